//! Domain reduction region: the free field enters through the layer of elements around it.

use powerhouse_boundary::ReductionLayer;
use powerhouse_model::{BoundarySite, IncidentField};
use thiserror::Error;

use crate::{Error, InitialMotion, Remark, Scene, reduction_layer, remark};
use powerhouse_laws::Damping;

/// Why domain reduction through the layer around a region is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RegionError {
    /// Region in a scene without an incident field.
    #[error("the region is for waves that enter around it, but the scene has no wave")]
    NoField,
    /// Region without a layer of elements around it: it is empty or covers the whole body.
    #[error(
        "the region has {inside} of {of} elements: there must be elements inside and around it"
    )]
    Nothing {
        /// Number of elements of the region.
        inside: usize,
        /// Number of elements of the body.
        of: usize,
    },
    /// Region that reaches the absorbing faces.
    #[error(
        "the region has node {node} on an absorbing face ({count} such nodes): at least one layer of elements must lie between, since these faces absorb scattered waves alone"
    )]
    TouchesFace {
        /// Number of the first such node in the mesh file.
        node: u64,
        /// Number of such nodes.
        count: usize,
    },
    /// Element of the layer that is not elastic, undamped ground of the field's medium: of another part than the rest or
    /// of another medium, not elastic or damped (rims excepted), inactive in the dynamic run, or at a joint.
    #[error(
        "element {element} of the layer around the region is {what}: the layer must be elastic, undamped ground of the field's medium"
    )]
    OtherGround {
        /// Number of the element in the mesh file.
        element: u64,
        /// Its deviation in words.
        what: &'static str,
    },
    /// Initial motion of the free field in a scene with a region.
    #[error(
        "the initial motion of the free field would also be outside the region, where the motion is that of scattered waves: start at rest"
    )]
    InMotion,
}

impl Scene {
    /// Layer around the region through which the field enters, if there is a region, with a remark about it.
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
        field.check_layer(layer.positions(), layer.inner())?;
        let remark = Remark::from(remark::Region {
            inside: region.len(),
            layer: elements.len(),
        });
        Ok(Some((layer, remark)))
    }

    /// Part of all elements of a layer, if it is elastic, undamped ground of the field's medium.
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
            } else if medium != Some(field.medium_at(&self.mesh.centroid(element))) {
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
