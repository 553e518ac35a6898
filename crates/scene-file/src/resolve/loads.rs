//! Supports, loads and functions of time from scene files.

use super::draft::Draft;
use std::collections::BTreeMap;

use powerhouse_elements::{FacePressure, FaceTraction, NodalForce, Profile};
use powerhouse_model::{
    Constant, Facet, NodalLoad, PeriodicPairs, Prescribed, Support, Table, TimeFunction, Vec3,
};
use powerhouse_wavefield::{BaselineCorrection, QuietStartLimits, Signal};

use super::record::{PreparedRecord, cut_short};
use super::{Names, named, one_of, vector};
use crate::spec::{self, At, Finite, Function, Load, Positive, water_weight};
use powerhouse_scene::internal::{GRAVITY, StagedLoad};
use powerhouse_scene::{
    DelayedError, Fault, InitialMotion, Mirror, Parity, Problem, Remark, remark,
};

/// Matching tolerance of the nodes of periodic faces, over the diagonal of the mesh.
const PERIODIC_TOLERANCE: f64 = 1e-6;
/// Least ratio of vector area to total area of a face that counts as plane: cosine of about a degree.
const PLANE: f64 = 0.999_85;

pub(super) fn supports(
    names: &Names,
    supports: &[At<spec::Support>],
    records: &BTreeMap<String, PreparedRecord>,
    scene: &mut Draft,
) -> Result<(), Fault> {
    let arrivals = arrivals(supports, records, scene)?;
    for support in supports {
        match &**support {
            spec::Support::Fixed { set } => {
                scene.supports.push(Support::fixed(names.nodes(set)?));
            }
            spec::Support::Roller { set, normal } => {
                let normal = match normal {
                    Some(normal) => direction(normal)?,
                    None => mean_normal(names, set)?,
                };
                scene
                    .supports
                    .push(Support::roller(names.nodes(set)?, normal));
            }
            spec::Support::Symmetry { set, normal } => {
                mirror(
                    names,
                    (support, set, normal.as_ref()),
                    Parity::Symmetric,
                    scene,
                )?;
            }
            spec::Support::Antisymmetry { set, normal } => {
                let plane = (support, set, normal.as_ref());
                mirror(names, plane, Parity::Antisymmetric, scene)?;
            }
            spec::Support::Periodic { from, to } => {
                scene.periodic.push(paired(names, from, to)?);
            }
            // They are known before the waves are.
            spec::Support::Delayed { .. } => {}
            spec::Support::Prescribed {
                set,
                direction: along,
                displacement,
                record,
                function,
            } => {
                let displacement = match (displacement, record) {
                    (Some(displacement), None) => {
                        history(function.as_ref(), displacement.get(), support)?
                    }
                    (None, Some(record)) => {
                        let factor = history(function.as_ref(), 1.0, support)?;
                        let prepared = named("record", record, records)?;
                        let arrival = arrivals.padding - prepared.lead;
                        let remark = cut_short(record, prepared, arrival, scene);
                        scene.remarks.extend(remark);
                        of_record(record, factor, prepared, &arrivals)?
                    }
                    (displacement, record) => {
                        let found = [displacement.is_some(), record.is_some()];
                        return Err(one_of(support.span(), &["displacement", "record"], &found));
                    }
                };
                let nodes = names.nodes(set)?;
                let tag = |&node: &u32| names.mesh.node_tags()[node as usize];
                let tags = nodes.iter().map(tag).collect();
                scene.places.prescribed.push((along.span(), tags));
                let prescribed = Prescribed {
                    nodes,
                    direction: direction(along)?,
                    displacement,
                };
                scene.prescribed.push(prescribed.into());
            }
        }
    }
    Ok(())
}

