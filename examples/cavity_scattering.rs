//! Scattering of waves by a cavity under the surface: amplitudes along the surface and transients, compared with a solution
//! by boundary elements.
//!
//! Builds on `free_field` and `absorbing_box`. Example 2 of Wang, Chen & Xiao (2019), their Figs. 8
//! and 9: a circular cavity in a half-space under vertically incident waves, one element thick in plane
//! strain. A single pulse gives the amplitudes of all its frequencies, as ratios of spectra.
//!
//! ```text
//!    x = -4a          0           4a
//!   ------x-x-x-x-x-x-x-x-x-x-x-x-x------  free surface, 81 stations
//!   |                .--.                |
//!   |               (    )  radius a     |  =))  springs, dashpots and input forces,
//!   |                `--'   depth 1.5 a  |       halved springs: waves spread as cylinders
//!   |                                    |
//!   --------------------------------------
//!         ^     ^     ^     ^     ^     P or SV: Ricker pulse, peak frequency 0.25 cs/a
//! ```
//!
//! The reference is in `data/reference`. Errors are per unit of incident displacement; they fall
//! with the element length and with the size of the box, as the figures show. The remaining error in the large box is due
//! to surface waves: in two dimensions they do not decay, and the boundary reflects part of them. After a pulse they return
//! late; under a harmonic wave they are always present, so that its amplitudes have larger errors than those of the pulse.
//!
//! Dashpots have B = 1, the default: with the paper's B = 1.1 they reflect 4.8 % of every body wave, which this comparison
//! shows.
//!
//! Run: `cargo run --release --example cavity_scattering`; it draws `results/cavity_scattering`.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::engine::observe::HistoryTable;
use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};
use powerhouse::wavefield::{Signal, WaveKind};
use powerhouse_examples::cavity::compare::{
    Pair, Steady, amplitudes, relative_l2, transients, values,
};
use powerhouse_examples::cavity::{CavityModel, Incoming, PEAK, STATIONS, pulse, unit_of_time};
use powerhouse_examples::reference::ReferenceTable;
use powerhouse_examples::{Figures, Outcome};

/// An incident wave of the reference.
struct Wave {
    kind: WaveKind,
    /// Name in the names of figures and in the reference.
    name: &'static str,
    rows: &'static str,
    transients: &'static str,
}

const WAVES: [Wave; 2] = [
    Wave {
        kind: WaveKind::P,
        name: "p0",
        rows: "P",
        transients: "cavity_ricker_P0.csv",
    },
    Wave {
        kind: WaveKind::SV,
        name: "sv0",
        rows: "SV",
        transients: "cavity_ricker_SV0.csv",
    },
];

/// Results of a model under a wave.
struct Answer {
    /// Amplitudes of ux and uz along the surface: of the reference and computed.
    amplitudes: [[Vec<f64>; 2]; 2],
    transients: Vec<Pair>,
}

impl Wave {
    fn incoming(&self, signal: Arc<dyn Signal>, end: f64) -> Incoming {
        Incoming {
            kind: self.kind,
            degrees: 0.0,
            signal,
            begin: 0.0,
            end,
        }
    }

    fn expected(&self, axis: char) -> Outcome<Vec<f64>> {
        let table = ReferenceTable::read("cavity_surface_harmonic.csv")?;
        table.rows_of(self.rows).column(&format!("abs_u{axis}"))
    }

    fn answer(&self, model: &CavityModel) -> Outcome<Answer> {
        let signal = pulse()?;
        let run = model.motion(&self.incoming(signal.clone(), 44.0))?;
        let of_axis = |axis: char| -> Outcome<[Vec<f64>; 2]> {
            Ok([
                self.expected(axis)?,
                amplitudes(&run, signal.as_ref(), axis, None)?,
            ])
        };
        let amplitudes = [of_axis('x')?, of_axis('z')?];
        let reference = ReferenceTable::read(self.transients)?;
        let transients = transients(&run, &reference, PEAK)?;
        Ok(Answer {
            amplitudes,
            transients,
        })
    }

