use core::f64::consts::TAU;

use powerhouse_model::{Cadence, Mesh, Observer, Vec3};
use powerhouse_observe::{
    AccelerationRule, Envelope, History, HistoryTable, Motion, PeakTable, Place,
};

use super::{Fields, noise};

const NODE: u32 = 8;

fn block() -> Mesh {
    Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(2.0), [2; 3], "rock").unwrap()
}

/// Histories of the node every so many seconds, and the accelerations of a band (Hz) if there is one.
fn history(mesh: &Mesh, every: f64) -> History {
    History::builder(Cadence::Seconds(every))
        .stress("before", powerhouse_observe::StressPlace::Element(3))
        .motion("a", Place::Node(u64::from(NODE) + 1), Motion::ALL)
        .relative(
            "b",
            Place::Node(3),
            Place::Node(u64::from(NODE) + 1),
            Motion::ACCELERATION,
        )
        .build(mesh)
        .unwrap()
}

/// Motion of the node by displacements along x at the steps (m), as central differences have it: velocities between steps.
fn moving<'a>(view: &mut Fields<'a>, step: f64, displacement: impl Fn(i64) -> f64 + Clone + 'a) {
    view.step = step;
    let number = move |t: f64| (t / step).round() as i64;
    let at = |node: u32, value: f64| Vec3::new(if node == NODE { value } else { 0.0 }, 0.0, 0.0);
    let u = displacement.clone();
    view.displacement = Box::new(move |node, t| at(node, u(number(t))));
    let u = displacement.clone();
    view.velocity = Box::new(move |node, t| {
        let n = number(t);
        at(node, 0.5 * (u(n + 1) - u(n - 1)) / step)
    });
    view.acceleration = Box::new(move |node, t| {
        let (n, u) = (number(t), &displacement);
        at(node, (u(n + 1) - 2.0 * u(n) + u(n - 1)) / (step * step))
    });
}

fn values<'t>(table: &'t HistoryTable, name: &str) -> &'t [f64] {
    &table.column(name).unwrap().values
}

/// Rows of accelerations are the changes of the velocity over the interval around them, of a motion of velocities at random: nothing
/// of what happens between rows is lost, whether intervals are multiples of the step or not, and their sum is the velocity.
#[test]
fn accelerations_are_means_over_the_interval() {
    let mesh = block();
    for (step, every) in [
        (1e-3, 0.02),
        (1.3e-4, 0.005),
        (2.9e-3, 0.0071),
        (1e-3, 4e-3),
    ] {
        // Positions of a body whose velocity between steps is at random.
        let steps = (0.31_f64 / step).ceil() as usize;
        let mut path = vec![0.0; 3];
        for n in 0..steps + 3 {
            path.push(path[n + 2] + step * noise(n as u64));
        }
        let path = &path;
        let mut view = Fields::at_rest(mesh.node_count());
        moving(&mut view, step, move |n| path[(n + 1) as usize]);
        // The velocity is straight between those at the steps.
        let velocity = |t: f64| {
            let n = (t / step + 1e-6).floor();
            let at = |n: f64| 0.5 * (path[n as usize + 2] - path[n as usize]) / step;
            let share = t / step - n;
            if share.abs() < 1e-5 {
                at(n)
            } else {
                at(n) * (1.0 - share) + at(n + 1.0) * share
            }
        };
        let mut history = history(&mesh, every);
        let recording = history.recording();
        view.run(&mut [&mut history], steps as u64);
        let table = recording.copy();
        let (means, relative) = (values(&table, "a.ax"), values(&table, "b.ax"));
        assert_eq!(means, relative);
        let end = (steps - 1) as f64 * step;
        assert_eq!(table.times.len(), (end / every + 1e-6).floor() as usize + 1);
        for (row, &time) in table.times.iter().enumerate() {
            assert!((time - row as f64 * every).abs() < 1e-12);
            let (from, to) = ((time - 0.5 * every).max(0.0), (time + 0.5 * every).min(end));
            let expected = (velocity(to) - velocity(from)) / (to - from);
            assert!(
                (means[row] - expected).abs() < 1e-9 * (1.0 / step),
                "{step} {every} {time}: {} {expected}",
                means[row]
            );
        }
    }
}

