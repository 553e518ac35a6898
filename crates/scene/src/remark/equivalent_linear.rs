//! Remarks about layers by the equivalent linear method.

use super::{Item, Kind};
use crate::Topic;

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

/// Fact: modulus and damping of layers by the equivalent linear method.
#[derive(Clone, Debug, PartialEq)]
pub struct EquivalentLinear {
    /// The layers, from the uppermost down.
    pub layers: Vec<EquivalentLayer>,
    /// Effective strain over the greatest one (1).
    pub strain_ratio: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// Change of modulus or damping in the last one, over its value (1).
    pub change: f64,
}

impl Item for EquivalentLinear {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Input)
    }
    fn text(&self) -> String {
        let mut text = format!(
            "equivalent linear method, {} iteration(s) to {:.2} %, bulk moduli as at small strain:",
            self.iterations,
            100.0 * self.change
        );
        for (index, layer) in self.layers.iter().enumerate() {
            text += &format!(
                "{} '{}' has an effective shear strain of {:.4} % ({} of the greatest), {:.3} of its shear modulus, held at {:.2} Hz in the run, and damping of {:.2} %; with the dispersion of that the strain is {:.4} %",
                if index == 0 { "" } else { ";" },
                layer.material,
                100.0 * layer.strain,
                self.strain_ratio,
                layer.modulus,
                layer.frequency,
                100.0 * layer.damping,
                100.0 * layer.in_run
            );
        }
        text
    }
}

remark! {
    /// Warning: effective strains for which the equivalent linear method is too crude.
    pub struct LargeStrains {
        /// Materials of the layers.
        pub materials: Vec<String>,
        /// Effective shear strain (1) above which a warning is given.
        pub limit: f64,
    }
    Warning(Input),
    "the effective shear strain of '{}' is above {} %: the equivalent linear method damps high frequencies too much there; compare with a law that yields",
    materials.join("', '"),
    100.0 * limit
}

remark! {
    /// Warning: the effective strain of an equivalent linear layer is beyond its curves.
    pub struct BeyondStrainCurves {
        /// Material of the layer.
        pub material: String,
        /// Effective shear strain (1).
        pub strain: f64,
        /// Greatest strain of the curves (1).
        pub greatest: f64,
    }
    Warning(Input),
    "the effective shear strain of '{material}', {:.3} %, is beyond the last of its strain curves, {:.3} %: it has the modulus and the damping of that; a law that yields says more",
    100.0 * strain,
    100.0 * greatest
}
