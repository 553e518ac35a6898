//! `powerhouse mesh`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::io::{FieldPrecision, VtuField, VtuNumbers, VtuWriter, write_gmsh};
use powerhouse_wang_2019::bay::Bay;

use crate::Outcome;
use crate::terminal::{say, say_on};

/// Generates the mesh of a machine bay, prints its report, and writes it for Gmsh and ParaView with a picture of its
/// section.
pub(crate) fn mesh(file: &Path, out: Option<PathBuf>) -> Outcome {
    let bay = Bay::from_file(file)?.mesh()?;
    say_on!("{}", bay.report);
    let default =
        || PathBuf::from(file.file_stem().unwrap_or("bay".as_ref())).with_extension("msh");
    let gmsh = out.unwrap_or_else(default);
    let (vtu, picture) = (gmsh.with_extension("vtu"), gmsh.with_extension("png"));
    write_gmsh(&gmsh, &bay.mesh)?;
    let numbers = bay.part_numbers()?;
    let part = VtuField {
        name: "part",
        components: 1,
        numbers: VtuNumbers::Whole,
        unit: "",
        values: &numbers,
    };
    VtuWriter::new(&bay.mesh, FieldPrecision::Single)?.write(&vtu, 0.0, &[], &[part])?;
    bay.draw(&picture)?;
    say!("\nfiles");
    for file in [gmsh, vtu, picture] {
        say!("  {}", file.display());
    }
    Ok(ExitCode::SUCCESS)
}
