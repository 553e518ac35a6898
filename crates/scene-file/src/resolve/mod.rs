//! Composition of a scene from its file: resolves names into sets, materials, fields and loads.

mod added_mass;
mod damping;
mod draft;
mod equivalent_linear;
mod ground;
mod joints;
mod layers;
mod loads;
mod mesh;
mod motion;
mod origin;
mod output;
pub(crate) mod pore_water;
mod record;
mod stages;
mod stations;
mod target;
mod unused;
mod water_warning;

use std::collections::{BTreeMap, BTreeSet};

use powerhouse_model::{Axis, Facet, Mesh, MeshError, Vec3};

use crate::spec::{self, Allowance, At, Finite, Load, NonNegative, Registered, SceneSpec};
use crate::{CheckpointPlan, Registry, keys, registry};
use powerhouse_laws::Material;
use powerhouse_scene::internal::{Leapfrog, NamedThing, OneSided, sets_with};
use powerhouse_scene::{
    Boundary, Error, Fault, InitialMotion, Magnitude, MagnitudeOf, Part, Problem, Remark,
    SampledRequest, Scene, SceneText, TimeStep, remark,
};

pub(crate) use draft::Draft;
pub use mesh::read_mesh;
pub(crate) use record::processed_records;
pub(crate) use target::target_spectrum;

