//! Water in the pores of a material.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use powerhouse_elements::{AnyLaw, Drainage, PoreWater, WaterPressure};
use powerhouse_model::{ElasticDomain, PORE_PRESSURE, PORE_PRESSURE_RATIO};

use super::*;

fn water() -> PoreWater {
    PoreWater::new(2.2e9, 0.3).unwrap()
}

fn linear(medium: ElasticMedium) -> AnyLaw {
    AnyLaw::new(Linear(medium))
}

fn sum(a: &[Quad<f64>], b: &[Quad<f64>]) -> Vec<Quad<f64>> {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| Quad::from_vector(&(a.to_vector() + b.to_vector())))
        .collect()
}

fn misfit(found: &[Vec3], expected: &[Vec3]) -> f64 {
    let pairs = found.iter().zip(expected);
    let worst = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    worst / largest(expected)
}

/// The undrained medium has the shear modulus of the skeleton, and its bulk modulus with that of the water over the porosity.
#[test]
fn the_undrained_medium_adds_the_water_to_the_bulk_modulus() {
    for poisson in [0.0, 0.2, 0.45] {
        let skeleton = ElasticMedium::new(5e7, poisson, 2000.0).unwrap();
        let undrained = water().undrained(&skeleton);
        let bulk = skeleton.bulk() + 2.2e9 / 0.3;
        assert!((undrained.bulk() / bulk - 1.0).abs() < 1e-9);
        assert!((undrained.shear() / skeleton.shear() - 1.0).abs() < 1e-12);
        assert_eq!(undrained.density, 2000.0);
        // Skempton's B: the share of an isotropic stress that the water takes.
        let b = (2.2e9 / 0.3) / bulk;
        let share = 1.0 - skeleton.bulk() / undrained.bulk();
        assert!((share - b).abs() < 1e-9, "{share} {b}");
    }
}

/// In steps from rest the forces are those of the undrained medium, in static states those of the skeleton; after a static
/// state the water takes the change of volume since then alone. (Kernels with parameters that follow from Poisson's ratio have
/// those of the undrained medium.)
#[test]
fn water_is_drained_in_static_states_and_cannot_flow_in_steps() {
    let kernels = [
        SolidKernel::Hex8Full,
        SolidKernel::Wedge6,
        SolidKernel::Tet4,
    ];
    let skeleton = ElasticMedium::new(3e8, 0.2, 2100.0).unwrap();
    let undrained = water().undrained(&skeleton);
    for kernel in kernels {
        for (precision, tolerance) in [(Precision::F64, 1e-12), (Precision::Mixed, 1e-5)] {
            let options = options(precision, LaneWidth::Native, 0.0);
            let of = |law| Fixture::new(kernel, law, options);
            let mut wet = of(linear(skeleton).with_pore_water(water()));
            let (mut dry, mut stiff) = (of(linear(skeleton)), of(linear(undrained)));
            assert_eq!(wet.masses(), dry.masses());
            let (still, moved) = (wet.noise(3, 1e-3), wet.noise(4, 2e-4));
            let rest = zeros(still.len());
            let from_rest = misfit(&wet.forces(&moved, &rest), &stiff.forces(&moved, &rest));
            assert!(from_rest < tolerance, "{} {from_rest:e}", kernel.name());
            // Initial stiffness, in static states and in steps.
            for (operator, other) in [(Operator::Static, &dry), (Operator::Elastic, &stiff)] {
                let expected = other.apply(Operator::Elastic, &moved);
                let found = misfit(&wet.apply(operator, &moved), &expected);
                assert!(
                    found < tolerance,
                    "{} {operator:?} {found:e}",
                    kernel.name()
                );
            }
            let drained = misfit(&wet.static_forces(&still), &dry.static_forces(&still));
            assert!(drained < tolerance, "{} {drained:e}", kernel.name());
            wet.block.commit();
            // No pressure before anything moves.
            let held = misfit(&wet.forces(&still, &rest), &dry.forces(&still, &rest));
            assert!(held < tolerance, "{} {held:e}", kernel.name());
            let found = wet.forces(&sum(&still, &moved), &rest);
            let (still_forces, moved_forces) =
                (dry.forces(&still, &rest), stiff.forces(&moved, &rest));
            let expected: Vec<Vec3> = still_forces
                .iter()
                .zip(&moved_forces)
                .map(|(a, b)| a + b)
                .collect();
            let together = misfit(&found, &expected);
            assert!(
                together < 10.0 * tolerance,
                "{} {together:e}",
                kernel.name()
            );
            // The pressure of the water is what total stress and that of the skeleton differ by: of elements with one point.
            wet.block.commit();
            if kernel.kind() == ElementKind::Tet4 {
                let total = wet.stress(&sum(&still, &moved));
                let effective = dry.stress(&sum(&still, &moved));
                for (element, (total, effective)) in total.iter().zip(&effective).enumerate() {
                    let pressure = wet.block.shown_history(element, "excess_pore_pressure");
                    let difference = effective.0[1] - total.0[1] - pressure.unwrap();
                    let size = total.0[..3].iter().fold(0.0_f64, |m, s| m.max(s.abs()));
                    assert!(
                        difference.abs() < 1e3 * tolerance * size,
                        "{difference:e} of {size:e}"
                    );
                }
            }
            // Drained again.
            let later = wet.static_forces(&sum(&still, &moved));
            let again = misfit(&later, &dry.static_forces(&sum(&still, &moved)));
            assert!(again < tolerance, "{} {again:e}", kernel.name());
        }
    }
}

