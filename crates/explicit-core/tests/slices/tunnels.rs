//! Cavities and lined tunnels along y under waves of any azimuth against closed forms.

use core::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use powerhouse_boundary::{Spreading, ViscousSpring};
use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run};
use powerhouse_material_damage::{LinearElastic, Mazars, MazarsParameters, MazarsTension};
use powerhouse_model::{
    AbsorbingBoundary, BlockFactory, BlockOptions, BoundarySite, DelayedPairs, ElasticMedium,
    ElementKind, EnergyCheck, Mesh, RunOptions, StiffElements, TimeIntegrator, Vec3,
};
use powerhouse_wavefield::{
    Angle, InputConvention, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, Site, WaveKind,
};

use super::{pairs, rock, slowness};

/// Radius of the cavity (m).
const RADIUS: f64 = 5.0;

/// A table of `data/reference`: rows of numbers under names.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(name: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/reference");
        let text = std::fs::read_to_string(root.join(name)).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let names = lines
            .next()
            .unwrap()
            .split(',')
            .map(str::to_owned)
            .collect();
        let numbers = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
        Self {
            names,
            rows: lines.map(numbers).collect(),
        }
    }
    /// The value of a column at a time (s), between the samples by cubic interpolation; zero before the first one.
    fn at(&self, column: usize, time: f64) -> f64 {
        let (first, interval) = (self.rows[0][0], self.rows[1][0] - self.rows[0][0]);
        let place = (time - first) / interval;
        let index = place.floor();
        let x = place - index;
        let value = |offset: f64| {
            let row = index + offset;
            let inside = row >= 0.0 && (row as usize) < self.rows.len();
            if inside {
                self.rows[row as usize][column]
            } else {
                0.0
            }
        };
        let [a, b, c, d] = [-1.0, 0.0, 1.0, 2.0].map(value);
        b + 0.5 * x * (c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a)))
    }
    fn column(&self, name: &str) -> usize {
        self.names.iter().position(|own| own == name).unwrap()
    }
}

/// A square of a half width (m) around a circular hole, one element thick: bricks between rings of some radii, which go over into
/// the square beyond the radius of the cavity. Elements within it are `lining`.
fn around_a_hole(rings: &[f64], half: f64, round: usize, outward: usize) -> Mesh {
    let mut builder = Mesh::builder();
    let layers = rings.len() + outward;
    let growth = {
        // The first edge outwards is as long as those along the wall.
        let (first, whole) = (TAU * RADIUS / round as f64, half - RADIUS);
        let sum = |q: f64| (0..outward).map(|k| q.powi(k as i32)).sum::<f64>() * first;
        let (mut low, mut high) = (1.0, 2.0);
        for _ in 0..60 {
            let q = 0.5 * (low + high);
            if sum(q) < whole { low = q } else { high = q }
        }
        low
    };
    let share = |k: usize| {
        let sum = |n: usize| (0..n).map(|k| growth.powi(k as i32)).sum::<f64>();
        sum(k) / sum(outward)
    };
    let thickness = 0.1;
    let tag = |ring: usize, place: usize, side: usize| {
        (1 + side + 2 * (place % round + round * ring)) as u64
    };
    for ring in 0..layers {
        for place in 0..round {
            let angle = TAU * place as f64 / round as f64;
            let (sine, cosine) = angle.sin_cos();
            let on_square = half / sine.abs().max(cosine.abs());
            let radius = match rings.get(ring) {
                Some(radius) => *radius,
                None => {
                    let share = share(ring + 1 - rings.len());
                    RADIUS + share * (on_square - RADIUS)
                }
            };
            for side in 0..2 {
                let y = thickness * (side as f64 - 0.5);
                let at = Vec3::new(radius * cosine, y, radius * sine);
                builder.node(tag(ring, place, side), at);
            }
        }
    }
    let mut number = 0;
    for ring in 0..layers - 1 {
        for place in 0..round {
            number += 1;
            let corners = |side| {
                [
                    tag(ring, place, side),
                    tag(ring + 1, place, side),
                    tag(ring + 1, place + 1, side),
                    tag(ring, place + 1, side),
                ]
            };
            let inside = rings.get(ring + 1).is_some();
            let set = if inside { "lining" } else { "rock" };
            // From the back to the front the corners turn to the right.
            let nodes = [corners(1), corners(0)].concat();
            builder.element(number, ElementKind::Hex8, &nodes, &[set]);
            builder.facet("front", &corners(0));
            builder.facet("back", &corners(1));
            if ring + 2 == layers {
                let [outer, next] = [place, place + 1].map(|p| [0, 1].map(|s| tag(ring + 1, p, s)));
                builder.facet("outer", &[outer[0], outer[1], next[1], next[0]]);
            }
        }
    }
    builder.build().unwrap()
}

