//! Every element cut into smaller ones of its kind.

use std::collections::HashMap;

use super::{ElementKind, Facet, Mesh, MeshError, Vec3};

/// Parts of an element that is cut; numbers of elements grow by this factor.
const PARTS: u64 = 8;

/// Nodes of an element between which a new one lies halfway, at its place in the element's list.
type Between = Vec<u8>;

/// The nodes of a whole between which each node of a part lies.
type Part = Vec<Between>;

impl Mesh {
    /// The mesh with every element cut at the middles of its edges: a solid into eight of its kind, a bar
    /// into two.
    ///
    /// The body stays the same: new nodes lie halfway between those of an element, on the sides that it has,
    /// and do not follow what it stands for. Old nodes keep their places and numbers; new ones follow,
    /// numbered from the greatest number on. Element `n` becomes `8 n`, `8 n + 1` and so on. Sets of elements
    /// and facets hold the parts of what they held, sets of nodes also the new nodes between
    /// nodes of theirs that belong to one edge, side or element.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [2, 1, 1], "rock")?;
    /// let fine = mesh.refined()?;
    /// assert_eq!((fine.element_count(), fine.node_count()), (16, 5 * 3 * 3));
    /// assert_eq!(fine.element_set("rock")?.len(), 16);
    /// assert_eq!(fine.facet_set("left")?.len(), 4);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn refined(&self) -> Result<Self, MeshError> {
        let cuts = Cuts::new();
        let mut fine = Self {
            positions: self.positions.clone(),
            node_tags: self.node_tags.clone(),
            offsets: vec![0],
            ..Self::default()
        };
        let mut new = NewNodes::of(self);
        // Where the parts of each element start.
        let mut firsts = Vec::with_capacity(self.element_count());
        for element in 0..self.element_count() as u32 {
            let cut = cuts.of(self, element);
            let tag = self.element_tags[element as usize];
            firsts.push(fine.kinds.len() as u32);
            for (place, part) in cut.parts.iter().enumerate() {
                fine.kinds.push(self.kind(element));
                let number = tag
                    .checked_mul(PARTS)
                    .and_then(|n| n.checked_add(place as u64));
                fine.element_tags.push(number.ok_or(MeshError::TooLarge {
                    what: "as the number of an element",
                    count: tag as usize,
                })?);
                for between in part {
                    let node = new.between(self, element, between, &mut fine.positions);
                    fine.connectivity.push(node);
                }
                fine.offsets.push(fine.connectivity.len() as u32);
            }
            if fine.connectivity.len() >= u32::MAX as usize {
                let (what, count) = ("nodes of elements", fine.connectivity.len());
                return Err(MeshError::TooLarge { what, count });
            }
        }
        let greatest = self.node_tags.iter().copied().max().unwrap_or(0);
        let added = (fine.positions.len() - self.node_count()) as u64;
        fine.node_tags.extend((1..=added).map(|i| greatest + i));
        for (name, elements) in &self.element_sets {
            let parts = elements.iter().flat_map(|&element| {
                let first = firsts[element as usize];
                first..first + cuts.of(self, element).parts.len() as u32
            });
            fine.element_sets.insert(name.clone(), parts.collect());
        }
        for (name, nodes) in &self.node_sets {
            let mut all = nodes.clone();
            all.extend(new.among(nodes));
            fine.node_sets.insert(name.clone(), all);
        }
        for (name, facets) in &self.facet_sets {
            let parts = facets.iter().flat_map(|facet| {
                let first = firsts[facet.element as usize];
                let parts = &cuts.of(self, facet.element).sides[facet.side as usize];
                parts.iter().map(move |&(part, side)| Facet {
                    element: first + part,
                    side,
                })
            });
            let mut parts: Vec<Facet> = parts.collect();
            parts.sort_unstable();
            fine.facet_sets.insert(name.clone(), parts);
        }
        Ok(fine)
    }
}

/// Nodes that stand between others.
struct NewNodes {
    /// Nodes of the mesh before.
    old: usize,
    /// The new node between some of them, in rising order and filled up with `u32::MAX`, which is no node.
    made: HashMap<[u32; 8], u32>,
    /// Between which nodes each of them stands, one after the other.
    parents: Vec<u32>,
    /// Where those of each start, and where the last ones end.
    starts: Vec<usize>,
}

impl NewNodes {
    fn of(mesh: &Mesh) -> Self {
        Self {
            old: mesh.node_count(),
            made: HashMap::new(),
            parents: Vec::new(),
            starts: vec![0],
        }
    }