/// Undrained static states are those of the undrained medium, and steps go on from their pressure; in a drained state after them it
/// is gone.
#[test]
fn water_of_undrained_static_states_takes_part() {
    let skeleton = ElasticMedium::new(3e8, 0.2, 2100.0).unwrap();
    for kernel in [
        SolidKernel::Hex8Full,
        SolidKernel::Wedge6,
        SolidKernel::Tet4,
    ] {
        let of = |law| Fixture::new(kernel, law, BlockOptions::default());
        let law = linear(skeleton).with_pore_water(water());
        let mut wet = of(law.with_drainage(Drainage::Undrained));
        let mut drained = of(law);
        let (mut dry, mut stiff) = (
            of(linear(skeleton)),
            of(linear(water().undrained(&skeleton))),
        );
        let (first, further) = (wet.noise(3, 1e-3), wet.noise(4, 2e-4));
        let (rest, both) = (zeros(first.len()), sum(&first, &further));
        for operator in [Operator::Static, Operator::Elastic] {
            let expected = stiff.apply(Operator::Elastic, &further);
            let found = misfit(&wet.apply(operator, &further), &expected);
            assert!(found < 1e-12, "{} {operator:?} {found:e}", kernel.name());
        }
        let found = misfit(&wet.static_forces(&first), &stiff.static_forces(&first));
        assert!(found < 1e-12, "{} {found:e}", kernel.name());
        wet.block.commit();
        let found = misfit(&wet.forces(&both, &rest), &stiff.forces(&both, &rest));
        assert!(found < 1e-12, "{} {found:e}", kernel.name());
        wet.block.commit();
        // The same state in a block that is drained at rest.
        drained.block.set_history(&wet.block.history());
        let found = misfit(&drained.static_forces(&both), &dry.static_forces(&both));
        assert!(found < 1e-12, "{} {found:e}", kernel.name());
        drained.block.commit();
        for element in 0..drained.block.elements().len() {
            let shown =
                |block: &Fixture| block.block.shown_history(element, "excess_pore_pressure");
            assert_eq!(shown(&drained), Some(0.0));
            assert!(shown(&wet).unwrap().abs() > 1.0);
        }
    }
}

