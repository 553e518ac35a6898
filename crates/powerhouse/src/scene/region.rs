//! A region that the field enters through the layer of elements around it.

use powerhouse_boundary::ReductionLayer;
use powerhouse_model::{BoundarySite, IncidentField};
use thiserror::Error;

use super::{InitialMotion, Scene};
use crate::{Damping, Error, Remark, reduction_layer};

/// Why domain reduction through the layer around a region is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RegionError {
    /// No field that could enter.
    #[error("a region lets waves in through the layer around it, and no wave comes")]
    NoField,
    /// A region without an element, or one that is the whole body.
    #[error("the region has {inside} of {of} elements: some must be in it, and some around it")]
    Nothing {
        /// Elements of the region.
        inside: usize,
        /// Elements of the body.
        of: usize,
    },
    /// A region that reaches the absorbing faces.
    #[error(
        "the region has node {node} on an absorbing face ({count} such nodes): a layer of elements must lie between, since those faces see scattered waves alone"
    )]
    TouchesFace {
        /// The user's number of the first such node.
        node: u64,
        /// How many there are.
        count: usize,
    },
    /// An element of the layer that is not the ground of the field.
    #[error(
        "element {element} of the layer around the region is {what}: the field solves the equations of elastic, undamped ground of its own medium there"
    )]
    OtherGround {
        /// The user's number.
        element: u64,
        /// What it is.
        what: &'static str,
    },
    /// A body that starts with the motion of the field.
    #[error(
        "a body that starts with the field's own motion has it outside the region too, where only scattered waves belong: start at rest"
    )]
    InMotion,
}

impl Scene {
    /// The layer around the region through which the field enters, if there is a region, and what is to
    /// be said of it.
    pub(super) fn region_layer(
        &self,
        site: &BoundarySite,
        present: Option<&[bool]>,
    ) -> Result<Option<(ReductionLayer, Remark)>, Error> {
        let region = self.boundary.as_ref().and_then(|b| b.region.as_deref());
        let Some(region) = region else {
            return Ok(None);
        };
        let field = site.field.ok_or(RegionError::NoField)?;
        if self.initial == InitialMotion::Field {
            return Err(RegionError::InMotion.into());
        }
        let elements = ReductionLayer::elements(&self.mesh, region);
        if elements.is_empty() {
            return Err(RegionError::Nothing {
                inside: region.len(),
                of: self.mesh.element_count(),
            }
            .into());
        }
        let inner = self.mesh.nodes_of_elements(region);
        let absorbs = |node: &&u32| site.nodes.binary_search_by_key(*node, |n| n.node).is_ok();
        let on_faces: Vec<&u32> = inner.iter().filter(absorbs).collect();
        if let Some(&&node) = on_faces.first() {
            return Err(RegionError::TouchesFace {
                node: self.mesh.node_tags()[node as usize],
                count: on_faces.len(),
            }
            .into());
        }
        let part = self.part_of_layer(&elements, field, present)?;
        let layer = reduction_layer(&self.mesh, region, &self.parts[part])?;
        let remark = Remark::Region {
            inside: region.len(),
            layer: elements.len(),
        };
        Ok(Some((layer, remark)))
    }

    /// The one part that all elements of a layer belong to, if it is the ground of the field.
    fn part_of_layer(
        &self,
        elements: &[u32],
        field: &dyn IncidentField,
        present: Option<&[bool]>,
    ) -> Result<usize, Error> {
        let owner = self.part_of_elements()?;
        let rims = self.rims()?;
        let first = owner[elements[0] as usize];
        let jointed: Vec<u32> = (self.joints.iter())
            .flat_map(|joint| joint.surface.pairs.iter().flat_map(|pair| pair.nodes))
            .collect();
        for &element in elements {
            let of = owner[element as usize];
            let part = of.map(|of| &self.parts[of]);
            let medium = part.map(|part| part.material.medium());
            let in_rim = of.is_some_and(|of| rims[of].contains(&element));
            let nodes = self.mesh.nodes_of(element);
            let what = if of != first {
                "of another part than the rest"
            } else if medium != Some(field.medium()) {
                "of another medium"
            } else if !in_rim && part.is_some_and(|part| !part.material.is_linear()) {
                "not elastic"
            } else if !in_rim && part.is_some_and(|part| part.damping != Damping::None) {
                "damped"
            } else if present.is_some_and(|present| !present[element as usize]) {
                "not there when the body moves"
            } else if nodes.iter().any(|node| jointed.contains(node)) {
                "at a joint"
            } else {
                continue;
            };
            let element = self.mesh.element_tags()[element as usize];
            return Err(RegionError::OtherGround { element, what }.into());
        }
        first.ok_or_else(|| {
            let element = self.mesh.element_tags()[elements[0] as usize];
            let what = "of no part";
            RegionError::OtherGround { element, what }.into()
        })
    }
}
