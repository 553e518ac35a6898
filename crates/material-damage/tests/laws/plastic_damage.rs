//! Eq. (25): plasticity with damage.

use powerhouse_material_damage::{
    ConeFit, Control, DruckerPrager, DruckerPragerParameters, ElasticInSeries, MaterialError,
    MohrCoulomb, MohrCoulombParameters, PlasticDamage, PlasticDamageParameters, PointDriver,
    Softening, SofteningOf, TwoSurface, YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::random::Random;

const ENERGY: f64 = 133.0;

fn concrete<S: YieldSurface>(surface: S, tension: Softening) -> PlasticDamage<S> {
    PlasticDamage::new(PlasticDamageParameters {
        surface,
        tension,
        compression: Softening::FractureEnergy {
            energy: 36.0e3,
            threshold: 0.0,
        },
        // Uniaxial tension has closed forms without.
        stiffness_recovery: 0.0,
        residual_stiffness: 1.0e-6,
    })
    .unwrap()
}

fn mohr_coulomb(dilation: f64, tension_strength: Option<f64>) -> MohrCoulomb {
    MohrCoulomb::new(MohrCoulombParameters {
        dilation,
        tension_strength,
        ..presets::PAPER_CONCRETE
    })
    .unwrap()
}

fn by_energy(threshold: f64) -> Softening {
    Softening::FractureEnergy {
        energy: ENERGY,
        threshold,
    }
}

/// The same law with another stiffness recovery.
fn recovering<S: YieldSurface>(law: PlasticDamage<S>, stiffness_recovery: f64) -> PlasticDamage<S> {
    PlasticDamage::new(PlasticDamageParameters {
        stiffness_recovery,
        ..law.parameters().clone()
    })
    .unwrap()
}

/// Past the peak in uniaxial tension the nominal stress is `f exp(-B (e_p - e0))` with `B` of the
/// element's size: 4093 and 8920 at 0.5 and 1 m (computed apart, with f = 1.005864 MPa).
#[test]
fn uniaxial_tension_is_the_closed_form() {
    for (size, expected) in [(0.5, 4093.0), (1.0, 8920.0)] {
        let law = recovering(presets::paper_concrete().unwrap(), 0.0);
        let (f, e) = (law.parameters().surface.uniaxial_tension(), 25.0e9);
        let rate = 1.0 / (ENERGY / (size * f) - 0.5 * f / e);
        assert!((rate - expected).abs() < 1.0, "{rate}");
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        for record in point.advance(Control::uniaxial(8.0e-4), 400).unwrap() {
            let strain = record.strain.0[2];
            let plastic = (strain - f / e).max(0.0);
            let nominal = (e * strain).min(f) * (-rate * plastic).exp();
            let error = (record.stress.0[2] - nominal).abs();
            assert!(error < 1e-10 * f, "{strain:e}: {error:e}");
        }
    }
}

/// The same holds of the raw parameters of the equation with a threshold, in tension and in
/// compression.
#[test]
fn raw_parameters_are_the_equation() {
    let raw = |share, rate, threshold| Softening::Rates {
        share,
        rate,
        threshold,
    };
    let open = PlasticDamage::new(PlasticDamageParameters {
        surface: mohr_coulomb(0.0, None),
        tension: raw(0.9, 1.5e4, 5.0e-5),
        compression: raw(1.2, 1500.0, 2.0e-4),
        stiffness_recovery: 0.0,
        residual_stiffness: 1.0e-3,
    })
    .unwrap();
    let damage = |plastic: f64, share: f64, rate: f64, threshold: f64| {
        if plastic <= threshold {
            return 0.0;
        }
        let kept = (1.0 - share) * threshold / plastic;
        (1.0 - kept - share * (-rate * (plastic - threshold)).exp()).clamp(0.0, 0.999)
    };
    let young = 25.0e9;
    for (end, share, rate, threshold, recovery) in [
        (1.0e-3, 0.9, 1.5e4, 5.0e-5, 0.0),
        (-6.0e-3, 1.2, 1500.0, 2.0e-4, 1.0),
    ] {
        let law = recovering(open, recovery);
        let surface = law.parameters().surface;
        let f = if end > 0.0 {
            surface.uniaxial_tension()
        } else {
            surface.uniaxial_compression()
        };
        let mut point = PointDriver::new(law);
        for record in point.advance(Control::uniaxial(end), 300).unwrap() {
            let strain = record.strain.0[2].abs();
            let plastic = (strain - f / young).max(0.0);
            let nominal = (young * strain).min(f) * (1.0 - damage(plastic, share, rate, threshold));
            let error = (record.stress.0[2].abs() - nominal).abs();
            assert!(error < 1e-10 * f, "{strain:e}: {error:e} of {f}");
        }
    }
}

/// The work that opens a crack is the fracture energy, whatever the size of the element, the
/// surface, its dilation, the threshold, and the factor to the moduli of a law that is damped.
#[test]
fn cracks_dissipate_the_fracture_energy() {
    fn energy<S: YieldSurface>(law: PlasticDamage<S>, size: f64) -> f64 {
        law.check_size(size).unwrap();
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        // The crack opens until a thousandth of the strength is left.
        let opening = 8.0 * ENERGY / 1.0e6 / size;
        point.advance(Control::uniaxial(opening), 2000).unwrap()[1999].work * size
    }
    let cone = |dilation, fit| {
        DruckerPrager::new(DruckerPragerParameters {
            medium: presets::PAPER_CONCRETE.medium,
            friction: 47.7,
            dilation,
            cohesion: 1.3e6,
            fit,
        })
        .unwrap()
    };
    let mut worst = 0.0_f64;
    for size in [0.05, 0.25, 0.5, 1.0] {
        for threshold in [0.0, 2.0e-5] {
            for dilation in [0.0, 20.0] {
                for cut_off in [None, Some(0.8e6)] {
                    let law = concrete(mohr_coulomb(dilation, cut_off), by_energy(threshold));
                    worst = worst.max((energy(law, size) / ENERGY - 1.0).abs());
                }
                let law = concrete(cone(dilation, ConeFit::Inscribed), by_energy(threshold));
                worst = worst.max((energy(law, size) / ENERGY - 1.0).abs());
            }
            // This flow opens laterally too: all three strains count.
            let wide = cone(47.7, ConeFit::Circumscribed);
            assert!(wide.flow_in_uniaxial_tension()[1] > 0.0);
            let law = concrete(wide, by_energy(threshold));
            worst = worst.max((energy(law, size) / ENERGY - 1.0).abs());
        }
    }
    // With other moduli the same law has the same energy.
    for threshold in [0.0, 2.0e-5] {
        let law = concrete(mohr_coulomb(0.0, None), by_energy(threshold));
        for factor in [0.6, 1.5] {
            let law = law.with_stiffness(factor);
            worst = worst.max((energy(law, 1.0) / ENERGY - 1.0).abs());
        }
    }
    // A thousandth of the strength is left, and the trapezoidal rule adds as much.
    println!("largest deviation from the fracture energy {worst:.1e}");
    assert!(worst < 3.0e-3, "{worst:e}");
}

/// The work that crushes is the crushing energy, whatever the size of the element.
#[test]
fn crushing_dissipates_its_energy() {
    for size in [0.25, 1.0] {
        // Lateral cracks of crushing stay closed.
        let law = recovering(concrete(mohr_coulomb(0.0, None), by_energy(0.0)), 1.0);
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        let end = -8.0 * 36.0e3 / law.parameters().surface.uniaxial_compression() / size;
        let work = point.advance(Control::uniaxial(end), 2000).unwrap()[1999].work;
        assert!(
            (work * size / 36.0e3 - 1.0).abs() < 3.0e-3,
            "{}",
            work * size
        );
    }
}

/// Elements that would snap back are refused, naming the largest permitted size.
#[test]
fn snap_back_is_refused() {
    let law = concrete(mohr_coulomb(0.0, None), by_energy(1.0e-5));
    let f = law.parameters().surface.uniaxial_tension();
    let expected = ENERGY / f / (0.5 * f / 25.0e9 + 1.0e-5);
    let largest = law.largest_size().unwrap();
    assert!((largest - expected).abs() < 1e-12 * expected);
    assert_eq!(law.check_size(0.999 * largest), Ok(()));
    let size = 1.001 * largest;
    assert_eq!(
        law.check_size(size),
        Err(MaterialError::SnapBack {
            of: SofteningOf::Tension,
            size,
            largest
        })
    );
    assert!(law.check_size(f64::NAN).is_err());
}

/// Neither flow nor growing damage ever generates energy on random cyclic paths of a hundred
/// thousand steps; damage stays below one, `d_t` and `d_c` never fall, and the sum of the energies
/// stored and dissipated is the work.
#[test]
fn dissipation_is_never_negative() {
    fn check<S: YieldSurface>(law: PlasticDamage<S>) {
        let mut random = Random(31);
        let mut old = [0.0; 15];
        let (mut rate, mut strain) = ([0.0; 6], [0.0; 6]);
        let initial = Stress([-1.0e6, -0.5e6, -1.0e6, 0.1e6, 0.0, 0.0]);
        let (mut sum, mut most) = ([0.0_f64; 2], 0.0_f64);
        for step in 0..50_000 {
            if step % 50 == 0 {
                let size = 6.0e-6 * (1.0 + 3.0 * f64::from(step) / 50_000.0);
                rate = random.six().map(|x| size * x);
            }
            for i in 0..6 {
                strain[i] = 0.999 * strain[i] + rate[i];
            }
            let mut new = [0.0; 15];
            let input = LawInput::new(Strain(strain), &old)
                .with_initial(initial)
                .with_size(0.5);
            let stress = law.stress_change(&input, &mut new);
            assert!(stress.0.iter().all(|s| s.is_finite()));
            let lost = law.energy(&input, &new).unwrap();
            assert!(
                lost.plastic >= 0.0 && lost.damage >= 0.0 && lost.recovered == 0.0,
                "{lost:?}"
            );
            assert!(new[8] >= old[8] && new[9] >= old[9]);
            assert!((0.0..1.0).contains(&new[10]), "{}", new[10]);
            sum = [sum[0] + lost.plastic, sum[1] + lost.damage];
            most = most.max(new[10]);
            old = new;
        }
        assert!(sum.iter().all(|energy| *energy > 0.0), "{sum:?}");
        assert!(most > 0.1, "{most}");
    }
    check(recovering(
        concrete(mohr_coulomb(0.0, None), by_energy(0.0)),
        1.0,
    ));
    let cut_off = mohr_coulomb(47.7, Some(0.8e6));
    check(recovering(concrete(cut_off, by_energy(1.0e-5)), 1.0));
    let listed = TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap();
    check(recovering(concrete(listed, by_energy(0.0)), 1.0));
}

/// Closed cracks carry pressure as undamaged concrete does if stiffness recovers, and the damaged share
/// of it if not; reopened, they are as weak as before.
#[test]
fn stiffness_recovers_as_cracks_close() {
    for recovery in [0.0, 0.4, 1.0] {
        let mut parameters = *presets::paper_concrete().unwrap().parameters();
        parameters.stiffness_recovery = recovery;
        let law = PlasticDamage::new(parameters).unwrap();
        let mut point = PointDriver::new(law).with_size(0.5).unwrap();
        let opened = point.advance(Control::uniaxial(3.0e-4), 200).unwrap()[199].clone();
        let torn = opened.history[8];
        assert!(torn > 0.5);
        // An elastic pressure, in the damaged state.
        let mut target = Control::uniaxial(0.0);
        target[2] = Control::Stress(-0.1e6);
        let closed = point.advance(target, 20).unwrap()[19].clone();
        let plastic = closed.history[2];
        let modulus = closed.stress.0[2] / (closed.strain.0[2] - plastic);
        let expected = 25.0e9 * (1.0 - (1.0 - recovery) * torn);
        assert!(
            (modulus - expected).abs() < 1e-6 * expected,
            "{recovery}: {modulus:e} {expected:e}"
        );
        let end = opened.strain.0[2];
        let again = point.advance(Control::uniaxial(end), 50).unwrap()[49]
            .stress
            .0[2];
        assert!((again - opened.stress.0[2]).abs() < 1e-6 * 1.0e6);
    }
}

/// The damage type in the history is none, tension, compression, or both.
#[test]
fn damage_has_a_type() {
    let law = presets::paper_concrete().unwrap();
    let kind = |ends: &[f64]| {
        let mut point = PointDriver::new(law).with_size(0.5).unwrap();
        for end in ends {
            point.advance(Control::uniaxial(*end), 100).unwrap();
        }
        point.state().history[11]
    };
    assert_eq!(kind(&[2.0e-5]), 0.0);
    assert_eq!(kind(&[2.0e-4]), 1.0);
    assert_eq!(kind(&[2.0e-4, -2.0e-3]), 3.0);
    let names: Vec<&str> = law.history().iter().map(|variable| variable.name).collect();
    assert_eq!(
        (names[8], names[10], names[11]),
        ("damage_tension", "damage", "damage_type")
    );
}

/// The yield surface of concrete by the code has the strengths of its class.
#[test]
fn concrete_of_the_code_has_its_strengths() {
    for (class, tensile, young) in [
        (20.0, 2.21, 29.96),
        (25.0, 2.56, 31.48),
        (40.0, 3.51, 35.22),
    ] {
        let law = presets::eurocode_concrete(class).unwrap();
        let surface = law.parameters().surface;
        let compressive = 1.0e6 * (class + 8.0);
        assert!((surface.uniaxial_compression() - compressive).abs() < 1e-9 * compressive);
        assert!((surface.uniaxial_tension() - 1.0e6 * tensile).abs() < 1.0e4);
        assert!((surface.medium().young - 1.0e9 * young).abs() < 2.0e7);
        assert!(surface.cut_off() < surface.apex());
    }
    assert!(presets::eurocode_concrete(90.0).is_err());
}
