//! Constitutive laws that are functions in Python, evaluated for all points of an element block at once.

use std::collections::BTreeMap;
use std::sync::Arc;

use numpy::PyArray2;
use powerhouse::model::{
    BlockLaw, BlockLawInput, ElasticMedium, HistoryVariable, Stress, interned,
};
use powerhouse::schemars::JsonSchema;
use powerhouse::{Material, Registry};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use serde::Deserialize;

use crate::alarm::Alarm;
use crate::arrays::{of_list, of_rows, stresses};
use crate::functions::numbers;

/// A law under the name that materials of a scene give.
#[derive(Clone)]
pub(crate) struct Law {
    pub(crate) name: String,
    function: Arc<Py<PyAny>>,
    variables: Vec<HistoryVariable>,
    locations: bool,
    /// Changes with the function, so that finished cases of sweeps are run again.
    version: String,
}

/// Keys of a material with a law of Python.
#[derive(Deserialize, JsonSchema)]
#[schemars(crate = "powerhouse::schemars")]
#[serde(deny_unknown_fields)]
struct Keys {
    /// Young's modulus of the undamaged material (Pa).
    young: f64,
    /// Poisson's ratio (1).
    poisson: f64,
    /// Density (kg/m3).
    density: f64,
    /// Parameters of the function, by name.
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
}

impl Law {
    /// A law by its name, function, history variables (name and unit), whether it uses locations, and its version.
    pub(crate) fn new(
        name: String,
        (function, version): (Py<PyAny>, String),
        history: Vec<(String, String)>,
        locations: bool,
    ) -> Self {
        let variables = history.iter();
        let variables =
            variables.map(|(name, unit)| HistoryVariable::amount(interned(name), interned(unit)));
        Self {
            variables: variables.collect(),
            function: Arc::new(function),
            name,
            locations,
            version,
        }
    }
}

/// Registers laws, of which an exception raises the alarm.
pub(crate) fn register(mut registry: Registry, laws: &[Law], alarm: &Arc<Alarm>) -> Registry {
    if laws.is_empty() {
        return registry;
    }
    for law in laws {
        let (of_name, alarm) = (law.clone(), alarm.clone());
        registry.add_law(&law.name, move |keys: Keys| {
            Ok(Material::from_block_law(Evaluated {
                medium: ElasticMedium::new(keys.young, keys.poisson, keys.density)?,
                parameters: keys.parameters,
                law: of_name.clone(),
                alarm: alarm.clone(),
            }))
        });
    }
    let versions = laws
        .iter()
        .map(|law| format!("{} {}", law.name, law.version));
    registry.with_version(versions.collect::<Vec<String>>().join(", "))
}

/// A law with the parameters of a material.
struct Evaluated {
    law: Law,
    medium: ElasticMedium,
    parameters: BTreeMap<String, f64>,
    alarm: Arc<Alarm>,
}

/// Integration points at which a law in Python is evaluated; the arrays are read-only.
#[pyclass(frozen, get_all, module = "powerhouse_fe")]
pub(crate) struct LawPoints {
    /// Total strain (1), one row for a point: xx, yy, zz, xy, yz, zx, engineering shears.
    strain: Py<PyArray2<f64>>,
    /// Initial stress (Pa), likewise.
    initial_stress: Py<PyArray2<f64>>,
    /// Committed history variables by name, one value for a point.
    history: Py<PyDict>,
    /// Widths of the element along x, y and z (m), one row for a point.
    widths: Py<PyArray2<f64>>,
    /// Positions (m), one row for a point; none unless the law asks for them.
    positions: Option<Py<PyArray2<f64>>>,
    /// Parameters of the material by name.
    parameters: Py<PyDict>,
}

#[pymethods]
impl LawPoints {
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.strain.bind(py).len()
    }
}

/// Values of a history variable at points.
fn column(points: &BlockLawInput, variable: usize) -> Vec<f64> {
    (0..points.len())
        .map(|point| points.history_of(point)[variable])
        .collect()
}

impl Evaluated {
    fn arguments(&self, py: Python<'_>, points: &BlockLawInput) -> PyResult<LawPoints> {
        let history = PyDict::new(py);
        for (index, variable) in self.law.variables.iter().enumerate() {
            history.set_item(variable.name, of_list(py, column(points, index)))?;
        }
        let parameters = PyDict::new(py);
        for (name, value) in &self.parameters {
            parameters.set_item(name, value)?;
        }
        let strains = points.strains.iter().flat_map(|strain| strain.0);
        let widths = points.extents.iter().flat_map(|extents| {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| extents.along(&axis))
        });
        let positions = points.positions.as_flattened();
        Ok(LawPoints {
            strain: of_rows(py, strains.collect(), 6)?.unbind(),
            initial_stress: of_rows(py, stresses(points.initial), 6)?.unbind(),
            history: history.unbind(),
            widths: of_rows(py, widths.collect(), 3)?.unbind(),
            positions: if self.law.locations {
                Some(of_rows(py, positions.to_vec(), 3)?.unbind())
            } else {
                None
            },
            parameters: parameters.unbind(),
        })
    }

    /// Stress and new history variables from what the function returned.
    fn read(
        &self,
        found: &Bound<'_, PyAny>,
        stresses: &mut [Stress],
        new_history: &mut [f64],
    ) -> PyResult<()> {
        let py = found.py();
        let (name, variables) = (&self.law.name, &self.law.variables);
        let shape = (stresses.len(), 6);
        let mut history = None;
        let stress = if variables.is_empty() {
            found.clone()
        } else {
            let pair = found.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
            let pair = pair.ok_or_else(|| {
                PyTypeError::new_err(format!(
                    "law '{name}': expected a tuple of stress and a dictionary of history variables"
                ))
            })?;
            history = Some(pair.get_item(1)?);
            pair.get_item(0)?
        };
        let stress = numbers(&stress, shape, &format!("law '{name}', stress (Pa)"))?;
        for (stress, row) in stresses.iter_mut().zip(stress.as_chunks::<6>().0) {
            *stress = Stress(*row);
        }
        for (index, variable) in variables.iter().enumerate() {
            let what = format!("law '{name}', history variable '{}'", variable.name);
            let value = history
                .as_ref()
                .map(|history| history.get_item(variable.name));
            let value = value.and_then(Result::ok).ok_or_else(|| {
                PyValueError::new_err(format!("{what} is missing in what the function returns"))
            })?;
            // One value for a point, as a column.
            let numpy = py.import("numpy")?;
            let value = numpy.call_method1("atleast_1d", (value,))?;
            let values = numpy.call_method1("expand_dims", (value, -1))?;
            let values = numbers(&values, (shape.0, 1), &what)?;
            let places = new_history.iter_mut().skip(index).step_by(variables.len());
            for (place, value) in places.zip(values) {
                *place = value;
            }
        }
        Ok(())
    }
}

impl BlockLaw for Evaluated {
    fn name(&self) -> &str {
        &self.law.name
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &self.law.variables
    }
    fn uses_location(&self) -> bool {
        self.law.locations
    }
    fn stress_changes(
        &self,
        points: &BlockLawInput,
        stresses: &mut [Stress],
        new_history: &mut [f64],
    ) {
        let found = self.alarm.watch(|py| {
            let arguments = self.arguments(py, points)?;
            let found = self.law.function.call1(py, (arguments,))?;
            self.read(found.bind(py), stresses, new_history)
        });
        if found.is_none() {
            // The run ends at once, and its alarm has the reason.
            stresses.fill(Stress([f64::NAN; 6]));
            new_history.copy_from_slice(points.history);
        }
    }
}
