use std::sync::{Arc, Mutex};

use powerhouse_model::{Cadence, Mesh, Observer, Stress, Vec3};
use powerhouse_observe::{Motion, Snapshot, SnapshotFields, SnapshotSink, Snapshots};

use super::Fields;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A sink that counts, and fails at its third snapshot.
struct Counter(Arc<Mutex<(u64, bool)>>);

impl SnapshotSink for Counter {
    fn take(&mut self, snapshot: &Snapshot) -> Result<(), Failure> {
        let mut seen = self.0.lock().unwrap();
        assert_eq!(snapshot.index, seen.0);
        seen.0 += 1;
        if seen.0 == 3 {
            Err("disk full".into())
        } else {
            Ok(())
        }
    }
    fn finish(&mut self) -> Result<(), Failure> {
        self.0.lock().unwrap().1 = true;
        Ok(())
    }
}

/// A sink sees the wanted fields whole and the others empty, at the step's time.
#[test]
fn a_sink_sees_whole_fields() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2, 2, 2], "rock").unwrap();
    let positions = mesh.positions().to_vec();
    let times = Arc::new(Mutex::new(Vec::new()));
    let kept = times.clone();
    let fields = SnapshotFields {
        motion: Motion {
            acceleration: false,
            ..Motion::ALL
        },
        stress: true,
    };
    let mut snapshots = Snapshots::new(
        &mesh,
        fields,
        Cadence::Seconds(0.1),
        move |shot: &Snapshot| {
            for (node, position) in positions.iter().enumerate() {
                assert_eq!(shot.displacement[node], position * shot.time);
                assert_eq!(shot.velocity[node], -position);
            }
            assert!(shot.acceleration.is_empty());
            assert_eq!((shot.displacement.len(), shot.stress.len()), (27, 8));
            assert_eq!(shot.stress[5].0[0], 5.0);
            kept.lock()
                .unwrap()
                .push((shot.index, shot.step, shot.time));
            Ok(())
        },
    )
    .unwrap();
    assert!(snapshots.fields().stress && !snapshots.fields().acceleration);
    let x = |node: u32| mesh.positions()[node as usize];
    let mut view = Fields::at_rest(27);
    view.displacement = Box::new(|node, t| x(node) * t);
    view.velocity = Box::new(|node, _| -x(node));
    view.stress = Box::new(|element, _| Stress([f64::from(element), 0.0, 0.0, 0.0, 0.0, 0.0]));
    view.show(&mut snapshots, 0.0);
    view.show(&mut snapshots, 0.125);
    assert_eq!(*times.lock().unwrap(), [(0, 0, 0.0), (1, 125, 0.125)]);
}

/// A sink that fails ends the run with its own message, and its `finish` is still called.
#[test]
fn a_failing_sink_ends_the_run() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [1, 1, 1], "rock").unwrap();
    let seen = Arc::new(Mutex::new((0, false)));
    let sink = Counter(seen.clone());
    let mut snapshots =
        Snapshots::new(&mesh, SnapshotFields::default(), Cadence::Steps(5), sink).unwrap();
    let mut view = Fields::at_rest(8);
    view.show(&mut snapshots, 0.0);
    view.show(&mut snapshots, 0.1);
    let error = snapshots.observe(&view).unwrap_err();
    assert_eq!(error.to_string(), "snapshots: disk full");
    snapshots.finish().unwrap();
    assert_eq!(*seen.lock().unwrap(), (3, true));
}
