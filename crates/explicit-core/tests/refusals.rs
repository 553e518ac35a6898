//! What cannot be computed is refused before the run, with a typed error that names it.

use crate::support::{Links, chain, hex_box};
use powerhouse_elements::NodalForce;
use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{
    BoundaryParts, Constraint, ConstraintParts, ConstraintWork, DividedConstraint, ElementKind,
    EngineError, Mat3, Mesh, MeshError, ModelError, ModelSpec, NodalImpedance, PeriodicPairs,
    Precision, PredictedMotion, Prescribed, RunError, Support, Vec3,
};

fn rock() -> Links {
    Links::new("rock", ElementKind::Hex8, 9.0e9, 0.3, 2700.0)
}

fn model(mesh: &Mesh) -> ModelSpec<'_> {
    Model::builder(mesh).elements("rock", rock().boxed())
}

fn refusal(builder: ModelSpec) -> EngineError {
    match builder.build().unwrap_err() {
        ModelError::Refused { source, .. } => *source.downcast::<EngineError>().unwrap(),
        other => panic!("{other}"),
    }
}

/// Bars that no set claims are lines of the mesh and are left out; where their own nodes are left
/// without mass, the first of them is named.
#[test]
fn bars_without_a_set_are_left_out() {
    let with_bar = |end: u64| {
        let mut builder = Mesh::builder();
        for corner in 0..8_u64 {
            let of = |bit: u64| f64::from(u8::from(corner & bit != 0));
            builder.node(corner + 1, Vec3::new(of(1), of(2), of(4)));
        }
        if end == 9 {
            builder.node(9, Vec3::new(0.0, 0.0, 3.0));
        }
        builder.element(1, ElementKind::Hex8, &[1, 2, 4, 3, 5, 6, 8, 7], &["rock"]);
        builder.element(2, ElementKind::Bar2, &[5, end], &["edge"]);
        builder.build().unwrap()
    };
    let edge = with_bar(7);
    assert!(
        Model::builder(&edge)
            .elements("rock", rock().boxed())
            .build()
            .is_ok()
    );
    let alone = with_bar(9);
    let builder = Model::builder(&alone).elements("rock", rock().boxed());
    let EngineError::NodeWithoutMass { node, .. } = refusal(builder) else {
        panic!("the bar's end has no mass");
    };
    assert_eq!(node, 9);
}

/// Every element is computed once: two sets that claim one, and elements that no set claims, are
/// refused by number.
#[test]
fn elements_are_computed_once() {
    let mesh = hex_box([3, 1, 1], 1.0, 0.0);
    let twice = model(&mesh).elements(vec![1], rock().boxed());
    assert!(matches!(
        refusal(twice),
        EngineError::ElementTwice { element: 2, .. }
    ));
    let missing = Model::builder(&mesh).elements(vec![1], rock().boxed());
    let expected = EngineError::ElementUnassigned {
        element: 1,
        count: 2,
    };
    assert_eq!(refusal(missing), expected);
    assert_eq!(refusal(Model::builder(&mesh)), EngineError::NoElements);
    let unknown = Model::builder(&mesh)
        .elements("marble", rock().boxed())
        .build();
    assert!(matches!(
        unknown.unwrap_err(),
        ModelError::Mesh(MeshError::NoSuchSet { name, .. }) if name == "marble"
    ));
    let outside = Model::builder(&mesh)
        .elements(vec![0, 1, 2, 3], rock().boxed())
        .build();
    assert!(matches!(
        outside.unwrap_err(),
        ModelError::Mesh(MeshError::SetOutOfRange { number: 3, .. })
    ));
}

