//! Spectra of codes, and records that are scaled and matched to them.

use std::f64::consts::TAU;

use powerhouse_wavefield::{
    Asce7, BaselineCorrection, ChineseSite, DesignSpectrum, Eurocode8, Eurocode8Ground,
    Eurocode8Type, Nb35047, SpectralBand, TimeHistory, WaveError, characteristic_period,
};

const NINE: [f64; 9] = [0.0, 0.05, 0.1, 0.15, 0.25, 0.4, 1.0, 2.0, 4.0];

fn compare(spectrum: &DesignSpectrum, expected: &[(f64, f64)]) {
    for &(period, value) in expected {
        let found = spectrum.acceleration(period).unwrap();
        assert!(
            (found / value - 1.0).abs() < 1e-12,
            "{} at {period} s: {found} for {value}",
            spectrum.name()
        );
    }
}

/// Ordinates of Eurocode 8 are those of its formulas (3.2) to (3.5) with the figures of tables 3.2 and 3.3, worked out by hand for
/// a_g = 1 m/s2.
#[test]
fn eurocode_8_by_hand() {
    use Eurocode8Ground::{A, B, C, D, E};
    let spectrum = |kind, ground, damping| {
        DesignSpectrum::eurocode_8(&Eurocode8 {
            kind,
            ground,
            peak: 1.0,
            damping,
        })
        .unwrap()
    };
    let check = |kind, ground, expected: [f64; 9]| {
        let points: Vec<(f64, f64)> = NINE.into_iter().zip(expected).collect();
        compare(&spectrum(kind, ground, 0.05), &points);
    };
    let one = Eurocode8Type::One;
    check(one, A, [1.0, 1.5, 2.0, 2.5, 2.5, 2.5, 1.0, 0.5, 0.125]);
    check(one, B, [1.2, 1.8, 2.4, 3.0, 3.0, 3.0, 1.5, 0.75, 0.1875]);
    let c = [
        1.15, 1.58125, 2.0125, 2.44375, 2.875, 2.875, 1.725, 0.8625, 0.215625,
    ];
    check(one, C, c);
    let d = [
        1.35, 1.85625, 2.3625, 2.86875, 3.375, 3.375, 2.7, 1.35, 0.3375,
    ];
    check(one, D, d);
    check(one, E, [1.4, 2.1, 2.8, 3.5, 3.5, 3.5, 1.75, 0.875, 0.21875]);
    let two = Eurocode8Type::Two;
    check(
        two,
        A,
        [1.0, 2.5, 2.5, 2.5, 2.5, 1.5625, 0.625, 0.1875, 0.046875],
    );
    let b = [
        1.35, 3.375, 3.375, 3.375, 3.375, 2.109375, 0.84375, 0.253125, 0.06328125,
    ];
    check(two, B, b);
    check(
        two,
        C,
        [
            1.5, 2.625, 3.75, 3.75, 3.75, 2.34375, 0.9375, 0.28125, 0.0703125,
        ],
    );
    check(
        two,
        D,
        [1.8, 3.15, 4.5, 4.5, 4.5, 3.375, 1.35, 0.405, 0.10125],
    );
    check(two, E, [1.6, 4.0, 4.0, 4.0, 4.0, 2.5, 1.0, 0.3, 0.075]);
    // Damping of 20 %: eta = sqrt(10 / 25); of 30 % it is not below 0.55.
    compare(
        &spectrum(one, A, 0.2),
        &[(0.0, 1.0), (0.3, 2.5 * 0.4f64.sqrt())],
    );
    compare(&spectrum(one, A, 0.3), &[(0.3, 2.5 * 0.55)]);
    assert_eq!(spectrum(one, A, 0.05).acceleration(4.001), None);
}

