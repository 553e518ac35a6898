//! Share of hourglass resistance in the internal work of an element set.

/// Share of the largest internal work of all sets below which the work of a set is rounding.
const ROUNDING: f64 = 1.0e-9;

/// Work of hourglass resistance and internal work of an element set.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HourglassShare {
    /// Name of the element set.
    pub set: String,
    /// Largest work of hourglass resistance (J), stored and dissipated.
    pub hourglass: f64,
    /// Largest internal work (J), hourglass included: stored and dissipated energy in a run, stored energy in a
    /// stage.
    pub internal: f64,
}

impl HourglassShare {
    /// Largest acceptable share of hourglass work in internal work; above it the stiffness of a set depends
    /// on the hourglass resistance as much as on the material.
    ///
    /// Around a circular hole in rock with associated flow and 42 degrees of friction, meshed to twenty radii, the
    /// closure of the wall falls to less than half where the share of the whole ring is 1.5 %, because distant
    /// elements store most of the work.
    pub const LIMIT: f64 = 0.01;

    /// Hourglass work over internal work; zero without internal work.
    pub fn share(&self) -> f64 {
        if self.internal > 0.0 {
            self.hourglass / self.internal
        } else {
            0.0
        }
    }

    /// Updates the maxima with the energies (J) of the set at another time.
    pub fn update(&mut self, hourglass: f64, internal: f64) {
        self.hourglass = self.hourglass.max(hourglass.abs());
        self.internal = self.internal.max(internal.abs()).max(self.hourglass);
    }

    /// The sets whose work exceeds rounding.
    pub fn above_rounding(sets: impl Iterator<Item = Self>) -> Vec<Self> {
        let sets: Vec<Self> = sets.collect();
        let most = sets
            .iter()
            .fold(0.0_f64, |most, set| most.max(set.internal));
        let counts = |set: &Self| set.internal > ROUNDING * most;
        sets.into_iter().filter(counts).collect()
    }
}
