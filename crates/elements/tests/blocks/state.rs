//! State of blocks: history, activity, reference, initial stress, work.

use super::*;

/// Forces can be evaluated any number of times from the committed history, which changes only at a commit.
#[test]
fn history_is_committed_apart() {
    let kernel = SolidKernel::Hex8Full;
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let (small, large) = (fixture.noise(1, 1e-4), fixture.noise(1, 1e-2));
    let rest = zeros(small.len());
    let before = fixture.forces(&small, &rest);
    let tried = fixture.forces(&large, &rest);
    assert_eq!(fixture.forces(&small, &rest), before);
    assert_eq!(fixture.forces(&large, &rest), tried);
    fixture.block.commit();
    let after = fixture.forces(&small, &rest);
    assert!(largest(&after) < 0.5 * largest(&before));

    let saved = fixture.block.history();
    assert_eq!((saved[0].points, saved[0].values.len()), (8, 27 * 8));
    let mut other = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    other.block.set_history(&saved);
    assert_eq!(other.forces(&small, &rest), after);
    assert_eq!(other.block.history(), saved);
}

/// With in-place updates forces and histories have the same bits as with buffered ones, elements that are
/// inactive for a while included; further forces start from the overwritten history.
#[test]
fn in_place_updates_have_the_bits_of_buffered_ones() {
    for precision in [Precision::F64, Precision::Mixed] {
        let options = options(precision, LaneWidth::Native, 0.0);
        let new = || Fixture::new(SolidKernel::Wedge6, Softening(rock()), options);
        let [mut in_place, mut buffered] = [new(), new()];
        let count = in_place.block.elements().len();
        for step in 0..8 {
            let active: Vec<bool> = (0..count)
                .map(|e| e % 3 != 0 || !(3..5).contains(&step))
                .collect();
            // A step after which nothing has changed, and one that starts afresh.
            let amplitude = if step == 6 { 1e-5 } else { 1e-3 };
            let u = in_place.noise(step, amplitude);
            let rest = zeros(u.len());
            let views = [NodalView::F64(&u), NodalView::F64(&rest)];
            let context = BlockContext::new(when(step, 1e-4), views[0], views[1]);
            let mut forces = Vec::new();
            for (fixture, repeats) in [(&mut in_place, false), (&mut buffered, true)] {
                fixture.block.stateful_mut().unwrap().set_active(&active);
                let context = context.with_repeats(repeats);
                forces.push(fixture.forces_at(&context).unwrap());
                fixture.block.commit();
            }
            assert_eq!(forces[0], forces[1], "{precision:?}, step {step}");
            assert_eq!(in_place.block.history(), buffered.block.history());
        }
        // There is one history: further forces start from the new one.
        let (u, more) = (in_place.noise(9, 1e-4), in_place.noise(10, 1e-1));
        let rest = zeros(u.len());
        let before = in_place.forces(&u, &rest);
        let views = [NodalView::F64(&more), NodalView::F64(&rest)];
        let context = BlockContext::new(when(9, 1e-4), views[0], views[1]).with_repeats(false);
        in_place.forces_at(&context).unwrap();
        assert!(largest(&in_place.forces(&u, &rest)) < 0.5 * largest(&before));
    }
}

/// A stress that is not finite is a fault of its element, also where the history from which it came was
/// overwritten and the new one leads to no such stress.
#[test]
fn a_fault_is_found_after_an_in_place_update() {
    /// The stress is NaN in the step in which the strain first exceeds a hundredth.
    #[derive(Clone)]
    struct Flash(ElasticMedium);
    impl ConstitutiveLaw for Flash {
        fn name(&self) -> &str {
            "flash"
        }
        fn medium(&self) -> ElasticMedium {
            self.0
        }
        fn history(&self) -> &'static [HistoryVariable] {
            const { &[HistoryVariable::flags("flashed")] }
        }
        #[inline(always)]
        fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
            let any = input.strain.0[0];
            let one = any.constant(1.0);
            let beyond = any.constant(1e-2).less(any.abs());
            new[0] = one.select(beyond, input.history[0]);
            let calm = one - (new[0] - input.history[0]);
            let lambda = any.constant(self.0.lambda());
            let shear = any.constant(self.0.shear());
            Stress::elastic(lambda, shear, &input.strain) * (calm / calm)
        }
    }
    let mut fixture = Fixture::new(
        SolidKernel::Hex8Full,
        Flash(rock()),
        BlockOptions::default(),
    );
    // One corner is pulled.
    let end = fixture.mesh.positions()[0];
    let u = fixture.field(|x| Vec3::x() * if *x == end { -0.5 } else { 0.0 });
    let rest = zeros(u.len());
    let views = [NodalView::F64(&u), NodalView::F64(&rest)];
    let context = BlockContext::new(when(0, 1e-4), views[0], views[1]);
    let element = fixture.mesh.nodes_of(0);
    assert!(
        element.contains(&0),
        "the corner belongs to the first element"
    );
    let fault = fixture.forces_at(&context).unwrap_err();
    assert_eq!(
        (fault.element, &*fault.reason),
        (0, "its stress is not finite")
    );
    let fault = fixture.forces_at(&context.with_repeats(false)).unwrap_err();
    assert_eq!(fault.element, 0);
    assert!(fault.reason.contains("force"), "{}", fault.reason);
}

