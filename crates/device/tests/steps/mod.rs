//! Steps on a device have the bits of the host's: motion, history variables, observers, checkpoints.
//!
//! Kernels run on the emulated device, for which a C++ compiler must be there; without one nothing is compared. With the feature
//! `cuda` they run on a card where there is one.

#[cfg(feature = "cuda")]
mod nvrtc;

use std::sync::{Arc, Mutex};

use powerhouse_device::{EmulatedDevice, EmulatedDevices};
use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{Explicit, ExplicitOnDevice, Leapfrog, OneSided};
use powerhouse_material_damage::{
    DampingBand, ElastoPlastic, FlatDamping, LinearElastic, MohrCoulomb, ReferenceFrequency,
    RelaxationSpectrum, media, presets,
};
use powerhouse_model::{
    BlockOptions, BoundaryParts, Cadence, Cast, CheckpointSink, ElementKind, EnergyCheck, Engine,
    EngineModel, Fields, Flow, HistoryVariable, LawInput, Mat3, Mesh, ModelError, ModelSpec,
    NodalImpedance, NodalLoad, Observer, PeriodicPairs, PointAdapter, PointLaw, Precision,
    Prescribed, Progress, Rayleigh, RunError, RunOptions, SavedRun, State, StateError, StepChoice,
    StepView, Stress, Support, TimeIntegrator, Vec3,
};

/// A box of elements of a kind, distorted.
fn mesh(kind: ElementKind) -> Mesh {
    let (generate, cells): (fn(_, _, _, &str) -> _, [usize; 3]) = match kind {
        ElementKind::Hex8 => (Mesh::box_of_hexes, [7, 5, 6]),
        ElementKind::Wedge6 => (Mesh::box_of_wedges, [5, 4, 4]),
        ElementKind::Pyramid5 => (Mesh::box_of_pyramids, [4, 3, 3]),
        _ => (Mesh::box_of_tets, [4, 3, 3]),
    };
    let high = Vec3::from(cells.map(|count| count as f64));
    let mesh = generate(Vec3::zeros(), high, cells, "rock").unwrap();
    // Faces stay plane and opposite ones alike, for supports and periodic pairs.
    let inside = move |x: &Vec3| {
        let bubble = |x: f64, high: f64| (core::f64::consts::PI * x / high).sin();
        bubble(x.x, high.x) * bubble(x.y, high.y) * bubble(x.z, high.z)
    };
    let shift = |x: &Vec3| Vec3::new((9.0 * x.y).sin(), (7.0 * x.z).cos(), (8.0 * x.x).sin());
    let mesh = mesh
        .map_positions(|x| x + 0.15 * inside(&x) * shift(&x))
        .unwrap();
    match kind {
        ElementKind::Tet10 => mesh.with_midpoints().unwrap(),
        _ => mesh,
    }
}

/// A force that swings, at some nodes.
struct Swing(Vec<u32>, f64);
impl NodalLoad for Swing {
    fn name(&self) -> &str {
        "swing"
    }
    fn nodes(&self) -> &[u32] {
        &self.0
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        for (index, force) in forces.iter_mut().enumerate() {
            let phase = 0.7 * index as f64;
            *force += Vec3::new(0.6, -0.3, 1.0) * self.1 * (900.0 * time + phase).sin();
        }
    }
}

/// Records the motion of a node and the stress of an element.
struct Record {
    every: u64,
    stress: bool,
    numbers: Arc<Mutex<Vec<u64>>>,
}
impl Observer for Record {
    fn name(&self) -> &str {
        "record"
    }
    fn fields(&self) -> Fields {
        Fields::default()
            .with_acceleration(true)
            .with_stress(self.stress)
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(self.every)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let node = view.node_count() as u32 / 2;
        let motion = [
            view.displacement(node),
            view.velocity(node),
            view.acceleration(node),
        ];
        let numbers = motion.iter().flat_map(|v| v.iter().copied());
        let stress = view.stress(3).0.into_iter().filter(|_| self.stress);
        let numbers = numbers.chain(stress).chain([view.time()]);
        self.numbers
            .lock()
            .unwrap()
            .extend(numbers.map(f64::to_bits));
        Ok(Flow::Continue)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        let numbers = self.numbers.lock().unwrap();
        Ok(numbers.iter().flat_map(|bits| bits.to_le_bytes()).collect())
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let numbers = saved.as_chunks().0.iter();
        *self.numbers.lock().unwrap() = numbers.map(|&bytes| u64::from_le_bytes(bytes)).collect();
        Ok(())
    }
}