/// Blows between two rows are in their means, whose peak is that of the table; the blow itself is a peak under a name of its own.
/// By the rule of instants the rows know nothing of it.
#[test]
fn blows_between_rows_are_not_lost() {
    let mesh = block();
    let (step, every) = (1e-4, 0.01);
    // Blows of 1 m/s in 37 steps of every thousand and back later.
    let velocity = |n: i64| {
        f64::from(u8::from(
            n.rem_euclid(1000) >= 237 && n.rem_euclid(1000) < 671,
        ))
    };
    let mut path = vec![0.0];
    for n in 0..4005 {
        path.push(path[n] + step * velocity(n as i64));
    }
    let path = &path;
    for (rule, expected) in [
        (AccelerationRule::Mean, 100.0),
        (AccelerationRule::Instant, 0.0),
    ] {
        let mut view = Fields::at_rest(mesh.node_count());
        moving(&mut view, step, move |n| path[n.max(0) as usize]);
        let mut history = History::builder(Cadence::Seconds(every))
            .motion("a", Place::Node(u64::from(NODE) + 1), Motion::ACCELERATION)
            .accelerations(rule)
            .build(&mesh)
            .unwrap();
        let (recording, mut peaks) = (history.recording(), history.motion_peaks().unwrap());
        view.run(&mut [&mut peaks, &mut history], 4000);
        let table = recording.copy();
        let greatest = values(&table, "a.ax")
            .iter()
            .fold(0.0_f64, |most, a| most.max(a.abs()));
        assert!((greatest - expected).abs() < 1e-6, "{rule:?}: {greatest}");
        let mut rows = PeakTable::default();
        rows.add_history(&table);
        rows.add_instants(&table);
        let peak = |name: &str| {
            rows.rows
                .iter()
                .find(|row| row.name == name)
                .map(|row| row.value)
        };
        let (of_table, instant) = (peak("a.ax").unwrap(), peak("a.ax (instant)"));
        match rule {
            AccelerationRule::Mean => {
                assert!((of_table.abs() - 100.0).abs() < 1e-6, "{of_table}");
                assert!(
                    (instant.unwrap().abs() - 1.0 / step).abs() < 1e-6,
                    "{instant:?}"
                );
            }
            AccelerationRule::Instant => {
                assert!((of_table.abs() - 1.0 / step).abs() < 1e-6, "{of_table}");
                assert_eq!(instant, None);
            }
        }
    }
}

/// Accelerations of a band are those of the motion up to 0.75 of the band to 0.2 %, without delay, and nothing from 1.25 of it on,
/// at rows of a fifth of its period up to the end of the run, whatever the step; to 1 % of fewer than ten steps to its period.
#[test]
fn bands_end_where_they_are_to() {
    let mesh = block();
    for (step, band) in [
        (1e-4, 100.0),
        (2.3e-4, 100.0),
        (1.1e-3, 40.0),
        (2e-3, 100.0),
    ] {
        for (share, kept) in [
            (0.1, 1.0),
            (0.5, 1.0),
            (0.75, 1.0),
            (1.0, 0.5),
            (1.25, 0.0),
            (2.0, 0.0),
        ] {
            let w = TAU * share * band;
            if w * step > 1.5 {
                continue;
            }
            let mut view = Fields::at_rest(mesh.node_count());
            moving(&mut view, step, move |n| (w * n as f64 * step + 0.7).sin());
            // Acceleration of central differences.
            let height = 2.0 * (1.0 - (w * step).cos()) / (step * step);
            let mut history = history(&mesh, 0.01);
            let mut limited = history.band_limited(band).unwrap().unwrap();
            let recording = limited.recording();
            let steps = (14.0 / band / step).round() as u64;
            view.run(&mut [&mut history, &mut limited], steps + 1);
            let table = recording.copy();
            let rows = (steps as f64 * step * 5.0 * band + 1e-6).floor();
            assert_eq!(table.times.len(), rows as usize + 1);
            let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["a.ax", "a.ay", "a.az", "b.ax", "b.ay", "b.az"]);
            let mut seen = 0;
            for (row, &time) in table.times.iter().enumerate() {
                assert!((time - row as f64 / (5.0 * band)).abs() < 1e-12, "{time}");
                if time > 4.5 / band && time < 9.0 / band {
                    seen += 1;
                    let expected = -kept * height * (w * time + 0.7).sin();
                    let off = (values(&table, "a.ax")[row] - expected).abs() / height;
                    // Blows of so few steps have images above the band, each with a thousandth left.
                    let allowed = if step * band > 0.1 { 1e-2 } else { 2e-3 };
                    assert!(off < allowed, "{step} {band} {share} {time}: {off}");
                }
            }
            assert!(seen >= 20);
        }
    }
}

/// Histories of a smooth motion are as they were: means every 5 ms and accelerations of a band are the instants to a thousandth of
/// the peak, at the same times.
#[test]
fn smooth_motions_are_as_they_were() {
    let mesh = block();
    for step in [2e-4, 3.1e-4] {
        let path = |n: i64| {
            let t = n as f64 * step;
            0.01 * (-((t - 0.5) / 0.15).powi(2)).exp() * (TAU * 2.5 * t).sin()
        };
        let tables = [AccelerationRule::Mean, AccelerationRule::Instant].map(|rule| {
            let mut view = Fields::at_rest(mesh.node_count());
            moving(&mut view, step, path);
            let mut history = History::builder(Cadence::Seconds(0.005))
                .motion("a", Place::Node(u64::from(NODE) + 1), Motion::ACCELERATION)
                .accelerations(rule)
                .build(&mesh)
                .unwrap();
            let mut limited = history.band_limited(100.0).unwrap().unwrap();
            let recordings = [history.recording(), limited.recording()];
            view.run(&mut [&mut history, &mut limited], (1.0 / step) as u64);
            recordings.map(|recording| recording.copy())
        });
        let [[means, limited], [instants, _]] = &tables;
        assert_eq!(means.times, instants.times);
        let [a, b] = [means, instants].map(|table| values(table, "a.ax"));
        let peak = b.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        for (row, time) in means.times.iter().enumerate() {
            let off = (a[row] - b[row]).abs() / peak;
            assert!(off < 1e-3, "{step} {time}: {off}");
            // Every tenth of a second both tables have a row.
            if row % 20 == 0 {
                let same = limited
                    .times
                    .iter()
                    .position(|other| (other - time).abs() < 1e-9);
                let value = values(limited, "a.ax")[same.unwrap()];
                assert!((value - b[row]).abs() < 1e-3 * peak, "{step} {time}");
            }
        }
    }
}

