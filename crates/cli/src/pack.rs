//! `powerhouse pack`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::io::{MeshOptions, is_packed_mesh, write_packed_mesh};

use crate::Outcome;
use crate::terminal::{say, warn_aside};

/// Writes a mesh file as packed mesh, by default beside it.
pub(crate) fn pack(file: &Path, out: Option<PathBuf>) -> Outcome {
    if is_packed_mesh(file) {
        return Err(format!("{}: this is a packed mesh already", file.display()).into());
    }
    let date = || {
        std::fs::metadata(file)
            .and_then(|found| found.modified())
            .ok()
    };
    let before = date();
    let (mesh, remarks) = powerhouse::read_mesh(file, MeshOptions::default())
        .map_err(|error| error as Box<dyn std::error::Error>)?;
    for remark in remarks {
        warn_aside!("{remark}");
    }
    let out = out.unwrap_or_else(|| file.with_extension("phm"));
    if !is_packed_mesh(&out) {
        let out = out.display();
        return Err(
            format!("{out}: a packed mesh has the extension .phm, by which it is known").into(),
        );
    }
    write_packed_mesh(&out, &mesh, Some(file))?;
    if date() != before {
        return Err(format!(
            "{}: the file was changed while it was read: pack it again",
            file.display()
        )
        .into());
    }
    let (nodes, elements) = (mesh.node_count(), mesh.element_count());
    say!("{}: {nodes} nodes, {elements} elements", out.display());
    Ok(ExitCode::SUCCESS)
}
