//! Dynamic relaxation of bodies without joints.

use powerhouse_explicit_core::{
    Model, ModelBuilder, Precision, StaticError, StaticMethod, StaticOptions, StaticReport, Support,
};
use powerhouse_model::Vec3;

use super::{GRAVITY, absorbing, bent_box, elastic_body, face_nodes, largest, on_rollers, weak};

fn at_rest(builder: ModelBuilder, options: &StaticOptions) -> (Vec<Vec3>, StaticReport) {
    let mut model = builder.build().unwrap();
    let report = model.equilibrate(options, &mut |_| {}).unwrap();
    let nodes = 0..model.mesh().node_count() as u32;
    (nodes.map(|node| model.displacement(node)).collect(), report)
}

/// Compares the displacements of a body under its weight by both methods.
fn alike<'a>(built: &dyn Fn() -> ModelBuilder<'a>, increments: u32) {
    let gradients = StaticOptions::default()
        .with_tolerance(1.0e-11)
        .with_increments(increments);
    let relaxation = gradients.with_method(StaticMethod::DynamicRelaxation);
    let built = || built().gravity(GRAVITY, Box::new(|_: f64| 1.0));
    let (expected, _) = at_rest(built(), &gradients);
    let (found, report) = at_rest(built(), &relaxation);
    println!("{report:?}");
    assert!(report.steps > 20 && report.corrections == 0);
    let size = largest(expected.iter().copied());
    for (a, b) in expected.iter().zip(&found) {
        assert!((a - b).norm() < 1.0e-8 * size, "{a} {b} {size}");
    }
}

/// Elastic bodies on an oblique roller or on springs, and one that yields, come to the same rest by
/// dynamic relaxation as by conjugate gradients, to 1e-8; with the load in parts, too.
#[test]
fn relaxation_rests_where_gradients_do() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 30.0), [6, 5, 4], 1.0);
    let oblique = || {
        let normal = Vec3::new(1.0, 0.4, -0.2);
        elastic_body(&mesh)
            .support(Support::roller(face_nodes(&mesh, "left"), normal))
            .support(Support::fixed(face_nodes(&mesh, "bottom")))
    };
    let sprung = || absorbing(&mesh, elastic_body(&mesh), 20.0);
    let yielding = || {
        let body = Model::builder(&mesh).elements("ground", weak("ground", Precision::F64));
        on_rollers(&mesh, body)
    };
    alike(&oblique, 1);
    alike(&sprung, 3);
    alike(&yielding, 1);
    alike(&yielding, 3);
}

/// A relaxation that has too few steps says so, and where the forces are that do not balance; the
/// model is where it was.
#[test]
fn a_relaxation_that_ends_early_is_no_rest() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 30.0), [6, 5, 4], 1.0);
    let body = on_rollers(&mesh, elastic_body(&mesh));
    let mut model = body
        .gravity(GRAVITY, Box::new(|_: f64| 1.0))
        .build()
        .unwrap();
    let options = StaticOptions {
        steps: 10,
        least_increment: 0.5,
        ..StaticOptions::default().with_method(StaticMethod::DynamicRelaxation)
    };
    let refused = model.equilibrate(&options, &mut |_| {}).unwrap_err();
    assert!(matches!(&refused, StaticError::NotConverged { set, .. } if set == "ground"));
    let nodes = 0..mesh.node_count() as u32;
    assert!(
        nodes
            .into_iter()
            .all(|node| model.displacement(node) == Vec3::zeros())
    );
}
