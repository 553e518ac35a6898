//! Closed forms of reflection against independently computed numbers.

use powerhouse_boundary::FaceCoefficients;
use powerhouse_boundary::reflection::{BodyWave, reflection};
use powerhouse_model::ElasticMedium;

use BodyWave::{P, Sv};
use Face::{Free, Lysmer, Springs, Stiffer};

/// The faces of the table.
#[derive(Clone, Copy, Debug)]
enum Face {
    /// Dashpots with B = 1.
    Lysmer,
    /// Dashpots with B = 1.1.
    Stiffer,
    /// Nothing.
    Free,
    /// Springs and dashpots, A = 0.8, B = 1.1, at `w r / cp`.
    Springs(f64),
}

/// Incident wave, degrees from the normal, face, |R_P| and |R_SV| (displacement), reflected energy;
/// Poisson's ratio 0.25. Computed apart from this code from the boundary conditions, and checked
/// there by the balance of energy.
#[rustfmt::skip]
const TABLE: [(BodyWave, f64, Face, f64, f64, f64); 60] = [
    (P, 0.0, Lysmer, 0.0, 0.0, 0.0),
    (P, 0.0, Stiffer, 0.047619, 0.0, 0.00226757),
    (P, 0.0, Free, 1.0, 0.0, 1.0),
    (P, 0.0, Springs(5.0), 0.0710838, 0.0, 0.0050529),
    (P, 0.0, Springs(1.0), 0.259862, 0.0, 0.0675283),
    (P, 15.0, Lysmer, 0.00770555, 0.0131872, 0.000162152),
    (P, 15.0, Stiffer, 0.0510581, 0.0123844, 0.00269757),
    (P, 15.0, Free, 0.8976, 0.573397, 1.0),
    (P, 15.0, Springs(5.0), 0.0710563, 0.0251071, 0.00542155),
    (P, 15.0, Springs(1.0), 0.244492, 0.106999, 0.0665429),
    (P, 30.0, Lysmer, 0.0160351, 0.00895437, 0.000308304),
    (P, 30.0, Stiffer, 0.0478524, 0.053138, 0.00409214),
    (P, 30.0, Free, 0.626304, 0.975782, 1.0),
    (P, 30.0, Springs(5.0), 0.0621913, 0.0660029, 0.00664838),
    (P, 30.0, Springs(1.0), 0.197801, 0.197749, 0.0640849),
    (P, 45.0, Lysmer, 0.0138386, 0.0708951, 0.00393775),
    (P, 45.0, Stiffer, 0.00261335, 0.122101, 0.011119),
    (P, 45.0, Free, 0.28286, 1.11099, 1.0),
    (P, 45.0, Springs(5.0), 0.0246541, 0.131223, 0.0134424),
    (P, 45.0, Springs(1.0), 0.118111, 0.263778, 0.0658113),
    (P, 60.0, Lysmer, 0.133975, 0.133975, 0.0358984),
    (P, 60.0, Stiffer, 0.131987, 0.179606, 0.0496787),
    (P, 60.0, Free, 2.56395e-16, 1.0, 1.0),
    (P, 60.0, Springs(5.0), 0.131706, 0.18543, 0.0517308),
    (P, 60.0, Springs(1.0), 0.125326, 0.287277, 0.098235),
    (P, 75.0, Lysmer, 0.413007, 0.131693, 0.202687),
    (P, 75.0, Stiffer, 0.419159, 0.160705, 0.223514),
    (P, 75.0, Free, 0.0384412, 0.73435, 1.0),
    (P, 75.0, Springs(5.0), 0.418824, 0.163819, 0.225105),
    (P, 75.0, Springs(1.0), 0.411569, 0.222961, 0.261436),
    (Sv, 0.0, Lysmer, 0.0, 0.0, 0.0),
    (Sv, 0.0, Stiffer, 0.0, 0.047619, 0.00226757),
    (Sv, 0.0, Free, 0.0, 1.0, 1.0),
    (Sv, 0.0, Springs(5.0), 0.0, 0.0565486, 0.00319775),
    (Sv, 0.0, Springs(1.0), 0.0, 0.158155, 0.025013),
    (Sv, 15.0, Lysmer, 1.82108e-17, 0.0545323, 0.00297377),
    (Sv, 15.0, Stiffer, 0.0255194, 0.0892387, 0.00900741),
    (Sv, 15.0, Free, 0.565884, 0.697652, 1.0),
    (Sv, 15.0, Springs(5.0), 0.0339441, 0.091514, 0.0102217),
    (Sv, 15.0, Springs(1.0), 0.111851, 0.135157, 0.0383204),
    (Sv, 30.0, Lysmer, 0.133975, 0.133975, 0.0358984),
    (Sv, 30.0, Stiffer, 0.179606, 0.131987, 0.0496787),
    (Sv, 30.0, Free, 1.0, 1.66533e-16, 1.0),
    (Sv, 30.0, Springs(5.0), 0.18543, 0.131706, 0.0517308),
    (Sv, 30.0, Springs(1.0), 0.287277, 0.125326, 0.098235),
    (Sv, 45.0, Lysmer, 0.420367, 0.16937, 0.0286861),
    (Sv, 45.0, Stiffer, 0.451711, 0.181581, 0.0329716),
    (Sv, 45.0, Free, 4.44089e-16, 1.0, 1.0),
    (Sv, 45.0, Springs(5.0), 0.44756, 0.145765, 0.0212473),
    (Sv, 45.0, Springs(1.0), 0.464643, 0.117529, 0.013813),
    (Sv, 60.0, Lysmer, 0.408248, 0.336524, 0.113249),
    (Sv, 60.0, Stiffer, 0.415351, 0.35897, 0.128859),
    (Sv, 60.0, Free, 0.5, 1.0, 1.0),
    (Sv, 60.0, Springs(5.0), 0.40751, 0.331346, 0.10979),
    (Sv, 60.0, Springs(1.0), 0.377725, 0.28677, 0.0822371),
    (Sv, 75.0, Lysmer, 0.279225, 0.592384, 0.350919),
    (Sv, 75.0, Stiffer, 0.276869, 0.611398, 0.373807),
    (Sv, 75.0, Free, 0.472033, 1.0, 1.0),
    (Sv, 75.0, Springs(5.0), 0.272622, 0.592852, 0.351474),
    (Sv, 75.0, Springs(1.0), 0.248586, 0.557802, 0.311143),
];

