//! Motions at a depth of layered ground, from which the incident wave is found again.

use powerhouse_model::{ElasticMedium, FieldMotion, FieldSampler, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, Ground, GroundLayer, InputConvention, LayerDamping, LayeredWave, LayeredWaveParameters,
    Ricker, RickerQuantity, Signal, SignalMotion, SignalSupport, SurfaceComponent, WaveKind,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

/// Soil of 128 m on rock, damped with a quality factor.
fn ground(quality: Option<f64>) -> Ground {
    let damping = match quality {
        None => LayerDamping::None,
        Some(quality) => LayerDamping::ConstantQuality {
            quality,
            reference: 3.0,
        },
    };
    let soil = GroundLayer::new(-128.0, medium(1800.0, 224.0, 419.0)).with_damping(damping);
    Ground::new(0.0, vec![soil], medium(2000.0, 448.0, 838.0)).unwrap()
}

const RECORD: f64 = 12.0;
/// Time (s) from which the record is faded out.
const WHOLE: f64 = 10.0;

/// Component of the motion at a point as a record, known from 0 to 12 s and faded out over its last two seconds.
struct Recorded {
    sampler: Box<dyn FieldSampler>,
    component: usize,
}

impl Recorded {
    fn at(&self, time: f64) -> [f64; 2] {
        let mut motion = [FieldMotion::default()];
        self.sampler.add_motion(time, &mut motion);
        let [motion] = motion;
        [
            motion.displacement[self.component],
            motion.velocity[self.component],
        ]
    }
}

impl Signal for Recorded {
    fn motion(&self, time: f64) -> SignalMotion {
        const SMALL: f64 = 1e-3;
        if !(0.0..RECORD).contains(&time) {
            return SignalMotion::default();
        }
        let [u, v] = self.at(time);
        let a = (self.at(time + SMALL)[1] - self.at(time - SMALL)[1]) / (2.0 * SMALL);
        let rate = 1.0 / (RECORD - WHOLE);
        let x = ((time - WHOLE) * rate).max(0.0);
        let w = 1.0 - x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let w1 = -30.0 * rate * x * x * (1.0 - x) * (1.0 - x);
        let w2 = -60.0 * rate * rate * x * (1.0 - x) * (1.0 - 2.0 * x);
        SignalMotion {
            displacement: u * w,
            velocity: v * w + u * w1,
            acceleration: a * w + 2.0 * v * w1 + u * w2,
        }
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: RECORD,
            step: 0.005,
        }
    }
}

fn parameters(kind: WaveKind, degrees: f64, ground: &Ground) -> LayeredWaveParameters {
    let mut parameters = LayeredWaveParameters::vertical(kind, ground.clone(), -260.0);
    parameters.incidence = Angle::from_degrees(degrees);
    parameters.until = Some(RECORD);
    parameters
}

/// Relative L2 difference in velocity of two fields at a height up to a time, of one component.
fn difference(of: [&LayeredWave; 2], height: f64, component: usize, end: f64) -> f64 {
    let samplers = of.map(|wave| wave.prepare(&[Vec3::new(0.0, 0.0, height)]).unwrap());
    let (mut off, mut all) = (0.0, 0.0);
    for i in -200..(200.0 * end) as i32 {
        let [given, found] = samplers.each_ref().map(|sampler| {
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(0.005 * f64::from(i), &mut motion);
            motion[0].velocity[component]
        });
        off += (given - found).powi(2);
        all += given * given;
    }
    assert!(all > 0.0);
    (off / all).sqrt()
}

/// A wave that was chosen is found again from the motion that it makes within layers: the motion of the surface, of the interface
/// and of a point below it to 1 % until the record is faded out, elastic and damped, also at nodes of standing waves; the same
/// wave arrives at the same time, and the stated misfit of the record is not above the error. The stated least
/// transfer is that of the motion itself, small at a node.
#[test]
fn a_motion_within_layers_gives_its_wave() {
    use SurfaceComponent::{X, Y, Z};
    let mut worst = 0.0_f64;
    for (kind, degrees, component) in [
        (WaveKind::SV, 0.0, X),
        (WaveKind::SH, 0.0, Y),
        (WaveKind::SH, 25.0, Y),
        (WaveKind::P, 0.0, Z),
        (WaveKind::SV, 12.0, X),
    ] {
        for quality in [None, Some(25.0), Some(10.0)] {
            let ground = ground(quality);
            for depth in [64.0, 128.0, 200.0] {
                // The wave passes the top of the half-space after 0.9 s.
                let pulse = Ricker::new(RickerQuantity::Displacement, 0.01, 1.5, 1.8).unwrap();
                let given = LayeredWave::new(parameters(kind, degrees, &ground), Arc::new(pulse));
                let given = given.unwrap();
                let axis = component as usize;
                let record = Recorded {
                    sampler: given.prepare(&[Vec3::new(0.0, 0.0, -depth)]).unwrap(),
                    component: axis,
                };
                let mut parameters = parameters(kind, degrees, &ground);
                parameters.convention = InputConvention::Within {
                    depth,
                    component,
                    regularisation: None,
                };
                let found = LayeredWave::new(parameters, Arc::new(record)).unwrap();
                let report = found.conversion().within.unwrap();
                for height in [0.0, -64.0, -128.0, -200.0] {
                    // What the fading changes reaches the surface a second later, and a second before below it.
                    let error = difference([&given, &found], height, axis, WHOLE - 1.5);
                    worst = worst.max(error);
                    assert!(
                        error < 0.01,
                        "{kind} {degrees} {quality:?}: record at {depth} m, motion at {height} m: {error} {report:?}"
                    );
                }
                assert!(report.misfit < 1e-3, "{report:?}");
                // Half way down the transfer function is `2 cos(w d / c)` near a node of standing waves. Frequencies count at
                // which the record has a hundredth of its peak: 0.06 is that of the wave, which there has a third of its own.
                // They are closer than those of a record twice as long.
                if kind != WaveKind::P && degrees == 0.0 && quality.is_none() && depth == 64.0 {
                    let most = 0.06 + 2.0 * (2.0 * PI * depth / 224.0) / (2.0 * RECORD);
                    assert!(report.least_transfer < most, "{most} {report:?}");
                }
            }
        }
    }
    println!("figure wavefield.within_layers {worst:e}");
}
