//! Results of a convergence study and their files.

use std::path::{Path, PathBuf};

use powerhouse::io::write_summary;
use serde::{Deserialize, Serialize};

use super::FORMAL_ORDERS;
use super::estimate::{Estimate, estimate};
use super::figures::Figure;
use crate::StudyError;
use crate::json::read_json;
use crate::rounded::rounded;
use crate::sweep::write_text;

/// Names of the files of a study.
const JSON: &str = "convergence.json";
const TABLE: &str = "convergence.csv";
/// Values below this share of the largest of their kind are negligible.
const NEGLIGIBLE: f64 = 1e-3;

/// Mesh of a convergence study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshLevel {
    /// Name of its run, which is that of its folder.
    pub case: String,
    /// Number of elements.
    pub elements: usize,
    /// Edge of a cube with the mean volume of the elements (m).
    pub size: f64,
}

/// Result on several meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComparedFigure {
    /// Name of the result.
    pub name: String,
    /// Unit of its values; `1` for a dimensionless one.
    pub unit: String,
    /// Values on the meshes, the coarsest first.
    pub values: Vec<f64>,
    /// Largest change of the value under waves larger by 1e-6; `None` if it was not measured.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub scatter: Option<f64>,
    /// Estimate for vanishing element size.
    pub estimate: Estimate,
    /// Whether all values are below a thousandth of the largest of their kind.
    pub negligible: bool,
}

impl ComparedFigure {
    /// Half width of the error band over the value on the finest mesh (1); infinite for a result that does not converge.
    pub fn relative_band(&self) -> f64 {
        let finest = self.values.last().copied().unwrap_or(0.0);
        match self.estimate.band {
            Some(0.0) => 0.0,
            Some(band) => band / finest.abs(),
            None => f64::INFINITY,
        }
    }
}

/// Results of a convergence study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceReport {
    /// Title of the scene.
    pub title: String,
    /// Meshes, the coarsest first.
    pub meshes: Vec<MeshLevel>,
    /// Whether laws or joints have history variables and no run was repeated under perturbed waves.
    pub scatter_unknown: bool,
    /// Whether the meshes are refinements, which keep the chords of curved walls.
    pub keeps_chords: bool,
    /// Results that all runs have.
    pub figures: Vec<ComparedFigure>,
    /// Written files.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
}

impl ConvergenceReport {
    /// Results that are not negligible and whose relative error band is wider than a share (1).
    pub fn wider_than(&self, share: f64) -> impl Iterator<Item = &ComparedFigure> {
        let counted = self.figures.iter().filter(|figure| !figure.negligible);
        counted.filter(move |figure| figure.relative_band() > share)
    }

    /// Sentences on what the error bands do not contain.
    pub fn limits(&self) -> Vec<String> {
        let mut limits = Vec::new();
        if self.meshes.len() == 2 {
            limits.push(
                "two meshes show no order of convergence: it is assumed, 2 for motions in scenes without history variables and 1 \
                 otherwise, with a factor of safety of 3; three meshes show it"
                    .to_owned(),
            );
        }
        if self.scatter_unknown {
            limits.push(
                "laws or joints have history variables, and no run was repeated under perturbed waves: the scatter of results \
                 is unknown"
                    .to_owned(),
            );
        }
        if self.figures.iter().any(|figure| figure.scatter.is_some()) {
            limits.push(
                "the finest mesh was not run under perturbed waves: its results are assumed to scatter no more than those of the others"
                    .to_owned(),
            );
        }
        if self.keeps_chords {
            limits.push(
                "refined meshes keep the chords of curved walls: the error of the geometry is not in the bands".to_owned(),
            );
        }
        limits.push(
            "the error of the absorbing boundary is not in the bands: `advise box` and `check --free-field` show it".to_owned(),
        );
        limits
    }

    /// Cells of a result in a table: name, unit, values, extrapolated value, relative band, order, scatter, trend.
    pub fn cells(figure: &ComparedFigure) -> Vec<String> {
        let percent = |share: f64| {
            if share.is_finite() {
                format!("{:.1} %", 100.0 * share)
            } else {
                "unknown".into()
            }
        };
        let text = |value: Option<f64>| value.map_or(String::new(), rounded);
        let mut cells = vec![figure.name.clone(), figure.unit.clone()];
        cells.extend(figure.values.iter().map(|value| rounded(*value)));
        cells.extend([
            text(figure.estimate.extrapolated),
            percent(figure.relative_band()),
            text(figure.estimate.order),
            text(figure.scatter),
            figure.estimate.trend.text().into(),
        ]);
        cells
    }

