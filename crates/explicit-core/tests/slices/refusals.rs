//! What slices do not take is refused by name.

use std::sync::Arc;

use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, ExplicitOnDevice, Model, RankModel};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{
    AddedMass, BlockOptions, BoundaryParts, Constant, Constraint, ConstraintWork, DelayedPairs,
    DeviceError, ElementBlock, ElementKind, EmbeddedElements, Engine, EngineError, ExtraBlock,
    Fibre, Mat3, Mesh, ModelError, ModelSpec, NodalImpedance, PeriodicPairs, Precision,
    PredictedMotion, Prescribed, Rayleigh, RunError, StepDevice, StepDevices, Support, ThreadRanks,
    Vec3,
};
use powerhouse_wavefield::{PlaneWave, WaveKind};

use super::{pairs, rock, slowness, spec, wave};
use crate::support::Links;

const ANGLES: [f64; 2] = [25.0, 50.0];

fn small() -> Mesh {
    let (low, high) = (Vec3::new(-60.0, -2.0, -60.0), Vec3::new(60.0, 2.0, 0.0));
    Mesh::box_of_hexes(low, high, [12, 1, 6], "rock").unwrap()
}

fn field() -> PlaneWave {
    wave(WaveKind::SV, ANGLES, (8.0, 0.2))
}

/// The slice before anything is wrong with it.
fn sound(mesh: &Mesh) -> ModelSpec<'_> {
    let own = slowness(WaveKind::SV, ANGLES);
    spec(mesh, SolidKernel::Hex8Full, &field(), own).unwrap()
}

/// The same of other pairs.
fn paired(mesh: &Mesh, pairs: Vec<(u32, u32)>, slowness: f64) -> ModelSpec<'_> {
    sound(mesh).delayed(DelayedPairs {
        pairs,
        slowness,
        ..DelayedPairs::default()
    })
}

/// A specification as often as wanted.
type Specs<'a> = Box<dyn Fn() -> ModelSpec<'a> + 'a>;

fn specs(mesh: &Mesh, pairs: Vec<(u32, u32)>, slowness: f64) -> Specs<'_> {
    Box::new(move || paired(mesh, pairs.clone(), slowness))
}

/// The same with other options of its elements.
fn with_options(mesh: &Mesh, options: BlockOptions) -> ModelSpec<'_> {
    let mut spec = sound(mesh);
    spec.sets.clear();
    let law = LinearElastic::new(rock());
    spec.elements("rock", SolidKernel::Hex8Full.factory("rock", law, options))
}

/// The same with a matrix as dashpot or spring of a node.
fn absorbing(mesh: &Mesh, spring: Mat3, dashpot: Mat3) -> ModelSpec<'_> {
    let impedance = NodalImpedance::new(0, spring, dashpot);
    sound(mesh).boundary(BoundaryParts::default().with_impedance([impedance]))
}

/// A constraint of two nodes that changes nothing.
struct Glue;

impl Constraint for Glue {
    fn name(&self) -> &str {
        "glue"
    }
    fn nodes(&self) -> &[u32] {
        &[0, 1]
    }
    fn correct(&mut self, _motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        Ok(ConstraintWork::default())
    }
}

/// Embedded elements of which there are none.
struct Bolts;

impl EmbeddedElements for Bolts {
    fn name(&self) -> &str {
        "bolts"
    }
    fn hosts(&self) -> Vec<Option<u32>> {
        Vec::new()
    }
    fn block_of(&self, _units: &[usize]) -> Box<dyn ElementBlock> {
        unreachable!("there are no bolts")
    }
}

/// A block of one brick beyond the mesh.
fn beyond(mesh: &Mesh) -> ExtraBlock {
    let law = LinearElastic::new(rock());
    let factory = SolidKernel::Hex8Full.factory("rock", law, BlockOptions::default());
    let nodes = mesh.nodes_of_elements(&[0]);
    let part = powerhouse_model::BlockPart::new(mesh, &[0], &nodes);
    ExtraBlock {
        nodes: Vec::new(),
        block: factory.build(&part).unwrap(),
    }
}

