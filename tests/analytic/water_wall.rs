//! A wall in water: its frequencies with Westergaard's added mass, against a beam with the same mass.

use core::f64::consts::TAU;

use nalgebra::{DMatrix, Rotation3};
use powerhouse::engine::BuildModel;
use powerhouse_elements::{FaceMass, SolidKernel, WaterMass};
use powerhouse_material_damage::LinearElastic;
use powerhouse_model::{BlockOptions, ElasticMedium, Mesh, ModelSpec, Support, Vec3};
use powerhouse_tests::motion_at;

const HEIGHT: f64 = 30.0;
const THICKNESS: f64 = 2.4;
const WIDTH: f64 = 1.5;
const WATER: f64 = 1000.0;
/// Parts of the beam, far more than the wall has bricks.
const PARTS: usize = 150;

/// Concrete without lateral contraction, of which a wall is a beam.
fn concrete() -> ElasticMedium {
    ElasticMedium::new(25e9, 0.0, 2400.0).unwrap()
}

/// First frequency (Hz) and deflection of a cantilever with shear (Timoshenko) whose depth under water is given: stiffness of
/// exact elements with a shear area of 5/6, masses and rotary inertia at their ends, and the integral of the mass of the water
/// around each end.
fn beam(depths: &[f64]) -> (f64, Vec<f64>) {
    let medium = concrete();
    let (area, length) = (THICKNESS * WIDTH, HEIGHT / PARTS as f64);
    let inertia = WIDTH * THICKNESS.powi(3) / 12.0;
    let bending = medium.young * inertia;
    let shear = 12.0 * bending / (medium.shear() * 5.0 / 6.0 * area * length * length);
    let size = 2 * (PARTS + 1);
    let mut stiffness = DMatrix::<f64>::zeros(size, size);
    let factor = bending / ((1.0 + shear) * length.powi(3));
    let l = length;
    let own = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [
            6.0 * l,
            (4.0 + shear) * l * l,
            -6.0 * l,
            (2.0 - shear) * l * l,
        ],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [
            6.0 * l,
            (2.0 - shear) * l * l,
            -6.0 * l,
            (4.0 + shear) * l * l,
        ],
    ];
    let mut mass = vec![0.0; size];
    for part in 0..PARTS {
        for (i, row) in own.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                stiffness[(2 * part + i, 2 * part + j)] += factor * value;
            }
        }
        for end in [part, part + 1] {
            mass[2 * end] += 0.5 * medium.density * area * l;
            mass[2 * end + 1] += 0.5 * medium.density * inertia * l;
        }
    }
    for &depth in depths {
        for node in 0..=PARTS {
            let middle = node as f64 * l;
            let [low, high] = [middle - 0.5 * l, middle + 0.5 * l].map(|z| z.clamp(0.0, HEIGHT));
            let below = |z: f64| (depth - z).max(0.0).powf(1.5) / 1.5;
            let of_root = below(low) - below(high);
            mass[2 * node] += 0.875 * WATER * depth.sqrt() * of_root * WIDTH;
        }
    }
    // The foot is clamped.
    let free: Vec<usize> = (2..size).collect();
    let scaled = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        stiffness[(free[i], free[j])] / (mass[free[i]] * mass[free[j]]).sqrt()
    });
    let eigen = scaled.symmetric_eigen();
    let first = eigen.eigenvalues.imin();
    let shape = (0..=PARTS).map(|node| match node {
        0 => 0.0,
        _ => eigen.eigenvectors[(2 * node - 2, first)] / mass[2 * node].sqrt(),
    });
    (eigen.eigenvalues[first].sqrt() / TAU, shape.collect())
}

/// Frequency (Hz) of a wall of bricks that is turned about the vertical, with water of given depths on its sides, from the times at which
/// its top passes its place.
fn wall(depths: &[f64], turn: f64, bricks: usize) -> f64 {
    let size = Vec3::new(THICKNESS, WIDTH, HEIGHT);
    let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), turn);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 1, bricks], "wall").unwrap();
    let mesh = mesh.map_positions(|x| turn * x).unwrap();
    let law = LinearElastic::new(concrete());
    let kernel = SolidKernel::Hex8Natural.factory("wall", law, BlockOptions::default());
    let foot = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
    let mut spec = ModelSpec::new(&mesh)
        .elements("wall", kernel)
        .support(Support::fixed(foot));
    for (&depth, side) in depths.iter().zip(["left", "right"]) {
        let water = WaterMass::Westergaard {
            density: WATER,
            level: depth,
            depth,
        };
        let mass = FaceMass::new(&mesh, mesh.facet_set(side).unwrap(), &water).unwrap();
        spec = spec.added_masses(mass.masses().iter().copied());
    }
    let mut model = spec.build().unwrap();
    let (expected, shape) = beam(depths);
    let along = turn * Vec3::x();
    let at = |z: f64| {
        let place = z / HEIGHT * PARTS as f64;
        let part = (place as usize).min(PARTS - 1);
        shape[part] + (place - part as f64) * (shape[part + 1] - shape[part])
    };
    let speeds: Vec<Vec3> = (mesh.positions().iter())
        .map(|x| along * (at(x.z) / shape[PARTS]))
        .collect();
    model
        .set_initial(&vec![Vec3::zeros(); speeds.len()], &speeds)
        .unwrap();
    let top = mesh.nodes_of_facets(mesh.facet_set("top").unwrap())[0];
    let motion = motion_at(&mut model, top, 6.2 / expected);
    let crossings: Vec<f64> = motion
        .windows(2)
        .filter_map(|pair| {
            let [(t0, u0), (t1, u1)] = [pair[0], pair[1]];
            let (u0, u1) = (along.dot(&u0), along.dot(&u1));
            (u0 != 0.0 && u0 * u1 <= 0.0).then(|| t0 + (t1 - t0) * u0 / (u0 - u1))
        })
        .collect();
    let last = crossings.len() - 1;
    0.5 * last as f64 / (crossings[last] - crossings[0])
}

/// The first frequency of a wall in water is that of the beam within 0.5 %, dry, full on one side and on both, at levels that
/// cut bricks, in any direction; water lowers it by a fifth to two fifths.
#[test]
fn a_wall_in_water_swings_as_its_beam_does() {
    let (dry, _) = beam(&[]);
    for (depths, turn, bricks) in [
        (&[][..], 0.0, 30),
        (&[30.0][..], 0.0, 30),
        (&[26.37], 0.8, 24),
        (&[22.4, 30.0], -2.2, 30),
        (&[30.0, 30.0], 0.3, 20),
    ] {
        let (expected, _) = beam(depths);
        let found = wall(depths, turn, bricks);
        let error = found / expected - 1.0;
        assert!(error.abs() < 5e-3, "{depths:?}: {found} Hz, not {expected}");
        assert!(
            depths.is_empty() || expected < 0.85 * dry,
            "{expected} {dry}"
        );
    }
}
