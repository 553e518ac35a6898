//! Mazars' damage law in total strain.

use powerhouse_material_damage::{
    Control, ElasticInSeries, MaterialError, Mazars, MazarsParameters, MazarsTension, PointDriver,
    PointState, SofteningOf, presets,
};
use powerhouse_model::{ConstitutiveLaw, ElasticMedium, LawInput, Strain, Stress};

/// Strain, stress (Pa) and damage in uniaxial tension and compression, computed apart from the
/// law: E 30 GPa, nu 0.2, e0 1e-4, A_t 1, B_t 1.5e4, A_c 1.2, B_c 1500.
#[rustfmt::skip]
const TYPICAL: [[f64; 3]; 14] = [
    [5e-05, 1500000.0, 0.0],
    [0.0001, 3000000.0, 0.0],
    [0.00015000000000000001, 2125649.4873345657, 0.5276334472589854],
    [0.0002, 1338780.9608905788, 0.7768698398515702],
    [0.00030000000000000003, 448083.6153107756, 0.950212931632136],
    [0.0005, 37181.28264999565, 0.9975212478233336],
    [-0.00025, -7500000.0, 0.0],
    [-0.001, -25243407.2432795, 0.15855309189068323],
    [-0.00175, -32715420.67185658, 0.37684913005987475],
    [-0.0025, -34081951.55011216, 0.5455739793318379],
    [-0.0032500000000000003, -32115980.28845627, 0.6706053303748075],
    [-0.004, -28532491.599373452, 0.7622292366718879],
    [-0.00475, -24359195.996376436, 0.829058273709639],
    [-0.0055, -20183764.063152064, 0.8776741571930178],
];
/// The same with A_t 0.8, B_t 1e4, A_c 1.4, B_c 1900.
#[rustfmt::skip]
const SLOWER: [[f64; 3]; 17] = [
    [5e-05, 1500000.0, 0.0],
    [0.0001, 3000000.0, 0.0],
    [0.00015000000000000001, 2783510.37496548, 0.38144213889656003],
    [0.0002, 2365821.3176229238, 0.6056964470628461],
    [0.00030000000000000003, 1574414.039303611, 0.8250651067440432],
    [0.0005, 819787.6666648102, 0.9453474888890127],
    [0.001, 602961.8352980814, 0.9799012721567306],
    [0.002, 600000.2689342288, 0.9899999955177629],
    [0.003, 600000.0000183192, 0.9933333333331298],
    [-0.00025, -7500000.0, 0.0],
    [-0.00125, -28186639.606778093, 0.24835627715258424],
    [-0.002, -30432204.15088555, 0.49279659748524085],
    [-0.00275, -27619463.824594352, 0.6652186203079472],
    [-0.0035, -22857218.960633177, 0.7823122003749221],
    [-0.00425, -17748368.532355044, 0.8607971095501565],
    [-0.005, -13046900.485825308, 0.9130206634278313],
    [-0.00575, -9044714.421978537, 0.9475668729160664],
];

fn typical(tension: MazarsTension) -> MazarsParameters {
    MazarsParameters {
        medium: ElasticMedium::new(30.0e9, 0.2, 2400.0).unwrap(),
        threshold: 1.0e-4,
        tension,
        compression_share: 1.2,
        compression_rate: 1500.0,
        residual_stiffness: 1.0e-6,
    }
}

fn rates(share: f64) -> MazarsTension {
    MazarsTension::Rates { share, rate: 1.5e4 }
}

/// Uniaxial curves in tension and compression are those of a table computed apart.
#[test]
fn uniaxial_curves_are_those_of_the_table() {
    let slower = MazarsParameters {
        compression_share: 1.4,
        compression_rate: 1900.0,
        ..typical(MazarsTension::Rates {
            share: 0.8,
            rate: 1.0e4,
        })
    };
    for (parameters, table) in [(typical(rates(1.0)), &TYPICAL[..]), (slower, &SLOWER[..])] {
        let law = Mazars::new(parameters).unwrap();
        let peak = |sign: f64| {
            table
                .iter()
                .fold(0.0, |most: f64, row| most.max(sign * row[1]))
        };
        let mut point = PointDriver::new(law);
        let mut last = 0.0;
        for &[strain, stress, damage] in table {
            // Each branch starts from an undamaged point.
            if strain * last < 0.0 {
                point = PointDriver::new(law);
            }
            last = strain;
            let end = point.advance(Control::uniaxial(strain), 1).unwrap()[0].clone();
            let error = (end.stress.0[2] - stress).abs();
            assert!(error < 1e-10 * peak(strain.signum()), "{strain}: {error:e}");
            assert!(
                (end.history[3] - damage).abs() < 1e-10,
                "{strain}: {damage}"
            );
        }
    }
}

