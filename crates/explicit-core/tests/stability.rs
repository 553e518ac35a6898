//! The stable step: against the dense eigenvalue, at the limit and past it.

use crate::support::{Links, chain, dense_limit, hex_box, random_vectors};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, OneSided, run};
use powerhouse_model::{
    ElementKind, LimitingTerm, PeriodicPairs, RunError, RunOptions, StepChoice, Support,
    TimeIntegrator, Vec3,
};

fn rock() -> Links {
    Links::new("rock", ElementKind::Hex8, 9.0e9, 0.3, 2700.0)
}

/// The reported step lies between 0.95 and 1.000 of the limit from the dense eigenvalue of the
/// same model, on regular and on distorted meshes, free and supported.
#[test]
fn the_reported_step_is_just_below_the_true_limit() {
    for jitter in [0.0, 0.15, 0.3] {
        let mesh = hex_box([5, 4, 4], 1.0, jitter);
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let floor = mesh.node_set("z0").unwrap().to_vec();
        for fixed in [vec![], floor] {
            let truth = dense_limit(&mesh, &rock(), &all, &fixed);
            let mut model = Model::builder(&mesh)
                .elements("rock", rock().boxed())
                .support(Support::fixed(fixed))
                .build()
                .unwrap();
            let report = model.stable_step(&Leapfrog).unwrap();
            let share = report.step / truth;
            assert!((0.95..=1.0).contains(&share), "jitter {jitter}: {share}");
            assert!(report.converged);
            assert!(report.element_bound <= truth);
        }
    }
}

/// At the reported step the motion of a random start stays bounded over 1e5 steps; at 1.01 of the
/// true limit the run is stopped, naming a step, and an element of the set that limits.
#[test]
fn at_the_limit_bounded_and_past_it_stopped() {
    let mesh = hex_box([3, 3, 2], 1.0, 0.25);
    let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
    let count = mesh.node_count();
    let build = || {
        Model::builder(&mesh)
            .elements("rock", rock().boxed())
            .build()
            .unwrap()
    };
    let start = |model: &mut Model| {
        let velocity = random_vectors(count, 1.0, 5);
        model
            .set_initial(&vec![Vec3::zeros(); count], &velocity)
            .unwrap();
    };
    let mut model = build();
    start(&mut model);
    let options = RunOptions::steps(100_000);
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let fastest = (0..count as u32)
        .map(|n| model.velocity(n).norm())
        .fold(0.0, f64::max);
    // The kinetic energy cannot exceed that of the start by more than the distance to the limit
    // allows, 1 / (1 - 0.98^2).
    let energy = |model: &Model| -> f64 {
        (0..count as u32)
            .map(|n| 0.5 * model.mass(n) * model.velocity(n).norm_squared())
            .sum()
    };
    let at_start = {
        let mut fresh = build();
        start(&mut fresh);
        energy(&fresh)
    };
    assert!(fastest.is_finite());
    assert!(energy(&model) < at_start / (1.0 - 0.98 * 0.98));

    let truth = dense_limit(&mesh, &rock(), &all, &[]);
    let mut model = build();
    start(&mut model);
    let options = RunOptions::steps(100_000).with_step(StepChoice::Unchecked(1.01 * truth));
    let error = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap_err();
    match error {
        RunError::Diverged {
            step,
            element,
            set,
            node,
            ..
        } => {
            assert!(step < 1000);
            assert_eq!(set, "rock");
            assert!(mesh.element_tags().contains(&element));
            assert!(mesh.node_tags().contains(&node));
        }
        other => panic!("{other}"),
    }
}

/// A fixed step above the limit is refused before the run, with the limit.
#[test]
fn a_step_above_the_limit_is_refused() {
    let mesh = hex_box([3, 2, 2], 1.0, 0.1);
    let mut model = Model::builder(&mesh)
        .elements("rock", rock().boxed())
        .build()
        .unwrap();
    let limit = model.stable_step(&Leapfrog).unwrap().step;
    let options = RunOptions::steps(1).with_step(StepChoice::Fixed(1.001 * limit));
    let error = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap_err();
    assert!(matches!(error, RunError::UnstableStep { limit: l, .. } if l == limit));
    assert_eq!(model.steps_taken(), 0);
}

/// The report names the element, its set and the term that limits, and what the next set allows.
#[test]
fn the_report_names_who_limits() {
    let mesh = hex_box([4, 4, 4], 1.0, 0.0);
    let stiff = vec![21];
    let rest: Vec<u32> = (0..64).filter(|e| *e != 21).collect();
    let build = |damping: f64| {
        let concrete = Links::new("concrete", ElementKind::Hex8, 36.0e9, 0.3, 2700.0);
        Model::builder(&mesh)
            .elements(stiff.clone(), concrete.damped(0.0, damping).boxed())
            .elements(rest.clone(), rock().boxed())
            .build()
            .unwrap()
    };
    let report = build(0.0).stable_step(&Leapfrog).unwrap();
    assert_eq!((report.element, report.set.as_str()), (22, "concrete"));
    assert_eq!(report.term, LimitingTerm::Stiffness);
    assert_eq!(report.similar_elements, 1);
    // Four times the modulus, half the step.
    let gain = report.next_set_bound.unwrap() / report.element_bound;
    assert!((gain - 2.0).abs() < 1e-12);
    let damped = build(report.step).stable_step(&Leapfrog).unwrap();
    assert_eq!(damped.term, LimitingTerm::StiffnessDamping);
    assert!(damped.step < report.step);
    let concrete = Links::new("concrete", ElementKind::Hex8, 36.0e9, 0.3, 2700.0);
    let all: Vec<u32> = (0..64).collect();
    let stopped = Model::builder(&mesh).elements(all, concrete.damped(1e9, 0.0).boxed());
    let stopped = stopped.build().unwrap().stable_step(&Leapfrog).unwrap();
    assert_eq!(
        (stopped.term, stopped.step),
        (LimitingTerm::MassDamping, 2e-9)
    );
    // Whichever set has the damping.
    for [of_stiff, of_rock] in [[1e9, 0.0], [0.0, 1e9], [1e8, 1e9]] {
        let concrete = Links::new("concrete", ElementKind::Hex8, 36.0e9, 0.3, 2700.0);
        let mut model = Model::builder(&mesh)
            .elements(stiff.clone(), concrete.damped(of_stiff, 0.0).boxed())
            .elements(rest.clone(), rock().damped(of_rock, 0.0).boxed())
            .build()
            .unwrap();
        let report = model.stable_step(&Leapfrog).unwrap();
        assert_eq!(
            (report.term, report.step),
            (LimitingTerm::MassDamping, 2e-9)
        );
    }
}

