//! Single-point test of a material along a strain or stress path, both read from files.

use core::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse_io::TableColumn;
#[cfg(feature = "pictures")]
use powerhouse_io::{Plot, PlotCurve, PlotPanel, write_plot, write_table};
use powerhouse_material_damage::{Control, PointDriver, PointState};
use powerhouse_model::{HistoryVariable, PointAdapter, Stress};
use powerhouse_observe::principal_stresses;
use serde::Deserialize;

use crate::Registry;
use crate::spec::{self, At, Finite, Positive};
use powerhouse_laws::Material;
use powerhouse_scene::{Error, Fault, Problem, SceneFault, SceneText};

/// Default number of steps of a leg.
const STEPS: usize = 100;
/// Largest number of steps of a path.
const MOST_STEPS: usize = 1_000_000;
/// Components of stress and strain, shears last.
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Strain and stress path of a single-point test, read from a file.
///
/// ```toml
/// size = 0.5                       # m, crack band width; 1 by default
/// initial_stress = [0, 0, 0, 0, 0, 0]   # Pa, xx yy zz xy yz zx; none by default
///
/// [[leg]]
/// kind = "uniaxial"                # along z, free sides
/// strain = 3e-4
/// steps = 200                      # 100 by default
/// ```
///
/// Legs are applied one after the other, each in equal steps from the current strain to its target; a path has at most
/// a million steps.
///
/// | kind | keys | loading |
/// |---|---|---|
/// | `uniaxial` | `strain` | a strain along z, free sides |
/// | `triaxial` | `lateral`, `strain` | a strain along z under a lateral stress (Pa) |
/// | `biaxial` | `strain` | equal strains along x and y, free along z |
/// | `plane-strain` | `lateral`, `strain` | a strain along z, none along y, a stress along x (Pa) |
/// | `simple-shear` | `strain`, `normal` | an engineering strain xy under three normal stresses (Pa), 0 by default |
/// | `cyclic` | `strains` | uniaxial, to each strain in turn |
/// | `mixed` | `xx` ... `zx` | each `{ strain = ... }` or `{ stress = ... }` (Pa); components that are not given keep their strain |
#[derive(Debug)]
pub struct PointPath {
    text: Arc<SceneText>,
    file: PathFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PathFile {
    size: Option<Positive>,
    initial_stress: Option<[Finite; 6]>,
    #[serde(rename = "leg")]
    legs: Vec<At<Leg>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum Leg {
    Uniaxial {
        strain: Finite,
        steps: Option<NonZeroUsize>,
    },
    Triaxial {
        lateral: Finite,
        strain: Finite,
        steps: Option<NonZeroUsize>,
    },
    Biaxial {
        strain: Finite,
        steps: Option<NonZeroUsize>,
    },
    PlaneStrain {
        lateral: Finite,
        strain: Finite,
        steps: Option<NonZeroUsize>,
    },
    SimpleShear {
        strain: Finite,
        normal: Option<[Finite; 3]>,
        steps: Option<NonZeroUsize>,
    },
    Cyclic {
        strains: Vec<Finite>,
        steps: Option<NonZeroUsize>,
    },
    Mixed(Box<Mixed>),
}

/// Prescribed strain or stress of each component.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mixed {
    xx: Option<At<Prescribed>>,
    yy: Option<At<Prescribed>>,
    zz: Option<At<Prescribed>>,
    xy: Option<At<Prescribed>>,
    yz: Option<At<Prescribed>>,
    zx: Option<At<Prescribed>>,
    steps: Option<NonZeroUsize>,
}

/// Prescribed value of one component: either strain or stress.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Prescribed {
    strain: Option<Finite>,
    stress: Option<Finite>,
}

impl Leg {
    /// Number of steps to each target.
    fn steps_to_target(&self) -> usize {
        let steps = match self {
            Self::Uniaxial { steps, .. }
            | Self::Triaxial { steps, .. }
            | Self::Biaxial { steps, .. }
            | Self::PlaneStrain { steps, .. }
            | Self::SimpleShear { steps, .. }
            | Self::Cyclic { steps, .. } => steps,
            Self::Mixed(mixed) => &mixed.steps,
        };
        steps.map_or(STEPS, NonZeroUsize::get)
    }

