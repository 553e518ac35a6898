//! Section forces of a body that went through stages.

use powerhouse_explicit_core::observe::{Cut, CutSource, SectionForces};
use powerhouse_explicit_core::{
    Leapfrog, Model, NodalForce, RunOptions, Stage, StageModel, StaticOptions, Support, run,
    run_stages,
};
use powerhouse_model::{Cadence, Mesh, State, Vec3};

use super::{GRAVITY, elastic, face_nodes, rock};

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

/// Section forces of the pillar, cut at some heights, while it stands still after its stages.
fn at_rest(
    sources: impl Fn(&[Vec<u32>; 2]) -> Vec<Vec<u32>>,
    heights: &[f64],
) -> Result<Vec<[f64; 9]>, String> {
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
            .elements("pillar", elastic("pillar", rock()))
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

    let factory = elastic("pillar", rock());
    let mut forces = SectionForces::new(Cadence::Steps(1)).unwrap();
    let sources = sources(&halves);
    let of_cut: Vec<CutSource> = sources
        .iter()
        .map(|elements| CutSource {
            elements,
            factory: &*factory,
            medium: rock(),
        })
        .collect();
    for height in heights {
        let cut = Cut {
            name: format!("at {height}"),
            point: Vec3::z() * *height,
            normal: Vec3::z(),
            along: Vec3::y(),
            within: None,
        };
        forces.add_cut(&mesh, &cut, &of_cut).unwrap();
    }
    let table = forces.recording();
    let options = RunOptions::steps(3);
    run(
        &mut model,
        &Leapfrog,
        &options,
        &mut [Box::new(forces)],
        &mut |_| {},
    )
    .map_err(|failure| failure.to_string())?;
    let last = table.read(|table| -> Vec<f64> {
        let columns = table.columns.iter();
        columns
            .map(|column| *column.values.last().unwrap())
            .collect()
    });
    let cuts = last.chunks_exact(9);
    Ok(cuts.map(|cut| core::array::from_fn(|i| cut[i])).collect())
}

/// Sections of a body at rest after stages carry the weight above them and the moments of the pushes: in
/// the foot, which bent before the head was cast, as in the head, which counts from there.
#[test]
fn what_stages_left_counts() {
    let heights = [2.1, 4.3, 6.3];
    let found = at_rest(|halves| halves.to_vec(), &heights).unwrap();
    let weight = rock().density * 9.81;
    for ([axial, shear, _, _, moment, ..], height) in found.into_iter().zip(heights) {
        let above = HEIGHT - height;
        let of_middle = (0.5 * HEIGHT - height).max(0.0);
        let pushes = if of_middle > 0.0 { 2.0 } else { 1.0 };
        let expected = [-weight * above, pushes * PUSH, PUSH * (above + of_middle)];
        for (found, expected) in [axial, shear, -moment].into_iter().zip(expected) {
            assert!(
                (found / expected - 1.0).abs() < 1.0e-3,
                "{height}: {found} {expected}"
            );
        }
    }
}

/// Elements that were cast in different stages cannot be one source: their strains count from different
/// displacements.
#[test]
fn a_source_of_several_casts_is_refused() {
    let together = |halves: &[Vec<u32>; 2]| vec![halves.concat()];
    let refused = at_rest(together, &[0.5 * HEIGHT + 0.1]).unwrap_err();
    assert!(
        refused.contains("'at 4.1'") && refused.contains("different stages"),
        "{refused}"
    );
    at_rest(together, &[2.1]).unwrap();
}
