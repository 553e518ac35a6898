//! Delayed pairs of a model: check, sides, fixed axes.

use powerhouse_model::{
    DelayedPairs, ElementBlock, EngineError, Mat3, Mesh, ModelSpec, PeriodicPairs, Precision, Vec3,
};

use super::linear::inertia_of;
use super::lumping::Rows;
use super::stiff::Stiff;
use super::{Coupling, DelayedSlice, DelayedWork, Lumping};
use crate::node_group::NodeGroup;
use crate::subdomain::Subdomain;

/// Distance of a pair from that of the others, over that distance, above which it is refused.
const TOLERANCE: f64 = 1e-6;
/// Least share of the mass of a node that the slowness may leave.
const LEAST_SHARE: f64 = 0.01;
/// Least and largest number of rows of nodes around stiff elements that take over a part of theirs, and the least share of the mass
/// of a node for which no more of them are taken.
const LEAST_REACH: usize = 3;
const MOST_REACH: usize = 30;
const ENOUGH: f64 = 0.03;

/// Which of x, y and z are fixed.
pub(crate) type Axes = [bool; 3];

fn with(what: impl Into<String>, way: &'static str) -> EngineError {
    EngineError::DelayedWith {
        what: what.into(),
        way,
    }
}

/// Refuses what neither a slice nor a bay takes under waves along y; with a slowness of zero its pairs are periodic, and take all. A bay takes
/// joints and bolts.
pub(crate) fn check_delayed(
    spec: &ModelSpec,
    single: bool,
    is_bay: bool,
) -> Result<(), EngineError> {
    let Some(delayed) = spec.delayed.as_ref().filter(|pairs| pairs.slowness != 0.0) else {
        return Ok(());
    };
    if !delayed.slowness.is_finite() {
        return Err(EngineError::DelayedSlowness {
            slowness: delayed.slowness,
        });
    }
    let alone = "run it in one process, on as many threads as there are";
    let present = [
        (!single, "ranks", alone),
        (
            !is_bay && !spec.constraints.is_empty(),
            "joints",
            "bond what they divide, or take a body with its whole length along y",
        ),
        (
            !is_bay && !spec.embedded.is_empty(),
            "bolts",
            "leave them out, or take a body with its whole length along y",
        ),
        (
            !spec.added_masses.is_empty(),
            "added masses",
            "leave the water beside it out, or take a body with its whole length along y",
        ),
        (
            !spec.prescribed.is_empty(),
            "prescribed motions",
            "let the wave enter through absorbing faces",
        ),
        (
            !(spec.periodic.iter()).all(|pairs| is_bay && is_across(spec.mesh, pairs)),
            "other periodic pairs",
            "absorb at the sides across x; a bay takes pairs of nodes at the same y",
        ),
        (
            (spec.boundaries.iter()).any(|parts| !parts.blocks.is_empty()),
            "boundaries with elements of their own",
            "take a viscous or viscous-spring boundary",
        ),
    ];
    if let Some((_, what, way)) = present.into_iter().find(|(is, ..)| *is) {
        return Err(with(what, way));
    }
    for (_, factory) in &spec.sets {
        let options = factory.options();
        if options.precision != Precision::F64 {
            let what = format!("set '{}' in single or mixed precision", factory.label());
            return Err(with(what, "take double precision"));
        }
        if options.damping.stiffness != 0.0 {
            let what = format!("the stiffness damping of set '{}'", factory.label());
            return Err(with(what, "take mass damping, or none"));
        }
    }
    Ok(())
}

/// Number of the pairs that each node is in.
pub(crate) fn pairs_of_nodes(
    mesh: &Mesh,
    delayed: &DelayedPairs,
) -> Result<Vec<usize>, EngineError> {
    let mut count = vec![0; mesh.node_count()];
    for node in delayed.pairs.iter().flat_map(|&(a, b)| [a, b]) {
        *(count.get_mut(node as usize)).ok_or_else(|| EngineError::UnknownNode {
            part: "a delayed pair".into(),
            node,
            count: mesh.node_count(),
        })? += 1;
    }
    Ok(count)
}

/// Whether all pairs have their two nodes at the same y.
fn is_across(mesh: &Mesh, pairs: &PeriodicPairs) -> bool {
    let nodes = mesh.positions();
    let (low, high) = mesh.bounding_box();
    pairs.pairs.iter().all(|&(a, b)| {
        let at = [a, b].map(|node| nodes.get(node as usize).map(|at| at.y));
        let [Some(a), Some(b)] = at else {
            return true;
        };
        (a - b).abs() <= TOLERANCE * (high.y - low.y)
    })
}

/// The pairs of a slice, each with its node of the smaller y first.
pub(crate) fn pair_up(mesh: &Mesh, delayed: &DelayedPairs) -> Result<DelayedPairs, EngineError> {
    let (nodes, tags) = (mesh.positions(), mesh.node_tags());
    let count = pairs_of_nodes(mesh, delayed)?;
    let mut expected: Option<Vec3> = None;
    let mut pairs = Vec::with_capacity(delayed.pairs.len());
    for &(a, b) in &delayed.pairs {
        let [at_a, at_b] = [a, b].map(|node| nodes[node as usize]);
        let (low, high) = if at_a.y <= at_b.y { (a, b) } else { (b, a) };
        let apart = nodes[high as usize] - nodes[low as usize];
        let wanted = *expected.get_or_insert(Vec3::new(0.0, apart.y, 0.0));
        let far = (apart - wanted).norm();
        let fits = wanted.y > 0.0 && far <= TOLERANCE * wanted.y;
        if !fits {
            return Err(EngineError::DelayedPair {
                first: tags[low as usize],
                second: tags[high as usize],
                expected: wanted.into(),
            });
        }
        pairs.push((low, high));
    }
    match count.iter().position(|&count| count != 1) {
        Some(node) => Err(EngineError::DelayedNode {
            node: tags[node],
            count: count[node],
        }),
        None => Ok(DelayedPairs {
            pairs,
            ..delayed.clone()
        }),
    }
}

