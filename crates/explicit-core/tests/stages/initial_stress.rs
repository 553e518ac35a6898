//! Stress that was there first.

use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{Mesh, Precision, State, StaticOptions, StressField, Vec3};

use super::{GRAVITY, elastic_body, face_nodes, on_rollers, rock, weak};

const SIZE: Vec3 = Vec3::new(30.0, 20.0, 80.0);

/// A box, graded in depth.
fn column() -> Mesh {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), SIZE, [3, 2, 10], "ground").unwrap();
    let graded = |p: Vec3| Vec3::new(p.x, p.y, p.z * (0.5 + p.z / (2.0 * SIZE.z)));
    mesh.map_positions(graded).unwrap()
}

/// A block of any K0 under its weight stays where it is and as it is, to 1e-8: K0 need not be
/// `nu / (1 - nu)`; the mesh is graded in depth, the rock elastic or close to yielding.
#[test]
fn a_block_of_given_lateral_stress_stays_as_it_is() {
    let mesh = column();
    let weight = rock().density * GRAVITY.norm();
    let field = StressField::geostatic(SIZE.z, weight, [0.95, 1.05]).unwrap();
    let mut state = State::at_rest(mesh.node_count());
    state.initial_stress = field.of_elements(&mesh);
    let settled = 0.5 * weight * SIZE.z * SIZE.z / rock().constrained();
    for elastic in [true, false] {
        let builder = if elastic {
            elastic_body(&mesh)
        } else {
            Model::builder(&mesh).elements("ground", weak("ground", Precision::F64))
        };
        let mut model = on_rollers(&mesh, builder)
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .start(state.clone())
            .build()
            .unwrap();
        let options = StaticOptions::default().with_tolerance(1.0e-10);
        model.equilibrate(&options, &mut |_| {}).unwrap();
        for node in 0..mesh.node_count() as u32 {
            let moved = model.displacement(node).norm();
            assert!(moved < 1.0e-8 * settled, "{moved} {settled}");
        }
        for stress in model.stress_changes() {
            let change = stress.0.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            assert!(change < 1.0e-8 * weight * SIZE.z, "{change}");
        }
    }
}

/// Without its weight the same block is unbalanced: it rises by as much as its own weight
/// would have pressed it down, and keeps the initial stress sideways less what the rise gives back.
#[test]
fn an_initial_stress_without_its_cause_moves_the_body() {
    let mesh = column();
    let weight = rock().density * GRAVITY.norm();
    let field = StressField::geostatic(SIZE.z, weight, [0.95, 1.05]).unwrap();
    let mut state = State::at_rest(mesh.node_count());
    state.initial_stress = field.of_elements(&mesh);
    let mut model = on_rollers(&mesh, elastic_body(&mesh))
        .start(state)
        .build()
        .unwrap();
    let options = StaticOptions::default().with_tolerance(1.0e-11);
    model.equilibrate(&options, &mut |_| {}).unwrap();
    let risen = 0.5 * weight * SIZE.z * SIZE.z / rock().constrained();
    for node in face_nodes(&mesh, "top") {
        let found = model.displacement(node);
        assert!((found - Vec3::z() * risen).norm() < 1.0e-8 * risen);
    }
}
