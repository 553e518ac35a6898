//! Loads and incident fields that are functions in Python.

use std::sync::Arc;

use numpy::{PyArray2, PyArrayMethods};
use powerhouse::model::{
    ElasticMedium, FieldMotion, FieldSampler, IncidentField, ModelError, NodalLoad, Stress, Vec3,
};
use powerhouse::{Error, FileScene};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::alarm::Alarm;
use crate::arrays::{components, of_rows};

/// A function in Python that a scene calls.
#[derive(Clone)]
pub(crate) enum Function {
    /// Forces (N) at the nodes of a set, as a function of time (s) and of the positions of the nodes (m).
    Load {
        set: String,
        function: Arc<Py<PyAny>>,
    },
    /// Motion of the free field, as a function of time (s) and of points (m).
    Field {
        medium: ElasticMedium,
        function: Arc<Py<PyAny>>,
    },
}

impl Function {
    /// Adds the function to a scene.
    pub(crate) fn add_to(&self, scene: FileScene, alarm: &Arc<Alarm>) -> Result<FileScene, Error> {
        let alarm = alarm.clone();
        match self {
            Self::Load { set, function } => {
                let mesh = scene.mesh().clone();
                let nodes = mesh.nodes_of_set(set)?;
                let at = nodes.iter().map(|node| mesh.positions()[*node as usize]);
                let points = components(at);
                let load = Load {
                    name: format!("function on '{set}'"),
                    nodes,
                    calls: Calls::new(function.clone(), points, alarm),
                };
                Ok(scene.map(|scene| scene.load(load)))
            }
            Self::Field { medium, function } => {
                let field = Field {
                    medium: *medium,
                    function: function.clone(),
                    alarm,
                };
                Ok(scene.map(|scene| scene.with_field(field)))
            }
        }
    }
}

/// A function of time and points.
struct Calls {
    function: Arc<Py<PyAny>>,
    /// Coordinates of the points (m), one after the other, and as an array when there is one.
    points: Vec<f64>,
    array: std::sync::OnceLock<Py<PyArray2<f64>>>,
    alarm: Arc<Alarm>,
}

impl Calls {
    fn new(function: Arc<Py<PyAny>>, points: Vec<f64>, alarm: Arc<Alarm>) -> Self {
        Self {
            function,
            points,
            array: std::sync::OnceLock::new(),
            alarm,
        }
    }

    /// What the function returns at a time (s), read by `read`; nothing after an exception.
    fn at<T>(&self, time: f64, read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>) -> Option<T> {
        self.alarm.watch(|py| {
            let points = match self.array.get() {
                Some(points) => points,
                None => {
                    let array = of_rows(py, self.points.clone(), 3)?.unbind();
                    self.array.get_or_init(|| array)
                }
            };
            let found = self.function.call1(py, (time, points))?;
            read(found.bind(py))
        })
    }
}

/// Numbers of an array of rows of `width`, or of one row for all.
pub(crate) fn numbers(
    value: &Bound<'_, PyAny>,
    (rows, width): (usize, usize),
    what: &str,
) -> PyResult<Vec<f64>> {
    let py = value.py();
    let shaped = py
        .import("numpy")?
        .call_method1("broadcast_to", (value, (rows, width)))
        .and_then(|array| {
            py.import("numpy")?
                .call_method1("ascontiguousarray", (array, "float64"))
        });
    let array = shaped.map_err(|error| {
        let text = format!(
            "{what}: {error}; expected an array of {rows} x {width} numbers, or one row for all"
        );
        PyValueError::new_err(text)
    })?;
    let found = array
        .cast_into::<PyArray2<f64>>()?
        .readonly()
        .as_slice()?
        .to_vec();
    match found.iter().position(|value| !value.is_finite()) {
        None => Ok(found),
        Some(place) => Err(PyValueError::new_err(format!(
            "{what}: {} of row {} is not finite",
            found[place],
            place / width
        ))),
    }
}

fn vector(numbers: &[f64]) -> Vec3 {
    Vec3::new(numbers[0], numbers[1], numbers[2])
}

/// A load whose forces a function returns.
struct Load {
    name: String,
    nodes: Vec<u32>,
    calls: Calls,
}

impl NodalLoad for Load {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        let shape = (self.nodes.len(), 3);
        let read = |found: &Bound<'_, PyAny>| numbers(found, shape, "forces (N)");
        if let Some(found) = self.calls.at(time, read) {
            for (force, own) in forces.iter_mut().zip(found.chunks_exact(3)) {
                *force += vector(own);
            }
        }
    }
}

/// A free field whose motion a function returns.
struct Field {
    medium: ElasticMedium,
    function: Arc<Py<PyAny>>,
    alarm: Arc<Alarm>,
}

impl IncidentField for Field {
    fn name(&self) -> &str {
        "function"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        let at = components(points.iter().copied());
        Ok(Box::new(Sampler {
            count: points.len(),
            calls: Calls::new(self.function.clone(), at, self.alarm.clone()),
        }))
    }
}

struct Sampler {
    count: usize,
    calls: Calls,
}

impl FieldSampler for Sampler {
    fn len(&self) -> usize {
        self.count
    }
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let count = self.count;
        let read = |found: &Bound<'_, PyAny>| {
            let (displacement, velocity, stress): (
                Bound<'_, PyAny>,
                Bound<'_, PyAny>,
                Bound<'_, PyAny>,
            ) = found.extract()?;
            Ok([
                numbers(&displacement, (count, 3), "displacement (m)")?,
                numbers(&velocity, (count, 3), "velocity (m/s)")?,
                numbers(&stress, (count, 6), "stress (Pa)")?,
            ])
        };
        let Some([displacement, velocity, stress]) = self.calls.at(time, read) else {
            return;
        };
        for (index, motion) in motion.iter_mut().take(count).enumerate() {
            let stress = &stress[6 * index..6 * index + 6];
            *motion += FieldMotion {
                displacement: vector(&displacement[3 * index..]),
                velocity: vector(&velocity[3 * index..]),
                stress: Stress(core::array::from_fn(|i| stress[i])),
            };
        }
    }
}