/// The one-sided scheme with a stiffness damping of half a step is the undamped leapfrog, bit for
/// bit in its displacements up to rounding; without damping it is refused.
#[test]
fn the_one_sided_scheme_with_half_a_step_of_damping_is_the_leapfrog() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.2);
    let count = mesh.node_count();
    let step = 5e-5;
    let build = |damping: f64| {
        let mut model = Model::builder(&mesh)
            .elements("rock", rock().damped(0.0, damping).boxed())
            .build()
            .unwrap();
        let velocity = random_vectors(count, 1.0, 2);
        model
            .set_initial(&vec![Vec3::zeros(); count], &velocity)
            .unwrap();
        model
    };
    let options = RunOptions::steps(400).with_step(StepChoice::Fixed(step));
    let go = |model: &mut Model, integrator: &dyn TimeIntegrator| {
        run(model, integrator, &options, &mut [], &mut |_| {})
    };
    let (mut plain, mut one_sided) = (build(0.0), build(0.5 * step));
    go(&mut plain, &Leapfrog).unwrap();
    go(&mut one_sided, &OneSided).unwrap();
    for node in 0..count as u32 {
        let difference = plain.displacement(node) - one_sided.displacement(node);
        assert!(difference.norm() < 1e-12);
    }
    let error = go(&mut build(0.49 * step), &OneSided).unwrap_err();
    assert!(matches!(error, RunError::TooLittleDamping { least, .. } if least == 0.5 * step));
}

/// Damping in a set that does not reach the highest frequency does not shorten the step as if it
/// did; the step given is stable all the same, and one past what the damped set can bear is not.
#[test]
fn damping_is_charged_where_it_acts() {
    let mesh = hex_box([6, 3, 3], 1.0, 0.1);
    let (soft, stiff): (Vec<u32>, Vec<u32>) =
        (0..mesh.element_count() as u32).partition(|&e| mesh.centroid(e).x < 3.0);
    let count = mesh.node_count();
    let damping = 1.0e-3;
    let build = || {
        let clay = Links::new("clay", ElementKind::Hex8, 9.0e7, 0.3, 2700.0);
        let mut model = Model::builder(&mesh)
            .elements(soft.clone(), clay.damped(0.0, damping).boxed())
            .elements(stiff.clone(), rock().boxed())
            .build()
            .unwrap();
        let velocity = random_vectors(count, 1.0, 5);
        model
            .set_initial(&vec![Vec3::zeros(); count], &velocity)
            .unwrap();
        model
    };
    let mut model = build();
    let report = model.stable_step(&Leapfrog).unwrap();
    // Charged to the stiff set's frequency, the damping would take most of the step.
    let w = 2.0 / report.assembled_limit;
    let z = 0.5 * damping * w;
    let charged = 2.0 / (w * (z.hypot(1.0) + z));
    assert!(report.step > 3.0 * charged);
    run(
        &mut model,
        &Leapfrog,
        &RunOptions::steps(20_000),
        &mut [],
        &mut |_| {},
    )
    .unwrap();
    let past = StepChoice::Unchecked(1.01 * report.assembled_limit);
    let options = RunOptions::steps(20_000).with_step(past);
    let error = run(&mut build(), &Leapfrog, &options, &mut [], &mut |_| {}).unwrap_err();
    assert!(matches!(error, RunError::Diverged { .. }));
}

/// Supports and ties take part in the limit: a bar of two elements has `w^2 = 4 k/m` free and
/// `2 k/m` held at both ends, a ring of three `3 k/m`, with the mass `m` and stiffness `k` of one
/// element.
#[test]
fn supports_and_ties_take_part_in_the_limit() {
    let (young, density) = (9.0e9_f64, 2700.0);
    let bars = || Links::new("bar", ElementKind::Bar2, young, 1.0, density).boxed();
    let two = chain(2, 1.0);
    let three = chain(3, 1.0);
    let across: Vec<u32> = (0..3).collect();
    let pair = PeriodicPairs {
        pairs: vec![(0, 3)],
    };
    let cases = [
        (4.0, Model::builder(&two)),
        (
            2.0,
            Model::builder(&two).support(Support::fixed(vec![0, 2])),
        ),
        (
            2.0,
            Model::builder(&two)
                .support(Support::roller(vec![0, 2], Vec3::x()))
                .support(Support::roller(across, Vec3::y())),
        ),
        (3.0, Model::builder(&three).periodic(pair)),
    ];
    for (factor, builder) in cases {
        let mut model = builder.elements("bar", bars()).build().unwrap();
        let exact = 2.0 / (factor * young / density).sqrt();
        let report = model.stable_step(&Leapfrog).unwrap();
        assert!(
            (report.assembled_limit / exact - 1.0).abs() < 1e-9,
            "{factor}"
        );
    }
}