/// Mean total stress plus the pressure that a block shows is mean effective stress, in elements of any shape; the ratio of the
/// excess pressure is that to the vertical effective stress of the last drained state.
#[test]
fn blocks_show_the_pressure_of_their_water() {
    let skeleton = ElasticMedium::new(3e8, 0.2, 2100.0).unwrap();
    let level = water().with_pressure(WaterPressure::hydrostatic(3.5, 9810.0).unwrap());
    for kernel in [
        SolidKernel::Hex8Full,
        SolidKernel::Wedge6,
        SolidKernel::Tet4,
    ] {
        let of = |law| Fixture::new(kernel, law, BlockOptions::default());
        let mut wet = of(linear(skeleton).with_pore_water(level.clone()));
        let mut dry = of(linear(skeleton));
        let count = wet.block.elements().len();
        let initial = Stress([-1e6, -1e6, -2e6, 0.0, 0.0, 0.0]);
        wet.block.set_initial_stress(&vec![initial; count]);
        let (still, moved) = (wet.noise(5, 2e-4), wet.noise(6, 2e-4));
        let (rest, both) = (zeros(still.len()), sum(&still, &moved));
        wet.static_forces(&still);
        wet.block.commit();
        dry.static_forces(&still);
        let at_rest = dry.stress(&still);
        wet.forces(&both, &rest);
        let (total, effective) = (wet.stress(&both), dry.stress(&both));
        let (mut below, mut compressed) = (0, 0);
        for element in 0..count {
            let height = wet.mesh.centroid(element as u32).z;
            let hydrostatic = 9810.0 * (3.5 - height).max(0.0);
            below += usize::from(hydrostatic > 0.0);
            let shown = |name| wet.block.shown_history(element, name).unwrap();
            let pressure = shown(PORE_PRESSURE.name);
            let size = pressure.abs();
            for i in 0..3 {
                let found = total[element].0[i] + pressure - hydrostatic;
                let off = (found - effective[element].0[i]).abs();
                assert!(off < 1e-9 * size, "{} {off:e}", kernel.name());
            }
            let vertical = initial.0[2] + hydrostatic + at_rest[element].0[2];
            let found = shown("vertical_stress_at_rest");
            assert!((found - vertical).abs() < 1e-6, "{found} {vertical}");
            let excess = shown("excess_pore_pressure");
            assert!((excess + hydrostatic - pressure).abs() < 1e-9 * size);
            let ratio = if vertical < 0.0 {
                -excess / vertical
            } else {
                0.0
            };
            compressed += usize::from(vertical < 0.0);
            assert!((shown(PORE_PRESSURE_RATIO.name) - ratio).abs() < 1e-9 * ratio.abs());
        }
        assert!(
            below > 0 && below < count && compressed > 0,
            "{below} {compressed}"
        );
        // Pressures by element of the mesh stand for those below the level.
        let given: Vec<Option<f64>> = (0..count).map(|e| (e % 2 == 0).then_some(7e3)).collect();
        let law = linear(skeleton).with_pore_water(level.clone());
        let given = of(law.with_pore_pressures(given.into()));
        for element in 0..count {
            let height = given.mesh.centroid(element as u32).z;
            let expected = match element % 2 {
                0 => 7e3,
                _ => 9810.0 * (3.5 - height).max(0.0),
            };
            let found = given.block.shown_history(element, PORE_PRESSURE.name);
            assert!(
                (found.unwrap() - expected).abs() < 1e-9,
                "{found:?} {expected}"
            );
        }
        assert_eq!(dry.block.shown_history(0, PORE_PRESSURE.name), None);
    }
}

/// A table has straight lines between its heights and its ends beyond them; a bend has the slope below it, as a level has.
#[test]
fn pressures_follow_a_table() {
    let table = WaterPressure::table(&[[2.0, 0.0], [-3.0, 5e4], [-4.0, 4e4]]).unwrap();
    for (height, pressure, slope) in [
        (3.0, 0.0, 0.0),
        (2.0, 0.0, -1e4),
        (0.0, 2e4, -1e4),
        (-3.0, 5e4, 1e4),
        (-3.5, 4.5e4, 1e4),
        (-5.0, 4e4, 0.0),
    ] {
        let found = (table.pressure(height), table.slope(height));
        assert_eq!(found, (pressure, slope), "{height}");
    }
    assert_eq!((table.range(), table.level()), ([-4.0, 2.0], None));
    let level = WaterPressure::hydrostatic(1.0, 1e4).unwrap();
    assert_eq!((level.slope(1.0), level.slope(1.5)), (-1e4, 0.0));
    for (wrong, name) in [
        (&[[1.0, 0.0]][..], "number of heights"),
        (&[[1.0, 0.0], [1.0, 2.0]], "height"),
        (&[[1.0, 0.0], [f64::NAN, 2.0]], "height"),
        (&[[1.0, 0.0], [0.0, -2.0]], "pressure"),
    ] {
        assert_eq!(WaterPressure::table(wrong).unwrap_err().name, name);
    }
}

