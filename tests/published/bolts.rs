//! Bolts that are pulled out of rock.

use super::page::{Row, compare};
use super::{at, run};

/// The force along a grouted bolt falls as Farmer (1975) measured and derived it: `exp(-0.2 x / a)`, `a` its radius.
#[test]
fn the_force_along_a_bolt() {
    let results = run("pull_out.toml", &[]);
    let bolt = &results.bolts[0];
    let middles: Vec<f64> = bolt
        .ends
        .iter()
        .map(|[from, to]| 0.5 * (from + to) - 1e-4)
        .collect();
    // The head moves by 0.1 mm: the force there is sqrt(K E A) times this.
    let head = f64::sqrt(2.513_274e10 * 2e11 * core::f64::consts::PI * 1e-4) * 1e-4;
    let forces: Vec<f64> = bolt.forces.iter().map(|force| force / head).collect();
    let row = |radii: f64| {
        let found = at(&middles, &forces, radii * 0.01);
        let what = format!("force over that at the face, {radii} radii into the rock");
        Row::over(what, f64::exp(-0.2 * radii), found, 1.0, 0.02)
    };
    compare("Farmer", &[1.0, 2.5, 5.0, 10.0, 15.0, 20.0].map(row));
}

/// A cable whose grout yields along it: the pull test of 3DEC's manual, against the closed form of elastic, perfectly plastic grout.
#[test]
fn a_cable_is_pulled_out() {
    let results = run("pull_test.toml", &[]);
    let (stiffness, strength, axial, length) = (112e6, 0.175e6, 98.6e9 * 181e-6, 17.7);
    let decay = f64::sqrt(stiffness / axial);
    // Displacement and force at the face where the grout yields along `plastic` of the cable.
    let state = |plastic: f64| {
        let rest = (decay * (length - plastic)).tanh();
        let slip = strength / stiffness
            + strength * plastic * rest / (decay * axial)
            + 0.5 * strength * plastic * plastic / axial;
        (slip, strength * (plastic + rest / decay))
    };
    let (slips, known): (Vec<f64>, Vec<f64>) =
        (0..=1000).map(|i| state(0.004 * f64::from(i))).unzip();
    let histories = results.bolt_histories();
    let forces = &histories.column("bolt.greatest").expect("the bolt").values;
    let row = |millimetres: f64| {
        // 50 mm in 50 ms.
        let found = at(&histories.times, forces, 1e-3 * millimetres);
        let known = at(&slips, &known, 1e-3 * millimetres).min(0.5e6);
        let what = format!("force at {millimetres} mm (kN)");
        Row::new(what, 1e-3 * known, 1e-3 * found, 0.02)
    };
    compare("3DEC", &[2.0, 5.0, 10.0, 20.0, 30.0, 45.0].map(row));
}
