//! `powerhouse pack`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::io::{MeshOptions, is_packed_mesh, write_packed_mesh};

use crate::Outcome;
use crate::terminal::{say, warn_aside};

/// Writes a mesh file as packed mesh, by default beside it.
pub(crate) fn pack(file: &Path, out: Option<PathBuf>) -> Outcome {
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
    let (nodes, elements) = (mesh.node_count(), mesh.element_count());
    say!("{}: {nodes} nodes, {elements} elements", out.display());
    Ok(ExitCode::SUCCESS)
}
