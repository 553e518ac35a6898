//! Rims: elements of parts along the absorbing faces.

use std::collections::HashSet;

use powerhouse_model::Facet;

use crate::{Error, Scene};

impl Scene {
    /// Elements of the rim of each part.
    ///
    /// # Errors
    /// Width that is negative or not finite; rim without elements.
    pub(crate) fn rims(&self) -> Result<Vec<HashSet<u32>>, Error> {
        let facets: Vec<Facet> = self
            .absorbing_facets()?
            .iter()
            .flat_map(|(_, facets)| facets.iter().copied())
            .collect();
        let rim_of = |part: &crate::Part| {
            let Some(width) = part.rim else {
                return Ok(HashSet::new());
            };
            powerhouse_model::ParameterError::check("rim", width, 0.0, f64::MAX)?;
            let near = self.mesh.nodes_near(&facets, width);
            let elements = self.mesh.element_set(&part.set)?.iter().copied();
            let is_near = |element: &u32| {
                let nodes = self.mesh.nodes_of(*element);
                nodes.iter().any(|&node| near[node as usize])
            };
            let rim: HashSet<u32> = elements.filter(is_near).collect();
            if rim.is_empty() {
                let set = part.set.clone();
                return Err(Error::EmptyRim { set, width });
            }
            Ok(rim)
        };
        self.parts.iter().map(rim_of).collect()
    }
}
