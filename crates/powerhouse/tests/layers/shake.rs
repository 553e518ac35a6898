//! The equivalent linear method against an own computation of the usual form (SHAKE): a column of complex moduli `G (1 + 2 i r)` that
//! are the same at all frequencies, by transfer matrices from the surface down.

use std::f64::consts::PI;
use std::path::PathBuf;

use nalgebra::Complex;
use powerhouse::model::{FieldMotion, IncidentField, Vec3};
use powerhouse::{EquivalentLayer, Scene};

use super::column::{PERIODIC, column};
use super::equivalent_linear::figures;
use super::read;

type Number = Complex<f64>;

/// Strain, modulus over that of small strain, damping ratio.
type Curve = &'static [[f64; 3]];

const CLAY: Curve = &[
    [1e-6, 1.0, 0.01],
    [1e-5, 0.97, 0.015],
    [1e-4, 0.8, 0.035],
    [1e-3, 0.36, 0.11],
    [1e-2, 0.1, 0.18],
];
const GRAVEL: Curve = &[
    [1e-6, 1.0, 0.008],
    [1e-5, 0.96, 0.014],
    [1e-4, 0.7, 0.05],
    [1e-3, 0.3, 0.12],
    [1e-2, 0.12, 0.18],
];

/// Layer of the column: thickness (m), density (kg/m3), shear modulus at small strain (Pa), curve.
struct Soil {
    thickness: f64,
    density: f64,
    shear: f64,
    curve: Curve,
}

fn soils() -> [Soil; 2] {
    let shear = |young: f64| young / 2.8;
    [(1800.0, 0.2e9, CLAY), (2000.0, 0.9e9, GRAVEL)].map(|(density, young, curve)| Soil {
        thickness: 20.0,
        density,
        shear: shear(young),
        curve,
    })
}

/// Modulus and damping at a strain, by its logarithm.
fn at(curve: Curve, strain: f64) -> [f64; 2] {
    let after = curve.iter().position(|row| row[0] > strain);
    match after {
        Some(0) => [curve[0][1], curve[0][2]],
        None => [curve[curve.len() - 1][1], curve[curve.len() - 1][2]],
        Some(after) => {
            let (a, b) = (curve[after - 1], curve[after]);
            let share = (strain / a[0]).ln() / (b[0] / a[0]).ln();
            [1, 2].map(|k| a[k] + share * (b[k] - a[k]))
        }
    }
}

/// Transform of a power of two of samples; `sign` -1 forward, 1 back without its scale.
fn transform(samples: &[Number], sign: f64) -> Vec<Number> {
    let count = samples.len();
    if count == 1 {
        return samples.to_vec();
    }
    let every_second = |from: usize| -> Vec<Number> {
        let part: Vec<Number> = samples.iter().skip(from).step_by(2).copied().collect();
        transform(&part, sign)
    };
    let (even, odd) = (every_second(0), every_second(1));
    let mut all = vec![Number::default(); count];
    for (k, (even, odd)) in even.into_iter().zip(odd).enumerate() {
        let angle = sign * 2.0 * PI * k as f64 / count as f64;
        let turned = odd * Number::new(angle.cos(), angle.sin());
        all[k] = even + turned;
        all[k + count / 2] = even - turned;
    }
    all
}

/// Largest value of a motion whose spectrum is known up to its Nyquist frequency.
fn largest(half: &[Number], count: usize) -> f64 {
    let mut all = half.to_vec();
    all.resize(count, Number::default());
    for bin in 1..count / 2 {
        all[count - bin] = half[bin].conj();
    }
    let back = transform(&all, 1.0);
    back.iter().fold(0.0, |most, value| {
        f64::max(most, value.re.abs() / count as f64)
    })
}

/// Effective strains of the layers, and the peak acceleration of the surface, under the acceleration of an outcrop of the rock.
fn shake(acceleration: &[f64], step: f64) -> ([f64; 2], f64) {
    const COUNT: usize = 8192;
    let rock = (2300.0, 5e9 / (2.0 * 1.37));
    let soils = soils();
    let mut samples: Vec<Number> = acceleration.iter().map(|a| Number::new(*a, 0.0)).collect();
    samples.resize(COUNT, Number::default());
    let spectrum = transform(&samples, -1.0);
    let (mut strains, mut peak) = ([0.0; 2], 0.0);
    for _ in 0..40 {
        let moduli: [Number; 2] = core::array::from_fn(|k| {
            let [modulus, ratio] = at(soils[k].curve, strains[k]);
            Number::new(1.0, 2.0 * ratio) * modulus * soils[k].shear
        });
        let mut of_strain = [(); 2].map(|()| vec![Number::default(); COUNT / 2 + 1]);
        let mut of_surface = vec![Number::default(); COUNT / 2 + 1];
        for bin in 1..COUNT / 2 {
            let w = 2.0 * PI * bin as f64 / (COUNT as f64 * step);
            // Amplitudes of the upgoing and the downgoing wave at the top of a layer.
            let one = Number::new(1.0, 0.0);
            let (mut up, mut down) = (one, one);
            let mut strain = [Number::default(); 2];
            for (k, soil) in soils.iter().enumerate() {
                let number = Number::new(0.0, w) / (moduli[k] / soil.density).sqrt();
                let after = |distance: f64| [(number * distance).exp(), (number * -distance).exp()];
                let [a, b] = after(0.5 * soil.thickness);
                strain[k] = number * (up * a - down * b);
                let [a, b] = after(soil.thickness);
                let (above, below) = (up * a, down * b);
                let impedance = (moduli[k] * soil.density).sqrt();
                let next = match soils.get(k + 1) {
                    Some(next) => (moduli[k + 1] * next.density).sqrt(),
                    None => Number::new(f64::sqrt(rock.0 * rock.1), 0.0),
                };
                let ratio = impedance / next;
                up = (above * (one + ratio) + below * (one - ratio)) * 0.5;
                down = (above * (one - ratio) + below * (one + ratio)) * 0.5;
            }
            // The outcrop moves by twice the upgoing wave of the rock.
            let outcrop = spectrum[bin] / (up * 2.0);
            of_surface[bin] = outcrop * 2.0;
            for k in 0..2 {
                of_strain[k][bin] = strain[k] * outcrop / (-w * w);
            }
        }
        strains = of_strain.map(|half| 0.65 * largest(&half, COUNT));
        peak = largest(&of_surface, COUNT);
    }
    (strains, peak)
}