/// A law whose moduli are multiplied by a factor, as that of a damped material is, has the same stress at a strain divided by
/// it, in tension and in compression: its strengths are unchanged.
#[test]
fn stiffer_laws_have_the_same_strengths() {
    let law = Mazars::new(typical(rates(0.9))).unwrap();
    for factor in [0.6, 1.5] {
        let laws = [(law, 1.0), (law.with_stiffness(factor), factor)];
        for end in [6.0e-4, -6.0e-3] {
            let [given, stiff] = laws.map(|(law, factor)| {
                let control = Control::uniaxial(end / factor);
                PointDriver::new(law).advance(control, 60).unwrap()
            });
            let stress = |records: &[PointState]| -> Vec<f64> {
                records.iter().map(|record| record.stress.0[2]).collect()
            };
            let (given, stiff) = (stress(&given), stress(&stiff));
            let peak = given.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            assert!(given[59].abs() < 0.8 * peak);
            for (given, stiff) in given.iter().zip(&stiff) {
                let off = (stiff - given).abs();
                assert!(off < 1e-9 * peak, "{factor} {end}: {given} {stiff}");
            }
        }
    }
}

/// The work that opens a crack is the fracture energy for every permitted size, and sizes
/// out of range are refused on both sides.
#[test]
fn cracks_dissipate_the_fracture_energy_or_are_refused() {
    let energy = 100.0;
    let law = Mazars::new(typical(MazarsTension::FractureEnergy { energy })).unwrap();
    let [least, largest] = law.permitted_sizes().unwrap();
    // Without softening left, the energy is that of the peak.
    let at_peak = 0.5 * 30.0e9 * 1.0e-8;
    assert!((largest * at_peak / energy - 1.0).abs() < 1e-12);
    for share in [0.001, 0.3, 0.7] {
        let size = least + share * (largest - least);
        law.check_size(size).unwrap();
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        let work = point.advance(Control::uniaxial(3.0e-3), 6000).unwrap()[5999].work;
        let error = (work * size / energy - 1.0).abs();
        // A millionth of the stiffness is left; the trapezoidal rule has a step of 5e-7.
        assert!(error < 1e-3, "{size}: {error:e}");
    }
    let size = 1.01 * largest;
    assert_eq!(
        law.check_size(size),
        Err(MaterialError::SnapBack {
            of: SofteningOf::Tension,
            size,
            largest
        })
    );
    let refused = law.check_size(0.99 * least);
    assert!(matches!(refused, Err(MaterialError::Hardening { product }) if product < 1.0));
    let slow = MazarsTension::Rates {
        share: 1.0,
        rate: 0.9e4,
    };
    let refused = Mazars::new(typical(slow));
    assert!(
        matches!(refused, Err(MaterialError::Hardening { product }) if (product - 0.9).abs() < 1e-12)
    );
}

