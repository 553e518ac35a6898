//! Bays of an endless row under waves of any azimuth.

mod bits;
mod free;
mod free_field;
mod joint;
mod laws;
mod rows;

use powerhouse_model::{Mesh, Vec3};

pub(super) use super::slices::{pairs, rock, slowness, wave};

/// A reproducible number in [-1, 1).
pub(super) fn noise(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

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
