//! Cost and error of numerical options for problems with known solutions.
//!
//! Builds on `free_field`, `cavity_scattering`, `joint_slip` and `concrete_cycle`: their problems, each solved
//! with several options, and the bay of `data/scenes/wang_2019.toml` compared with its own finest run.
//!
//! Run: `cargo run --release --example verification`; it writes `docs/verification.md` and the pictures
//! in `docs/verification`. With `-- bay` it solves the bay too, which takes a quarter of an hour.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use powerhouse::InitialMotion;
use powerhouse::boundary::{InputMode, ViscousSpring};
use powerhouse::engine::{Hex8OnePoint, Precision, SolidKernel};
use powerhouse::material::{
    PlasticDamage, PlasticDamageParameters, Softening, TwoSurface, TwoSurfaceParameters, presets,
};
use powerhouse::wavefield::{RaisedCosinePulse, WaveKind, ZeroMeanPulse};
use powerhouse_examples::Outcome;
use powerhouse_examples::block::{BlockWave, Choices};
use powerhouse_examples::cavity::compare::{relative_l2, transients};
use powerhouse_examples::cavity::{CavityModel, Incoming, PEAK, pulse};
use powerhouse_examples::interface::{closed_form, computed};
use powerhouse_examples::prices::{CostErrorTable, Measured};
use powerhouse_examples::reference::ReferenceTable;
use powerhouse_examples::softening::dissipated;
use powerhouse_study::trade::{Goal, Trade, TradeCase, TradeWatch};

const HEADER: &str = "# Cost and error of numerical options

Problems with known solutions, each solved with several numerical options. Errors are relative; costs are wall
times relative to that of the first option of each table, so that they are comparable between machines. Options on the
Pareto front of cost and error are in **bold**. `cargo run --release --example verification` writes this page; with
`-- bay` it adds the bay of `data/scenes/wang_2019.toml`, compared with its own finest run.
";

/// Options for the free field, of which the first has `bricks` elements along an edge.
fn free_field(table: &mut CostErrorTable, wave: &BlockWave, bricks: usize) -> Outcome<()> {
    let base = Choices {
        elements: bricks,
        ..Choices::default()
    };
    let mut put = |name: String, choices: Choices| -> Outcome<()> {
        table.put(name, wave.run(&choices)?);
        Ok(())
    };
    put(format!("{bricks} bricks along an edge"), base.clone())?;
    for elements in [3 * bricks / 4, bricks / 2] {
        let choices = Choices {
            elements,
            ..base.clone()
        };
        put(format!("{elements} bricks"), choices)?;
    }
    for (name, kernel) in [
        ("2 x 2 x 2 points", SolidKernel::Hex8Full),
        ("B-bar", SolidKernel::Hex8BBar),
    ] {
        let kernel = Some(kernel);
        let choices = Choices {
            kernel,
            ..base.clone()
        };
        put(name.into(), choices)?;
    }
    for (name, precision) in [
        ("mixed precision", Precision::Mixed),
        ("single precision", Precision::F32),
    ] {
        let choices = Choices {
            precision,
            ..base.clone()
        };
        put(name.into(), choices)?;
    }
    let half = Choices {
        step: 0.5,
        ..base.clone()
    };
    put("half the stable step".into(), half)?;
    let bottom = InputMode::IncidentOnly {
        faces: vec!["bottom".into()],
    };
    let boundary = ViscousSpring {
        input: bottom,
        ..ViscousSpring::default()
    };
    let choices = Choices { boundary, ..base };
    put("the incident wave alone, at the bottom".into(), choices)
}

/// The free field of an SV wave at 15 degrees.
fn below_critical(bricks: usize) -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "free_field_15",
        "Free field, SV at 15 degrees",
        "A pulse of 0.8 s crosses a cube of 1200 m under a free surface; displacement at the centre of the\n\
         surface over the whole run, compared with the closed form.",
    );
    let wave = BlockWave::new(WaveKind::SV, 15.0, RaisedCosinePulse::new(1.0, 0.8)?);
    free_field(&mut table, &wave, bricks)?;
    Ok(table)
}

