//! Rock bolts of a scene.

use std::collections::HashSet;

use powerhouse_elements::{BoltLine, BoltParameters, BoltPattern, BoltSet};
use powerhouse_model::{Facet, Mesh};

use super::StagingError;
use crate::{Error, Scene};

/// Layout of a bolt group.
#[derive(Clone, Debug, PartialEq)]
pub enum BoltLayout {
    /// Given axes, each from head to toe.
    Lines(Vec<BoltLine>),
    /// Regular pattern on those facets of a set that are on the surface of the body when the bolts are installed.
    Pattern {
        /// Facet set of the heads.
        facets: String,
        /// Axis of the rows, spacing and length.
        pattern: BoltPattern,
    },
}

/// Bolt group: bolts with equal properties that a construction stage installs.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBolts {
    /// Name in stages and results.
    pub name: String,
    /// Axes of the bolts, given one by one or as a pattern on a surface.
    pub layout: BoltLayout,
    /// Section, stiffness, yield force and pretension of the bars, and their grout if they have any.
    pub parameters: BoltParameters,
}

impl SceneBolts {
    /// Embeds the bolts in the active elements.
    pub(super) fn embed(&self, scene: &Scene, present: &[bool]) -> Result<BoltSet, Error> {
        let mesh = &*scene.mesh;
        let refused = |source| {
            let name = self.name.clone();
            Error::of_bolts(StagingError::Bolts { name, source })
        };
        let is_active = |element: &u32| present[*element as usize];
        let hosts: Vec<u32> = (0..present.len() as u32)
            .filter(|element| is_active(element) && mesh.kind(*element).is_solid())
            .collect();
        let lines = match &self.layout {
            BoltLayout::Lines(lines) => lines.clone(),
            BoltLayout::Pattern { facets, pattern } => {
                let facets = surface_of(mesh, present, mesh.facet_set(facets)?);
                pattern.lines(mesh, &facets, &hosts).map_err(refused)?
            }
        };
        if lines.is_empty() {
            let name = self.name.clone();
            return Err(Error::of_bolts(StagingError::NoFreeFacet { name }));
        }
        scene.check_bolts_of_bay(&self.name, &lines)?;
        BoltSet::new(&self.name, mesh, &hosts, &lines, self.parameters).map_err(refused)
    }
}

/// Surface facets of the active elements among the given facets. A face inside the mesh may be given from either
/// side, or from both.
pub fn surface_of(mesh: &Mesh, present: &[bool], facets: &[Facet]) -> Vec<Facet> {
    let key = |facet: Facet| {
        let mut nodes = mesh.facet_nodes(facet);
        nodes.sort_unstable();
        nodes
    };
    let requested: HashSet<Vec<u32>> = facets.iter().map(|&facet| key(facet)).collect();
    let active = |element: u32| present[element as usize];
    let surface = mesh.boundary_facets_of(active).into_iter();
    surface
        .filter(|&facet| requested.contains(&key(facet)))
        .collect()
}
