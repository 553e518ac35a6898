//! Uniform refinement: every element divided into smaller ones of its kind.

use std::collections::HashMap;
use std::sync::Arc;

use super::{ElementKind, Facet, Mesh, MeshError, Vec3};

impl Mesh {
    /// The uniformly refined mesh: every solid element divided at the midpoints of its edges into eight of its kind, and
    /// every bar along an edge of a solid into two.
    ///
    /// The geometry of the body is unchanged: new nodes are midpoints of the element's nodes and are not projected
    /// onto curved surfaces. Old nodes keep their indices and numbers; new ones follow,
    /// numbered from the greatest number on. The numbers of the parts of an element are its number with a leading
    /// digit: in a mesh with numbers up to 15840, number 12 becomes 100012 to 800012, so that no old number is that of a
    /// new element. Element and facet sets contain the parts of their members, node sets also the new
    /// nodes whose parent nodes, on one edge, side or element, are all members.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`], [`MeshError::Numbers`].
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [2, 1, 1], "rock")?;
    /// let fine = mesh.refined()?;
    /// assert_eq!((fine.element_count(), fine.node_count()), (16, 5 * 3 * 3));
    /// assert_eq!(fine.element_tags()[8..10], [12, 22]);
    /// assert_eq!(fine.element_set("rock")?.len(), 16);
    /// assert_eq!(fine.facet_set("left")?.len(), 4);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn refined(&self) -> Result<Self, MeshError> {
        let divided = |element: &u32| {
            let kind = self.kind(*element);
            !matches!(kind, ElementKind::Pyramid5 | ElementKind::Tet10)
        };
        if let Some(element) = (0..self.element_count() as u32).find(|e| !divided(e)) {
            return Err(MeshError::NotDivided {
                element: self.element_tags[element as usize],
                kind: self.kind(element).name(),
            });
        }
        let subdivisions = Subdivisions::new();
        self.check_refined_size(&subdivisions)?;
        let stride = self.number_stride()?;
        let mut new = NewNodes::of(self);
        // Nodes of the parts of all solids: bars are divided where these have a node.
        let mut of_solids = Vec::new();
        for element in self.solids() {
            let subdivision = subdivisions.of(self, element);
            let points = new.points_of(self, element, subdivision);
            let corners = subdivision.parts.iter().flatten();
            of_solids.extend(corners.map(|&point| points[point as usize]));
        }
        let mut fine = Self {
            positions: self.positions.clone(),
            node_tags: self.node_tags.clone(),
            offsets: vec![0].into(),
            ..Self::default()
        };
        let mut of_solids = of_solids.into_iter();
        // First part of each element, and the number of all parts at the end.
        let mut firsts = vec![0];
        for element in 0..self.element_count() as u32 {
            let kind = self.kind(element);
            let nodes = self.nodes_of(element);
            let parts: Vec<u32> = match kind {
                ElementKind::Bar2 => match new.middle(nodes) {
                    Some(middle) => vec![nodes[0], middle, middle, nodes[1]],
                    None => nodes.to_vec(),
                },
                _ => {
                    let corners = subdivisions.of(self, element).parts.iter().map(Vec::len);
                    of_solids.by_ref().take(corners.sum()).collect()
                }
            };
            let tag = self.element_tags[element as usize];
            for (part, corners) in (1..).zip(parts.chunks(kind.node_count())) {
                fine.kinds.push(kind);
                fine.element_tags.push(tag + part * stride);
                fine.connectivity.extend(corners.iter().copied());
                fine.offsets.push(fine.connectivity.len() as u32);
            }
            firsts.push(fine.kinds.len() as u32);
        }
        let greatest = self.node_tags.iter().copied().max().unwrap_or(0);
        let added = new.positions.len() as u64;
        let last = greatest
            .checked_add(added)
            .ok_or(MeshError::Numbers { what: "node" })?;
        fine.node_tags
            .extend((greatest..last).map(|number| number + 1));
        self.refine_sets(&mut fine, &subdivisions, &firsts, &new)?;
        fine.positions.extend(new.positions);
        Ok(fine)
    }

    fn solids(&self) -> impl Iterator<Item = u32> {
        (0..self.element_count() as u32).filter(|&element| self.kind(element).is_solid())
    }

    /// Refuses refined meshes whose element corners exceed the range of indices.
    fn check_refined_size(&self, subdivisions: &Subdivisions) -> Result<(), MeshError> {
        let corners = |element| {
            let parts = subdivisions.of(self, element).parts.iter();
            parts.map(Vec::len).sum::<usize>()
        };
        let count: usize = (0..self.element_count() as u32).map(corners).sum();
        // There are no more new nodes than corners.
        if count + self.node_count() < u32::MAX as usize {
            Ok(())
        } else {
            Err(MeshError::TooLarge {
                what: "corners of smaller elements",
                count,
            })
        }
    }

    /// Least power of ten above all element numbers, such that a leading digit fits 64 bits.
    fn number_stride(&self) -> Result<u64, MeshError> {
        let greatest = self.element_tags.iter().copied().max().unwrap_or(0);
        let fits = |stride: &u64| *stride < u64::MAX / 10;
        let mut powers = (0..)
            .map_while(|power| 10_u64.checked_pow(power))
            .take_while(fits);
        let stride = powers.find(|stride| *stride > greatest);
        stride.ok_or(MeshError::Numbers { what: "element" })
    }

    /// Transfers the sets of the mesh to the parts of its elements, whose indices start at `firsts`.
    fn refine_sets(
        &self,
        fine: &mut Self,
        subdivisions: &Subdivisions,
        firsts: &[u32],
        new: &NewNodes,
    ) -> Result<(), MeshError> {
        for (name, elements) in &*self.element_sets {
            let parts = |&element: &u32| firsts[element as usize]..firsts[element as usize + 1];
            let all = elements.iter().flat_map(parts).collect();
            Arc::make_mut(&mut fine.element_sets).insert(name.clone(), all);
        }
        for (name, nodes) in &*self.node_sets {
            let mut all = nodes.clone();
            all.extend(new.among(nodes));
            Arc::make_mut(&mut fine.node_sets).insert(name.clone(), all);
        }
        for (name, facets) in &*self.facet_sets {
            let parts = facets.iter().flat_map(|facet| {
                let first = firsts[facet.element as usize];
                let subdivision = subdivisions.of(self, facet.element);
                let parts = &subdivision.sides[facet.side as usize];
                parts.iter().map(move |&(part, side)| Facet {
                    element: first + part,
                    side,
                })
            });
            fine.set_facet_set(name, parts.collect())?;
        }
        Ok(())
    }
}