/// The free field of an SV wave at 40 degrees.
fn past_critical(bricks: usize) -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "free_field_40",
        "Free field, SV at 40 degrees",
        "The same past the critical angle, with a pulse of 1.6 s: the run starts from the motion of the field.",
    );
    let mut wave = BlockWave::new(WaveKind::SV, 40.0, ZeroMeanPulse::new(1.0, 1.6)?);
    wave.start = -1.0;
    wave.duration = 5.5;
    wave.initial = InitialMotion::Field;
    free_field(&mut table, &wave, bricks)?;
    Ok(table)
}

/// Transients around a cavity, with elements of an edge of `edge` radii at first.
fn scattering(edge: f64, half_width: f64) -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "cavity_scattering",
        "A cavity scatters a P wave",
        "A vertically incident Ricker pulse and a circular cavity under the surface, in plane strain;\n\
         displacements of the surface and the wall, compared with a solution by boundary elements.",
    );
    let base = CavityModel {
        edge,
        far: [0.4, 1.6 * edge],
        half_width,
        ..CavityModel::BEST
    };
    let longer = |factor: f64| CavityModel {
        edge: factor * edge,
        far: [0.4, (1.6 * factor * edge).min(0.4)],
        ..base
    };
    let kernel = |kernel: SolidKernel| CavityModel {
        kernel: Some(kernel),
        ..base
    };
    let precision = |precision: Precision| CavityModel { precision, ..base };
    let half = CavityModel {
        half_width: 0.5 * half_width,
        ..base
    };
    let speed = CavityModel {
        speed_ratio: 1.1,
        ..base
    };
    let reference = ReferenceTable::read("cavity_ricker_P0.csv")?;
    for (name, model) in [
        (format!("bricks of {edge} radii"), base),
        ("bricks twice as long".into(), longer(2.0)),
        ("bricks half as long".into(), longer(0.5)),
        ("2 x 2 x 2 points".into(), kernel(SolidKernel::Hex8Full)),
        ("mixed precision".into(), precision(Precision::Mixed)),
        ("single precision".into(), precision(Precision::F32)),
        ("half the width of the box".into(), half),
        ("dashpots with B = 1.1".into(), speed),
    ] {
        let wave = Incoming {
            kind: WaveKind::P,
            degrees: 0.0,
            signal: pulse()?,
            begin: 0.0,
            end: 44.0,
        };
        let started = Instant::now();
        let run = model.motion(&wave)?;
        let seconds = started.elapsed().as_secs_f64();
        let error = relative_l2(&transients(&run, &reference, PEAK)?);
        table.put(name, Measured { error, seconds });
    }
    Ok(table)
}

/// Energies at a slipping interface, in columns with given numbers of elements per wavelength.
fn interface(bricks: [usize; 4]) -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "joint_slip",
        "A joint slips under a shear wave",
        "An S wave with twice the shear strength of an interface; the largest error of the transmitted,\n\
         reflected and absorbed shares of energy, compared with the closed form.",
    );
    let share = 0.5;
    let expected = closed_form(share);
    for bricks in bricks {
        let (found, seconds) = computed(share, bricks)?;
        let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        let error = apart.fold(0.0, f64::max);
        let name = format!("{bricks} bricks per wavelength");
        table.put(name, Measured { error, seconds });
    }
    Ok(table)
}

/// Dissipated energy of a bar of concrete with increasing numbers of elements.
fn softening() -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "softening_bar",
        "A bar of concrete cracks",
        "A bar of 2 m softens in one weakened element; its dissipated energy, compared with that of one crack.\n\
         The rates give the correct energy with 20 elements.",
    );
    let listed = presets::PAPER_CONCRETE_LISTED;
    let energy = 133.0;
    let concrete = |tension: Softening, share: f64| -> Outcome<PlasticDamage<TwoSurface>> {
        let surface = TwoSurface::new(TwoSurfaceParameters {
            tension_strength: listed.tension_strength * share,
            compression_strength: listed.compression_strength * share,
            ..listed
        })?;
        Ok(PlasticDamage::new(PlasticDamageParameters {
            surface,
            tension,
            compression: Softening::None,
            stiffness_recovery: 1.0,
            residual_stiffness: 1.0e-6,
        })?)
    };
    let strength = listed.tension_strength;
    let young = listed.medium.young;
    let rate = 1.0 / (energy / (0.1 * strength) - 0.5 * strength / young);
    for (law, tension) in [
        (
            "by energy",
            Softening::FractureEnergy {
                energy,
                threshold: 0.0,
            },
        ),
        (
            "by rates",
            Softening::Rates {
                share: 1.0,
                rate,
                threshold: 0.0,
            },
        ),
    ] {
        for count in [10, 20, 40, 80] {
            let [weak, strong] = [concrete(tension, 0.99)?, concrete(tension, 1.0)?];
            let started = Instant::now();
            let ratio = dissipated(weak, strong, (2.0, count), (energy, strength))?;
            let seconds = started.elapsed().as_secs_f64();
            let error = (ratio - 1.0).abs();
            table.put(
                format!("{law}, {count} elements"),
                Measured { error, seconds },
            );
        }
    }
    Ok(table)
}