/// A kernel gets elements of its own kind only, and all sets keep nodes in one format.
#[test]
fn kinds_and_formats_must_agree() {
    let bars = chain(3, 1.0);
    let wrong = Model::builder(&bars).elements("bar", rock().boxed());
    assert!(matches!(
        refusal(wrong),
        EngineError::ElementKind {
            element: 1,
            found: "bar2",
            expected: "hex8",
            ..
        }
    ));
    let mesh = hex_box([2, 1, 1], 1.0, 0.0);
    let mixed = Model::builder(&mesh)
        .elements(vec![0], rock().boxed())
        .elements(vec![1], rock().precision(Precision::F32).boxed());
    assert!(matches!(refusal(mixed), EngineError::MixedNodes { .. }));
}

/// Every node has mass: one that belongs to no element, or to massless ones, is refused by number.
#[test]
fn nodes_without_mass_are_refused() {
    let mut builder = Mesh::builder();
    for i in 1..=3_u64 {
        builder.node(10 * i, Vec3::new(i as f64, 0.0, 0.0));
    }
    builder.element(1, ElementKind::Bar2, &[10, 20], &["bar"]);
    let mesh = builder.build().unwrap();
    let bars = |density| Links::new("bar", ElementKind::Bar2, 1.0, 1.0, density).boxed();
    let orphan = Model::builder(&mesh).elements("bar", bars(1.0));
    assert_eq!(
        refusal(orphan),
        EngineError::NodeWithoutMass {
            node: 30,
            mass: 0.0
        }
    );
    let chain = chain(2, 1.0);
    let massless = Model::builder(&chain).elements("bar", bars(0.0));
    assert!(matches!(
        refusal(massless),
        EngineError::NodeWithoutMass { .. }
    ));
}

/// Loads, supports and boundaries act on nodes that exist, a load on each once.
#[test]
fn unknown_nodes_are_refused() {
    let mesh = hex_box([1, 1, 1], 1.0, 0.0);
    let force = |nodes| Box::new(NodalForce::new(nodes, Vec3::x(), Box::new(|_: f64| 1.0)));
    let unknown = refusal(model(&mesh).load(force(vec![8])));
    assert!(matches!(
        unknown,
        EngineError::UnknownNode {
            node: 8,
            count: 8,
            ..
        }
    ));
    let twice = refusal(model(&mesh).load(force(vec![3, 2, 3])));
    assert!(matches!(twice, EngineError::NodeTwice { node: 4, .. }));
    let support = refusal(model(&mesh).support(Support::fixed(vec![99])));
    assert!(matches!(support, EngineError::UnknownNode { node: 99, .. }));
    let normal = refusal(model(&mesh).support(Support::roller(vec![0], Vec3::zeros())));
    assert!(matches!(normal, EngineError::NoDirection { .. }));
}

/// A prescribed motion in a held direction is a contradiction; in another it is not.
#[test]
fn contradicting_conditions_are_refused() {
    let mesh = hex_box([1, 1, 1], 1.0, 0.0);
    let drive = |direction| Prescribed {
        nodes: vec![0],
        direction,
        displacement: Box::new(|t: f64| t),
    };
    let roller = || model(&mesh).support(Support::roller(vec![0], Vec3::z()));
    let conflict = refusal(roller().prescribed(drive(Vec3::z())));
    assert_eq!(conflict, EngineError::SupportConflict { node: 1 });
    assert!(
        roller()
            .prescribed(drive(Vec3::new(1.0, 0.0, 1.0)))
            .build()
            .is_ok()
    );
}

/// A dashpot that would feed energy in is refused.
#[test]
fn active_impedances_are_refused() {
    let mesh = hex_box([1, 1, 1], 1.0, 0.0);
    for matrix in [
        Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -0.1)),
        Mat3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        Mat3::repeat(f64::NAN),
    ] {
        let parts = BoundaryParts::default().with_impedance(vec![NodalImpedance::new(
            2,
            Mat3::zeros(),
            matrix,
        )]);
        let error = refusal(model(&mesh).boundary(parts));
        assert_eq!(
            error,
            EngineError::Impedance {
                what: "dashpot",
                node: 3
            }
        );
    }
}

