//! Concrete at one point: biaxial strength, cyclic compression, tension beyond the strength.

use powerhouse::model::HistoryKind;
use powerhouse::{PointError, PointPath, PointTest, Registry};

use super::page::{Row, compare};
use super::{at, changed, greatest, published};

const ZZ: usize = 2;

/// Drives a concrete of `concrete.toml` along a path; of one that it does not bear to its end the steps until then.
fn drive(material: &str, path: String) -> PointTest {
    let file = published("concrete.toml");
    let material = Registry::default().material_of_file(file, Some(material));
    let path = PointPath::from_toml(path, "path.toml").unwrap();
    match path.drive(&material.unwrap()) {
        Ok(test) => test,
        Err(PointError::Leg { test, .. }) => *test,
        Err(error) => panic!("{error}"),
    }
}

/// Greatest stress along z (Pa, in the sense of `stress`) while that along x is a share of it and that along y is zero.
fn strength(material: &str, stress: f64, share: f64) -> f64 {
    let changes = [
        format!("leg.xx={{ stress = {} }}", share * stress),
        format!("leg.zz={{ stress = {stress} }}"),
    ];
    let test = drive(material, changed("biaxial.toml", &changes));
    let stresses = test.records.iter().map(|record| record.stress.0[ZZ].abs());
    stresses.fold(0.0, f64::max)
}

/// Strengths under two stresses in proportion, against the envelope that Kupfer & Gerstle (1973) drew through the tests of
/// Kupfer, Hilsdorf & Ruesch (1969): within a tenth.
#[test]
fn biaxial_strengths() {
    let (compressive, tensile) = (33e6, 3.3e6);
    let mut rows = Vec::new();
    for share in [0.0_f64, 0.25, 0.52, 0.75, 1.0, -0.052, -0.103, -0.204] {
        let envelope = if share >= 0.0 {
            (1.0 + 3.65 * share) / (1.0 + share).powi(2)
        } else {
            // The tensile strength is ft (1 - 0.8 s / fc) beside the pressure s.
            let ratio = tensile / compressive;
            ratio / (-share + 0.8 * ratio)
        };
        let found = strength("kupfer", -2.0 * compressive, share) / compressive;
        rows.push(Row::new(
            format!("-1 : {}", 0.0 - share),
            envelope,
            found,
            0.1,
        ));
    }
    let found = strength("kupfer", 2.0 * tensile, 1.0) / tensile;
    rows.push(Row::new(
        "1 : 1, over the tensile strength",
        1.0,
        found,
        0.1,
    ));
    compare("Kupfer", &rows);
}

/// The two of Kupfer's tests whose strengths code_aster has, by two laws: within its own tolerance of 5 %.
#[test]
fn biaxial_tests_of_code_aster() {
    let mut rows = Vec::new();
    for (law, material) in [("`lee-fenves`", "kupfer"), ("`mazars`", "kupfer-mazars")] {
        for (share, measured) in [(0.52, 42.428571), (-0.052, 27.899998)] {
            let found = 1e-6 * strength(material, -66e6, share);
            let what = format!("{law}, -1 : {} (MPa)", 0.0 - share);
            rows.push(Row::new(what, measured, found, 0.05));
        }
    }
    compare("SSNP161", &rows);
}

/// Strain that remains when the stress is taken away, against the relation that Karsan & Jirsa (1969) found in their tests.
#[test]
fn strains_that_remain() {
    let peak = 2e-3;
    let monotonic = drive("karsan-jirsa", changed("crushing.toml", &[]));
    let pressures: Vec<f64> = monotonic.records.iter().map(|r| -r.stress.0[ZZ]).collect();
    let greatest = &monotonic.records[greatest(&pressures)];
    let mut rows = vec![
        Row::new("strength (MPa)", 27.6, -1e-6 * greatest.stress.0[ZZ], 0.1),
        Row::new(
            "strain e0 at the strength (per mille)",
            2.0,
            -1e3 * greatest.strain.0[ZZ],
            0.1,
        ),
    ];
    for reached in [0.5, 1.0, 1.5, 2.0] {
        let measured = if reached < 2.0 {
            0.145 * reached * reached + 0.13 * reached
        } else {
            0.834
        };
        let path = format!(
            "size = 0.1\n[[leg]]\nkind = \"uniaxial\"\nstrain = {}\nsteps = 500\n\
             [[leg]]\nkind = \"mixed\"\nxx = {{ stress = 0 }}\nyy = {{ stress = 0 }}\nzz = {{ stress = 0 }}\n",
            -reached * peak
        );
        let test = drive("karsan-jirsa", path);
        let end = test.records.last().expect("an end");
        assert!(end.stress.0[ZZ].abs() < 1.0, "{}", end.stress.0[ZZ]);
        let found = -end.strain.0[ZZ] / peak;
        let what = format!("strain that remains after {reached} e0, over e0");
        rows.push(Row::over(what, measured, found, 1.0, 0.1));
    }
    compare("Karsan & Jirsa", &rows);
}

/// Stress against the width of a crack, against the curve that Gopalaratnam & Shah (1985) fitted to their tests: within a tenth
/// of the strength, and in the mean.
#[test]
fn stress_across_a_crack() {
    let (young, strength, length) = (31e9, 3.48e6, 0.0826);
    let measured = |width: f64| (-0.063 * width.powf(1.01)).exp();
    let test = drive("gopalaratnam-shah", changed("tearing.toml", &[]));
    assert!(
        test.variables
            .iter()
            .any(|variable| variable.kind == HistoryKind::Amount)
    );
    let stresses: Vec<f64> = test.records.iter().map(|r| r.stress.0[ZZ]).collect();
    let after = greatest(&stresses);
    let softening = &test.records[after..];
    // Micrometres.
    let opening = |stress: f64, strain: f64| 1e6 * length * (strain - stress / young);
    let widths: Vec<f64> = softening
        .iter()
        .map(|r| opening(r.stress.0[ZZ], r.strain.0[ZZ]))
        .collect();
    let stresses: Vec<f64> = softening
        .iter()
        .map(|r| r.stress.0[ZZ] / strength)
        .collect();
    let row = |width: f64| {
        let found = at(&widths, &stresses, width);
        Row::over(
            format!("stress over strength at {width} um"),
            measured(width),
            found,
            1.0,
            0.1,
        )
    };
    let mut rows: Vec<Row> = [2.0, 5.0, 10.0, 20.0, 40.0, 60.0].map(row).into();
    let grid = (0..=60).map(f64::from);
    let [difference, whole] = grid.fold([0.0, 0.0], |[difference, whole], width| {
        let stress = measured(width);
        let error = at(&widths, &stresses, width) - stress;
        [difference + error * error, whole + stress * stress]
    });
    let error = f64::sqrt(difference / whole);
    rows.push(Row::over(
        "relative L2 from 0 to 60 um",
        0.0,
        error,
        1.0,
        0.1,
    ));
    compare("Gopalaratnam & Shah", &rows);
}