/// Inactive elements have neither force, mass, stress, energy nor bound, and their history stays.
#[test]
fn inactive_elements_are_not_there() {
    let kernel = SolidKernel::Wedge6;
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let u = fixture.noise(1, 1e-3);
    let rest = zeros(u.len());
    let all = fixture.forces(&u, &rest);
    let count = fixture.block.elements().len();
    let mut sum = vec![Vec3::zeros(); u.len()];
    let mut mass = vec![0.0; u.len()];
    for share in 0..2 {
        let active: Vec<bool> = (0..count).map(|e| e % 2 == share).collect();
        fixture.block.stateful_mut().unwrap().set_active(&active);
        for (sum, force) in sum.iter_mut().zip(fixture.forces(&u, &rest)) {
            *sum += force;
        }
        fixture.block.add_mass(&mut mass);
        assert_eq!(fixture.block.frequency_bounds().len(), count / 2);
        let stress = fixture.stress(&u);
        assert!((0..count).all(|e| (stress[e] != Stress::default()) == active[e]));
        fixture.block.commit();
        let history = &fixture.block.history()[0].values;
        let grown = |e: usize| history[6 * e..6 * e + 6].iter().all(|&h| h > 0.0);
        assert!((0..count).all(|e| grown(e) == (e % 2 <= share)));
        fixture
            .block
            .stateful_mut()
            .unwrap()
            .set_active(&vec![true; count]);
        let values = (0..6 * count)
            .map(|i| {
                if (i / 6) % 2 <= share {
                    history[i]
                } else {
                    0.0
                }
            })
            .collect();
        let elements = fixture.block.elements().to_vec();
        let field = powerhouse_model::HistoryField::new("largest_strain", elements, 6, values);
        fixture.block.set_history(&[field]);
    }
    let scale = largest(&all);
    for (sum, force) in sum.iter().zip(&all) {
        assert!((sum - force).norm() < 1e-13 * scale);
    }
    assert!((mass.iter().sum::<f64>() - 2750.0 * 216.0).abs() < 1e-8);
}

/// What is cast in a deformed state is free of stress and hourglass force there, and answers to
/// what comes after as if it had been cast undeformed.
#[test]
fn strain_is_measured_from_the_reference() {
    for kernel in SolidKernel::ALL {
        for precision in [Precision::F64, Precision::Mixed] {
            let options = options(precision, LaneWidth::Native, 0.0);
            let mut fixture = Fixture::new(kernel, Linear(rock()), options);
            let (deformed, more) = (fixture.noise(1, 0.1), fixture.noise(2, 1e-3));
            let rest = zeros(more.len());
            let expected = fixture.forces(&more, &rest);
            fixture
                .block
                .set_reference_displacement(NodalView::F64(&deformed));
            assert_eq!(largest(&fixture.forces(&deformed, &rest)), 0.0);
            let both: Vec<Quad<f64>> = deformed
                .iter()
                .zip(&more)
                .map(|(a, b)| Quad::from_vector(&(a.to_vector() + b.to_vector())))
                .collect();
            let forces = fixture.forces(&both, &rest);
            let tolerance = if precision == Precision::F64 {
                1e-12
            } else {
                2e-6
            };
            for (force, expected_force) in forces.iter().zip(&expected) {
                let error = (force - expected_force).norm() / largest(&expected);
                assert!(error < tolerance, "{error}");
            }
        }
    }
}

/// A law receives the initial stress, and only the change of stress makes forces.
#[test]
fn initial_stress_reaches_the_law() {
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let u = fixture.noise(1, 1e-4);
    let rest = zeros(u.len());
    let fresh = fixture.forces(&u, &rest);
    fixture
        .block
        .set_initial_stress(&vec![Stress([-9e7, -9e7, -9e7, 0.0, 0.0, 0.0]); 27]);
    assert!(largest(&fixture.forces(&u, &rest)) < 0.5 * largest(&fresh));
    assert_eq!(largest(&fixture.forces(&rest, &rest)), 0.0);
}

