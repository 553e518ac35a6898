//! Static solutions that are refused or fail.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{
    ElasticMedium, Mesh, StaticError, StaticMethod, StaticOptions, Support, Vec3,
};

use super::{GRAVITY, elastic, face_nodes, rock};

/// A layer without stiffness between two of rock, and the same body without supports, are refused
/// by every method before anything is solved: the one names the layer and a node of it, the other
/// the part that can move.
#[test]
fn what_nothing_holds_is_refused_by_name() {
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(6.0), [3, 3, 3], "all").unwrap();
    let layer = |from: f64| {
        let (low, high) = (Vec3::new(0.0, 0.0, from), Vec3::new(6.0, 6.0, from + 2.0));
        mesh.elements_in_box(&low, &high)
    };
    let (low, seam, high) = (layer(0.0), layer(2.0), layer(4.0));
    mesh.set_element_set("seam", seam.clone()).unwrap();
    mesh.set_element_set("low", low).unwrap();
    mesh.set_element_set("high", high).unwrap();
    let refused = |young: f64, held: bool, method: StaticMethod| {
        let void = ElasticMedium::new(young, 0.27, 2750.0).unwrap();
        let mut builder = Model::builder(&mesh)
            .elements("low", elastic("low", rock()))
            .elements("seam", elastic("seam", void))
            .elements("high", elastic("high", rock()))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0));
        if held {
            builder = builder.support(Support::fixed(face_nodes(&mesh, "bottom")));
        }
        let mut model = builder.build().unwrap();
        let options = StaticOptions::default().with_method(method);
        model.equilibrate(&options, &mut |_| {}).unwrap_err()
    };
    let methods = [
        StaticMethod::ConjugateGradients,
        StaticMethod::DynamicRelaxation,
        #[cfg(feature = "direct")]
        StaticMethod::Cholesky(powerhouse_model::Linearisation::Elastic),
    ];
    let inside: Vec<u64> = (mesh.nodes_of_elements(&seam).iter())
        .map(|&node| mesh.node_tags()[node as usize])
        .collect();
    for method in methods {
        for young in [1.0e-290, 1.0e-8] {
            match refused(young, true, method) {
                StaticError::NoStiffness { node, set } => {
                    assert!(set == "seam" && inside.contains(&node), "{set} {node}");
                }
                other => panic!("{other}"),
            }
        }
        match refused(9.0e9, false, method) {
            StaticError::Floating { set, elements, .. } => {
                assert_eq!((set.as_str(), elements), ("low", 27));
            }
            other => panic!("{other}"),
        }
    }
}

/// A raised flag ends a static solution by any method at once, and what was balanced before stays.
#[test]
fn a_solution_ends_when_a_flag_is_raised() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(6.0), [3, 3, 3], "all").unwrap();
    let methods = [
        StaticMethod::ConjugateGradients,
        StaticMethod::DynamicRelaxation,
    ];
    for method in methods {
        let flag = Arc::new(AtomicBool::new(false));
        let mut model = Model::builder(&mesh)
            .elements("all", elastic("all", rock()))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .support(Support::fixed(face_nodes(&mesh, "bottom")))
            .stop_on(flag.clone())
            .build()
            .unwrap();
        let options = StaticOptions::default()
            .with_method(method)
            .with_increments(4);
        let mut shares = Vec::new();
        let ended = model.equilibrate(&options, &mut |progress| {
            flag.store(progress.share > 0.5, Ordering::Relaxed);
            shares.push(progress.share);
        });
        assert_eq!(ended, Err(StaticError::Interrupted));
        assert_eq!(shares.iter().filter(|&&share| share > 0.5).count(), 1);
        // Two increments of four stand.
        let top = face_nodes(&mesh, "top")[0];
        let half = model.displacement(top).z;
        flag.store(false, Ordering::Relaxed);
        model.equilibrate(&options, &mut |_| {}).unwrap();
        let whole = model.displacement(top).z;
        assert!((2.0 * half / whole - 1.0).abs() < 1.0e-6, "{half} {whole}");
    }
}
