//! Plane waves in layered ground: closed forms, limits, continuity, errors.

use crate::support::{rock, size};
use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, Complex, Ground, GroundLayer, HarmonicBurst, InputConvention, LayerDamping, LayerDefect,
    LayerMechanism, LayeredWave, LayeredWaveParameters, PlaneWave, PlaneWaveParameters,
    QuietStartLimits, Ricker, RickerQuantity, Signal, SmoothPulse, SurfaceComponent,
    SurfaceReflection, WaveError, WaveKind,
};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

const KINDS: [WaveKind; 3] = [WaveKind::P, WaveKind::SV, WaveKind::SH];

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

fn two() -> Ground {
    let layers = vec![
        GroundLayer::new(-20.0, medium(1800.0, 200.0, 500.0)),
        GroundLayer::new(-40.0, medium(2000.0, 400.0, 1000.0)),
    ];
    Ground::new(0.0, layers, medium(2300.0, 900.0, 2000.0)).unwrap()
}

fn ricker() -> Arc<dyn Signal> {
    Arc::new(Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 0.6).unwrap())
}

fn layered(kind: WaveKind, degrees: f64, ground: Ground, signal: Arc<dyn Signal>) -> LayeredWave {
    let lowest = ground.base() - 60.0;
    let mut parameters = LayeredWaveParameters::vertical(kind, ground, lowest);
    parameters.incidence = Angle::from_degrees(degrees);
    parameters.until = Some(100.0);
    LayeredWave::new(parameters, signal).unwrap()
}

/// Ground of one medium, cut into layers.
fn equal(count: usize) -> Ground {
    let layers = (1..=count).map(|i| GroundLayer::new(-11.0 * i as f64, rock(0.3)));
    Ground::new(0.0, layers.collect(), rock(0.3)).unwrap()
}

/// Transfer function of a half-space without layers by the coefficients of its surface: motion at a depth
/// below the surface for unit incident motion at the depth `base`.
fn closed_form(
    reflection: &SurfaceReflection,
    depth: f64,
    base: f64,
    frequency: f64,
) -> [Complex; 3] {
    let w = 2.0 * PI * frequency;
    let after = |delay: Complex| (Complex::new(0.0, -w) * delay).exp();
    let rise = Complex::new(reflection.vertical_slowness, 0.0);
    let fall = reflection.converted_slowness;
    let (sine, cosine) = reflection.incidence.radians().sin_cos();
    let (p, real) = (reflection.horizontal_slowness, |x| Complex::new(x, 0.0));
    // Speed of the converted wave from its slowness.
    let c = 1.0 / (fall * fall + p * p).re.sqrt();
    let zero = real(0.0);
    let waves = match reflection.kind {
        WaveKind::P => [
            [real(sine), zero, real(cosine)],
            [real(-sine), zero, real(cosine)],
            [fall * c, zero, real(p * c)],
        ],
        WaveKind::SV => [
            [real(cosine), zero, real(-sine)],
            [real(-cosine), zero, real(-sine)],
            [real(p * c), zero, -fall * c],
        ],
        WaveKind::SH => [[zero, real(1.0), zero], [zero, real(1.0), zero], [zero; 3]],
    };
    let delays = [
        rise * (base - depth),
        rise * (base + depth),
        rise * base + if depth == 0.0 { zero } else { fall * depth },
    ];
    let factors = [real(1.0), reflection.same, reflection.converted];
    core::array::from_fn(|i| {
        (0..3)
            .map(|k| waves[k][i] * factors[k] * after(delays[k]))
            .sum()
    })
}