/// Takes the delayed ends of a scene, which must be normal to y and may not absorb.
pub(super) fn delayed_ends(
    names: &Names,
    file: &spec::SceneSpec,
    scene: &mut Draft,
) -> Result<(), Fault> {
    for support in &file.supports {
        let spec::Support::Delayed { from, to } = &**support else {
            continue;
        };
        let refused = |error| Err(Fault::refused(support.span(), error));
        if scene.delayed.is_some() {
            return refused(DelayedError::Twice);
        }
        let pairs = paired(names, from, to)?;
        if let Some(&(a, b)) = pairs.pairs.first() {
            let at = names.mesh.positions();
            let apart = at[b as usize] - at[a as usize];
            let (low, high) = names.mesh.bounding_box();
            if apart.x.hypot(apart.z) > PERIODIC_TOLERANCE * (high - low).norm() {
                return refused(DelayedError::NotAlong {
                    from: from.to_string(),
                    to: to.to_string(),
                    apart: apart.into(),
                });
            }
        }
        scene.scene.delayed = Some(pairs);
        scene.places.delayed = support.span();
    }
    for face in file.boundary.iter().flat_map(|section| &section.faces) {
        let checked = scene.check_absorbing_end(face);
        checked.map_err(|error| Fault::refused(face.span(), error))?;
    }
    Ok(())
}

/// Pairs of the nodes of two sets, the second the first one, translated.
fn paired(names: &Names, from: &At<String>, to: &At<String>) -> Result<PeriodicPairs, Fault> {
    let (from_nodes, to_nodes) = (names.nodes(from)?, names.nodes(to)?);
    let (low, high) = names.mesh.bounding_box();
    let tolerance = PERIODIC_TOLERANCE * (high - low).norm();
    let pairs = PeriodicPairs::by_translation(names.mesh, &from_nodes, &to_nodes, tolerance);
    pairs.map_err(|error| Fault::refused(to.span(), error))
}

/// Symmetry plane: its table, its set, and its normal if given.
type Plane<'f> = (
    &'f At<spec::Support>,
    &'f At<String>,
    Option<&'f At<[Finite; 3]>>,
);

fn mirror(
    names: &Names,
    (table, set, normal): Plane,
    parity: Parity,
    scene: &mut Draft,
) -> Result<(), Fault> {
    let normal = match normal {
        Some(normal) => direction(normal)?,
        None => mean_normal(names, set)?,
    };
    let nodes = names.nodes(set)?;
    let mirror = Mirror {
        nodes,
        normal,
        parity,
    };
    scene.supports.extend(mirror.supports());
    scene.mirrors.push(mirror);
    scene.places.mirrors.push(table.span());
    Ok(())
}

/// Vector that is not zero.
pub(super) fn direction(at: &At<[Finite; 3]>) -> Result<Vec3, Fault> {
    let vector = vector(at);
    if vector.norm() > 0.0 {
        return Ok(vector);
    }
    let (found, expected) = ("a zero vector".into(), "a direction".into());
    Err(Fault::new(at.span(), Problem::Value { found, expected }))
}

/// Arrival of the records of prescribed motions.
struct Arrivals {
    /// Start of the run (s).
    start: f64,
    /// Delay of all records (s), so that the body starts at rest.
    padding: f64,
}

impl Arrivals {
    /// Time of the record (s), with its lead (s), at the start of the run.
    fn first(&self, record: &PreparedRecord) -> f64 {
        self.start + record.lead - self.padding
    }
}

/// Displacement of a record, multiplied by a function. A filtered record begins before its original start; if it has
/// begun at the start of the run, it is multiplied by a smooth ramp.
fn of_record(
    name: &At<String>,
    factor: Box<dyn TimeFunction>,
    record: &PreparedRecord,
    arrivals: &Arrivals,
) -> Result<Box<dyn TimeFunction>, Fault> {
    let signal = record.signal(1.0);
    let signal = signal.map_err(|error| Fault::refused(name.span(), error))?;
    let ahead = record.lead - arrivals.padding;
    let displacement = move |t: f64| factor.value(t) * signal.motion(t + ahead).displacement;
    let (start, easing) = (arrivals.start, easing(record));
    if easing == 0.0 || arrivals.first(record) <= 0.0 {
        return Ok(Box::new(displacement));
    }
    Ok(Box::new(move |t: f64| {
        let x = ((t - start) / easing).clamp(0.0, 1.0);
        displacement(t) * (x * x * x * (10.0 + x * (6.0 * x - 15.0)))
    }))
}

