//! Bolts of a scene.

use std::collections::HashSet;

use powerhouse_explicit_core::{BoltLine, BoltParameters, BoltPattern, BoltSet};
use powerhouse_model::{Facet, Mesh};

use super::StagingError;
use crate::Error;

/// Where bolts stand.
#[derive(Clone, Debug, PartialEq)]
pub enum BoltPlace {
    /// Each from its head to its toe.
    Lines(Vec<BoltLine>),
    /// In rows on the facets of a set that are on the surface of the body when they are installed.
    Pattern {
        /// The facet set.
        facets: String,
        /// Rows, distances, length.
        pattern: BoltPattern,
    },
}

/// Bolts of one make, which a stage installs.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBolts {
    /// The name in stages and results.
    pub name: String,
    /// Where they stand.
    pub place: BoltPlace,
    /// What they are made of.
    pub parameters: BoltParameters,
}

impl SceneBolts {
    /// The bolts in the elements that are there.
    pub(super) fn embed(&self, mesh: &Mesh, present: &[bool]) -> Result<BoltSet, Error> {
        let refused = |source| {
            let name = self.name.clone();
            Error::of_bolts(StagingError::Bolts { name, source })
        };
        let is_there = |element: &u32| present[*element as usize];
        let hosts: Vec<u32> = (0..present.len() as u32)
            .filter(|element| is_there(element) && mesh.kind(*element).is_solid())
            .collect();
        let lines = match &self.place {
            BoltPlace::Lines(lines) => lines.clone(),
            BoltPlace::Pattern { facets, pattern } => {
                let facets = surface_of(mesh, present, mesh.facet_set(facets)?);
                pattern.lines(mesh, &facets, &hosts).map_err(refused)?
            }
        };
        if lines.is_empty() {
            let name = self.name.clone();
            return Err(Error::of_bolts(StagingError::NoPlace { name }));
        }
        BoltSet::new(&self.name, mesh, &hosts, &lines, self.parameters).map_err(refused)
    }
}

/// The facets that are on the surface of the body, seen from the elements that are there. A face
/// inside the mesh may be given from either side, or from both.
pub(crate) fn surface_of(mesh: &Mesh, present: &[bool], facets: &[Facet]) -> Vec<Facet> {
    let key = |facet: Facet| {
        let mut nodes = mesh.facet_nodes(facet);
        nodes.sort_unstable();
        nodes
    };
    let wanted: HashSet<Vec<u32>> = facets.iter().map(|&facet| key(facet)).collect();
    let there = |element: u32| present[element as usize];
    let surface = mesh.boundary_facets_of(there).into_iter();
    surface
        .filter(|&facet| wanted.contains(&key(facet)))
        .collect()
}
