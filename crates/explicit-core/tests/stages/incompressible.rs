//! Bodies near incompressibility.

use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{
    BlockOptions, ElasticMedium, Mesh, StaticError, StaticMethod, StaticOptions, Support, Vec3,
};

use super::{Elastic, face_nodes};

/// A cantilever of ten-node tetrahedra, ten long and one square, with cells that are cubes, at a Poisson's ratio.
fn cantilever(poisson: f64, layers: usize, method: StaticMethod) -> Result<f64, StaticError> {
    let size = Vec3::new(10.0, 1.0, 1.0);
    let cells = [10 * layers, layers, layers];
    let mesh = Mesh::box_of_tets(Vec3::zeros(), size, cells, "beam").unwrap();
    let mesh = mesh.with_midpoints().unwrap();
    let medium = ElasticMedium::new(20.0e9, poisson, 2500.0).unwrap();
    let elements = SolidKernel::Tet10.factory("beam", Elastic(medium), BlockOptions::default());
    let mut builder = Model::builder(&mesh)
        .elements("beam", elements)
        .support(Support::fixed(face_nodes(&mesh, "left")));
    let end = mesh.facet_set("right").unwrap();
    let force = 1.0e5;
    for part in mesh.tributary_areas(end) {
        let share = Vec3::z() * (force * part.area);
        let load = NodalForce::new(vec![part.node], share, Box::new(|_: f64| 1.0));
        builder = builder.load(Box::new(load));
    }
    let mut model = builder.build().unwrap();
    let options = StaticOptions::default().with_method(method);
    model.equilibrate(&options, &mut |_| {})?;
    let moved = mesh.tributary_areas(end);
    let mean: f64 = moved
        .iter()
        .map(|p| p.area * model.displacement(p.node).z)
        .sum();
    let bending = force * 1000.0 / (3.0 * medium.young / 12.0);
    let shear = force * 10.0 / (5.0 / 6.0 * medium.shear());
    Ok(mean / (bending + shear))
}

fn deflects(method: StaticMethod, poisson: f64, layers: usize, expected: f64) {
    let found = cantilever(poisson, layers, method).unwrap();
    let is_close = (found - expected).abs() < 0.006;
    assert!(is_close, "{method:?} {poisson} {layers}: {found}");
}

/// Cantilevers of one layer of cells deflect by known shares of a beam up to a Poisson's ratio of 0.4999: conjugate gradients,
/// whose residual grows at first, find the solution.
#[test]
fn tetrahedra_rest_near_incompressibility() {
    for (poisson, expected) in [(0.3, 1.04), (0.49, 1.06), (0.4999, 1.06)] {
        deflects(StaticMethod::ConjugateGradients, poisson, 1, expected);
    }
}

/// The same of two layers of cells, and by dynamic relaxation.
#[test]
#[ignore = "slow: cargo test --release --test explicit-core incompressibility -- --ignored"]
fn fine_and_relaxed_tetrahedra_rest_near_incompressibility() {
    deflects(StaticMethod::ConjugateGradients, 0.4999, 2, 0.98);
    deflects(StaticMethod::DynamicRelaxation, 0.4999, 1, 1.06);
}
