//! Stress that was there first.

use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{Mesh, Precision, State, StaticOptions, Stress, StressField, Support, Vec3};

use powerhouse_elements::SolidKernel;

use super::{Elastic, GRAVITY, elastic_body, face_nodes, on_rollers, rock, weak};

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
    state.initial_slope = field.slopes_of_elements(&mesh);
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

/// A block of any kind of elements, bent inside, is balanced under its geostatic stress to rounding: no node moves by more
/// than 1e-9 of what it would settle by its weight, and the unbalanced force is below 1e-9 of the load.
#[test]
fn geostatic_stress_is_balanced_in_elements_of_any_kind() {
    let (size, cells) = (Vec3::new(20.0, 15.0, 40.0), [3, 2, 4]);
    let box_of = |mesh: Result<Mesh, powerhouse_model::MeshError>| {
        let bent = mesh.unwrap().map_positions(|p| {
            let half = p.component_div(&size) * core::f64::consts::PI;
            let bump = half.x.sin() * half.y.sin() * half.z.sin();
            p + Vec3::new(1.0, -0.7, 0.8) * bump
        });
        bent.unwrap()
    };
    let zero = Vec3::zeros();
    let tets = box_of(Mesh::box_of_tets(zero, size, cells, "ground"));
    for (kernel, mesh) in [
        (
            SolidKernel::Hex8Natural,
            box_of(Mesh::box_of_hexes(zero, size, cells, "ground")),
        ),
        (
            SolidKernel::Hex8Eas,
            box_of(Mesh::box_of_hexes(zero, size, cells, "ground")),
        ),
        (
            SolidKernel::Hex8BBar,
            box_of(Mesh::box_of_hexes(zero, size, cells, "ground")),
        ),
        (
            SolidKernel::Wedge6,
            box_of(Mesh::box_of_wedges(zero, size, cells, "ground")),
        ),
        (
            SolidKernel::Pyramid5,
            box_of(Mesh::box_of_pyramids(zero, size, cells, "ground")),
        ),
        (SolidKernel::Tet4, tets.clone()),
        (SolidKernel::Tet10, tets.with_midpoints().unwrap()),
    ] {
        let weight = rock().density * GRAVITY.norm();
        let field = StressField::geostatic(size.z, weight, [0.5, 0.9]).unwrap();
        let mut state = State::at_rest(mesh.node_count());
        state.initial_stress = field.of_elements(&mesh);
        state.initial_slope = field.slopes_of_elements(&mesh);
        let elements = kernel.factory("ground", Elastic(rock()), Default::default());
        let body = Model::builder(&mesh).elements("ground", elements);
        let mut model = on_rollers(&mesh, body)
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .start(state)
            .build()
            .unwrap();
        let report = model
            .equilibrate(&StaticOptions::default(), &mut |_| {})
            .unwrap();
        let settled = 0.5 * weight * size.z * size.z / rock().constrained();
        for node in 0..mesh.node_count() as u32 {
            let moved = model.displacement(node).norm();
            assert!(moved < 1.0e-9 * settled, "{kernel:?}: {moved} {settled}");
        }
        assert!(report.unbalanced < 1.0e-9, "{kernel:?}: {report:?}");
    }
}

/// A uniform stress in a body that is held all around is balanced: load and residual are both rounding, and neither an
/// unbalanced force nor a displacement is reported. Held on one side less, the same stress is unbalanced by itself.
#[test]
fn a_uniform_stress_in_a_held_body_is_no_load() {
    let mesh = super::bent_box(Vec3::new(12.0, 9.0, 10.0), [4, 3, 3], 0.4);
    for stress in [
        [-5.0e6, -2.5e6, -5.0e6, 0.0, 0.0, 0.0],
        [1.0, 2.0, -3.0, 0.4, 0.5, -0.6],
    ] {
        let rests = |held: &[&str]| {
            let mut state = State::at_rest(mesh.node_count());
            state.initial_stress = vec![Stress(stress); mesh.element_count()];
            let body = held.iter().fold(elastic_body(&mesh), |body, face| {
                body.support(Support::fixed(face_nodes(&mesh, face)))
            });
            let mut model = body.start(state).build().unwrap();
            let report = model
                .equilibrate(&StaticOptions::default(), &mut |_| {})
                .unwrap();
            let moved = (0..mesh.node_count() as u32).map(|node| model.displacement(node));
            (report, super::largest(moved))
        };
        let faces = ["left", "right", "front", "back", "bottom", "top"];
        let (report, moved) = rests(&faces);
        assert_eq!((report.load, report.unbalanced, moved), (0.0, 0.0, 0.0));
        let (report, moved) = rests(&faces[..5]);
        assert!(
            (report.unbalanced - 1.0).abs() < 1e-12 && moved > 0.0,
            "{report:?}"
        );
    }
}