/// A wave in a full space, whose pulse of the displacement (1 m) passes the axis at time zero.
fn full_space(kind: WaveKind, [incidence, azimuth]: [f64; 2], frequency: f64) -> PlaneWave {
    let pulse = Ricker::new(RickerQuantity::Displacement, 1.0, frequency, 0.0).unwrap();
    let parameters = PlaneWaveParameters {
        kind,
        incidence: Angle::from_degrees(incidence),
        azimuth: Angle::from_degrees(azimuth),
        medium: rock(),
        site: Site::FullSpace,
        reference: Vec3::zeros(),
        arrival: 0.0,
        convention: InputConvention::Incident,
    };
    PlaneWave::new(parameters, Arc::new(pulse)).unwrap()
}

fn concrete() -> ElasticMedium {
    ElasticMedium::new(30.0e9, 0.2, 2500.0).unwrap()
}

/// The lining as stiff elements, if its P waves are nearly as fast as the motion along y or faster: half of its density is left.
fn stiff(mesh: &Mesh, slowness: f64) -> Vec<StiffElements> {
    let lining = mesh.element_set("lining");
    let is_stiff = slowness.abs() * concrete().p_speed() > 0.95;
    let elements = lining.into_iter().filter(|_| is_stiff).map(|elements| {
        let kept = [concrete().s_speed(), concrete().p_speed()];
        StiffElements {
            elements: elements.to_vec(),
            kept: kept.map(|speed| (0.5 / (slowness * speed).powi(2)).min(1.0)),
        }
    });
    elements.collect()
}

/// Blocks of the rock or the lining.
fn factory(set: &str, law: impl Into<AnyLaw>) -> Box<dyn BlockFactory> {
    SolidKernel::Hex8Full.factory(set, law, BlockOptions::default())
}

/// The slice around a hole, at a time (s) before the wave.
fn model(mesh: &Mesh, field: &PlaneWave, slowness: f64, start: f64) -> Model {
    let lining = factory("lining", LinearElastic::new(concrete()));
    model_lined(mesh, field, slowness, (start, lining))
}

/// The same with a lining of other elements, if the mesh has one.
fn model_lined(
    mesh: &Mesh,
    field: &PlaneWave,
    slowness: f64,
    (start, lining): (f64, Box<dyn BlockFactory>),
) -> Model {
    let faces = [("outer", mesh.facet_set("outer").unwrap())];
    let site = BoundarySite::from_mesh(mesh, &faces, |_| rock(), Vec3::zeros(), Some(field));
    let boundary = ViscousSpring {
        spreading: Spreading::Cylindrical,
        ..ViscousSpring::default()
    };
    let mut spec = Model::builder(mesh)
        .elements("rock", factory("rock", LinearElastic::new(rock())))
        .boundary(boundary.build(&site.with_slowness(slowness)).unwrap())
        .delayed(DelayedPairs {
            pairs: pairs(mesh),
            slowness,
            stiff: stiff(mesh, slowness),
        });
    if mesh.element_set("lining").is_ok() {
        spec = spec.elements("lining", lining);
    }
    let mut state = powerhouse_model::State::at_rest(mesh.node_count());
    state.time = start;
    spec.start(state).build().unwrap()
}

/// A wave and its table.
struct Case {
    kind: WaveKind,
    angles: [f64; 2],
    name: &'static str,
}

/// A box: half its width over the radius of the cavity, and the elements round the cavity and outwards.
struct Grid {
    radii: f64,
    round: usize,
    outward: usize,
}

/// A slice of a wave in a box, with the table that it is compared with.
struct Compared {
    table: Table,
    model: Model,
    step: f64,
    /// Time (s) of the last sample that is compared.
    end: f64,
}

/// The slice of a case around a hole with some rings, under a pulse of a frequency (Hz), from a time before it is at the axis on:
/// `lead` (s) more than the way from the corner of the box takes.
fn compared(case: &Case, grid: &Grid, rings: &[f64], [frequency, lead]: [f64; 2]) -> Compared {
    let table = Table::read(case.name);
    let half = grid.radii * RADIUS;
    let mesh = around_a_hole(rings, half, grid.round, grid.outward);
    let field = full_space(case.kind, case.angles, frequency);
    let start = -lead - 1.5 * half / case.kind.speed(&rock());
    let mut model = model(&mesh, &field, slowness(case.kind, case.angles), start);
    Compared {
        step: model.stable_step(&Leapfrog).unwrap().step,
        end: table.rows[table.rows.len() - 3][0],
        table,
        model,
    }
}

