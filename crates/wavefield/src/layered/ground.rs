//! Layered ground: horizontal layers over a half-space.

use powerhouse_model::{ElasticMedium, ParameterError};
use std::f64::consts::PI;

use crate::{Complex, LayerDefect, WaveError};

/// Least thickness of a layer (m).
const LEAST_THICKNESS: f64 = 1e-3;
/// Least density (kg/m3) and least shear wave speed (m/s) of a layer.
const LEAST_DENSITY: f64 = 50.0;
const LEAST_SPEED: f64 = 1.0;
/// Greatest number of layers.
const MOST_LAYERS: usize = 10_000;

/// Relaxation mechanism of a damped layer: a Maxwell element, a spring and a dashpot in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerMechanism {
    /// Relaxation frequency, at which it dissipates most (Hz).
    pub frequency: f64,
    /// Stiffness of its spring relative to the static modulus (1).
    pub weight: f64,
}

/// Damping of a layer, the same for both elastic moduli.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LayerDamping {
    /// No damping.
    #[default]
    None,
    /// Flat damping by relaxation mechanisms in parallel with a spring, as that of bodies (a
    /// generalised Maxwell body): `M(w) / C = (1 + sum y_l i w / (i w + w_l)) / c^2`, `C` the modulus of
    /// the layer's medium.
    Flat {
        /// Mechanisms.
        mechanisms: Vec<LayerMechanism>,
        /// Phase velocity c at the reference frequency, at which waves have the speeds of the layer's
        /// medium, over that of static moduli (1).
        velocity: f64,
    },
    /// Constant quality factor at all frequencies:
    /// `M(w) / C = cos^2(pi g / 2) (i w / w_r)^(2 g)`, `g = atan(1 / Q) / pi`.
    ///
    /// Source: E. Kjartansson (1979), J. Geophys. Res. 84(B9), 4737-4748.
    ConstantQuality {
        /// Quality factor Q of P and S waves (1), 1 or more; half its inverse is the damping ratio.
        quality: f64,
        /// Frequency at which waves have the speeds of the layer's medium (Hz).
        reference: f64,
    },
    /// One complex modulus at all frequencies, `M / C = 1 + 2 i r`, as in the usual equivalent linear method: without dispersion,
    /// and for that not causal.
    Hysteretic {
        /// Damping ratio r (1), 0 to 0.5.
        ratio: f64,
    },
}

impl LayerDamping {
    /// Whether there is no damping.
    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Modulus over that of the layer's medium, of `i w` (1/s), which is not zero.
    pub(crate) fn modulus(&self, rate: Complex) -> Complex {
        let one = Complex::new(1.0, 0.0);
        match self {
            Self::None => one,
            Self::Flat {
                mechanisms,
                velocity,
            } => {
                let terms = mechanisms.iter().map(|mechanism| {
                    let own = rate + 2.0 * PI * mechanism.frequency;
                    rate / own * mechanism.weight
                });
                terms.fold(one, |sum, term| sum + term) / (velocity * velocity)
            }
            Self::ConstantQuality { quality, reference } => {
                let exponent = (1.0 / quality).atan() / PI;
                let scale = (0.5 * PI * exponent).cos();
                (rate / (2.0 * PI * reference)).powf(2.0 * exponent) * (scale * scale)
            }
            Self::Hysteretic { ratio } => Complex::new(1.0, 2.0 * ratio),
        }
    }

    /// Greatest wave speed over that of the layer's medium (1), of frequencies up to a given one (Hz).
    fn fastest(&self, highest: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Flat {
                mechanisms,
                velocity,
            } => {
                let unrelaxed = mechanisms.iter().fold(1.0, |sum, m| sum + m.weight);
                unrelaxed.sqrt() / velocity
            }
            Self::ConstantQuality { .. } => {
                let rate = Complex::new(0.0, 2.0 * PI * highest);
                self.modulus(rate).norm().sqrt().max(1.0)
            }
            Self::Hysteretic { ratio } => (1.0 + 4.0 * ratio * ratio).sqrt(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::None => Ok(()),
            Self::Flat {
                mechanisms,
                velocity,
            } => {
                ParameterError::check("velocity", *velocity, 1.0, 10.0)?;
                for mechanism in mechanisms {
                    ParameterError::check("frequency", mechanism.frequency, 1e-9, 1e9)?;
                    ParameterError::check("weight", mechanism.weight, 0.0, 10.0)?;
                }
                Ok(())
            }
            Self::ConstantQuality { quality, reference } => {
                ParameterError::check("quality", *quality, 1.0, f64::MAX)?;
                ParameterError::check("reference", *reference, 1e-9, 1e9)
            }
            Self::Hysteretic { ratio } => ParameterError::check("ratio", *ratio, 0.0, 0.5),
        }
    }
}

/// Horizontal layer of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundLayer {
    /// Height z of its lower interface (m).
    pub bottom: f64,
    /// Elastic medium; of a damped layer, that at the reference frequency of its damping.
    pub medium: ElasticMedium,
    /// Damping.
    pub damping: LayerDamping,
}

impl GroundLayer {
    /// Undamped layer down to a height z (m).
    pub fn new(bottom: f64, medium: ElasticMedium) -> Self {
        Self {
            bottom,
            medium,
            damping: LayerDamping::None,
        }
    }
    /// The same layer with damping.
    #[must_use]
    pub fn with_damping(mut self, damping: LayerDamping) -> Self {
        self.damping = damping;
        self
    }
}