/// Law whose stress does not change, and whose history is the effective stress that it sees.
#[derive(Clone)]
struct Watching(ElasticMedium);

impl ConstitutiveLaw for Watching {
    fn name(&self) -> &str {
        "watching"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const {
            &[
                HistoryVariable::component("xx", "Pa"),
                HistoryVariable::component("zz", "Pa"),
                HistoryVariable::component("xy", "Pa"),
            ]
        }
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        for (new, i) in new.iter_mut().zip([0, 2, 3]) {
            *new = input.initial.0[i];
        }
        Stress::zero(input.strain.0[0].token())
    }
}

/// The law sees the total initial stress and the hydrostatic pressure at the centre of its element, none above the level; its
/// total stress is its own less the growth of the pressure.
#[test]
fn laws_see_effective_stress() {
    let wet = water().with_pressure(WaterPressure::hydrostatic(3.5, 9810.0).unwrap());
    for kernel in [SolidKernel::Hex8Full, SolidKernel::Hex8Natural] {
        let law = AnyLaw::new(Watching(rock())).with_pore_water(wet.clone());
        let mut fixture = Fixture::new(kernel, law, BlockOptions::default());
        let initial = |element: usize| Stress([-1e5 - element as f64, -2e5, -3e5, 4e4, 0.0, 0.0]);
        let count = fixture.block.elements().len();
        let stresses: Vec<Stress> = (0..count).map(initial).collect();
        fixture.block.set_initial_stress(&stresses);
        let gradient = Mat3::from_diagonal(&Vec3::new(1e-5, -3e-5, -2e-5));
        let (u, rest) = (
            fixture.field(|x| gradient * x),
            zeros(fixture.masses().len()),
        );
        fixture.forces(&u, &rest);
        fixture.block.commit();
        let mut below = 0;
        for element in 0..count {
            let height = fixture.mesh.centroid(element as u32).z;
            let pressure = 9810.0 * (3.5 - height).max(0.0);
            below += usize::from(pressure > 0.0);
            let shown = |name| fixture.block.shown_history(element, name).unwrap();
            let expected = [
                initial(element).0[0] + pressure,
                -3e5 + pressure,
                4e4,
                4e-5 * wet.stiffness(),
            ];
            let found = ["xx", "zz", "xy", "excess_pore_pressure"].map(shown);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
            }
        }
        assert!(below > 9 && below < count, "{below} of {count}");
        let total = fixture.stress(&u);
        for stress in total {
            assert!((stress.0[1] / (-4e-5 * wet.stiffness()) - 1.0).abs() < 1e-9);
            assert!(stress.0[3].abs() < 1e-3);
        }
    }
}

/// Free motion after a static state keeps its energy to rounding; with a skeleton that is elastic nothing counts as plastic, and
/// what a yielding one dissipates is what the same skeleton dissipates, in whatever order.
#[test]
fn the_ledger_closes_with_water() {
    let kernels = [
        SolidKernel::Hex8Full,
        SolidKernel::Hex8Natural,
        SolidKernel::Hex8Eas,
        SolidKernel::Wedge6,
    ];
    let medium = ElasticMedium::new(2e9, 0.25, 2200.0).unwrap();
    let laws = [
        (linear(medium), false),
        (AnyLaw::new(Softening(medium)), true),
        (AnyLaw::new(Yielding(medium, 5e-5)), true),
    ];
    for kernel in kernels {
        for (law, dissipates) in &laws {
            let law = law.with_pore_water(water());
            let mut fixture = Fixture::new(kernel, law, BlockOptions::default());
            let u = fixture.noise(5, 1e-5);
            fixture.static_forces(&u);
            fixture.block.commit();
            let (first, worst, energy) = fixture.free_motion(u);
            let spent = energy.plastic + energy.damage;
            assert!(worst < 1e-12, "{} {worst:e}", kernel.name());
            assert_eq!(
                spent.abs() > 1e-9 * first,
                *dissipates,
                "{} {spent:e}",
                kernel.name()
            );
            assert!(spent > -1e-9 * first, "{} {spent:e}", kernel.name());
        }
    }
}