/// A case: elements, law and what they are damped by.
struct Case {
    kernel: SolidKernel,
    law: AnyLaw,
    options: BlockOptions,
    /// Size of the forces (N).
    force: f64,
    block_size: usize,
}

impl Case {
    fn new(kernel: SolidKernel, law: impl Into<AnyLaw>, precision: Precision) -> Self {
        let mut options = BlockOptions::default();
        options.precision = precision;
        Self {
            kernel,
            law: law.into(),
            options,
            force: 2e5,
            block_size: 60,
        }
    }
    fn damped(mut self, mass: f64, stiffness: f64) -> Self {
        self.options.damping = Rayleigh { mass, stiffness };
        self
    }
    fn force(mut self, force: f64) -> Self {
        self.force = force;
        self
    }

    fn build(&self, engine: &dyn Engine, mesh: &Mesh) -> Result<Box<dyn EngineModel>, ModelError> {
        self.build_with(engine, mesh, |spec| spec)
    }

    /// Builds a model with rollers along and across axes, springs and dashpots along and across them, ties, forces that change
    /// at plain nodes and at nodes of groups, and weight.
    fn build_with<'m>(
        &self,
        engine: &dyn Engine,
        mesh: &'m Mesh,
        change: impl FnOnce(ModelSpec<'m>) -> ModelSpec<'m>,
    ) -> Result<Box<dyn EngineModel>, ModelError> {
        let face = |name: &str| mesh.nodes_of_facets(mesh.facet_set(name).unwrap());
        let (bottom, left) = (face("bottom"), face("left"));
        let [front, back] = [face("front"), face("back")];
        let not_bottom = |nodes: Vec<u32>| -> Vec<u32> {
            nodes.into_iter().filter(|n| !bottom.contains(n)).collect()
        };
        let normal = Vec3::new(1.0, 0.4, -0.2).normalize();
        let along = normal * normal.transpose();
        let slanted = Mat3::identity() * 3e6 + along * 4e7;
        let right = not_bottom(face("right"));
        let impedance = right.iter().map(|&node| {
            let diagonal = Mat3::from_diagonal(&Vec3::new(5e7, 2e7, 3e7));
            match node % 2 {
                0 => NodalImpedance::new(node, diagonal, diagonal * 0.01),
                _ => NodalImpedance::new(node, slanted, slanted * 0.01),
            }
        });
        let impedance: Vec<NodalImpedance> = impedance.collect();
        let mut loaded = face("top");
        loaded.extend(
            right
                .iter()
                .copied()
                .filter(|n| !loaded.contains(n))
                .collect::<Vec<_>>(),
        );
        let tied = |nodes: Vec<u32>| -> Vec<u32> {
            let nodes = not_bottom(nodes).into_iter();
            nodes
                .filter(|n| !left.contains(n) && !right.contains(n))
                .collect()
        };
        let periodic = PeriodicPairs::by_translation(mesh, &tied(front), &tied(back), 1e-9);
        let periodic = periodic.unwrap();
        let spec = ModelSpec::new(mesh)
            .elements(
                "rock",
                self.kernel.factory("rock", self.law.clone(), self.options),
            )
            .support(Support::fixed(bottom.clone()))
            .support(Support::roller(not_bottom(left.clone()), Vec3::x()))
            .periodic(periodic)
            .boundary(BoundaryParts::default().with_impedance(impedance))
            .load(Box::new(Swing(loaded, self.force)))
            .gravity(
                Vec3::new(0.0, 0.0, -9.81),
                Box::new(powerhouse_model::Constant(1.0)),
            )
            .block_size(self.block_size)
            .threads(2);
        engine.build(change(spec))
    }
}