/// New nodes, at midpoints of their parent nodes.
struct NewNodes {
    /// Number of nodes of the coarse mesh.
    old: usize,
    positions: Vec<Vec3>,
    /// The new node of an edge or side, by its parent nodes in rising order, filled up with `u32::MAX`.
    shared: HashMap<[u32; 4], u32>,
    /// Parent nodes of all new nodes, as a flat list.
    parents: Vec<u32>,
    /// Start of the parents of each new node, and the length of the list at the end.
    starts: Vec<usize>,
}

impl NewNodes {
    fn of(mesh: &Mesh) -> Self {
        // A mesh of bricks has about three edges and three sides to each.
        let count = 6 * mesh.element_count();
        Self {
            old: mesh.node_count(),
            positions: Vec::with_capacity(count),
            shared: HashMap::with_capacity(count),
            parents: Vec::with_capacity(3 * count),
            starts: vec![0],
        }
    }

    /// The nodes at the points of a divided element; new ones are created.
    fn points_of(&mut self, mesh: &Mesh, element: u32, subdivision: &Subdivision) -> Vec<u32> {
        let of_element = mesh.nodes_of(element);
        let point = |parents: &Parents| {
            let mut nodes: Vec<u32> = parents.iter().map(|&i| of_element[i as usize]).collect();
            if let [node] = nodes[..] {
                return node;
            }
            // Summed in the same order for every element, so that the position is the same.
            nodes.sort_unstable();
            let key = key_of(&nodes);
            if let Some(&node) = key.as_ref().and_then(|key| self.shared.get(key)) {
                return node;
            }
            let new = (self.old + self.positions.len()) as u32;
            let sum: Vec3 = nodes.iter().map(|&n| mesh.positions[n as usize]).sum();
            self.positions.push(sum / nodes.len() as f64);
            if let Some(key) = key {
                self.shared.insert(key, new);
            }
            self.parents.extend(nodes);
            self.starts.push(self.parents.len());
            new
        };
        subdivision.points.iter().map(point).collect()
    }