/// [`Yielding`] with its elastic domain, if it is to have one, and the number of its evaluations.
#[derive(Clone)]
pub(super) struct Spared {
    pub(super) law: Yielding,
    pub(super) has_domain: bool,
    pub(super) evaluations: Arc<AtomicUsize>,
}

impl ConstitutiveLaw for Spared {
    fn name(&self) -> &str {
        "spared"
    }
    fn medium(&self) -> ElasticMedium {
        self.law.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        self.law.history()
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        self.law.stress_change(input, new)
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new: &[L]) -> Option<LawEnergy<L>> {
        self.law.energy(input, new)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        let strength = 2.0_f64.sqrt() * self.law.0.shear() * self.law.1;
        (self.has_domain).then(|| ElasticDomain::EVERYTHING.within(0.0, 1.0, strength))
    }
}

/// Within its elastic domain the law of a skeleton is spared: forces, pressures and what is plastic keep their bits, also after
/// a static state and when batches leave the domain one after the other, and the ledger closes.
#[test]
fn saturated_ground_within_its_elastic_domain_spares_the_law() {
    for kernel in [
        SolidKernel::Hex8Full,
        SolidKernel::Tet4,
        SolidKernel::Hex8Natural,
    ] {
        for precision in [Precision::F64, Precision::Mixed] {
            let of = |has_domain| {
                let evaluations = Arc::new(AtomicUsize::new(0));
                let law = Spared {
                    law: Yielding(rock(), 1e-4),
                    has_domain,
                    evaluations: evaluations.clone(),
                };
                let law = AnyLaw::new(law).with_pore_water(water());
                let lanes = options(precision, LaneWidth::Native, 0.0);
                (Fixture::new(kernel, law, lanes), evaluations)
            };
            let (mut spared, few) = of(true);
            let (mut whole, many) = of(false);
            let still = spared.noise(1, 1e-5);
            spared.static_forces(&still);
            whole.static_forces(&still);
            spared.block.commit();
            whole.block.commit();
            let rest = zeros(still.len());
            // Motion that grows, more on one side of the body, and ends as it began.
            let sizes = (0..14).map(|n| 1e-4 * 1.1_f64.powi(n)).chain([1e-5]);
            let mut shares = Vec::new();
            for (number, size) in sizes.enumerate() {
                for counter in [&few, &many] {
                    counter.store(0, Ordering::Relaxed);
                }
                let noise = spared.noise(number as u64, size);
                let grown: Vec<Quad<f64>> = spared.field(|x| Vec3::new(x.x, x.x, x.x));
                let largest = grown.iter().map(|x| x.to_vector().x).fold(0.0, f64::max);
                let pairs = noise.iter().zip(&grown);
                let u = pairs.map(|(noise, grown)| {
                    let share = (grown.to_vector().x / largest).powi(3);
                    Quad::from_vector(&(noise.to_vector() * share))
                });
                let u = sum(&still, &u.collect::<Vec<_>>());
                let found = spared.forces(&u, &rest);
                let expected = whole.forces(&u, &rest);
                spared.block.commit();
                whole.block.commit();
                assert_eq!(found, expected, "{} {number}", kernel.name());
                assert_eq!(spared.block.history(), whole.block.history());
                let [few, many] = [&few, &many].map(|counter| counter.load(Ordering::Relaxed));
                shares.push(few as f64 / many as f64);
            }
            // What has yielded once follows the law from then on.
            let name = kernel.name();
            assert!(shares.is_sorted(), "{name} {shares:?}");
            let partial = shares.iter().filter(|share| (0.05..0.95).contains(*share));
            assert!(shares[0] < 0.5 && partial.count() > 1, "{name} {shares:?}");
        }
        let domain = Spared {
            law: Yielding(rock(), 1e-5),
            has_domain: true,
            evaluations: Arc::default(),
        };
        let law = AnyLaw::new(domain).with_pore_water(water());
        let mut fixture = Fixture::new(kernel, law, BlockOptions::default());
        let u = fixture.noise(5, 1e-6);
        fixture.static_forces(&u);
        fixture.block.commit();
        let (first, worst, energy) = fixture.free_motion(u);
        assert!(worst < 1e-12, "{} {worst:e}", kernel.name());
        assert!(energy.plastic > 1e-4 * first, "{}", kernel.name());
    }
}

