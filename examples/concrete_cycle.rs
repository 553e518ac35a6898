//! Concrete at one integration point under tension, compression and renewed tension; and a cracking bar with increasing
//! numbers of elements.
//!
//! Builds on `own_law`. The laws of concrete run without a mesh: a material driver applies a strain path with
//! stress-free sides to one point. Cracks open at the tensile strength, close with full stiffness recovery in compression, and
//! reopen with the earlier damage.
//!
//! ```text
//!     stress                                  sigma <-[   |   |xxx|   |   ]-> sigma
//!       |  /\   cracks                                 n elements, one weakened
//!       | /  \_____
//!     --+---/------- strain                   all energy is dissipated in the weak
//!       |  /                                  element, which shrinks with their number
//!       \_/    crushes
//! ```
//!
//! A bar softens in a single element. If softening depended on strain alone, the dissipated energy would decrease with mesh
//! refinement; laws regularised by the crack band width dissipate the fracture energy in any mesh.
//!
//! Run: `cargo run --release --example concrete_cycle`; it draws `concrete_cycle_tension.svg`,
//! `concrete_cycle_compression.svg` and `concrete_cycle_cycle.svg` into `results`.

use std::path::Path;
use std::process::ExitCode;
use std::thread;

use powerhouse::io::{Plot, PlotCurve, PlotPanel, write_plot};
use powerhouse::material::{
    ConeFit, Control, DruckerPrager, DruckerPragerParameters, LeeFenves, LeeFenvesParameters,
    Mazars, MazarsParameters, MazarsTension, MohrCoulomb, MohrCoulombParameters, PlasticDamage,
    PlasticDamageParameters, PointDriver, PointState, Softening, SofteningPlasticity,
    SofteningPlasticityParameters, StrengthFall, TwoSurface, TwoSurfaceParameters, YieldSurface,
    presets,
};
use powerhouse::model::{ConstitutiveLaw, ElasticMedium};
use powerhouse_examples::softening::dissipated;
use powerhouse_examples::{Figures, Outcome};

/// Energy per area of crack and of crushing band (N/m).
const CRACKING: f64 = 133.0;
const CRUSHING: f64 = 35.96e3;
/// Strength reduction of the weak element of the bar (1).
const WEAKER: f64 = 0.01;

/// Concrete with plastic strain in cracks: less of the softening is damage. (With damage alone, tension is that of Eq. 25.)
const SOFTENING: LeeFenvesParameters = LeeFenvesParameters {
    tension_damage: 0.6,
    ..presets::PAPER_CONCRETE_LEE_FENVES
};

/// Strain (thousandths) and stress (MPa) along z.
fn curve(path: &[PointState]) -> [Vec<f64>; 2] {
    let strain = path.iter().map(|record| 1.0e3 * record.strain.0[2]);
    let stress = path.iter().map(|record| 1.0e-6 * record.stress.0[2]);
    [strain.collect(), stress.collect()]
}

/// Drives a point of a law in an element of 0.2 m through turning points of strain along z.
fn lead(law: impl ConstitutiveLaw, ends: &[f64]) -> Outcome<Vec<PointState>> {
    let mut point = PointDriver::new(law).with_size(0.2)?;
    let mut path = vec![point.state().clone()];
    for end in ends {
        path.extend(point.advance(Control::uniaxial(*end), 400)?);
    }
    Ok(path)
}

/// Draws tension, compression and a cycle of three laws, one plot each, into a folder.
fn draw(folder: &Path) -> Outcome<()> {
    let paths: [(&str, &[f64]); 3] = [
        ("tension", &[6.0e-4]),
        ("compression", &[-8.0e-3]),
        ("cycle", &[1.0e-4, -1.0e-4, 2.5e-4, -1.0e-4, 5.0e-4]),
    ];
    let eq_25 = damaging(TwoSurface::new(presets::PAPER_CONCRETE_LISTED)?)?;
    let lee_fenves = LeeFenves::new(SOFTENING)?;
    let mazars = Mazars::new(presets::PAPER_CONCRETE_MAZARS)?;
    for (name, path) in paths {
        let curves = [
            ("Eq. 25, listed strengths", curve(&lead(eq_25, path)?)),
            ("Lee-Fenves", curve(&lead(lee_fenves, path)?)),
            ("Mazars", curve(&lead(mazars, path)?)),
        ];
        let curves = curves.iter().map(|(name, [x, y])| PlotCurve { name, x, y });
        let plot = Plot {
            title: format!("Concrete C25 along the axis: {name}"),
            label: "strain".into(),
            unit: "0.001".into(),
            panels: vec![PlotPanel {
                label: "stress".into(),
                unit: "MPa".into(),
                curves: curves.collect(),
            }],
            gaps: Vec::new(),
        };
        write_plot(&folder.join(format!("concrete_cycle_{name}.svg")), &plot)?;
    }
    Ok(())
}