/// Two pairs of nodes joined by bars along x and one that goes across from the front to the back.
fn skewed() -> Mesh {
    let mut builder = Mesh::builder();
    for (tag, [x, y]) in (1..).zip([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]) {
        builder.node(tag, Vec3::new(x, y, 0.0));
    }
    for (tag, ends) in (1..).zip([[1, 3], [2, 4], [1, 4]]) {
        builder.element(tag, ElementKind::Bar2, &ends, &["bars"]);
    }
    builder.build().unwrap()
}

fn bars(mesh: &Mesh) -> ModelSpec<'_> {
    let links = Links::new("bars", ElementKind::Bar2, 9.0e9, 0.5, 2700.0);
    Model::builder(mesh)
        .elements("bars", links.boxed())
        .delayed(DelayedPairs {
            pairs: vec![(0, 1), (2, 3)],
            slowness: 1e-5,
            ..DelayedPairs::default()
        })
}

/// Every specification that a slice does not take is refused with the name of what is wrong and with a way out.
#[test]
fn a_slice_refuses_what_it_does_not_take() {
    type Case<'a> = (&'a str, &'a str, Specs<'a>);
    let (mesh, skewed) = (small(), skewed());
    let (mesh, skewed) = (&mesh, &skewed);
    let own = slowness(WaveKind::SV, ANGLES);
    let all = pairs(mesh);
    let (mut fewer, mut twice, mut crossed) = (all.clone(), all.clone(), all.clone());
    fewer.pop();
    twice.push(all[0]);
    (crossed[0].1, crossed[1].1) = (crossed[1].1, crossed[0].1);
    let mut unknown = all.clone();
    unknown[0].0 = 9999;
    let lead = all[0].0;
    let oblique = Vec3::new(1.0, 0.0, 1.0);
    let across = (Vec3::x() + Vec3::y()) * (Vec3::x() + Vec3::y()).transpose() * 1e5;
    let (damped, mixed) = {
        let [mut damped, mut mixed] = [BlockOptions::default(); 2];
        damped.damping = Rayleigh {
            mass: 0.0,
            stiffness: 1e-4,
        };
        mixed.precision = Precision::Mixed;
        (damped, mixed)
    };
    let with_pairs = |pairs: Vec<(u32, u32)>, slowness: f64| specs(mesh, pairs, slowness);
    let cases: Vec<Case> = vec![
        ("in 0 delayed pairs", "in one", with_pairs(fewer, own)),
        ("in 2 delayed pairs", "in one", with_pairs(twice, own)),
        ("a delayed pair", "9999", with_pairs(unknown, own)),
        (
            "not apart by (0, 4, 0) m",
            "translated along y",
            with_pairs(crossed, own),
        ),
        ("must be finite", "NaN", with_pairs(all.clone(), f64::NAN)),
        (
            "share of the mass",
            "s/m is possible: take the sine of the incidence at most 0.",
            with_pairs(all.clone(), 0.999 / rock().p_speed()),
        ),
        (
            "along no coordinate axis",
            "rollers normal to",
            Box::new(|| sound(mesh).support(Support::roller(vec![lead], oblique))),
        ),
        (
            "other periodic pairs",
            "absorb at the sides",
            Box::new(|| {
                sound(mesh).periodic(PeriodicPairs {
                    pairs: vec![all[0]],
                })
            }),
        ),
        (
            "added masses",
            "leave the water",
            Box::new(|| sound(mesh).added_masses([AddedMass::new(lead, Mat3::identity())])),
        ),
        (
            "take joints",
            "bond what they divide",
            Box::new(|| sound(mesh).constraint(Box::new(Glue))),
        ),
        (
            "take bolts",
            "leave them out",
            Box::new(|| sound(mesh).embed(Box::new(Bolts))),
        ),
        (
            "prescribed motions",
            "absorbing faces",
            Box::new(|| {
                sound(mesh).prescribed(Prescribed {
                    nodes: vec![lead],
                    direction: Vec3::x(),
                    displacement: Box::new(Constant(0.0)),
                })
            }),
        ),
        (
            "boundaries with elements",
            "viscous-spring",
            Box::new(|| sound(mesh).boundary(BoundaryParts::default().with_blocks([beyond(mesh)]))),
        ),
        (
            "stiffness damping of set 'rock'",
            "mass damping",
            Box::new(move || with_options(mesh, damped)),
        ),
        (
            "set 'rock' in single or mixed precision",
            "double precision",
            Box::new(move || with_options(mesh, mixed)),
        ),
        (
            "an impedance at node 1 between y and x",
            "parallel to y",
            Box::new(|| absorbing(mesh, Mat3::zeros(), across)),
        ),
        (
            "an impedance at node 1 between y and x",
            "parallel to y",
            Box::new(|| absorbing(mesh, across, Mat3::zeros())),
        ),
        (
            "set 'bars', whose elements couple motion along y",
            "isotropic laws",
            Box::new(|| bars(skewed)),
        ),
    ];
    sound(mesh).build().unwrap();
    let missed = cases.into_iter().filter_map(|(what, way, spec)| {
        let found = spec()
            .build()
            .err()
            .map_or_else(String::new, |error| error.to_string());
        let is_named = found.contains(what) && found.contains(way);
        (!is_named).then(|| format!("{what}: {found}"))
    });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Waves past those of the P waves along y have no dashpots, and a body that is no slice has no skew coupling.