/// Composes the scene of a file.
pub(crate) fn compose(
    (text, registry): (&SceneText, &Registry),
    file: &SceneSpec,
    registered: Registered,
) -> Result<Draft, Fault> {
    let mut materials = materials(file, registered.materials)?;
    let parts = parts(file, &materials, registry)?;
    let records = record::records(text, file, registry)?;
    let (mesh, of_mesh, in_use) = mesh::mesh(text, file, registry)?;
    check_rims(&mesh, file)?;
    let (mesh, joints) = joints::joints(mesh, &file.joints, registered.joint_laws)?;
    let names = Names {
        mesh: &mesh,
        layer: file.mesh.slice.as_ref().map(|slice| slice.across),
    };
    check_parts(&names, file)?;
    check_kernels(&names, file, &parts)?;

    let scene = Scene::new(file.title.clone(), mesh.clone());
    let mut scene = Draft::new(scene, registry.known_waves.clone());
    scene.parts = parts;
    scene.magnitudes_allowed = (file.allow.iter()).any(|a| **a == Allowance::Magnitudes);
    scene.places.mesh = file.mesh.file.span();
    scene.remarks.extend(of_mesh);
    scene.in_use = in_use;
    // Checked before points are located in a mesh of a wrong size.
    let of_mesh = |(_, of): &(Magnitude, MagnitudeOf)| *of == MagnitudeOf::Mesh;
    let unusual = scene.unusual_magnitudes().into_iter().find(of_mesh);
    if let (Some((magnitude, _)), false) = (unusual, scene.magnitudes_allowed) {
        return Err(Fault::of_magnitude(file.mesh.file.span(), magnitude));
    }
    scene.joints = joints;
    scene.start = file.time.start.as_ref().map_or(0.0, |start| start.get());
    scene.duration = file.time.duration.get();
    scene.initial = *file.time.initial;
    scene.step = match *file.time.step {
        spec::Step::Auto => TimeStep::OfStable(file.time.safety.map_or(1.0, |s| s.get())),
        spec::Step::Seconds(step) => TimeStep::Seconds(step),
    };
    for set in file.time.fibres.sets() {
        names.elements(set)?;
    }
    scene.fibres = file.time.fibres.options().map(|mut options| {
        let limit = file.time.fibre_shift.map(|limit| limit.get());
        options.most_shift = limit.unwrap_or(options.most_shift);
        options
    });
    scene.integrator = match *file.time.scheme {
        spec::Scheme::Leapfrog => Box::new(Leapfrog),
        spec::Scheme::OneSided => Box::new(OneSided),
    };
    scene.precision = file.precision;
    scene.residual = file.energy_residual;
    scene.places.step = file.time.step.span();
    scene.places.scheme = file.time.scheme.span();
    let of_waves = file.waves.iter().map(|wave| wave.incidence.span());
    let of_motions = file.motions.iter().map(|motion| motion.incidence.span());
    let first = of_waves.chain(of_motions).next().unwrap_or(0..0);
    let start = file.time.start.as_ref();
    scene.places.start = start.map_or(first.clone(), At::span);
    scene.places.field = first;
    scene.self_check = file.self_check.as_ref().map(|limit| limit.get());
    if let (Some(section), Some(condition)) = (&file.boundary, registered.boundary) {
        for face in &section.faces {
            names.facets(face)?;
        }
        scene.places.boundary = section.kind.span();
        let first = section.faces.first();
        scene.places.faces = first.map_or(section.kind.span(), At::span);
        let region = match &section.region {
            Some(region) => {
                scene.places.region = region.span();
                Some(self::region(&names, section, region)?)
            }
            None => None,
        };
        scene.boundary = Some(Boundary {
            condition,
            faces: section.faces.iter().map(|face| face.to_string()).collect(),
            scatterer: section.scatterer.as_ref().map(|at| vector(at)),
            through: section.through.iter().map(|set| set.to_string()).collect(),
            region,
        });
        if let Some(first) = section.through.first() {
            let checked = scene.check_through();
            checked.map_err(|error| Fault::refused(first.span(), error))?;
        }
    }
    for (name, record) in &records {
        scene
            .places
            .records
            .insert(name.clone(), record.name.clone());
        scene.records.insert(name.clone(), record.history.clone());
        scene.remarks.push(Remark::from(remark::Record {
            name: name.clone(),
            report: record.report,
            baseline: record.baseline,
        }));
        if let Some(key) = record.weak {
            scene.remarks.push(Remark::from(remark::WeakRecord {
                name: name.clone(),
                peak: record.report.peak_acceleration,
                key,
            }));
        }
        scene.remarks.extend(record.source.clone().map(|source| {
            let name = name.clone();
            Remark::from(remark::RecordSource { name, source })
        }));
        scene.remarks.extend(record.spectrum.clone().map(|report| {
            let name = name.clone();
            Remark::from(remark::RecordSpectrum {
                name,
                report: Box::new(report),
            })
        }));
        scene.remarks.extend(record::large_correction(name, record));
        for warning in &record.warnings {
            scene.remarks.push(Remark::from(remark::RecordFile {
                name: name.clone(),
                warning: warning.clone(),
            }));
        }
    }
    scene.remarks.extend(unused::records(file));
    scene.remarks.extend(unused::materials(file));
    pore_water::check_heights(&mesh, file, &materials)?;
    scene
        .remarks
        .extend(pore_water::waters(&mesh, file, &materials));
    let warnings = water_warning::warnings(&mesh, file, &materials, &scene.parts)?;
    scene.remarks.extend(warnings);
    scene.remarks.extend(empty_sets(&names, file));
    loads::delayed_ends(&names, file, &mut scene)?;
    let of_layers = equivalent_linear::apply(file, &mut scene, &records, &mut materials)?;
    scene = ground::field((text, file), scene, &records, &materials, &of_layers)?;
    damping::default_rims(file, &mut scene)?;
    if scene.initial == InitialMotion::Field && scene.field.is_none() {
        return Err(Fault::refused(file.time.initial.span(), Error::NoField));
    }
    scene.threads = file.threads.as_ref().map(|threads| threads.get());
    loads::supports(&names, &file.supports, &records, &mut scene)?;
    if let Some(section) = &file.boundary {
        let long = long_body(file, section, &scene);
        scene.remarks.extend(long);
    }
    loads::loads(&names, &file.loads, &mut scene)?;
    added_mass::added_masses(&names, &file.added_masses, &mut scene)?;
    stages::stages(text, &names, file, &materials, &mut scene)?;
    let lacking = scene.lacking_ground();
    scene.remarks.extend(lacking);
    scene.output = output::plan(
        &names,
        &file.output,
        &scene.joints,
        file.time.duration.get(),
    )?;
    for (request, output) in file.output.own.iter().zip(&registered.outputs) {
        let sampler =
            output(&mesh).map_err(|error| registry::placed(&request.parameters, error))?;
        let request = SampledRequest::new(request.name.to_string(), sampler);
        scene.output.sampled.push(request);
    }
    scene.checkpoints = checkpoints(&file.checkpoint, &scene)?;
    check_names(file)?;
    let materials = file.parts.iter();
    let materials = materials.map(|part| (part.set.to_string(), part.material.span()));
    scene.places.materials = materials.collect();
    let rims = file.parts.iter().filter_map(|part| {
        let rim = part.elastic_rim.as_ref()?;
        Some((part.set.to_string(), rim.span()))
    });
    scene.places.rims = rims.collect();
    [scene.places.cuts, scene.places.reinforcements] = output::places(&file.output);
    let histories = file.output.histories.iter().map(|history| &history.name);
    let relative = file.output.relative.iter().map(|relative| &relative.name);
    let own = file.output.own.iter().map(|own| &own.name);
    let named = histories.chain(relative).chain(own);
    scene.places.histories = named.map(|name| (name.to_string(), name.span())).collect();
    Ok(scene)
}