/// Without layers, and with four layers of the same medium, the spectrum is that of the half-space to
/// 1e-10, from 0 to 85 degrees, before and past the critical angle, down to 4 km.
#[test]
fn equal_layers_have_the_spectrum_of_a_half_space() {
    let mut worst = 0.0f64;
    for count in [0, 1, 4] {
        let ground = equal(count);
        for kind in KINDS {
            for degrees in (0..=85).step_by(5) {
                let mut parameters = LayeredWaveParameters::vertical(kind, ground.clone(), -4000.0);
                parameters.incidence = Angle::from_degrees(f64::from(degrees));
                let wave = LayeredWave::new(parameters.clone(), ricker()).unwrap();
                let reflection =
                    SurfaceReflection::new(kind, parameters.incidence, &rock(0.3)).unwrap();
                for depth in [0.0, 5.5, 11.0, 100.0, 4000.0] {
                    for frequency in [0.1, 2.0, 9.0] {
                        let found = wave.transfer(-depth, frequency).unwrap();
                        let expected = closed_form(&reflection, depth, -ground.base(), frequency);
                        for (found, expected) in found.iter().zip(expected) {
                            worst = worst.max((found - expected).norm());
                        }
                    }
                }
            }
        }
    }
    println!("figure wavefield.layered_equal_spectrum {worst:e}");
    assert!(worst < 1e-10, "{worst:e}");
}

/// Largest differences of displacement, velocity and stress of two fields over the peaks of the second.
fn difference(
    (a, b): (&dyn IncidentField, &dyn IncidentField),
    points: &[Vec3],
    times: impl Iterator<Item = f64>,
) -> [f64; 3] {
    let (a, b) = (a.prepare(points).unwrap(), b.prepare(points).unwrap());
    let (mut worst, mut peak) = ([0.0f64; 3], [0.0f64; 3]);
    for time in times {
        let mut motion = [(); 2].map(|()| vec![FieldMotion::default(); points.len()]);
        a.add_motion(time, &mut motion[0]);
        b.add_motion(time, &mut motion[1]);
        for (a, b) in motion[0].iter().zip(&motion[1]) {
            let stress: [f64; 6] = core::array::from_fn(|i| a.stress.0[i] - b.stress.0[i]);
            let apart = [
                (a.displacement - b.displacement).norm(),
                (a.velocity - b.velocity).norm(),
                size(&stress),
            ];
            let of = [b.displacement.norm(), b.velocity.norm(), size(&b.stress.0)];
            for k in 0..3 {
                worst[k] = worst[k].max(apart[k]);
                peak[k] = peak[k].max(of[k]);
            }
        }
    }
    core::array::from_fn(|k| worst[k] / peak[k])
}

fn plane(kind: WaveKind, degrees: f64, azimuth: f64, signal: Arc<dyn Signal>) -> PlaneWave {
    let mut parameters = PlaneWaveParameters::vertical(kind, rock(0.3), 0.0);
    parameters.incidence = Angle::from_degrees(degrees);
    parameters.azimuth = Angle::from_degrees(azimuth);
    parameters.reference = Vec3::new(30.0, -20.0, -80.0);
    parameters.arrival = 0.25;
    PlaneWave::new(parameters, signal).unwrap()
}

/// In time equal layers agree with the plane wave of the half-space, turned by an azimuth: before the
/// critical angle to 1e-5 of the peak displacement and 1e-3 of velocity and stress.
#[test]
fn equal_layers_move_like_a_half_space() {
    let points = [0.0, -5.0, -11.0, -40.0, -75.0].map(|z| Vec3::new(12.0, 50.0, z));
    let signals: [Arc<dyn Signal>; 3] = [
        ricker(),
        Arc::new(SmoothPulse::new(1.0, 0.4).unwrap()),
        Arc::new(HarmonicBurst::new(1.0, 5.0, 4.0).unwrap()),
    ];
    let mut worst = [0.0f64; 3];
    for (kind, degrees) in [
        (WaveKind::P, 0.0),
        (WaveKind::P, 35.0),
        (WaveKind::P, 85.0),
        (WaveKind::SV, 0.0),
        (WaveKind::SV, 28.0),
        (WaveKind::SH, 0.0),
        (WaveKind::SH, 60.0),
        (WaveKind::SH, 85.0),
    ] {
        for (signal, count) in signals.iter().zip([0, 4, 2]) {
            let plane = plane(kind, degrees, 115.0, signal.clone());
            let mut parameters = LayeredWaveParameters::vertical(kind, equal(count), -90.0);
            parameters.incidence = Angle::from_degrees(degrees);
            parameters.azimuth = Angle::from_degrees(115.0);
            parameters.reference = Vec3::new(30.0, -20.0, -80.0);
            parameters.arrival = 0.25;
            let wave = LayeredWave::new(parameters, signal.clone()).unwrap();
            assert!(wave.is_causal());
            let times = (-20..400).map(|i| 0.005173 * f64::from(i));
            let apart = difference((&wave, &plane), &points, times);
            worst = core::array::from_fn(|k| worst[k].max(apart[k]));
            let ok = apart[0] < 1e-5 && apart[1] < 1e-3 && apart[2] < 1e-3;
            assert!(ok, "{kind} {degrees} in {count} layers: {apart:?}");
        }
    }
    println!("figure wavefield.layered_equal_time {worst:?}");
}