    /// The node halfway between some of an element's, which is made if it does not stand yet.
    fn between(
        &mut self,
        mesh: &Mesh,
        element: u32,
        between: &[u8],
        positions: &mut Vec<Vec3>,
    ) -> u32 {
        let of_element = mesh.nodes_of(element);
        let mut nodes: Vec<u32> = between.iter().map(|&i| of_element[i as usize]).collect();
        if let [node] = nodes[..] {
            return node;
        }
        // In one order whichever element asks, so that it stands in one place.
        nodes.sort_unstable();
        let mut key = [u32::MAX; 8];
        key[..nodes.len()].copy_from_slice(&nodes);
        if let Some(&node) = self.made.get(&key) {
            return node;
        }
        let new = positions.len() as u32;
        let sum: Vec3 = nodes.iter().map(|&n| mesh.positions[n as usize]).sum();
        positions.push(sum / nodes.len() as f64);
        self.made.insert(key, new);
        self.parents.extend(nodes);
        self.starts.push(self.parents.len());
        new
    }

    /// The new nodes all of whose parents are among some nodes, given and found in rising order.
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

/// How an element is cut.
struct Cut {
    parts: Vec<Part>,
    /// For each side of the whole the sides of parts that lie on it, with the number of the part.
    sides: Vec<Vec<(u32, u8)>>,
}

impl Cut {
    fn new(kind: ElementKind, parts: Vec<Part>) -> Self {
        let lies_on = |part: &Part, side: &[u8], whole: &[u8]| {
            let mut parents = side.iter().flat_map(|&node| &part[node as usize]);
            parents.all(|parent| whole.contains(parent))
        };
        let on_side = |whole: &&[u8]| {
            let of_part = |(place, part): (usize, &Part)| {
                let sides = kind.sides().iter().enumerate();
                let on = sides.filter(|(_, side)| lies_on(part, side, whole));
                on.map(|(side, _)| (place as u32, side as u8)).collect()
            };
            let found: Vec<Vec<(u32, u8)>> = parts.iter().enumerate().map(of_part).collect();
            found.concat()
        };
        Self {
            sides: kind.sides().iter().map(on_side).collect(),
            parts,
        }
    }
}

/// The opposite edges of a tetrahedron. Between the middles of two lies a diagonal of the octahedron that its
/// four corners leave; the other middles stand around it, counter-clockwise seen from the second one, in the
/// order of [`Cuts::around`].
const OPPOSITE_EDGES: [[[u8; 2]; 2]; 3] = [[[0, 1], [3, 2]], [[0, 2], [1, 3]], [[0, 3], [2, 1]]];

/// How elements of all kinds are cut.
struct Cuts {
    hexahedron: Cut,
    wedge: Cut,
    bar: Cut,
    /// With the octahedron cut along each of its diagonals.
    tetrahedron: [Cut; 3],
}

impl Cuts {
    fn new() -> Self {
        let of_corners = |kind| Cut::new(kind, corner_parts(kind));
        let mut wedge = corner_parts(ElementKind::Wedge6);
        for level in [0, 3] {
            // What the corners leave: the triangle of the middles of a triangle's edges.
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
            hexahedron: of_corners(ElementKind::Hex8),
            bar: of_corners(ElementKind::Bar2),
            wedge: Cut::new(ElementKind::Wedge6, wedge),
            tetrahedron: OPPOSITE_EDGES.map(|edges| {
                let parts = corner_parts(ElementKind::Tet4).into_iter();
                Cut::new(
                    ElementKind::Tet4,
                    parts.chain(Self::around(edges)).collect(),
                )
            }),
        }
    }

    /// The four tetrahedra around the diagonal of an octahedron.
    fn around([first, second]: [[u8; 2]; 2]) -> [Part; 4] {
        let ([a, b], [c, d]) = (first, second);
        let ring = [[a, c], [c, b], [b, d], [d, a]];
        [0, 1, 2, 3].map(|i| {
            let part = [first, second, ring[i], ring[(i + 1) % 4]];
            part.map(|edge| edge.to_vec()).to_vec()
        })
    }

    /// How an element is cut; the octahedron in a tetrahedron along its shortest diagonal.
    fn of(&self, mesh: &Mesh, element: u32) -> &Cut {
        match mesh.kind(element) {
            ElementKind::Hex8 => &self.hexahedron,
            ElementKind::Wedge6 => &self.wedge,
            ElementKind::Bar2 => &self.bar,
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
fn corner_parts(kind: ElementKind) -> Vec<Part> {
    let nodes = 0..kind.node_count() as u8;
    // Of which point of each factor (three axes, or a triangle and a line) a node is.
    let point = |node: u8| match kind {
        ElementKind::Hex8 => kind.natural_corners()[node as usize].map(|x| u8::from(x > 0.0)),
        ElementKind::Wedge6 => [node % 3, node / 3, 0],
        ElementKind::Tet4 | ElementKind::Bar2 => [node, 0, 0],
    };
    // The nodes of the smallest edge, side or element that has both.
    let span = |a: u8, b: u8| -> Between {
        let (a, b) = (point(a), point(b));
        let holds = |node: &u8| (0..3).all(|i| [a[i], b[i]].contains(&point(*node)[i]));
        nodes.clone().filter(holds).collect()
    };
    let part = |corner: u8| nodes.clone().map(|node| span(corner, node)).collect();
    nodes.clone().map(part).collect()
}