    /// The node at the midpoint of an edge, if there is one.
    fn middle(&self, ends: &[u32]) -> Option<u32> {
        let mut ends = ends.to_vec();
        ends.sort_unstable();
        self.shared.get(&key_of(&ends)?).copied()
    }

    /// The new nodes whose parents are all among some nodes; both in rising order.
    fn among(&self, nodes: &[u32]) -> impl Iterator<Item = u32> {
        let mut is_among = vec![false; self.old];
        for &node in nodes {
            is_among[node as usize] = true;
        }
        self.starts
            .windows(2)
            .enumerate()
            .filter_map(move |(i, ends)| {
                let parents = &self.parents[ends[0]..ends[1]];
                let all = parents.iter().all(|&parent| is_among[parent as usize]);
                all.then_some((self.old + i) as u32)
            })
    }
}

/// Key of the sorted nodes of an edge or side; none for those of a whole element, whose midpoint is not shared.
fn key_of(sorted: &[u32]) -> Option<[u32; 4]> {
    let mut key = [u32::MAX; 4];
    key.get_mut(..sorted.len())?.copy_from_slice(sorted);
    Some(key)
}

/// Local nodes of an element whose midpoint is a point of its subdivision, in rising order; one for the node itself.
type Parents = Vec<u8>;

/// Subdivision of an element into parts of its kind.
struct Subdivision {
    /// Points at which the parts have nodes.
    points: Vec<Parents>,
    /// Indices of the points of the nodes of each part.
    parts: Vec<Vec<u8>>,
    /// For each side of the element the sides of parts on it, as index of the part and side.
    sides: Vec<Vec<(u32, u8)>>,
}

impl Subdivision {
    fn new(kind: ElementKind, mut parts: Vec<Vec<Parents>>) -> Self {
        for parents in parts.iter_mut().flatten() {
            parents.sort_unstable();
        }
        let mut points: Vec<Parents> = parts.iter().flatten().cloned().collect();
        points.sort_unstable();
        points.dedup();
        let lies_on = |part: &[Parents], side: &[u8], whole: &[u8]| {
            let mut parents = side.iter().flat_map(|&node| &part[node as usize]);
            parents.all(|parent| whole.contains(parent))
        };
        let on_side = |whole: &&[u8]| {
            let of_part = |(index, part): (usize, &Vec<Parents>)| {
                let sides = kind.sides().iter().enumerate();
                let on = sides.filter(|(_, side)| lies_on(part, side, whole));
                on.map(|(side, _)| (index as u32, side as u8)).collect()
            };
            let found: Vec<Vec<(u32, u8)>> = parts.iter().enumerate().map(of_part).collect();
            found.concat()
        };
        let sides = kind.sides().iter().map(on_side).collect();
        let index = |point: &Parents| points.partition_point(|other| other < point) as u8;
        let parts = parts.iter().map(|part| part.iter().map(index).collect());
        Self {
            sides,
            parts: parts.collect(),
            points,
        }
    }
}

/// The pairs of opposite edges of a tetrahedron. The midpoints of a pair are the ends of a diagonal of the octahedron
/// that remains without the four corners; the other midpoints surround it, counter-clockwise seen from the second end, in
/// the order of [`Subdivisions::around`].
const OPPOSITE_EDGES: [[[u8; 2]; 2]; 3] = [[[0, 1], [3, 2]], [[0, 2], [1, 3]], [[0, 3], [2, 1]]];

