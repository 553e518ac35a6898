//! A hole in an elastic plane.

use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{ElasticMedium, Mesh, NodalLoad, StaticOptions, Stress, Support, Vec3};

use super::{Elastic, rock};

/// Far stress along x (Pa); the hole has a radius of one metre, the quarter box a side of four.
const FAR: f64 = 10.0e6;
const SIDE: f64 = 4.0;
const THICKNESS: f64 = 0.5;

/// Displacement and stress around the hole under a far stress along x, in plane strain.
///
/// Source: Kirsch (1898), *Z. VDI* 42; displacements with `kappa = 3 - 4 nu` after Muskhelishvili
/// (1953).
fn kirsch(p: &Vec3, medium: &ElasticMedium) -> (Vec3, Stress) {
    let (r, angle) = (p.x.hypot(p.y), p.y.atan2(p.x));
    let (i2, i4) = (r.powi(-2), r.powi(-4));
    let (c2, s2) = ((2.0 * angle).cos(), (2.0 * angle).sin());
    let kappa = 3.0 - 4.0 * medium.poisson;
    let scale = FAR * r / (8.0 * medium.shear());
    let radial = scale * (kappa - 1.0 + 2.0 * i2 + 2.0 * (1.0 + (kappa + 1.0) * i2 - i4) * c2);
    let around = -scale * 2.0 * (1.0 + (kappa - 1.0) * i2 + i4) * s2;
    let rr = 0.5 * FAR * (1.0 - i2 + (1.0 - 4.0 * i2 + 3.0 * i4) * c2);
    let tt = 0.5 * FAR * (1.0 + i2 - (1.0 + 3.0 * i4) * c2);
    let rt = -0.5 * FAR * (1.0 + 2.0 * i2 - 3.0 * i4) * s2;
    let (c, s) = (angle.cos(), angle.sin());
    let displacement = Vec3::new(radial * c - around * s, radial * s + around * c, 0.0);
    let xx = rr * c * c + tt * s * s - 2.0 * rt * s * c;
    let yy = rr * s * s + tt * c * c + 2.0 * rt * s * c;
    let xy = (rr - tt) * s * c + rt * (c * c - s * s);
    let zz = medium.poisson * (rr + tt);
    (displacement, Stress([xx, yy, zz, xy, 0.0, 0.0]))
}

/// Forces that do not change.
struct Given {
    nodes: Vec<u32>,
    forces: Vec<Vec3>,
}

impl NodalLoad for Given {
    fn name(&self) -> &str {
        "tractions"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
        for (sum, force) in forces.iter_mut().zip(&self.forces) {
            *sum += force;
        }
    }
}

/// The exact tractions of a face as nodal forces, by 2 x 2 Gauss points on each plane rectangle.
fn tractions(mesh: &Mesh, face: &str, medium: &ElasticMedium) -> Given {
    let facets = mesh.facet_set(face).unwrap();
    let nodes = mesh.nodes_of_facets(facets);
    let mut forces = vec![Vec3::zeros(); nodes.len()];
    let gauss = 1.0 / 3.0_f64.sqrt();
    for &facet in facets {
        let geometry = mesh.facet_geometry(facet);
        let corners: Vec<Vec3> = geometry
            .nodes
            .iter()
            .map(|&n| mesh.positions()[n as usize])
            .collect();
        for (r, s) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let (r, s) = (r * gauss, s * gauss);
            let weights = [
                (1.0 - r) * (1.0 - s),
                (1.0 + r) * (1.0 - s),
                (1.0 + r) * (1.0 + s),
                (1.0 - r) * (1.0 + s),
            ]
            .map(|w| 0.25 * w);
            let place: Vec3 = corners.iter().zip(weights).map(|(c, w)| c * w).sum();
            let traction = kirsch(&place, medium).1.traction(&geometry.normal());
            for (node, weight) in geometry.nodes.iter().zip(weights) {
                let place = nodes.binary_search(node).unwrap();
                forces[place] += traction * (weight * 0.25 * geometry.area());
            }
        }
    }
    Given { nodes, forces }
}

/// Relative errors of displacement and of stresses at element centres, in the mean square.
fn errors(cells: usize) -> [f64; 2] {
    let medium = rock();
    let unit = Vec3::new(1.0, 1.0, THICKNESS);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), unit, [cells, cells, 1], "ground").unwrap();
    let mesh = mesh.map_positions(|p| {
        let angle = core::f64::consts::FRAC_PI_2 * p.y;
        let (c, s) = (angle.cos(), angle.sin());
        let outer = SIDE / c.max(s);
        // Bricks grow outwards.
        let radius = outer.powf(p.x);
        Vec3::new(radius * c, radius * s, p.z)
    });
    let mesh = mesh.unwrap();
    let nodes = |face: &str| mesh.nodes_of_facets(mesh.facet_set(face).unwrap());
    let factory = SolidKernel::Hex8Full.factory("ground", Elastic(medium), Default::default());
    let mut model = Model::builder(&mesh)
        .elements("ground", factory)
        .support(Support::roller(nodes("front"), Vec3::y()))
        .support(Support::roller(nodes("back"), Vec3::x()))
        .support(Support::roller(nodes("bottom"), Vec3::z()))
        .support(Support::roller(nodes("top"), Vec3::z()))
        .load(Box::new(tractions(&mesh, "right", &medium)))
        .build()
        .unwrap();
    let options = StaticOptions::default().with_tolerance(1.0e-10);
    model.equilibrate(&options, &mut |_| {}).unwrap();
    let (mut error, mut size) = ([0.0; 2], [0.0; 2]);
    for (node, p) in mesh.positions().iter().enumerate() {
        let exact = kirsch(p, &medium).0;
        error[0] += (model.displacement(node as u32) - exact).norm_squared();
        size[0] += exact.norm_squared();
    }
    for (element, stress) in model.stress_changes().iter().enumerate() {
        let exact = kirsch(&mesh.centroid(element as u32), &medium).1;
        for i in 0..6 {
            error[1] += (stress.0[i] - exact.0[i]).powi(2);
            size[1] += exact.0[i].powi(2);
        }
    }
    [0, 1].map(|i| (error[i] / size[i]).sqrt())
}

/// Around a hole, with the exact tractions on the box around it, displacements converge with the
/// square of the element size, stresses at element centres at least with the element size.
#[test]
fn a_hole_converges() {
    let [coarse, middle, fine] = [8, 16, 32].map(errors);
    println!("{coarse:?} {middle:?} {fine:?}");
    for (a, b) in [(coarse, middle), (middle, fine)] {
        let [displacement, stress] = [0, 1].map(|i| (a[i] / b[i]).log2());
        assert!(displacement > 1.8, "{displacement}");
        assert!(stress > 1.0, "{stress}");
    }
    assert!(fine[0] < 2.0e-3 && fine[1] < 2.0e-2, "{fine:?}");
}
