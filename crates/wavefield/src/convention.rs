//! Input conventions: the motion that a record represents.

use crate::{Complex, SurfaceReflection, WaveError, WithinReport};

/// Component of the ground motion in the frame of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceComponent {
    /// Horizontal component along the direction of travel (x at azimuth zero).
    X,
    /// Horizontal component across the direction of travel (y at azimuth zero); SH has this one alone.
    Y,
    /// Vertical component, upwards positive.
    Z,
}

impl SurfaceComponent {
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Motion that a record represents: incident wave, outcrop, surface, or motion at a depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum InputConvention {
    /// The incident wave itself, along its own polarisation.
    #[default]
    Incident,
    /// The motion of a rock outcrop, defined as twice the incident wave.
    Outcrop,
    /// A component of the motion of the free surface under the wave itself: the incident wave is the
    /// record divided by the surface coefficient of its type and angle. Past the critical angle the
    /// coefficient is complex and the incident wave a phase-shifted record.
    SurfaceComponent(SurfaceComponent),
    /// A component of the motion at a depth below the free surface under the wave itself, incident
    /// and reflected waves together (a within motion). The record's time zero becomes that of the
    /// incident wave at the location of the record; the incident wave begins before it where the start
    /// of the record requires waves that arrived earlier.
    ///
    /// That motion vanishes at some frequencies, at which the incident wave cannot be recovered: the
    /// division by the transfer function H is regularised, `F conj(H) / (|H|^2 + (r Hm)^2)`, with
    /// Hm the sum of the waves' magnitudes. [`PlaneWave::conversion`](crate::PlaneWave::conversion)
    /// reports the misfit that results.
    ///
    /// In layers in which nothing moves before the wave arrives the record is made by a wave from below that began before
    /// it, and without r the division is exact: at complex frequencies, of the motion under an exponential weight, where H
    /// vanishes nowhere. Errors of the record at the frequencies at which H vanishes grow with time in undamped layers.
    Within {
        /// Depth below the surface (m), above zero and at most 1e9.
        depth: f64,
        /// Component of the record.
        component: SurfaceComponent,
        /// Regularisation r (1), 0.001 to 0.5; none for the exact division in layers, and for 0.05 elsewhere.
        regularisation: Option<f64>,
    },
}

impl InputConvention {
    /// Name of the convention in scenes and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Incident => "incident",
            Self::Outcrop => "outcrop",
            Self::SurfaceComponent(_) => "surface-component",
            Self::Within { .. } => "within",
        }
    }

    /// Incident amplitude per unit of the record, where that is one number for all frequencies.
    pub(crate) fn amplitude(&self, reflection: &SurfaceReflection) -> Result<Complex, WaveError> {
        /// Least surface coefficient: below it the record would be amplified more than fivefold.
        const LEAST_COEFFICIENT: f64 = 0.2;
        let one = Complex::new(1.0, 0.0);
        match *self {
            Self::Incident | Self::Within { .. } => Ok(one),
            Self::Outcrop => Ok(one * 0.5),
            Self::SurfaceComponent(component) => {
                let coefficient = reflection.surface_motion()[component.index()];
                if coefficient.norm() < LEAST_COEFFICIENT {
                    return Err(WaveError::WeakComponent {
                        kind: reflection.kind,
                        component,
                        coefficient: coefficient.norm(),
                        limit: LEAST_COEFFICIENT,
                    });
                }
                Ok(one / coefficient)
            }
        }
    }
}

/// Conversion of a record into the incident wave, as it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputConversion {
    /// Incident amplitude per unit of the record (1), for spectra of `exp(+i w t)`, `w > 0`; one where
    /// [`within`](Self::within) is set.
    pub amplitude: Complex,
    /// Report of the regularised division, for [`InputConvention::Within`].
    pub within: Option<WithinReport>,
}