/// Ordinates of NB 35047-2015, of GB 18306-2015's periods and of ASCE 7-16, worked out by hand.
#[test]
fn other_codes_by_hand() {
    let spectrum = |characteristic_period| {
        DesignSpectrum::nb_35047(&Nb35047 {
            peak: 2.0,
            amplification: 2.25,
            characteristic_period,
            damping: 0.05,
        })
        .unwrap()
    };
    // 4.5 (0.25 / T)^0.6 down to 0.9 m/s2, at T = 0.25 x 5^(5/3) = 3.655 s.
    let points = [
        (0.0, 2.0),
        (0.04, 3.0),
        (0.1, 4.5),
        (0.25, 4.5),
        (0.5, 4.5 / 2f64.powf(0.6)),
        (8.0 / 4.0, 4.5 / 8f64.powf(0.6)),
        (3.7, 0.9),
        (6.0, 0.9),
    ];
    compare(&spectrum(0.25), &points);
    // A period of 0.65 s is not down at a fifth by 6 s.
    compare(&spectrum(0.65), &[(6.0, 4.5 * (0.65f64 / 6.0).powf(0.6))]);
    for (zone, site, period) in [
        (0.35, ChineseSite::I0, 0.20),
        (0.40, ChineseSite::II, 0.40),
        (0.40, ChineseSite::III, 0.55),
        (0.45, ChineseSite::I1, 0.35),
        (0.45, ChineseSite::IV, 0.90),
    ] {
        assert_eq!(characteristic_period(zone, site), Ok(period));
    }
    let wrong = characteristic_period(0.5, ChineseSite::II);
    assert_eq!(wrong, Err(WaveError::ZonePeriod { given: 0.5 }));

    let asce = DesignSpectrum::asce_7(&Asce7 {
        short: 10.0,
        one_second: 6.0,
        long_period: 8.0,
    })
    .unwrap();
    let points = [
        (0.0, 4.0),
        (0.06, 7.0),
        (0.12, 10.0),
        (0.6, 10.0),
        (1.0, 6.0),
        (2.0, 3.0),
        (8.0, 0.75),
        (16.0, 0.1875),
    ];
    compare(&asce, &points);
}

/// A table is straight in logarithmic axes between its points, and refuses what is none.
#[test]
fn tables_of_an_office() {
    let points = [(0.0, 1.0), (0.1, 2.0), (1.0, 2.0), (4.0, 0.5)];
    let table = DesignSpectrum::table("site", 0.05, &points).unwrap();
    compare(&table, &[(0.05, 1.5), (0.3, 2.0), (2.0, 1.0), (4.0, 0.5)]);
    let double = table.scaled(2.0).unwrap();
    compare(&double, &[(0.0, 2.0), (2.0, 2.0)]);
    for wrong in [
        &points[..1],
        &[(0.2, 1.0), (0.2, 2.0)],
        &[(0.2, 1.0), (0.1, 2.0)],
        &[(0.2, 1.0), (0.3, 0.0)],
        &[(-0.1, 1.0), (0.3, 1.0)],
        &[(0.1, f64::NAN), (0.3, 1.0)],
    ] {
        assert!(
            DesignSpectrum::table("wrong", 0.05, wrong).is_err(),
            "{wrong:?}"
        );
    }
}

/// Band-limited noise in an envelope that rises and falls, of a seed.
fn record(seed: u64, step: f64, duration: f64) -> TimeHistory {
    let mut state = seed;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let waves: Vec<(f64, f64, f64)> = (0..60)
        .map(|_| {
            let frequency = 0.3 * 50f64.powf(random());
            (frequency, 6.3 * random(), random() / frequency.powf(0.4))
        })
        .collect();
    let sample = |i: usize| {
        let time = i as f64 * step;
        let envelope = (time / 3.0).powi(2) * (2.0 - time / 1.5).exp();
        let sum: f64 = waves
            .iter()
            .map(|(frequency, phase, size)| size * (TAU * frequency * time + phase).sin())
            .sum();
        envelope * sum
    };
    let samples = (0..(duration / step) as usize).map(sample).collect();
    let history = TimeHistory::new(step, samples).unwrap();
    let correction = BaselineCorrection::VelocityPolynomial { order: 5 };
    history.corrected(correction).unwrap().0
}