/// Widths of lanes change no bit, and a restored block goes on with the same ones.
#[test]
fn lanes_and_resumption_keep_the_bits() {
    let step = |fixture: &mut Fixture, number: u64| -> Vec<u64> {
        let (u, v) = (fixture.noise(number, 1e-3), fixture.noise(number + 9, 0.1));
        let length = if number < 2 { 0.0 } else { 1e-4 };
        let views = [NodalView::F64(&u), NodalView::F64(&v)];
        let context = BlockContext::new(when(number, length), views[0], views[1]);
        let context = context.with_ledger(length > 0.0);
        let forces = fixture.forces_at(&context).unwrap();
        fixture.block.commit();
        let numbers = forces.iter().flat_map(|force| [force.x, force.y, force.z]);
        let fields = fixture.block.history();
        let histories = fields.into_iter().flat_map(|field| field.values);
        numbers.chain(histories).map(f64::to_bits).collect()
    };
    let kernel = SolidKernel::Hex8Full;
    for precision in [Precision::F64, Precision::Mixed] {
        let fresh = |lanes| {
            let law = AnyLaw::new(Yielding(rock(), 1e-4)).with_pore_water(water());
            Fixture::new(kernel, law, options(precision, lanes, 1e-5))
        };
        let mut wide = fresh(LaneWidth::Native);
        let mut one = fresh(LaneWidth::One);
        let mut saved = None;
        for number in 0..8 {
            assert_eq!(step(&mut wide, number), step(&mut one, number), "{number}");
            if number == 4 {
                let state = wide.block.saved().unwrap();
                saved = Some(state.save_state().unwrap());
            }
        }
        let mut restored = fresh(LaneWidth::One);
        restored
            .block
            .saved_mut()
            .unwrap()
            .restore_state(&saved.unwrap())
            .unwrap();
        for number in 5..8 {
            step(&mut restored, number);
        }
        assert_eq!(step(&mut wide, 8), step(&mut restored, 8));
    }
}

/// A law for whole blocks has water, too.
#[test]
fn laws_of_blocks_have_water() {
    struct Whole(ElasticMedium);
    impl powerhouse_model::BlockLaw for Whole {
        fn name(&self) -> &str {
            "whole"
        }
        fn medium(&self) -> ElasticMedium {
            self.0
        }
        fn history(&self) -> &[HistoryVariable] {
            const { &[HistoryVariable::amount("strain", "1")] }
        }
        fn stress_changes(
            &self,
            input: &powerhouse_model::BlockLawInput,
            stresses: &mut [Stress],
            new_history: &mut [f64],
        ) {
            assert_eq!(new_history.len(), stresses.len());
            for (i, strain) in input.strains.iter().enumerate() {
                stresses[i] = Stress::elastic(self.0.lambda(), self.0.shear(), strain);
                new_history[i] = strain.0[0].abs().max(input.history[i]);
            }
        }
    }
    let kernel = SolidKernel::Hex8Full;
    let of = |law| Fixture::new(kernel, law, BlockOptions::default());
    let mut whole = of(AnyLaw::of_blocks(Whole(rock())).with_pore_water(water()));
    let mut stiff = of(linear(water().undrained(&rock())));
    let rest = zeros(whole.masses().len());
    for seed in 0..3 {
        let u = whole.noise(seed, 1e-3);
        let found = misfit(&whole.forces(&u, &rest), &stiff.forces(&u, &rest));
        whole.block.commit();
        assert!(found < 1e-12, "{found:e}");
    }
    let fields = whole.block.history();
    let strains = fields.iter().find(|field| field.name == "strain").unwrap();
    assert!(strains.values.iter().all(|strain| *strain > 0.0));
}

