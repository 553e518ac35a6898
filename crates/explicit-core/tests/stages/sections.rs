//! Section forces of a body that went through stages.

use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run, run_stages};
use powerhouse_model::{
    BlockFactory, BlockOptions, Cadence, Mesh, Observer, Precision, RunOptions, Stage, StageModel,
    State, StaticOptions, StressField, Support, Vec3,
};
use powerhouse_observe::{CrossSection, SectionForces};

use super::{BRICK, Elastic, GRAVITY, Yielding, elastic_body, face_nodes, on_rollers, rock, weak};

/// A pillar of which the upper half is cast on the lower one; pushes at half its height, from the start,
/// and at its head.
const HEIGHT: f64 = 8.0;
const PUSH: f64 = 3.0e4;

fn pillar() -> (Mesh, [Vec<u32>; 2]) {
    let size = Vec3::new(1.0, 1.0, HEIGHT);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 2, 16], "pillar").unwrap();
    let half = |from: f64| {
        let low = Vec3::new(0.0, 0.0, from);
        mesh.elements_in_box(&low, &(low + Vec3::new(1.0, 1.0, 0.5 * HEIGHT)))
    };
    let halves = [half(0.0), half(0.5 * HEIGHT)];
    (mesh, halves)
}

/// The plastic strain that the pillar shows at most, and its section forces at some heights, while it is in equilibrium
/// still after its stages.
fn at_rest(factory: impl Fn() -> Box<dyn BlockFactory>, heights: &[f64]) -> (f64, Vec<[f64; 9]>) {
    let (mesh, halves) = pillar();
    let middle: Vec<u32> = (mesh.positions().iter().zip(0..))
        .filter(|(position, _)| position.z == 0.5 * HEIGHT)
        .map(|(_, node)| node)
        .collect();
    let body: Box<StageModel> = Box::new(|builder| {
        let push = |nodes: Vec<u32>| {
            let force = Vec3::x() * (PUSH / nodes.len() as f64);
            Box::new(NodalForce::new(nodes, force, Box::new(|_: f64| 1.0)))
        };
        let builder = builder
            .elements("pillar", factory())
            .support(Support::fixed(face_nodes(&mesh, "bottom")))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .load(push(middle.clone()));
        Ok(builder.load(push(face_nodes(&mesh, "top"))))
    });
    let tight = StaticOptions::default().with_tolerance(1.0e-11);
    let stages = [
        Stage::new("foot", &body).options(tight),
        Stage::new("head", &body).cast(&halves[1]).options(tight),
    ];
    let mut first = State::at_rest(mesh.node_count());
    first.remove(&halves[1]);
    let (state, _) = run_stages(&mesh, first, &stages, &mut |_| {}).unwrap();
    let mut model: Model = body(Model::builder(&mesh).start(state))
        .unwrap()
        .build()
        .unwrap();
    model.hand_over(1.0e-6).unwrap();

    let plastic = (model.state().history.iter())
        .filter(|field| field.name == "equivalent_plastic_strain")
        .flat_map(|field| &field.values)
        .fold(0.0_f64, |most, &strain| most.max(strain));
    (plastic, sections(&mut model, "pillar", heights))
}

/// Section forces of a set of a body in static equilibrium at some heights: the nine columns of each section.
fn sections(model: &mut Model, set: &str, heights: &[f64]) -> Vec<[f64; 9]> {
    let mut forces = SectionForces::new(Cadence::Steps(1)).unwrap();
    for height in heights {
        let cut = CrossSection {
            name: format!("at {height}"),
            point: Vec3::z() * *height,
            normal: Vec3::z(),
            along: Vec3::y(),
            within: None,
        };
        let mesh = model.mesh();
        let elements = mesh.element_set(set).unwrap();
        forces.add_section(mesh, &cut, elements).unwrap();
    }
    let table = forces.recording();
    let options = RunOptions::steps(3);
    let observers: &mut [Box<dyn Observer>] = &mut [Box::new(forces)];
    run(model, &Leapfrog, &options, observers, &mut |_| {}).unwrap();
    let last = table.read(|table| -> Vec<f64> {
        let columns = table.columns.iter();
        columns
            .map(|column| *column.values.last().unwrap())
            .collect()
    });
    let cuts = last.chunks_exact(9);
    cuts.map(|cut| core::array::from_fn(|i| cut[i])).collect()
}

/// Sections of a body in static equilibrium after stages carry the weight above them and the moments of the pushes: in
/// the foot, which bent before the head was cast, as in the head, which counts from there; where a part
/// of the section yields as where none does, whatever the kernel.
#[test]
fn what_stages_left_counts() {
    let heights = [0.3, 2.1, 4.3, 6.3];
    let weight = rock().density * 9.81;
    let yielding = Yielding {
        medium: rock(),
        strength: 1.45e6,
    };
    // Two bricks of one point each give way as soon as they yield.
    for (kernel, yields) in [
        (BRICK, false),
        (SolidKernel::Hex8Full, false),
        (SolidKernel::Hex8Full, true),
        (SolidKernel::Hex8BBar, true),
    ] {
        let options = BlockOptions::default;
        let (plastic, found) = if yields {
            at_rest(
                || kernel.factory("pillar", yielding.clone(), options()),
                &heights,
            )
        } else {
            at_rest(
                || kernel.factory("pillar", Elastic(rock()), options()),
                &heights,
            )
        };
        assert_eq!(plastic > 1e-5, yields, "{kernel:?} {plastic:e}");
        for ([axial, shear, _, _, moment, ..], height) in found.into_iter().zip(heights) {
            let above = HEIGHT - height;
            let of_middle = (0.5 * HEIGHT - height).max(0.0);
            let pushes = if of_middle > 0.0 { 2.0 } else { 1.0 };
            let expected = [-weight * above, pushes * PUSH, PUSH * (above + of_middle)];
            for (found, expected) in [axial, shear, -moment].into_iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 1.0e-3,
                    "{kernel:?} {plastic:e} {height}: {found} {expected}"
                );
            }
        }
    }
}

/// Cuts through ground that bears its weight by an initial stress alone, elastic or close to yielding, carry the
/// weight above them.
#[test]
fn initial_stress_counts() {
    let size = Vec3::new(3.0, 2.0, 24.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [3, 2, 12], "ground").unwrap();
    let weight = rock().density * GRAVITY.norm();
    let field = StressField::geostatic(size.z, weight, [0.9, 0.9]).unwrap();
    let mut state = State::at_rest(mesh.node_count());
    state.initial_stress = field.of_elements(&mesh);
    for elastic in [true, false] {
        let body = |state: State| {
            let builder = if elastic {
                elastic_body(&mesh)
            } else {
                Model::builder(&mesh).elements("ground", weak("ground", Precision::F64))
            };
            let held = on_rollers(&mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0));
            held.start(state).build().unwrap()
        };
        let mut at_rest = body(state.clone());
        let options = StaticOptions::default().with_tolerance(1.0e-10);
        at_rest.equilibrate(&options, &mut |_| {}).unwrap();
        let mut model = body(at_rest.state());
        model.hand_over(1.0e-6).unwrap();
        let heights = [4.0, 9.3, 17.5];
        let found = sections(&mut model, "ground", &heights);
        for ([found, ..], height) in found.into_iter().zip(heights) {
            let expected = -weight * (size.z - height) * size.x * size.y;
            // Stress is linear in depth: nothing but rounding and the motion of three steps.
            assert!(
                (found / expected - 1.0).abs() < 1.0e-6,
                "{elastic} {height}: {found} {expected}"
            );
        }
    }
}
