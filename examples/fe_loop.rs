//! The explicit loop of another finite element code, with the free field of `powerhouse-wavefield` and the boundary of
//! `powerhouse-boundary`, and nothing else of this project but the words that both exchange.
//!
//! Mesh, elements, masses and time integration are the other code's own: cubes of one size, one stiffness matrix for all.

use powerhouse_boundary::ViscousSpring;
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, IncidentField, Mat3, ModelError, SiteFace,
    SiteNode, Vec3,
};

/// Ground of equal cubes, from the origin to a free surface on top; the other five faces absorb.
pub struct Cubes {
    /// Medium of the ground.
    pub medium: ElasticMedium,
    /// Edge of a cube (m).
    pub edge: f64,
    /// Number of cubes along x, y and z.
    pub cells: [usize; 3],
}

impl Cubes {
    /// Index of the node with numbers along x, y and z.
    pub fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        let [x, y, _] = self.cells;
        i + (x + 1) * (j + (y + 1) * k)
    }

    /// Numbers of all nodes along x, y and z, in the order of their indices.
    fn nodes(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let [x, y, z] = self.cells;
        (0..=z).flat_map(move |k| (0..=y).flat_map(move |j| (0..=x).map(move |i| [i, j, k])))
    }

    /// The nodes of the absorbing faces with their tributary areas.
    fn site(&self) -> Vec<SiteNode> {
        let mut found = Vec::new();
        for at in self.nodes() {
            let mut faces = Vec::new();
            for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0)] {
                if at[axis] == side * self.cells[axis] {
                    let inside = |c: usize| c != axis && at[c] > 0 && at[c] < self.cells[c];
                    let quarters = [0, 1, 2].map(|c| if inside(c) { 2.0 } else { 1.0 });
                    let mut normal = Vec3::zeros();
                    normal[axis] = if side == 0 { -1.0 } else { 1.0 };
                    faces.push(SiteFace {
                        face: 2 * axis + side,
                        medium: self.medium,
                        normal,
                        area: 0.25 * self.edge.powi(2) * quarters.iter().product::<f64>(),
                    });
                }
            }
            if !faces.is_empty() {
                let [x, y, z] = at.map(|number| self.edge * number as f64);
                found.push(SiteNode {
                    node: self.node(at) as u32,
                    position: Vec3::new(x, y, z),
                    faces,
                });
            }
        }
        found
    }

    /// The stiffness (N/m) between two corners of a cube, by 2 x 2 x 2 points of Gauss.
    fn stiffness(&self) -> [[Mat3; 8]; 8] {
        let side = |a: usize, c: usize| if (a >> c) & 1 == 1 { 1.0 } else { -1.0 };
        let mut stiffness = [[Mat3::zeros(); 8]; 8];
        for point in 0..8 {
            let gradient = [0, 1, 2, 3, 4, 5, 6, 7].map(|a| {
                let along = |c: usize| 1.0 + side(a, c) * side(point, c) / 3f64.sqrt();
                let of = |c: usize| side(a, c) * along((c + 1) % 3) * along((c + 2) % 3);
                Vec3::new(of(0), of(1), of(2)) / (4.0 * self.edge)
            });
            let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
            for (a, row) in stiffness.iter_mut().enumerate() {
                for (b, entry) in row.iter_mut().enumerate() {
                    let (from, to) = (&gradient[a], &gradient[b]);
                    let isotropic = Mat3::identity() * (shear * from.dot(to));
                    let coupled = from * to.transpose() * lambda + to * from.transpose() * shear;
                    *entry += (isotropic + coupled) * (self.edge.powi(3) / 8.0);
                }
            }
        }
        stiffness
    }

    /// The displacement (m) of a node after 0, 1, 2 ... steps of a length (s) from rest, in a free field.
    ///
    /// # Errors
    /// A boundary or a field that is refused.
    pub fn run(
        &self,
        (field, scatterer): (&dyn IncidentField, Vec3),
        (steps, dt): (usize, f64),
        probe: usize,
    ) -> Result<Vec<Vec3>, ModelError> {
        let faces = ["left", "right", "front", "back", "bottom"].map(String::from);
        let site = BoundarySite::new(faces.to_vec(), self.site(), scatterer, Some(field));
        let mut parts = ViscousSpring::default().build(&site)?;
        let count = self.nodes().count();
        let (mut mass, mut dashpot) = (vec![0.0; count], vec![Mat3::zeros(); count]);
        let mut spring = dashpot.clone();
        for impedance in &parts.impedance {
            dashpot[impedance.node as usize] += impedance.dashpot;
            spring[impedance.node as usize] += impedance.spring;
        }
        let inner = self
            .nodes()
            .filter(|at| (0..3).all(|c| at[c] < self.cells[c]));
        let corners = |[i, j, k]: [usize; 3]| {
            [0, 1, 2, 3, 4, 5, 6, 7]
                .map(|a| self.node([i + (a & 1), j + ((a >> 1) & 1), k + (a >> 2)]))
        };
        let cubes: Vec<[usize; 8]> = inner.map(corners).collect();
        for &node in cubes.iter().flatten() {
            mass[node] += self.medium.density * self.edge.powi(3) / 8.0;
        }
        let stiffness = self.stiffness();
        let (mut u, mut v) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
        let mut motion = Vec::new();
        for step in 0..=steps {
            motion.push(u[probe]);
            let mut force = vec![Vec3::zeros(); count];
            for load in &mut parts.loads {
                let nodes = load.nodes().to_vec();
                let mut own = vec![Vec3::zeros(); nodes.len()];
                load.add_forces(step as f64 * dt, &mut own);
                nodes
                    .iter()
                    .zip(own)
                    .for_each(|(&node, own)| force[node as usize] += own);
            }
            for cube in &cubes {
                for (a, &node) in cube.iter().enumerate() {
                    for (b, &other) in cube.iter().enumerate() {
                        force[node] -= stiffness[a][b] * u[other];
                    }
                }
            }
            for node in 0..count {
                // M (v+ - v-)/dt + C (v+ + v-)/2 + K (u + dt (v+ - v-)/4) = f.
                let half = dashpot[node] * (0.5 * dt);
                let inertia = Mat3::identity() * mass[node] + spring[node] * (0.25 * dt * dt);
                let push = (force[node] - spring[node] * u[node]) * dt;
                let impulse = (inertia - half) * v[node] + push;
                v[node] = (inertia + half).try_inverse().unwrap_or_default() * impulse;
                u[node] += v[node] * dt;
            }
        }
        Ok(motion)
    }
}