/// Damage plasticity with softening by fracture energies.
fn damaging<S: YieldSurface>(surface: S) -> Outcome<PlasticDamage<S>> {
    let by_energy = |energy| Softening::FractureEnergy {
        energy,
        threshold: 0.0,
    };
    Ok(PlasticDamage::new(PlasticDamageParameters {
        surface,
        tension: by_energy(CRACKING),
        compression: by_energy(CRUSHING),
        stiffness_recovery: 1.0,
        residual_stiffness: 1.0e-6,
    })?)
}

/// The largest deviation of the energy ratio from one over the given numbers of elements, each of which is printed; they are
/// computed in parallel.
fn deviation(
    name: &str,
    counts: &[usize],
    ratio: impl Fn(usize) -> Outcome<f64> + Sync,
) -> Outcome<f64> {
    let ratio = |count| ratio(count).map_err(|error| error.to_string());
    let ratio = &ratio;
    let ratios: Vec<Result<f64, String>> = thread::scope(|scope| {
        let start = |&count| scope.spawn(move || ratio(count));
        let started: Vec<_> = counts.iter().map(start).collect();
        let join = |bar: thread::ScopedJoinHandle<'_, _>| bar.join().expect("bars do not panic");
        started.into_iter().map(join).collect()
    });
    let mut worst = 0.0_f64;
    for (count, ratio) in counts.iter().zip(ratios) {
        let ratio = ratio?;
        println!("{name}: {count} elements dissipate {ratio:.5} of the fracture energy");
        worst = worst.max((ratio - 1.0).abs());
    }
    Ok(worst)
}

const COUNTS: [usize; 4] = [10, 20, 40, 80];

/// Bars of a law with plastic strain and damage, in tension and compression.
fn bars<M: ConstitutiveLaw>(
    figures: &mut Figures,
    name: &str,
    law: impl Fn(f64) -> Outcome<M> + Sync,
    strengths: [f64; 2],
) -> Outcome<()> {
    for (what, energy, strength) in [
        ("tension", CRACKING, strengths[0]),
        ("crushing", CRUSHING, -strengths[1]),
    ] {
        let name = format!("concrete_cycle.objectivity.{name}.{what}");
        let worst = deviation(&name, &COUNTS, |count| {
            let [weak, strong] = [law(1.0 - WEAKER)?, law(1.0)?];
            dissipated(weak, strong, (2.0, count), (energy, strength))
        })?;
        figures.at_most(&name, worst, 0.02);
    }
    Ok(())
}

/// Residual strength of softening rock over its peak.
const RESIDUAL: f64 = 0.05;

/// Bars of rock with cohesion softening, in compression: dissipated energy beyond that of the residual strength.
fn softening_bars(figures: &mut Figures) -> Outcome<()> {
    let law = |share: f64| -> Outcome<SofteningPlasticity<MohrCoulomb>> {
        let surface = MohrCoulomb::new(MohrCoulombParameters {
            cohesion: 1.3e6 * share,
            ..presets::PAPER_CONCRETE
        })?;
        Ok(SofteningPlasticity::new(SofteningPlasticityParameters {
            surface,
            fall: StrengthFall::FractureEnergy { energy: CRUSHING },
            residual_strength: RESIDUAL,
        })?)
    };
    let name = "concrete_cycle.objectivity.mohr_coulomb_softening.crushing";
    let length = 2.0;
    let strength = law(1.0)?.parameters().surface.uniaxial_compression();
    let worst = deviation(name, &COUNTS, |count| {
        let [weak, strong] = [law(1.0 - WEAKER)?, law(1.0)?];
        // The strain range of `dissipated`, all of it plastic but for the residual stress.
        let young = weak.medium().young;
        let residual = RESIDUAL * (1.0 - WEAKER) * strength;
        let size = length / count as f64;
        let shortened = strength / young + 8.0 * CRUSHING / (strength * size) - residual / young;
        let all = dissipated(weak, strong, (length, count), (CRUSHING, -strength))?;
        Ok(all - residual * shortened * size / CRUSHING)
    })?;
    figures.at_most(name, worst, 0.02);
    Ok(())
}

