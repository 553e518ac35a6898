//! Bays against rows of many bays.

use std::collections::{HashMap, HashSet};

use powerhouse_boundary::ViscousSpring;
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model};
use powerhouse_material_damage::{
    DampingBand, FlatDamping, LinearElastic, ReferenceFrequency, RelaxationSpectrum,
};
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, DelayedPairs, ElasticMedium, Mesh,
    TimeIntegrator, Vec3,
};
use powerhouse_wavefield::WaveKind;

use super::{pairs, rock, slowness, wave};
use crate::support::apart;

/// Half widths of the section, depth, and size of elements (m).
const HALF: f64 = 60.0;
const DEPTH: f64 = 80.0;
const SIZE: f64 = 5.0;
/// Share of the stable step.
const SHARE: f64 = 0.7;
/// Length of a bay (m).
const LENGTH: f64 = 20.0;

/// A row of bays between two y (m), with the nodes of the core and those around it apart if they are `divided`.
fn row(low: f64, high: f64, divided: bool) -> Mesh {
    let count = |length: f64| (length / SIZE).round() as usize;
    let counts = [count(2.0 * HALF), count(high - low), count(DEPTH)];
    let (low, high) = (Vec3::new(-HALF, low, -DEPTH), Vec3::new(HALF, high, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, counts, "rock").unwrap();
    if !divided {
        return mesh;
    }
    let [inside, outside] = both(&mesh);
    mesh.split_between(&outside, &inside).unwrap().mesh
}

/// Elements of the core, which fills half of a bay, and the others.
fn both(mesh: &Mesh) -> [Vec<u32>; 2] {
    let all = 0..mesh.element_count() as u32;
    let is_inside = |element: &u32| {
        let x = mesh.centroid(*element);
        let along = (x.y - 5.0).rem_euclid(LENGTH);
        x.x.abs() < 15.0 && (-45.0..-25.0).contains(&x.z) && along < 0.5 * LENGTH
    };
    let (inside, outside) = all.partition(is_inside);
    [inside, outside]
}

/// What the core is made of, and the law of its surface; welded without one.
#[derive(Clone, Copy)]
struct Core {
    medium: ElasticMedium,
    surface: Option<BondedCoulomb>,
    /// Whether core and rock have flat damping of 5 %.
    damped: bool,
}

impl Core {
    fn welded(medium: ElasticMedium) -> Self {
        Self {
            medium,
            surface: None,
            damped: false,
        }
    }
}

/// A model of a row, as a bay if it is `delayed`.
fn model(mesh: &Mesh, (kind, angles): (WaveKind, [f64; 2]), core: Core, delayed: bool) -> Model {
    let field = wave(kind, angles, (8.0, 0.25));
    let s = slowness(kind, angles);
    let sides: &[&str] = if delayed {
        &["left", "right", "bottom"]
    } else {
        &["left", "right", "bottom", "front", "back"]
    };
    let faces: Vec<_> = sides
        .iter()
        .map(|face| (*face, mesh.facet_set(face).unwrap()))
        .collect();
    let site = BoundarySite::from_mesh(mesh, &faces, |_| rock(), Vec3::zeros(), Some(&field));
    let site = if delayed { site.with_slowness(s) } else { site };
    let parts = ViscousSpring::default().build(&site).unwrap();
    let [inside, rest] = both(mesh);
    let band = DampingBand {
        ratio: 0.05,
        lowest: 2.0,
        highest: 30.0,
        mechanisms: 2,
    };
    let law = |medium| -> AnyLaw {
        let law = LinearElastic::new(medium);
        if core.damped {
            let spectrum = RelaxationSpectrum::fit(band).unwrap();
            FlatDamping::new(law, spectrum, ReferenceFrequency::Centre)
                .unwrap()
                .into()
        } else {
            law.into()
        }
    };
    let elastic = |label: &str, medium| {
        SolidKernel::Hex8Full.factory(label, law(medium), BlockOptions::default())
    };
    let mut spec = Model::builder(mesh)
        .elements(rest.clone(), elastic("rock", rock()))
        .elements(inside.clone(), elastic("core", core.medium))
        .boundary(parts);
    if let Some(law) = core.surface {
        let options = SurfaceOptions::within(1e-6).unwrap();
        // Facets of the core all lie on its surface, and those of the rock there face them.
        let is_inside = |element: u32| inside.binary_search(&element).is_ok();
        let inner = mesh.boundary_facets_of(is_inside);
        let (low, high) = mesh.bounding_box();
        let mut outer = mesh.boundary_facets_of(|element| !is_inside(element));
        outer.retain(|facet| {
            let nodes = mesh.facet_nodes(*facet);
            let at = |node: &u32, c: usize, end: f64| {
                (mesh.positions()[*node as usize][c] - end).abs() < 1e-6
            };
            let on_end = |c: usize, end: f64| nodes.iter().all(|node| at(node, c, end));
            !(0..3).any(|c| on_end(c, low[c]) || on_end(c, high[c]))
        });
        let surface = JointSurface::between(mesh, &outer, &inner, &options).unwrap();
        spec = spec.constraint(Box::new(Joint::new("joint", surface.pairs, law).unwrap()));
    }
    if delayed {
        spec = spec.delayed(DelayedPairs {
            pairs: pairs(mesh),
            slowness: s,
            ..DelayedPairs::default()
        });
    }
    spec.build().unwrap()
}

/// Displacements of nodes at times (s), linearly between steps of a share of the stable one.
fn history(model: &mut Model, share: f64, nodes: &[u32], times: &[f64]) -> Vec<Vec<Vec3>> {
    let step = share * model.stable_step(&Leapfrog).unwrap().step;
    let now =
        |model: &Model| -> Vec<Vec3> { nodes.iter().map(|n| model.displacement(*n)).collect() };
    let (mut before, mut all) = (now(model), Vec::new());
    for &time in times {
        while model.time() < time {
            before = now(model);
            Leapfrog.step(model, step).unwrap();
        }
        let share = (model.time() - time) / step;
        let after = now(model);
        let both = after.iter().zip(&before);
        all.push(
            both.map(|(after, before)| after * (1.0 - share) + before * share)
                .collect(),
        );
    }
    all
}

/// Where the motion of the bay of a core is compared: all of its nodes that are not on the surface of the core.
fn compared(mesh: &Mesh) -> Vec<u32> {
    let [inside, outside] = both(mesh).map(|elements| mesh.nodes_of_elements(&elements));
    let key = |node: &u32| mesh.positions()[*node as usize].map(|x| (10.0 * x).round() as i64);
    let inside: HashSet<_> = inside.iter().map(key).collect();
    let outside = outside
        .into_iter()
        .filter(|node| !inside.contains(&key(node)));
    outside.collect()
}

/// Displacements of the nodes of a bay at some times.
fn of_bay(
    wave: (WaveKind, [f64; 2]),
    core: Core,
    share: f64,
    times: &[f64],
) -> (Mesh, Vec<u32>, Vec<Vec<Vec3>>) {
    let mesh = row(0.0, LENGTH, core.surface.is_some());
    let nodes = compared(&mesh);
    let motion = history(&mut model(&mesh, wave, core, true), share, &nodes, times);
    (mesh, nodes, motion)
}

fn times() -> Vec<f64> {
    (0..90).map(|k| 0.1 + 0.005 * f64::from(k)).collect()
}

/// Error of a bay against a row of a number of bays with a core, as a share of the norm of the motion of all nodes around the core at the
/// middle of the row, and what another core would change of it.
fn error(wave: (WaveKind, [f64; 2]), core: Core, other: Core, bays: u32) -> [f64; 2] {
    let (kind, angles) = wave;
    let s = slowness(kind, angles);
    let (one, own, found) = of_bay(wave, core, SHARE, &times());
    let (.., plain) = of_bay(wave, other, SHARE, &times());
    let half = 0.5 * f64::from(bays) * LENGTH;
    let long = row(-half, half, core.surface.is_some());
    let key = |x: &Vec3| x.map(|x| (10.0 * x).round() as i64);
    let place: HashMap<_, u32> = long.positions().iter().map(key).zip(0..).collect();
    let at = |node: &u32| one.positions()[*node as usize];
    let nodes: Vec<u32> = own.iter().map(|node| place[&key(&at(node))]).collect();
    let (first, interval) = (0.05, 0.001);
    let fine: Vec<f64> = (0..600).map(|k| first + interval * f64::from(k)).collect();
    let row = history(&mut model(&long, wave, core, false), SHARE, &nodes, &fine);
    let of_time = |time: &f64| -> Vec<Vec3> {
        let of_node = |(i, node): (usize, &u32)| {
            // The motion at y is that at the middle of the bay, later.
            let at = (time + s * (at(node).y - 0.5 * LENGTH) - first) / interval;
            let (k, share) = (at.floor() as usize, at.fract());
            row[k][i] * (1.0 - share) + row[k + 1][i] * share
        };
        own.iter().enumerate().map(of_node).collect()
    };
    let exact: Vec<Vec<Vec3>> = times().iter().map(of_time).collect();
    let [found, plain, exact] = [found, plain, exact].map(|motion| motion.concat());
    [apart(&found, &exact), apart(&plain, &found)]
}

/// A bond that never breaks.
fn bonded() -> BondedCoulomb {
    let parameters = BondedCoulombParameters {
        static_friction: 0.5,
        dynamic_friction: 0.5,
        cohesion: 1e9,
        tensile_strength: 1e9,
        cohesion_loss: true,
    };
    BondedCoulomb::new(parameters).unwrap()
}

fn soft() -> ElasticMedium {
    ElasticMedium::new(1.5e9, 0.2, 2400.0).unwrap()
}

fn concrete() -> ElasticMedium {
    ElasticMedium::new(30e9, 0.2, 2400.0).unwrap()
}

/// A bay whose core of concrete has a ratio of slownesses of 0.86 moves as the middle of a row of 16.
#[test]
fn a_bay_moves_as_a_row_of_bays() {
    let wave = (WaveKind::SV, [15.0, 90.0]);
    let [concrete, rock] = [concrete(), rock()].map(Core::welded);
    let [error, effect] = error(wave, concrete, rock, 16);
    println!("{error:.4}, effect {effect:.3}");
    assert!(error < 0.025 && effect > 0.05, "{error} {effect}");
}

/// A core that is bonded to the rock by a joint moves as one that is welded to it, to the second order in the step.
#[test]
fn a_bonded_core_moves_as_a_welded_one() {
    let wave = (WaveKind::SV, [15.0, 90.0]);
    let bonded = Core {
        medium: concrete(),
        surface: Some(bonded()),
        damped: false,
    };
    let differences = [SHARE, 0.5 * SHARE].map(|share| {
        let (.., bonded) = of_bay(wave, bonded, share, &times());
        let (.., welded) = of_bay(wave, Core::welded(concrete()), share, &times());
        apart(&bonded.concat(), &welded.concat())
    });
    println!("bonded {differences:?}");
    let [whole, half] = differences;
    assert!(whole < 0.015 && half < 0.3 * whole, "{whole} {half}");
}

/// A core that slips in the rock and opens moves as those of a row do, to less than a sixth of what slip changes.
#[test]
fn a_core_that_slips_moves_as_those_of_a_row() {
    let wave = (WaveKind::SV, [15.0, 90.0]);
    let slipping = Core {
        medium: concrete(),
        surface: Some(BondedCoulomb::unbonded(0.5, 0.5).unwrap()),
        damped: false,
    };
    let [error, effect] = error(wave, slipping, Core::welded(concrete()), 16);
    println!("slipping {error:.4}, effect {effect:.3}");
    assert!(error < 0.15 * effect && effect > 0.2, "{error} {effect}");
}

/// With flat damping, of the rock too, a bay moves as a row does. The ends of a row, at which the motion is not damped, are nearer the shorter it is: against
/// one of 32 bays the error is smaller than against one of 16.
#[test]
fn a_damped_bay_moves_as_a_damped_row() {
    let wave = (WaveKind::SV, [10.0, 90.0]);
    let plain = Core::welded(concrete());
    let damped = Core {
        damped: true,
        ..plain
    };
    let [short, long] = [16, 32].map(|bays| error(wave, damped, plain, bays));
    println!("damped {short:?} {long:?}");
    assert!(
        long[1] > 0.1 && long[0] < 0.025 && long[0] < short[0],
        "{short:?} {long:?}"
    );
}

/// Bays with soft and with stiff cores move as the middle of rows of 40, for P and SV waves at several azimuths. A minute:
/// `cargo test --release -p powerhouse-explicit-core --test explicit-core -- --ignored bays --nocapture`.
#[test]
#[ignore = "a minute"]
fn bays_move_as_long_rows_of_bays() {
    let slipping = Core {
        medium: concrete(),
        surface: Some(BondedCoulomb::unbonded(0.5, 0.5).unwrap()),
        damped: false,
    };
    let wave = (WaveKind::SV, [15.0, 90.0]);
    let [of_slip, effect] = error(wave, slipping, Core::welded(concrete()), 40);
    println!("slipping {of_slip:.4}, effect {effect:.3}");
    for (kind, angles, inside) in [
        (WaveKind::SV, [15.0, 90.0], soft()),
        (WaveKind::SV, [20.0, 50.0], soft()),
        (WaveKind::P, [35.0, 90.0], soft()),
        (WaveKind::SV, [15.0, 90.0], concrete()),
        (WaveKind::P, [25.0, 60.0], concrete()),
    ] {
        let [inside, rock] = [inside, rock()].map(Core::welded);
        let [error, effect] = error((kind, angles), inside, rock, 40);
        println!("{kind} {angles:?}: {error:.4}, effect {effect:.3}");
        assert!(error < 0.025, "{kind} {angles:?}: {error}");
    }
}
