//! Tractions of joints, pair by pair, in static equilibrium and at the start of a run: where supports hold pairs, where
//! facets meet at edges, and from one stage to the next.

mod body;
mod given;
mod loaded;
mod newmark;

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    BondedCoulomb, Cohesive, CohesiveParameters, Joint, StrengthReduction, Tied,
};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{
    BoundaryParts, Constraint, ContactLaw, ElasticMedium, Mat3, ModelSpec, NodalImpedance,
    Prescribed, RunOptions, State, StaticMethod, StaticOptions, Support, Vec3,
};
use powerhouse_tests::elastic;

pub(crate) use body::{Body, Cut};

/// Random numbers of a seed.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    /// A number from 0 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }
    pub(crate) fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.between(-size, size))
    }
    pub(crate) fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.share() * choices.len() as f64) as usize]
    }
}

/// A contact law that admits the tractions of these bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Law {
    Tied,
    Friction,
    Cohesive,
}

impl Law {
    pub(crate) const ALL: [Self; 3] = [Self::Tied, Self::Friction, Self::Cohesive];

    pub(crate) fn joint(self, body: &Body) -> Box<dyn Constraint> {
        let law: Box<dyn ContactLaw> = match self {
            Self::Tied => Box::new(Tied),
            Self::Friction => Box::new(BondedCoulomb::unbonded(8.0, 8.0).unwrap()),
            Self::Cohesive => Box::new(
                Cohesive::new(CohesiveParameters {
                    tensile_strength: 1.0e8,
                    cohesion: 1.0e8,
                    opening_energy: 1.0e6,
                    shear_energy: 1.0e6,
                    mode_exponent: 2.0,
                    static_friction: 0.6,
                    dynamic_friction: 0.6,
                    reduction: StrengthReduction::None,
                })
                .unwrap(),
            ),
        };
        let pairs = body.surface.pairs.clone();
        Box::new(Joint::new("joint", pairs, law).unwrap())
    }
}

/// What holds the faces of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Held {
    /// All nodes of all faces in all directions.
    Fixed,
    /// The same by prescribed motions that stay zero.
    Prescribed,
    /// Rollers on the faces across x and y, and fixed faces across z.
    Rollers,
    /// Rollers on the faces across x and y, a fixed face below, a free one above.
    Ground,
    /// The first side as a whole; the second is free.
    FirstSide,
    /// Springs and dashpots in place of all supports.
    Absorbing,
    /// The same, but for rollers across y, as at the ends of a slice.
    Slice,
}

impl Held {
    pub(crate) fn on<'a>(self, body: &Body, mut spec: ModelSpec<'a>) -> ModelSpec<'a> {
        let both = [-1.0, 1.0];
        let rollers = |spec: ModelSpec<'a>, axis: usize| {
            spec.support(Support::roller(body.faces(axis, &both), body.axes[axis]))
        };
        match self {
            Self::Fixed => spec.support(Support::fixed(body.outside())),
            Self::Prescribed => {
                for direction in body.axes {
                    spec = spec.prescribed(Prescribed {
                        nodes: body.outside(),
                        direction,
                        displacement: Box::new(|_: f64| 0.0),
                    });
                }
                spec
            }
            Self::Rollers => {
                rollers(rollers(spec, 0), 1).support(Support::fixed(body.faces(2, &both)))
            }
            Self::Ground => {
                rollers(rollers(spec, 0), 1).support(Support::fixed(body.faces(2, &[-1.0])))
            }
            Self::FirstSide => {
                spec.support(Support::fixed(body.mesh.nodes_of_set("first").unwrap()))
            }
            Self::Absorbing => absorbing(spec, &body.outside()),
            Self::Slice => {
                let mut nodes = body.faces(0, &both);
                nodes.extend(body.faces(2, &[-1.0]));
                nodes.sort_unstable();
                nodes.dedup();
                absorbing(rollers(spec, 1), &nodes)
            }
        }
    }
}

fn absorbing<'a>(spec: ModelSpec<'a>, nodes: &[u32]) -> ModelSpec<'a> {
    let spring = Mat3::new(3.0e8, 1.0e7, 0.0, 1.0e7, 2.0e8, 0.0, 0.0, 0.0, 2.5e8);
    let dashpot = spring * 2.0e-2;
    let of = |&node: &u32| NodalImpedance::new(node, spring, dashpot);
    spec.boundary(BoundaryParts::default().with_impedance(nodes.iter().map(of)))
}

/// A model in the making of the bricks of a body and its joint.
pub(crate) fn spec<'a>(
    body: &'a Body,
    kernel: SolidKernel,
    media: [ElasticMedium; 2],
    law: Law,
) -> ModelSpec<'a> {
    spec_with(body, kernel, media, law.joint(body))
}

/// The same with a joint of its own.
pub(crate) fn spec_with<'a>(
    body: &'a Body,
    kernel: SolidKernel,
    media: [ElasticMedium; 2],
    joint: Box<dyn Constraint>,
) -> ModelSpec<'a> {
    let sides = ["first", "second"].into_iter().zip(media);
    let spec = sides.fold(
        Model::builder(&body.mesh).threads(1),
        |spec, (set, medium)| {
            let factory = elastic(set, kernel, medium, Default::default());
            spec.elements(set, factory)
        },
    );
    spec.constraint(joint)
}

/// Static equilibrium by a method to a tolerance; the state from which the next stage begins.
pub(crate) fn settled(body: &Body, spec: ModelSpec, method: StaticMethod, tolerance: f64) -> State {
    let mut model = spec.build().unwrap();
    let options = StaticOptions::default()
        .with_method(method)
        .with_tolerance(tolerance);
    model.equilibrate(&options, &mut |_| {}).unwrap();
    model.state().next_stage(body.mesh.node_count())
}

/// Tractions of all pairs (Pa, in space).
pub(crate) fn tractions(body: &Body, state: &State) -> Vec<Vec3> {
    let records = state.joints.iter().flat_map(|joint| &joint.records);
    let pairs = body.surface.pairs.iter().zip(records);
    pairs
        .map(|(pair, record)| pair.to_global(&record.traction))
        .collect()
}

/// Greatest difference of two lists of tractions over the greatest traction.
pub(crate) fn difference(found: &[Vec3], expected: &[Vec3]) -> f64 {
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let error = most(&mut found.iter().zip(expected).map(|(a, b)| (a - b).norm()));
    error / most(&mut expected.iter().map(|t| t.norm()))
}

/// Tractions after some steps of a run without input from the state of a stage.
pub(crate) fn at_rest(body: &Body, spec: ModelSpec, state: &State, steps: u64) -> Vec<Vec3> {
    let mut model = spec.start(state.clone()).build().unwrap();
    model.hand_over(1.0e-6).unwrap();
    let options = RunOptions::steps(steps);
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    tractions(body, &model.state())
}

/// Rock, and a second medium of another stiffness and density.
pub(crate) fn two_media(random: &mut Random) -> [ElasticMedium; 2] {
    let other = ElasticMedium {
        young: media::ROCK.young * random.between(0.1, 4.0),
        poisson: random.between(0.1, 0.35),
        density: media::ROCK.density * random.between(0.6, 1.2),
    };
    [media::ROCK, other]
}