/// Past the critical angle a one-sided pulse in equal layers agrees with the plane wave to 1e-4 of the peak
/// displacement, its forerunner and what follows included.
#[test]
fn equal_layers_past_the_critical_angle_move_like_a_half_space() {
    let points = [0.0, -11.0, -30.0, -75.0].map(|z| Vec3::new(12.0, 50.0, z));
    let pulse: Arc<dyn Signal> = Arc::new(SmoothPulse::new(1.0, 0.4).unwrap());
    let mut worst = [0.0f64; 3];
    for degrees in [34.0, 40.0, 60.0, 85.0] {
        let plane = plane(WaveKind::SV, degrees, 115.0, pulse.clone());
        let mut parameters = LayeredWaveParameters::vertical(WaveKind::SV, equal(3), -90.0);
        parameters.incidence = Angle::from_degrees(degrees);
        parameters.azimuth = Angle::from_degrees(115.0);
        parameters.reference = Vec3::new(30.0, -20.0, -80.0);
        parameters.arrival = 0.25;
        let wave = LayeredWave::new(parameters, pulse.clone()).unwrap();
        let times = (-1000..1000).map(|i| 0.00917 * f64::from(i));
        let apart = difference((&wave, &plane), &points, times);
        worst = core::array::from_fn(|k| worst[k].max(apart[k]));
        println!("SV {degrees}: {apart:?}, {:?}", wave.report());
    }
    println!("figure wavefield.layered_past_critical {worst:?}");
    assert!(
        worst[0] < 1e-4 && worst[1] < 1e-3 && worst[2] < 1e-3,
        "{worst:?}"
    );
}

/// Past the critical angle, and with a stiff layer in which waves decay, the field does not depend on the
/// window in which it is computed: to 1e-4 of the peak displacement, also where layers ring on at sharp
/// resonances.
#[test]
fn fields_that_are_not_causal_do_not_depend_on_their_window() {
    let points = [0.0, -11.0, -20.0, -40.0, -75.0].map(|z| Vec3::new(0.0, 0.0, z));
    let pulse: Arc<dyn Signal> = Arc::new(SmoothPulse::new(1.0, 0.4).unwrap());
    let slab = vec![
        GroundLayer::new(-20.0, medium(2300.0, 900.0, 2000.0)),
        GroundLayer::new(-40.0, medium(2000.0, 400.0, 1000.0)),
    ];
    let slab = Ground::new(0.0, slab, medium(2000.0, 500.0, 1300.0)).unwrap();
    for (ground, kind, degrees) in [
        (two(), WaveKind::SV, 40.0),
        (two(), WaveKind::SV, 50.0),
        (slab.clone(), WaveKind::SV, 20.0),
        (slab, WaveKind::SH, 40.0),
    ] {
        let in_window = |lowest: f64, until: f64| {
            let mut parameters = LayeredWaveParameters::vertical(kind, ground.clone(), lowest);
            parameters.incidence = Angle::from_degrees(degrees);
            parameters.until = Some(until);
            LayeredWave::new(parameters, pulse.clone()).unwrap()
        };
        let (short, long) = (in_window(-80.0, 8.0), in_window(-2000.0, 150.0));
        assert!(!short.is_causal());
        let times = (-300..600).map(|i| 0.01 * f64::from(i));
        let apart = difference((&short, &long), &points, times);
        println!(
            "{kind} {degrees}: {apart:?}, {:?}, {}",
            short.report(),
            long.report().samples
        );
        assert!(long.report().samples >= 2 * short.report().samples);
        assert!(apart[0] < 1e-4, "{kind} {degrees}: {apart:?}");
    }
}