/// Checkpoints that a scene requests.
fn checkpoints(file: &spec::Checkpoint, scene: &Draft) -> Result<CheckpointPlan, Fault> {
    let (start, end) = (scene.start, scene.start + scene.duration);
    for time in &file.keep {
        if time.get() <= start || time.get() >= end {
            let problem = Problem::Value {
                found: format!("{}", time.get()),
                expected: format!(
                    "a time (s) after the start of the run, {start}, and before its end, {end}"
                ),
            };
            return Err(Fault::new(time.span(), problem));
        }
    }
    let mut plan = CheckpointPlan::default().with_keep(file.keep.iter().map(|time| time.get()));
    plan.every = file.every.map(|every| every.0);
    Ok(plan)
}

/// Checks that the first of two numbers is below the second.
fn ordered(span: core::ops::Range<usize>, [low, high]: [f64; 2]) -> Result<(), Fault> {
    if low < high {
        Ok(())
    } else {
        Err(Fault::new(
            span,
            Problem::Value {
                found: format!("[{low}, {high}]"),
                expected: "two numbers, the lower one first".into(),
            },
        ))
    }
}

/// Warnings about empty sets of supports, loads and added masses, as of a part of the mesh that was cut off.
fn empty_sets(names: &Names, file: &SceneSpec) -> Vec<Remark> {
    let of_stages = || file.stages.iter();
    let supports = (file.supports.iter().flat_map(|support| support.sets()))
        .chain(of_stages().flat_map(|stage| stage.supports.iter().map(|support| support.set())));
    let loads = file
        .loads
        .iter()
        .chain(of_stages().flat_map(|stage| &stage.loads));
    let has_no_nodes = |set: &At<String>| names.nodes(set).is_ok_and(|nodes| nodes.is_empty());
    let is_idle = |load: &&At<Load>| match (&***load, load.set()) {
        (_, None) => false,
        (Load::Nodal { .. }, Some(set)) => has_no_nodes(set),
        (_, Some(set)) => names.facets(set).is_ok_and(|facets| facets.is_empty()),
    };
    let of_supports = supports.filter(|set| has_no_nodes(set));
    let of_loads = loads.filter(is_idle).filter_map(|load| load.set());
    let of_masses = file.added_masses.iter().map(|mass| mass.set());
    let of_masses = of_masses.filter(|set| names.facets(set).is_ok_and(|facets| facets.is_empty()));
    let empty: BTreeSet<String> = of_supports
        .chain(of_loads)
        .chain(of_masses)
        .map(|set| set.to_string())
        .collect();
    let remarks = empty
        .into_iter()
        .map(|set| Remark::from(remark::EmptySet { set }));
    remarks.collect()
}

/// Warning about springs for spherical spreading on a model of a long body: a slice, or a body between periodic ends or
/// rollers on two opposite sides.
fn long_body(file: &SceneSpec, section: &spec::BoundarySection, scene: &Draft) -> Option<Remark> {
    if *section.kind != keys::VISCOUS_SPRING {
        return None;
    }
    let spreading = section.parameters.get(keys::SPREADING);
    let is_cylindrical = spreading.is_some_and(|spreading| spreading == keys::CYLINDRICAL.into());
    let ends = match &file.mesh.slice {
        Some(_) => Some("a slice"),
        None => scene.repeated_by(),
    };
    let remark = |ends| Remark::from(remark::SphericalSpreading { ends });
    ends.filter(|_| !is_cylindrical).map(remark)
}

fn materials(file: &SceneSpec, made: Vec<Material>) -> Result<BTreeMap<String, Material>, Fault> {
    let mut materials = BTreeMap::new();
    for (table, material) in file.materials.iter().zip(made) {
        let level = table.pore_water.as_ref().and_then(|water| {
            let level = water
                .level
                .as_ref()
                .map(|level| (level.span(), "a water level"));
            let table = water.pressures.as_ref();
            level.or(table.map(|table| (table.span(), "pressures of water")))
        });
        if let (Some((span, what)), None) = (level, &file.in_situ_stress) {
            let problem = Problem::Value {
                found: format!("{what} in a scene without [in_situ_stress]"),
                expected: "an in-situ stress of total stresses, from which the pressure of the water is taken, or no level"
                    .into(),
            };
            return Err(Fault::new(span, problem));
        }
        unique("material", &table.name, &mut materials, material)?;
    }
    Ok(materials)
}

