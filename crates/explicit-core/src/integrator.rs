//! Explicit time integration schemes.

use powerhouse_model::{
    Dynamics, ForceTerms, FrequencyLimits, MassDampingRule, RunError, TimeIntegrator,
};

/// The central difference method in leapfrog form: velocities at half steps, displacements at full steps.
///
/// `M (v+ - v-)/dt + C (v+ + v-)/2 + f(u, v-) = F(t)`, `u+ = u + dt v+` (Newmark 1959, beta = 0;
/// Hughes 1987, section 9.1). Mass damping and dashpots are implicit in the nodal diagonal and
/// do not reduce the stable step; nodal springs are integrated by average acceleration. Stiffness damping is
/// lagged (explicit), which gives the limit
///
/// `dt <= (2/w) (sqrt(1 + z^2) - z)`, `z = b w / 2`
///
/// for the highest frequency `w` (rad/s) and the stiffness damping coefficient `b` (s). Mass damping `a` (1/s)
/// is stable at any step, but it multiplies the velocity of a free mass by `(2 - a dt) / (2 + a dt)`, which changes
/// sign in every step where `a dt > 2`; the step is therefore limited to `2 / a` too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Leapfrog;

impl TimeIntegrator for Leapfrog {
    fn name(&self) -> &'static str {
        "leapfrog"
    }
    fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError> {
        let w = limits.highest;
        let z = 0.5 * limits.most_stiffness_damping * w;
        // sqrt(1 + z^2) - z without cancellation.
        let of_stiffness = 2.0 / (w * (z.hypot(1.0) + z));
        Ok(of_stiffness.min(2.0 / limits.most_mass_damping))
    }
    fn check(&self, limits: &FrequencyLimits, step: f64) -> Result<(), RunError> {
        let limit = self.stable_step(limits)?;
        let of_mass = limit * limits.most_mass_damping >= 2.0;
        let reason = if of_mass {
            "mass damping that would reverse velocities in every step"
        } else {
            "the highest frequency and its stiffness damping"
        };
        refuse_above(self.name(), limit, step, reason)
    }
    fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError> {
        let terms = ForceTerms::PLAIN.with_repeats(false);
        dynamics.forces(terms, step)?;
        dynamics.kick(MassDampingRule::Implicit, step)?;
        dynamics.constrain(step)?;
        dynamics.drift(step);
        Ok(())
    }
}

/// The time integration scheme of Wang, Chen & Xiao (2019), Eqs. (14)-(17), with a one-sided velocity difference.
///
/// Eliminating the velocity of Eq. (15) gives the leapfrog with lagged mass damping and the
/// stiffness damping coefficient reduced by half a step, which is how it is computed here. With
/// `q = (a + b w^2) dt` (mass coefficient `a`, stiffness coefficient `b`) a mode is stable if and
/// only if `w^2 dt^2 / 2 <= q <= 2`: without damping it is unstable at *every* step. So each set needs
/// `b >= dt/2`; its effective stiffness damping is `b - dt/2`.
///
/// Velocities are half a step apart from displacements, as in [`Leapfrog`]; the publication's
/// velocity at time `t` is their mean. A load is applied at the time of the displacement, in the
/// publication on average half a step later. Dashpots and springs of boundaries stay implicit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneSided;

impl TimeIntegrator for OneSided {
    fn name(&self) -> &'static str {
        "one-sided"
    }
    fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError> {
        let (least, most) = (
            limits.least_stiffness_damping,
            limits.most_stiffness_damping,
        );
        if least <= 0.0 {
            return Err(RunError::TooLittleDamping {
                scheme: self.name(),
                least: f64::MIN_POSITIVE,
                given: least,
            });
        }
        let rate = limits.most_mass_damping + most * limits.highest * limits.highest;
        Ok((2.0 * least).min(2.0 / rate))
    }
    fn check(&self, limits: &FrequencyLimits, step: f64) -> Result<(), RunError> {
        let given = limits.least_stiffness_damping;
        if given < 0.5 * step {
            return Err(RunError::TooLittleDamping {
                scheme: self.name(),
                least: 0.5 * step,
                given,
            });
        }
        let reason = "damping at the highest frequency";
        refuse_above(self.name(), self.stable_step(limits)?, step, reason)
    }
    fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError> {
        let terms = ForceTerms::shifted(-0.5 * step);
        dynamics.forces(terms.with_repeats(false), step)?;
        dynamics.kick(MassDampingRule::Lagged, step)?;
        dynamics.constrain(step)?;
        dynamics.drift(step);
        Ok(())
    }
}

fn refuse_above(scheme: &'static str, limit: f64, step: f64, reason: &str) -> Result<(), RunError> {
    // A step equal to the limit is accepted, rounding included.
    if step > 0.0 && step <= limit * (1.0 + 1e-12) {
        return Ok(());
    }
    Err(RunError::UnstableStep {
        step,
        limit,
        scheme,
        reason: reason.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits of both schemes under damping are those of the reference table
    /// (`alpha dt`, `xi dt^-1` per step, highest stable `w dt`), from roots of the amplification
    /// polynomials.
    #[test]
    fn limits_agree_with_the_roots_of_the_amplification() {
        // xi/dt, highest w dt of the leapfrog with lagged stiffness damping.
        for (xi, highest) in [
            (0.1, 1.82574),
            (0.25, 1.63299),
            (0.5, core::f64::consts::SQRT_2),
            (2.0, 0.894427),
        ] {
            let limits = FrequencyLimits::undamped(highest).with_damping(xi, xi, 0.0);
            assert!((Leapfrog.stable_step(&limits).unwrap() - 1.0).abs() < 1e-5);
        }
        // alpha dt, xi/dt, highest w dt of the one-sided scheme.
        for (alpha, xi, highest) in [
            (0.0, 0.75, 1.63299),
            (0.1, 2.0, 0.974679),
            (0.01, 0.5, 1.99499),
        ] {
            let limits = FrequencyLimits::undamped(highest).with_damping(xi, xi, alpha);
            assert!((OneSided.stable_step(&limits).unwrap() - 1.0).abs() < 1e-5);
        }
    }

    /// Mass damping shortens the step only where it would turn a free mass around.
    #[test]
    fn mass_damping_never_turns_a_mass_around() {
        let step = |mass: f64| {
            let limits = FrequencyLimits::undamped(1.0).with_damping(0.0, 0.0, mass);
            Leapfrog.stable_step(&limits).unwrap()
        };
        assert_eq!((step(0.0), step(0.9)), (2.0, 2.0));
        assert_eq!(step(100.0), 0.02);
        let limits = FrequencyLimits::undamped(1.0).with_damping(0.0, 0.0, 100.0);
        assert!(Leapfrog.check(&limits, 0.02).is_ok());
        let refused = Leapfrog.check(&limits, 0.021).unwrap_err();
        assert!(refused.to_string().contains("mass damping"), "{refused}");
    }

    /// The one-sided scheme refuses a set whose stiffness damping is below half the step.
    #[test]
    fn the_one_sided_scheme_needs_stiffness_damping() {
        let limits = FrequencyLimits::undamped(1.0).with_damping(0.04, 0.5, 0.0);
        assert!(OneSided.check(&limits, 0.08).is_ok());
        assert!(matches!(
            OneSided.check(&limits, 0.081),
            Err(RunError::TooLittleDamping { least, given, .. }) if least == 0.0405 && given == 0.04
        ));
        let undamped = FrequencyLimits::undamped(1.0);
        assert!(matches!(
            OneSided.stable_step(&undamped),
            Err(RunError::TooLittleDamping { .. })
        ));
    }
}
