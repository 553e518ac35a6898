//! In-situ stress of the ground.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use powerhouse_elements::WaterPressure;
use powerhouse_io::{IoError, TableColumn, read_table};
use powerhouse_model::{Mesh, ParameterError, Stress, StressField, Vec3};
use thiserror::Error;

/// Names of the stress components, in the order of [`Stress`].
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// In-situ stress of the ground before the first construction stage.
#[derive(Clone, Debug, PartialEq)]
pub enum InSituStress {
    /// Stress linear in depth, in each element that at its centroid.
    Field(StressField),
    /// Stress linear in depth from layer to layer, from the top downwards, each from its `surface` to that of the next,
    /// in each element that at its centroid; see [`layers`](Self::layers).
    Layers(Vec<StressField>),
    /// Stress of each element of the mesh (Pa), in mesh order.
    Elements(Vec<Stress>),
}

/// Layer of ground under its own weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightLayer {
    /// Height z of its lower end (m), below that of the layer above; that of the last layer does not count.
    pub bottom: f64,
    /// Weight per volume (N/m3), positive.
    pub unit_weight: f64,
    /// Ratios K0 of horizontal to vertical stress along x and y.
    pub lateral: [f64; 2],
}

impl InSituStress {
    /// The geostatic stress of horizontal layers below a height `level` (m), zero above: vertical stress is the weight of
    /// what lies above, horizontal stress its share in each layer.
    ///
    /// # Errors
    /// [`ParameterError`] of a layer, or of a lower end that is not below the upper one.
    pub fn layers(level: f64, layers: &[WeightLayer]) -> Result<Self, ParameterError> {
        Ok(Self::Layers(Self::fields_of(level, layers)?))
    }

    /// The stress of each layer.
    fn fields_of(level: f64, layers: &[WeightLayer]) -> Result<Vec<StressField>, ParameterError> {
        let (mut top, mut weight) = (level, 0.0);
        let mut fields = Vec::with_capacity(layers.len());
        for (index, layer) in layers.iter().enumerate() {
            let mut field = StressField::geostatic(top, layer.unit_weight, layer.lateral)?;
            let [x, y] = layer.lateral.map(|share| -share * weight);
            field.at_surface = Stress([x, y, -weight, 0.0, 0.0, 0.0]);
            fields.push(field);
            if index + 1 < layers.len() {
                ParameterError::check("bottom", layer.bottom, -f64::MAX, top.next_down())?;
                weight += layer.unit_weight * (top - layer.bottom);
                top = layer.bottom;
            }
        }
        Ok(fields)
    }

    /// The total geostatic stress of horizontal layers with water in their pores: vertical stress is the weight of what lies above,
    /// water included, and the ratios of the layers hold between effective stresses.
    ///
    /// # Errors
    /// As [`layers`](Self::layers).
    pub fn layers_in_water(
        level: f64,
        layers: &[WeightLayer],
        water: &WaterPressure,
    ) -> Result<Self, ParameterError> {
        // Layers are divided where the slope of the pressure changes.
        let bends = water.bends();
        let mut divided = Vec::with_capacity(layers.len() + bends.len());
        let mut top = level;
        for (index, layer) in layers.iter().enumerate() {
            let is_last = index + 1 == layers.len();
            for &bend in &bends {
                if bend < top && (is_last || layer.bottom < bend) {
                    divided.push(WeightLayer {
                        bottom: bend,
                        ..*layer
                    });
                    top = bend;
                }
            }
            divided.push(*layer);
            top = layer.bottom;
        }
        let mut fields = Self::fields_of(level, &divided)?;
        for (field, layer) in fields.iter_mut().zip(&divided) {
            // Pressure at the upper end of the layer, and its increase with depth; sigma = K0 (sigma_z + p) - p.
            let pressure = water.pressure(field.surface);
            let increase = -water.slope(field.surface);
            for (axis, share) in layer.lateral.into_iter().enumerate() {
                field.at_surface.0[axis] -= (1.0 - share) * pressure;
                field.gradient.0[axis] -= (1.0 - share) * increase;
            }
        }
        Ok(Self::Layers(fields))
    }

