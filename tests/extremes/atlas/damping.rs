//! Damping from none to overcritical, and steps at the limit with it.

use powerhouse::Material;
use powerhouse_material_damage::{DampingBand, ReferenceFrequency, RelaxationSpectrum, media};
use powerhouse_model::Rayleigh;

use super::cell::{Refusal, Row};
use super::trial::{Trial, body, elastic, irregular};

fn rayleigh(mass: f64, stiffness: f64) -> Rayleigh {
    Rayleigh { mass, stiffness }
}

/// Rock with flat damping of a ratio to critical.
fn flat(ratio: f64) -> Result<Material, Refusal> {
    let spectrum = RelaxationSpectrum::fit(DampingBand {
        ratio,
        lowest: 10.0,
        highest: 400.0,
        mechanisms: 3,
    })?;
    let damped = elastic(media::ROCK).damped(&spectrum, ReferenceFrequency::Centre)?;
    damped.ok_or_else(|| "no damping in series".into())
}

pub(super) fn rows() -> Vec<Row> {
    // The frequencies of the box are some 100 to 1000 Hz.
    let amounts = [
        ("Rayleigh damping, none", rayleigh(0.0, 0.0)),
        (
            "Rayleigh damping, of the mass, 5 % at 200 Hz",
            rayleigh(126.0, 0.0),
        ),
        (
            "Rayleigh damping, of the stiffness, 5 % at 200 Hz",
            rayleigh(0.0, 8e-5),
        ),
        (
            "Rayleigh damping, both critical at 200 Hz",
            rayleigh(1260.0, 8e-4),
        ),
        (
            "Rayleigh damping, of the mass, a million times critical",
            rayleigh(1e9, 0.0),
        ),
        (
            "Rayleigh damping, of the stiffness, a thousand times critical",
            rayleigh(0.0, 1.0),
        ),
        (
            "Rayleigh damping, both far beyond critical",
            rayleigh(1e9, 1.0),
        ),
    ];
    let of_rayleigh = amounts.map(|(name, damping)| {
        Row::new(name, move |column| {
            Trial::of(column)
                .damped(damping)
                .play(|damping| body(column, &irregular(column)?, &elastic(media::ROCK), damping))
        })
    });
    let ratios = [0.0, 1e-6, 0.05, 0.2, 0.5, 1.0];
    let of_flat = ratios.map(|ratio| {
        Row::new(
            format!("flat damping, {ratio} of critical"),
            move |column| {
                Trial::of(column)
                    .play(|damping| body(column, &irregular(column)?, &flat(ratio)?, damping))
            },
        )
    });
    of_rayleigh
        .into_iter()
        .chain(of_flat)
        .chain(at_the_limit())
        .collect()
}

/// Steps just below, at and just above the reported one.
fn at_the_limit() -> Vec<Row> {
    let kinds: [(&str, Option<Rayleigh>); 4] = [
        ("undamped", None),
        ("damped by mass", Some(rayleigh(126.0, 0.0))),
        ("damped by stiffness", Some(rayleigh(0.0, 4e-4))),
        ("with flat damping", None),
    ];
    let mut rows = Vec::new();
    for (kind, damping) in kinds {
        for share in [0.999, 1.0, 1.001] {
            rows.push(Row::new(
                format!("{share} of the reported step, {kind}"),
                move |column| {
                    let mut trial = Trial::of(column).share(share);
                    if let Some(damping) = damping {
                        trial = trial.damped(damping);
                    }
                    trial.play(|damping| {
                        let rock = match kind {
                            "with flat damping" => flat(0.05)?,
                            _ => elastic(media::ROCK),
                        };
                        body(column, &irregular(column)?, &rock, damping)
                    })
                },
            ));
        }
    }
    rows
}
