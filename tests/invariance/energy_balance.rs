//! The energy balance does not change the motion, and does not evaluate laws where they are certainly elastic.

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_elements::{Hex8OnePoint, SolidKernel};
use powerhouse_material_damage::{ElastoPlastic, MohrCoulomb, presets};
use powerhouse_model::{
    BlockOptions, ConstitutiveLaw, ElasticMedium, EnergyCheck, HistoryVariable, Lane, LawEnergy,
    LawInput, Mesh, Precision, RemainingStiffness, RunOptions, StepChoice, Stress, Vec3,
};

/// A law without an elastic domain, so that its energies are evaluated everywhere.
#[derive(Clone)]
struct Asked<M>(M);

impl<M: ConstitutiveLaw> ConstitutiveLaw for Asked<M> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        self.0.history()
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        self.0.stress_change(input, new_history)
    }
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        self.0.energy(input, new_history)
    }
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        self.0.remaining_stiffness(input, new_history, change)
    }
}

/// The elements of a beam: kernel, law and stiffness damping (s).
struct Beam<M> {
    kernel: SolidKernel,
    law: M,
    damping: f64,
}

/// A distorted beam in bending with yielding at its foot only: the bits of its motion, and its energies if the
/// balance is computed.
fn shaken<M: ConstitutiveLaw>(
    beam: Beam<M>,
    steps: u64,
    balanced: bool,
) -> (Vec<u64>, Vec<(&'static str, f64)>) {
    let boxed = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 2.0, 8.0), [4, 4, 16], "rock");
    let shift = |x: &Vec3| Vec3::new((3.0 * x.y).sin(), (2.0 * x.z).cos(), (2.5 * x.x).sin());
    let mesh = boxed
        .unwrap()
        .map_positions(|x| x + 0.03 * shift(&x))
        .unwrap();
    let mut options = BlockOptions::default();
    options.precision = Precision::F64;
    options.damping.stiffness = beam.damping;
    let mut model = Model::builder(&mesh)
        .elements("rock", beam.kernel.factory("rock", beam.law, options))
        .block_size(48)
        .build()
        .unwrap();
    let velocity = |x: &Vec3| Vec3::new((0.2 * x.z).powi(2), 0.1 * x.x, 0.05 * x.z);
    let velocities: Vec<Vec3> = mesh.positions().iter().map(|x| velocity(x) * 0.6).collect();
    let rest = vec![Vec3::zeros(); mesh.node_count()];
    model.set_initial(&rest, &velocities).unwrap();
    let mut options = RunOptions::steps(steps).with_step(StepChoice::Unchecked(2e-5));
    if balanced {
        options = options.with_energy(EnergyCheck::every(10));
    }
    let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    let state = model.state();
    let motion = state.displacement.iter().chain(&state.velocity);
    let history = state.history.iter().flat_map(|field| &field.values);
    let numbers = motion.flat_map(|v| v.iter()).chain(history);
    (numbers.map(|n| n.to_bits()).collect(), report.energies)
}

/// The motion has the same bits with and without the energy balance, and the balance is the same if the law is
/// evaluated everywhere: no energy is lost when batches of elements enter and leave the active set.
fn check<M: ConstitutiveLaw>(kernel: SolidKernel, law: &M, stiffness: f64) {
    let mut spent = 0.0_f64;
    for steps in [40, 120, 400] {
        let of = |balanced| {
            let law = law.clone();
            let beam = Beam {
                kernel,
                law,
                damping: stiffness,
            };
            shaken(beam, steps, balanced)
        };
        let asking = Beam {
            kernel,
            law: Asked(law.clone()),
            damping: stiffness,
        };
        let asked = shaken(asking, steps, true);
        let (balanced, free) = (of(true), of(false));
        assert!(
            balanced.0 == free.0 && balanced.0 == asked.0,
            "{}",
            law.name()
        );
        let column = |energies: &[(&str, f64)], name: &str| {
            energies
                .iter()
                .find(|(column, _)| *column == name)
                .unwrap()
                .1
        };
        let initial = column(&balanced.1, "initial");
        for (name, energy) in &balanced.1 {
            let other = column(&asked.1, name);
            let off = (energy - other).abs() / initial;
            assert!(off < 1e-13, "{} {name}: {energy} {other}", law.name());
        }
        let residual = column(&balanced.1, "residual").abs() / initial;
        assert!(residual < 1e-12, "{}: {residual}", law.name());
        spent = column(&balanced.1, "plastic") + column(&balanced.1, "damage");
        spent /= initial;
    }
    assert!(spent > 1e-3 && spent < 0.5, "{}: {spent}", law.name());
}

#[test]
fn the_balance_does_not_change_the_motion() {
    let one_point = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
    check(one_point, &rock, 0.0);
    check(SolidKernel::Hex8Full, &rock, 2e-6);
}

#[test]
fn the_balance_of_laws_with_damage_does_not_change_the_motion() {
    check(
        SolidKernel::Hex8Full,
        &presets::paper_concrete().unwrap(),
        0.0,
    );
}