/// SH transfer function of one layer, elastic and with flat damping, against the closed form
/// `2 / (cos k + i a sin k)`, `k = w s h`, `a = M s / (G' s')`, to 1e-10.
#[test]
fn one_layer_has_its_transfer_function() {
    let (soil, below) = (medium(1800.0, 200.0, 500.0), medium(2300.0, 900.0, 2000.0));
    let mechanisms = vec![
        LayerMechanism {
            frequency: 0.7,
            weight: 0.1,
        },
        LayerMechanism {
            frequency: 9.0,
            weight: 0.12,
        },
    ];
    let flat = LayerDamping::Flat {
        mechanisms: mechanisms.clone(),
        velocity: 1.04,
    };
    let mut worst = 0.0f64;
    for damping in [LayerDamping::None, flat] {
        let layer = GroundLayer::new(-20.0, soil).with_damping(damping.clone());
        let ground = Ground::new(0.0, vec![layer], below).unwrap();
        for degrees in [0.0f64, 30.0, 60.0] {
            let wave = layered(WaveKind::SH, degrees, ground.clone(), ricker());
            let p = degrees.to_radians().sin() / below.s_speed();
            for i in 1..=200 {
                let frequency = 0.1 * f64::from(i);
                let w = 2.0 * PI * frequency;
                let mut modulus = Complex::new(soil.shear(), 0.0);
                if damping != LayerDamping::None {
                    let sum = mechanisms.iter().map(|m| {
                        let ratio = Complex::new(0.0, frequency / m.frequency);
                        ratio / (ratio + 1.0) * m.weight
                    });
                    modulus *= (sum.sum::<Complex>() + 1.0) / (1.04 * 1.04);
                }
                let s = (Complex::new(soil.density, 0.0) / modulus - p * p).sqrt();
                let s = if s.im > 0.0 { -s } else { s };
                let of_rock = below.shear() * degrees.to_radians().cos() / below.s_speed();
                let (k, a) = (s * (w * 20.0), modulus * s / of_rock);
                let expected =
                    Complex::new(2.0, 0.0) / (k.cos() + Complex::new(0.0, 1.0) * a * k.sin());
                let found = wave.transfer(0.0, frequency).unwrap()[1];
                worst = worst.max((found - expected).norm() / expected.norm());
            }
        }
    }
    println!("figure wavefield.layered_sh_transfer {worst:e}");
    assert!(worst < 1e-10, "{worst:e}");
}

/// Transfer functions of two layers agree with those of an independent solution to 1e-8.
#[test]
fn transfer_functions_are_those_of_an_independent_solution() {
    let table = include_str!("data/transfer_two_layer.csv");
    let mut rows = table
        .lines()
        .filter(|line| !line.starts_with("# ") || line.starts_with("# f"));
    let names: Vec<&str> = rows
        .next()
        .unwrap()
        .trim_start_matches("# ")
        .split(',')
        .collect();
    let mut waves = BTreeMap::new();
    let (mut worst, mut count) = (0.0f64, 0);
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
        for (column, pair) in names[1..].chunks(2).zip(numbers[1..].chunks(2)) {
            let words: Vec<&str> = column[0].split(' ').collect();
            let (kind, degrees) = match words[2] {
                "SH0" => (WaveKind::SH, 0.0),
                "SH30" => (WaveKind::SH, 30.0),
                "SV15" => (WaveKind::SV, 15.0),
                _ => (WaveKind::P, 30.0),
            };
            let height: f64 = words[3].trim_start_matches('z').parse().unwrap();
            let axis = ["ux", "uy", "uz"]
                .iter()
                .position(|a| *a == words[1])
                .unwrap();
            let wave = waves
                .entry(words[2])
                .or_insert_with(|| layered(kind, degrees, two(), ricker()));
            let found = wave.transfer(height, numbers[0]).unwrap()[axis];
            worst = worst.max((found - Complex::new(pair[0], pair[1])).norm());
            count += 1;
        }
    }
    println!("figure wavefield.layered_transfer {worst:e}");
    assert!(count > 100 && worst < 1e-8, "{worst:e}");
}

