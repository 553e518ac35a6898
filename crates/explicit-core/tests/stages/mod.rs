//! From the first stress to the earthquake.

mod bolt_blocks;
mod bolts;
#[cfg(feature = "direct")]
mod direct;
mod excavation;
mod hand_over;
mod incompressible;
mod initial_stress;
mod joints;
mod kirsch;
mod refused;
mod relaxation;
mod sections;
mod ties;

use powerhouse_elements::{Hex8OnePoint, SolidKernel};
use powerhouse_explicit_core::Model;
use powerhouse_model::{
    BlockFactory, BlockOptions, ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput,
    Mesh, ModelSpec, NodalImpedance, Precision, Strain, Stress, Support, Vec3,
};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
const SIDES: [(&str, Vec3); 5] = [
    ("left", Vec3::new(1.0, 0.0, 0.0)),
    ("right", Vec3::new(1.0, 0.0, 0.0)),
    ("front", Vec3::new(0.0, 1.0, 0.0)),
    ("back", Vec3::new(0.0, 1.0, 0.0)),
    ("bottom", Vec3::new(0.0, 0.0, 1.0)),
];
const BRICK: SolidKernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

/// Linear elasticity.
#[derive(Clone)]
struct Elastic(ElasticMedium);

impl ConstitutiveLaw for Elastic {
    const LINEAR: bool = true;
    fn name(&self) -> &str {
        "elastic"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let one = input.strain.0[0].constant(1.0);
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(one.constant(lambda), one.constant(shear), &input.strain)
    }
}

/// Yields at a deviatoric stress `sqrt(3 s : s / 2)` (Pa) and flows as far as it takes (von Mises).
#[derive(Clone)]
struct Yielding {
    medium: ElasticMedium,
    strength: f64,
}

const PLASTIC: [HistoryVariable; 7] = [
    HistoryVariable::component("plastic_strain_xx", "1"),
    HistoryVariable::component("plastic_strain_yy", "1"),
    HistoryVariable::component("plastic_strain_zz", "1"),
    HistoryVariable::component("plastic_strain_xy", "1"),
    HistoryVariable::component("plastic_strain_yz", "1"),
    HistoryVariable::component("plastic_strain_zx", "1"),
    HistoryVariable::amount("equivalent_plastic_strain", "1"),
];

impl ConstitutiveLaw for Yielding {
    fn name(&self) -> &str {
        "yielding"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &PLASTIC
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let number = |value: f64| input.strain.0[0].constant(value);
        let (lambda, shear) = (number(self.medium.lambda()), self.medium.shear());
        let elastic = Strain([0, 1, 2, 3, 4, 5].map(|i| input.strain.0[i] - input.history[i]));
        let trial = input.initial + Stress::elastic(lambda, number(shear), &elastic);
        let mean = (trial.0[0] + trial.0[1] + trial.0[2]) * number(1.0 / 3.0);
        let mut deviator = trial.0;
        for normal in &mut deviator[..3] {
            *normal = *normal - mean;
        }
        let mut square = number(0.0);
        for (i, s) in deviator.iter().enumerate() {
            square = square + *s * *s * number(if i < 3 { 1.5 } else { 3.0 });
        }
        let measure = square.sqrt();
        let strength = number(self.strength);
        let beyond = strength.less(measure);
        let none = number(0.0);
        let flow = ((measure - strength) * number(1.0 / (3.0 * shear))).select(beyond, none);
        let turn = flow * number(1.5) / measure.max(strength);
        let mut stress = trial - input.initial;
        for i in 0..6 {
            let strain = turn * deviator[i] * number(if i < 3 { 1.0 } else { 2.0 });
            new_history[i] = input.history[i] + strain;
            stress.0[i] = stress.0[i] - turn * deviator[i] * number(2.0 * shear);
        }
        new_history[6] = input.history[6] + flow;
        stress
    }
}

/// Rock that yields where a weight of ten metres of it presses on one axis alone.
fn weak(set: &str, precision: Precision) -> Box<dyn BlockFactory> {
    let law = Yielding {
        medium: rock(),
        strength: 0.25e6,
    };
    let mut options = BlockOptions::default();
    options.precision = precision;
    BRICK.factory(set, law, options)
}

fn elastic(set: &str, medium: ElasticMedium) -> Box<dyn BlockFactory> {
    BRICK.factory(set, Elastic(medium), BlockOptions::default())
}

/// A box of bricks named `ground`, bent inside but with plane faces.
fn bent_box(size: Vec3, cells: [usize; 3], bend: f64) -> Mesh {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "ground").unwrap();
    let mesh = mesh.map_positions(|p| {
        let half = p.component_div(&size) * core::f64::consts::PI;
        let bump = half.x.sin() * half.y.sin() * half.z.sin();
        p + Vec3::new(1.0, -0.7, 0.8) * (bend * bump)
    });
    mesh.unwrap()
}

fn face_nodes(mesh: &Mesh, face: &str) -> Vec<u32> {
    mesh.nodes_of_facets(mesh.facet_set(face).unwrap())
}

/// Elements of a mesh of one set, elastic.
fn elastic_body(mesh: &Mesh) -> ModelSpec<'_> {
    Model::builder(mesh).elements("ground", elastic("ground", rock()))
}

/// Rollers on the sides and at the bottom.
fn on_rollers<'a>(mesh: &Mesh, builder: ModelSpec<'a>) -> ModelSpec<'a> {
    let roll = |builder: ModelSpec<'a>, (face, normal): &(&str, Vec3)| {
        builder.support(Support::roller(face_nodes(mesh, face), *normal))
    };
    SIDES.iter().fold(builder, roll)
}

/// Springs and dashpots on the sides and at the bottom, of rock that reaches `distance` metres on.
fn absorbing<'a>(mesh: &Mesh, builder: ModelSpec<'a>, distance: f64) -> ModelSpec<'a> {
    let medium = rock();
    let mut impedance = Vec::new();
    for (face, normal) in SIDES {
        for part in mesh.tributary_areas(mesh.facet_set(face).unwrap()) {
            let across = normal * normal.transpose();
            let along = powerhouse_model::Mat3::identity() - across;
            let spring = across * medium.constrained() + along * medium.shear();
            let (p, s) = (medium.p_speed(), medium.s_speed());
            impedance.push(NodalImpedance::new(
                part.node,
                spring * (part.area / distance),
                (across * p + along * s) * (medium.density * part.area),
            ));
        }
    }
    builder.boundary(powerhouse_model::BoundaryParts::default().with_impedance(impedance))
}

fn largest(vectors: impl IntoIterator<Item = Vec3>) -> f64 {
    vectors.into_iter().fold(0.0, |most, v| most.max(v.norm()))
}
