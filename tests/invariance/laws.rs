//! Independence of the bits from threads, lanes and restarts for laws with yielding and cracking.

use std::sync::{Arc, Mutex};

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse::{Kernel, Material};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown,
    HoekBrownParameters, LeeFenves, Mazars, MohrCoulomb, MohrCoulombParameters, PlasticDamage,
    PlasticDamageParameters, ReferenceFrequency, RelaxationSpectrum, SofteningPlasticity,
    SofteningPlasticityParameters, StrengthFall, TwoSurface, presets,
};
use powerhouse_model::{
    BlockOptions, Cadence, Dynamics, Fields, Flow, ForceTerms, FrequencyLimits, LaneWidth,
    MassDampingRule, Mesh, ModelError, Observer, Precision, RunError, RunOptions, State,
    StepChoice, StepView, TimeIntegrator, Vec3,
};

/// Configuration of a run.
#[derive(Clone, Copy)]
struct Division {
    lanes: LaneWidth,
    threads: usize,
    /// Whether another model continues from the state after half of the steps.
    interrupted: bool,
    /// Whether forces may be evaluated again before the drift, so that both trial and committed history
    /// variables are stored.
    again: bool,
    /// Whether there is an observer.
    watched: bool,
}

/// The central difference method, declared so that forces may be evaluated again.
struct Again;

impl TimeIntegrator for Again {
    fn name(&self) -> &'static str {
        "again"
    }
    fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError> {
        Leapfrog.stable_step(limits)
    }
    fn check(&self, limits: &FrequencyLimits, step: f64) -> Result<(), RunError> {
        Leapfrog.check(limits, step)
    }
    fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError> {
        dynamics.forces(ForceTerms::PLAIN, step)?;
        dynamics.kick(MassDampingRule::Implicit, step)?;
        dynamics.constrain(step)?;
        dynamics.drift(step);
        Ok(())
    }
}

/// Stresses (Pa) and energies (J) that the observer reads at intervals.
#[derive(Clone, Default)]
struct Seen {
    stresses: Vec<f64>,
    energies: Vec<f64>,
    /// Changes of stress of the model after the run (Pa).
    at_end: Vec<f64>,
}

struct Shown(Arc<Mutex<Seen>>);

impl Observer for Shown {
    fn name(&self) -> &str {
        "shown"
    }
    fn fields(&self) -> Fields {
        let mut fields = Fields::default();
        (fields.stress, fields.energy) = (true, true);
        fields
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(7)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let mut seen = self.0.lock().unwrap();
        for element in 0..7 * 5 * 4 {
            seen.stresses.extend(view.stress(element).0);
        }
        let energies = view.energies().iter().map(|(_, energy)| *energy);
        seen.energies.extend(energies);
        Ok(Flow::Continue)
    }
}

/// A distorted box that fills no lane evenly, in motion with partial yielding; with one lane a part has more
/// elements than a law evaluates at once.
fn state(
    material: &Material,
    kernel: SolidKernel,
    precision: Precision,
    division: Division,
) -> (State, Seen) {
    let boxed = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(3.5, 2.5, 2.0), [7, 5, 4], "rock");
    let shift = |x: &Vec3| Vec3::new((3.0 * x.y).sin(), (2.0 * x.z).cos(), (2.5 * x.x).sin());
    let mesh = boxed
        .unwrap()
        .map_positions(|x| x + 0.05 * shift(&x))
        .unwrap();
    let mut options = BlockOptions::default();
    options.precision = precision;
    options.lanes = division.lanes;
    let build = || {
        let factory = Kernel::from(kernel).factory("rock", material, options);
        let builder = Model::builder(&mesh).elements("rock", factory);
        builder
            .threads(division.threads)
            .block_size(48)
            .build()
            .unwrap()
    };
    let velocity = |x: &Vec3| Vec3::new((1.5 * x.x).sin(), (2.0 * x.y).cos(), (x.x + x.z).sin());
    let velocities: Vec<Vec3> = mesh.positions().iter().map(|x| velocity(x) * 0.5).collect();
    let mut model = build();
    let rest = vec![Vec3::zeros(); mesh.node_count()];
    model.set_initial(&rest, &velocities).unwrap();
    let seen = Arc::new(Mutex::new(Seen::default()));
    let steps = |model: &mut Model, count| {
        let options = RunOptions::steps(count).with_step(StepChoice::Unchecked(2e-5));
        let integrator: &dyn TimeIntegrator = if division.again { &Again } else { &Leapfrog };
        let mut observers: Vec<Box<dyn Observer>> = Vec::new();
        if division.watched {
            observers.push(Box::new(Shown(seen.clone())));
        }
        run(model, integrator, &options, &mut observers, &mut |_| {}).unwrap();
    };
    steps(&mut model, 30);
    if division.interrupted {
        let state = model.state();
        model = build();
        model.set_state(&state).unwrap();
    }
    steps(&mut model, 30);
    let mut seen = seen.lock().unwrap().clone();
    let changes = model.stress_changes().into_iter();
    seen.at_end = changes.flat_map(|stress| stress.0).collect();
    (model.state(), seen)
}