/// The surface is free of traction to 1e-4 of the peak stress; at interfaces normal and shear traction
/// have no jump, to the bit, while the stress along them jumps, as the media demand.
#[test]
fn traction_is_continuous_and_vanishes_at_the_surface() {
    let ground = two();
    for (kind, degrees) in [
        (WaveKind::SV, 15.0),
        (WaveKind::P, 30.0),
        (WaveKind::SV, 50.0),
        (WaveKind::SH, 30.0),
    ] {
        let wave = layered(kind, degrees, ground.clone(), ricker());
        let media = [
            ground.layers()[0].medium,
            ground.layers()[0].medium,
            ground.layers()[1].medium,
        ];
        let points = [0.0, -20.0, -20.0].map(|z| Vec3::new(3.0, 4.0, z));
        let sampler = wave.prepare_in(&points, &media).unwrap();
        let (mut traction, mut stress, mut jump) = (0.0f64, 0.0f64, 0.0f64);
        for i in 0..600 {
            let mut motion = [FieldMotion::default(); 3];
            sampler.add_motion(0.005 * f64::from(i), &mut motion);
            traction = traction.max(motion[0].stress.traction(&Vec3::z()).amax());
            stress = stress.max(size(&motion[1].stress.0));
            let [_, above, below] = motion;
            assert_eq!(
                above.stress.traction(&Vec3::z()),
                below.stress.traction(&Vec3::z())
            );
            jump = jump.max((above.stress.0[0] - below.stress.0[0]).abs());
            jump = jump.max((above.stress.0[3] - below.stress.0[3]).abs());
        }
        println!(
            "{kind} {degrees}: traction {:e}, jump {:e}",
            traction / stress,
            jump / stress
        );
        assert!(
            traction <= 1e-4 * stress,
            "{kind} {degrees}: {:e}",
            traction / stress
        );
        assert!(jump > 0.01 * stress);
    }
}

/// A soft layer of impedance ratio 20 rings down as the sum of its reflections, to 1e-5 of the peak.
#[test]
fn a_soft_layer_rings_down() {
    let (soil, below) = (medium(1800.0, 200.0, 500.0), medium(2400.0, 3000.0, 6000.0));
    let ground = Ground::new(0.0, vec![GroundLayer::new(-20.0, soil)], below).unwrap();
    let wave = layered(WaveKind::SH, 0.0, ground, ricker());
    let signal = ricker();
    let (soft, stiff) = (
        soil.density * soil.s_speed(),
        below.density * below.s_speed(),
    );
    assert!((stiff / soft - 20.0).abs() < 1e-9);
    let (passed, turned) = (
        2.0 * stiff / (soft + stiff),
        (soft - stiff) / (soft + stiff),
    );
    let sampler = wave.prepare(&[Vec3::zeros()]).unwrap();
    let (mut worst, mut peak) = (0.0f64, 0.0f64);
    for i in 0..6000 {
        let time = 0.00713 * f64::from(i);
        let echoes = (0..300).map(|n| {
            let motion = signal.motion(time - 0.1 - 0.2 * f64::from(n));
            2.0 * passed * turned.powi(n) * motion.displacement
        });
        let expected: f64 = echoes.sum();
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(time, &mut motion);
        worst = worst.max((motion[0].displacement.y - expected).abs());
        peak = peak.max(expected.abs());
    }
    println!(
        "figure wavefield.layered_ring_down {:e}; {:?}",
        worst / peak,
        wave.report()
    );
    assert!(worst < 1e-5 * peak, "{:e}", worst / peak);
}

