//! The explicit loop of another finite element code, with the free field of `powerhouse-wavefield` and the boundary of
//! `powerhouse-boundary`, on a mesh of `powerhouse-model`, and nothing else of this project.
//!
//! Elements, masses and time integration are the other code's own: bricks of 2 x 2 x 2 points of Gauss.

use powerhouse_boundary::ViscousSpring;
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, ElementKind, IncidentField, Mat3, Mesh,
    ModelError, Vec3,
};

/// Ground of one medium, meshed with bricks.
pub struct Ground {
    /// Nodes, bricks and facet sets.
    pub mesh: Mesh,
    /// Medium of all bricks.
    pub medium: ElasticMedium,
    /// Names of the facet sets that absorb.
    pub absorbing: Vec<String>,
    /// Point (m) from which the springs take their distance.
    pub scatterer: Vec3,
}

/// Stiffness (N/m) between two corners of a brick.
type Stiffness = [[Mat3; 8]; 8];

impl Ground {
    /// Masses (kg) of the corners of a brick, and its stiffness.
    fn brick(&self, corners: &[Vec3]) -> ([f64; 8], Stiffness) {
        let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
        let (mut masses, mut stiffness) = ([0.0; 8], [[Mat3::zeros(); 8]; 8]);
        for corner in ElementKind::Hex8.natural_corners() {
            let (mut values, mut slopes) = ([0.0; 8], [Vec3::zeros(); 8]);
            let point = Vec3::from(*corner) / 3f64.sqrt();
            ElementKind::Hex8.shape_functions(&point, &mut values);
            ElementKind::Hex8.shape_gradients(&point, &mut slopes);
            let sides = corners.iter().zip(&slopes);
            let jacobian: Mat3 = sides.map(|(x, slope)| x * slope.transpose()).sum();
            let back = jacobian.transpose().try_inverse().unwrap_or_default();
            let gradients = slopes.map(|slope| back * slope);
            for (a, from) in gradients.iter().enumerate() {
                masses[a] += self.medium.density * values[a] * jacobian.determinant();
                for (b, to) in gradients.iter().enumerate() {
                    let isotropic = Mat3::identity() * (shear * from.dot(to));
                    let coupled = from * to.transpose() * lambda + to * from.transpose() * shear;
                    stiffness[a][b] += (isotropic + coupled) * jacobian.determinant();
                }
            }
        }
        (masses, stiffness)
    }

    /// The displacement (m) of a node after 0, 1, 2 ... steps of a length (s) from rest, in a free field.
    ///
    /// # Errors
    /// A facet set that is not there; a boundary or a field that is refused.
    pub fn run(
        &self,
        field: &dyn IncidentField,
        (steps, dt): (usize, f64),
        probe: u32,
    ) -> Result<Vec<Vec3>, ModelError> {
        let (mesh, mut faces) = (&self.mesh, Vec::new());
        for name in &self.absorbing {
            faces.push((name.as_str(), mesh.facet_set(name)?));
        }
        let site =
            BoundarySite::from_mesh(mesh, &faces, |_| self.medium, self.scatterer, Some(field));
        let mut parts = ViscousSpring::default().build(&site)?;
        let still = vec![Vec3::zeros(); mesh.node_count()];
        let mut mass = vec![0.0; still.len()];
        let mut dashpot = vec![Mat3::zeros(); still.len()];
        let mut spring = dashpot.clone();
        for impedance in &parts.impedance {
            dashpot[impedance.node as usize] += impedance.dashpot;
            spring[impedance.node as usize] += impedance.spring;
        }
        let mut bricks = Vec::new();
        for nodes in (0..mesh.element_count() as u32).map(|brick| mesh.nodes_of(brick)) {
            let corners: Vec<Vec3> = nodes
                .iter()
                .map(|&n| mesh.positions()[n as usize])
                .collect();
            let (masses, stiffness) = self.brick(&corners);
            for (&node, of_corner) in nodes.iter().zip(masses) {
                mass[node as usize] += of_corner;
            }
            bricks.push((nodes, stiffness));
        }
        let (mut u, mut v, mut motion) = (still.clone(), still.clone(), Vec::new());
        for step in 0..=steps {
            motion.push(u[probe as usize]);
            let mut force = still.clone();
            for load in &mut parts.loads {
                let mut own = vec![Vec3::zeros(); load.nodes().len()];
                load.add_forces(step as f64 * dt, &mut own);
                for (&node, own) in load.nodes().iter().zip(own) {
                    force[node as usize] += own;
                }
            }
            for (nodes, stiffness) in &bricks {
                for (&node, row) in nodes.iter().zip(stiffness) {
                    for (&other, entry) in nodes.iter().zip(row) {
                        force[node as usize] -= entry * u[other as usize];
                    }
                }
            }
            for node in 0..still.len() {
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