/// Faces that do not match are refused with the worst node and its distance.
#[test]
fn periodic_faces_that_do_not_match_are_refused() {
    let mut builder = Mesh::builder();
    for (tag, y, z) in [(1, 0.0, 0.0), (2, 1.0, 0.0), (3, 0.0, 1.0)] {
        builder.node(tag, Vec3::new(0.0, y, z));
        let shift = if tag == 3 { 1e-3 } else { 0.0 };
        builder.node(tag + 10, Vec3::new(5.0, y, z + shift));
    }
    builder.element(1, ElementKind::Bar2, &[1, 11], &["bar"]);
    let mesh = builder.build().unwrap();
    let node = |tag: u64| mesh.node_tags().iter().position(|&t| t == tag).unwrap() as u32;
    let (from, to) = ([1, 2, 3].map(node), [11, 12, 13].map(node));
    let match_within = |tolerance| PeriodicPairs::by_translation(&mesh, &from, &to, tolerance);
    assert_eq!(
        match_within(1e-2).unwrap().pairs,
        from.into_iter().zip(to).collect::<Vec<_>>()
    );
    match match_within(1e-4).unwrap_err() {
        EngineError::PeriodicMismatch { node, distance, .. } => {
            assert!(node == 3 || node == 13);
            assert!((distance - 1e-3).abs() < 1e-15);
        }
        other => panic!("{other}"),
    }
    let fewer = PeriodicPairs::by_translation(&mesh, &from, &to[..2], 1e-2).unwrap_err();
    assert!(matches!(
        fewer,
        EngineError::PeriodicMismatch { from: 3, to: 2, .. }
    ));
}

/// Holds nodes in place, in parts that it states.
struct Held {
    nodes: Vec<u32>,
    parts: Vec<Vec<u32>>,
}

impl Constraint for Held {
    fn name(&self) -> &str {
        "held"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn divided(&self) -> Option<&dyn DividedConstraint> {
        Some(self)
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        motion.velocity.fill(Vec3::zeros());
        Ok(ConstraintWork::default())
    }
}

impl DividedConstraint for Held {
    fn parts(&self) -> ConstraintParts {
        ConstraintParts::merged(self.parts.iter().map(|part| &part[..]))
    }
}

/// The parts of a model are those of its constraints and its periodic pairs, joined where they share nodes; a constraint
/// whose parts lack a node of it, or have another one, is refused with the number of that node.
#[test]
fn parts_of_constraints_have_each_node_once() {
    let mesh = hex_box([3, 3, 3], 1.0, 0.0);
    let with_parts = |parts: &[&[u32]]| {
        let held = Held {
            nodes: vec![5, 9, 2, 14],
            parts: parts.iter().map(|part| part.to_vec()).collect(),
        };
        let pairs = PeriodicPairs {
            pairs: vec![(9, 30), (40, 41)],
        };
        model(&mesh).constraint(Box::new(held)).periodic(pairs)
    };
    let built = with_parts(&[&[5, 2], &[14], &[9]]).build().unwrap();
    let parts = built.constraint_parts();
    let expected: [&[u32]; 4] = [&[2, 5], &[9, 30], &[14], &[40, 41]];
    assert_eq!(parts.iter().collect::<Vec<_>>(), expected);
    assert_eq!(parts.divided(|node| node < 20), Some(1));
    let cases: [(&[&[u32]], u32); 3] = [
        (&[&[5, 2], &[14]], 9),
        (&[&[5, 2, 9], &[14, 50]], 50),
        (&[], 2),
    ];
    for (parts, wanted) in cases {
        let EngineError::ConstraintParts { constraint, node } = refusal(with_parts(parts)) else {
            panic!("{parts:?}");
        };
        assert_eq!(constraint, "held");
        assert_eq!(node, mesh.node_tags()[wanted as usize]);
    }
}