/// Largest acceleration of the field of a scene at the surface, from differences of its velocity over 5 ms.
fn surface_peak(scene: &Scene, axis: usize) -> f64 {
    const STEP: f64 = 0.005;
    let sampler = scene.layered_waves()[0]
        .prepare(&[Vec3::new(0.0, 2.0, 0.0)])
        .unwrap();
    let velocity = |i: i32| {
        let mut motion = [FieldMotion::default()];
        sampler.add_motion(STEP * f64::from(i), &mut motion);
        motion[0].velocity[axis]
    };
    (0..3000)
        .map(|i| (velocity(i + 1) - velocity(i)).abs() / STEP)
        .fold(0.0, f64::max)
}

/// Effective strains are within 4 % of those of the usual method up to 0.3 g on the outcrop, modulus and damping are those of the
/// curves at them, and the ground of the run, whose moduli rise with frequency, has strains within 20 % and a peak
/// acceleration of the surface within 20 %.
#[test]
fn strains_are_those_of_the_usual_method() {
    let keys = |curve: Curve| {
        let column = |k: usize| curve.iter().map(|row| row[k]).collect::<Vec<f64>>();
        format!(
            "strain_curves = {{ kind = \"points\", strain = {:?}, modulus = {:?}, damping_ratio = {:?} }}",
            column(0),
            column(1),
            column(2)
        )
    };
    let clay = format!("bottom = -20\n{}\n#", keys(CLAY));
    let gravel = format!("bottom = -40\n{}\n", keys(GRAVEL));
    let strict =
        "duration = 14\n\n[ground]\nequivalent_linear = { tolerance = 0.002, iterations = 60 }\n";
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let file = file.join("../../data/records/el_centro_1940_ns.csv");
    for (peak, kind, axis) in [(0.05, "sv", 0), (0.15, "sh", 1), (0.3, "sv", 0)] {
        let wave = format!(
            "[[record]]\nname = \"r\"\nfile = {file:?}\nunits = \"m/s2\"\ncut = [0, 12]\nbaseline = {{ kind = \"velocity-polynomial\", order = 5 }}\nconvention = \"outcrop\"\npeak = {}\n[[wave]]\nkind = \"{kind}\"\nincidence = 0\nrecord = \"r\"\n",
            9.81 * peak
        );
        let others = [
            ("bottom = -20 ", clay.as_str()),
            ("bottom = -40\n", gravel.as_str()),
            ("duration = 3\n", strict),
        ];
        let scene = read(&column(&wave, PERIODIC, &others)).unwrap();
        let (layers, ..) = figures(&scene);
        if peak == 0.05 {
            // A run that ends before the record shakes has the same ground.
            let text =
                column(&wave, PERIODIC, &others).replacen("duration = 14", "duration = 0.1", 1);
            let (of_short, ..) = figures(&read(&text).unwrap());
            for (short, whole) in of_short.iter().zip(&layers) {
                assert!(
                    (short.strain / whole.strain - 1.0).abs() < 0.01,
                    "{short:?}"
                );
            }
        }
        let record = &scene.records()["r"];
        let (strains, acceleration) = shake(&record.acceleration(), record.step());
        let in_run = surface_peak(&scene, axis);
        println!(
            "figure shake.surface_{peak} {:.3} of {acceleration:.3} m/s2",
            in_run / acceleration
        );
        assert!(
            (in_run / acceleration - 1.0).abs() < 0.2,
            "{in_run} {acceleration}"
        );
        for ((layer, strain), curve) in layers.iter().zip(strains).zip([CLAY, GRAVEL]) {
            let EquivalentLayer {
                strain: found,
                in_run,
                frequency,
                ..
            } = layer;
            println!(
                "figure shake.strain_{peak}_{} {:.4} of {strain:.3e}, in the run {:.4}, {frequency:.3} Hz",
                layer.material,
                found / strain,
                in_run / strain
            );
            assert!((found / strain - 1.0).abs() < 0.04, "{layer:?} {strain}");
            assert!((in_run / strain - 1.0).abs() < 0.2, "{layer:?} {strain}");
            let [modulus, damping] = at(curve, *found);
            assert!((layer.modulus / modulus - 1.0).abs() < 0.0021, "{layer:?}");
            assert!((layer.damping / damping - 1.0).abs() < 0.0021, "{layer:?}");
        }
    }
}