/// Progress output of a trade study.
struct Printed;

impl TradeWatch for Printed {
    fn ends(&mut self, case: &TradeCase) {
        println!("bay: {}: error {:.2e}", case.name, case.error);
    }
}

/// The bay of the paper over a window (s) of its record.
fn bay(scene: &Path, window: f64) -> Outcome<CostErrorTable> {
    let mut table = CostErrorTable::new(
        "bay",
        "The powerhouse of Wang, Chen & Xiao (2019)",
        "Yielding rock, cracking concrete, joints and bolts, after six stages: the first second of the\n\
         coarse bay under SV at 30 degrees; all recorded histories, compared with the finest run: eight integration\n\
         points per element, half the stable step, double precision, the full field on viscous springs.",
    );
    let folder = std::env::temp_dir().join("powerhouse-verification-bay");
    let mut trade =
        Trade::of_file_with(scene, Some(folder), &powerhouse_wang_2019::registry())?.window(window);
    let report = trade.run(Goal::Front, None, &mut Printed)?;
    table.rows = report.pareto_points();
    table.uncertainty = report.reference_error.unwrap_or(0.0);
    Ok(table)
}

fn main() -> Outcome<()> {
    let docs = Path::new("docs");
    let mut tables = vec![
        below_critical(40)?,
        past_critical(40)?,
        scattering(0.1, 32.0)?,
        interface([12, 20, 40, 80])?,
        softening()?,
    ];
    if std::env::args().any(|argument| argument == "bay") {
        tables.push(bay(Path::new("data/scenes/wang_2019.toml"), 1.0)?);
    }
    let pictures = docs.join("verification");
    std::fs::create_dir_all(&pictures)?;
    let mut page = String::from(HEADER);
    for table in &tables {
        table.draw(&pictures)?;
        let _ = write!(page, "{}", table.markdown());
    }
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    let _ = writeln!(
        page,
        "\nKernels are `{}` where none is named.",
        kernel.name()
    );
    std::fs::write(docs.join("verification.md"), page)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of the row whose name has a prefix.
    fn error(table: &CostErrorTable, name: &str) -> f64 {
        let row = table.rows.iter().find(|row| row.name.starts_with(name));
        row.unwrap().error
    }

    /// Errors of the free field grow with the element size, and are far larger if only the incident wave is
    /// applied at the bottom; number formats have no effect here.
    #[test]
    fn choices_of_the_free_field_have_their_prices() {
        let table = below_critical(24).unwrap();
        let base = error(&table, "24 bricks");
        assert!(error(&table, "12 bricks") > 2.0 * base);
        assert!(error(&table, "the incident wave alone") > 1.5 * base);
        for same in ["mixed", "single"] {
            assert!((error(&table, same) / base - 1.0).abs() < 0.05);
        }
        let page = table.markdown();
        assert!(page.contains("12 bricks") && page.contains("24 bricks along an edge"));
        assert!(!page.contains("itself"), "a closed form has no error");
        let uncertain = CostErrorTable {
            uncertainty: 1.1e-3,
            ..table
        };
        assert!(
            uncertain
                .markdown()
                .contains("error of the reference itself is 1.1e-3")
        );
    }

    /// With softening by fracture energy the dissipation is the same in any mesh, with rates it is not.
    #[test]
    fn a_bar_has_its_energy_by_the_crack() {
        let table = softening().unwrap();
        for count in [10, 20, 40, 80] {
            assert!(error(&table, &format!("by energy, {count}")) < 0.02);
        }
        assert!(error(&table, "by rates, 20") < 0.02);
        assert!(error(&table, "by rates, 80") > 0.5);
    }
}
