//! The engine against a naive one that shares no code with it: the same scene in both, node by node.

mod conditions;
mod elements;
mod naive;
mod plain;
mod scene;

use powerhouse::engine::{Explicit, Leapfrog};
use powerhouse_elements::{Hex8OnePoint, SolidKernel};
use powerhouse_material_damage::{LinearElastic, media};
use powerhouse_model::{
    BlockFactory, BlockOptions, Engine, Mesh, MeshError, ModelSpec, Rayleigh, RunOptions,
    StepChoice, Vec3,
};

use naive::Naive;
use plain::Plain;

/// Name of the element set of every mesh.
const SET: &str = "rock";
const STEPS: u64 = 200;
/// Largest difference of displacements and velocities over the largest of them.
const LIMIT: f64 = 1e-12;

/// A function that adds what acts on a model to its specification.
type Conditions<'m, 'c> = dyn Fn(ModelSpec<'m>) -> ModelSpec<'m> + 'c;

/// A scene: mesh, initial velocity (m/s) and what acts on the body.
struct Case<'m, 'c> {
    name: String,
    mesh: &'m Mesh,
    /// Largest initial velocity (m/s).
    speed: f64,
    conditions: &'c Conditions<'m, 'c>,
}

/// Displacements and velocities at the end.
struct Motion([Vec<Vec3>; 2]);

impl Motion {
    /// Largest difference of displacements and of velocities, over the largest of them.
    fn differences(&self, other: &Self) -> [f64; 2] {
        core::array::from_fn(|i| {
            let size = self.0[i].iter().map(|v| v.norm()).fold(0.0, f64::max);
            assert!(size > 0.0, "nothing moves");
            let pairs = self.0[i].iter().zip(&other.0[i]);
            pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size
        })
    }
}

impl Case<'_, '_> {
    fn velocity(&self) -> Vec<Vec3> {
        let of = |x: &Vec3| Vec3::new((1.5 * x.x).sin(), (2.0 * x.y).cos(), (x.x + x.z).sin());
        let positions = self.mesh.positions().iter();
        positions.map(|x| of(x) * self.speed).collect()
    }

    /// The motion after [`STEPS`] steps of a length (s), or of nine tenths of the stable one.
    fn run(
        &self,
        engine: &dyn Engine,
        factory: Box<dyn BlockFactory>,
        step: Option<f64>,
    ) -> (Motion, f64) {
        self.run_from(&self.velocity(), engine, factory, step)
    }

    /// The same from given initial velocities (m/s).
    fn run_from(
        &self,
        velocity: &[Vec3],
        engine: &dyn Engine,
        factory: Box<dyn BlockFactory>,
        step: Option<f64>,
    ) -> (Motion, f64) {
        let spec = ModelSpec::new(self.mesh).elements(SET, factory);
        let mut model = engine.build((self.conditions)(spec)).unwrap();
        let rest = vec![Vec3::zeros(); self.mesh.node_count()];
        model.set_initial(&rest, velocity).unwrap();
        let stable = || 0.9 * model.stable_step(&Leapfrog).unwrap().step;
        let step = step.unwrap_or_else(stable);
        let options = RunOptions::steps(STEPS).with_step(StepChoice::Unchecked(step));
        model
            .run(&Leapfrog, &options, &mut [], &mut |_| {})
            .unwrap();
        let nodes = || 0..self.mesh.node_count() as u32;
        let displacement = nodes().map(|node| model.displacement(node)).collect();
        let velocity = nodes().map(|node| model.velocity(node)).collect();
        (Motion([displacement, velocity]), step)
    }

    /// Fails if the engine with the elements of one factory and the naive engine with those of the other move the body
    /// differently, by more than some permitted differences of displacement and velocity; returns the motion.
    fn check_within(
        &self,
        solid: Box<dyn BlockFactory>,
        plain: Box<dyn BlockFactory>,
        permitted: [f64; 2],
    ) -> Motion {
        let (found, step) = self.run(&Explicit, solid, None);
        let (expected, _) = self.run(&Naive, plain, Some(step));
        let differences = expected.differences(&found);
        assert!(
            differences[0] < permitted[0] && differences[1] < permitted[1],
            "{}: differs by {differences:?} (permitted: {permitted:?})",
            self.name
        );
        found
    }

    /// The same, to rounding.
    fn check(&self, solid: Box<dyn BlockFactory>, plain: Box<dyn BlockFactory>) -> Motion {
        self.check_within(solid, plain, [LIMIT; 2])
    }

    /// The same with elastic elements of one point.
    fn check_elastic(&self) -> Motion {
        let kernel = Hex8OnePoint::default();
        let law = LinearElastic::new(media::ROCK);
        let options = BlockOptions::default();
        let solid = SolidKernel::ONE_POINT.factory(SET, law, options);
        let plain = Plain {
            set: SET,
            kernel,
            law,
            damping: Rayleigh::default(),
        };
        self.check(solid, plain.boxed())
    }
}

/// A box of cells of an element kind; bent, so that no two elements are alike.
fn boxed(make: fn(Vec3, Vec3, [usize; 3], &str) -> Result<Mesh, MeshError>, bend: f64) -> Mesh {
    let straight = make(Vec3::zeros(), Vec3::new(3.5, 2.5, 2.0), [7, 5, 4], SET).unwrap();
    let shift = |x: &Vec3| Vec3::new((3.0 * x.y).sin(), (2.0 * x.z).cos(), (2.5 * x.x).sin());
    straight.map_positions(|x| x + bend * shift(&x)).unwrap()
}

/// The nodes of a named face.
fn face(mesh: &Mesh, name: &str) -> Vec<u32> {
    mesh.nodes_of_facets(mesh.facet_set(name).unwrap())
}
