//! Dynamic relaxation of bodies without joints.

use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_model::{
    BlockOptions, ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput, Mesh, ModelSpec,
    Precision, Prescribed, StaticError, StaticMethod, StaticOptions, StaticReport, Stress, Support,
    Vec3,
};

use super::{
    BRICK, GRAVITY, absorbing, bent_box, elastic_body, face_nodes, largest, on_rollers, rock, weak,
};

fn at_rest(builder: ModelSpec, options: &StaticOptions) -> (Vec<Vec3>, StaticReport) {
    let mut model = builder.build().unwrap();
    let report = model.equilibrate(options, &mut |_| {}).unwrap();
    let nodes = 0..model.mesh().node_count() as u32;
    (nodes.map(|node| model.displacement(node)).collect(), report)
}

/// Compares the displacements of a body under its weight by both methods.
fn alike<'a>(built: &dyn Fn() -> ModelSpec<'a>, increments: u32) {
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

/// Elastic bodies on an oblique roller or on springs, and one that yields, reach the same equilibrium by
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

/// A solution that has too few steps or corrections says so, where the forces are that do not
/// balance, and what may do; the model is where it was.
#[test]
fn what_ends_early_is_no_rest() {
    let mesh = bent_box(Vec3::new(40.0, 30.0, 30.0), [6, 5, 4], 1.0);
    for (method, advice) in [
        (StaticMethod::DynamicRelaxation, "more steps"),
        (StaticMethod::ConjugateGradients, "dynamic relaxation"),
    ] {
        let body = Model::builder(&mesh).elements("ground", weak("ground", Precision::F64));
        let mut model = on_rollers(&mesh, body)
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .build()
            .unwrap();
        let options = StaticOptions {
            steps: 10,
            corrections: 1,
            least_increment: 0.5,
            ..StaticOptions::default().with_method(method)
        };
        let refused = model.equilibrate(&options, &mut |_| {}).unwrap_err();
        assert!(matches!(&refused, StaticError::NotConverged { set, .. } if set == "ground"));
        assert!(refused.to_string().contains(advice), "{refused}");
        let mut nodes = 0..mesh.node_count() as u32;
        assert!(nodes.all(|node| model.displacement(node) == Vec3::zeros()));
    }
}

/// Loses its stiffness as it is stretched: the stress falls from its peak, at the strain `first`, in
/// a straight line to none at `last`.
#[derive(Clone)]
struct Softening {
    medium: ElasticMedium,
    first: f64,
    last: f64,
}

impl ConstitutiveLaw for Softening {
    fn name(&self) -> &str {
        "softening"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &[const { HistoryVariable::amount("largest_strain", "1") }]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let number = |value: f64| input.strain.0[0].constant(value);
        let [x, y, z, ..] = input.strain.0;
        let strain = (x * x + y * y + z * z).sqrt().max(input.history[0]);
        new_history[0] = strain;
        let (first, last) = (number(self.first), number(self.last));
        let falls = first * (last - strain) / (strain.max(first) * (last - first));
        let left = falls
            .max(number(0.0))
            .select(first.less(strain), number(1.0));
        let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
        Stress::elastic(number(lambda) * left, number(shear) * left, &input.strain)
    }
}

/// A bar of five bricks, the middle one weaker than the others, that is drawn past its peak: the weak
/// one softens along its line, the others give back, and the stress is that at which their strains
/// add up to what is prescribed, `4 s / M + e(s) = u / h`, to 1e-8.
#[test]
fn a_bar_is_drawn_down_its_softening_branch() {
    let size = Vec3::new(5.0, 1.0, 1.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [5, 1, 1], "all").unwrap();
    mesh.set_element_set("weak", vec![2]).unwrap();
    mesh.set_element_set("strong", vec![0, 1, 3, 4]).unwrap();
    let (first, last, drawn) = (1.0e-4, 1.2e-3, 8.0e-4);
    let bricks = |set: &str, first: f64| {
        let medium = rock();
        let law = Softening {
            medium,
            first,
            last,
        };
        BRICK.factory(set, law, BlockOptions::default())
    };
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut model = Model::builder(&mesh)
        .elements("weak", bricks("weak", first))
        .elements("strong", bricks("strong", 1.2 * first))
        .support(Support::roller(all.clone(), Vec3::y()))
        .support(Support::roller(all, Vec3::z()))
        .support(Support::roller(face_nodes(&mesh, "left"), Vec3::x()))
        .prescribed(Prescribed {
            nodes: face_nodes(&mesh, "right"),
            direction: Vec3::x(),
            displacement: Box::new(move |_: f64| drawn),
        })
        .build()
        .unwrap();
    let options = StaticOptions::default()
        .with_method(StaticMethod::DynamicRelaxation)
        .with_tolerance(1.0e-11)
        .with_increments(20);
    let report = model.equilibrate(&options, &mut |_| {}).unwrap();
    println!("{report:?}");
    // e = last - (last - first) s / (M first).
    let share = (last - drawn) / ((last - first) / first - 4.0);
    let expected = share * rock().constrained();
    assert!(expected < 0.6 * first * rock().constrained());
    for stress in model.stress_changes() {
        let error = (stress.0[0] - expected).abs();
        assert!(error < 1.0e-8 * expected, "{} {expected}", stress.0[0]);
    }
}