    /// Header of the table of results.
    pub fn header(&self) -> Vec<String> {
        let mut header = vec!["result".to_owned(), "unit".to_owned()];
        let meshes = self.meshes.iter();
        header.extend(meshes.map(|mesh| format!("{} elements", mesh.elements)));
        let rest = ["extrapolated", "error band", "order", "scatter", "trend"];
        header.extend(rest.map(str::to_owned));
        header
    }

    /// Writes the files of the study and lists them.
    pub(super) fn write(&mut self, folder: &Path) -> Result<(), StudyError> {
        let (json, table) = (folder.join(JSON), folder.join(TABLE));
        write_summary(&json, self).map_err(powerhouse::Error::from)?;
        let mut text: String = (self.limits().iter())
            .map(|limit| format!("# {limit}\n"))
            .collect();
        text += "result,unit";
        for mesh in &self.meshes {
            text += &format!(",{} elements of {} m", mesh.elements, rounded(mesh.size));
        }
        text += ",extrapolated,half width of the error band,order,scatter,trend,negligible\n";
        let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
        for figure in &self.figures {
            let Estimate {
                trend,
                order,
                extrapolated,
                band,
            } = figure.estimate;
            let values: Vec<String> = figure.values.iter().map(|v| format!("{v:e}")).collect();
            text += &format!(
                "\"{}\",{},{},{},{},{},{},{},{}\n",
                figure.name,
                figure.unit,
                values.join(","),
                cell(extrapolated),
                cell(band),
                cell(order),
                cell(figure.scatter),
                trend.text(),
                figure.negligible
            );
        }
        write_text(&table, &text)?;
        self.files = vec![table, json];
        Ok(())
    }
}

/// Reads the results of a study from its folder; `None` for a folder without one.
///
/// # Errors
/// A file that cannot be read.
pub fn read(folder: &Path) -> Result<Option<ConvergenceReport>, StudyError> {
    let file = folder.join(JSON);
    if !file.exists() {
        return Ok(None);
    }
    read_json(&file).map(Some)
}

/// Results of the runs of a study.
#[derive(Clone, Copy)]
pub(super) struct RunFigures<'a> {
    /// Those of each mesh, the coarsest first.
    pub(super) plain: &'a [Vec<Figure>],
    /// Those under perturbed waves, with the index of their mesh.
    pub(super) perturbed: &'a [(usize, Vec<Figure>)],
}

/// Compares the results that all runs have.
pub(super) fn compare(
    meshes: &[MeshLevel],
    runs: &RunFigures,
    is_linear: bool,
) -> Vec<ComparedFigure> {
    let RunFigures { plain, perturbed } = *runs;
    let of = |figures: &[Figure], name: &str| {
        let found = figures.iter().find(|figure| figure.name == name);
        found.map(|figure| figure.value)
    };
    let sizes: Vec<f64> = meshes.iter().map(|mesh| mesh.size).collect();
    let finest = plain.last().map_or(&[][..], Vec::as_slice);
    let compared = finest.iter().filter_map(|figure| {
        let values = plain.iter().map(|figures| of(figures, &figure.name));
        let values: Vec<f64> = values.collect::<Option<_>>()?;
        let changes = perturbed.iter().filter_map(|(mesh, figures)| {
            let change = of(figures, &figure.name)? - values.get(*mesh)?;
            Some(change.abs())
        });
        let scatter = changes.reduce(f64::max);
        let own = plain.iter().flatten();
        let own = own.filter(|other| other.name == figure.name);
        let sampling = own.fold(0.0_f64, |most, other| most.max(other.of_sampling));
        let [motions, others] = FORMAL_ORDERS;
        let formal = if figure.of_motion && is_linear {
            motions
        } else {
            others
        };
        let largest = |figure: &Figure| {
            let of_kind = plain.iter().flatten();
            let of_kind = of_kind.filter(|other| kind(other) == kind(figure));
            of_kind.fold(0.0_f64, |most, other| most.max(other.value.abs()))
        };
        let limit = NEGLIGIBLE * largest(figure);
        let negligible = values.iter().all(|value| value.abs() <= limit);
        Some(ComparedFigure {
            name: figure.name.clone(),
            unit: figure.unit.clone(),
            estimate: estimate(
                &values,
                &sizes,
                scatter.unwrap_or(0.0).max(sampling),
                formal,
            ),
            values,
            scatter,
            negligible,
        })
    });
    compared.collect()
}