    /// Number of steps to all targets, or the largest number there is.
    fn steps(&self) -> usize {
        let targets = match self {
            Self::Cyclic { strains, .. } => strains.len(),
            _ => 1,
        };
        self.steps_to_target().saturating_mul(targets)
    }

    /// Targets of the leg in order, from the current strains.
    fn targets(&self, now: &PointState) -> Result<Vec<[Control; 6]>, Fault> {
        let target = match self {
            Self::Uniaxial { strain, .. } => Control::uniaxial(strain.get()),
            Self::Triaxial {
                lateral, strain, ..
            } => Control::triaxial(lateral.get(), strain.get()),
            Self::Biaxial { strain, .. } => Control::biaxial(strain.get()),
            Self::PlaneStrain {
                lateral, strain, ..
            } => Control::plane_strain(lateral.get(), strain.get()),
            Self::SimpleShear { strain, normal, .. } => {
                let normal = normal.map_or([0.0; 3], |normal| normal.map(Finite::get));
                Control::simple_shear(normal, strain.get())
            }
            Self::Cyclic { strains, .. } => {
                let strains = strains.iter();
                return Ok(strains
                    .map(|strain| Control::uniaxial(strain.get()))
                    .collect());
            }
            Self::Mixed(mixed) => {
                let Mixed {
                    xx,
                    yy,
                    zz,
                    xy,
                    yz,
                    zx,
                    ..
                } = &**mixed;
                let mut target = now.strain.0.map(Control::Strain);
                for (control, prescribed) in target.iter_mut().zip([xx, yy, zz, xy, yz, zx]) {
                    if let Some(prescribed) = prescribed {
                        *control = prescribed.control(prescribed.span())?;
                    }
                }
                target
            }
        };
        Ok(vec![target])
    }
}

impl Prescribed {
    fn control(&self, span: core::ops::Range<usize>) -> Result<Control, Fault> {
        match (self.strain, self.stress) {
            (Some(strain), None) => Ok(Control::Strain(strain.get())),
            (None, Some(stress)) => Ok(Control::Stress(stress.get())),
            (strain, stress) => {
                let keys = &["strain", "stress"];
                let found = usize::from(strain.is_some()) + usize::from(stress.is_some());
                Err(Fault::new(span, Problem::OneOf { keys, found }))
            }
        }
    }
}