fn parts(
    file: &SceneSpec,
    materials: &BTreeMap<String, Material>,
    registry: &Registry,
) -> Result<Vec<Part>, Fault> {
    file.parts
        .iter()
        .map(|table| {
            let material = named("material", &table.material, materials)?;
            let mut part = Part::new(table.set.to_string(), material.clone());
            if let Some(kernel) = &table.kernel {
                part = part.with_kernel(registry.kernel(kernel)?.clone());
            }
            let span = match &table.damping {
                Some(own) => {
                    part = part.with_damping(damping::damping(own)?);
                    part = part.with_high_damping(damping::high(own));
                    own.span()
                }
                None => {
                    if file.has_field() {
                        part = part.with_damping(material.default_damping().clone());
                    }
                    table.material.span()
                }
            };
            let moving = part.moving_material();
            moving.map_err(|error| Fault::refused(span, error))?;
            if let Some(rim) = &table.elastic_rim {
                part = part.with_rim(rim.get());
            }
            Ok(part)
        })
        .collect()
}

/// Elements of a domain reduction region. Waves enter around it, so that an `input` of the boundary is an error.
fn region(
    names: &Names,
    section: &spec::BoundarySection,
    region: &At<spec::Region>,
) -> Result<Vec<u32>, Fault> {
    let (input, nothing) = (
        section.parameters.span_of("input"),
        section.parameters.span_of(""),
    );
    if input != nothing {
        return Err(one_of(input, &["input", "region"], &[true, true]));
    }
    match (&region.set, region.corners) {
        (Some(set), None) => Ok(names.elements(set)?.to_vec()),
        (None, Some([low, high])) => {
            let (low, high) = (vector(&low), vector(&high));
            Ok(names.mesh.elements_in_box(&low, &high))
        }
        (set, corners) => {
            let given = [set.is_some(), corners.is_some()];
            Err(one_of(region.span(), &["set", "box"], &given))
        }
    }
}

/// Checks that every element belongs to exactly one part; bars may belong to none.
fn check_parts(names: &Names, file: &SceneSpec) -> Result<(), Fault> {
    let mesh = names.mesh;
    let mut owners = vec![0_usize; mesh.element_count()];
    for part in &file.parts {
        for &element in names.elements(&part.set)? {
            owners[element as usize] += 1;
            if owners[element as usize] > 1 {
                return Err(part_count((mesh, file), part.set.span(), element, 2));
            }
        }
    }
    let mut elements = 0..mesh.element_count() as u32;
    let unassigned = |&e: &u32| owners[e as usize] == 0 && mesh.kind(e).is_solid();
    match (elements.find(unassigned), file.parts.last()) {
        (Some(element), Some(part)) => Err(part_count((mesh, file), part.set.span(), element, 0)),
        _ => Ok(()),
    }
}

/// Checks that all names of results can be names of files, and that no two have the same file.
fn check_names(file: &SceneSpec) -> Result<(), Fault> {
    let output = &file.output;
    let joints = file.joints.iter().map(|j| (NamedThing::Joint, &j.name));
    let bolts = file
        .bolts
        .iter()
        .map(|bolts| (NamedThing::Bolts, &bolts.name));
    let stages = file.stages.iter().map(|s| (NamedThing::Stage, &s.name));
    let histories = output.histories.iter().map(|history| &history.name);
    let relative = output.relative.iter().map(|relative| &relative.name);
    let sections = output.sections.iter().map(|section| &section.name);
    let own = output.own.iter().map(|own| &own.name);
    let results = histories.chain(relative).chain(sections).chain(own);
    let results = results.map(|name| (NamedThing::Result, name));
    let zones = output
        .joints
        .iter()
        .map(|j| (NamedThing::JointZone, &j.name));
    let named: Vec<(NamedThing, &At<String>)> = joints
        .chain(bolts)
        .chain(stages)
        .chain(results)
        .chain(zones)
        .collect();
    let names = named.iter().map(|(what, name)| (*what, name.as_str()));
    let checked = powerhouse_scene::internal::check_names(names);
    checked.map_err(|(index, error)| Fault::refused(named[index].1.span(), error))
}

/// Checks that no rim is wider than the body.
fn check_rims(mesh: &Mesh, file: &SceneSpec) -> Result<(), Fault> {
    let rims = file
        .parts
        .iter()
        .filter_map(|part| part.elastic_rim.as_ref());
    for rim in rims {
        check_reach(mesh, (NonNegative::get(**rim), rim.span()))?;
    }
    Ok(())
}

/// Checks that a distance is not larger than the diagonal of the mesh.
fn check_reach(mesh: &Mesh, (distance, span): (f64, core::ops::Range<usize>)) -> Result<(), Fault> {
    let (low, high) = mesh.bounding_box();
    let diagonal = (high - low).norm();
    if distance <= diagonal {
        return Ok(());
    }
    let found = format!("{distance} m");
    let expected = format!("at most the diagonal of the body, {diagonal:.4} m");
    Err(Fault::new(span, Problem::Value { found, expected }))
}

