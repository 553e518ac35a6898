//! Frequencies that the mesh of each part resolves.

use powerhouse_laws::Damping;
use powerhouse_model::Mesh;

use crate::{Error, Scene};

/// Elements per wavelength that a mesh should have for waves to travel without visible dispersion.
pub(crate) const PER_WAVELENGTH: f64 = 10.0;

/// Highest frequency that the mesh of a part resolves, with ten elements per shear wavelength, and that its damping reaches.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Resolution {
    /// Element set of the part.
    pub set: String,
    /// Shear wave speed (m/s).
    pub s_speed: f64,
    /// Longest element edge (m).
    pub longest_edge: f64,
    /// Highest resolved frequency `s_speed / (10 longest_edge)` (Hz).
    pub frequency: f64,
    /// Highest frequency of the band of its flat damping (Hz); none of other damping.
    pub damped: Option<f64>,
}

impl Scene {
    /// The resolution of each part.
    ///
    /// # Errors
    /// A set of a part that does not exist.
    pub fn resolution(&self) -> Result<Vec<Resolution>, Error> {
        let parts = self.parts.iter().map(|part| {
            let longest_edge = longest_edge_of(&self.mesh, &part.set)?;
            let s_speed = part.material.medium().s_speed();
            let damped = match &part.damping {
                Damping::Flat { spectrum, .. } => Some(spectrum.band().highest),
                _ => None,
            };
            Ok(Resolution {
                set: part.set.clone(),
                s_speed,
                longest_edge,
                frequency: s_speed / (PER_WAVELENGTH * longest_edge),
                damped,
            })
        });
        parts.collect()
    }
}

/// The longest edge in an element set (m).
fn longest_edge_of(mesh: &Mesh, set: &str) -> Result<f64, Error> {
    let edges = mesh
        .element_set(set)?
        .iter()
        .map(|&e| longest_edge(mesh, e));
    Ok(edges.fold(0.0, f64::max))
}

/// The longest edge of an element (m).
fn longest_edge(mesh: &Mesh, element: u32) -> f64 {
    let nodes = mesh.nodes_of(element);
    let at = |i: u8| mesh.positions()[nodes[i as usize] as usize];
    let sides = mesh.kind(element).sides();
    let edges = sides.iter().flat_map(|side| {
        (0..side.len()).map(|i| (at(side[i]) - at(side[(i + 1) % side.len()])).norm())
    });
    edges.fold(0.0, f64::max)
}
