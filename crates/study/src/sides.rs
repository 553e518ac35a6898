//! Transfer of the supports of a box's sides to the sides of another box.

use std::collections::HashSet;

use powerhouse::engine::{PeriodicPairs, Support};
use powerhouse::model::{Mesh, ModelError};
use powerhouse::{Error, Scene};

use crate::StudyError;

/// Names of the sides of a box mesh, their axis, and whether they are the upper side.
const SIDES: [(&str, usize, bool); 6] = [
    ("left", 0, false),
    ("right", 0, true),
    ("front", 1, false),
    ("back", 1, true),
    ("bottom", 2, false),
    ("top", 2, true),
];
/// Tolerance for nodes on a side, over the diagonal of the box.
const TOLERANCE: f64 = 1e-6;

/// Supports and periodic pairs of the sides of a box that do not absorb.
#[derive(Clone, Debug, Default)]
pub(crate) struct SideSupports {
    pub(crate) supports: Vec<Support>,
    pub(crate) periodic: Vec<PeriodicPairs>,
    /// Delayed sides of a slice.
    pub(crate) delayed: Option<PeriodicPairs>,
}

/// Names the sides of a box after the scene's absorbing faces on them, and transfers supports and periodic pairs of
/// whole sides.
pub(crate) fn transfer_supports(
    scene: &Scene,
    ground: &mut Mesh,
) -> Result<SideSupports, StudyError> {
    let absorbing = name_faces(scene, ground)?;
    let mut held = SideSupports::default();
    let mut paired = [false; 3];
    for (side, &(face, axis, upper)) in SIDES[..5].iter().enumerate() {
        if absorbing[side] {
            continue;
        }
        let nodes = nodes_on(scene.mesh(), axis, upper);
        let there = nodes_on(ground, axis, upper);
        let holds = |of: &[u32]| {
            let of: HashSet<u32> = of.iter().copied().collect();
            nodes.iter().all(|node| of.contains(node))
        };
        let supports = scene.supports().iter();
        let supports: Vec<Support> = supports
            .filter(|support| holds(support.nodes()))
            .map(|support| support.on(there.clone()))
            .collect();
        let is_paired = |pairs: &&PeriodicPairs| {
            let both = pairs.pairs.iter().flat_map(|&(from, to)| [from, to]);
            holds(&both.collect::<Vec<u32>>())
        };
        let delayed = scene.delayed_sides().is_some_and(|pairs| is_paired(&pairs));
        let pairs = delayed || scene.periodic_pairs().iter().any(|pairs| is_paired(&pairs));
        if pairs && !paired[axis] {
            paired[axis] = true;
            let opposite = nodes_on(ground, axis, !upper);
            let (low, high) = ground.bounding_box();
            let tolerance = TOLERANCE * (high - low).norm();
            let pairs = PeriodicPairs::by_translation(ground, &there, &opposite, tolerance);
            let pairs = pairs.map_err(|error| Error::from(ModelError::from(error)))?;
            if delayed {
                held.delayed = Some(pairs)
            } else {
                held.periodic.push(pairs)
            }
        }
        if supports.is_empty() && !pairs {
            return Err(StudyError::OpenFace { face });
        }
        held.supports.extend(supports);
    }
    Ok(held)
}

/// The nodes on a side of a mesh's box.
fn nodes_on(mesh: &Mesh, axis: usize, upper: bool) -> Vec<u32> {
    let (low, high) = mesh.bounding_box();
    let plane = if upper { high[axis] } else { low[axis] };
    let tolerance = TOLERANCE * (high - low).norm();
    let nodes = mesh.positions().iter().enumerate();
    nodes
        .filter(|(_, position)| (position[axis] - plane).abs() <= tolerance)
        .map(|(node, _)| node as u32)
        .collect()
}

/// Names the sides of a box after the scene's absorbing faces on them; returns which sides absorb.
fn name_faces(scene: &Scene, ground: &mut Mesh) -> Result<[bool; SIDES.len()], StudyError> {
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let tolerance = TOLERANCE * (high - low).norm();
    let original = ground.clone();
    let mut covered = [false; SIDES.len()];
    for (face, facets) in scene.absorbing_facets().map_err(Error::from)? {
        let mut sides = [false; SIDES.len()];
        for &facet in facets {
            let centre = mesh.facet_geometry(facet).centroid;
            let side = SIDES.iter().position(|&(_, axis, upper)| {
                let plane = if upper { high[axis] } else { low[axis] };
                (centre[axis] - plane).abs() <= tolerance
            });
            let side = side.ok_or_else(|| StudyError::ObliqueFace { face: face.into() })?;
            (sides[side], covered[side]) = (true, true);
        }
        let mut of_face = Vec::new();
        for ((name, ..), _) in SIDES.iter().zip(sides).filter(|(_, on)| *on) {
            of_face.extend_from_slice(original.facet_set(name).map_err(Error::from)?);
        }
        ground.set_facet_set(face, of_face).map_err(Error::from)?;
    }
    Ok(covered)
}
