//! Curves of shear modulus and damping of soils.

use powerhouse_material_damage::{DarendeliSoil, StrainCurves};

/// The damping of Darendeli, less that at small strain and without its scaling, is the area of the loop that Masing's rule makes
/// of the backbone of the modulus.
#[test]
fn damping_of_darendeli_is_that_of_masing_loops() {
    for (plasticity, pressure) in [(0.0, 101_325.0), (30.0, 4e5), (100.0, 5e4)] {
        let soil = DarendeliSoil {
            cycles: 1.0,
            ..DarendeliSoil::new(plasticity, pressure)
        };
        let curves = StrainCurves::darendeli(&soil).unwrap();
        let small = curves.damping(1e-6);
        // The reference strain is where half of the modulus is left.
        let atmospheres = pressure / 101_325.0_f64;
        let reference = 0.01 * (0.0352 + 0.001 * plasticity) * atmospheres.powf(0.3483);
        assert!((curves.modulus(reference) - 0.5).abs() < 5e-3);
        for strain in [3e-5, 1e-4, 3e-4, 1e-3, 3e-3] {
            let stress = |at: f64| at / (1.0 + (at / reference).powf(0.919));
            let steps = 20_000;
            let width = strain / f64::from(steps);
            let below: f64 = (0..steps)
                .map(|i| stress(width * (f64::from(i) + 0.5)) * width)
                .sum();
            let whole = strain * stress(strain);
            let loss = 8.0 * (below - 0.5 * whole) / (4.0 * std::f64::consts::PI * 0.5 * whole);
            let scale = 0.6329 * curves.modulus(strain).powf(0.1);
            let found = (curves.damping(strain) - small) / scale;
            assert!(
                (found - loss).abs() < 0.006,
                "{plasticity} {strain}: {found} {loss}"
            );
        }
    }
}

/// Values between the strains of curves lie between theirs, and are constant beyond both ends.
#[test]
fn curves_are_monotone_between_their_points() {
    let strains = vec![1e-6, 1e-5, 1e-3];
    let curves = StrainCurves::new(strains, vec![1.0, 0.9, 0.2], vec![0.01, 0.02, 0.1]).unwrap();
    let mut before = (1.0, 0.01);
    for index in 0..=600 {
        let strain = 1e-7 * 10f64.powf(f64::from(index) / 100.0);
        let now = (curves.modulus(strain), curves.damping(strain));
        assert!(now.0 <= before.0 && now.1 >= before.1, "{strain}");
        before = now;
    }
    assert_eq!(before, (0.2, 0.1));
    assert_eq!(curves.modulus(0.0), 1.0);
    assert!((curves.modulus(1e-4) - 0.55).abs() < 1e-12);
    assert_eq!(curves.greatest_strain(), 1e-3);
}
