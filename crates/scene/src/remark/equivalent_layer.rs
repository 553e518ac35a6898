//! Layers of the equivalent linear method, as remarks have them.

/// Modulus and damping of a layer by the equivalent linear method.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EquivalentLayer {
    /// Material of the layer.
    pub material: String,
    /// Effective engineering shear strain (1).
    pub strain: f64,
    /// Shear modulus over that at small strain (1).
    pub modulus: f64,
    /// Damping ratio (1).
    pub damping: f64,
    /// Frequency (Hz) at which the waves of the run have the modulus: the mean of its logarithm over the power of the strain.
    pub frequency: f64,
    /// Effective engineering shear strain (1) in the ground of the run, whose modulus rises with frequency.
    pub in_run: f64,
}

impl EquivalentLayer {
    /// Layer of a material with its modulus and damping at small strain.
    pub fn new(material: impl Into<String>) -> Self {
        Self {
            material: material.into(),
            strain: 0.0,
            modulus: 1.0,
            damping: 0.0,
            frequency: 0.0,
            in_run: 0.0,
        }
    }
}