fn target(ground: Eurocode8Ground) -> DesignSpectrum {
    DesignSpectrum::eurocode_8(&Eurocode8 {
        kind: Eurocode8Type::One,
        ground,
        peak: 2.0,
        damping: 0.05,
    })
    .unwrap()
}

const BAND: SpectralBand = SpectralBand {
    shortest: 0.1,
    longest: 2.0,
    tolerance: 0.05,
};

/// The factor makes the mean of the logarithm of the ratio zero, of one record and of a pair, which keeps its proportion.
#[test]
fn a_factor_centres_the_spectrum() {
    let target = target(Eurocode8Ground::B);
    let [first, second] = [1, 2].map(|seed| record(seed, 0.01, 20.0));
    let logarithms = |history: &TimeHistory| {
        let count = 200;
        let period = |i: usize| 0.1 * 20f64.powf(i as f64 / f64::from(count - 1));
        let periods: Vec<f64> = (0..count as usize).map(period).collect();
        let responses = history.response_spectrum(0.05, &periods).unwrap();
        let ratio = responses.iter().map(|response| {
            (response.pseudo_acceleration() / target.acceleration(response.period).unwrap()).ln()
        });
        ratio.sum::<f64>() / f64::from(count)
    };
    for histories in [&[&first][..], &[&first, &second]] {
        let factor = TimeHistory::factor_to_spectrum(histories, &target, &BAND).unwrap();
        let mean: f64 = histories
            .iter()
            .map(|history| logarithms(&history.scaled(factor).unwrap()))
            .sum();
        assert!(mean.abs() < 0.01, "{mean}");
    }
    let still = TimeHistory::new(0.01, vec![0.0; 1000]).unwrap();
    let fault = TimeHistory::factor_to_spectrum(&[&still], &target, &BAND);
    assert_eq!(fault, Err(WaveError::ZeroPeak));
    let long = SpectralBand {
        longest: 5.0,
        ..BAND
    };
    assert!(TimeHistory::factor_to_spectrum(&[&first], &target, &long).is_err());
}

/// Eleven matched records of several steps have the spectrum to 15 % at periods between those of the wavelets as well, and to 1 % in the
/// mean over the band, as the report says; the mean of the records is within 0.9 and 1.1 at every period.
#[test]
fn matched_records_have_the_spectrum() {
    let target = target(Eurocode8Ground::B);
    let periods: Vec<f64> = (0..150)
        .map(|i| 0.1 * 20f64.powf(i as f64 / 149.0))
        .collect();
    let mut sum = vec![0.0; periods.len()];
    for seed in 1..=11 {
        let step = [0.005, 0.01, 0.02][seed as usize % 3];
        let original = record(seed, step, 15.0);
        let (matched, report) = original.matched_to_spectrum(&target, &BAND).unwrap();
        let responses = matched.response_spectrum(0.05, &periods).unwrap();
        for (sum, response) in sum.iter_mut().zip(&responses) {
            let ratio =
                response.pseudo_acceleration() / target.acceleration(response.period).unwrap();
            assert!(
                (ratio - 1.0).abs() < 0.15,
                "seed {seed}, {} s: {ratio}",
                response.period
            );
            *sum += ratio / 11.0;
        }
        let misfit = matched.misfit(&target, &BAND).unwrap();
        assert_eq!(misfit, report.after);
        assert!((misfit.mean - 1.0).abs() < 0.01, "{misfit:?}");
        assert!(report.after.worst() < report.before.worst());
        assert_eq!(report.motion_after, matched.report());
    }
    for (mean, period) in sum.iter().zip(&periods) {
        assert!((mean - 1.0).abs() < 0.1, "{period} s: {mean}");
    }
}