/// Bars of Mazars' law in tension; in compression it is not regularised.
fn mazars_bars(
    figures: &mut Figures,
    name: &str,
    tension: MazarsTension,
    (length, counts): (f64, &[usize]),
) -> Outcome<()> {
    let law = |share: f64| -> Outcome<Mazars> {
        Ok(Mazars::new(MazarsParameters {
            threshold: 5.08e-5 * share,
            tension,
            residual_stiffness: 1.0e-6,
            ..presets::PAPER_CONCRETE_MAZARS
        })?)
    };
    let name = format!("concrete_cycle.objectivity.{name}.tension");
    let worst = deviation(&name, counts, |count| {
        let [weak, strong] = [law(1.0 - WEAKER)?, law(1.0)?];
        dissipated(weak, strong, (length, count), (CRACKING, 1.27e6))
    })?;
    figures.at_most(&name, worst, 0.02);
    Ok(())
}

fn objectivity(figures: &mut Figures) -> Outcome<()> {
    let medium: ElasticMedium = presets::PAPER_CONCRETE.medium;
    let plane = |share: f64| MohrCoulombParameters {
        cohesion: 1.3e6 * share,
        ..presets::PAPER_CONCRETE
    };
    let exact = MohrCoulomb::new(plane(1.0))?;
    let strengths = [exact.uniaxial_tension(), exact.uniaxial_compression()];
    let law = |share: f64| damaging(MohrCoulomb::new(plane(share))?);
    bars(figures, "eq25_mohr_coulomb", law, strengths)?;

    let cone = |share: f64| {
        DruckerPrager::new(DruckerPragerParameters {
            medium,
            friction: 47.7,
            dilation: 10.0,
            cohesion: 1.3e6 * share,
            fit: ConeFit::Inscribed,
        })
    };
    let exact = cone(1.0)?;
    let strengths = [exact.uniaxial_tension(), exact.uniaxial_compression()];
    let law = |share: f64| damaging(cone(share)?);
    bars(figures, "eq25_drucker_prager", law, strengths)?;

    let listed = presets::PAPER_CONCRETE_LISTED;
    let strengths = [listed.tension_strength, listed.compression_strength];
    let law = |share: f64| {
        damaging(TwoSurface::new(TwoSurfaceParameters {
            tension_strength: listed.tension_strength * share,
            compression_strength: listed.compression_strength * share,
            ..listed
        })?)
    };
    bars(figures, "eq25_two_surface", law, strengths)?;

    let concrete = SOFTENING;
    let law = |share: f64| -> Outcome<LeeFenves> {
        Ok(LeeFenves::new(LeeFenvesParameters {
            tension_strength: concrete.tension_strength * share,
            compression_strength: concrete.compression_strength * share,
            compression_limit: concrete.compression_limit * share,
            residual_stiffness: 1.0e-6,
            ..concrete
        })?)
    };
    bars(figures, "lee_fenves", law, strengths)?;

    softening_bars(figures)?;

    let energy = CRACKING;
    let falling = MazarsTension::FallingStress { energy };
    mazars_bars(figures, "mazars_falling_stress", falling, (2.0, &COUNTS))?;
    // Its permitted widths span a factor of five.
    let original = MazarsTension::FractureEnergy { energy };
    mazars_bars(figures, "mazars", original, (37.5, &COUNTS[..3]))?;
    Ok(())
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    objectivity(&mut figures)?;

    // One point under tension, compression and tension.
    let law = LeeFenves::new(SOFTENING)?;
    let path = lead(law, &[2.0e-4, -4.0e-4, 2.0e-4])?;
    let peak = path
        .iter()
        .map(|record| record.stress.0[2])
        .fold(0.0, f64::max);
    let strength = (peak / 1.27e6 - 1.0).abs();
    // The peak falls between two steps.
    figures.at_most("concrete_cycle.peak.error", strength, 1e-2);
    let [opened, again] = [&path[400], &path[1200]].map(|record| record.stress.0[2]);
    figures.at_most(
        "concrete_cycle.reopened.error",
        (again / opened - 1.0).abs(),
        1e-6,
    );
    let pressed = &path[800];
    let plastic = pressed.history[2];
    let modulus = pressed.stress.0[2] / (pressed.strain.0[2] - plastic);
    let stiffness = (modulus / law.medium().young - 1.0).abs();
    figures.at_most("concrete_cycle.closed.stiffness.error", stiffness, 1e-6);
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    draw(Path::new("results"))?;
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures().unwrap().missed(), 0);
    }

    /// The curves are drawn, one picture for each path.
    #[test]
    fn curves_are_drawn() {
        let folder = std::env::temp_dir().join(format!("concrete_cycle_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        draw(&folder).unwrap();
        for name in ["tension", "compression", "cycle"] {
            let text =
                std::fs::read_to_string(folder.join(format!("concrete_cycle_{name}.svg"))).unwrap();
            assert!(text.contains("Lee-Fenves"));
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