/// Subdivisions of all element kinds.
struct Subdivisions {
    hexahedron: Subdivision,
    wedge: Subdivision,
    bar: Subdivision,
    /// With the octahedron divided along each of its diagonals.
    tetrahedron: [Subdivision; 3],
}

impl Subdivisions {
    fn new() -> Self {
        let mut wedge = corner_parts(ElementKind::Wedge6);
        for level in [0, 3] {
            // The remainder without the corners: the triangle of the midpoints of a triangle's edges.
            let node = |n: u8| {
                let edge = [(n + 1) % 3, (n + 2) % 3];
                let levels: &[u8] = if n / 3 == level / 3 {
                    &[level]
                } else {
                    &[0, 3]
                };
                let at = |level: &u8| edge.map(|corner| corner + level);
                levels.iter().flat_map(at).collect()
            };
            wedge.push((0..6).map(node).collect());
        }
        Self {
            hexahedron: Subdivision::new(ElementKind::Hex8, corner_parts(ElementKind::Hex8)),
            wedge: Subdivision::new(ElementKind::Wedge6, wedge),
            bar: Subdivision::new(ElementKind::Bar2, corner_parts(ElementKind::Bar2)),
            tetrahedron: OPPOSITE_EDGES.map(|edges| {
                let parts = corner_parts(ElementKind::Tet4).into_iter();
                Subdivision::new(
                    ElementKind::Tet4,
                    parts.chain(Self::around(edges)).collect(),
                )
            }),
        }
    }

    /// The four tetrahedra around the diagonal of an octahedron.
    fn around([first, second]: [[u8; 2]; 2]) -> [Vec<Parents>; 4] {
        let ([a, b], [c, d]) = (first, second);
        let ring = [[a, c], [c, b], [b, d], [d, a]];
        [0, 1, 2, 3].map(|i| {
            let part = [first, second, ring[i], ring[(i + 1) % 4]];
            part.map(|edge| edge.to_vec()).to_vec()
        })
    }

    /// The subdivision of an element; the octahedron in a tetrahedron is divided along its shortest diagonal.
    fn of(&self, mesh: &Mesh, element: u32) -> &Subdivision {
        match mesh.kind(element) {
            ElementKind::Hex8 => &self.hexahedron,
            ElementKind::Wedge6 => &self.wedge,
            // Kinds without a subdivision are refused before.
            ElementKind::Bar2 | ElementKind::Pyramid5 | ElementKind::Tet10 => &self.bar,
            ElementKind::Tet4 => {
                let nodes = mesh.nodes_of(element);
                let at = |corner: u8| mesh.positions[nodes[corner as usize] as usize];
                let length = |way: usize| {
                    let [[a, b], [c, d]] = OPPOSITE_EDGES[way];
                    (at(a) + at(b) - at(c) - at(d)).norm_squared()
                };
                let shortest = (0..3).min_by(|&i, &j| length(i).total_cmp(&length(j)));
                &self.tetrahedron[shortest.unwrap_or(0)]
            }
        }
    }
}

/// The part at each corner of an element: the element itself, half as large, with that corner in common.
fn corner_parts(kind: ElementKind) -> Vec<Vec<Parents>> {
    let nodes = 0..kind.node_count() as u8;
    // The point of each factor (three axes, or a triangle and a line) of which a node is the product.
    let point = |node: u8| match kind {
        ElementKind::Hex8 => kind.natural_corners()[node as usize].map(|x| u8::from(x > 0.0)),
        ElementKind::Wedge6 => [node % 3, node / 3, 0],
        _ => [node, 0, 0],
    };
    // The nodes of the smallest edge, side or element that contains both.
    let span = |a: u8, b: u8| -> Parents {
        let (a, b) = (point(a), point(b));
        let holds = |node: &u8| (0..3).all(|i| [a[i], b[i]].contains(&point(*node)[i]));
        nodes.clone().filter(holds).collect()
    };
    let part = |corner: u8| nodes.clone().map(|node| span(corner, node)).collect();
    nodes.clone().map(part).collect()
}