    /// Largest error of the amplitudes under a harmonic wave, from the last 10 of 30 periods.
    fn harmonic_error(&self, model: &CavityModel) -> Outcome<f64> {
        let signal = Arc::new(Steady::new(PEAK)?);
        let end = signal.periods(30.0)?;
        let last = signal.periods(10.0)? * unit_of_time()?;
        let run = model.motion(&self.incoming(signal.clone(), end))?;
        let mut worst = 0.0_f64;
        for axis in ['x', 'z'] {
            let found = amplitudes(&run, signal.as_ref(), axis, Some(last))?;
            worst = worst.max(largest_difference(&found, &self.expected(axis)?));
        }
        Ok(worst)
    }
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    // A NaN counts as the largest error.
    let size = |(a, b): (&f64, &f64)| (a - b).abs();
    pairs
        .map(size)
        .fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

impl Answer {
    fn max_error(&self) -> f64 {
        let of_axis = |[expected, found]: &[Vec<f64>; 2]| largest_difference(expected, found);
        self.amplitudes.iter().map(of_axis).fold(0.0, f64::max)
    }

    fn ricker_rel_l2(&self) -> f64 {
        relative_l2(&self.transients)
    }

    /// Draws the amplitudes along the surface, and some of the transients.
    fn draw(&self, folder: &Path, name: &str) -> Outcome<()> {
        let curve = |name, x, y| PlotCurve { name, x, y };
        let panel = |label: &str, x, [expected, found]: [_; 2]| PlotPanel {
            label: label.into(),
            unit: "1".into(),
            curves: vec![curve("reference", x, expected), curve("computed", x, found)],
        };
        let places: Vec<f64> = STATIONS.map(|station| 0.1 * f64::from(station)).collect();
        let labels = ["|ux|", "|uz|"].iter().zip(&self.amplitudes);
        let along = Plot {
            title: format!("{name}: amplitudes along the surface over that of the incident wave"),
            label: "x / a".into(),
            unit: "1".into(),
            panels: labels
                .map(|(label, [a, b])| panel(label, &places[..], [&a[..], &b[..]]))
                .collect(),
            gaps: Vec::new(),
        };
        std::fs::create_dir_all(folder)?;
        write_plot(&folder.join(format!("{name}_surface.svg")), &along)?;
        let times: Vec<f64> = (0..self.transients[0].expected.len())
            .map(|row| 0.1 * row as f64)
            .collect();
        let shown_names = [
            "ux(0)",
            "uy(0)",
            "ux(2)",
            "uy(2)",
            "ur@-90deg",
            "ut@-90deg",
            "ut@0deg",
        ];
        // By symmetry some of them stay zero.
        let moves = |pair: &&Pair| pair.expected.iter().any(|u| u.abs() > 1.0e-6);
        let shown = self.transients.iter().filter(moves);
        let shown = shown.filter(|pair| shown_names.contains(&pair.name.as_str()));
        let transients = Plot {
            title: format!("{name}: transients over the peak of the incident wave"),
            label: "t cs / a".into(),
            unit: "1".into(),
            panels: shown
                .map(|pair| {
                    panel(
                        &pair.name,
                        &times[..],
                        [&pair.expected[..], &pair.found[..]],
                    )
                })
                .collect(),
            gaps: Vec::new(),
        };
        Ok(write_plot(
            &folder.join(format!("{name}_transients.svg")),
            &transients,
        )?)
    }
}

/// Fine mesh in a large box.
const BEST: CavityModel = CavityModel::BEST;
/// The same box with elements of twice the length.
const MIDDLE: CavityModel = CavityModel {
    edge: 0.1,
    far: [0.4, 0.16],
    ..BEST
};
/// The same box with elements of four times the length.
const COARSE: CavityModel = CavityModel {
    edge: 0.2,
    far: [0.4, 0.32],
    ..BEST
};
/// The fine mesh in a small box.
const SMALL: CavityModel = CavityModel {
    half_width: 8.0,
    height: 8.0,
    ..BEST
};

/// Difference of the surface motion between a small and a large box over the largest motion, for shear waves past the
/// critical angle (29 degrees).
fn past_critical(small: &CavityModel, large: &CavityModel) -> Outcome<f64> {
    let wave = Incoming {
        kind: WaveKind::SV,
        degrees: 45.0,
        signal: pulse()?,
        begin: 0.0,
        end: 24.0,
    };
    let (small, large) = (small.motion(&wave)?, large.motion(&wave)?);
    // Both end at the same time.
    let last = |table: &HistoryTable, name: &str| -> Outcome<Vec<f64>> {
        let values = values(table, name)?;
        Ok(values[values.len() - 240..].to_vec())
    };
    let (mut difference, mut peak) = (0.0_f64, 0.0_f64);
    for station in STATIONS {
        for axis in ['x', 'z'] {
            let name = format!("s{station}.u{axis}");
            let (small, large) = (last(&small, &name)?, last(&large, &name)?);
            difference = difference.max(largest_difference(&small, &large));
            peak = large.iter().fold(peak, |peak, u| peak.max(u.abs()));
        }
    }
    Ok(difference / peak)
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    for wave in &WAVES {
        let figure = |of: &str| format!("cavity_scattering.{}.{of}", wave.name);
        let best = wave.answer(&BEST)?;
        figures.at_most(&figure("max_error"), best.max_error(), 0.04);
        figures.at_most(&figure("ricker_rel_l2"), best.ricker_rel_l2(), 0.03);
        best.draw(Path::new("results/cavity_scattering"), wave.name)?;
        for (model, name, remark) in [
            (MIDDLE, "middle", "bricks of twice the length"),
            (COARSE, "coarse", "bricks of four times the length"),
            (SMALL, "small", "a small box"),
        ] {
            let answer = wave.answer(&model)?;
            figures.report(
                &figure(&format!("{name}.max_error")),
                answer.max_error(),
                remark,
            );
            figures.report(
                &figure(&format!("{name}.ricker_rel_l2")),
                answer.ricker_rel_l2(),
                remark,
            );
        }
        let layer = CavityModel {
            layer: Some(5.0),
            ..MIDDLE
        };
        let error = wave.answer(&layer)?.ricker_rel_l2();
        let remark = "bricks of twice the length, the wave enters by domain reduction";
        figures.report(&figure("layer.ricker_rel_l2"), error, remark);
        let error = wave.harmonic_error(&MIDDLE)?;
        let remark = "bricks of twice the length, 30 periods of a harmonic wave";
        figures.report(&figure("middle.harmonic_error"), error, remark);
    }
    let small = CavityModel {
        half_width: 16.0,
        ..MIDDLE
    };
    let difference = past_critical(&small, &MIDDLE)?;
    figures.report(
        "cavity_scattering.sv45.small_box",
        difference,
        "half the width compared with the whole, over the largest motion",
    );
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of a coarse mesh in a small box decreases with a larger box (P, whose surface waves are
    /// reflected) and with smaller elements (SV, which is short).
    #[test]
    fn errors_fall_with_bricks_and_box() {
        let [p, sv] = &WAVES;
        let small = CavityModel {
            edge: 0.2,
            far: [0.4, 0.2],
            half_width: 10.0,
            height: 8.0,
            ..BEST
        };
        let wide = CavityModel {
            half_width: 24.0,
            height: 10.0,
            ..small
        };
        let fine = CavityModel {
            edge: 0.1,
            far: [0.4, 0.1],
            ..small
        };
        let [of_small, of_wide] = [small, wide].map(|model| p.answer(&model).unwrap());
        let fall = of_wide.ricker_rel_l2() / of_small.ricker_rel_l2();
        assert!(of_wide.ricker_rel_l2() < 0.05 && fall < 0.7, "{fall}");
        let [of_small, of_fine] = [small, fine].map(|model| sv.answer(&model).unwrap());
        let fall = of_fine.ricker_rel_l2() / of_small.ricker_rel_l2();
        assert!(of_fine.ricker_rel_l2() < 0.1 && fall < 0.7, "{fall}");
    }
}