/// With waves exactly along a layer the motion is finite and equal to that at slownesses beside it, off by
/// 1e-9, to 1e-6. At the critical angle of the half-space the coefficients go with the root of the distance:
/// the motion is equal to that at 1e-14 beside it to 1e-6.
#[test]
fn critical_and_grazing_slownesses_are_like_their_neighbours() {
    let ground = two();
    let rock = ground.half_space();
    let layers = vec![
        GroundLayer::new(-20.0, medium(2300.0, 1300.0, 2600.0)),
        GroundLayer::new(-40.0, medium(2000.0, 400.0, 1000.0)),
    ];
    let crust = Ground::new(0.0, layers, rock).unwrap();
    let differs = |ground: &Ground, kind: WaveKind, p: f64, by: f64| {
        let at = |p: f64| {
            let degrees = (p * kind.speed(&rock)).asin().to_degrees();
            let wave = layered(kind, degrees, ground.clone(), ricker());
            let mut found = Vec::new();
            for frequency in [0.3, 2.0, 11.0] {
                for height in [0.0, -10.0, -20.0, -40.0, -60.0] {
                    found.extend(wave.transfer(height, frequency).unwrap());
                }
            }
            found
        };
        let exact = at(p);
        assert!(
            exact
                .iter()
                .all(|value| value.norm().is_finite() && value.norm() < 100.0)
        );
        let beside = [at(p * (1.0 - by)), at(p * (1.0 + by))];
        let pairs = beside.iter().flat_map(|beside| exact.iter().zip(beside));
        pairs.fold(0.0f64, |worst, (a, b)| worst.max((a - b).norm()))
    };
    for (kind, speed) in [
        (WaveKind::SV, 2600.0),
        (WaveKind::SV, 1300.0),
        (WaveKind::SH, 1300.0),
        (WaveKind::P, 2600.0),
    ] {
        let worst = differs(&crust, kind, 1.0 / speed, 1e-9);
        println!("figure wavefield.layered_grazing_{kind}_{speed} {worst:e}");
        assert!(worst < 1e-6, "{kind} {speed}: {worst:e}");
    }
    let worst = differs(&ground, WaveKind::SV, 1.0 / rock.p_speed(), 1e-14);
    println!("figure wavefield.layered_critical {worst:e}");
    assert!(worst < 1e-6, "{worst:e}");
}

/// A causal field is at rest until the wave arrives, and a permanent displacement stays, enlarged by the
/// surface of the half-space alone.
#[test]
fn a_permanent_displacement_stays() {
    struct Ramp;
    impl Signal for Ramp {
        fn motion(&self, time: f64) -> powerhouse_wavefield::SignalMotion {
            let x = (time / 0.5).clamp(0.0, 1.0);
            let inside = if x < 1.0 { 1.0 } else { 0.0 };
            powerhouse_wavefield::SignalMotion {
                displacement: x * x * x * (10.0 + x * (6.0 * x - 15.0)),
                velocity: 60.0 * x * x * (1.0 - x) * (1.0 - x),
                acceleration: inside * 240.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
            }
        }
        fn support(&self) -> powerhouse_wavefield::SignalSupport {
            powerhouse_wavefield::SignalSupport {
                start: 0.0,
                end: 0.5,
                step: 0.0025,
            }
        }
    }
    let wave = layered(WaveKind::SV, 15.0, two(), Arc::new(Ramp));
    let incidence = Angle::from_degrees(15.0);
    let surface = SurfaceReflection::new(WaveKind::SV, incidence, &two().half_space()).unwrap();
    let points = [0.0, -30.0, -80.0].map(|z| Vec3::new(0.0, 0.0, z));
    let sampler = wave.prepare(&points).unwrap();
    for (time, of) in [(-0.2, 0.0), (30.0, 1.0), (1e4, 1.0)] {
        let mut motion = [FieldMotion::default(); 3];
        sampler.add_motion(time, &mut motion);
        for motion in motion {
            let expected = surface.surface_motion()[0].re * of;
            assert!(
                (motion.displacement.x - expected).abs() < 2e-6,
                "{time}: {motion:?}"
            );
            assert!(size(&motion.stress.0) < 1e4 && motion.velocity.norm() < 1e-4);
        }
    }
    let refused = LayeredWave::new(
        LayeredWaveParameters {
            incidence: Angle::from_degrees(40.0),
            ..LayeredWaveParameters::vertical(WaveKind::SV, two(), -80.0)
        },
        Arc::new(Ramp),
    );
    assert!(matches!(
        refused,
        Err(WaveError::PermanentDisplacement { .. })
    ));
}

