//! A shear wave at an interface that slips.

use core::f64::consts::TAU;

use powerhouse::engine::BuildModel;
use powerhouse_contact::{BondedCoulomb, Joint};
use powerhouse_material_damage::media;
use powerhouse_model::{Constraint, Vec3};

use super::{Column, even_step, watched};

/// Fractions of energy that are transmitted, reflected and absorbed.
type Energies = [f64; 3];

/// The closed form for a sine wave on a Coulomb interface under constant pressure with
/// `s = tau / (Z V)`, `th = asin s`: transmitted `(4/pi) ((th - sin th cos th)/2 + s^2 (pi/2 - th))`,
/// absorbed `(8/pi) (s cos th - s^2 (pi/2 - th))`.
fn closed_form(s: f64) -> Energies {
    let (th, rest) = (s.asin(), s.acos());
    let pi = core::f64::consts::PI;
    let transmitted = 4.0 / pi * ((th - s * th.cos()) / 2.0 + s * s * rest);
    let absorbed = 8.0 / pi * (s * th.cos() - s * s * rest);
    [transmitted, 1.0 - transmitted - absorbed, absorbed]
}

/// The same from a column with so many bricks per wavelength.
fn computed(s: f64, bricks: usize) -> Energies {
    let (frequency, amplitude, friction) = (5.0, 0.1, 0.6);
    let medium = media::ROCK;
    let impedance = medium.density * medium.s_speed();
    let wavelength = medium.s_speed() / frequency;
    let brick = wavelength / bricks as f64;
    let column = Column::new(&[(2 * bricks, medium), (bricks / 2, medium)], brick);
    let wave = move |t: f64| amplitude * (TAU * frequency * t.max(0.0)).sin();
    let watch = [
        column.level(wavelength * 1.75)[0],
        column.level(wavelength * 2.25)[0],
    ];
    let seen = |joined: Box<dyn Constraint>| {
        let builder = column.open(column.along(0), 0, [impedance; 2], wave);
        let mut model = builder.constraint(joined).build().unwrap();
        let step = even_step(&mut model, 1.0 / frequency);
        let (seen, report) = watched(&mut model, &watch, (6.0 / frequency, step));
        assert!(report.energy_residual < 1e-10, "{}", report.energy_residual);
        seen
    };
    let pairs = || column.surfaces[0].pairs.clone();
    let bonded = Joint::new("bonded", pairs(), powerhouse_contact::Tied).unwrap();
    let whole = seen(Box::new(bonded));
    let pressure = s * impedance * amplitude / friction;
    let law = BondedCoulomb::unbonded(friction, friction).unwrap();
    let joint = Joint::new("joint", pairs(), law).unwrap();
    let joint = joint.with_preload(|_| Vec3::z() * -pressure).unwrap();
    let slipping = seen(Box::new(joint));
    // The last two cycles, in which nothing but the direct waves is there.
    let last = |times: &[f64]| {
        let end = times.len() - 1;
        let from = times.partition_point(|&t| t < times[end] - 2.0 / frequency + 1e-9);
        from..end
    };
    let range = last(&whole.times);
    let incident = &whole.velocity[0][range.clone()];
    let power = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let total = power(&mut incident.iter().map(|v| v.x));
    let transmitted = power(&mut slipping.velocity[1][range.clone()].iter().map(|v| v.x));
    let below = slipping.velocity[0][range.clone()].iter().zip(incident);
    let reflected = power(&mut below.map(|(v, v0)| v.x - v0.x));
    let friction = |step: usize| -> f64 {
        slipping.records[step]
            .iter()
            .map(|record| record.friction)
            .sum()
    };
    let spent = friction(range.end) - friction(range.start);
    let incoming = impedance * amplitude * amplitude / 2.0 * 2.0 / frequency;
    [transmitted / total, reflected / total, spent / incoming]
}

fn error(s: f64, bricks: usize) -> f64 {
    let (found, expected) = (computed(s, bricks), closed_form(s));
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// The closed form agrees with the values of the reference table.
#[test]
fn energies_agree_with_the_reference() {
    for (s, reference) in [
        (0.1, [0.019150322, 0.76492747, 0.21592221]),
        (0.5, [0.39100222, 0.17300666, 0.43599112]),
        (0.9, [0.92827569, 0.0030478376, 0.068676472]),
    ] {
        for (a, b) in closed_form(s).iter().zip(reference) {
            assert!((a - b).abs() < 1e-7);
        }
    }
}

/// A shear wave on a slipping interface is transmitted, reflected and absorbed as the closed form
/// has it: to 0.5 % of its energy with 80 bricks per wavelength, the error falling at least linearly
/// with their size.
#[test]
fn a_shear_wave_slips_as_the_closed_form_has_it() {
    for s in [0.2, 0.5, 0.8] {
        let [coarse, fine] = [20, 80].map(|bricks| error(s, bricks));
        assert!(fine <= 0.005, "{s}: {fine}");
        // Four times finer: a linear error falls by four, within a part for what is left of phase.
        assert!(fine <= coarse / 3.5, "{s}: {coarse} {fine}");
    }
}