/// Checks that every element has a kernel, and that every kernel is for an element of its part.
fn check_kernels(names: &Names, file: &SceneSpec, parts: &[Part]) -> Result<(), Fault> {
    for (part, table) in parts.iter().zip(&file.parts) {
        let elements = names.elements(&table.set)?;
        let kinds = elements.iter().map(|&element| names.mesh.kind(element));
        if let (Some(kernel), Some(at)) = (part.unused_kernel(kinds), &table.kernel) {
            let (set, kernel) = (part.set.clone(), kernel.name().into());
            return Err(Fault::refused(
                at.span(),
                Error::UnusedKernel { set, kernel },
            ));
        }
        let unserved = |&&element: &&u32| part.kernel_for(names.mesh.kind(element)).is_none();
        if let Some(&element) = elements.iter().find(unserved) {
            let error = Error::NoKernel {
                element: names.mesh.element_tags()[element as usize],
                set: part.set.clone(),
                kind: names.mesh.kind(element).name(),
            };
            return Err(Fault::refused(table.set.span(), error));
        }
    }
    Ok(())
}

fn part_count(
    (mesh, file): (&Mesh, &SceneSpec),
    span: core::ops::Range<usize>,
    element: u32,
    count: usize,
) -> Fault {
    let parts = file.parts.iter().map(|part| part.set.as_str());
    let sets = sets_with(mesh, element, parts, count);
    let element = mesh.element_tags()[element as usize];
    let problem = Problem::PartCount {
        element,
        count,
        sets,
    };
    Fault::new(span, problem)
}

/// Resolver of the set names and numbers of a mesh.
struct Names<'m> {
    mesh: &'m Mesh,
    /// Axis across which the mesh is one layer of another one.
    layer: Option<Axis>,
}

impl<'m> Names<'m> {
    fn elements(&self, name: &At<String>) -> Result<&'m [u32], Fault> {
        self.mesh
            .element_set(name)
            .map_err(|e| no_such_set(name, e))
    }
    fn facets(&self, name: &At<String>) -> Result<&'m [Facet], Fault> {
        self.mesh.facet_set(name).map_err(|e| no_such_set(name, e))
    }
    /// Checks that a node number exists.
    fn node(&self, number: &At<u64>) -> Result<(), Fault> {
        if self.mesh.node_tags().contains(number) {
            return Ok(());
        }
        Err(no_such_number("node", number))
    }
    /// Nodes of a node, facet or element set.
    fn nodes(&self, name: &At<String>) -> Result<Vec<u32>, Fault> {
        self.mesh
            .nodes_of_set(name)
            .map_err(|e| no_such_set(name, e))
    }
}

fn no_such_set(name: &At<String>, error: MeshError) -> Fault {
    let problem = match error {
        MeshError::NoSuchSet {
            what, available, ..
        } => Problem::NoSuchName {
            what: match what {
                "element" => "element set",
                "facet" => "facet set",
                "node" => "node set",
                _ => "node, facet or element set",
            },
            name: name.to_string(),
            available,
        },
        other => Problem::Refused(other.into()),
    };
    Fault::new(name.span(), problem)
}

fn no_such_number(what: &'static str, number: &At<u64>) -> Fault {
    let name = number.to_string();
    let available = Vec::new();
    let problem = Problem::NoSuchName {
        what,
        name,
        available,
    };
    Fault::new(number.span(), problem)
}

fn named<'m, T>(
    what: &'static str,
    name: &At<String>,
    items: &'m BTreeMap<String, T>,
) -> Result<&'m T, Fault> {
    let unknown = || name.unknown(what, items.keys().cloned().collect());
    items.get(name.as_str()).ok_or_else(unknown)
}

fn unique<T>(
    what: &'static str,
    name: &At<String>,
    items: &mut BTreeMap<String, T>,
    item: T,
) -> Result<(), Fault> {
    match items.insert(name.to_string(), item) {
        None => Ok(()),
        Some(_) => Err(name.duplicate(what)),
    }
}

/// Fault of keys of which exactly one must be given.
fn one_of(span: core::ops::Range<usize>, keys: &'static [&'static str], given: &[bool]) -> Fault {
    let found = given.iter().filter(|given| **given).count();
    Fault::new(span, Problem::OneOf { keys, found })
}

fn vector(numbers: &[Finite; 3]) -> Vec3 {
    Vec3::from(numbers.map(Finite::get))
}
