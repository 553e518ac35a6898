//! A constitutive law of one's own, in a scene like any other: in thirty lines, then with a history
//! variable and energies, in lanes.
//!
//! Builds on `free_field`. Soil that softens in shear: the modulus falls with the shear strain
//! `gamma` as `G / (1 + gamma / gamma_ref)` (the hyperbola of Hardin & Drnevich, 1972). The first
//! form has no history variables. The second has the largest shear strain so far as history variable,
//! which defines its modulus; the energy that further softening dissipates is damage. It is evaluated in
//! lanes, for as many elements at once as the processor permits, and one point at a time, with the same
//! bits. The third has a reference strain that grows with depth, from the position of each point.
//!
//! ```text
//!      z = 0   +---+  free surface           a column of soil, 40 m, one element across,
//!              |   |                         supported in y and z, under a vertically
//!              | : |                         incident SV wave along x
//!              |   |
//!     z = -40  +---+  absorbing, SV wave in
//! ```
//!
//! Under a wave of small strain the softening must have no effect; a strong one is slowed down. The energy
//! that the law with history dissipates is damage alone, and the balance closes.
//!
//! Run: `cargo run --release --example own_law`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::Viscous;
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{AnyLaw, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput, Mesh, PointLaw,
    Stress, Vec3,
};
use powerhouse::wavefield::{PlaneWave, PlaneWaveParameters, RaisedCosinePulse, WaveKind};
use powerhouse::{Boundary, Material, OutputPlan, Part, Results, RunHooks, Scene};
use powerhouse_examples::Figures;

/// Soil whose shear modulus falls with the shear strain, without history.
#[derive(Clone)]
struct Hyperbolic {
    medium: ElasticMedium,
    /// Reference shear strain, at which the modulus is halved (1).
    reference_strain: f64,
}

impl PointLaw for Hyperbolic {
    fn name(&self) -> &str {
        "hyperbolic"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    fn stress_change(&self, input: &LawInput<f64>, _new_history: &mut [f64]) -> Stress {
        let [.., xy, yz, zx] = input.strain.0;
        let shear_strain = (xy * xy + yz * yz + zx * zx).sqrt();
        let softening = 1.0 / (1.0 + shear_strain / self.reference_strain);
        let mut stress = Stress::elastic(self.medium.lambda(), self.medium.shear(), &input.strain);
        for shear in &mut stress.0[3..] {
            *shear *= softening;
        }
        stress
    }
}

/// Soil with the largest shear strain so far as history variable, for any lane.
#[derive(Clone)]
struct SofteningSoil(Hyperbolic);

/// Its history variable: name, unit and kind.
const HISTORY: [HistoryVariable; 1] = [HistoryVariable::amount("largest_shear_strain", "1")];

impl SofteningSoil {
    /// Remaining share of the shear modulus after a shear strain.
    #[inline(always)]
    fn left<L: Lane>(&self, largest: L) -> L {
        let one = largest.constant(1.0);
        one / (one + largest * largest.constant(1.0 / self.0.reference_strain))
    }
}

impl ConstitutiveLaw for SofteningSoil {
    fn name(&self) -> &str {
        "softening-soil"
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &HISTORY
    }
    // Inlined, so that it is compiled for the instructions that the processor has.
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let [.., xy, yz, zx] = input.strain.0;
        let strain = xy.mul_add(xy, yz.mul_add(yz, zx * zx)).sqrt();
        new_history[0] = input.history[0].max(strain);
        let (lambda, shear) = (self.0.medium.lambda(), self.0.medium.shear());
        let mut stress = Stress::elastic(xy.constant(lambda), xy.constant(shear), &input.strain);
        let left = self.left(new_history[0]);
        for shear in &mut stress.0[3..] {
            *shear = left * *shear;
        }
        stress
    }
    // Without it the energy that softening dissipates would count as plastic.
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let [xx, yy, zz, xy, yz, zx] = input.strain.0;
        let half = |value: f64| xy.constant(0.5 * value);
        let (lambda, shear) = (self.0.medium.lambda(), self.0.medium.shear());
        let volume = xx + yy + zz;
        let squares = xx.mul_add(xx, yy.mul_add(yy, zz * zz));
        let normal = half(lambda) * volume * volume + half(2.0 * shear) * squares;
        let sheared = half(shear) * xy.mul_add(xy, yz.mul_add(yz, zx * zx));
        let (before, after) = (self.left(input.history[0]), self.left(new_history[0]));
        let stored = after.mul_add(sheared, normal);
        Some(LawEnergy::stored(stored).with_damage(sheared * (before - after)))
    }
}

/// Soil without history whose reference strain grows with depth, in one law for the whole column.
#[derive(Clone)]
struct Graded {
    soil: Hyperbolic,
    /// Growth of the reference strain with depth (1/m), relative to that at the surface.
    growth: f64,
}