impl DelayedSlice {
    /// The slice of ordered pairs, from the groups of a model, each of which has the two nodes of a pair.
    pub(crate) fn new(
        mesh: &Mesh,
        delayed: &DelayedPairs,
        groups: &[NodeGroup],
        subdomain: &Subdomain,
        blocks: &[Box<dyn ElementBlock>],
    ) -> Result<Self, EngineError> {
        let mesh_of = &subdomain.numbering.mesh_of;
        let tag = |node: u32| mesh.node_tags()[mesh_of[node as usize] as usize];
        let height = |node: u32| mesh.positions()[mesh_of[node as usize] as usize].y;
        let mut sides = Vec::with_capacity(groups.len());
        let mut place = vec![(u32::MAX, 0.0); subdomain.node_count()];
        let mut held = Vec::with_capacity(groups.len());
        let mut half = 0.0;
        for (index, group) in (0..).zip(groups) {
            let &[a, b] = &group.members[..] else {
                return Err(EngineError::DelayedNode {
                    node: tag(group.members[0]),
                    count: group.members.len().saturating_sub(1),
                });
            };
            let (low, high) = if height(a) < height(b) {
                (a, b)
            } else {
                (b, a)
            };
            half = 0.5 * (height(high) - height(low));
            sides.push([low, high]);
            place[low as usize] = (index, 1.0);
            place[high as usize] = (index, -1.0);
            held.push(fixed_axes(group).ok_or_else(|| {
                let what = format!("a roller at node {} along no coordinate axis", tag(low));
                with(what, "take rollers normal to x, y or z")
            })?);
            let coupled = [(0, 1), (1, 2)]
                .into_iter()
                .any(|(i, j)| group.dashpot[(i, j)] != 0.0 || group.spring[(i, j)] != 0.0);
            if coupled {
                let what = format!("an impedance at node {} between y and x or z", tag(low));
                return Err(with(what, "absorb at faces parallel to y alone"));
            }
        }
        let rows = Rows::new(blocks, subdomain, &place, half)?;
        let mass: Vec<f64> = groups.iter().map(|group| group.mass).collect();
        let stiff = |reach| Stiff::new(delayed, &rows, &mass, reach);
        let mut slice = Self {
            slowness: delayed.slowness,
            half,
            lumping: Lumping::new(&rows, groups.len(), stiff(LEAST_REACH)),
            coupling: Coupling::new(&rows, groups, delayed.slowness),
            is_linear: blocks.iter().all(|block| {
                let stiffness = block.stiffness();
                stiffness.is_some_and(|stiffness| stiffness.is_linear_elastic())
            }),
            sides,
            place,
            mass: mass.clone(),
            bare: groups.iter().map(is_bare).collect(),
            free: Vec::new(),
            loaded: Vec::new(),
            held,
            is_centred: false,
            motion: None,
            work: DelayedWork::default(),
        };
        for reach in LEAST_REACH + 1..=MOST_REACH {
            if delayed.stiff.is_empty() || slice.least_share().1 >= ENOUGH {
                break;
            }
            slice.lumping.pass_on(stiff(reach));
        }
        let (group, share) = slice.least_share();
        if share.is_nan() || share < LEAST_SHARE {
            return Err(EngineError::DelayedMass {
                node: tag(slice.sides[group][0]),
                slowness: slice.slowness,
                share,
                least: LEAST_SHARE,
                most: slowest(slice.slowness, share, LEAST_SHARE),
            });
        }
        Ok(slice)
    }

    /// The group with the least share of its mass as inertia along any axis (1), and that share; not a number if some share is none.
    fn least_share(&self) -> (usize, f64) {
        let with_mass = (0..self.mass.len()).filter(|group| self.mass[*group] > 0.0);
        let shares = with_mass.map(|group| (group, (self.inertia(group) / self.mass[group]).min()));
        shares
            .reduce(|a, b| if b.1 < a.1 || b.1.is_nan() { b } else { a })
            .unwrap_or((0, 1.0))
    }

    /// Inertia of a group (kg) along each axis, `M - s^2 A`.
    pub(crate) fn inertia(&self, group: usize) -> Vec3 {
        inertia_of(
            self.mass[group],
            self.lumping.rigidity(group),
            self.slowness,
        )
    }
}

/// Whether a group has a mass and fixed directions alone.
fn is_bare(group: &NodeGroup) -> bool {
    let matrices = [&group.dashpot, &group.spring, &group.gyroscopic];
    group.mass_damping == 0.0 && matrices.into_iter().all(|matrix| *matrix == Mat3::zeros())
}

/// Components of a unit vector below which it is along an axis: rounding of normals of facets.
const ALONG: f64 = 1e-9;

/// The fixed axes of a group; none if a fixed direction is no coordinate axis.
fn fixed_axes(group: &NodeGroup) -> Option<Axes> {
    let mut held = [false; 3];
    for direction in group.condition.directions() {
        let axis = direction.iamax();
        if direction.abs().sum() - direction[axis].abs() > ALONG {
            return None;
        }
        held[axis] = true;
    }
    Some(held)
}

/// Slowness at which a share of a mass is left, where `share` is left at `slowness`: what is lost grows with its square.
pub(crate) fn slowest(slowness: f64, share: f64, least: f64) -> f64 {
    slowness * ((1.0 - least) / (1.0 - share)).sqrt()
}