/// Free motion keeps the sum of kinetic, elastic, hourglass, plastic and damping energy to
/// round-off: each term comes from the elements.
#[test]
fn the_ledger_closes() {
    fn residual<M: ConstitutiveLaw>(kernel: SolidKernel, law: M, stiffness: f64) -> f64 {
        let damped = options(Precision::F64, LaneWidth::Native, stiffness);
        let mut fixture = Fixture::new(kernel, law, damped);
        let rest = zeros(fixture.masses().len());
        let (first, worst, energy) = fixture.free_motion(rest);
        let spent = energy.plastic + energy.damping;
        if stiffness > 0.0 || !fixture.block.history().is_empty() {
            assert!(spent > 0.01 * first, "{spent} of {first}");
        }
        worst
    }
    for kernel in SolidKernel::ALL {
        for stiffness in [0.0, 2e-5] {
            let linear = residual(kernel, Linear(rock()), stiffness);
            assert!(linear < 1e-12, "{} {linear}", kernel.name());
            let softening = residual(kernel, Softening(rock()), stiffness);
            assert!(softening < 1e-12, "{} {softening}", kernel.name());
            let yielding = residual(kernel, Yielding(rock(), 5e-5), stiffness);
            assert!(yielding < 1e-12, "{} {yielding}", kernel.name());
        }
    }
}

/// For a law without change of history in a static state of uniform damage the secant is the stress over strain, and
/// the tangent the derivative of the forces.
#[test]
fn secant_and_tangent_follow_the_state() {
    for kernel in SolidKernel::ALL {
        let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
        let gradient = GRADIENT * 1e-3;
        let u = fixture.field(|x| gradient * x);
        let forces = fixture.static_forces(&u);
        let scale = largest(&forces);
        let secant = fixture.apply(Operator::Secant, &u);
        for (secant, force) in secant.iter().zip(&forces) {
            assert!((secant - force).norm() < 1e-12 * scale);
        }
        let direction = fixture.noise(9, 1e-3);
        let tangent = fixture.apply(Operator::Tangent, &direction);
        let h = 1e-4;
        let mut at = |offset: f64| {
            let moved: Vec<Quad<f64>> = u
                .iter()
                .zip(&direction)
                .map(|(u, d)| Quad::from_vector(&(u.to_vector() + d.to_vector() * offset)))
                .collect();
            fixture.static_forces(&moved)
        };
        let (plus, minus) = (at(h), at(-h));
        for ((tangent, plus), minus) in tangent.iter().zip(&plus).zip(&minus) {
            let quotient = (plus - minus) / (2.0 * h);
            assert!(
                (tangent - quotient).norm() < 1e-6 * scale,
                "{}",
                kernel.name()
            );
        }
    }
}

/// The forces of single elements add up to those of the block, with a law with history variables, under initial
/// stresses and from a reference displacement, in blocks of many elements and of a few; inactive elements have
/// none.
#[test]
fn forces_of_elements_add_up_to_those_of_the_block() {
    for kernel in SolidKernel::ALL {
        for (precision, tolerance) in [(Precision::F64, 1e-12), (Precision::Mixed, 1e-5)] {
            for cells in [[3, 3, 3], [2, 2, 1]] {
                let mesh = distorted(kernel.kind(), cells);
                let options = options(precision, LaneWidth::Native, 0.0);
                let mut fixture = Fixture::of(mesh, kernel, Softening(rock()), options);
                let elements = fixture.block.elements().len();
                let mut noise = Noise(3);
                let initial: Vec<Stress> = (0..elements)
                    .map(|_| Stress([(); 6].map(|()| 1e6 * noise.next())))
                    .collect();
                let (reference, before, now) = (
                    fixture.noise(4, 1e-3),
                    fixture.noise(5, 2e-3),
                    fixture.noise(6, 1e-3),
                );
                let off = elements / 2;
                let active: Vec<bool> = (0..elements).map(|element| element != off).collect();
                let block = &mut fixture.block;
                block.stateful_mut().unwrap().set_active(&active);
                block.set_initial_stress(&initial);
                block.set_reference_displacement(NodalView::F64(&reference));
                let rest = zeros(now.len());
                fixture.forces(&before, &rest);
                fixture.block.commit();
                let mut expected = fixture.forces(&now, &rest);
                fixture
                    .block
                    .stateful()
                    .unwrap()
                    .add_forces_of(&initial, &mut expected);

                let mut sums = vec![Vec3::zeros(); expected.len()];
                for (element, place) in fixture.block.elements().iter().zip(0..) {
                    let nodes = fixture.mesh.nodes_of(*element);
                    let mut forces = vec![Vec3::repeat(f64::NAN); nodes.len()];
                    let view = NodalView::F64(&now);
                    let output = fixture.block.output().unwrap();
                    let of_elements = output.element_forces().unwrap();
                    of_elements.write_forces(place, view, &initial[place], &mut forces);
                    assert!(place != off || largest(&forces) == 0.0);
                    for (&node, force) in nodes.iter().zip(&forces) {
                        sums[fixture.place(node)] += force;
                    }
                }
                for (sum, expected_force) in sums.iter().zip(&expected) {
                    let error = (sum - expected_force).norm() / largest(&expected);
                    assert!(error < tolerance, "{kernel:?} {precision:?} {error}");
                }
            }
        }
    }
}
