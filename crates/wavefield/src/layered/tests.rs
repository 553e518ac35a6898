use super::ground::{Ground, GroundLayer};
use super::stack::{Amplitudes, Stack};
use crate::{Complex, WaveKind};
use powerhouse_model::ElasticMedium;

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
            let state = |index: usize, depth: f64| {
                stack.state((index, depth), &stack.columns(index, w), &of[index], w)
            };
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
