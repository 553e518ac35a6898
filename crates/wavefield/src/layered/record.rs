//! Incident wave of a record on layered ground or in it.

use powerhouse_model::ParameterError;
use std::sync::Arc;

use super::stack::{Stack, transfer};
use super::window::Arriving;
use crate::within::{TransferFunction, WITHIN_REGULARISATION, causal_incident_of, incident_of};
use crate::{
    Complex, InputConvention, InputConversion, Signal, SignalMotion, SignalSupport,
    SurfaceComponent, WaveError,
};

/// Least magnitude of the transfer function of a surface record over the frequencies of the record.
const LEAST_TRANSFER: f64 = 0.2;
/// Size of transfer functions: that of a free surface. Resonances reach far more, and a share of theirs
/// would bias all other frequencies.
const SURFACE: f64 = 2.0;

/// A signal times a factor.
struct Scaled {
    signal: Arc<dyn Signal>,
    factor: f64,
}

impl Signal for Scaled {
    fn motion(&self, time: f64) -> SignalMotion {
        let motion = self.signal.motion(time);
        SignalMotion {
            displacement: self.factor * motion.displacement,
            velocity: self.factor * motion.velocity,
            acceleration: self.factor * motion.acceleration,
        }
    }
    fn support(&self) -> SignalSupport {
        self.signal.support()
    }
}

/// Transfer function of one component at a height.
struct OfHeight<'a> {
    arriving: Arriving<'a>,
    stack: Stack,
    height: f64,
    component: SurfaceComponent,
}

impl TransferFunction for OfHeight<'_> {
    fn value(&self, frequency: Complex) -> Complex {
        /// Angular frequency (1/s) in place of zero, where a damped modulus may vanish.
        const LEAST: Complex = Complex { re: 1e-5, im: 0.0 };
        let ground = self.arriving.ground;
        let is_zero = frequency == Complex::new(0.0, 0.0);
        let frequency = if is_zero { LEAST } else { frequency };
        let state = transfer(ground, &self.stack, self.height, frequency);
        match (self.stack.order, self.component) {
            (1, SurfaceComponent::Y) | (2, SurfaceComponent::X) => state[0],
            (2, SurfaceComponent::Z) => state[1],
            _ => Complex::new(0.0, 0.0),
        }
    }
    fn magnitude(&self) -> f64 {
        SURFACE
    }
    fn longest_delay(&self) -> f64 {
        self.arriving.longest_delay()
    }
}

/// Incident wave at the top of the half-space of which a signal is the motion that the convention states, and how it was
/// found.
pub(crate) fn incident(
    arriving: &Arriving,
    signal: Arc<dyn Signal>,
    convention: InputConvention,
) -> Result<(Arc<dyn Signal>, InputConversion), WaveError> {
    let mut conversion = InputConversion {
        amplitude: Complex::new(1.0, 0.0),
        within: None,
    };
    let mut is_exact = false;
    let (depth, component, regularisation) = match convention {
        InputConvention::Incident => return Ok((signal, conversion)),
        InputConvention::Outcrop => {
            let factor = 0.5;
            conversion.amplitude *= factor;
            return Ok((Arc::new(Scaled { signal, factor }), conversion));
        }
        InputConvention::SurfaceComponent(component) => (0.0, component, 0.0),
        InputConvention::Within {
            depth,
            component,
            regularisation,
        } => {
            ParameterError::check("depth", depth, f64::MIN_POSITIVE, 1e9)?;
            match regularisation {
                Some(r) => ParameterError::check("regularisation", r, 1e-3, 0.5)?,
                None => is_exact = arriving.is_causal(),
            }
            let regularisation = regularisation.unwrap_or(WITHIN_REGULARISATION);
            (depth, component, regularisation)
        }
    };
    let slowness = arriving.reflection.horizontal_slowness;
    let of_height = OfHeight {
        arriving: *arriving,
        stack: Stack::new(arriving.ground, arriving.kind, slowness),
        height: arriving.ground.surface() - depth,
        component,
    };
    let weak = |coefficient: f64, limit: f64| WaveError::WeakComponent {
        kind: arriving.kind,
        component,
        coefficient,
        limit,
    };
    let still = of_height.value(Complex::new(0.0, 0.0)).norm();
    if still < 1e-12 {
        return Err(weak(still, LEAST_TRANSFER));
    }
    let (found, report) = if is_exact {
        causal_incident_of(&*signal, &of_height, arriving.until)?
    } else {
        incident_of(&*signal, &of_height, regularisation)?
    };
    if regularisation == 0.0 && report.least_transfer < LEAST_TRANSFER {
        return Err(weak(report.least_transfer, LEAST_TRANSFER));
    }
    conversion.within = Some(report);
    Ok((Arc::new(found), conversion))
}
