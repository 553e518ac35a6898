//! Folder with a cube of ground and a scene of it.

use std::path::PathBuf;

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse_test_support::TestFolder;

/// Folder that is removed at the end, with the mesh of a cube of 120 m in `mesh.msh` and a scene in `scene.toml`.
pub(crate) struct Folder(pub(crate) TestFolder);

impl Folder {
    /// The folder of a name with a scene and so many bricks along each edge of the cube.
    pub(crate) fn new(name: &str, scene: &str, bricks: usize) -> Self {
        let path = TestFolder::new(&format!("block-{name}"));
        let size = Vec3::repeat(120.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [bricks; 3], "rock").unwrap();
        write_gmsh(path.join("mesh.msh"), &mesh).unwrap();
        std::fs::write(path.join("scene.toml"), scene).unwrap();
        Self(path)
    }
    pub(crate) fn scene(&self) -> PathBuf {
        self.0.join("scene.toml")
    }
    pub(crate) fn out(&self) -> PathBuf {
        self.0.join("out")
    }
}
