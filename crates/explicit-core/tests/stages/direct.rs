//! The direct solver against the conjugate gradients.

use powerhouse_elements::{BoltLine, BoltParameters, BoltSet};
use powerhouse_explicit_core::{BuildModel, Model, run_stages};
use powerhouse_model::{
    BlockOptions, ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput, Linearisation,
    Mesh, ModelSpec, Precision, Prescribed, Stage, StageModel, State, StaticError, StaticMethod,
    StaticOptions, StaticReport, Stress, Support, Vec3,
};

use super::ties::{Weld, cut_through};
use super::{
    BRICK, GRAVITY, absorbing, bent_box, elastic_body, face_nodes, largest, on_rollers, rock, weak,
};

const ELASTIC: StaticMethod = StaticMethod::Cholesky(Linearisation::Elastic);
const TANGENT: StaticMethod = StaticMethod::Cholesky(Linearisation::Tangent);

fn by(method: StaticMethod) -> StaticOptions {
    let options = StaticOptions::default().with_tolerance(1.0e-11);
    options.with_method(method)
}

/// The displacement of a model in static equilibrium, and the report of the solution.
fn at_rest(builder: ModelSpec, method: StaticMethod) -> (Vec<Vec3>, StaticReport) {
    let mut model = builder.build().unwrap();
    let report = model.equilibrate(&by(method), &mut |_| {}).unwrap();
    let nodes = 0..model.mesh().node_count() as u32;
    (nodes.map(|node| model.displacement(node)).collect(), report)
}

/// Both solvers leave the same displacement, to 1e-8 of the largest.
fn same(a: &[Vec3], b: &[Vec3]) {
    let size = largest(a.iter().copied());
    assert!(size > 1.0e-6);
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).norm() < 1.0e-8 * size, "{a} {b} {size}");
    }
}

/// A bent block with a cavern, bolts into its roof, rollers at an angle, a face with prescribed motion and
/// one on springs comes to the same rest by the direct solver as by conjugate gradients, to 1e-8, in
/// one correction and with one factor; so does one that is cut in two and welded.
#[test]
fn elastic_bodies_rest_alike() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 40.0), [8, 6, 8], 1.0);
    let cavern = mesh.elements_in_box(&Vec3::new(15.0, 10.0, 10.0), &Vec3::new(25.0, 20.0, 20.0));
    let mut state = State::at_rest(mesh.node_count());
    state.remove(&cavern);
    let roof = [Vec3::new(18.0, 14.0, 21.0), Vec3::new(22.0, 17.0, 36.0)];
    let lines = [BoltLine {
        head: roof[0],
        toe: roof[1],
    }];
    let hosts: Vec<u32> = (0..mesh.element_count() as u32)
        .filter(|element| !cavern.contains(element))
        .collect();
    let steel = BoltParameters::steel(0.05).unwrap();
    let bolts = BoltSet::new("bolts", &mesh, &hosts, &lines, steel).unwrap();
    let built = || {
        let oblique = Vec3::new(1.0, 0.5, -0.3);
        let motion = Prescribed {
            nodes: face_nodes(&mesh, "right"),
            direction: Vec3::x(),
            displacement: Box::new(|_: f64| -2.0e-3),
        };
        elastic_body(&mesh)
            .start(state.clone())
            .support(Support::roller(face_nodes(&mesh, "left"), oblique))
            .support(Support::roller(face_nodes(&mesh, "front"), Vec3::y()))
            .support(Support::roller(face_nodes(&mesh, "bottom"), Vec3::z()))
            .prescribed(motion)
            .embed(Box::new(bolts.clone()))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
    };
    let (expected, gradients) = at_rest(built(), StaticMethod::default());
    let (found, direct) = at_rest(built(), ELASTIC);
    same(&expected, &found);
    assert_eq!((direct.factorisations, direct.products), (1, 0));
    assert!(direct.corrections <= 2 && direct.factor_entries > 0);
    assert!(gradients.products > 50 && gradients.factorisations == 0);

    let sprung = || {
        let builder = absorbing(&mesh, elastic_body(&mesh), 30.0);
        builder.gravity(GRAVITY + Vec3::y(), Box::new(|_: f64| 1.0))
    };
    let expected = at_rest(sprung(), StaticMethod::default()).0;
    same(&expected, &at_rest(sprung(), ELASTIC).0);

    let whole = bent_box(Vec3::new(8.0, 6.0, 9.0), [4, 3, 6], 0.3);
    let (cut, pairs) = cut_through(&whole, 4.5);
    let welded = || {
        elastic_body(&cut)
            .support(Support::fixed(face_nodes(&cut, "bottom")))
            .constraint(Box::new(Weld::new(pairs.clone())))
            .gravity(GRAVITY + Vec3::x(), Box::new(|_: f64| 1.0))
    };
    let expected = at_rest(welded(), StaticMethod::default()).0;
    same(&expected, &at_rest(welded(), ELASTIC).0);
}

