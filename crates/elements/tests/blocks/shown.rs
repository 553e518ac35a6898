//! Steps that are shown: one evaluation of the law serves forces, stresses and energies.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::pore_water::Spared;
use super::*;

/// A block of a law that yields beyond a deviatoric strain of 1e-4, and the number of its evaluations.
fn counted(
    kernel: SolidKernel,
    precision: Precision,
    has_domain: bool,
) -> (Fixture, Arc<AtomicUsize>) {
    let evaluations = Arc::new(AtomicUsize::new(0));
    let law = Spared {
        law: Yielding(rock(), 1e-4),
        has_domain,
        evaluations: evaluations.clone(),
    };
    let options = options(precision, LaneWidth::Native, 1e-5);
    (Fixture::new(kernel, law, options), evaluations)
}

/// Motion that yields towards the top of the body more than at its bottom.
fn motion(fixture: &Fixture, number: u64, size: f64) -> Vec<Quad<f64>> {
    let mut noise = Noise(number);
    fixture.field(|x| noise.vector() * (size * (x.z / 6.0).powi(3)))
}

/// A law is evaluated once at each point in every step, whatever is read of it: by the forces, or within the elastic domain, where
/// forces spare it, at the first read. Elements that condense strains of their own have others after the forces, and evaluate it
/// a second time.
#[test]
fn a_step_that_is_shown_evaluates_the_law_once() {
    for kernel in SolidKernel::ALL {
        for precision in [Precision::F64, Precision::Mixed] {
            let spent = |has_domain, shown, number, size| {
                let (mut fixture, evaluations) = counted(kernel, precision, has_domain);
                let (u, v) = (motion(&fixture, number, size), fixture.noise(9, 0.1));
                let views = [NodalView::F64(&u), NodalView::F64(&v)];
                let context = BlockContext::new(when(number, 1e-4), views[0], views[1])
                    .with_ledger(true)
                    .with_repeats(false)
                    .with_shown(shown);
                fixture.forces_at(&context).unwrap();
                let of_forces = evaluations.load(Ordering::Relaxed);
                if shown {
                    for _ in 0..2 {
                        fixture.stress(&u);
                        fixture.block.energy(&context);
                    }
                }
                [of_forces, evaluations.load(Ordering::Relaxed)]
            };
            let [once, _] = spent(false, false, 3, 1e-3);
            let condenses = kernel == SolidKernel::Hex8Eas;
            let all = if condenses { 2 * once } else { once };
            let name = kernel.name();
            assert_eq!(spent(false, true, 3, 1e-3), [once, all], "{name}");
            let [spared, read] = spent(true, true, 3, 1e-3);
            let whole = if condenses { spared + once } else { once };
            assert!(0 < spared && spared < once, "{name}: {spared} of {once}");
            assert_eq!(read, whole, "{name}");
            assert_eq!(spent(true, true, 3, 1e-6), [0, once], "{name}");
        }
    }
}

/// Forces, stresses, energies and histories of steps that are shown have the bits of steps whose forces may be repeated, of which
/// everything is evaluated from the committed state: with and without an elastic domain, with elements off for a while, and at
/// displacements other than that of the forces.
#[test]
fn shown_values_have_the_bits_of_a_second_evaluation() {
    for kernel in SolidKernel::ALL {
        for (precision, narrow) in [
            (Precision::F64, false),
            (Precision::F64, true),
            (Precision::Mixed, false),
            (Precision::F32, true),
        ] {
            let softening = || {
                Fixture::new(
                    kernel,
                    Softening(rock()),
                    options(precision, LaneWidth::Native, 1e-5),
                )
            };
            let yielding = |has_domain| counted(kernel, precision, has_domain).0;
            for [shown, plain] in [
                [softening(), softening()],
                [yielding(true), yielding(true)],
                [yielding(false), yielding(false)],
            ] {
                same_bits(shown, plain, narrow);
            }
        }
    }
}

/// Compares steps that are shown, of the first block, with steps that may be repeated of the second one.
fn same_bits(mut shown: Fixture, mut plain: Fixture, narrow: bool) {
    let name = format!("{} {}", shown.block.label(), narrow);
    let count = shown.block.elements().len();
    let narrowed = |values: &[Quad<f64>]| -> Vec<Quad<f32>> {
        values
            .iter()
            .map(|value| Quad::from_vector(&value.to_vector()))
            .collect()
    };
    for number in 0..10 {
        let size = 1e-4 * 1.5_f64.powi(number as i32 % 7);
        let (u, v) = (motion(&shown, number, size), shown.noise(number + 20, 0.1));
        let (narrow_u, narrow_v) = (narrowed(&u), narrowed(&v));
        let views = if narrow {
            [NodalView::F32(&narrow_u), NodalView::F32(&narrow_v)]
        } else {
            [NodalView::F64(&u), NodalView::F64(&v)]
        };
        let active: Vec<bool> = (0..count)
            .map(|e| e % 3 != 0 || !(4..6).contains(&number))
            .collect();
        let context = BlockContext::new(when(number, 1e-4), views[0], views[1]).with_ledger(true);
        let contexts = [context.with_shown(true).with_repeats(false), context];
        let pair = [&mut shown, &mut plain];
        let found = pair.into_iter().zip(contexts).map(|(fixture, context)| {
            if number == 4 || number == 6 {
                fixture.block.stateful_mut().unwrap().set_active(&active);
            }
            let forces = fixture.forces_at(&context).unwrap();
            let energy = fixture.block.energy(&context);
            let mut stress = vec![Stress::default(); count];
            fixture.block.add_stress(context.displacement, &mut stress);
            let elsewhere = fixture.stress(&motion(fixture, 50 + number, 2e-4));
            let again = fixture.block.energy(&context);
            assert_eq!(energy, again, "{name}, {number}");
            if number % 2 == 0 {
                fixture.block.commit();
            } else {
                // A state that is put beside the step, without a commit.
                let initial: Vec<Stress> =
                    (0..count).map(|e| Stress([-1e4 * e as f64; 6])).collect();
                fixture.block.set_initial_stress(&initial);
            }
            let after = fixture.block.energy(&context);
            fixture.block.commit();
            (
                forces,
                energy,
                stress,
                elsewhere,
                after,
                fixture.block.history(),
            )
        });
        let found: Vec<_> = found.collect();
        assert!(
            found[0].2.iter().any(|stress| stress.0 != [0.0; 6]),
            "{name}, {number}"
        );
        assert_eq!(found[0].0, found[1].0, "{name}, {number}: forces");
        assert_eq!(found[0].1, found[1].1, "{name}, {number}: energies");
        assert_eq!(found[0].2, found[1].2, "{name}, {number}: stresses");
        assert_eq!(
            found[0].3, found[1].3,
            "{name}, {number}: stresses elsewhere"
        );
        assert_eq!(
            found[0].4, found[1].4,
            "{name}, {number}: energies of a changed state"
        );
        assert_eq!(found[0].5, found[1].5, "{name}, {number}: histories");
    }
}
