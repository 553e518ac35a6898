//! Layered fields against the histories of an independent solution.

use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use powerhouse_wavefield::{
    Angle, Ground, GroundLayer, LayerDamping, LayeredWave, LayeredWaveParameters, Ricker,
    RickerQuantity, WaveKind,
};
use std::sync::Arc;

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

fn soft() -> ElasticMedium {
    medium(1800.0, 200.0, 500.0)
}

/// Two layers over rock; the file's header has the same numbers.
fn two(damped: bool) -> Ground {
    let stiffer = medium(2000.0, 400.0, 1000.0);
    let damping = |quality: f64| {
        if damped {
            LayerDamping::ConstantQuality {
                quality,
                reference: 3.0,
            }
        } else {
            LayerDamping::None
        }
    };
    let layers = vec![
        GroundLayer::new(-20.0, soft()).with_damping(damping(25.0)),
        GroundLayer::new(-40.0, stiffer).with_damping(damping(50.0)),
    ];
    Ground::new(0.0, layers, medium(2300.0, 900.0, 2000.0)).unwrap()
}

/// Column of a table: quantity, height and the layer, counted from 1, whose side is meant.
fn column(name: &str) -> (&str, f64, Option<usize>) {
    let (quantity, place) = name.split_once('@').unwrap();
    let mut words = place.split(' ');
    let height = words.next().unwrap().parse().unwrap();
    let layer = words.nth(1).map(|number| number.parse().unwrap());
    (quantity, height, layer)
}

fn value(motion: &FieldMotion, quantity: &str) -> f64 {
    let axis = |letter: &str| ["x", "y", "z"].iter().position(|axis| *axis == letter);
    match quantity.split_at(1) {
        ("u", letter) => motion.displacement[axis(letter).unwrap()],
        ("v", letter) => motion.velocity[axis(letter).unwrap()],
        (_, pair) => {
            let pairs = ["xx", "yy", "zz", "xy", "yz", "xz"];
            motion.stress.0[pairs.iter().position(|p| *p == pair).unwrap()]
        }
    }
}

/// Compares a field with a table: largest differences of displacement, velocity and stress over the
/// largest value of the same kind in the table.
fn compare(table: &str, kind: WaveKind, degrees: f64, ground: Ground, x: f64) -> [f64; 3] {
    let mut parameters = LayeredWaveParameters::vertical(kind, ground.clone(), -60.0);
    parameters.incidence = Angle::from_degrees(degrees);
    let ricker = Ricker::new(RickerQuantity::Displacement, 1.0, 3.0, 1.0).unwrap();
    let wave = LayeredWave::new(parameters, Arc::new(ricker)).unwrap();
    let mut rows = table
        .lines()
        .filter(|line| !line.starts_with("# ") || line.starts_with("# t,"));
    let names = rows.next().unwrap().trim_start_matches("# ").split(',');
    let columns: Vec<_> = names.skip(1).map(column).collect();
    let points: Vec<Vec3> = columns.iter().map(|c| Vec3::new(x, 0.0, c.1)).collect();
    let media: Vec<ElasticMedium> = (columns.iter())
        .map(|&(_, height, layer)| {
            let layers = ground.layers();
            match layer {
                Some(number) => layers
                    .get(number - 1)
                    .map_or(ground.half_space(), |l| l.medium),
                None => ground.medium_at(height),
            }
        })
        .collect();
    let sampler = wave.prepare_in(&points, &media).unwrap();
    let kind_of = |quantity: &str| match quantity.as_bytes()[0] {
        b'u' => 0,
        b'v' => 1,
        _ => 2,
    };
    let (mut worst, mut peak, mut count) = ([0.0f64; 3], [0.0f64; 3], 0);
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
        let mut motion = vec![FieldMotion::default(); points.len()];
        sampler.add_motion(numbers[0], &mut motion);
        for ((column, motion), expected) in columns.iter().zip(&motion).zip(&numbers[1..]) {
            let k = kind_of(column.0);
            peak[k] = peak[k].max(expected.abs());
            worst[k] = worst[k].max((value(motion, column.0) - expected).abs());
            count += 1;
        }
    }
    assert!(count > 500, "{count} values");
    let shares = core::array::from_fn(|k| worst[k] / peak[k]);
    println!("{kind} {degrees}: {shares:?}, {:?}", wave.report());
    shares
}

fn check(shares: [f64; 3], of_displacement: f64) {
    let limits = [of_displacement, 1e-3, 1e-3];
    assert!(
        shares
            .iter()
            .zip(limits)
            .all(|(share, limit)| *share <= limit),
        "{shares:?}"
    );
}

/// Displacement agrees with the independent solution to 1e-4 of its peak, velocity and stress to 1e-3, at
/// the surface, on both sides of interfaces, in layers and in the half-space, for P, SV and SH.
#[test]
fn the_field_is_that_of_an_independent_solution() {
    let sv = include_str!("data/two_layer_SV15.csv");
    check(compare(sv, WaveKind::SV, 15.0, two(false), 0.0), 1e-4);
    let p = include_str!("data/two_layer_P30.csv");
    check(compare(p, WaveKind::P, 30.0, two(false), 0.0), 1e-4);
    let sh = include_str!("data/two_layer_SH30.csv");
    check(compare(sh, WaveKind::SH, 30.0, two(false), 0.0), 1e-4);
    let rock = medium(2300.0, 900.0, 2000.0);
    let one = Ground::new(0.0, vec![GroundLayer::new(-20.0, soft())], rock).unwrap();
    let sh = include_str!("data/one_layer_SH00.csv");
    check(compare(sh, WaveKind::SH, 0.0, one, 0.0), 1e-4);
}

/// At 50 m along the direction of travel the same holds.
#[test]
fn the_field_travels_along_the_layers() {
    let sv = include_str!("data/two_layer_SV15_x50.csv");
    check(compare(sv, WaveKind::SV, 15.0, two(false), 50.0), 1e-4);
}

/// In layers of constant quality factors the same holds; stress along the layers is that of the
/// relaxing modulus.
#[test]
fn damped_layers_are_those_of_an_independent_solution() {
    let sv = include_str!("data/damped_two_layer_SV15.csv");
    check(compare(sv, WaveKind::SV, 15.0, two(true), 0.0), 1e-4);
}