impl ConstitutiveLaw for Graded {
    fn name(&self) -> &str {
        "graded"
    }
    fn medium(&self) -> ElasticMedium {
        self.soil.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    // Without it there is no position.
    fn uses_location(&self) -> bool {
        true
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let [.., xy, yz, zx] = input.strain.0;
        let strain = xy.mul_add(xy, yz.mul_add(yz, zx * zx)).sqrt();
        let [_, _, z] = input.position();
        let one = z.constant(1.0);
        let relative = one - z * z.constant(self.growth);
        let reference = relative * z.constant(self.soil.reference_strain);
        let share = reference / (reference + strain);
        let (lambda, shear) = (self.soil.medium.lambda(), self.soil.medium.shear());
        let mut stress = Stress::elastic(xy.constant(lambda), xy.constant(shear), &input.strain);
        for shear in &mut stress.0[3..] {
            *shear = share * *shear;
        }
        stress
    }
}

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const DEPTH: f64 = 40.0;

/// The motion of the surface over time and the energies, for an incident amplitude (m).
fn shake(material: Material, amplitude: f64) -> Outcome<Results> {
    let medium = material.medium();
    let low = Vec3::new(0.0, 0.0, -DEPTH);
    let mesh = Mesh::box_of_hexes(low, Vec3::new(1.0, 1.0, 0.0), [1, 1, 40], "soil")?;
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, medium, 0.0);
    parameters.reference = low;
    let pulse = RaisedCosinePulse::new(amplitude, 0.4)?;
    let output = OutputPlan::default().with_energies(0.01);
    let top = Vec3::new(0.5, 0.5, 0.0);
    let output = output
        .history("top", top, Motion::DISPLACEMENT)
        .state("top soil", top);
    Ok(Scene::new("soil column", mesh)
        .part(Part::new("soil", material))
        .support(Support::roller(all.clone(), Vec3::y()))
        .support(Support::roller(all, Vec3::z()))
        .with_field(PlaneWave::new(parameters, Arc::new(pulse))?)
        .with_boundary(Boundary::new(Viscous::default(), ["bottom"]))
        .with_duration(1.5)
        .with_output(output)
        .prepare()?
        .run(RunHooks::default())?)
}

/// The horizontal displacement of the surface over time, for an incident amplitude (m).
fn surface_motion(material: Material, amplitude: f64) -> Outcome<Vec<f64>> {
    let results = shake(material, amplitude)?;
    let column = results.histories().column("top.ux").ok_or("no column")?;
    Ok(column.values.clone())
}

/// Largest difference of two motions over the peak of the first.
fn difference(first: &[f64], second: &[f64]) -> f64 {
    let peak = first.iter().fold(0.0_f64, |peak, u| peak.max(u.abs()));
    let pairs = first.iter().zip(second);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak
}

fn figures() -> Outcome<Figures> {
    let soil = ElasticMedium::new(100.0e6, 0.3, 1900.0)?;
    let elastic = || Material::from(LinearElastic::new(soil));
    let softening = || {
        Material::from_point_law(Hyperbolic {
            medium: soil,
            reference_strain: 1e-3,
        })
    };
    let mut figures = Figures::default();

    // Strains of about 1e-8 lie 1e-5 below the reference strain.
    let weak = difference(
        &surface_motion(elastic(), 1e-7)?,
        &surface_motion(softening(), 1e-7)?,
    );
    figures.at_most("own_law.weak.difference", weak, 1e-3);

    let strong = difference(
        &surface_motion(elastic(), 0.05)?,
        &surface_motion(softening(), 0.05)?,
    );
    figures.report(
        "own_law.strong.difference",
        strong,
        "a strong wave arrives late and changed",
    );

    // A reference strain that grows with depth: between elastic and uniformly soft soil.
    let graded = |growth: f64| {
        Material::new(Graded {
            soil: Hyperbolic {
                medium: soil,
                reference_strain: 1e-3,
            },
            growth,
        })
    };
    let uniform = surface_motion(softening(), 0.05)?;
    let same = difference(&uniform, &surface_motion(graded(0.0), 0.05)?);
    figures.at_most("own_law.graded.uniform", same, 1e-9);
    let stiffer = difference(
        &surface_motion(elastic(), 0.05)?,
        &surface_motion(graded(1.0), 0.05)?,
    );
    figures.at_most("own_law.graded.over_uniform", stiffer / strong, 0.9);

    let law = || {
        SofteningSoil(Hyperbolic {
            medium: soil,
            reference_strain: 1e-3,
        })
    };
    let wide = shake(Material::new(law()), 0.05)?;
    let narrow = shake(Material::from_point_law(AnyLaw::new(law())), 0.05)?;
    let column = |results: &Results, name: &str| -> Outcome<Vec<f64>> {
        let column = results.histories().column(name).ok_or("no column")?;
        Ok(column.values.clone())
    };
    let largest = "top soil.largest_shear_strain";
    for name in ["top.ux", largest] {
        let apart = difference(&column(&wide, name)?, &column(&narrow, name)?);
        figures.at_most(
            &format!("own_law.lanes.{}", name.replace(' ', "_")),
            apart,
            0.0,
        );
    }
    let strains = column(&wide, largest)?;
    let falls = strains
        .windows(2)
        .map(|pair| pair[0] - pair[1])
        .fold(0.0, f64::max);
    figures.at_most("own_law.memory.falls", falls, 0.0);
    figures.report(
        "own_law.memory.largest_strain",
        strains.last().copied().unwrap_or_default(),
        "the history variable at the top of the soil",
    );
    let energy = |name: &str| -> Outcome<f64> {
        let terms = wide.energy_terms();
        let term = terms.iter().find(|(term, _)| *term == name);
        Ok(term.ok_or("no energy")?.1)
    };
    let taken = energy("damage")?;
    figures.report("own_law.energy.damage", taken, "J, dissipated by softening");
    // The error of the integration in time is of second order in the step, the softening of first order.
    let left = energy("integration")?.abs() / taken;
    figures.at_most("own_law.energy.integration", left, 0.05);
    figures.at_most("own_law.energy.residual", wide.run.energy_residual, 1e-10);
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(super::figures().unwrap().missed(), 0);
    }
}
