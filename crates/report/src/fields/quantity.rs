//! One number per node or element from a field of a file.

use std::fmt;
use std::path::Path;

use powerhouse::engine::observe::principal_stresses;
use powerhouse::io::{FieldNumbers, FieldOfFile, VtuGrid};
use powerhouse::model::Stress;

use powerhouse_study::StudyError;

/// Names of the components of vectors and of symmetric tensors.
const VECTOR: [&str; 3] = ["x", "y", "z"];
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// One number of a vector or tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FieldPart {
    /// The number of a scalar, or the magnitude of a vector.
    Magnitude,
    /// A component, by its index.
    Component(usize),
    /// Greatest principal value of a tensor, tension positive.
    Greatest,
    /// Least principal value of a tensor.
    Least,
    /// Equivalent stress of von Mises.
    Mises,
}

/// Quantity of a picture: the name of a field, and after a point what of it, such as `displacement`, `displacement.z`,
/// `stress.greatest`, `stress.xx` or `damage`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldQuantity(pub String);

impl fmt::Display for FieldQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// One number per node or element.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    /// Unit; empty for a dimensionless quantity.
    pub unit: String,
    /// Whether there is one number per node, in place of one per element.
    pub is_nodal: bool,
    /// Numbers in the order of the mesh; NaN where the body is not present.
    pub values: Vec<f64>,
    /// Whether they are integers, such as a yield state, between which there is nothing.
    pub is_whole: bool,
}

impl FieldQuantity {
    /// The quantity from the fields of a file.
    ///
    /// # Errors
    /// [`StudyError::NoSuchField`] with the quantities that the file has.
    pub fn of(&self, grid: &VtuGrid, file: &Path) -> Result<ScalarField, StudyError> {
        let (field, is_nodal, part) = self.find(grid).ok_or_else(|| StudyError::NoSuchField {
            file: file.into(),
            name: self.0.clone(),
            available: available(grid),
        })?;
        let groups = field.values.chunks(field.components.max(1));
        let values = groups.map(|group| part.of(group));
        Ok(ScalarField {
            unit: field.unit.clone(),
            is_nodal,
            values: values.collect(),
            is_whole: field.numbers == FieldNumbers::Whole && field.components == 1,
        })
    }

    /// The field, whether it is one of nodes, and what of it.
    fn find<'g>(&self, grid: &'g VtuGrid) -> Option<(&'g FieldOfFile, bool, FieldPart)> {
        let nodal = grid.at_nodes.iter().map(|field| (field, true));
        let elemental = grid.in_elements.iter().map(|field| (field, false));
        let all = || nodal.clone().chain(elemental.clone());
        // A name may have a point of its own.
        let whole = all().find(|(field, _)| field.name == self.0);
        if let Some((field, is_nodal)) = whole {
            let part = FieldPart::named(None, field.components)?;
            return Some((field, is_nodal, part));
        }
        let (name, part) = self.0.rsplit_once('.')?;
        let (field, is_nodal) = all().find(|(field, _)| field.name == name)?;
        let part = FieldPart::named(Some(part), field.components)?;
        Some((field, is_nodal, part))
    }
}

impl FieldPart {
    /// Names of the parts of a field with a number of components; none of a scalar.
    pub fn names(components: usize) -> &'static [&'static str] {
        match components {
            3 => &VECTOR,
            6 => &[
                "greatest", "least", "mises", "xx", "yy", "zz", "xy", "yz", "zx",
            ],
            _ => &[],
        }
    }

    /// The part with a name, of a field with a number of components; without a name that of a scalar or a vector as a
    /// whole.
    fn named(name: Option<&str>, components: usize) -> Option<Self> {
        let component = |names: &[&str], name: &str| {
            let index = names.iter().position(|known| *known == name);
            index.map(Self::Component)
        };
        match (components, name) {
            (1 | 3, None) => Some(Self::Magnitude),
            (3, Some(name)) => component(&VECTOR, name),
            (6, Some("greatest")) => Some(Self::Greatest),
            (6, Some("least")) => Some(Self::Least),
            (6, Some("mises")) => Some(Self::Mises),
            (6, Some(name)) => component(&TENSOR, name),
            _ => None,
        }
    }

    /// The number of one group of components; NaN if one of them is.
    fn of(self, group: &[f64]) -> f64 {
        let tensor = || {
            <[f64; 6]>::try_from(group)
                .ok()
                .filter(|s| s.iter().all(|x| x.is_finite()))
        };
        match (self, group) {
            (Self::Magnitude, [value]) => *value,
            (Self::Magnitude, _) => group.iter().map(|x| x * x).sum::<f64>().sqrt(),
            (Self::Component(index), _) => group[index],
            (Self::Greatest | Self::Least | Self::Mises, _) => {
                let Some(stress) = tensor() else {
                    return f64::NAN;
                };
                let principal = principal_stresses(&Stress(stress));
                let [a, b, c] = principal;
                match self {
                    Self::Mises => {
                        (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt()
                    }
                    Self::Greatest => principal.into_iter().fold(f64::NEG_INFINITY, f64::max),
                    _ => principal.into_iter().fold(f64::INFINITY, f64::min),
                }
            }
        }
    }
}

/// Names of all quantities of a file.
fn available(grid: &VtuGrid) -> Vec<String> {
    let mut names = Vec::new();
    for field in grid.at_nodes.iter().chain(&grid.in_elements) {
        if matches!(field.components, 1 | 3) {
            names.push(field.name.clone());
        }
        let parts = FieldPart::names(field.components).iter();
        names.extend(parts.map(|part| format!("{}.{part}", field.name)));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts of a stress with known principal values: turned by 30 degrees about z, 5 and -3 in the plane, 1 out of it.
    #[test]
    fn parts_of_a_tensor_are_those_of_its_principal_values() {
        let (c, s) = (30_f64.to_radians().cos(), 30_f64.to_radians().sin());
        let stress = [
            5.0 * c * c - 3.0 * s * s,
            5.0 * s * s - 3.0 * c * c,
            1.0,
            8.0 * c * s,
            0.0,
            0.0,
        ];
        let of = |part: FieldPart| part.of(&stress);
        assert!((of(FieldPart::Greatest) - 5.0).abs() < 1e-12);
        assert!((of(FieldPart::Least) + 3.0).abs() < 1e-12);
        let mises = (0.5_f64 * (16.0 + 16.0 + 64.0)).sqrt();
        assert!((of(FieldPart::Mises) - mises).abs() < 1e-12);
        let named = |name| FieldPart::named(Some(name), 6);
        assert_eq!(named("yz"), Some(FieldPart::Component(4)));
        assert_eq!(FieldPart::named(None, 6), None);
        assert_eq!(
            FieldPart::named(Some("z"), 3),
            Some(FieldPart::Component(2))
        );
        assert_eq!(FieldPart::named(Some("z"), 1), None);
        assert_eq!(FieldPart::Magnitude.of(&[2.0, -3.0, 6.0]), 7.0);
        assert!(FieldPart::Mises.of(&[f64::NAN; 6]).is_nan());
    }
}
