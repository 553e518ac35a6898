//! Bays of an endless row under waves of any azimuth.

mod bits;
mod bonded;
mod cracked;
mod free;
mod free_field;
mod joint;
mod laws;
mod rows;

use powerhouse_model::{Mesh, Vec3};

use super::slices::noise;
pub(super) use super::slices::{brittle, pairs, rock, slowness, wave, yielding};

/// A box of elements around (0, 0, z) with its inner nodes moved by a share of the edges.
pub(super) fn bent(high: Vec3, counts: [usize; 3], share: f64, seed: u64) -> Mesh {
    let low = Vec3::new(-high.x, -high.y, -2.0 * high.z);
    let top = Vec3::new(high.x, high.y, 0.0);
    let edges = Vec3::from_fn(|c, _| (top - low)[c] / counts[c] as f64);
    let mesh = Mesh::box_of_hexes(low, top, counts, "rock").unwrap();
    let map = |x: Vec3| {
        let inside = (0..3).all(|c| x[c] - low[c] > 1e-6 && top[c] - x[c] > 1e-6);
        let place = x.component_div(&edges).map(|i| i.round());
        let place = (place.x * 10_007.0 + place.y * 101.0 + place.z) as i64 as u64;
        let moved = Vec3::from_fn(|c, _| noise(seed ^ (place.wrapping_mul(4) + c as u64)));
        x + moved.component_mul(&edges) * (share * f64::from(inside))
    };
    mesh.map_positions(map).unwrap()
}