impl PointPath {
    /// Reads the strain and stress path (loading path) of a single-point test from a TOML file.
    ///
    /// # Errors
    /// File that cannot be read, or a fault in it with line and column.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::from_toml(spec::read_text(path)?, path)
    }

    /// Strain and stress path of a text in TOML. `path` is used in messages.
    ///
    /// # Errors
    /// A fault in the text with line and column; a leg after which there are more than a million steps.
    pub fn from_toml(text: impl Into<String>, path: impl Into<PathBuf>) -> Result<Self, Error> {
        let text = Arc::new(SceneText {
            path: path.into(),
            text: text.into(),
        });
        let file = spec::decode_tagged(&text.text);
        let file: PathFile = file.map_err(|fault| SceneFault::new(text.clone(), fault))?;
        let mut steps = 0_usize;
        for leg in &file.legs {
            let before = steps;
            steps = steps.saturating_add(leg.steps());
            if steps > MOST_STEPS {
                let problem = Problem::Value {
                    found: format!("{} steps after {before}", leg.steps()),
                    expected: format!("at most {MOST_STEPS} steps in a path"),
                };
                return Err(SceneFault::new(text, Fault::new(leg.span(), problem)).into());
            }
        }
        Ok(Self { text, file })
    }

    /// Number of steps of all legs, at most a million.
    pub fn steps(&self) -> usize {
        self.file.legs.iter().map(|leg| leg.steps()).sum()
    }

    /// Computes the response of a material point along the path.
    ///
    /// # Errors
    /// Crack band width that the material rejects; [`PointError::Leg`] with the states until then for a target that is not
    /// reached, or a strain that is not finite.
    pub fn drive(&self, material: &Material) -> Result<PointTest, PointError> {
        let size = self.file.size.map_or(1.0, Positive::get);
        material.accept_size(size).map_err(Error::from)?;
        let initial = self
            .file
            .initial_stress
            .map_or([0.0; 6], |s| s.map(Finite::get));
        let law = PointAdapter::new(material.law().clone());
        let point = PointDriver::new(law).with_size(size);
        let point = point.and_then(|point| point.with_initial(Stress(initial)));
        let point = point.map_err(powerhouse_model::ModelError::from);
        let mut point = point.map_err(Error::from)?;
        let mut test = PointTest {
            law: material.name().into(),
            variables: material.history().to_vec(),
            records: vec![point.state().clone()],
        };
        for leg in &self.file.legs {
            let located = |fault| SceneFault::new(self.text.clone(), fault);
            let targets = leg
                .targets(point.state())
                .map_err(|fault| Error::from(located(fault)))?;
            for target in targets {
                let steps = leg.steps_to_target();
                if let Err(error) = point.advance_into(target, steps, &mut test.records) {
                    let fault = Box::new(located(Fault::refused(leg.span(), error)));
                    let test = Box::new(test);
                    return Err(PointError::Leg { fault, test });
                }
            }
        }
        Ok(test)
    }
}

impl Registry {
    /// Reads a material from a file with `[[material]]` tables, such as a scene. Without a name the file must have
    /// exactly one material.
    ///
    /// # Errors
    /// File that cannot be read, or a fault in it with line and column.
    pub fn material_of_file(
        &self,
        path: impl AsRef<Path>,
        name: Option<&str>,
    ) -> Result<Material, Error> {
        let path = path.as_ref();
        self.material_of_text(spec::read_text(path)?, path, name)
    }

    /// Material of a text in TOML with `[[material]]` tables, as [`material_of_file`](Self::material_of_file). `path` is used in
    /// messages.
    ///
    /// # Errors
    /// A fault in the text with line and column.
    pub fn material_of_text(
        &self,
        text: impl Into<String>,
        path: impl Into<PathBuf>,
        name: Option<&str>,
    ) -> Result<Material, Error> {
        let text = Arc::new(SceneText {
            path: path.into(),
            text: text.into(),
        });
        let found = spec::decode_materials(&text.text).and_then(|tables| {
            let available = || tables.iter().map(|table| table.name.to_string()).collect();
            let selected = match name {
                Some(name) => tables.iter().find(|table| *table.name == *name),
                None if tables.len() == 1 => tables.first(),
                None => None,
            };
            let table = selected.ok_or_else(|| {
                let problem = Problem::NoSuchName {
                    what: "single material, or one of the name",
                    name: name.unwrap_or_default().into(),
                    available: available(),
                };
                Fault::new(0..0, problem)
            })?;
            self.material(table)
        });
        Ok(found.map_err(|fault| SceneFault::new(text, fault))?)
    }
}

/// Error of a single-point test.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// Path or material that cannot be tested.
    #[error(transparent)]
    Scene(#[from] Error),
    /// Leg whose target is not reached.
    #[error("{fault}")]
    Leg {
        /// Cause, at the leg.
        fault: Box<SceneFault>,
        /// Response until then.
        test: Box<PointTest>,
    },
}

/// Result of a single-point test: response of a material point along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTest {
    /// Name of the law.
    pub law: String,
    /// Names, units and kinds of the history variables of the law; empty for a law without any.
    pub variables: Vec<HistoryVariable>,
    /// State at the start and after every step.
    pub records: Vec<PointState>,
}