    /// Whether the vertical stress grows with depth; unknown, and `false`, of a table of elements.
    pub(crate) fn grows_with_depth(&self) -> bool {
        const VERTICAL: usize = 2;
        match self {
            Self::Field(field) => field.gradient.0[VERTICAL] != 0.0,
            Self::Layers(fields) => fields.iter().any(|field| field.gradient.0[VERTICAL] != 0.0),
            Self::Elements(_) => false,
        }
    }

    /// Height (m) above which the stress is zero; `None` where it ends nowhere.
    pub(crate) fn level(&self) -> Option<f64> {
        let first = match self {
            Self::Field(field) => field,
            Self::Layers(fields) => fields.first()?,
            Self::Elements(_) => return None,
        };
        first.ends.then_some(first.surface)
    }

    /// Reads the in-situ stress of every element of a mesh from a CSV table.
    ///
    /// Columns, in any order: `element [1]` (number in the mesh file), `xx [Pa]`, `yy [Pa]`, `zz [Pa]`, `xy [Pa]`,
    /// `yz [Pa]`, `zx [Pa]`, tension positive; kPa and MPa are also permitted.
    ///
    /// # Errors
    /// [`InSituError`] with the file and the column or element concerned.
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
        let index_of: HashMap<u64, usize> = tags.map(|(&tag, index)| (tag, index)).collect();
        let mut stresses = vec![None; mesh.element_count()];
        for (row, element) in elements.iter().enumerate() {
            let index = index_of.get(&(*element as u64));
            let known = index.filter(|_| element.fract() == 0.0 && *element >= 0.0);
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

    /// Stress of every element (Pa).
    pub(crate) fn of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        match self {
            Self::Field(field) => field.of_elements(mesh),
            Self::Layers(fields) => {
                let elements = 0..mesh.element_count() as u32;
                elements
                    .map(|element| {
                        let centre = mesh.centroid(element);
                        layer(fields, &centre).map_or(Stress::default(), |field| field.at(&centre))
                    })
                    .collect()
            }
            Self::Elements(stresses) => stresses.clone(),
        }
    }

    /// Increase of the stress per height (Pa/m) of every element; empty if it is given element by element.
    pub(crate) fn slopes_of_elements(&self, mesh: &Mesh) -> Vec<Stress> {
        match self {
            Self::Field(field) => field.slopes_of_elements(mesh),
            Self::Layers(fields) => {
                let elements = 0..mesh.element_count() as u32;
                elements
                    .map(|element| {
                        let centre = mesh.centroid(element);
                        layer(fields, &centre)
                            .map_or(Stress::default(), |field| field.slope_at(&centre))
                    })
                    .collect()
            }
            Self::Elements(_) => Vec::new(),
        }
    }
}

/// The layer that contains a point; none above the first.
fn layer<'a>(fields: &'a [StressField], point: &Vec3) -> Option<&'a StressField> {
    let mut below = fields.iter().rev();
    below.find(|field| point.z <= field.surface)
}

/// Values of a column in SI units.
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

/// Error of a table of in-situ stress.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InSituError {
    /// File that cannot be read, or is not a table.
    #[error(transparent)]
    Table(#[from] IoError),
    /// Column that is missing, or has a wrong unit.
    #[error(
        "{}: {}; expected are element [1] and xx, yy, zz, xy, yz, zx in [Pa], [kPa] or [MPa]",
        file.display(),
        match unit {
            Some(unit) => format!("the column '{name}' has the unit [{unit}]"),
            None => format!("there is no column '{name}'"),
        }
    )]
    Column {
        /// Path of the file.
        file: PathBuf,
        /// Name of the column.
        name: &'static str,
        /// Unit of the column; `None` if it is missing.
        unit: Option<String>,
    },
    /// Invalid row: its element is not in the mesh or is listed twice, or its stress is not finite.
    #[error("{}: element {element} {what}", file.display())]
    Element {
        /// Path of the file.
        file: PathBuf,
        /// Element number as written in the table.
        element: f64,
        /// Description of the fault, in words.
        what: &'static str,
    },
    /// Elements of the mesh without a row: every element needs one, also those that are cast later.
    #[error(
        "{}: {count} elements of the mesh have no stress, element {element} the first",
        file.display()
    )]
    Missing {
        /// Path of the file.
        file: PathBuf,
        /// Number of such elements.
        count: usize,
        /// Number of the first such element in the mesh file.
        element: u64,
    },
}
