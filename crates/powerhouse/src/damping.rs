//! How parts are damped.

use core::fmt;

use powerhouse_explicit_core::Rayleigh;
use powerhouse_material_damage::{DampingBand, ReferenceFrequency, RelaxationSpectrum};
use powerhouse_model::ParameterError;

use crate::Material;

/// How a part is damped.
///
/// ```
/// use powerhouse::engine::Rayleigh;
/// use powerhouse::material::{
///     DampingBand, LinearElastic, ReferenceFrequency, RelaxationSpectrum, media,
/// };
/// use powerhouse::{Damping, Material, Part};
///
/// // 5 % over a band cost a tenth of the step.
/// let band = DampingBand { ratio: 0.05, lowest: 0.5, highest: 20.0, mechanisms: 3 };
/// let flat = Damping::Flat {
///     spectrum: RelaxationSpectrum::fit(band)?,
///     reference: ReferenceFrequency::Centre,
/// };
/// let rock = Part::new("rock", Material::from(LinearElastic::new(media::ROCK))).with_damping(flat);
/// let moving = rock.moving_material()?;
/// let shortening = media::ROCK.p_speed() / moving.medium().p_speed();
/// assert!(shortening > 0.89 && shortening < 0.92, "{shortening}");
/// # Ok::<(), powerhouse::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Damping {
    /// Not at all.
    #[default]
    None,
    /// In proportion to mass and stiffness.
    Rayleigh(Rayleigh),
    /// By relaxation mechanisms in series with the law, the same at all frequencies of a band. What
    /// stages leave at rest stays: there the material is as soft as it is at frequencies far below the
    /// band ([`DampingCost::at_rest`]). The material must be a law of the software (`Material::from`) or come from
    /// [`Material::in_series`](crate::Material::in_series).
    Flat {
        /// The mechanisms.
        spectrum: RelaxationSpectrum,
        /// Where waves have the speeds that the material states.
        reference: ReferenceFrequency,
    },
}

impl From<Rayleigh> for Damping {
    fn from(rayleigh: Rayleigh) -> Self {
        if rayleigh == Rayleigh::default() {
            Self::None
        } else {
            Self::Rayleigh(rayleigh)
        }
    }
}

impl Damping {
    /// The coefficients, zero if damping is of another kind.
    pub(crate) fn rayleigh(&self) -> Rayleigh {
        match self {
            Self::Rayleigh(rayleigh) => *rayleigh,
            Self::None | Self::Flat { .. } => Rayleigh::default(),
        }
    }
}

/// What flat damping costs a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingCost {
    /// What was asked for.
    pub band: DampingBand,
    /// The largest deviation of the damping from its ratio within the band, relative to it.
    pub deviation: f64,
    /// Speed of waves at the ends of the band, over that of the material.
    pub speeds: [f64; 2],
    /// Stiffness at rest, as stages meet it, over that of the material.
    pub at_rest: f64,
    /// The stable step of an element over that of one without damping.
    pub step: f64,
    /// Further history variables of an integration point.
    pub variables: usize,
}

impl DampingCost {
    /// The cost to a material of the same one damped.
    pub(crate) fn of(
        material: &Material,
        damped: &Material,
        (spectrum, reference): (&RelaxationSpectrum, ReferenceFrequency),
    ) -> Result<Self, ParameterError> {
        let band = spectrum.band();
        let at_reference = reference.velocity(spectrum)?;
        let speed = |frequency: f64| spectrum.velocity(frequency) / at_reference;
        Ok(Self {
            band,
            deviation: spectrum.deviation(),
            speeds: [speed(band.lowest), speed(band.highest)],
            at_rest: at_reference.powi(-2),
            step: material.medium().p_speed() / damped.medium().p_speed(),
            variables: damped.history().len() - material.history().len(),
        })
    }
}

impl fmt::Display for DampingCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DampingBand {
            ratio,
            lowest,
            highest,
            mechanisms,
        } = self.band;
        write!(
            f,
            "{:.3} % of critical from {lowest} to {highest} Hz by {mechanisms} mechanisms, within {:.1} % of that; \
             waves travel {:.3} times as fast as the material says at {lowest} Hz, {:.3} times at {highest} Hz; \
             at rest it is {:.3} times as stiff; \
             its elements permit {:.3} of the undamped step, each integration point has {} history variables more",
            100.0 * ratio,
            100.0 * self.deviation,
            self.speeds[0],
            self.speeds[1],
            self.at_rest,
            self.step,
            self.variables,
        )
    }
}
