//! `powerhouse drive`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::model::HistoryKind;
use powerhouse::{Material, PointPath, Registry};

use crate::Outcome;
use crate::terminal::say;

/// Leads a point of a material along a path, and writes its table and curve.
pub(crate) fn drive(
    law: &Path,
    path: &Path,
    material: Option<&str>,
    out: Option<PathBuf>,
) -> Outcome {
    let material = Material::from_file(law, material, &Registry::default())?;
    let driven = PointPath::from_file(path)?.drive(&material)?;
    say!("{}: {} steps", driven.law, driven.records.len() - 1);
    for doubt in material.doubts() {
        say!("warning: {doubt}");
    }
    let (component, [least, greatest]) = driven.extremes();
    say!("stress {component} from {least:.4e} to {greatest:.4e} Pa");
    if let Some(last) = driven.records.last() {
        say!("work {:.4e} J/m3", last.work);
        for (variable, value) in driven.variables.iter().zip(&last.history) {
            if variable.kind != HistoryKind::Component {
                say!("{} {value:.4e}", variable.name);
            }
        }
    }
    let named = || {
        let stem = path.file_stem().unwrap_or("point".as_ref());
        Path::new("results").join(stem)
    };
    say!("\nfiles");
    for file in driven.write(&out.unwrap_or_else(named))? {
        say!("  {}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}
