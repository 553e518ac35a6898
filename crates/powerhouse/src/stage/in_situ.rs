//! The stress of the ground before the first stage.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use powerhouse_explicit_core::StressField;
use powerhouse_io::{IoError, TableColumn, read_table};
use powerhouse_model::{Mesh, Stress};
use thiserror::Error;

/// Components of a stress, in the order of [`Stress`].
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// The stress of the ground before the first stage.
#[derive(Clone, Debug, PartialEq)]
pub enum InSituStress {
    /// Linear in depth; each element has that at its centroid.
    Field(StressField),
    /// One for each element of the mesh (Pa).
    Elements(Vec<Stress>),
}

impl InSituStress {
    /// Reads the stress of every element of a mesh from a table with the columns `element [1]`,
    /// `xx [Pa]`, `yy [Pa]`, `zz [Pa]`, `xy [Pa]`, `yz [Pa]`, `zx [Pa]` in any order, tension
    /// positive; kPa and MPa are read, too. Elements have the numbers of the mesh file.
    ///
    /// # Errors
    /// [`InSituError`] names the file and the column or the element.
    pub fn read(file: &Path, mesh: &Mesh) -> Result<Self, InSituError> {
        let columns = read_table(file)?;
        let elements = column(file, &columns, "element", |unit| {
            (unit == "1").then_some(1.0)
        })?;
        let mut components = Vec::with_capacity(COMPONENTS.len());
        for name in COMPONENTS {
            components.push(column(file, &columns, name, |unit| match unit {
                "Pa" => Some(1.0),
                "kPa" => Some(1.0e3),
                "MPa" => Some(1.0e6),
                _ => None,
            })?);
        }
        let tags = mesh.element_tags().iter().zip(0_usize..);
        let place_of: HashMap<u64, usize> = tags.map(|(&tag, place)| (tag, place)).collect();
        let mut stresses = vec![None; mesh.element_count()];
        for (row, element) in elements.iter().enumerate() {
            let place = place_of.get(&(*element as u64));
            let known = place.filter(|_| element.fract() == 0.0 && *element >= 0.0);
            let fault = |what| InSituError::Element {
                file: file.into(),
                element: *element,
                what,
            };
            let own = &mut stresses[*known.ok_or_else(|| fault("is not in the mesh"))?];
            if own.is_some() {
                return Err(fault("is listed twice"));
            }
            let stress = Stress(core::array::from_fn(|i| components[i][row]));
            if !stress.0.iter().all(|component| component.is_finite()) {
                return Err(fault("has a stress that is not finite"));
            }
            *own = Some(stress);
        }
        let missing = stresses.iter().filter(|stress| stress.is_none()).count();
        let first = stresses.iter().position(Option::is_none);
        if let Some(first) = first {
            return Err(InSituError::Missing {
                file: file.into(),
                count: missing,
                element: mesh.element_tags()[first],
            });
        }
        Ok(Self::Elements(stresses.into_iter().flatten().collect()))
    }

    /// The stress (Pa) of every element.
    pub(crate) fn of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        match self {
            Self::Field(field) => field.of_elements(mesh),
            Self::Elements(stresses) => stresses.clone(),
        }
    }
}

/// The values of a column, in SI units.
fn column(
    file: &Path,
    columns: &[TableColumn],
    name: &'static str,
    factor: impl Fn(&str) -> Option<f64>,
) -> Result<Vec<f64>, InSituError> {
    let fault = |found: Option<&TableColumn>| InSituError::Column {
        file: file.into(),
        name,
        unit: found.map(|column| column.unit.clone()),
    };
    let column = columns.iter().find(|column| column.name == name);
    let column = column.ok_or_else(|| fault(None))?;
    let factor = factor(&column.unit).ok_or_else(|| fault(Some(column)))?;
    Ok(column.values.iter().map(|value| value * factor).collect())
}

/// A table that does not give the stress of the ground.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InSituError {
    /// A file that is no table.
    #[error(transparent)]
    Table(#[from] IoError),
    /// A column that is missing, or has another unit.
    #[error(
        "{}: {}; expected are element [1] and xx, yy, zz, xy, yz, zx in [Pa], [kPa] or [MPa]",
        file.display(),
        match unit {
            Some(unit) => format!("the column '{name}' has the unit [{unit}]"),
            None => format!("there is no column '{name}'"),
        }
    )]
    Column {
        /// The file.
        file: PathBuf,
        /// The column.
        name: &'static str,
        /// Its unit, if it is there.
        unit: Option<String>,
    },
    /// A row that cannot be.
    #[error("{}: element {element} {what}", file.display())]
    Element {
        /// The file.
        file: PathBuf,
        /// The number that stands in the file.
        element: f64,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Elements without a row.
    #[error(
        "{}: {count} elements of the mesh have no stress, element {element} the first",
        file.display()
    )]
    Missing {
        /// The file.
        file: PathBuf,
        /// How many.
        count: usize,
        /// The number of the first.
        element: u64,
    },
}