/// A record of the layered surface gives the incident wave of an independent solution to 2e-3 of its peak, and
/// its field moves the surface as recorded; the vertical component, which hardly moves at some
/// frequencies, is refused.
#[test]
fn a_surface_record_becomes_the_incident_wave() {
    let ricker: Arc<dyn Signal> =
        Arc::new(Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 3.0).unwrap());
    let of = |component: SurfaceComponent, lowest: f64| {
        let mut parameters = LayeredWaveParameters::vertical(WaveKind::SV, two(), lowest);
        parameters.incidence = Angle::from_degrees(15.0);
        parameters.convention = InputConvention::SurfaceComponent(component);
        LayeredWave::new(parameters, ricker.clone())
    };
    assert!(matches!(
        of(SurfaceComponent::Z, -60.0),
        Err(WaveError::WeakComponent { .. })
    ));
    let wave = of(SurfaceComponent::X, -60.0).unwrap();
    println!("{:?}", wave.conversion());
    let sampler = wave.prepare(&[Vec3::zeros()]).unwrap();
    let mut worst = 0.0f64;
    for i in 0..600 {
        let time = 0.01 * f64::from(i);
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(time, &mut motion);
        worst = worst.max((motion[0].displacement.x - ricker.motion(time).displacement).abs());
    }
    println!("figure wavefield.layered_surface_record {worst:e}");
    assert!(worst < 1e-4, "{worst:e}");
    // A field that is known for a short time from the start of the record has the same motion in it.
    let mut short = LayeredWaveParameters::vertical(WaveKind::SV, two(), -60.0);
    short.incidence = Angle::from_degrees(15.0);
    short.convention = InputConvention::SurfaceComponent(SurfaceComponent::X);
    short.until = Some(1.0);
    let short = LayeredWave::new(short, ricker.clone()).unwrap();
    let sampler = short.prepare(&[Vec3::zeros()]).unwrap();
    let start = ricker.support().start;
    for i in 0..=100 {
        let time = start + 0.01 * f64::from(i);
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(time, &mut motion);
        let off = motion[0].displacement.x - ricker.motion(time).displacement;
        assert!(off.abs() < 1e-4, "{time}: {off:e}");
    }
    // The incident wave itself: in the half-space far below the surface it comes first.
    let depth = 4000.0;
    let deep = of(SurfaceComponent::X, -40.0 - depth).unwrap();
    let sampler = deep.prepare(&[Vec3::new(0.0, 0.0, -40.0 - depth)]).unwrap();
    let (sine, cosine) = 15f64.to_radians().sin_cos();
    let earlier = cosine * depth / two().half_space().s_speed();
    let (mut worst, mut peak) = (0.0f64, 0.0f64);
    let table = include_str!("data/deconvolution_two_layer_SV15_ux.csv");
    for row in table.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(numbers[0] - earlier, &mut motion);
        let u = motion[0].displacement;
        worst = worst.max((u.x * cosine - u.z * sine - numbers[1]).abs());
        peak = peak.max(numbers[1].abs());
    }
    println!("figure wavefield.layered_deconvolution {:e}", worst / peak);
    assert!(worst < 2e-3 * peak, "{:e}", worst / peak);
}

/// The time zero of the signal arrives at a point of the half-space with the incident wave, and at one in the layers when it
/// arrives at the top of the half-space below it.
#[test]
fn arrivals_in_layers_are_those_at_the_half_space() {
    for (kind, speed, degrees, azimuth) in [
        (WaveKind::P, 2000.0, 0.0_f64, 0.0_f64),
        (WaveKind::SV, 900.0, 25.0, 40.0),
        (WaveKind::SH, 900.0, 60.0, -120.0),
    ] {
        let (across, up) = degrees.to_radians().sin_cos();
        let (y, x) = azimuth.to_radians().sin_cos();
        let direction = Vec3::new(across * x, across * y, up);
        let limited = |point: Vec3| Vec3::new(point.x, point.y, point.z.min(-40.0));
        for reference in [-75.0, -40.0, -8.0].map(|z| Vec3::new(12.0, -7.0, z)) {
            let mut parameters = LayeredWaveParameters::vertical(kind, two(), -100.0);
            parameters.incidence = Angle::from_degrees(degrees);
            parameters.azimuth = Angle::from_degrees(azimuth);
            parameters.arrival = 0.7;
            parameters.reference = reference;
            for point in [-90.0, -40.0, -25.0, 0.0].map(|z| Vec3::new(-30.0, 55.0, z)) {
                let path = direction.dot(&(limited(point) - limited(reference)));
                let off = parameters.arrival_at(&point) - (0.7 + path / speed);
                assert!(off.abs() < 1e-9, "{kind} {reference} {point}: {off:e}");
            }
        }
    }
}

