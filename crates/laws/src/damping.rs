//! Material damping of parts.

use core::fmt;

use powerhouse_material_damage::{DampingBand, ReferenceFrequency, RelaxationSpectrum};
use powerhouse_model::{ParameterError, Rayleigh};

use crate::Material;

/// Material damping of a part.
///
/// ```
/// use powerhouse_laws::{Damping, Material};
/// use powerhouse_material_damage::{
///     DampingBand, LinearElastic, ReferenceFrequency, RelaxationSpectrum, media,
/// };
///
/// // 5 % over a band reduce the stable step by a tenth.
/// let band = DampingBand { ratio: 0.05, lowest: 0.5, highest: 20.0, mechanisms: 3 };
/// let spectrum = RelaxationSpectrum::fit(band)?;
/// let rock = Material::from(LinearElastic::new(media::ROCK));
/// let moving = rock.damped(&spectrum, ReferenceFrequency::Centre)?.expect("an elastic part");
/// let shortening = media::ROCK.p_speed() / moving.medium().p_speed();
/// assert!(shortening > 0.89 && shortening < 0.92, "{shortening}");
/// let damping = Damping::Flat { spectrum, reference: ReferenceFrequency::Centre };
/// assert_eq!(damping.rayleigh().stiffness, 0.0);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Damping {
    /// No damping.
    #[default]
    None,
    /// Rayleigh damping, proportional to mass and stiffness.
    Rayleigh(Rayleigh),
    /// Flat damping: frequency-independent in a band, by relaxation mechanisms (a generalised Maxwell body) in series
    /// with the law. Construction stages have the static stiffness far below the band ([`DampingCost::static_stiffness`]),
    /// and their stress does not relax in the run. The material must have a law of the software (`Material::from`) or
    /// come from [`Material::in_series`](crate::Material::in_series).
    Flat {
        /// Fitted relaxation mechanisms.
        spectrum: RelaxationSpectrum,
        /// Reference frequency at which the moduli and wave speeds are those of the material.
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
    /// Rayleigh coefficients; zero for other kinds of damping.
    pub fn rayleigh(&self) -> Rayleigh {
        match self {
            Self::Rayleigh(rayleigh) => *rayleigh,
            Self::None | Self::Flat { .. } => Rayleigh::default(),
        }
    }
}

/// Accuracy of flat damping, and its effect on wave speeds, stable step and memory of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampingCost {
    /// Requested damping ratio and band.
    pub band: DampingBand,
    /// Largest deviation of the damping ratio within the band from the requested one, over the requested one (1).
    pub deviation: f64,
    /// Wave speeds at the lowest and highest frequency of the band, over that of the undamped material (1); P and S waves
    /// alike.
    pub speeds: [f64; 2],
    /// Ratio of the relaxed (static) modulus to the material's modulus, which holds at the reference frequency (1); it
    /// acts in construction stages.
    pub static_stiffness: f64,
    /// Stable step of an element with the damping over that without (1), at most 1.
    pub step: f64,
    /// Number of additional history variables per integration point.
    pub variables: usize,
}

impl DampingCost {
    /// Comparison of a material with its damped form.
    ///
    /// # Errors
    /// A reference frequency out of range.
    pub fn of(
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
            static_stiffness: at_reference.powi(-2),
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
            "{:.3} % of critical from {lowest} to {highest} Hz by {mechanisms} mechanisms, accurate to {:.1} % of that; \
             wave speeds are {:.3} times those of the material at {lowest} Hz, {:.3} times at {highest} Hz; \
             the static stiffness is {:.3} times that of the material; \
             the stable step of its elements is {:.3} of the undamped one, each integration point has {} more history variables",
            100.0 * ratio,
            100.0 * self.deviation,
            self.speeds[0],
            self.speeds[1],
            self.static_stiffness,
            self.step,
            self.variables,
        )
    }
}