/// Reflection of plane waves by dashpots, springs and a free face agrees with the table to its
/// printed digits, past the critical angle too.
#[test]
fn plane_waves_return_as_tabulated() {
    let medium = ElasticMedium::new(1.0e10, 0.25, 2700.0).unwrap();
    let distance = 100.0;
    for (wave, degrees, face, p, sv, energy) in TABLE {
        let mut frequency = 20.0;
        let dashpots = FaceCoefficients::viscous(&medium);
        let coefficients = match face {
            Lysmer => dashpots,
            Stiffer => {
                FaceCoefficients::viscous_spring(&medium, 0.0, 1.1, 1.0).with_springs_scaled(0.0)
            }
            Free => FaceCoefficients {
                normal_dashpot: 0.0,
                tangential_dashpot: 0.0,
                ..dashpots
            },
            Springs(number) => {
                frequency = number * medium.p_speed() / distance;
                FaceCoefficients::viscous_spring(&medium, 0.8, 1.1, distance)
            }
        };
        let angle = f64::to_radians(degrees);
        let returned = reflection(&medium, &coefficients, wave, angle, frequency).unwrap();
        let case = format!("{wave:?} at {degrees} degrees on {face:?}");
        let agrees = |found: f64, printed: f64| (found - printed).abs() < 1e-5 * printed + 1e-14;
        assert!(
            agrees(returned.p.norm(), p),
            "{case}: {} {p}",
            returned.p.norm()
        );
        assert!(
            agrees(returned.sv.norm(), sv),
            "{case}: {} {sv}",
            returned.sv.norm()
        );
        let returned_energy = returned.energy(&medium, wave, angle);
        assert!(
            agrees(returned_energy, energy),
            "{case}: {returned_energy} {energy}"
        );
    }
}

/// Angles at and past grazing, and frequencies that are no numbers, are refused.
#[test]
fn impossible_angles_and_frequencies_are_refused() {
    let medium = ElasticMedium::new(1.0e10, 0.25, 2700.0).unwrap();
    let face = FaceCoefficients::viscous(&medium);
    assert!(reflection(&medium, &face, P, core::f64::consts::FRAC_PI_2, 1.0).is_err());
    assert!(reflection(&medium, &face, Sv, -0.1, 1.0).is_err());
    assert!(reflection(&medium, &face, P, 0.1, f64::NAN).is_err());
}

/// Where springs are soft against dashpots, B = 1 returns less than two thirds of what the paper's B = 1.1
/// returns of a P wave that arrives at 30 degrees, for any Poisson's ratio of rock.
#[test]
fn plane_wave_impedance_returns_less_than_the_papers_dashpots() {
    for poisson in [0.15, 0.25, 0.3] {
        let medium = ElasticMedium::new(1.0e10, poisson, 2700.0).unwrap();
        for number in [10.0, 30.0, 100.0] {
            let frequency = number * medium.p_speed() / 100.0;
            let returned = |ratio: f64| {
                let face = FaceCoefficients::viscous_spring(&medium, 0.8, ratio, 100.0);
                let angle = 30.0_f64.to_radians();
                let found = reflection(&medium, &face, P, angle, frequency).unwrap();
                found.p.norm().hypot(found.sv.norm())
            };
            let share = returned(1.0) / returned(1.1);
            assert!(share < 0.67, "{poisson} {number}: {share}");
        }
    }
}
