//! Joints that slide and open on the way to rest.

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{
    Bond, BoundaryParts, ContactState, JointRecord, Mat3, Mesh, ModelSpec, NodalImpedance,
    RunOptions, StaticError, StaticMethod, StaticOptions, StaticReport, Support, Vec3,
};
use powerhouse_tests::elastic;

use super::Column;

/// Springs (N/m) along an axis, shared by some nodes.
fn sprung<'a>(builder: ModelSpec<'a>, nodes: &[u32], axis: usize, stiffness: f64) -> ModelSpec<'a> {
    let mut spring = Mat3::zeros();
    spring[(axis, axis)] = stiffness / nodes.len() as f64;
    let impedance = nodes
        .iter()
        .map(|&node| NodalImpedance::new(node, spring, Mat3::zeros()));
    builder.boundary(BoundaryParts::default().with_impedance(impedance))
}

fn relaxed(model: &mut Model) -> StaticReport {
    let options = StaticOptions::default()
        .with_method(StaticMethod::DynamicRelaxation)
        .with_tolerance(1.0e-11);
    let report = model.equilibrate(&options, &mut |_| {}).unwrap();
    println!("{report:?}");
    report
}

fn records(model: &Model) -> Vec<JointRecord> {
    model.joints().flat_map(|j| j.records.to_vec()).collect()
}

/// The corrections of Newton refuse a joint that moves, by name, and point to the relaxation.
fn newton_refuses(builder: ModelSpec, name: &str) {
    let refused = (builder.build().unwrap()).equilibrate(&StaticOptions::default(), &mut |_| {});
    let error = refused.unwrap_err();
    assert!(matches!(&error, StaticError::JointMoves { joint, .. } if joint == name));
    assert!(error.to_string().contains("dynamic relaxation"), "{error}");
}

/// A column under a body force `b` across it, cut at the height `l` by a joint under the pressure
/// `p`, its upper part of the height `h` held by a spring `k` at its top, slips by
///
/// `(b h - mu p) / k - (mu p h - b h^2 / 2) / G - (mu p l + b l^2 / 2) / G`
///
/// with the dynamic friction `mu`, to 1e-8, and sticks there; released, it does not move.
#[test]
fn a_joint_slips_as_far_as_its_spring_lets_it() {
    let (medium, brick) = (media::ROCK, 0.5);
    let column = Column::new(&[(4, medium), (6, medium)], brick);
    let (base, height) = (4.0 * brick, 6.0 * brick);
    let (pressure, stiffness, friction, acceleration) = (1.0e5, 2.0e7, 0.5, 60.0);
    let law = BondedCoulomb::unbonded(0.6, friction).unwrap();
    let pairs = column.surfaces[0].pairs.clone();
    let built = || {
        let joint = Joint::new("joint", pairs.clone(), law).unwrap();
        let joint = joint.with_preload(|_| Vec3::z() * -pressure).unwrap();
        let builder = column.along(0).support(Support::fixed(column.level(0.0)));
        sprung(builder, &column.level(base + height), 0, stiffness)
            .gravity(Vec3::x() * acceleration, Box::new(|_: f64| 1.0))
            .constraint(Box::new(joint))
    };
    newton_refuses(built(), "joint");
    let mut model = built().build().unwrap();
    relaxed(&mut model);
    let (force, rubbed) = (medium.density * acceleration, friction * pressure);
    let drawn = (rubbed * height - 0.5 * force * height * height) / medium.shear();
    let bent = (rubbed * base + 0.5 * force * base * base) / medium.shear();
    let expected = (force * height - rubbed) / stiffness - drawn - bent;
    assert!(expected > 1.0e-2);
    for (pair, record) in pairs.iter().zip(records(&model)) {
        let [below, above] = pair.nodes.map(|node| model.displacement(node));
        let moved = (above - below).x.abs();
        assert!(
            (moved - expected).abs() < 1.0e-8 * expected,
            "{moved} {expected}"
        );
        assert!(
            (record.state.slip - expected).abs() < 1.0e-6 * expected,
            "{record:?}"
        );
        assert_eq!(record.state.contact, ContactState::Stick);
        let shear = record.traction.y.hypot(record.traction.z);
        assert!((shear - rubbed).abs() < 1.0e-6 * rubbed, "{shear}");
    }
    let still: Vec<Vec3> = (0..column.mesh.node_count() as u32)
        .map(|node| model.displacement(node))
        .collect();
    run(
        &mut model,
        &Leapfrog,
        &RunOptions::steps(1000),
        &mut [],
        &mut |_| {},
    )
    .unwrap();
    for (node, still) in still.iter().enumerate() {
        let moved = (model.displacement(node as u32) - still).norm();
        assert!(moved < 1.0e-10, "{moved}");
    }
}

