//! `powerhouse drive`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::model::HistoryKind;
use powerhouse::{Error, PointError, PointPath, Registry};

use crate::Outcome;
use crate::terminal::{say, say_warning};

/// Runs a material test at one integration point along a path, and writes its table and curve.
pub(crate) fn drive(
    law: &Path,
    path: &Path,
    material: Option<&str>,
    out: Option<PathBuf>,
) -> Outcome {
    let material = Registry::default().material_of_file(law, material)?;
    // Of a test that fails on its way the steps before are written, and then the error.
    let (test, failure) = match PointPath::from_file(path)?.drive(&material) {
        Ok(test) => (test, None),
        Err(PointError::Leg { fault, test }) if test.records.len() > 1 => (*test, Some(fault)),
        Err(PointError::Leg { fault, .. }) => return Err(Error::Scene(fault).into()),
        Err(error) => return Err(error.into()),
    };
    say!("{}: {} steps", test.law, test.records.len() - 1);
    for warning in material.warnings() {
        say_warning!("{warning}");
    }
    let (component, [least, greatest]) = test.extremes();
    say!("stress {component} from {least:.4e} to {greatest:.4e} Pa");
    if let Some(last) = test.records.last() {
        say!("work {:.4e} J/m3", last.work);
        for (variable, value) in test.variables.iter().zip(&last.history) {
            if variable.kind != HistoryKind::Component {
                say!("{} {value:.4e}", variable.name);
            }
        }
    }
    let default = || {
        let stem = path.file_stem().unwrap_or("point".as_ref());
        Path::new("results").join(stem)
    };
    if let Some(growth) = material.growth_of_flow().filter(|growth| *growth > 0.0) {
        say!(
            "while it flows in plane-strain compression, waves of wave number k grow as exp(k t {growth:.0} m/s): \
             ill-posed (docs/materials.md#flow-without-dilation)"
        );
    }
    say!("\nfiles");
    for file in test.write(&out.unwrap_or_else(default))? {
        say!("  {}", file.display());
    }
    match failure {
        Some(fault) => Err(Error::Scene(fault).into()),
        None => Ok(ExitCode::SUCCESS),
    }
}
