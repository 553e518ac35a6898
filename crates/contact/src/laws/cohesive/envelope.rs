//! Envelope of a bond that softens linearly, and what a step does to it.

use powerhouse_model::Bond;

use super::{COMPLIANCE, DAMAGE, DISSIPATED, STORED};

/// Traction (Pa) of a bond on its envelope at a separation (m), up to the last one, at which it fails.
pub(super) fn envelope(tensile: f64, last: f64, separation: f64) -> f64 {
    (tensile * (1.0 - separation / last)).max(0.0)
}

/// Traction (Pa) of a bond that softens to a separation (m) in a step, at whose end (m) it may be within it.
pub(super) fn bearing(tensile: f64, last: f64, separation: f64, end: f64) -> f64 {
    let most = envelope(tensile, last, separation);
    if end < separation {
        most * end / separation
    } else {
        most
    }
}

/// Bond of a closed pair that does not slide in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StillBond {
    /// Traction along the tangents (Pa).
    pub(super) traction: [f64; 2],
    pub(super) change: BondChange,
}

/// Change of the history of a bond that softens in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BondChange {
    /// Energy stored, and newly dissipated (J/m2).
    stored: f64,
    dissipated: f64,
    /// Secant compliance (m/Pa) and damage at least.
    compliance: f64,
    damage: f64,
}

impl BondChange {
    /// A bond that stores an energy (J/m2) within its envelope.
    pub(super) fn elastic(stored: f64) -> Self {
        Self {
            stored,
            ..Self::default()
        }
    }

    /// A bond that softens to a separation, from the one that it had reached, and ends the step there or within it; it fails at the last.
    pub(super) fn on_envelope(
        tensile: f64,
        [reached, last]: [f64; 2],
        separation: f64,
        end: f64,
    ) -> Self {
        let dissipated = 0.5 * tensile * (separation.min(last) - reached).max(0.0);
        if separation >= last {
            return Self {
                dissipated,
                damage: 1.0,
                ..Self::default()
            };
        }
        let most = envelope(tensile, last, separation);
        Self {
            stored: 0.5 * bearing(tensile, last, separation, end) * end.min(separation),
            dissipated,
            compliance: separation / most,
            damage: separation / last,
        }
    }

    pub(super) fn bond(&self) -> Bond {
        if self.damage < 1.0 {
            Bond::Softening
        } else {
            Bond::Broken
        }
    }

    pub(super) fn record(&self, new: &mut [f64]) {
        new[COMPLIANCE] = new[COMPLIANCE].max(self.compliance);
        new[DAMAGE] = new[DAMAGE].max(self.damage);
        new[DISSIPATED] += self.dissipated;
        new[STORED] = self.stored;
    }
}