/// A column that hangs on a bond too weak for it falls on a spring `k` at its foot: the joint opens
/// by
///
/// `b h / k + b h^2 / (2 M) - b l^2 / (2 M)`
///
/// for a weight `b`, the lower part of the height `h` and the upper of `l`, modulus `M`, to 1e-8, and
/// bears nothing.
#[test]
fn a_joint_opens_as_far_as_its_spring_lets_it() {
    let (medium, brick) = (media::ROCK, 0.5);
    let column = Column::new(&[(6, medium), (4, medium)], brick);
    let (height, above) = (6.0 * brick, 4.0 * brick);
    let (stiffness, gravity) = (4.0e7, 9.81);
    let weight = medium.density * gravity;
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 1.0e6,
        // Half of what hangs on it.
        tensile_strength: 0.5 * weight * height,
        static_friction: 0.6,
        dynamic_friction: 0.6,
        cohesion_loss: true,
    })
    .unwrap();
    let pairs = column.surfaces[0].pairs.clone();
    let built = || {
        let joint = Joint::new("seam", pairs.clone(), law).unwrap();
        let roof = Support::fixed(column.level(height + above));
        let builder = column.along(2).support(roof);
        sprung(builder, &column.level(0.0), 2, stiffness)
            .gravity(Vec3::z() * -gravity, Box::new(|_: f64| 1.0))
            .constraint(Box::new(joint))
    };
    newton_refuses(built(), "seam");
    let mut model = built().build().unwrap();
    relaxed(&mut model);
    let pressed = 0.5 * weight * height * height / medium.constrained();
    let hangs = 0.5 * weight * above * above / medium.constrained();
    let expected = weight * height / stiffness + pressed - hangs;
    for (pair, record) in pairs.iter().zip(records(&model)) {
        let [below, above] = pair.nodes.map(|node| model.displacement(node).z);
        let opening = (above - below).abs();
        assert!(
            (opening - expected).abs() < 1.0e-8 * expected,
            "{opening} {expected}"
        );
        assert_eq!(
            (record.state.contact, record.state.bond),
            (ContactState::Open, Bond::Broken)
        );
        assert_eq!(record.traction, Vec3::zeros());
    }
}

/// A block on rough ground, pushed by more than friction holds, slides until springs take what is
/// left, to 1e-7: `m (a - mu g)`, wherever the ground presses more or less on it.
#[test]
fn a_block_slides_over_rough_ground() {
    let (size, medium) = (Vec3::new(6.0, 6.0, 4.0), media::ROCK);
    let whole = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 4, 4], "ground").unwrap();
    let low = whole.elements_in_box(&Vec3::zeros(), &Vec3::new(6.0, 6.0, 2.0));
    let high: Vec<u32> = (0..whole.element_count() as u32)
        .filter(|element| !low.contains(element))
        .collect();
    let split = whole.split_between(&low, &high).unwrap();
    let (mesh, options) = (split.mesh, SurfaceOptions::within(1.0e-6).unwrap());
    let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
    let (gravity, push, friction, stiffness) = (9.81, 7.0, 0.4, 1.0e8);
    let law = BondedCoulomb::unbonded(0.5, friction).unwrap();
    let joint = Joint::new("base", surface.pairs.clone(), law).unwrap();
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    let nodes = |face: &str| mesh.nodes_of_facets(mesh.facet_set(face).unwrap());
    let top = nodes("top");
    let builder = Model::builder(&mesh)
        .elements(
            "ground",
            elastic("ground", kernel, medium, Default::default()),
        )
        .support(Support::fixed(nodes("bottom")))
        .gravity(Vec3::new(push, 0.0, -gravity), Box::new(|_: f64| 1.0))
        .constraint(Box::new(joint));
    let mut model = sprung(builder, &top, 0, stiffness).build().unwrap();
    relaxed(&mut model);
    let moved: f64 = top.iter().map(|&node| model.displacement(node).x).sum();
    let held = stiffness * moved / top.len() as f64;
    let mass = medium.density * 6.0 * 6.0 * 2.0;
    let expected = mass * (push - friction * gravity);
    assert!(
        (held - expected).abs() < 1.0e-7 * mass * gravity,
        "{held} {expected}"
    );
    let pressures: Vec<f64> = records(&model).iter().map(|r| -r.traction.x).collect();
    let most = pressures.iter().fold(0.0, |a: f64, b| a.max(*b));
    let least = pressures.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    assert!(least > 0.0 && most > 1.5 * least, "{least} {most}");
}
