//! `powerhouse new`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use powerhouse::io::write_gmsh;
use powerhouse_study::starter;

use crate::Outcome;
use crate::terminal::say;

/// Names of the files.
const SCENE: &str = "scene.toml";
const MESH: &str = "tunnel.msh";

/// Writes the scene of a lined tunnel with its mesh into a folder; files that exist are not touched.
pub(crate) fn new(folder: &Path) -> Outcome {
    let (scene, mesh) = (folder.join(SCENE), folder.join(MESH));
    for file in [&scene, &mesh] {
        if file.exists() {
            return Err(format!(
                "{} exists and is kept: choose another folder",
                file.display()
            )
            .into());
        }
    }
    let cannot = |error| format!("cannot write {}: {error}", scene.display());
    std::fs::create_dir_all(folder).map_err(cannot)?;
    let mut text = std::fs::File::create_new(&scene).map_err(cannot)?;
    text.write_all(starter::SCENE.as_bytes()).map_err(cannot)?;
    write_gmsh(&mesh, &starter::tunnel()?)?;
    let shown = scene.display();
    say!("{shown} and its mesh are written; next:");
    say!("  powerhouse check {shown}");
    say!(
        "  powerhouse run {shown} --out {}",
        folder.join("results").display()
    );
    say!("  powerhouse report {}", folder.join("results").display());
    Ok(ExitCode::SUCCESS)
}