#[test]
fn dashpots_of_slices_belong_to_slices() {
    let mesh = small();
    let fast = 1.01 / rock().p_speed();
    let past = spec(&mesh, SolidKernel::Hex8Full, &field(), fast);
    assert!(past.err().unwrap().to_string().contains("no P wave leaves"));
    let mut plain = sound(&mesh);
    plain.delayed = None;
    let found = plain.build().unwrap_err();
    let ModelError::Refused { source, .. } = &found else {
        panic!("{found}");
    };
    assert!(
        matches!(source.downcast_ref(), Some(EngineError::Gyroscopic { .. })),
        "{found}"
    );
}

/// Fibres are refused once a slice is built.
#[test]
fn a_slice_takes_no_fibres() {
    let mesh = small();
    let fibre = Fibre {
        nodes: vec![0, 1],
        added: 1.0,
    };
    let mut model = sound(&mesh).build().unwrap();
    let found = model.set_fibres(core::slice::from_ref(&fibre));
    let found = found.unwrap_err().to_string();
    assert!(
        found.contains("fibres") && found.contains("a slice or bay under waves along y takes none"),
        "{found}"
    );
    let mut plain = paired(&mesh, pairs(&mesh), 0.0);
    plain.boundaries.clear();
    plain.build().unwrap().set_fibres(&[fibre]).unwrap();
}

/// Several ranks refuse a slice, each of them, and take one whose sides are not delayed.
#[test]
fn ranks_take_no_slice() {
    let mesh = small();
    let build = |delayed: bool| {
        ThreadRanks::run(2, |ranks| {
            let mut spec = sound(&mesh).block_size(8);
            if !delayed {
                spec = spec.delayed(DelayedPairs {
                    pairs: pairs(&mesh),
                    slowness: 0.0,
                    ..DelayedPairs::default()
                });
                spec.boundaries.clear();
            }
            let built = RankModel::build(spec, Box::new(ranks));
            Ok(built.err().map(|error| error.to_string()))
        })
    };
    for found in build(true) {
        let found = found.unwrap().unwrap();
        assert!(
            found.contains("take ranks") && found.contains("in one process"),
            "{found}"
        );
    }
    assert_eq!(build(false), vec![Ok(None); 2]);
}

/// A device refuses a slice before it asks for anything else.
#[test]
fn a_device_takes_no_slice() {
    struct Nowhere;
    impl StepDevices for Nowhere {
        fn name(&self) -> &str {
            "nowhere"
        }
        fn device(&self) -> Result<Box<dyn StepDevice>, DeviceError> {
            Err(DeviceError::missing("a card", "there is none"))
        }
    }
    let mesh = small();
    let engine = ExplicitOnDevice::new(Arc::new(Nowhere));
    let found = |spec: ModelSpec| engine.build(spec).err().unwrap().to_string();
    let delayed = found(sound(&mesh));
    assert!(
        delayed.contains("a slice under waves along y") && delayed.contains("on the host"),
        "{delayed}"
    );
    let periodic = found(paired(&mesh, pairs(&mesh), 0.0));
    assert!(periodic.contains("there is none"), "{periodic}");
}
