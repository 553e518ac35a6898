//! Delayed pairs of nodes: the two sides of a slice, or the two ends of a bay, under waves of any azimuth.

use crate::{Mesh, Vec3};

/// Delayed pairs: nodes of the two sides of a slice along y, of which the side of larger y moves as the other one does, but later.
///
/// A body that does not change along y under a wave `u_f(x, z, t - s y)` moves by `u = U(x, z, t - s y)`, whatever its
/// laws: a shift of the body along y by `d` and in time by `s d` leaves the problem as it is. One slice therefore has
/// the motion of the whole body. Its nodes are at `y -+ h/2` with the displacement `U +- (s h / 2) dU/dt`, so that
/// strains have their part `-s dU/dt` along y; a body of which all nodes are in such pairs is integrated by an
/// [engine](crate::Engine) in the momentum `rho dU/dt + s (s_xy, s_yy, s_yz)`.
///
/// Of a body with further nodes between the two sides these are the ends of one bay of an endless row, which moves by `u = U(x, y, z, t - s y)` with a
/// `U` that repeats at the ends. All nodes have `U` there, and the strain of each element its part `-s dU/dt`.
///
/// In static solutions the nodes of a pair have one motion, as those of [`PeriodicPairs`](crate::PeriodicPairs) do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DelayedPairs {
    /// The node pairs, by mesh index, in any order of their two nodes.
    pub pairs: Vec<(u32, u32)>,
    /// Slowness `s` along y of all motion (s/m), `sin(incidence) sin(azimuth) / c`; negative for waves against y. At
    /// zero the pairs are periodic.
    pub slowness: f64,
    /// Elements in which P waves are faster than the motion along y, or nearly so; empty by default.
    pub stiff: Vec<StiffElements>,
}

impl DelayedPairs {
    /// Whether pairs of a mesh are the ends of a bay of an endless row: some nodes are in none of them, and some lie between the ends of the
    /// mesh along y. Others make a slice.
    pub fn make_bay(mesh: &Mesh, pairs: &[(u32, u32)]) -> bool {
        let (low, high) = mesh.bounding_box();
        let end = Self::AT_END * (high.y - low.y);
        let mut is_paired = vec![false; mesh.node_count()];
        for node in pairs.iter().flat_map(|&(a, b)| [a, b]) {
            if let Some(is_paired) = is_paired.get_mut(node as usize) {
                *is_paired = true;
            }
        }
        let is_between = |node: &Vec3| node.y > low.y + end && node.y < high.y - end;
        is_paired.contains(&false) && mesh.positions().iter().any(is_between)
    }

    /// Distance from an end of a bay, over its length, within which a node is at it.
    pub const AT_END: f64 = 1e-6;
}

/// Elements of a slice in which P waves are faster than the motion along y, or nearly so.
///
/// The strain `-s dU/dt` along y acts as inertia `-s^2 E` per volume, with the modulus `E` of P waves along y and the shear modulus
/// along x and z: more than the density takes. Such elements keep a part of it at their nodes, and the rest is moved to nodes of other
/// elements near by, so that the inertia of the whole is right and that of a lining a little beside its place. Their stress along y is
/// some per cent too large.
#[derive(Clone, Debug, PartialEq)]
pub struct StiffElements {
    /// The elements, by mesh index.
    pub elements: Vec<u32>,
    /// Share (0 to 1) of `s^2 E` that the elements keep at their own nodes, along x and z and along y.
    pub kept: [f64; 2],
}
