//! Element layer of the domain reduction method, built from a part of a scene.

use powerhouse_boundary::{BoundaryError, ReductionLayer};
use powerhouse_model::{BlockOptions, BlockPart, Mesh, ModelError};

use crate::{Error, Kernel, Part};

/// Element layer of the domain reduction method around a region of a mesh (element indices), elastic and undamped,
/// with the kernel and medium of a part.
///
/// # Errors
/// Elements of a kind without kernel, of more than one kind, or of a shape that the kernel rejects; a region without
/// surrounding elements.
pub fn reduction_layer(mesh: &Mesh, inside: &[u32], part: &Part) -> Result<ReductionLayer, Error> {
    let elements = ReductionLayer::elements(mesh, inside);
    let nothing = BoundaryError::Layer {
        expected: 0,
        found: 0,
    };
    let first = elements.first().ok_or(nothing).map_err(ModelError::from)?;
    let kernel = part.kernel_for(mesh.kind(*first));
    let taken = kernel.as_ref().map(Kernel::kind);
    let other = elements.iter().find(|&&e| Some(mesh.kind(e)) != taken);
    let (Some(kernel), None) = (kernel, other) else {
        let element = *other.unwrap_or(first);
        return Err(Error::NoKernel {
            element: mesh.element_tags()[element as usize],
            set: part.set.clone(),
            kind: mesh.kind(element).name(),
        });
    };
    let nodes = mesh.nodes_of_elements(&elements);
    let factory = kernel.factory(&part.set, &part.material.elastic(), BlockOptions::default());
    let block = factory.build(&BlockPart::new(mesh, &elements, &nodes))?;
    let layer = ReductionLayer::new(mesh, inside, block.as_ref());
    Ok(layer.map_err(ModelError::from)?)
}