/// Rock that yields under its weight and around what is excavated comes to the same state by the
/// elastic factor and by tangents as by conjugate gradients, to 1e-8. Tangents, which are symmetric
/// here, take fewer corrections.
#[test]
fn yielding_stages_rest_alike() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 40.0), [8, 6, 8], 1.0);
    let cavern = mesh.elements_in_box(&Vec3::new(15.0, 10.0, 10.0), &Vec3::new(25.0, 20.0, 20.0));
    let body: Box<StageModel> = Box::new(|builder| {
        let builder = builder.elements("ground", weak("ground", Precision::F64));
        Ok(on_rollers(&mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    });
    let staged = |method| {
        let stages = [
            Stage::new("weight", &body).options(by(method)),
            Stage::new("excavation", &body)
                .excavate(&cavern)
                .options(by(method)),
        ];
        let first = State::at_rest(mesh.node_count());
        let (state, reports) = run_stages(&mesh, first, &stages, &mut |_| {}).unwrap();
        let corrections: u32 = reports.iter().map(|r| r.solution.corrections).sum();
        (state, corrections)
    };
    let (expected, _) = staged(StaticMethod::default());
    let plastic = |state: &State| -> Vec<f64> {
        let fields = state.history.iter();
        let wanted = fields.filter(|field| field.name == "equivalent_plastic_strain");
        wanted.flat_map(|field| field.values.clone()).collect()
    };
    let flowed = plastic(&expected);
    assert!(flowed.iter().filter(|&&strain| strain > 0.0).count() > 100);
    let most = flowed
        .iter()
        .fold(0.0, |most: f64, strain| most.max(*strain));
    let (by_elastic, elastic) = staged(ELASTIC);
    let (by_tangent, tangent) = staged(TANGENT);
    println!("corrections: elastic {elastic}, tangent {tangent}");
    for other in [by_elastic, by_tangent] {
        same(&expected.displacement, &other.displacement);
        for (a, b) in flowed.iter().zip(plastic(&other)) {
            assert!((a - b).abs() < 1.0e-7 * most, "{a} {b}");
        }
    }
    assert!(2 * tangent < elastic, "{tangent} {elastic}");
}

/// A direct solution has the same bits on one thread and on two.
#[test]
fn threads_do_not_change_a_factor() {
    let mesh = bent_box(Vec3::new(30.0, 30.0, 30.0), [12, 12, 12], 1.0);
    let on = |threads| {
        let builder = on_rollers(&mesh, elastic_body(&mesh)).threads(threads);
        at_rest(builder.gravity(GRAVITY, Box::new(|_: f64| 1.0)), ELASTIC).0
    };
    assert!(on(1) == on(2));
}

/// Rock whose stress falls as it is strained further, in its tangent.
#[derive(Clone)]
struct Falling(ElasticMedium);

impl ConstitutiveLaw for Falling {
    fn name(&self) -> &str {
        "falling"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &[HistoryVariable] {
        &[const { HistoryVariable::amount("nothing", "1") }]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let number = |value: f64| input.strain.0[0].constant(value);
        new_history[0] = number(0.0);
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(number(lambda), number(shear), &input.strain)
    }
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        Some(core::array::from_fn(|row| {
            core::array::from_fn(|column| if row == column { -1.0e11 } else { 0.0 })
        }))
    }
}

/// A tangent that is not positive definite is refused with a node of the set that softens; the
/// elastic factor of the same body exists.
#[test]
fn an_indefinite_tangent_is_named() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(8.0), [4, 4, 4], "ground").unwrap();
    let soft = mesh.elements_in_box(&Vec3::repeat(2.0), &Vec3::repeat(6.0));
    let hard: Vec<u32> = (0..mesh.element_count() as u32)
        .filter(|element| !soft.contains(element))
        .collect();
    let built = || {
        let falling = BRICK.factory("seam", Falling(rock()), BlockOptions::default());
        let builder = Model::builder(&mesh)
            .elements(hard.clone(), super::elastic("ground", rock()))
            .elements(soft.clone(), falling);
        on_rollers(&mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0))
    };
    let mut model = built().build().unwrap();
    match model.equilibrate(&by(TANGENT), &mut |_| {}).unwrap_err() {
        StaticError::NotDefinite { node, .. } => {
            let inside = mesh.nodes_of_elements(&soft);
            let tags = inside.iter().map(|&node| mesh.node_tags()[node as usize]);
            assert!(tags.into_iter().any(|tag| tag == node), "{node}");
        }
        other => panic!("{other}"),
    }
    at_rest(built(), ELASTIC);
}
