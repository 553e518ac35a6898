use super::ground::{Ground, GroundLayer, LayerDamping, LayerMechanism};
use super::stack::{Amplitudes, Stack};
use super::states::spectra;
use super::{KnownLayeredWaves, LayeredWave, LayeredWaveParameters};
use crate::{Angle, Complex, Ricker, RickerQuantity, WaveKind};
use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use std::sync::Arc;

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

fn three() -> Ground {
    let layers = vec![
        GroundLayer::new(-12.0, medium(1800.0, 150.0, 400.0)),
        GroundLayer::new(-15.0, medium(2400.0, 1200.0, 2500.0)),
        GroundLayer::new(-60.0, medium(2000.0, 350.0, 900.0)),
    ];
    Ground::new(0.0, layers, medium(2300.0, 900.0, 2000.0)).unwrap()
}

fn amplitudes(stack: &Stack, frequency: f64) -> Vec<Amplitudes> {
    let zero = [Complex::new(0.0, 0.0); 2];
    let mut found = vec![
        Amplitudes {
            up: zero,
            down: zero
        };
        stack.count() + 1
    ];
    let frequency = Complex::new(2.0 * core::f64::consts::PI * frequency, 0.0);
    stack.amplitudes(frequency, &mut found);
    found
}

/// Elastic layers reflect all energy: the flux of the waves that go down in the half-space is that of the
/// incident wave, to 1e-10, at all angles and frequencies, past the critical angle too.
#[test]
fn elastic_layers_return_the_energy_flux() {
    let ground = three();
    let rock = ground.half_space();
    let mut worst = 0.0f64;
    for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
        for degrees in (0..=80).step_by(5) {
            let speed = kind.speed(&rock);
            let p = f64::from(degrees).to_radians().sin() / speed;
            let stack = Stack::new(&ground, kind, p);
            let columns = stack.columns(3, Complex::new(1.0, 0.0));
            for frequency in [0.01, 0.4, 1.0, 3.3, 17.0, 60.0] {
                let half = amplitudes(&stack, frequency)[3];
                // Flux of unit amplitude: rho c^2 times the vertical slowness.
                let speeds = match stack.order {
                    1 => [rock.s_speed(), 0.0],
                    _ => [rock.p_speed(), rock.s_speed()],
                };
                let flux = |k: usize| speeds[k] * speeds[k] * columns.slowness[k].re;
                let down: f64 = (0..stack.order)
                    .map(|k| flux(k) * half.down[k].norm_sqr())
                    .sum();
                worst = worst.max((down / flux(stack.incident) - 1.0).abs());
            }
        }
    }
    println!("figure wavefield.layered_flux {worst:e}");
    assert!(worst < 1e-10, "{worst:e}");
}

/// Traction and displacement are continuous at interfaces, and the surface is free of traction, to
/// 1e-10 of the largest, also where layers of many wavelengths are passed by waves that decay.
#[test]
fn states_are_continuous_at_all_thicknesses() {
    let ground = three();
    let mut worst = 0.0f64;
    for degrees in [0.0f64, 20.0, 40.0, 70.0] {
        for frequency in [1e-4, 1.0, 30.0, 1000.0] {
            let p = degrees.to_radians().sin() / ground.half_space().s_speed();
            let stack = Stack::new(&ground, WaveKind::SV, p);
            let w = Complex::new(2.0 * core::f64::consts::PI * frequency, 0.0);
            let of = amplitudes(&stack, frequency);
            let state = |index: usize, depth: f64| stack.state((index, depth), &of[index], w);
            let size = |state: &[Complex; 4]| {
                let traction = state[2].norm().max(state[3].norm()) / stack.scale;
                state[0].norm().max(state[1].norm()).max(traction)
            };
            let top = state(0, 0.0);
            let traction = top[2].norm().max(top[3].norm()) / stack.scale;
            worst = worst.max(traction / size(&state(3, 0.0)));
            for (index, thickness) in [12.0, 3.0, 45.0].into_iter().enumerate() {
                let (above, below) = (state(index, thickness), state(index + 1, 0.0));
                let jump: [Complex; 4] = core::array::from_fn(|k| above[k] - below[k]);
                worst = worst.max(size(&jump) / size(&state(3, 0.0)));
                assert!(size(&above).is_finite());
            }
        }
    }
    println!("figure wavefield.layered_continuity {worst:e}");
    assert!(worst < 1e-10, "{worst:e}");
}