/// Saturated ground with a linear skeleton spares its law in steps: forces, pressures, stresses and energies are those with a law that
/// never yields, from rest and after a drained state, where an element is off or strains have a reference, and its energy is
/// constant in free motion. Steps that are not shown leave the pressures of those before.
#[test]
fn saturated_linear_ground_moves_without_its_law() {
    for kernel in SolidKernel::ALL {
        for (precision, tolerance) in [(Precision::F64, 1e-11), (Precision::Mixed, 3e-5)] {
            let options = options(precision, LaneWidth::Native, 0.0);
            let whole = Spared {
                law: Yielding(rock(), 1e9),
                has_domain: false,
                evaluations: Arc::default(),
            };
            let of = |law: AnyLaw| Fixture::new(kernel, law.with_pore_water(water()), options);
            let pair = &mut [of(linear(rock())), of(AnyLaw::new(whole))];
            let (still, moved) = (pair[0].noise(1, 1e-3), pair[0].noise(2, 1e-4));
            let (reference, rest) = (pair[0].noise(3, 5e-4), zeros(still.len()));
            let check = |pair: &mut [Fixture; 2], u: &[Quad<f64>], state: &str| {
                let name = format!("{} {precision:?} {state}", kernel.name());
                let forces = pair.each_mut().map(|fixture| fixture.forces(u, &rest));
                let error = misfit(&forces[0], &forces[1]);
                assert!(error < tolerance, "{name} {error:e}");
                for variable in ["excess_pore_pressure", "pore_pressure_ratio"] {
                    let of_element = |block: &dyn ElementBlock| -> Vec<f64> {
                        let elements = 0..block.elements().len();
                        let of = |element| block.shown_history(element, variable).unwrap();
                        elements.map(of).collect()
                    };
                    let [found, expected] = [0, 1].map(|i| of_element(pair[i].block.as_ref()));
                    let size = expected.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
                    for (found, expected) in found.iter().zip(&expected) {
                        let error = (found - expected).abs();
                        assert!(
                            error <= 10.0 * tolerance * size,
                            "{name} {error:e} of {size:e}"
                        );
                    }
                }
                pair.iter_mut().for_each(|fixture| fixture.block.commit());
                let [found, expected] = pair.each_ref().map(|fixture| {
                    let context =
                        BlockContext::new(when(0, 1e-4), NodalView::F64(u), NodalView::F64(&rest));
                    fixture.block.energy(&context).total()
                });
                assert!(
                    (found - expected).abs() <= 10.0 * tolerance * expected.abs(),
                    "{name}"
                );
            };
            check(pair, &moved, "from rest");
            for fixture in pair.iter_mut() {
                fixture.static_forces(&still);
                fixture.block.commit();
            }
            check(pair, &sum(&still, &moved), "after a drained state");
            let mut active = vec![true; pair[0].block.elements().len()];
            active[0] = false;
            pair.iter_mut()
                .for_each(|fixture| fixture.block.stateful_mut().unwrap().set_active(&active));
            check(pair, &still, "with an element off");
            check(pair, &moved, "with an element off, elsewhere");
            for fixture in pair.iter_mut() {
                (fixture.block).set_reference_displacement(NodalView::F64(&reference));
            }
            check(pair, &sum(&still, &moved), "from a reference");
            // Steps that are not shown leave the pressures of those before, but where elements condense strains of their own.
            let pressure = |fixture: &Fixture| {
                let shown = fixture.block.shown_history(1, "excess_pore_pressure");
                shown.unwrap()
            };
            let mut own = of(linear(rock()));
            own.forces(&moved, &rest);
            own.block.commit();
            let shown = pressure(&own);
            let context =
                BlockContext::new(when(1, 1e-4), NodalView::F64(&still), NodalView::F64(&rest));
            own.forces_at(&context.with_repeats(false)).unwrap();
            own.block.commit();
            let spares = pressure(&own) == shown;
            assert_eq!(spares, kernel != SolidKernel::Hex8Eas, "{}", kernel.name());
            if precision == Precision::F64 {
                let (_, change, spent) = of(linear(rock())).free_motion(moved.clone());
                assert!(change < 1e-10, "{} {change:e}", kernel.name());
                assert_eq!(
                    spent.total(),
                    spent.elastic + spent.bending + spent.hourglass
                );
            }
        }
    }
}
