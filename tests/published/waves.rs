//! Columns and bars of other programs' own tests.

use powerhouse::Results;

use super::page::{Row, compare};
use super::{at, greatest, run};

/// A column of the histories.
fn history<'a>(results: &'a Results, name: &str) -> &'a [f64] {
    &results.histories().column(name).expect("a history").values
}

/// A plane shear wave in a column: SDLV121 of code_aster, within its tolerances, and against the wave itself at the same instants.
#[test]
fn a_plane_wave_in_a_column() {
    let results = run("code_aster_column.toml", &[]);
    let times = &results.histories().times;
    // Millimetres.
    let found = |time: f64| 1e3 * at(times, history(&results, "middle.uy"), time);
    let speed = f64::sqrt(4.44e8 / (2.0 * 1.48 * 1900.0));
    let pulse = |time: f64| (-394.73 * (time - 0.177_061_5_f64).powi(2)).exp();
    let wave = |time: f64| pulse(time - 25.0 / speed) + pulse(time - 75.0 / speed);
    let mut rows = vec![
        Row::new("displacement at 0.2656 s (mm)", 1.0, found(0.2656), 0.004),
        Row::new("displacement at 0.4384 s (mm)", 1.0, found(0.4384), 0.007),
        Row::over("displacement at 0.8 s (mm)", 0.0, found(0.8), 1.0, 0.003),
    ];
    for time in [0.2656, 0.4384] {
        let what = format!("the same against the exact wave, {time} s (mm)");
        rows.push(Row::new(what, wave(time), found(time), 0.001));
    }
    compare("SDLV121", &rows);
}

/// A bar whose end absorbs: SDLV120 of code_aster, within its tolerances.
#[test]
fn a_bar_whose_end_absorbs() {
    let results = run("code_aster_bar.toml", &[]);
    // Millimetres.
    let found = |time: f64| {
        let displacement = history(&results, "at-150m.uz");
        1e3 * at(&results.histories().times, displacement, time)
    };
    let rows = [
        Row::new("displacement at 0.54 s (mm)", 0.99262, found(0.54), 0.001),
        Row::over("displacement at 1.2 s (mm)", 0.0, found(1.2), 1.0, 1e-4),
    ];
    compare("SDLV120", &rows);
}

/// A Ricker wavelet enters a column of soil, doubles at its surface and leaves: OpenSees' example of an absorbing boundary.
#[test]
fn a_wavelet_enters_doubles_and_leaves() {
    let results = run("opensees_column.toml", &[]);
    let times = &results.histories().times;
    let peak = |name: &str, from: f64, to: f64| {
        let values = history(&results, name).iter().zip(times);
        let values = values.filter(|(_, time)| (from..to).contains(*time));
        values.fold(0.0_f64, |peak, (value, _)| peak.max(*value)) / 9.806
    };
    let rows = [
        Row::new(
            "base, the wave that enters (g)",
            1.0,
            peak("base.ax", 0.0, 0.35),
            0.005,
        ),
        Row::new("surface (g)", 2.0, peak("surface.ax", 0.0, 1.0), 0.005),
        Row::new(
            "base, the wave that leaves (g)",
            1.0,
            peak("base.ax", 0.4, 1.0),
            0.005,
        ),
    ];
    compare("OpenSees", &rows);
}

/// A sudden load on a column over dashpots: the mean velocities of Kratos' test, within its tolerance of 0.005 of 0.0697.
#[test]
fn a_sudden_load_on_a_column() {
    let results = run("kratos_column.toml", &[]);
    let times = &results.histories().times;
    let speed = f64::sqrt(1e7 * 0.8 / (1.2 * 0.6) / 1855.0);
    let row = |(name, depth): (&str, f64)| {
        let displacement = history(&results, &format!("{name}.uz"));
        let arrival = times.partition_point(|&time| time < depth / speed);
        let (start, end) = (displacement[arrival], displacement.last().expect("an end"));
        let velocity = (start - end) / (times.last().expect("an end") - times[arrival]);
        Row::new(
            format!("mean velocity {depth} m below the top (m/s)"),
            6.9655e-5,
            velocity,
            0.072,
        )
    };
    compare(
        "Kratos",
        &[("quarter", 2.5), ("half", 5.0), ("three-quarters", 7.5)].map(row),
    );
}

/// A bar meets a rigid wall: SDNV100 of code_aster, whose solution is that of waves in a bar.
#[test]
fn a_bar_meets_a_wall() {
    let results = run("code_aster_impact.toml", &[]);
    let joints = results.joint_histories();
    let open = &joints.column("face.open").expect("the joint").values;
    let touches = |row: &usize| open[*row] < 0.5;
    let first = (0..open.len()).find(touches).expect("contact");
    let last = (0..open.len()).rfind(touches).expect("contact");
    let times = &results.histories().times;
    let pressures = history(&results, "contact.zz").iter().zip(times);
    let during: Vec<f64> = pressures
        .filter(|(_, time)| (25e-6..95e-6).contains(*time))
        .map(|(stress, _)| -1e-9 * stress)
        .collect();
    let mean = during.iter().sum::<f64>() / during.len() as f64;
    // The wall moves at 100 m/s and the bar is at rest; in the test the bar moves.
    let rebound = history(&results, "bar.vz").last().expect("an end") - 100.0;
    let rows = [
        Row::new("contact begins (us)", 20.0, 1e6 * joints.times[first], 0.02),
        Row::new("contact ends (us)", 100.0, 1e6 * joints.times[last], 0.02),
        Row::new("stress during the contact (GPa)", 4.0, mean, 0.02),
        Row::new("velocity of the rebound (m/s)", 100.0, rebound, 0.02),
    ];
    assert!(greatest(open) != first);
    compare("SDNV100", &rows);
}