/// The kind of a result, within which sizes are compared: its unit, or the variable of a dimensionless one.
fn kind(figure: &Figure) -> &str {
    if figure.unit != "1" {
        return &figure.unit;
    }
    let name = &figure.name;
    match (name.rsplit_once('.'), name.split_once(" of ")) {
        (Some((_, variable)), _) => variable,
        (None, Some((kind, _))) => kind,
        (None, None) => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convergence::Trend;

    fn figure(name: &str, unit: &str, value: f64) -> Figure {
        Figure {
            name: name.into(),
            unit: unit.into(),
            value,
            of_motion: unit == "m",
            of_sampling: 0.0,
        }
    }

    fn meshes() -> Vec<MeshLevel> {
        let level = |(index, size): (usize, f64)| MeshLevel {
            case: format!("mesh-{}", index + 1),
            elements: 8 << (3 * index),
            size,
        };
        [2.0, 1.0].into_iter().enumerate().map(level).collect()
    }

    /// Motions of linear scenes have the formal order 2, stresses and motions of other scenes 1; the scatter is the largest
    /// change of any perturbed run; a result that one run lacks is left out; a value far below others of its unit is negligible.
    #[test]
    fn results_of_all_meshes_are_compared() {
        let run = |motion: f64, stress: f64| {
            vec![
                figure("peak of a.ux", "m", motion),
                figure("peak of b.ux", "m", 1e-6 * motion),
                figure("peak of a.s1", "Pa", stress),
            ]
        };
        let mut fine = run(4.0, 10.0);
        fine.push(figure("peak of c.damage", "1", 0.5));
        let plain = [run(7.0, 12.0), fine];
        let found = compare(
            &meshes(),
            &RunFigures {
                plain: &plain,
                perturbed: &[],
            },
            true,
        );
        let names: Vec<&str> = found.iter().map(|figure| figure.name.as_str()).collect();
        assert_eq!(names, ["peak of a.ux", "peak of b.ux", "peak of a.s1"]);
        assert_eq!(found[0].estimate.extrapolated, Some(3.0));
        assert_eq!(found[2].estimate.extrapolated, Some(8.0));
        assert_eq!(found[0].scatter, None);
        let negligible = found.iter().map(|figure| figure.negligible);
        assert_eq!(negligible.collect::<Vec<_>>(), [false, true, false]);
        let perturbed = [(0, run(7.5, 12.1))];
        let found = compare(
            &meshes(),
            &RunFigures {
                plain: &plain,
                perturbed: &perturbed,
            },
            false,
        );
        assert_eq!(found[0].estimate.extrapolated, Some(1.0));
        assert_eq!(found[0].scatter, Some(0.5));
        assert!((found[2].scatter.unwrap() - 0.1).abs() < 1e-12);
        // What sampling changes limits the band as scatter does.
        let mut sampled = plain.clone();
        sampled[0][0].of_sampling = 2.0;
        let limited = compare(
            &meshes(),
            &RunFigures {
                plain: &sampled,
                perturbed: &[],
            },
            true,
        );
        assert_eq!(limited[0].estimate.band, Some(4.0));
        assert_eq!(limited[0].estimate.extrapolated, None);
        // The band of 6 m around 4 m, and of 6 Pa around 10 Pa; the negligible one does not count.
        let report = ConvergenceReport {
            title: String::new(),
            meshes: meshes(),
            scatter_unknown: false,
            keeps_chords: false,
            figures: found,
            files: Vec::new(),
        };
        let wide = |share: f64| report.wider_than(share).count();
        assert_eq!([0.5, 1.0, 3.0].map(wide), [2, 1, 0]);
    }

    #[test]
    fn dimensionless_results_are_compared_within_their_kind() {
        let of = |name: &str| kind(&figure(name, "1", 0.0)).to_owned();
        assert_eq!(of("peak of wall.damage"), "damage");
        assert_eq!(of("mean damage of lining"), "mean damage");
        assert_eq!(of("failed share"), "failed share");
        assert_eq!(kind(&figure("peak of a.ux", "m", 0.0)), "m");
    }

    /// A result that does not converge has no finite band.
    #[test]
    fn bands_are_relative_to_the_finest_value() {
        let with = |band: Option<f64>| ComparedFigure {
            name: String::new(),
            unit: "m".into(),
            values: vec![3.0, -2.0],
            scatter: None,
            estimate: Estimate {
                trend: Trend::Assumed,
                order: None,
                extrapolated: None,
                band,
            },
            negligible: false,
        };
        let found = [Some(0.5), Some(0.0), None].map(|band| with(band).relative_band());
        assert_eq!(found, [0.25, 0.0, f64::INFINITY]);
    }
}
