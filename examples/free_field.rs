//! Free field: a plane wave in a block of ground without a structure, with the surface motion compared to the closed form.
//!
//! Builds on nothing. After example 1 of Wang, Chen & Xiao (2019): a cube of 1200 m in 40^3
//! elements under a free surface, viscous-spring boundaries on the other five faces.
//!
//! ```text
//!            free surface, z = 1200 m
//!        +-----------x-----------+      x  monitoring point, the centre
//!        |                       |
//!   =))  |     E  10 GPa         |  ((=     =))  springs, dashpots and input forces
//!        |     nu 0.3            |
//!   =))  |     rho 3000 kg/m3    |  ((=
//!        |                       |
//!        +-----------------------+
//!      ^    ^  ^^   ^^   ^^   ^^
//!     /   wave front, `a` from the horizontal
//!    / a   travels up and to the right from the corner that it hits first
//! ```
//!
//! Two inputs at the bottom are compared: the full free field (the default here), and the
//! incident wave alone, as the paper has it.
//!
//! Run: `cargo run --release --example free_field`

use std::process::ExitCode;

use powerhouse::InitialMotion;
use powerhouse::boundary::{AxisParameters, InputMode, ViscousSpring};
use powerhouse::wavefield::{RaisedCosinePulse, SmoothPulse, WaveKind, ZeroMeanPulse};
use powerhouse_examples::block::{BlockWave, Choices, EDGE};
use powerhouse_examples::{Figures, Outcome};

/// The relative error of a wave with a boundary.
fn error(wave: &BlockWave, boundary: ViscousSpring) -> Outcome<f64> {
    let choices = Choices {
        boundary,
        ..Choices::default()
    };
    Ok(wave.run(&choices)?.error)
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    let full = ViscousSpring::default;

    // The paper's two waves; a pulse of 0.8 s without permanent displacement.
    for (name, kind, limit) in [("p15", WaveKind::P, 0.006), ("sv15", WaveKind::SV, 0.02)] {
        let wave = BlockWave::new(kind, 15.0, RaisedCosinePulse::new(1.0, 0.8)?);
        let of_full = error(&wave, full())?;
        figures.at_most(&format!("free_field.{name}.rel_l2"), of_full, limit);
        // The paper's springs: r is the cube's edge on every face.
        let paper = ViscousSpring {
            axes: [AxisParameters::new(0.8, 1.1, Some(EDGE))?; 3],
            input: InputMode::IncidentOnly {
                faces: vec!["bottom".into()],
            },
            ..ViscousSpring::default()
        };
        figures.report(
            &format!("free_field.{name}.incident_only.rel_l2"),
            error(&wave, paper)?,
            "the paper's input at the bottom, which takes reflected waves for scattered ones",
        );
        // A narrower pulse of the same duration has higher frequencies, with a larger error on the same mesh.
        let narrow = BlockWave::new(kind, 15.0, SmoothPulse::new(1.0, 0.8)?);
        figures.report(
            &format!("free_field.{name}.narrow.rel_l2"),
            error(&narrow, full())?,
            "a cubic B-spline pulse of 0.8 s",
        );
    }

    // A horizontally polarised wave with an oblique azimuth.
    let mut skew = BlockWave::new(WaveKind::SH, 30.0, RaisedCosinePulse::new(1.0, 0.8)?);
    skew.azimuth = 37.0;
    figures.at_most("free_field.sh30.rel_l2", error(&skew, full())?, 0.03);

    // Past the critical angle (32.3 degrees here) the surface begins to move before the wave
    // arrives: the run starts from the motion that the field then has.
    let mut past_critical = BlockWave::new(WaveKind::SV, 40.0, ZeroMeanPulse::new(1.0, 1.6)?);
    past_critical.start = -1.0;
    past_critical.duration = 5.5;
    past_critical.initial = InitialMotion::Field;
    let error = error(&past_critical, full())?;
    figures.at_most("free_field.sv40.rel_l2", error, 0.03);

    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(super::figures().unwrap().missed(), 0);
    }
}