/// Fails if threads, lanes, a restart or the storage of new history variables change a bit.
fn check(law: impl Into<Material>) {
    let law = law.into();
    let whole = Division {
        lanes: LaneWidth::Native,
        threads: 1,
        interrupted: false,
        again: false,
        watched: true,
    };
    let kernels = [SolidKernel::ALL[0], SolidKernel::Hex8Full];
    for (kernel, precision) in kernels
        .into_iter()
        .flat_map(|kernel| [Precision::F64, Precision::Mixed].map(|precision| (kernel, precision)))
    {
        let reference = state(&law, kernel, precision, whole);
        let most = |name: &str| {
            let fields = reference
                .0
                .history
                .iter()
                .filter(|field| field.name == name);
            fields
                .flat_map(|field| field.values.clone())
                .fold(0.0, f64::max)
        };
        let spent = most("equivalent_plastic_strain").max(most("damage"));
        assert!(spent > 1e-6, "{} does not yield: {spent}", law.name());
        for (what, other) in [
            (
                "three threads",
                Division {
                    threads: 3,
                    ..whole
                },
            ),
            (
                "one lane",
                Division {
                    lanes: LaneWidth::One,
                    ..whole
                },
            ),
            (
                "a restart",
                Division {
                    interrupted: true,
                    ..whole
                },
            ),
            (
                "two histories",
                Division {
                    again: true,
                    ..whole
                },
            ),
            (
                "nobody looks on",
                Division {
                    watched: false,
                    ..whole
                },
            ),
        ] {
            let found = state(&law, kernel, precision, other);
            let bits = |(state, seen): &(State, Seen)| -> Vec<u64> {
                let motion = state.displacement.iter().chain(&state.velocity);
                let history = state.history.iter().flat_map(|field| &field.values);
                let numbers = motion.flat_map(|v| v.iter()).chain(history);
                let shown = seen.stresses.iter().filter(|_| other.watched);
                let numbers = numbers.chain(&seen.at_end).chain(shown);
                numbers.map(|number| number.to_bits()).collect()
            };
            let case = format!("{} {} {precision:?}: {what}", law.name(), kernel.name());
            assert_eq!(bits(&reference).len(), bits(&found).len(), "{case}");
            assert!(bits(&reference) == bits(&found), "{case}");
            // The rounding of sums over a body depends on its division.
            if other.again {
                assert_eq!(reference.1.energies, found.1.energies, "{case}");
                assert!(found.1.energies.iter().any(|energy| *energy > 0.0));
            }
        }
    }
}

/// For plastic laws motion, plastic strains, yield states and stresses have the same bits for any number of
/// threads and lanes, across a restart from the state, and whether history variables are updated in place or
/// not; then also the energies.
#[test]
fn plastic_laws_have_the_same_bits() {
    let rock = presets::PAPER_ROCK;
    check(ElastoPlastic::new(MohrCoulomb::new(rock).unwrap()));
    let MohrCoulombParameters {
        medium,
        friction,
        cohesion,
        ..
    } = rock;
    let cone = DruckerPrager::new(DruckerPragerParameters {
        medium,
        friction,
        dilation: 10.0,
        cohesion,
        fit: ConeFit::Inscribed,
    });
    check(ElastoPlastic::new(cone.unwrap()));
    check(ElastoPlastic::new(
        TwoSurface::new(presets::PAPER_ROCK_LISTED).unwrap(),
    ));
}

/// Laws with damage have the same bits.
#[test]
fn laws_with_damage_have_the_same_bits() {
    check(presets::paper_concrete().unwrap());
    let paper = presets::paper_concrete().unwrap();
    let listed = PlasticDamageParameters {
        surface: TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap(),
        tension: paper.parameters().tension,
        compression: paper.parameters().compression,
        stiffness_recovery: 0.5,
        residual_stiffness: 1e-3,
    };
    check(PlasticDamage::new(listed).unwrap());
    check(Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap());
}

/// Laws with a scalar iteration, and one with damping in series, whose mechanisms have history variables, too,
/// have the same bits.
#[test]
fn iterated_and_damped_laws_have_the_same_bits() {
    let mass = HoekBrown::new(HoekBrownParameters {
        medium: presets::PAPER_ROCK.medium,
        intact_strength: 5.0e7,
        intact_constant: 10.0,
        strength_index: 40.0,
        disturbance: 0.0,
        dilation_share: 0.3,
    });
    check(ElastoPlastic::new(mass.unwrap()));
    check(LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap());
    let rock = MohrCoulomb::new(presets::PAPER_ROCK).unwrap();
    let softening = SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: rock,
        fall: StrengthFall::FractureEnergy { energy: 2.0e4 },
        residual_strength: 0.1,
    });
    check(softening.unwrap());
    let band = DampingBand {
        ratio: 0.05,
        lowest: 5.0,
        highest: 500.0,
        mechanisms: 2,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let rock = Material::from(ElastoPlastic::new(rock));
    let damped = rock.damped(&spectrum, ReferenceFrequency::Centre).unwrap();
    check(damped.unwrap());
}