/// Layered ground: any number of horizontal layers over an elastic, undamped half-space, under a
/// horizontal free surface.
///
/// ```
/// use powerhouse_model::ElasticMedium;
/// use powerhouse_wavefield::{Ground, GroundLayer};
/// let soil = ElasticMedium::new(180e6, 0.4, 1800.0)?;
/// let rock = ElasticMedium::new(9e9, 0.27, 2750.0)?;
/// let ground = Ground::new(0.0, vec![GroundLayer::new(-20.0, soil)], rock)?;
/// assert_eq!(ground.medium_at(-19.0), soil);
/// assert_eq!(ground.interfaces(), [-20.0]);
/// assert!(Ground::new(-30.0, vec![GroundLayer::new(-20.0, soil)], rock).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    surface: f64,
    layers: Vec<GroundLayer>,
    half_space: ElasticMedium,
    interfaces: Vec<f64>,
}

impl Ground {
    /// Ground of a free surface at a height z (m), of layers from the uppermost down and of the medium
    /// below them.
    ///
    /// # Errors
    /// [`WaveError::Layer`] names the first layer that is not below the one before it, is thinner than
    /// a millimetre or softer than any soil; parameter errors of media and damping.
    pub fn new(
        surface: f64,
        layers: Vec<GroundLayer>,
        half_space: ElasticMedium,
    ) -> Result<Self, WaveError> {
        const FARTHEST: f64 = 1e9;
        ParameterError::check("surface", surface, -FARTHEST, FARTHEST)?;
        let count = layers.len() as f64;
        ParameterError::check("number of layers", count, 0.0, MOST_LAYERS as f64)?;
        let mut top = surface;
        for (index, layer) in layers.iter().enumerate() {
            let refused = |defect| WaveError::Layer {
                index,
                depth: surface - top,
                defect,
            };
            ParameterError::check("bottom", layer.bottom, -FARTHEST, FARTHEST)?;
            let (above, bottom) = (top, layer.bottom);
            if bottom >= above {
                return Err(refused(LayerDefect::NotBelow { top: above, bottom }));
            }
            if above - bottom < LEAST_THICKNESS {
                return Err(refused(LayerDefect::Thin {
                    thickness: above - bottom,
                    least: LEAST_THICKNESS,
                }));
            }
            check_medium(&layer.medium).map_err(refused)?;
            layer
                .damping
                .check()
                .map_err(|error| refused(LayerDefect::Parameter(error)))?;
            top = bottom;
        }
        check_medium(&half_space).map_err(|defect| WaveError::Layer {
            index: layers.len(),
            depth: surface - top,
            defect,
        })?;
        Ok(Self {
            surface,
            interfaces: layers.iter().map(|layer| layer.bottom).collect(),
            layers,
            half_space,
        })
    }

    /// Height z of the free surface (m).
    pub fn surface(&self) -> f64 {
        self.surface
    }
    /// Layers from the uppermost down.
    pub fn layers(&self) -> &[GroundLayer] {
        &self.layers
    }
    /// Medium of the half-space below the layers.
    pub fn half_space(&self) -> ElasticMedium {
        self.half_space
    }
    /// Heights z (m) of the interfaces from the uppermost down; the last is the top of the half-space.
    pub fn interfaces(&self) -> &[f64] {
        &self.interfaces
    }
    /// Height z of the top of the half-space (m): the surface where there are no layers.
    pub fn base(&self) -> f64 {
        self.interfaces.last().copied().unwrap_or(self.surface)
    }
    /// Medium at a height z (m), on an interface that below it.
    pub fn medium_at(&self, height: f64) -> ElasticMedium {
        self.medium(self.layer_at(height))
    }
    /// Index of the layer at a height, on an interface of that below; the number of layers in the
    /// half-space.
    pub(crate) fn layer_at(&self, height: f64) -> usize {
        self.interfaces.partition_point(|bottom| *bottom >= height)
    }
    /// Medium of a layer, or of the half-space.
    pub(crate) fn medium(&self, index: usize) -> ElasticMedium {
        self.layers
            .get(index)
            .map_or(self.half_space, |layer| layer.medium)
    }
    /// Heights of top and bottom of a layer; the half-space has no bottom.
    pub(crate) fn extent(&self, index: usize) -> [f64; 2] {
        let interface = |index: usize| self.interfaces.get(index).copied();
        let top = match index {
            0 => self.surface,
            _ => interface(index - 1).unwrap_or(f64::NEG_INFINITY),
        };
        [top, interface(index).unwrap_or(f64::NEG_INFINITY)]
    }
    /// Greatest speed of the waves that a horizontal slowness meets, shear waves alone or both kinds,
    /// of frequencies up to a given one (Hz).
    pub(crate) fn fastest(&self, shear: bool, highest: f64) -> f64 {
        let speed = |medium: &ElasticMedium| {
            if shear {
                medium.s_speed()
            } else {
                medium.p_speed()
            }
        };
        let layers = self.layers.iter();
        let speeds = layers.map(|layer| speed(&layer.medium) * layer.damping.fastest(highest));
        speeds.fold(speed(&self.half_space), f64::max)
    }
}

/// Checks that a medium is one of the ground.
fn check_medium(medium: &ElasticMedium) -> Result<(), LayerDefect> {
    let medium = ElasticMedium::new(medium.young, medium.poisson, medium.density)
        .map_err(LayerDefect::Parameter)?;
    let limits = [
        ("density", medium.density, LEAST_DENSITY),
        ("shear wave speed", medium.s_speed(), LEAST_SPEED),
    ];
    for (quantity, value, least) in limits {
        if value.is_nan() || value < least {
            return Err(LayerDefect::Soft {
                quantity,
                value,
                least,
            });
        }
    }
    Ok(())
}