impl PointTest {
    /// Table of strains, stresses, principal stresses, work and history variables against steps.
    pub fn columns(&self) -> Vec<TableColumn> {
        let column = |name: String, unit: &str, value: &dyn Fn(&PointState) -> f64| {
            TableColumn::new(name, unit, self.records.iter().map(value).collect())
        };
        let steps = (0..self.records.len()).map(|step| step as f64).collect();
        let mut columns = vec![TableColumn::new("step", "1", steps)];
        for (i, component) in COMPONENTS.iter().enumerate() {
            columns.push(column(format!("strain {component}"), "1", &|r| {
                r.strain.0[i]
            }));
        }
        for (i, component) in COMPONENTS.iter().enumerate() {
            columns.push(column(format!("stress {component}"), "Pa", &|r| {
                r.stress.0[i]
            }));
        }
        for i in 0..3 {
            let name = format!("principal stress {}", i + 1);
            columns.push(column(name, "Pa", &|r| principal_stresses(&r.stress)[i]));
        }
        columns.push(column("work".into(), "J/m3", &|r| r.work));
        for (i, variable) in self.variables.iter().enumerate() {
            columns.push(column(variable.name.into(), variable.unit, &|r| {
                r.history[i]
            }));
        }
        columns
    }

    /// Index of the component with the largest product of peak strain and peak stress; a free side may strain more
    /// than the loaded axis.
    fn component(&self) -> usize {
        let reach = |i: usize| {
            let greatest = |number: fn(&PointState, usize) -> f64| {
                let numbers = self.records.iter().map(|record| number(record, i).abs());
                numbers.fold(0.0, f64::max)
            };
            greatest(|record, i| record.strain.0[i]) * greatest(|record, i| record.stress.0[i])
        };
        (0..6)
            .rev()
            .max_by(|&a, &b| reach(a).total_cmp(&reach(b)))
            .unwrap_or(0)
    }

    /// Name of the component with the largest product of peak strain and peak stress, and its least and greatest
    /// stress (Pa).
    pub fn extremes(&self) -> (&'static str, [f64; 2]) {
        let i = self.component();
        let stresses = self.records.iter().map(|record| record.stress.0[i]);
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        let extremes = stresses.fold(start, |[low, high], s| [low.min(s), high.max(s)]);
        (COMPONENTS[i], extremes)
    }

    /// Writes the table to `point.csv` and a plot to `point.svg`, and returns both paths. The plot shows stress
    /// against strain of the component of [`extremes`](Self::extremes) and, below it, the accumulated history
    /// variables. With the feature `pictures`.
    ///
    /// # Errors
    /// File that could not be written.
    #[cfg(feature = "pictures")]
    pub fn write(&self, folder: &Path) -> Result<[PathBuf; 2], Error> {
        let files = [folder.join("point.csv"), folder.join("point.svg")];
        let columns = self.columns();
        write_table(&files[0], &columns)?;
        let i = self.component();
        let (strain, stress) = (&columns[1 + i], &columns[7 + i]);
        fn curve<'a>(strain: &'a TableColumn, column: &'a TableColumn) -> PlotCurve<'a> {
            PlotCurve {
                name: &column.name,
                x: &strain.values,
                y: &column.values,
            }
        }
        let panel = |unit: &str, curves| PlotPanel {
            label: String::new(),
            unit: unit.into(),
            curves,
        };
        let mut panels = vec![panel("Pa", vec![curve(strain, stress)])];
        let amounts = self.variables.iter().zip(&columns[17..]);
        let amounts = amounts.filter(|(variable, column)| {
            variable.kind == powerhouse_model::HistoryKind::Amount
                && column.values.iter().any(|v| *v != 0.0)
        });
        let amounts: Vec<PlotCurve> = amounts.map(|(_, column)| curve(strain, column)).collect();
        if !amounts.is_empty() {
            panels.push(panel("1", amounts));
        }
        let plot = Plot {
            title: self.law.clone(),
            label: strain.name.clone(),
            unit: "1".into(),
            panels,
            gaps: Vec::new(),
        };
        write_plot(&files[1], &plot)?;
        Ok(files)
    }
}