/// Duration of the ramp (s) of a record that has begun at the start of the run: half a period of the filter's corner
/// frequency, zero for a record without filter.
fn easing(record: &PreparedRecord) -> f64 {
    match record.baseline.map(|report| report.correction) {
        Some(BaselineCorrection::HighPass { corner, .. }) => 0.5 / corner,
        _ => 0.0,
    }
}

/// Arrival of the records of prescribed motions: the common delay with which the leads of their filters are below the
/// threshold of a quiet start, as of waves, until the end of the ramp. A delay is added to the remarks.
fn arrivals(
    supports: &[At<spec::Support>],
    records: &BTreeMap<String, PreparedRecord>,
    scene: &mut Draft,
) -> Result<Arrivals, Fault> {
    let threshold = QuietStartLimits::default().threshold;
    let (mut padding, mut levels) = (0.0_f64, BTreeMap::new());
    for support in supports {
        let spec::Support::Prescribed {
            record: Some(name), ..
        } = &**support
        else {
            continue;
        };
        let record = named("record", name, records)?;
        if record.lead == 0.0 || scene.initial == InitialMotion::Field {
            continue;
        }
        let signal = record.signal(1.0);
        let signal = signal.map_err(|error| Fault::refused(name.span(), error))?;
        let report = record.report;
        let level = |time: f64| {
            let motion = signal.motion(time);
            let over = |value: f64, peak: f64| {
                if value == 0.0 {
                    0.0
                } else {
                    (value / peak).abs()
                }
            };
            over(motion.displacement, report.peak_displacement)
                .max(over(motion.velocity, report.peak_velocity))
        };
        let (start, easing) = (scene.start + record.lead, easing(record));
        if level(start + easing) >= threshold {
            levels.insert(name.to_string(), level(start));
        }
        // The shortest delay such that all longer ones are quiet; with the longest one no record has begun.
        let step = record.history.step();
        let count = (start.max(0.0) / step).ceil() as usize;
        let quiet = |i: &usize| level(start + easing - step * *i as f64) < threshold;
        let delay = (0..=count).rev().take_while(quiet).last();
        padding = padding.max(step * delay.unwrap_or(count) as f64);
    }
    if padding > 0.0 {
        let waves = scene.remarks.iter().find_map(|remark| match remark {
            Remark::QuietStart(remark::QuietStart { padding, .. }) => Some(*padding),
            _ => None,
        });
        let has_waves = scene.field.is_some();
        scene.remarks.push(Remark::from(remark::DelayedMotion {
            padding,
            records: levels.into_iter().collect(),
            waves: has_waves.then(|| waves.unwrap_or(0.0)),
        }));
    }
    let start = scene.start;
    Ok(Arrivals { start, padding })
}

/// Mean outward normal of a plane facet set.
pub(super) fn mean_normal(names: &Names, set: &At<String>) -> Result<Vec3, Fault> {
    if names.mesh.facet_set(set).is_err() && names.mesh.node_set(set).is_ok() {
        let key = "normal".into();
        return Err(Fault::new(set.span(), Problem::MissingKey { key }));
    }
    let facets = names.facets(set)?;
    if facets.is_empty() {
        let problem = Problem::Value {
            found: "a set without facets".into(),
            expected: "a plane face with facets; the mesh may have been cut off there".into(),
        };
        return Err(Fault::new(set.span(), problem));
    }
    let facets = facets.iter();
    let areas = facets.map(|&facet| names.mesh.facet_geometry(facet).vector_area);
    let areas: Vec<Vec3> = areas.collect();
    let mean = areas.iter().sum::<Vec3>();
    let all: f64 = areas.iter().map(Vec3::norm).sum();
    if mean.norm() >= PLANE * all && all > 0.0 {
        return Ok(mean);
    }
    let problem = Problem::Value {
        found: "facets with different normals".into(),
        expected: "a plane face, or the key 'normal'".into(),
    };
    Err(Fault::new(set.span(), problem))
}

/// Load on a body: forces at nodes, or an acceleration of all masses (m/s2).
pub(super) enum LoadOrWeight {
    Load(StagedLoad),
    Weight(Vec3, Box<dyn TimeFunction>),
}

