//! Solids with repeated nodes, in every format of meshes that has them: how programs write wedges, pyramids and
//! tetrahedra where they have bricks alone.

use powerhouse_model::ElementKind;

/// Largest number of nodes of a solid of first order.
const MOST: usize = 8;

/// Solid that a solid with repeated nodes is, with its nodes in the order of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Collapsed {
    pub(crate) kind: ElementKind,
    nodes: [u64; MOST],
}

impl Collapsed {
    pub(crate) fn nodes(&self) -> &[u64] {
        &self.nodes[..self.kind.node_count()]
    }

    /// Side with the same corners as the side of the solid that it was; none if that has fewer than three.
    #[cfg(any(feature = "inp", test))]
    pub(crate) fn side(&self, was: (ElementKind, &[u64]), side: usize) -> Option<u8> {
        let corners = side_of(was, side);
        let corners = corners.as_slice();
        let sides = self.kind.sides().iter();
        let same = |own: &&[u8]| {
            own.len() == corners.len()
                && own
                    .iter()
                    .all(|&local| corners.contains(&self.nodes[usize::from(local)]))
        };
        sides
            .zip(0..)
            .find(|(own, _)| same(own))
            .map(|(_, side)| side)
    }
}

/// Corners of a side in turn, each once.
#[derive(Clone, Copy, Default)]
struct Corners {
    nodes: [u64; 4],
    count: usize,
}

impl Corners {
    fn as_slice(&self) -> &[u64] {
        &self.nodes[..self.count]
    }
}

fn side_of((kind, nodes): (ElementKind, &[u64]), side: usize) -> Corners {
    let mut corners = Corners::default();
    for &local in kind.sides()[side] {
        let node = nodes[usize::from(local)];
        if !corners.as_slice().contains(&node) {
            corners.nodes[corners.count] = node;
            corners.count += 1;
        }
    }
    corners
}