/// Where the stress itself falls exponentially, it is `E e0 exp(-B (e - e0))`, and the work that
/// opens a crack is the fracture energy for elements of any width that does not snap back.
#[test]
fn falling_stress_dissipates_the_fracture_energy_at_any_width() {
    let energy = 100.0;
    let law = Mazars::new(typical(MazarsTension::FallingStress { energy })).unwrap();
    let [least, largest] = law.permitted_sizes().unwrap();
    assert!(least == 0.0 && (largest * 150.0 / energy - 1.0).abs() < 1e-12);
    for size in [0.01, 0.05, 0.3] {
        law.check_size(size).unwrap();
        let rate = 1.0 / (energy / (size * 3.0e6) - 0.5e-4);
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        let end = 1.0e-4 + 14.0 / rate;
        let path = point.advance(Control::uniaxial(end), 6000).unwrap();
        for record in path.iter().step_by(50) {
            let strain = record.strain.0[2];
            let fallen = 3.0e6 * (-rate * (strain - 1.0e-4)).exp();
            let expected = (30.0e9 * strain).min(fallen);
            let error = (record.stress.0[2] - expected).abs();
            // A millionth of the stiffness is never lost.
            assert!(
                error < 1e-10 * 3.0e6 + 1e-6 * 30.0e9 * strain,
                "{strain}: {error:e}"
            );
        }
        let taken = path[5999].work * size / energy;
        // The work includes that of the residual stiffness.
        let kept = 0.5e-6 * 30.0e9 * end * end * size / energy;
        assert!((taken - 1.0).abs() < 1e-3 + kept, "{size}: {taken}");
    }
    let size = 1.01 * largest;
    assert_eq!(
        law.check_size(size),
        Err(MaterialError::SnapBack {
            of: SofteningOf::Tension,
            size,
            largest
        })
    );
}

/// An initial stress causes the same damage as the strain of that stress.
#[test]
fn initial_stress_counts_as_strain() {
    let law = Mazars::new(typical(rates(0.8))).unwrap();
    let strain = [3.0e-4, -1.0e-4, 0.5e-4, 1.0e-4, 0.0, -2.0e-4];
    let half = strain.map(|e| 0.5 * e);
    let medium = law.medium();
    let initial = Stress::elastic(medium.lambda(), medium.shear(), &Strain(half));
    let (old, mut whole, mut parted) = ([0.0; 5], [0.0; 5], [0.0; 5]);
    let direct = law.stress_change(&LawInput::new(Strain(strain), &old), &mut whole);
    let input = LawInput::new(Strain(half), &old).with_initial(initial);
    let split = initial + law.stress_change(&input, &mut parted);
    assert!(whole[3] > 0.1);
    for i in 0..6 {
        assert!((direct.0[i] - split.0[i]).abs() < 1e-12 * 1.0e7);
    }
    for i in 0..4 {
        assert!((whole[i] - parted[i]).abs() < 1e-12);
    }
}

/// The paper's concrete in total strain starts to soften at its listed tensile strength and peaks
/// near its listed compressive one.
#[test]
fn the_papers_concrete_has_its_listed_strengths() {
    let law = Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap();
    let peak = |end: f64| {
        let mut point = PointDriver::new(law);
        let path = point.advance(Control::uniaxial(end), 2000).unwrap();
        path.iter()
            .fold(0.0, |most: f64, r| most.max(r.stress.0[2] * end.signum()))
    };
    assert!((peak(2.0e-4) - 1.27e6).abs() < 1.0e-3 * 1.27e6);
    let compressive = peak(-4.0e-3);
    assert!(
        (compressive - 16.7e6).abs() < 0.05 * 16.7e6,
        "{compressive}"
    );
}

/// Strains of all magnitudes give finite stresses, and those that are not finite ones that are not.
#[test]
fn extreme_strains_are_finite_or_not_finite() {
    let law = Mazars::new(typical(rates(1.0))).unwrap();
    let respond = |strain: [f64; 6]| {
        let mut new = [0.0_f64; 5];
        let stress = law.stress_change(&LawInput::new(Strain(strain), &[0.0; 5]), &mut new);
        (stress, new)
    };
    for size in [0.0, 1e-300, 1e-150, 1e-4, 1e3, 1e150, 1e290] {
        for sign in [-1.0, 1.0] {
            let (stress, new) = respond([sign * size, 0.2 * size, 0.0, 0.5 * size, 0.0, -size]);
            assert!(stress.0.iter().chain(&new).all(|x| x.is_finite()), "{size}");
        }
    }
    for broken in [f64::NAN, f64::INFINITY, 1e300] {
        let stress = respond([0.0, broken, 0.0, 0.0, 0.0, 0.0]).0;
        assert!(!stress.0.iter().all(|x| x.is_finite()));
    }
}