pub(super) fn loads(names: &Names, loads: &[At<Load>], scene: &mut Draft) -> Result<(), Fault> {
    let facets = |set: &At<String>| names.facets(set).map(<[Facet]>::to_vec);
    for table in loads {
        match load(names, table, &facets)? {
            LoadOrWeight::Load(load) => scene.loads.push(load),
            LoadOrWeight::Weight(acceleration, history) => {
                scene.weights.push((acceleration, history.into()));
            }
        }
    }
    Ok(())
}

/// Function that resolves the name of a facet set.
type FacetsOf<'f> = dyn Fn(&At<String>) -> Result<Vec<Facet>, Fault> + 'f;

/// Load of a scene table; `facets` resolves its facet set.
pub(super) fn load(
    names: &Names,
    load: &At<Load>,
    facets: &FacetsOf,
) -> Result<LoadOrWeight, Fault> {
    let history = |factor: f64| history(load.function(), factor, load);
    let refused = |error| {
        let set = load.set().map_or(load.span(), At::span);
        Fault::refused(set, error)
    };
    let removed_in = load.removed_in().map(|name| name.to_string());
    let load: Box<dyn NodalLoad> = match &**load {
        Load::Gravity { acceleration, .. } => {
            let acceleration = acceleration.map_or(GRAVITY, Positive::get);
            let downwards = Vec3::new(0.0, 0.0, -acceleration);
            return Ok(LoadOrWeight::Weight(downwards, history(1.0)?));
        }
        Load::Pressure { set, pressure, .. } => {
            let history = history(pressure.get())?;
            let load = FacePressure::new(names.mesh, &facets(set)?, Profile::Uniform, history);
            Box::new(load.map_err(refused)?)
        }
        Load::Water {
            set,
            level,
            density,
            ..
        } => {
            let profile = Profile::Depth {
                gradient: water_weight(*density),
                level: level.get(),
            };
            let load = FacePressure::new(names.mesh, &facets(set)?, profile, history(1.0)?);
            Box::new(load.map_err(refused)?)
        }
        Load::Traction {
            set,
            traction,
            level,
            ..
        } => {
            let profile = level.map_or(Profile::Uniform, |level| Profile::Depth {
                gradient: 1.0,
                level: level.get(),
            });
            let (facets, traction) = (facets(set)?, vector(traction));
            let history = history(1.0)?;
            let load = FaceTraction::new(names.mesh, &facets, traction, profile, history);
            Box::new(load.map_err(refused)?)
        }
        Load::Nodal { set, force, .. } => {
            let load = NodalForce::new(names.nodes(set)?, vector(force), history(1.0)?);
            Box::new(load)
        }
    };
    Ok(LoadOrWeight::Load(StagedLoad::new(load, removed_in)))
}

/// Function of time multiplied by a factor.
fn history<T>(
    function: Option<&Function>,
    factor: f64,
    table: &At<T>,
) -> Result<Box<dyn TimeFunction>, Fault> {
    use core::f64::consts::{PI, TAU};
    Ok(match function {
        None | Some(Function::Constant {}) => Box::new(Constant(factor)),
        Some(Function::Ramp { duration }) => {
            let duration = duration.get();
            Box::new(move |t: f64| factor * (t / duration).clamp(0.0, 1.0))
        }
        Some(Function::Sine { frequency }) => {
            let rate = TAU * frequency.get();
            Box::new(move |t: f64| factor * (rate * t).sin())
        }
        Some(Function::Ricker { frequency, delay }) => {
            let (rate, delay) = (PI * frequency.get(), delay.get());
            Box::new(move |t: f64| {
                let a = (rate * (t - delay)).powi(2);
                factor * (1.0 - 2.0 * a) * (-a).exp()
            })
        }
        Some(Function::Table { times, values }) => {
            let times: Vec<f64> = times.iter().copied().map(Finite::get).collect();
            let values: Vec<f64> = values.iter().map(|v| factor * v.get()).collect();
            let table = Table::new(&times, &values).map_err(|_| {
                Fault::new(
                    table.span(),
                    Problem::Value {
                        found: format!("{} times and {} values", times.len(), values.len()),
                        expected: "a table with as many values as times, which must increase"
                            .into(),
                    },
                )
            })?;
            Box::new(table)
        }
    })
}
