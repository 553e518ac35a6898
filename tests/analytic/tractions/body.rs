//! Boxes of bricks cut open by a joint of some shape, anyhow turned.

use nalgebra::Rotation3;
use powerhouse_contact::{JointSurface, SurfaceOptions};
use powerhouse_model::{Mesh, Vec3};

/// Shape of the joint of a box, whose bricks are unit cubes around the origin before they are mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cut {
    /// A plane through the whole box that dips by an angle (degrees) along x; all layers of bricks dip with it.
    Plane { dip: f64 },
    /// The four sides of a prism along y, whose ends lie in faces of the box.
    Block,
    /// A prism of eight sides in place of four.
    Octagon,
    /// Two planes that meet at an edge.
    Edge,
    /// All six sides of a block inside.
    Closed,
}

impl Cut {
    pub(crate) const ALL: [Self; 9] = [
        Self::Plane { dip: 0.0 },
        Self::Plane { dip: 10.0 },
        Self::Plane { dip: 30.0 },
        Self::Plane { dip: 60.0 },
        Self::Plane { dip: 80.0 },
        Self::Block,
        Self::Octagon,
        Self::Edge,
        Self::Closed,
    ];

    /// Whether a brick with its centre at a place is on the first side.
    fn is_first(self, at: &Vec3) -> bool {
        match self {
            Self::Plane { .. } => at.z < 0.0,
            Self::Block | Self::Octagon => at.x.abs() > 2.0 || at.z.abs() > 2.0,
            Self::Edge => at.x < 0.0 || at.z < 0.0,
            Self::Closed => at.amax() > 1.0,
        }
    }

    /// Place of a node of bricks of a size (m).
    fn place(self, at: &Vec3, brick: &Vec3) -> Vec3 {
        let mut place = at.component_mul(brick);
        match self {
            Self::Plane { dip } => place.z -= place.x * dip.to_radians().tan(),
            Self::Octagon => {
                let (x, z) = (at.x.abs(), at.z.abs());
                let (most, least) = (x.max(z), x.min(z));
                let corner = (least / most.max(1e-9) - 0.5).max(0.0);
                let near = if most <= 2.0 { most / 2.0 } else { 3.0 - most };
                let share = 1.0 - 0.5 * corner * near.max(0.0);
                (place.x, place.z) = (place.x * share, place.z * share);
            }
            _ => {}
        }
        place
    }
}

/// A body with a joint, and the element sets `first` and `second` of both sides.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) surface: JointSurface,
    /// Orthonormal directions of its own axes.
    pub(crate) axes: [Vec3; 3],
    /// Places of the nodes in units of bricks, before they are mapped.
    unmapped: Vec<Vec3>,
    half: Vec3,
}

impl Body {
    /// A box of bricks of a size (m), with some of them from its middle to its faces; its axes are turned as a rotation
    /// vector (rad) says.
    pub(crate) fn new(cut: Cut, half: [usize; 3], brick: Vec3, turn: &Vec3) -> Self {
        let extent = Vec3::from_fn(|i, _| half[i] as f64);
        let cells = half.map(|count| 2 * count);
        let mesh = Mesh::box_of_hexes(-extent, extent, cells, "all").unwrap();
        let all = 0..mesh.element_count() as u32;
        let (first, second): (Vec<u32>, Vec<u32>) =
            all.partition(|&element| cut.is_first(&mesh.centroid(element)));
        let split = mesh.split_between(&first, &second).unwrap();
        let unmapped = split.mesh.positions().to_vec();
        let rotation = Rotation3::new(*turn);
        let place = |at| rotation * cut.place(&at, &brick);
        let mut mesh = split.mesh.map_positions(place).unwrap();
        mesh.set_element_set("first", first).unwrap();
        mesh.set_element_set("second", second).unwrap();
        let options = SurfaceOptions::within(1e-6 * brick.max()).unwrap();
        let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
        Self {
            surface,
            axes: [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| rotation * axis),
            unmapped,
            half: extent,
            mesh,
        }
    }

    /// Nodes of the faces across an own axis: the lower one, the upper one or both.
    pub(crate) fn faces(&self, axis: usize, sides: &[f64]) -> Vec<u32> {
        let on = |node: &u32| {
            let at = self.unmapped[*node as usize][axis];
            sides
                .iter()
                .any(|side| (at - side * self.half[axis]).abs() < 1e-9)
        };
        (0..self.unmapped.len() as u32).filter(on).collect()
    }

    /// All nodes of the faces, each once.
    pub(crate) fn outside(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = (0..3)
            .flat_map(|axis| self.faces(axis, &[-1.0, 1.0]))
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}
