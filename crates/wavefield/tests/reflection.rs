//! Reflection coefficients against an independent table, energy and special cases.

use powerhouse_model::ElasticMedium;
use powerhouse_wavefield::{Angle, SurfaceReflection, WaveError, WaveKind, critical_angle};

use crate::support;

const TABLE: &str = include_str!("../../../data/reference/free_surface_coefficients.csv");

fn reflection(kind: WaveKind, poisson: f64, degrees: f64) -> SurfaceReflection {
    let incidence = Angle::from_degrees(degrees);
    SurfaceReflection::new(kind, incidence, &support::rock(poisson)).unwrap()
}

/// Coefficients, surface motions and energies agree with an independent calculation to its digits.
#[test]
fn coefficients_agree_with_the_table() {
    let mut rows = 0;
    for line in TABLE.lines().filter(|line| line.starts_with("0.")) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let kind = match fields[1] {
            "SV" => WaveKind::SV,
            _ => WaveKind::P,
        };
        let found = reflection(kind, number(0), number(2));
        let [x, y, z] = found.surface_motion();
        let [same, converted] = found.energy();
        let values = [
            found.same.re,
            found.same.im,
            found.converted.re,
            found.converted.im,
            x.re,
            x.im,
            z.re,
            z.im,
            same,
            converted,
        ];
        for (i, value) in values.into_iter().enumerate() {
            let expected = number(3 + i);
            // The table has ten digits.
            assert!(
                (value - expected).abs() < 2e-9 * (1.0 + expected.abs()),
                "column {} of {line}: {value}",
                3 + i
            );
        }
        assert_eq!(y.norm(), 0.0);
        rows += 1;
    }
    assert_eq!(rows, 3 * 2 * 18);
}

/// The reflected waves carry away the incident energy at every angle and Poisson's ratio.
#[test]
fn energy_is_conserved() {
    for poisson in [0.0, 0.1, 0.25, 0.3456, 0.4, 0.49] {
        for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
            for half_degrees in 0..=178 {
                let degrees = 0.5 * half_degrees as f64;
                let [same, converted] = reflection(kind, poisson, degrees).energy();
                assert!(
                    (same + converted - 1.0).abs() < 1e-12,
                    "{kind} {poisson} {degrees}: {same} + {converted}"
                );
            }
        }
    }
}

/// SV at 45 degrees moves the surface by (0, -sqrt 2) whatever Poisson's ratio, and makes no P.
#[test]
fn sv_at_45_degrees_makes_no_p_wave() {
    for poisson in [0.0, 0.2, 0.3, 0.45, 0.49] {
        let found = reflection(WaveKind::SV, poisson, 45.0);
        let [x, _, z] = found.surface_motion();
        assert!(
            found.converted.norm() < 1e-14,
            "{poisson}: {}",
            found.converted
        );
        assert!(x.norm() < 1e-14 && (z.re + 2f64.sqrt()).abs() < 1e-14 && z.im.abs() < 1e-14);
    }
}

/// At nu = 0.25 the reflected P wave vanishes at 60 and 77.206 degrees of P incidence.
#[test]
fn p_waves_vanish_where_theory_says() {
    assert!(reflection(WaveKind::P, 0.25, 60.0).same.norm() < 1e-14);
    // The angle is known to half a unit of its last digit, the slope is below 2 per radian.
    assert!(reflection(WaveKind::P, 0.25, 77.206).same.norm() < 2.0 * 0.0005f64.to_radians());
}

/// The critical angle is asin(cs/cp): 32.3115 degrees at nu 0.3, 29.06 at 0.3456; the field is
/// past it just above and not just below.
#[test]
fn the_critical_angle_divides_delays_from_phase_shifts() {
    for (poisson, degrees) in [(0.3, 32.3115), (0.3456, 29.06)] {
        let critical = critical_angle(&support::rock(poisson)).degrees();
        assert!((critical - degrees).abs() < 5e-3);
        assert!(!reflection(WaveKind::SV, poisson, critical - 1e-6).past_critical());
        assert!(reflection(WaveKind::SV, poisson, critical + 1e-6).past_critical());
        let at = reflection(WaveKind::SV, poisson, critical);
        let near = reflection(WaveKind::SV, poisson, critical - 1e-9);
        // Coefficients run as the square root of the distance from the critical angle.
        assert!(
            (at.same - near.same).norm() < 1e-3 && (at.converted - near.converted).norm() < 1e-3
        );
    }
}

/// Grazing incidence is refused, and the error names the alternatives.
#[test]
fn grazing_incidence_is_refused() {
    for (kind, permitted, refused) in [
        (WaveKind::P, 89.0, 89.01),
        (WaveKind::SV, 89.9, 89.95),
        (WaveKind::SH, 90.0, 90.1),
    ] {
        let at = |degrees| {
            SurfaceReflection::new(kind, Angle::from_degrees(degrees), &support::rock(0.27))
        };
        assert!(at(permitted).is_ok());
        let error = at(refused).unwrap_err();
        assert!(matches!(error, WaveError::GrazingIncidence { .. }));
        assert!(error.to_string().contains("full space"));
    }
}

/// Negative angles, angles that are NaN and impossible media are refused by name.
#[test]
fn impossible_parameters_are_named() {
    let rock = support::rock(0.27);
    for degrees in [-1.0, f64::NAN, f64::INFINITY] {
        let error = SurfaceReflection::new(WaveKind::SV, Angle::from_degrees(degrees), &rock);
        assert!(error.unwrap_err().to_string().contains("incidence"));
    }
    let fluid = ElasticMedium {
        poisson: 0.5,
        ..rock
    };
    let error = SurfaceReflection::new(WaveKind::P, Angle::ZERO, &fluid).unwrap_err();
    assert!(error.to_string().contains("poisson"));
}