/// What has fewer than two steps to the period of a band has a lower band, and the rows of that.
#[test]
fn a_band_of_long_steps_is_lower() {
    let mesh = block();
    let step = 9e-3;
    let mut view = Fields::at_rest(mesh.node_count());
    moving(&mut view, step, move |n| {
        (TAU * 5.0 * n as f64 * step).sin()
    });
    let mut limited = history(&mesh, 0.01).band_limited(100.0).unwrap().unwrap();
    let recording = limited.recording();
    view.run(&mut [&mut limited], 100);
    let times = recording.copy().times;
    assert!((times[1] - 1.0 / 250.0).abs() < 1e-12, "{}", times[1]);
    let history = history(&mesh, 0.01);
    for band in [0.0, -1.0, f64::NAN] {
        assert!(history.band_limited(band).is_err());
    }
    let still = History::builder(Cadence::Steps(1)).motion("a", Place::Node(1), Motion::VELOCITY);
    assert!(
        still
            .build(&mesh)
            .unwrap()
            .band_limited(50.0)
            .unwrap()
            .is_none()
    );
}

/// An envelope of accelerations is that of means over its interval, in which no blow is lost, and of instants by request; also of
/// one that is saved and restored between two looks.
#[test]
fn envelopes_are_of_means() {
    let mesh = block();
    let step = 1e-4;
    let velocity = |n: i64| f64::from(u8::from(n >= 237));
    let mut path = vec![0.0];
    for n in 0..1005 {
        path.push(path[n] + step * velocity(n as i64));
    }
    let path = &path;
    for (every, rule, expected) in [
        (0.01, AccelerationRule::Mean, 100.0),
        (0.01, AccelerationRule::Instant, 0.0),
        (1e-5, AccelerationRule::Mean, 1e4),
        (1e-5, AccelerationRule::Instant, 1e4),
    ] {
        let mut view = Fields::at_rest(mesh.node_count());
        moving(&mut view, step, move |n| path[n.max(0) as usize]);
        let nodes = [2, NODE];
        let cadence = Cadence::Seconds(every);
        let envelope = Envelope::new(&mesh, &nodes, Motion::ACCELERATION, &[], cadence).unwrap();
        let mut envelope = envelope.accelerations(rule);
        let recording = envelope.recording();
        view.run(&mut [&mut envelope as &mut dyn Observer], 1000);
        let found = recording.copy().acceleration.values;
        assert_eq!(found[0], 0.0);
        assert!(
            (found[1] - expected).abs() < 1e-6 * 1e4,
            "{every} {rule:?}: {found:?}"
        );
    }
}

/// A run that ends amid the motion, wherever in it, has no overshoot at its end: accelerations of a band exceed those of the motion by
/// half a hundredth at most, as the ripple of the filter and the half interval of its mirror allow, not by the 8 % of a sudden end.
#[test]
fn the_end_of_a_run_has_no_overshoot() {
    let mesh = block();
    let (step, band, frequency) = (2e-4, 100.0, 4.0);
    for phase in [0.0, 0.25, 0.4] {
        // It begins smoothly, and is at some phase of its oscillation at the end.
        let steps = ((1.0 + phase / frequency) / step) as u64;
        let motion = move |n: i64| {
            let t = n as f64 * step;
            let grown = (t / 0.5).clamp(0.0, 1.0);
            let share = grown * grown * grown * (10.0 - 15.0 * grown + 6.0 * grown * grown);
            share * (TAU * frequency * t).cos()
        };
        let mut view = Fields::at_rest(mesh.node_count());
        moving(&mut view, step, motion);
        let mut limited = history(&mesh, 0.01).band_limited(band).unwrap().unwrap();
        let recording = limited.recording();
        view.run(&mut [&mut limited], steps);
        let table = recording.copy();
        let most = (TAU * frequency).powi(2);
        let late = table.times.iter().zip(values(&table, "a.ax"));
        let late = late.filter(|(time, _)| **time > 0.5);
        let peak = late.map(|(_, a)| a.abs()).fold(0.0, f64::max);
        assert!(
            (0.99..1.005).contains(&(peak / most)),
            "{phase}: {}",
            peak / most
        );
    }
}
