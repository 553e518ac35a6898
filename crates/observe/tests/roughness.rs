//! Roughness of a recorded motion: whether its samples hold what moved between them.

use powerhouse_observe::Column;

fn column(name: &str, value: impl Fn(f64) -> f64) -> Column {
    Column::new(
        name,
        "m/s2",
        (0..200).map(|i| value(f64::from(i))).collect(),
    )
}

/// The roughness of a sinusoid is that of its samples per period, whatever its phase and direction and however many
/// periods are summed over.
#[test]
fn roughness_is_that_of_samples_per_period() {
    for samples in [2.3, 3.0, 5.0, 5.99, 6.01, 7.0, 11.7, 40.0] {
        for phase in [0.0, 0.3, 1.9] {
            let wave = |i: f64| (core::f64::consts::TAU * i / samples + phase).sin();
            let motion = [
                column("a.ax", |i| 0.6 * wave(i)),
                column("a.ay", |_| 0.0),
                column("a.az", |i| -0.8 * wave(i)),
            ];
            let found = Column::roughness(&motion).unwrap();
            let expected = 4.0 * (core::f64::consts::PI / samples).sin().powi(2);
            assert!((found / expected - 1.0).abs() < 1e-12, "{samples}: {found}");
        }
    }
}

/// A peak of one sample is rough, a wide one is not; a motion that is zero, or too short, has no roughness.
#[test]
fn roughness_is_that_of_the_greatest_peak() {
    let peak = |width: f64| {
        let long = |i: f64| 0.1 * (i / 20.0).sin();
        let peak = column("a.ax", |i| long(i) + (-((i - 90.0) / width).powi(2)).exp());
        Column::roughness(&[peak]).unwrap()
    };
    assert!(peak(0.3) > 1.5, "{}", peak(0.3));
    assert!(peak(4.0) < 0.2, "{}", peak(4.0));
    assert_eq!(Column::roughness(&[column("a.ax", |_| 0.0)]), None);
    assert_eq!(Column::roughness(&[]), None);
    for samples in 0..3 {
        let short = Column::new(
            "a.ax",
            "m/s2",
            (0..samples).map(|i| i as f64 + 1.0).collect(),
        );
        assert_eq!(Column::roughness(&[short]), None, "{samples}");
    }
}