/// Error of the displacements at eight points of the wall of a cavity over a table in time, as a share of their norm.
fn cavity(case: &Case, grid: &Grid) -> f64 {
    let Compared {
        table,
        mut model,
        step,
        end,
    } = compared(case, grid, &[RADIUS], [40.0, 0.05]);
    let round = grid.round;
    let wall: Vec<(u32, u32)> = (0..8)
        .map(|k| {
            let first = 2 * (k * round / 8) as u32;
            (first, first + 1)
        })
        .collect();
    let (mut missed, mut all) = (0.0, 0.0);
    while model.time() < end {
        Leapfrog.step(&mut model, step).unwrap();
        if model.time() < table.rows[2][0] {
            continue;
        }
        for (k, &(a, b)) in wall.iter().enumerate() {
            let found = (model.displacement(a) + model.displacement(b)) * 0.5;
            for c in 0..3 {
                let exact = table.at(1 + 3 * k + c, model.time());
                missed += (found[c] - exact).powi(2);
                all += exact * exact;
            }
        }
    }
    (missed / all).sqrt()
}

const SV25: Case = Case {
    kind: WaveKind::SV,
    angles: [25.0, 50.0],
    name: "cavity_azimuth_sv25_az50.csv",
};
const SV30: Case = Case {
    kind: WaveKind::SV,
    angles: [30.0, 90.0],
    name: "cavity_azimuth_sv30_az90.csv",
};
const P70: Case = Case {
    kind: WaveKind::P,
    angles: [70.0, 90.0],
    name: "cavity_azimuth_p70_az90.csv",
};

/// The wall of a cavity in a box of 4 radii moves as in the closed form, at a slowness of 0.94 of that of P waves. Another
/// implementation errs by 5.1 % with dashpots matched to the slowness, and by 18.5 % with those of vertical waves.
#[test]
fn the_wall_of_a_cavity_moves_as_the_closed_form_says() {
    let grid = Grid {
        radii: 4.0,
        round: 48,
        outward: 18,
    };
    let found = cavity(&P70, &grid);
    println!("P70: {found:.4}");
    assert!(found < 1.2 * 0.051, "{found:.4}");
}

/// Three waves in a box of 8 radii with 144 elements round, within 4.5 %, and 2.6 % for P at 70 degrees. A minute:
/// `cargo test -p powerhouse-explicit-core --test explicit-core -- --ignored slices`.
#[test]
#[ignore = "a minute"]
fn walls_of_cavities_in_large_boxes_move_as_the_closed_form_says() {
    for (case, most) in [(SV25, 0.045), (SV30, 0.045), (P70, 0.026)] {
        let grid = Grid {
            radii: 8.0,
            round: 144,
            outward: 66,
        };
        let found = cavity(&case, &grid);
        println!("{}: {found:.4}", case.name);
        assert!(found < most, "{}: {found:.4}", case.name);
    }
}

/// A ring of concrete of 4.5 to 5 m under a wave, and its table.
const RINGS: [(Case, f64, f64); 4] = [
    (
        Case {
            kind: WaveKind::SV,
            angles: [15.0, 90.0],
            name: "lined_azimuth_sv15_az90.csv",
        },
        0.825,
        0.015,
    ),
    (
        Case {
            kind: WaveKind::SV,
            angles: [25.0, 50.0],
            name: "lined_azimuth_sv25_az50.csv",
        },
        1.032,
        0.03,
    ),
    (
        Case {
            kind: WaveKind::P,
            angles: [60.0, 60.0],
            name: "lined_azimuth_p60_az60.csv",
        },
        1.342,
        0.03,
    ),
    (
        Case {
            kind: WaveKind::SV,
            angles: [30.0, 90.0],
            name: "lined_azimuth_sv30_az90.csv",
        },
        1.594,
        0.08,
    ),
];