/// The engine with a card, if this was compiled for it and there is one, else with the emulated device.
fn on_device() -> Option<ExplicitOnDevice> {
    #[cfg(feature = "cuda")]
    match powerhouse_device::CudaDevice::new() {
        Ok(_) => {
            return Some(ExplicitOnDevice::new(Arc::new(
                powerhouse_device::CudaDevices,
            )));
        }
        Err(error) => eprintln!("emulated: {error}"),
    }
    match EmulatedDevice::new() {
        Ok(_) => Some(ExplicitOnDevice::new(Arc::new(EmulatedDevices))),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// Bits of motion, stresses and histories of a model, and of what observers recorded.
#[derive(Debug, PartialEq)]
struct Found {
    motion: Vec<u64>,
    stress: Vec<u64>,
    history: Vec<u64>,
    recorded: Vec<u64>,
    steps_of_device: u64,
}

fn go(
    mut model: Box<dyn EngineModel>,
    options: &RunOptions,
    [often, seldom]: [u64; 2],
) -> Result<Found, RunError> {
    let recorded: Arc<Mutex<Vec<u64>>> = Arc::default();
    let record = |every, stress| {
        let numbers = recorded.clone();
        Box::new(Record {
            every,
            stress,
            numbers,
        }) as Box<dyn Observer>
    };
    let mut observers = vec![record(often, false), record(seldom, true)];
    let ran = model.run(&Leapfrog, options, &mut observers, &mut |_| {});
    let report = ran.map_err(|failure| failure.error)?;
    let count = model.mesh().node_count() as u32;
    let motion = (0..count).flat_map(|n| [model.displacement(n), model.velocity(n)]);
    let motion: Vec<f64> = motion.flat_map(|v| [v.x, v.y, v.z]).collect();
    let stress: Vec<f64> = model
        .output()
        .unwrap()
        .stress_changes()
        .iter()
        .flat_map(|s| s.0)
        .collect();
    let history: Vec<f64> = model
        .stateful()
        .unwrap()
        .state()
        .history
        .into_iter()
        .flat_map(|f| f.values)
        .collect();
    let bits = |numbers: &[f64]| numbers.iter().map(|n| n.to_bits()).collect();
    assert!(motion.iter().any(|&n| n.abs() > 1e-9), "nothing moved");
    let recorded = recorded.lock().unwrap().clone();
    Ok(Found {
        motion: bits(&motion),
        stress: bits(&stress),
        history: bits(&history),
        recorded,
        steps_of_device: report.device.map_or(0, |device| device.steps),
    })
}

/// The message with which a model is refused.
fn refusal(built: Result<Box<dyn EngineModel>, ModelError>) -> String {
    match built {
        Ok(_) => panic!("not refused"),
        Err(error) => error.to_string(),
    }
}

/// Compares a run on the device with that on the host; returns the history variables that are not zero.
fn compare(case: &Case, steps: u64) -> usize {
    let Some(engine) = on_device() else {
        return usize::MAX;
    };
    let mesh = mesh(case.kernel.kind());
    let options = RunOptions::steps(steps);
    let host = go(case.build(&Explicit, &mesh).unwrap(), &options, [17, 40]).unwrap();
    let mut device = go(case.build(&engine, &mesh).unwrap(), &options, [17, 40]).unwrap();
    let seen = (0..steps).filter(|n| n % 17 == 0 || n % 40 == 0 || *n + 1 == steps);
    assert_eq!(device.steps_of_device, steps - seen.count() as u64);
    device.steps_of_device = 0;
    let name = format!("{} {:?}", case.kernel.name(), case.options.precision);
    assert!(device == host, "{name}: the device has other bits");
    host.history.iter().filter(|&&bits| bits << 1 != 0).count()
}

const ALL: [Precision; 3] = [Precision::F64, Precision::Mixed, Precision::F32];

/// Rock that yields at little.
fn soft_rock() -> ElastoPlastic<MohrCoulomb> {
    let mut parameters = presets::PAPER_ROCK;
    (parameters.cohesion, parameters.tension_strength) = (2e5, Some(1e5));
    ElastoPlastic::new(MohrCoulomb::new(parameters).unwrap())
}

/// Linear elements of every kind, without damping and with damping proportional to mass and stiffness.
#[test]
fn linear_elements_of_every_kind_have_the_bits_of_the_host() {
    for (index, kernel) in SolidKernel::ALL.into_iter().enumerate() {
        let law = LinearElastic::new(media::ROCK);
        compare(&Case::new(kernel, law, ALL[index % 3]), 130);
        let damped = Case::new(kernel, law, ALL[(index + 1) % 3]).damped(3.0, 2e-5);
        compare(&damped, 130);
    }
}

/// Elements that yield, crack and relax, in every precision; most of them change their histories.
#[test]
fn elements_with_histories_have_the_bits_of_the_host() {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 2,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let relaxing = FlatDamping::new(soft_rock(), spectrum, ReferenceFrequency::Centre).unwrap();
    for precision in ALL {
        let natural = SolidKernel::Hex8Natural;
        let changed = compare(&Case::new(natural, soft_rock(), precision).force(2e6), 150);
        assert!(changed > 200, "{changed}");
        let damped = Case::new(natural, soft_rock(), precision).force(2e6);
        assert!(compare(&damped.damped(2.0, 1e-5), 150) > 200);
        let concrete = presets::paper_concrete().unwrap();
        let eas = Case::new(SolidKernel::Hex8Eas, concrete, precision).force(4e6);
        assert!(compare(&eas, 150) > 200);
        let tetrahedra = Case::new(SolidKernel::Tet10, relaxing.clone(), precision);
        assert!(compare(&tetrahedra.force(2e6), 150) > 200);
    }
}

/// Thin elements of a set in mixed precision are computed in double, in a kernel of their own. In single precision their forces are summed
/// in double by the host, which is refused.
#[test]
fn thin_elements_have_a_kernel_of_their_own() {
    let Some(engine) = on_device() else { return };
    let thin = |x: &Vec3| {
        if x.x > 5.5 {
            Vec3::new(6.0 + 0.05 * (x.x - 6.0), x.y, x.z)
        } else {
            *x
        }
    };
    let mesh = mesh(ElementKind::Hex8).map_positions(|x| thin(&x)).unwrap();
    let case = |precision| Case::new(SolidKernel::Hex8Natural, soft_rock(), precision).force(1e6);
    let options = RunOptions::steps(120);
    let run = |engine: &dyn Engine, precision| {
        go(
            case(precision).build(engine, &mesh).unwrap(),
            &options,
            [17, 40],
        )
    };
    let kernels = |precision| {
        let model = case(precision).build(&Explicit, &mesh).unwrap();
        model.distributed().unwrap().programs(1e-5, 0).len()
    };
    assert_eq!((kernels(Precision::F64), kernels(Precision::Mixed)), (1, 2));
    let host = run(&Explicit, Precision::Mixed).unwrap();
    let mut device = run(&engine, Precision::Mixed).unwrap();
    device.steps_of_device = 0;
    assert!(device == host);
    let message = run(&engine, Precision::F32).unwrap_err().to_string();
    assert!(message.contains("`precision = \"mixed\"`"), "{message}");
}

/// A body after construction stages: absent and cast elements, a displacement, stress and forces carried over. In single precision
/// cast elements are refused.
#[test]
fn bodies_after_stages_have_the_bits_of_the_host() {
    let Some(engine) = on_device() else { return };
    let mesh = mesh(ElementKind::Hex8);
    let (nodes, elements) = (mesh.node_count(), mesh.element_count());
    let field = |size: f64| -> Vec<Vec3> {
        let positions = mesh.positions().iter();
        let at = |x: &Vec3| Vec3::new((0.9 * x.z).sin(), (0.7 * x.x).cos(), x.y.sin()) * size;
        positions.map(at).collect()
    };
    let mut state = State::at_rest(nodes);
    (state.displacement, state.stage_start) = (field(2e-4), field(1e-4));
    state.carried_forces = field(3e4);
    state.initial_stress = vec![Stress([-2e5, -1e5, -3e5, 2e4, 0.0, -1e4]); elements];
    state.absent = (100..120).collect();
    for (law, precision) in [
        (AnyLaw::from(soft_rock()), Precision::F64),
        (LinearElastic::new(media::ROCK).into(), Precision::Mixed),
        (soft_rock().into(), Precision::F32),
    ] {
        let case = Case::new(SolidKernel::Hex8Natural, law, precision).force(1e6);
        let build = |engine: &dyn Engine, state: &State| {
            let built = case.build_with(engine, &mesh, |spec| spec.start(state.clone()));
            built.unwrap()
        };
        let mut with_casts = state.clone();
        with_casts.casts = vec![Cast {
            elements: (30..70).collect(),
            displacement: field(1.5e-4),
        }];
        let options = RunOptions::steps(120);
        if precision != Precision::F64 {
            let built = case.build_with(&engine, &mesh, |spec| spec.start(with_casts.clone()));
            let message = refusal(built);
            assert!(message.contains("cast"), "{message}");
            with_casts = state.clone();
        }
        let host = go(build(&Explicit, &with_casts), &options, [17, 40]).unwrap();
        let mut device = go(build(&engine, &with_casts), &options, [17, 40]).unwrap();
        assert!(device.steps_of_device > 100);
        device.steps_of_device = 0;
        assert!(device == host, "{precision:?}");
    }
}

/// A run that is interrupted between two steps of the device goes on to the same bits, on the device or on the host.
#[test]
fn checkpoints_of_the_device_and_of_the_host_are_one() {
    let Some(engine) = on_device() else { return };
    #[derive(Debug)]
    struct Keep(u64, Mutex<Option<SavedRun>>);
    impl CheckpointSink for Keep {
        fn is_due(&self, progress: &Progress) -> bool {
            progress.done >= self.0 && self.1.lock().unwrap().is_none()
        }
        fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
            *self.1.lock().unwrap() = Some(saved);
            Ok(())
        }
    }
    let case = Case::new(SolidKernel::Hex8Natural, soft_rock(), Precision::F64).force(2e6);
    let mesh = mesh(ElementKind::Hex8);
    let build = |on_device: bool| {
        let built = if on_device {
            case.build(&engine, &mesh)
        } else {
            case.build(&Explicit, &mesh)
        };
        built.unwrap()
    };
    let step = 1e-4;
    let options = RunOptions::steps(120).with_step(StepChoice::Fixed(step));
    let mut whole = go(build(false), &options, [17, 40]).unwrap();
    for (first, second) in [(true, true), (true, false), (false, true)] {
        let sink = Arc::new(Keep(50, Mutex::default()));
        let with_sink = options.clone().with_checkpoints(sink.clone());
        go(build(first), &with_sink, [17, 40]).unwrap();
        let saved = sink.1.lock().unwrap().take().unwrap();
        assert_eq!(saved.done, 50);
        let resumed = options.clone().with_resume(Arc::new(saved));
        let found = go(build(second), &resumed, [17, 40]).unwrap();
        assert!(second == (found.steps_of_device > 0));
        whole.steps_of_device = found.steps_of_device;
        assert!(found == whole, "{first} {second}");
    }
}

/// A motion that diverges on the device, or is faster than the limit of the run in the negative direction alone, ends with the error
/// of the host, which names the element and the step.
#[test]
fn a_divergence_on_the_device_is_named_by_the_host() {
    let Some(engine) = on_device() else { return };
    let case = Case::new(
        SolidKernel::Hex8Natural,
        LinearElastic::new(media::ROCK),
        Precision::F64,
    );
    let unstable = RunOptions::steps(4000).with_step(StepChoice::Unchecked(6e-4));
    // Damped ground settles under its weight: it falls, and rises next to not at all.
    let settling = Case::new(
        SolidKernel::Hex8Natural,
        LinearElastic::new(media::ROCK),
        Precision::F64,
    );
    let settling = settling.damped(2e3, 0.0).force(0.0);
    let limited = RunOptions::steps(400).with_step(StepChoice::Fixed(5e-5));
    let limited = limited.with_speed_limit(2e-3);
    let mesh = mesh(ElementKind::Hex8);
    for (case, options) in [(case, unstable), (settling, limited)] {
        let error_on = |engine: &dyn Engine| {
            let model = case.build(engine, &mesh).unwrap();
            go(model, &options, [1000, 1000]).unwrap_err().to_string()
        };
        let (host, device) = (error_on(&Explicit), error_on(&engine));
        assert!(host.contains("diverged at step"), "{host}");
        assert_eq!(device, host);
    }
}

/// What a device cannot compute is refused by name: before the model is built, or before the first step.
#[test]
fn what_a_device_cannot_compute_is_refused_by_name() {
    let Some(engine) = on_device() else { return };
    let mesh = mesh(ElementKind::Hex8);
    let case = |law: AnyLaw| Case::new(SolidKernel::Hex8Full, law, Precision::F64);
    let linear = || case(LinearElastic::new(media::ROCK).into());
    struct Own;
    impl PointLaw for Own {
        fn name(&self) -> &str {
            "own"
        }
        fn medium(&self) -> powerhouse_model::ElasticMedium {
            media::ROCK
        }
        fn history(&self) -> &'static [HistoryVariable] {
            &[]
        }
        fn stress_change(&self, _input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
            Stress([0.0; 6])
        }
    }
    let own = case(PointAdapter::new(Own).into()).build(&engine, &mesh);
    let message = refusal(own);
    assert!(
        message.contains("set 'rock'") && message.contains("'own'"),
        "{message}"
    );

    let prescribed = Prescribed {
        nodes: vec![mesh.node_count() as u32 / 2],
        direction: Vec3::x(),
        displacement: Box::new(powerhouse_model::Constant(0.0)),
    };
    let moved = linear().build_with(&engine, &mesh, |spec| spec.prescribed(prescribed));
    let message = refusal(moved);
    assert!(message.contains("prescribed motion"), "{message}");

    let run = |options: RunOptions, integrator: &dyn TimeIntegrator, load: bool| {
        struct Counting(u32);
        impl NodalLoad for Counting {
            fn name(&self) -> &str {
                "counting"
            }
            fn nodes(&self) -> &[u32] {
                &[0]
            }
            fn add_forces(&mut self, _time: f64, _forces: &mut [Vec3]) {
                self.0 += 1;
            }
            fn save_state(&self) -> Result<Vec<u8>, StateError> {
                Ok(self.0.to_le_bytes().into())
            }
        }
        let with_load = |spec: ModelSpec<'static>| {
            if load {
                spec.load(Box::new(Counting(0)))
            } else {
                spec
            }
        };
        let mesh: &'static Mesh = Box::leak(Box::new(mesh.clone()));
        let damped = linear().damped(0.0, 2e-4);
        let mut model = damped.build_with(&engine, mesh, with_load).unwrap();
        let failure = model
            .run(integrator, &options, &mut [], &mut |_| {})
            .unwrap_err();
        assert!(failure.report.is_none(), "refused after the first step");
        if !load {
            let plain = RunOptions::steps(20).with_step(StepChoice::Unchecked(1e-5));
            let ran = model.run(&Leapfrog, &plain, &mut [], &mut |_| {});
            assert!(ran.is_ok(), "a refused run leaves the model as it was");
        }
        failure.error.to_string()
    };
    let steps = || RunOptions::steps(20).with_step(StepChoice::Unchecked(1e-5));
    for (message, part) in [
        (
            run(steps().with_energy(EnergyCheck::every(5)), &Leapfrog, false),
            "energy balance",
        ),
        (run(steps().with_profile(true), &Leapfrog, false), "profile"),
        (run(steps(), &OneSided, false), "'one-sided'"),
        (run(steps(), &Leapfrog, true), "'counting'"),
    ] {
        assert!(message.contains(part), "{message}");
    }
}
