//! Controls of laboratory tests.

use super::Control::{self, Strain, Stress};

impl Control {
    /// Controls of uniaxial stress along z: an axial strain, stress-free sides.
    pub fn uniaxial(axial: f64) -> [Self; 6] {
        Self::triaxial(0.0, axial)
    }

    /// Controls of a triaxial test: an axial strain along z under a lateral stress (Pa, pressure negative).
    pub fn triaxial(lateral: f64, axial: f64) -> [Self; 6] {
        let [side, shear] = [Stress(lateral), Strain(0.0)];
        [side, side, Strain(axial), shear, shear, shear]
    }

    /// Controls of plane strain: an axial strain along z, no strain along y, a lateral stress along x (Pa).
    pub fn plane_strain(lateral: f64, axial: f64) -> [Self; 6] {
        let none = Strain(0.0);
        [Stress(lateral), none, Strain(axial), none, none, none]
    }

    /// Controls of a biaxial test: equal strains along x and y, a stress-free side along z.
    pub fn biaxial(strain: f64) -> [Self; 6] {
        let none = Strain(0.0);
        [
            Strain(strain),
            Strain(strain),
            Stress(0.0),
            none,
            none,
            none,
        ]
    }

    /// Controls of simple shear: an engineering strain xy under constant normal stresses (Pa).
    pub fn simple_shear(normal: [f64; 3], shear: f64) -> [Self; 6] {
        let [xx, yy, zz] = normal.map(Stress);
        [xx, yy, zz, Strain(shear), Strain(0.0), Strain(0.0)]
    }
}