/// States followed from frequency to frequency by products are those evaluated directly, to 1e-12 of the largest: of P, SV and
/// SH, steep, past the critical angles and of waves that decay in a layer, elastic and damped, in layers and in the half-space,
/// also over frequencies so far apart that no series holds.
#[test]
fn states_by_products_are_those_evaluated_directly() {
    let flat = LayerDamping::Flat {
        mechanisms: [0.6, 3.0, 15.0]
            .map(|frequency| LayerMechanism {
                frequency,
                weight: 0.12,
            })
            .to_vec(),
        velocity: 1.1,
    };
    let constant = LayerDamping::ConstantQuality {
        quality: 12.0,
        reference: 2.0,
    };
    let elastic = three();
    let damped = elastic.layers().iter().cloned();
    let damped = damped
        .zip([flat, LayerDamping::None, constant])
        .map(|(layer, damping)| layer.with_damping(damping));
    let damped = Ground::new(0.0, damped.collect(), three().half_space()).unwrap();
    let mut worst = 0.0f64;
    for (ground, growth, bin) in [
        (three(), 0.0, 0.02),
        (damped, 0.3, 0.11),
        (three(), 0.1, 7.0),
    ] {
        for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
            for degrees in [0.0f64, 25.0, 50.0, 85.0] {
                let p = degrees.to_radians().sin() / kind.speed(&ground.half_space());
                let stack = Stack::new(&ground, kind, p);
                let frequencies: Vec<Complex> = (0..500)
                    .map(|i| Complex::new((f64::from(i) + 1e-6) * bin, -growth))
                    .collect();
                let layers = ground.layers().len() + 1;
                let zero = [Complex::new(0.0, 0.0); 2];
                let none = Amplitudes {
                    up: zero,
                    down: zero,
                };
                let mut amplitudes = vec![none; layers * frequencies.len()];
                for (frequency, out) in frequencies.iter().zip(amplitudes.chunks_mut(layers)) {
                    stack.amplitudes(*frequency, out);
                }
                for (index, depths) in [
                    (0, [0.0, 3.1, 12.0]),
                    (1, [0.0, 1.7, 2.9]),
                    (2, [0.0, 20.3, 45.0]),
                    (3, [0.0, 40.0, 900.0]),
                ] {
                    let found = spectra(&stack, (index, &depths), &frequencies, &amplitudes);
                    let (mut missed, mut largest) = ([0.0f64; 4], [f64::MIN_POSITIVE; 4]);
                    for (depth, found) in depths.into_iter().zip(found) {
                        for (bin, frequency) in frequencies.iter().enumerate() {
                            let own = &amplitudes[bin * layers + index];
                            let state = stack.state((index, depth), own, *frequency);
                            for row in 0..2 * stack.order {
                                largest[row] = largest[row].max(state[row].norm());
                                missed[row] =
                                    missed[row].max((state[row] - found[row][bin]).norm());
                            }
                        }
                    }
                    for (missed, largest) in missed.into_iter().zip(largest) {
                        worst = worst.max(missed / largest);
                    }
                }
            }
        }
    }
    println!("figure wavefield.layered_products {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// The motion at a point is the same to the last bit, whatever heights were asked for before it or with it.
#[test]
fn tables_do_not_depend_on_others() {
    let damping = LayerDamping::ConstantQuality {
        quality: 25.0,
        reference: 3.0,
    };
    let elastic = three();
    let layers = elastic.layers().iter().cloned();
    let layers = layers.map(|layer| layer.with_damping(damping.clone()));
    let ground = Ground::new(0.0, layers.collect(), three().half_space()).unwrap();
    let points: Vec<Vec3> = (0..40)
        .map(|i| Vec3::new(f64::from(i), 0.0, -1.9 * f64::from(i)))
        .collect();
    for kind in [WaveKind::SV, WaveKind::SH] {
        let wave = || {
            let mut parameters = LayeredWaveParameters::vertical(kind, ground.clone(), -80.0);
            parameters.incidence = Angle::from_degrees(20.0);
            let ricker = Ricker::new(RickerQuantity::Displacement, 1.0, 4.0, 0.5).unwrap();
            LayeredWave::new(parameters, Arc::new(ricker)).unwrap()
        };
        let together = wave().prepare(&points).unwrap();
        let one_by_one = wave();
        let mut motion = vec![FieldMotion::default(); points.len()];
        for time in [0.3, 0.71, 1.5] {
            motion.fill(FieldMotion::default());
            together.add_motion(time, &mut motion);
            assert!(motion.iter().any(|m| m.velocity.norm() > 0.1));
            for (point, motion) in points.iter().zip(&motion).rev() {
                let mut alone = [FieldMotion::default()];
                one_by_one
                    .prepare(&[*point])
                    .unwrap()
                    .add_motion(time, &mut alone);
                assert_eq!(alone[0], *motion);
            }
        }
    }
}

/// A wave of the parameters and the signal of one that exists has its tables; one of another signal, angle or time has not, nor one
/// after all others are gone.
#[test]
fn equal_waves_share_their_tables() {
    let known = KnownLayeredWaves::default();
    let wave = |size: f64, degrees: f64, until: f64| {
        let mut parameters = LayeredWaveParameters::vertical(WaveKind::SV, three(), -80.0);
        parameters.incidence = Angle::from_degrees(degrees);
        parameters.until = Some(until);
        let ricker = Ricker::new(RickerQuantity::Displacement, size, 4.0, 0.5).unwrap();
        known.wave(parameters, Arc::new(ricker)).unwrap()
    };
    let first = wave(1.0, 20.0, 3.0);
    let point = [Vec3::new(0.0, 0.0, -5.0)];
    let mut motion = [[FieldMotion::default()]; 2];
    first
        .prepare(&point)
        .unwrap()
        .add_motion(0.5, &mut motion[0]);
    assert_eq!(first.report().tables.heights, 1);
    let second = wave(1.0, 20.0, 3.0);
    assert_eq!(second.report(), first.report());
    second
        .prepare(&point)
        .unwrap()
        .add_motion(0.5, &mut motion[1]);
    assert!(motion[0] == motion[1] && motion[0][0].velocity.norm() > 0.0);
    for other in [
        wave(2.0, 20.0, 3.0),
        wave(1.0, 21.0, 3.0),
        wave(1.0, 20.0, 4.0),
    ] {
        assert_eq!(other.report().tables.heights, 0);
    }
    drop((first, second));
    assert_eq!(wave(1.0, 20.0, 3.0).report().tables.heights, 0);
}
