//! State of a block between two steps: saved, and restored into a new block.

use powerhouse_model::{HistoryField, StateError};

use super::*;

/// A block that has taken some steps with energy bookkeeping and stiffness damping.
fn moved(precision: Precision, lanes: LaneWidth, steps: core::ops::Range<u64>) -> Fixture {
    let mut fixture = fresh(precision, lanes);
    for step in steps {
        step_of(&mut fixture, step);
    }
    fixture
}

fn fresh(precision: Precision, lanes: LaneWidth) -> Fixture {
    let mesh = distorted(ElementKind::Hex8, [3, 3, 3]);
    let options = options(precision, lanes, 2e-4);
    Fixture::of(
        mesh,
        SolidKernel::Hex8OnePoint(Hex8OnePoint::default()),
        Softening(rock()),
        options,
    )
}

/// Forces and energies of a step, to the bit.
fn step_of(fixture: &mut Fixture, step: u64) -> Vec<u64> {
    let amplitude = 1e-3 * (1.0 + step as f64 % 3.0);
    let (u, v) = (
        fixture.noise(step, amplitude),
        fixture.noise(step + 50, 1e-1),
    );
    let views = [NodalView::F64(&u), NodalView::F64(&v)];
    let context = BlockContext::new(when(step, 1e-4), views[0], views[1]).with_ledger(true);
    let forces = fixture.forces_at(&context).unwrap();
    let energy = fixture.block.energy(&context);
    fixture.block.commit();
    let forces = forces.iter().flat_map(|force| [force.x, force.y, force.z]);
    let sums = [
        energy.elastic,
        energy.hourglass,
        energy.plastic,
        energy.damping,
    ];
    assert!(energy.elastic > 0.0 && energy.damping > 0.0 || step == 0);
    forces.chain(sums).map(f64::to_bits).collect()
}

/// A block that is restored into a new one goes on with the same forces and energies, in every precision, and where its
/// lanes are of another width.
#[test]
fn a_restored_block_goes_on_with_the_same_bits() {
    let widths = [LaneWidth::Native, LaneWidth::One];
    for precision in [Precision::F64, Precision::Mixed] {
        for (before, after) in [(0, 0), (0, 1), (1, 0)] {
            let mut whole = moved(precision, widths[before], 0..4);
            let saved = whole.block.saved().unwrap().save_state().unwrap();
            let mut restored = fresh(precision, widths[after]);
            restored
                .block
                .saved_mut()
                .unwrap()
                .restore_state(&saved)
                .unwrap();
            let again = restored.block.saved().unwrap().save_state().unwrap();
            assert!(before != after || again == saved, "{precision:?}");
            for step in 4..8 {
                let case = format!("{precision:?}, {before} to {after}, step {step}");
                let [a, b] = [&mut restored, &mut whole].map(|fixture| step_of(fixture, step));
                assert_eq!(a, b, "{case}");
            }
            assert_eq!(restored.block.history(), whole.block.history());
        }
    }
}

/// The state of a block of other elements, of another precision, or one that is damaged is refused.
#[test]
fn the_state_of_another_block_is_refused() {
    let saved = moved(Precision::F64, LaneWidth::Native, 0..2);
    let saved = saved.block.saved().unwrap().save_state().unwrap();
    let mut single = fresh(Precision::Mixed, LaneWidth::Native);
    let mesh = distorted(ElementKind::Hex8, [3, 3, 2]);
    let options = options(Precision::F64, LaneWidth::Native, 2e-4);
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    let mut smaller = Fixture::of(mesh, kernel, Softening(rock()), options);
    for other in [&mut single, &mut smaller] {
        let refused = other.block.saved_mut().unwrap().restore_state(&saved);
        assert!(
            matches!(refused, Err(StateError::Foreign { .. })),
            "{refused:?}"
        );
    }
    let mut same = fresh(Precision::F64, LaneWidth::Native);
    let cut = same
        .block
        .saved_mut()
        .unwrap()
        .restore_state(&saved[..saved.len() / 2]);
    assert!(matches!(cut, Err(StateError::Unreadable { .. })), "{cut:?}");
}

/// A negative zero among history variables remains one, also where all others of its batch are zero.
#[test]
fn a_negative_zero_is_kept() {
    let mut fixture = fresh(Precision::F64, LaneWidth::Native);
    let elements: Vec<u32> = fixture.block.elements().to_vec();
    let name = fixture.block.history()[0].name.clone();
    let values = vec![-0.0; elements.len()];
    let fields = [HistoryField::new(name, elements, 1, values)];
    fixture.block.set_history(&fields);
    let bits = |fields: &[HistoryField]| -> Vec<u64> {
        fields[0]
            .values
            .iter()
            .map(|value| value.to_bits())
            .collect()
    };
    assert_eq!(bits(&fixture.block.history()), bits(&fields));
    let saved = fixture.block.saved().unwrap().save_state().unwrap();
    let mut restored = fresh(Precision::F64, LaneWidth::Native);
    restored
        .block
        .saved_mut()
        .unwrap()
        .restore_state(&saved)
        .unwrap();
    assert_eq!(bits(&restored.block.history()), bits(&fields));
}
