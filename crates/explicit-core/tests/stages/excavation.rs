//! Elements that go and come.

use powerhouse_explicit_core::{BuildModel, Model, run_stages};
use powerhouse_model::{
    Mesh, Stage, StageError, StageEvent, StageModel, State, StaticError, StaticOptions, Stress,
    StressField, Vec3,
};

use super::{GRAVITY, bent_box, elastic, elastic_body, largest, on_rollers, rock};

/// Rock on rollers under its weight.
fn ground<'a>(mesh: &'a Mesh) -> Box<StageModel<'a>> {
    Box::new(|builder| {
        let builder = builder.elements("ground", elastic("ground", rock()));
        Ok(on_rollers(mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    })
}

fn between(mesh: &Mesh, low: [f64; 3], high: [f64; 3]) -> Vec<u32> {
    mesh.elements_in_box(&low.into(), &high.into())
}

fn exact() -> StaticOptions {
    StaticOptions::default().with_tolerance(1.0e-11)
}

/// A cavern excavated in 1, 3 or 10 increments, or in two stages of 40 % and the rest, leaves the
/// same elastic state, to 1e-8, and that of a body that had the hole when its weight came. Elements
/// that are gone bear no stress, their nodes have no mass and stay where they were.
#[test]
fn an_elastic_excavation_does_not_depend_on_its_increments() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 40.0), [8, 6, 8], 1.0);
    let cavern = between(&mesh, [15.0, 10.0, 10.0], [25.0, 20.0, 20.0]);
    assert_eq!(cavern.len(), 8);
    let body = ground(&mesh);
    let first = || State::at_rest(mesh.node_count());
    let excavated = |options: &[StaticOptions]| {
        let mut stages = vec![Stage::new("weight", &body).options(exact())];
        for (i, options) in options.iter().enumerate() {
            let stage = Stage::new("excavation", &body).options(*options);
            let gone: &[u32] = if i == 0 { &cavern } else { &[] };
            stages.push(stage.excavate(gone));
        }
        run_stages(&mesh, first(), &stages, &mut |_| {}).unwrap().0
    };
    let once = excavated(&[exact()]);
    let mut with_hole = first();
    with_hole.remove(&cavern);
    let (with_hole, _) = run_stages(
        &mesh,
        with_hole,
        &[Stage::new("weight", &body).options(exact())],
        &mut |_| {},
    )
    .unwrap();
    let nodes_left: Vec<usize> = {
        let all = 0..mesh.element_count() as u32;
        let left: Vec<u32> = all.filter(|e| !cavern.contains(e)).collect();
        let nodes = mesh.nodes_of_elements(&left);
        nodes.into_iter().map(|node| node as usize).collect()
    };
    let size = largest(once.displacement.iter().copied());
    assert!(size > 1.0e-4);
    for other in [
        excavated(&[exact().with_increments(3)]),
        excavated(&[exact().with_increments(10)]),
        excavated(&[exact().with_release(0.4), exact()]),
        with_hole,
    ] {
        for &node in &nodes_left {
            let error = (other.displacement[node] - once.displacement[node]).norm();
            assert!(error < 1.0e-8 * size, "{error} {size}");
        }
    }

    let body = elastic_body(&mesh);
    let model = body.start(once.clone()).build().unwrap();
    for &element in &cavern {
        assert_eq!(model.stress_changes()[element as usize], Stress::default());
    }
    let orphan = (0..mesh.node_count()).find(|node| !nodes_left.contains(node));
    let orphan = orphan.expect("a node inside the cavern");
    assert_eq!(model.mass(orphan as u32), 0.0);
    let whole = elastic_body(&mesh).build().unwrap();
    let masses = |model: &Model| -> f64 {
        let nodes = 0..mesh.node_count() as u32;
        nodes.map(|node| model.mass(node)).sum()
    };
    assert!(masses(&model) < masses(&whole));
}