/// The solid of a brick, wedge or pyramid with repeated nodes; none if its sides bound no solid of a kind.
///
/// The sides, without those that have fewer than three corners, are those of the solid: two triangles and three
/// quadrilaterals of a wedge, four triangles and a quadrilateral of a pyramid, four triangles of a tetrahedron.
pub(crate) fn collapsed(kind: ElementKind, nodes: &[u64]) -> Option<Collapsed> {
    let mut sides = [Corners::default(); 6];
    let mut count = 0;
    for side in 0..kind.sides().len() {
        let corners = side_of((kind, nodes), side);
        if corners.count > 2 {
            sides[count] = corners;
            count += 1;
        }
    }
    let sides = &sides[..count];
    let of = |corners: usize| sides.iter().filter(move |side| side.count == corners);
    let [triangles, quadrilaterals] = [of(3).count(), of(4).count()];
    let apart = |side: &Corners| {
        nodes
            .iter()
            .copied()
            .find(|node| !side.as_slice().contains(node))
    };
    let mut found = [0; MOST];
    let kind = match (triangles, quadrilaterals) {
        (2, 3) => {
            // Seen from outside the first triangle is 0 2 1.
            let first = *of(3).next()?;
            let second = of(3).nth(1)?;
            let [a, b, c, _] = first.nodes;
            for (at, node) in [a, c, b].into_iter().enumerate() {
                let mut beside = of(4).filter_map(|side| {
                    let place = side.as_slice().iter().position(|own| *own == node)?;
                    let next = [side.nodes[(place + 1) % 4], side.nodes[(place + 3) % 4]];
                    next.into_iter()
                        .find(|next| second.as_slice().contains(next))
                });
                found[at] = node;
                found[at + 3] = beside.next()?;
            }
            ElementKind::Wedge6
        }
        (4, 1) => {
            let base = *of(4).next()?;
            let [a, b, c, d] = base.nodes;
            found[..5].copy_from_slice(&[a, d, c, b, apart(&base)?]);
            ElementKind::Pyramid5
        }
        (4, 0) => {
            let base = *of(3).next()?;
            let [a, b, c, _] = base.nodes;
            found[..4].copy_from_slice(&[a, c, b, apart(&base)?]);
            ElementKind::Tet4
        }
        _ => return None,
    };
    let own = &found[..kind.node_count()];
    let is_whole = nodes.iter().all(|node| own.contains(node))
        && (0..own.len()).all(|at| !own[..at].contains(&own[at]));
    let collapsed = Collapsed { kind, nodes: found };
    // Each of its sides is one of the sides that there are.
    let has = |side: usize| {
        let corners = side_of((kind, own), side);
        sides.iter().any(|other| {
            other.count == corners.count
                && corners
                    .as_slice()
                    .iter()
                    .all(|node| other.as_slice().contains(node))
        })
    };
    (is_whole && (0..kind.sides().len()).all(has)).then_some(collapsed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse_model::{Mesh, Vec3};

    /// Volume of an element by the program's own integral.
    fn volume(kind: ElementKind, nodes: &[u64], position: impl Fn(u64) -> Vec3) -> f64 {
        let mut builder = Mesh::builder();
        let mut own = nodes.to_vec();
        own.sort_unstable();
        own.dedup();
        for node in own {
            builder.node(node, position(node));
        }
        builder.element(1, kind, nodes, &["a"]);
        let mesh = builder.build().unwrap();
        mesh.check().unwrap();
        mesh.volume_of(&[0])
    }

    /// Volume within triangulated sides, by the divergence theorem.
    fn within(kind: ElementKind, nodes: &[u64], position: impl Fn(u64) -> Vec3) -> f64 {
        let at = |local: u8| position(nodes[usize::from(local)]);
        let triangles = kind
            .sides()
            .iter()
            .flat_map(|side| (1..side.len() - 1).map(|i| [side[0], side[i], side[i + 1]]));
        let each = triangles.map(|[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0);
        each.sum()
    }

    /// Whatever edge or side of a brick, wedge or pyramid with plane sides is collapsed, the solid has the volume of
    /// the brick within its sides, and its sides are found again.
    #[test]
    fn volumes_and_sides_remain() {
        let cube = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 3.0, 0.0],
            [0.0, 3.0, 0.0],
            [0.0, 0.0, 4.0],
            [2.0, 0.0, 4.0],
            [2.0, 3.0, 4.0],
            [0.0, 3.0, 4.0],
        ];
        let position = |node: u64| Vec3::from(cube[node as usize - 11]);
        let mut kinds = Vec::new();
        let hex: Vec<u64> = (11..19).collect();
        let edges = [
            [0, 1],
            [1, 2],
            [2, 3],
            [3, 0],
            [4, 5],
            [5, 6],
            [6, 7],
            [7, 4],
            [0, 4],
            [1, 5],
            [2, 6],
            [3, 7],
        ];
        let mut cases: Vec<Vec<usize>> = Vec::new();
        for [a, b] in edges {
            // Parallel edges of a side make a wedge; a whole side makes a pyramid; a side and an edge a tetrahedron.
            for side in ElementKind::Hex8.sides() {
                let side: Vec<usize> = side.iter().map(|&local| local.into()).collect();
                if !side.contains(&a) && !side.contains(&b) {
                    let mut to: Vec<usize> = (0..8).collect();
                    side.iter().for_each(|&local| to[local] = side[0]);
                    cases.push(to.clone());
                    to[b] = a;
                    cases.push(to);
                }
                if side.contains(&a) && side.contains(&b) {
                    let mut to: Vec<usize> = (0..8).collect();
                    let rest: Vec<usize> = side
                        .iter()
                        .copied()
                        .filter(|l| *l != a && *l != b)
                        .collect();
                    let near = |l: usize| edges.iter().any(|e| e.contains(&a) && e.contains(&l));
                    let (with_a, with_b) = if near(rest[0]) {
                        (rest[0], rest[1])
                    } else {
                        (rest[1], rest[0])
                    };
                    (to[with_a], to[with_b]) = (a, b);
                    cases.push(to.clone());
                    to[b] = a;
                    to[with_b] = a;
                    to[with_a] = a;
                    cases.push(to);
                }
            }
        }
        for to in cases {
            let nodes: Vec<u64> = to.iter().map(|&local| hex[local]).collect();
            let solid = collapsed(ElementKind::Hex8, &nodes).unwrap_or_else(|| panic!("{nodes:?}"));
            let expected = within(ElementKind::Hex8, &nodes, position);
            let found = volume(solid.kind, solid.nodes(), position);
            assert!(
                (found - expected).abs() < 1e-12 * expected,
                "{nodes:?}: {found} {expected}"
            );
            for side in 0..6 {
                let was = (ElementKind::Hex8, &nodes[..]);
                let corners = side_of(was, side);
                match solid.side(was, side) {
                    None => assert!(corners.count < 3),
                    Some(own) => {
                        let own = side_of((solid.kind, solid.nodes()), own.into());
                        let mut both = [own.as_slice().to_vec(), corners.as_slice().to_vec()];
                        both.iter_mut().for_each(|nodes| nodes.sort_unstable());
                        assert_eq!(both[0], both[1]);
                    }
                }
            }
            kinds.push(solid.kind);
        }
        for kind in [
            ElementKind::Wedge6,
            ElementKind::Pyramid5,
            ElementKind::Tet4,
        ] {
            assert!(kinds.contains(&kind), "{kind:?}");
        }
        // A wedge whose triangles share a corner, and a pyramid with a collapsed edge.
        let wedge = collapsed(ElementKind::Wedge6, &[11, 12, 14, 11, 16, 18]).unwrap();
        assert_eq!(wedge.kind, ElementKind::Pyramid5);
        let tet = collapsed(ElementKind::Pyramid5, &[11, 12, 13, 13, 15]).unwrap();
        assert_eq!(tet.kind, ElementKind::Tet4);
    }

    /// Nodes that bound no solid are refused: a diagonal, a flat element, two sheets.
    #[test]
    fn other_repetitions_are_no_solids() {
        for nodes in [
            [1, 2, 1, 4, 5, 6, 7, 8],
            [1, 2, 3, 4, 1, 2, 3, 4],
            [1, 2, 3, 4, 5, 6, 7, 1],
            [1, 1, 1, 1, 1, 1, 1, 1],
            [1, 2, 3, 4, 4, 3, 2, 1],
            [1, 1, 2, 2, 3, 3, 3, 3],
        ] {
            assert_eq!(collapsed(ElementKind::Hex8, &nodes), None, "{nodes:?}");
        }
        assert_eq!(collapsed(ElementKind::Tet4, &[1, 2, 3, 3]), None);
        // Two triangles and two quadrilaterals.
        assert_eq!(collapsed(ElementKind::Wedge6, &[1, 2, 3, 4, 5, 4]), None);
    }
}