/// A field that begins before its wave is delayed until it starts at rest.
#[test]
fn a_layered_field_can_start_at_rest() {
    let points = [0.0, -20.0, -80.0].map(|z| Vec3::new(0.0, 0.0, z));
    let wave = layered(WaveKind::SV, 40.0, two(), ricker());
    let limits = QuietStartLimits::default();
    assert!(wave.start_level(&points, 0.3).unwrap().largest() > limits.threshold);
    let (quiet, start) = wave.with_quiet_start(&points, 0.3, &limits).unwrap();
    assert!(start.padding > 0.0 && start.level.largest() < limits.threshold);
    assert!(quiet.start_level(&points, 0.3).unwrap().largest() < limits.threshold);
}

/// Layers out of order, thin as a hair or softer than any soil are refused, each with its depth; so are
/// points outside, media of other layers, records that cannot be converted and layers that ring on.
#[test]
fn what_cannot_be_is_refused() {
    let (soil, below) = (medium(1800.0, 200.0, 500.0), medium(2300.0, 900.0, 2000.0));
    let ground = |layers: Vec<GroundLayer>| Ground::new(2.0, layers, below);
    let defect = |layers: Vec<GroundLayer>| match ground(layers).unwrap_err() {
        WaveError::Layer {
            index,
            depth,
            defect,
        } => (index, depth, defect),
        other => panic!("{other}"),
    };
    let (index, depth, found) = defect(vec![
        GroundLayer::new(-20.0, soil),
        GroundLayer::new(-10.0, soil),
    ]);
    assert_eq!((index, depth), (1, 22.0));
    assert!(matches!(
        found,
        LayerDefect::NotBelow {
            top: -20.0,
            bottom: -10.0
        }
    ));
    let (index, _, found) = defect(vec![GroundLayer::new(1.9999, soil)]);
    assert!(index == 0 && matches!(found, LayerDefect::Thin { .. }));
    let air = ElasticMedium::new(1.4e5, 0.0, 1.2).unwrap();
    let (_, depth, found) = defect(vec![
        GroundLayer::new(-20.0, soil),
        GroundLayer::new(-30.0, air),
    ]);
    assert!(
        depth == 22.0
            && matches!(
                found,
                LayerDefect::Soft {
                    quantity: "density",
                    ..
                }
            )
    );
    let broken = LayerDamping::ConstantQuality {
        quality: 0.0,
        reference: 3.0,
    };
    let (.., found) = defect(vec![GroundLayer::new(-20.0, soil).with_damping(broken)]);
    assert!(matches!(found, LayerDefect::Parameter(_)));
    assert!(ground(vec![GroundLayer::new(f64::NAN, soil)]).is_err());

    let parameters = LayeredWaveParameters::vertical(WaveKind::SH, two(), -60.0);
    let new = |parameters: LayeredWaveParameters| LayeredWave::new(parameters, ricker());
    let wave = new(parameters.clone()).unwrap();
    let at = |z: f64| Vec3::new(0.0, 0.0, z);
    let told = |error: powerhouse_model::ModelError| error.to_string();
    assert!(told(wave.prepare(&[at(1.0)]).err().unwrap()).contains("above the free surface"));
    assert!(told(wave.prepare(&[at(-61.0)]).err().unwrap()).contains("below the lowest"));
    let media = [two().half_space()];
    assert!(told(wave.prepare_in(&[at(-20.0)], &media).err().unwrap()).contains("20 m deep"));
    assert!(wave.incident_part().is_none());
    let mut surface = parameters.clone();
    surface.convention = InputConvention::SurfaceComponent(SurfaceComponent::X);
    assert!(matches!(new(surface), Err(WaveError::WeakComponent { .. })));
    let mut grazing = parameters.clone();
    grazing.incidence = Angle::from_degrees(90.0);
    assert!(matches!(
        new(grazing),
        Err(WaveError::GrazingIncidence { .. })
    ));
    let mut endless = parameters;
    let rigid = medium(3000.0, 1e6, 2e6);
    endless.ground = Ground::new(0.0, vec![GroundLayer::new(-20.0, soil)], rigid).unwrap();
    assert!(matches!(
        new(endless),
        Err(WaveError::TooManySamples { .. })
    ));
}
