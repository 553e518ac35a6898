//! Elimination order of the unknowns by nested dissection.

use powerhouse_model::Vec3;

/// Number of nodes below which a part is not bisected further, because it fills like a dense block anyway.
const SMALL: usize = 64;

/// Adjacency of nodes that share an element, by index, as offsets and a flat list.
pub(super) struct Neighbours {
    pub(super) starts: Vec<usize>,
    pub(super) nodes: Vec<u32>,
}

impl Neighbours {
    fn of(&self, node: u32) -> &[u32] {
        &self.nodes[self.starts[node as usize]..self.starts[node as usize + 1]]
    }
}

/// Node indices in an elimination order with little fill: nested dissection.
///
/// A part is bisected across the axis with the smallest separator; the separator
/// comes last, after both halves, which are ordered likewise. George (1973), *SIAM J. Numer. Anal.*
/// 10(2), 345-363, for grids; here the plane is placed by coordinates and the separator taken from
/// the graph, so that the order is valid for any mesh and good for compact ones.
pub(super) fn order(positions: &[Vec3], neighbours: &Neighbours) -> Vec<u32> {
    let mut nodes: Vec<u32> = (0..positions.len() as u32).collect();
    let mut bisection = Bisection {
        positions,
        neighbours,
        side: vec![Side::Outside; positions.len()],
    };
    bisection.dissect(&mut nodes);
    nodes
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Outside,
    Low,
    High,
    Between,
}

/// A part under bisection.
struct Bisection<'a> {
    positions: &'a [Vec3],
    neighbours: &'a Neighbours,
    /// Side of each node in the present bisection.
    side: Vec<Side>,
}

impl Bisection<'_> {
    /// Sorts the nodes of a part into the elimination order.
    fn dissect(&mut self, nodes: &mut [u32]) {
        if nodes.len() <= SMALL {
            return;
        }
        let sizes = [0, 1, 2].map(|axis| self.bisect(nodes, axis));
        let sizes = sizes.into_iter().enumerate();
        let best = sizes.filter_map(|(axis, size)| Some((size?, axis))).min();
        let Some((_, axis)) = best else {
            // All nodes have the same position.
            return;
        };
        self.bisect(nodes, axis);
        let rank = |side: Side| match side {
            Side::Low => 0_u8,
            Side::High | Side::Outside => 1,
            Side::Between => 2,
        };
        nodes.sort_by_key(|&node| rank(self.side[node as usize]));
        let count = |wanted: Side| {
            let of_side = nodes.iter().filter(|&&n| self.side[n as usize] == wanted);
            of_side.count()
        };
        let (low, high) = (count(Side::Low), count(Side::High));
        for &node in nodes.iter() {
            self.side[node as usize] = Side::Outside;
        }
        let (low, rest) = nodes.split_at_mut(low);
        self.dissect(low);
        self.dissect(&mut rest[..high]);
    }

    /// Marks the sides of a bisection across an axis; returns the number of nodes of the separator, or none
    /// if all nodes lie in one plane.
    fn bisect(&mut self, nodes: &mut [u32], axis: usize) -> Option<usize> {
        let along = |node: u32| self.positions[node as usize][axis];
        let half = nodes.len() / 2;
        let order = |a: &u32, b: &u32| along(*a).total_cmp(&along(*b)).then(a.cmp(b));
        let (_, &mut middle, _) = nodes.select_nth_unstable_by(half, order);
        let mut plane = along(middle);
        if !nodes.iter().any(|&node| along(node) < plane) {
            // More than half of the nodes lie in the first plane.
            let above = nodes.iter().map(|&node| along(node));
            plane = above.filter(|&x| x > plane).min_by(f64::total_cmp)?;
        }
        for &node in nodes.iter() {
            let low = along(node) < plane;
            self.side[node as usize] = if low { Side::Low } else { Side::High };
        }
        let mut between = 0;
        for &node in nodes.iter() {
            let touches = |other: &u32| self.side[*other as usize] == Side::Low;
            if self.side[node as usize] == Side::High
                && self.neighbours.of(node).iter().any(touches)
            {
                self.side[node as usize] = Side::Between;
                between += 1;
            }
        }
        Some(between)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a grid, each a neighbour of those around it.
    fn grid(counts: [usize; 3]) -> (Vec<Vec3>, Neighbours) {
        let [nx, ny, nz] = counts;
        let index = |i: usize, j: usize, k: usize| i + nx * (j + ny * k);
        let (mut positions, mut starts, mut nodes) = (Vec::new(), vec![0], Vec::new());
        let around = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    positions.push(Vec3::new(i as f64, j as f64, k as f64));
                    for c in around(k, nz) {
                        for b in around(j, ny) {
                            for a in around(i, nx) {
                                nodes.push(index(a, b, c) as u32);
                            }
                        }
                    }
                    starts.push(nodes.len());
                }
            }
        }
        (positions, Neighbours { starts, nodes })
    }

    /// Entries of the factor, counted by eliminating node after node.
    fn entries(order: &[u32], neighbours: &Neighbours) -> usize {
        let count = order.len();
        let mut rank = vec![0; count];
        for (index, &node) in order.iter().enumerate() {
            rank[node as usize] = index;
        }
        let mut rows: Vec<std::collections::BTreeSet<usize>> = (0..count)
            .map(|index| {
                let others = neighbours.of(order[index]).iter();
                let others = others.map(|&node| rank[node as usize]);
                others.filter(|&other| other > index).collect()
            })
            .collect();
        let mut sum = 0;
        for index in 0..count {
            let row = core::mem::take(&mut rows[index]);
            sum += row.len() + 1;
            if let Some(&parent) = row.first() {
                rows[parent].extend(row.into_iter().skip(1));
            }
        }
        sum
    }

    /// The order names every node once, whatever the shape. On grids of `n` nodes a side the fill grows
    /// with `n` to the power of 4, and lower ones, where that of the natural order grows with 5.
    #[test]
    fn dissection_is_a_permutation_with_little_fill() {
        for counts in [[14, 14, 14], [40, 6, 3], [200, 1, 1], [1, 1, 1]] {
            let (positions, neighbours) = grid(counts);
            let mut order = order(&positions, &neighbours);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..positions.len() as u32));
        }
        let fill = [8, 16].map(|side| {
            let (positions, neighbours) = grid([side; 3]);
            let natural: Vec<u32> = (0..positions.len() as u32).collect();
            let own = entries(&order(&positions, &neighbours), &neighbours);
            [own, entries(&natural, &neighbours)].map(|entries| entries as f64)
        });
        let [own, natural] = [0, 1].map(|order| (fill[1][order] / fill[0][order]).log2());
        println!("powers {own} and {natural}");
        assert!(own < 4.5 && natural > 4.8, "{own} {natural}");
        // Nodes with the same position cannot be bisected.
        let (_, neighbours) = grid([10, 10, 10]);
        assert_eq!(order(&vec![Vec3::zeros(); 1000], &neighbours).len(), 1000);
    }
}