/// A column that loses its upper half rises by the weight that is gone, `W z / M`, to 1e-8: with its
/// own weight turned on, or under a stress that was there first. Of 40 % of the release comes 40 %.
#[test]
fn a_column_rises_by_the_weight_that_is_gone() {
    let size = Vec3::new(10.0, 10.0, 40.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 2, 8], "ground").unwrap();
    let upper = between(&mesh, [0.0, 0.0, 20.0], [10.0, 10.0, 40.0]);
    let body = ground(&mesh);
    let weight = rock().density * GRAVITY.norm();
    let mut pressed = State::at_rest(mesh.node_count());
    pressed.initial_stress = StressField::geostatic(40.0, weight, [0.6, 0.6])
        .unwrap()
        .of_elements(&mesh);
    for first in [State::at_rest(mesh.node_count()), pressed] {
        for release in [0.4, 1.0] {
            let stages = [
                Stage::new("weight", &body).options(exact()),
                Stage::new("excavation", &body)
                    .excavate(&upper)
                    .options(exact().with_release(release)),
            ];
            let mut before = Vec::new();
            let (after, reports) = run_stages(&mesh, first.clone(), &stages, &mut |event| {
                if let StageEvent::Equilibrated { model, report } = event
                    && report.name == "weight"
                {
                    let nodes = 0..mesh.node_count() as u32;
                    before = nodes.map(|node| model.displacement(node)).collect();
                }
            })
            .unwrap();
            let top = release * weight * 20.0 * 20.0 / rock().constrained();
            assert!((reports[1].largest_displacement.0 / top - 1.0).abs() < 1.0e-8);
            for (node, p) in mesh.positions().iter().enumerate() {
                if p.z <= 20.0 {
                    let risen = after.displacement[node] - before[node];
                    let expected = Vec3::z() * (top * p.z / 20.0);
                    assert!((risen - expected).norm() < 1.0e-8 * top);
                }
            }
        }
    }
}

/// What is cast on a column that has already settled is free of stress but for its own weight,
/// though its nodes have moved by more than it bears; the column below feels the new weight.
#[test]
fn what_is_cast_later_bears_its_own_weight_alone() {
    let size = Vec3::new(10.0, 10.0, 40.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 2, 8], "ground").unwrap();
    let upper = between(&mesh, [0.0, 0.0, 20.0], [10.0, 10.0, 40.0]);
    let body = ground(&mesh);
    let weight = rock().density * GRAVITY.norm();
    let mut first = State::at_rest(mesh.node_count());
    first.remove(&upper);
    let stages = [
        Stage::new("weight", &body).options(exact()),
        Stage::new("cast", &body).cast(&upper).options(exact()),
    ];
    let mut stresses = Vec::new();
    let (state, _) = run_stages(&mesh, first, &stages, &mut |event| {
        if let StageEvent::Equilibrated { model, .. } = event {
            stresses = model.output().unwrap().stress_changes();
        }
    })
    .unwrap();
    assert!(state.absent.is_empty() && state.casts.len() == 1);
    for (element, stress) in stresses.iter().enumerate() {
        let depth = 40.0 - mesh.centroid(element as u32).z;
        let expected = -weight * depth;
        assert!(
            (stress.0[2] / expected - 1.0).abs() < 1.0e-8,
            "{stress:?} {expected}"
        );
    }
    // The joint plane settles by the weight below it and above it.
    let plane = mesh.positions().iter().position(|p| p.z == 20.0).unwrap();
    let settled = weight * (20.0 * 20.0 + 0.5 * 20.0 * 20.0) / rock().constrained();
    assert!((state.displacement[plane].z / -settled - 1.0).abs() < 1.0e-8);

    // Taken over by another model, the state holds by itself, the casting included.
    let again = Stage::new("again", &body).options(exact());
    let (_, reports) = run_stages(&mesh, state, &[again], &mut |_| {}).unwrap();
    assert!(reports[0].largest_displacement.0 < 1.0e-9 * settled);
}

/// A block that an excavation cuts loose is named with the stage; so are elements that are taken
/// out twice or cast where they stand.
#[test]
fn stages_that_cannot_be_are_refused() {
    let size = Vec3::new(10.0, 10.0, 40.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 2, 8], "ground").unwrap();
    let middle = between(&mesh, [0.0, 0.0, 15.0], [10.0, 10.0, 25.0]);
    let body: Box<StageModel> = Box::new(|builder| {
        let bottom = mesh.nodes_of_facets(mesh.facet_set("bottom")?);
        let fixed = powerhouse_model::Support::fixed(bottom);
        let builder = builder.elements("ground", elastic("ground", rock()));
        Ok(builder
            .support(fixed)
            .gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    });
    let fails = |stages: &[Stage]| {
        let first = State::at_rest(mesh.node_count());
        run_stages(&mesh, first, stages, &mut |_| {}).unwrap_err()
    };
    let cut = fails(&[Stage::new("cut", &body).excavate(&middle)]);
    assert!(matches!(
        cut,
        StageError::NotEquilibrated { stage, source: StaticError::Floating { elements: 12, .. } } if stage == "cut"
    ));
    let twice = [
        Stage::new("once", &body).excavate(&[31]),
        Stage::new("twice", &body).excavate(&[31]),
    ];
    assert!(matches!(
        fails(&twice),
        StageError::Elements { stage, element: 32, .. } if stage == "twice"
    ));
    let there = fails(&[Stage::new("again", &body).cast(&[0])]);
    assert!(there.to_string().contains("is active already"), "{there}");
}
