//! What a record is.

use crate::{Complex, SurfaceReflection, WaveError, WithinReport};

/// A component of motion in the frame of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceComponent {
    /// Along the horizontal direction of travel (x at azimuth zero).
    X,
    /// Across it (y at azimuth zero); SH moves in it alone.
    Y,
    /// Up.
    Z,
}

impl SurfaceComponent {
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// What a record is, so that no factor hides in a comment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum InputConvention {
    /// The incident wave itself, along its own polarisation.
    #[default]
    Incident,
    /// The motion of rock outcropping, defined as twice the incident wave.
    Outcrop,
    /// A component of the motion of the free surface under this very wave: the incident wave is
    /// the record divided by the surface coefficient of its type and angle. Past the critical
    /// angle the coefficient is complex and the incident wave a phase-shifted record.
    SurfaceComponent(SurfaceComponent),
    /// A component of the motion at a depth below the free surface under this very wave, incident
    /// and reflected together. The record's time zero becomes that of the incident wave at the
    /// place of the record; the incident wave begins before it where the record is to be explained
    /// by waves that are on their way.
    ///
    /// That motion vanishes at some frequencies, where no record can tell the incident wave: the
    /// division by the transfer function H is regularised, `F conj(H) / (|H|^2 + (r Hm)^2)`, with
    /// Hm the sum of the waves' magnitudes. [`PlaneWave::conversion`](crate::PlaneWave::conversion)
    /// reports what that costs.
    Within {
        /// Depth below the surface (m), above zero.
        depth: f64,
        /// The component.
        component: SurfaceComponent,
        /// Regularisation r, 0.001 to 0.5.
        regularisation: f64,
    },
}

impl InputConvention {
    /// The name in scenes and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Incident => "incident",
            Self::Outcrop => "outcrop",
            Self::SurfaceComponent(_) => "surface-component",
            Self::Within { .. } => "within",
        }
    }

    /// The incident amplitude per unit of the record, where that is one number.
    pub(crate) fn amplitude(&self, reflection: &SurfaceReflection) -> Result<Complex, WaveError> {
        /// Below this the record would be amplified more than fivefold.
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

/// How a record became the incident wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputConversion {
    /// Incident amplitude per unit of the record, for spectra of `exp(+i w t)`, `w > 0`; one where
    /// [`within`](Self::within) tells more.
    pub amplitude: Complex,
    /// What the regularised division did, for [`InputConvention::Within`].
    pub within: Option<WithinReport>,
}