/// What a ring in a box of a grid errs by: its axial stress over all points and times as a share of the norm, its largest one
/// over that of the table less one, and the hoop stress.
fn ring(case: &Case, grid: &Grid) -> [f64; 3] {
    let Compared {
        table,
        mut model,
        step,
        end,
    } = compared(case, grid, &[4.5, 4.75, 5.0], [25.0, 0.07]);
    let round = grid.round;
    let columns: Vec<[[usize; 2]; 2]> = (0..8)
        .map(|k| {
            let column =
                |name: &str, side: &str| table.column(&format!("{name}_{side}@{}", 45 * k));
            ["yy", "tt"].map(|name| ["i", "o"].map(|side| column(name, side)))
        })
        .collect();
    let (mut missed, mut all, mut count) = ([0.0; 2], [0.0; 2], 0);
    let (mut largest, mut expected) = (0.0_f64, 0.0_f64);
    while model.time() < end {
        Leapfrog.step(&mut model, step).unwrap();
        count += 1;
        if model.time() < table.rows[2][0] || count % 20 != 0 {
            continue;
        }
        let stresses = model.stress_changes();
        for (k, columns) in columns.iter().enumerate() {
            // Two rings of elements, and the two elements beside the point.
            let place = k * round / 8;
            let (sine, cosine) = (TAU * k as f64 / 8.0).sin_cos();
            let beside = [(place + round - 1) % round, place];
            let elements = beside.iter().flat_map(|&e| [e, e + round]);
            let stresses = elements.map(|e| {
                let [xx, yy, zz, _, _, zx] = stresses[e].0;
                let hoop = xx * sine * sine + zz * cosine * cosine - 2.0 * zx * sine * cosine;
                [yy, hoop]
            });
            let found = stresses.fold([0.0; 2], |[a, b], [c, d]| [a + 0.25 * c, b + 0.25 * d]);
            for (c, columns) in columns.iter().enumerate() {
                let sides = columns.map(|column| table.at(column, model.time()));
                let exact = 0.5 * (sides[0] + sides[1]);
                missed[c] += (found[c] - exact).powi(2);
                all[c] += exact * exact;
                if c == 0 {
                    largest = largest.max(found[c].abs());
                    expected = expected.max(exact.abs());
                }
            }
        }
    }
    let [axial, hoop] = [0, 1].map(|c| (missed[c] / all[c]).sqrt());
    [axial, largest / expected - 1.0, hoop]
}

/// The axial stress in the middle of a concrete ring errs by no more than 1.5 % of the norm over its circumference where its P
/// waves are at 0.825 of the speed along y, by 3 % at 1.03 and 1.34, and by 8 % at 1.59. Five minutes:
/// `cargo test -p powerhouse-explicit-core --test explicit-core -- --ignored slices`.
#[test]
#[ignore = "five minutes"]
fn rings_have_the_axial_stress_of_the_closed_form() {
    for (case, ratio, most) in RINGS {
        let found = slowness(case.kind, case.angles) * concrete().p_speed();
        assert!((found - ratio).abs() < 1e-3, "{found}");
        let grid = Grid {
            radii: 8.0,
            round: 144,
            outward: 66,
        };
        let [axial, peak, hoop] = ring(&case, &grid);
        println!("{ratio}: axial stress {axial:.4}, peak {peak:+.4}, hoop {hoop:.4}");
        assert!(axial < most, "{ratio}: {axial:.4}");
    }
}

/// A ring in which P waves are faster than the motion along y conserves energy to rounding, and moves as one whose law could crack
/// but does not, which is computed with two evaluations in a step: to rounding.
#[test]
fn a_stiff_ring_conserves_energy_in_both_forms() {
    for (kind, angles) in [(WaveKind::SV, [25.0, 50.0]), (WaveKind::P, [60.0, -60.0])] {
        let mesh = around_a_hole(&[4.5, 4.75, 5.0], 3.0 * RADIUS, 32, 9);
        let field = full_space(kind, angles, 25.0);
        let slow = slowness(kind, angles);
        assert!(slow.abs() * concrete().p_speed() > 1.0);
        let brittle = Mazars::new(MazarsParameters {
            medium: concrete(),
            threshold: 1.0,
            tension: MazarsTension::Rates {
                share: 1.0,
                rate: 1.5,
            },
            compression_share: 1.0,
            compression_rate: 1.5,
            residual_stiffness: 1e-3,
        });
        let brittle = factory("lining", brittle.unwrap());
        let linear = factory("lining", LinearElastic::new(concrete()));
        let mut motions = Vec::new();
        for lining in [linear, brittle] {
            let mut model = model_lined(&mesh, &field, slow, (-0.09, lining));
            let options = RunOptions::seconds(0.095).with_energy(EnergyCheck::every(20));
            let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
            let residual = report.energy_residual;
            assert!(residual < 1e-11, "{angles:?}: {residual:e}");
            let nodes = 0..mesh.node_count() as u32;
            motions.push(nodes.map(|n| model.displacement(n)).collect::<Vec<_>>());
        }
        let size = motions[0].iter().map(|u| u.norm()).fold(0.0, f64::max);
        let apart = motions[0]
            .iter()
            .zip(&motions[1])
            .map(|(a, b)| (a - b).norm());
        let apart = apart.fold(0.0, f64::max);
        assert!(size > 0.1 && apart < 1e-9 * size, "{apart:e} of {size}");
    }
}
