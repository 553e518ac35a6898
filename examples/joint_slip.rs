//! Slip of joints: a shear wave on an interface, and a block on a shaken base.
//!
//! Builds on `free_field`. An interface with the shear strength `tau` limits the shear stress `Z V` of an S wave of
//! velocity `V sin(w t)`; the transmitted, reflected and absorbed shares of energy depend on `s = tau / (Z V)` alone and have
//! a closed form.
//!
//! ```text
//!      dashpot   |=|   ^                        block   +---+     pressed on by its weight
//!                | |   | transmitted                    |   |  -> slips when the base accelerates
//!     interface  |-|   |                        base  ==+===+==   by more than mu g
//!                | |   v reflected                      <-->
//!                | |
//!      dashpot   |=|   ^ V sin(w t)
//! ```
//!
//! The block is the sliding block of Newmark (1965): on a slope it slides downwards only, and its slip per cycle over
//! `A / w^2` depends on the ratio `r` of yield acceleration and amplitude `A` alone.
//!
//! Run: `cargo run --release --example joint_slip`

use std::f64::consts::{PI, TAU};
use std::process::ExitCode;

use powerhouse::contact::{BondedCoulomb, Joint};
use powerhouse::engine::{BuildModel, Leapfrog, Prescribed, RunOptions, StepChoice, run};
use powerhouse::model::{ElasticMedium, Vec3};
use powerhouse_examples::column::Column;
use powerhouse_examples::interface::{closed_form, computed};
use powerhouse_examples::{Figures, Outcome};

fn interface(figures: &mut Figures) -> Outcome<()> {
    for s in [0.2, 0.5, 0.8] {
        let expected = closed_form(s);
        let mut errors = [0.0; 2];
        for (error, bricks) in errors.iter_mut().zip([40, 80]) {
            let (found, _) = computed(s, bricks)?;
            println!("s = {s}, {bricks} bricks per wavelength: {found:.6?}, exact {expected:.6?}");
            let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            *error = differences.fold(0.0, f64::max);
        }
        figures.at_most(&format!("joint_slip.energy.s{s}.error"), errors[1], 0.005);
        let slope = format!("joint_slip.energy.s{s}.error_over_half_mesh");
        figures.at_most(&slope, errors[1] / errors[0], 0.5);
    }
    Ok(())
}

/// A block whose base is shaken by an acceleration `A sin(w t)`.
struct Shaken {
    /// Friction coefficient.
    friction: f64,
    /// Slope of the base (rad).
    slope: f64,
}

const AMPLITUDE: f64 = 3.0;
const FREQUENCY: f64 = 2.0;
const GRAVITY: f64 = 9.81;
const CYCLES: usize = 5;
/// Steps per cycle.
const STEPS: u64 = 50_000;

impl Shaken {
    /// Slip at the end of each cycle (m).
    fn slips(&self) -> Outcome<Vec<f64>> {
        let omega = TAU * FREQUENCY;
        // Block and base are one element each, a thousand times as stiff as rock: nearly rigid.
        let stiff = ElasticMedium::new(9e12, 0.27, 2750.0)?;
        let column = Column::new(&[(1, stiff), (1, stiff)], 1.0)?;
        let (slope, weight) = (self.slope, stiff.density * GRAVITY);
        // The weight and its component along the slope act from the start: a preload.
        let law = BondedCoulomb::unbonded(self.friction, self.friction)?;
        let joint = Joint::new("base", column.joints[0].pairs.clone(), law)?
            .with_preload(|_| Vec3::new(slope.sin(), 0.0, -slope.cos()) * weight)?;
        let base = column
            .mesh
            .nodes_of_elements(column.mesh.element_set("part 0")?);
        let block = column
            .mesh
            .nodes_of_elements(column.mesh.element_set("part 1")?);
        let mut model = column
            .along(0)
            .prescribed(Prescribed {
                nodes: base.clone(),
                direction: Vec3::x(),
                displacement: Box::new(move |t: f64| {
                    -AMPLITUDE / omega.powi(2) * (omega * t).sin()
                }),
            })
            .constraint(Box::new(joint))
            .build()?;
        let count = column.mesh.node_count();
        let start = Vec3::x() * (-AMPLITUDE / omega);
        model.set_initial(&vec![Vec3::zeros(); count], &vec![start; count])?;
        let options =
            RunOptions::steps(STEPS).with_step(StepChoice::Fixed(1.0 / FREQUENCY / STEPS as f64));
        let mut slips = vec![0.0];
        for _ in 0..CYCLES {
            run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {})?;
            slips.push((model.displacement(block[0]) - model.displacement(base[0])).x);
        }
        Ok(slips)
    }
}

/// Slip per cycle over `A / w^2`: from `sin x = r` on until the relative velocity is back at zero.
fn newmark(ratio: f64) -> f64 {
    let start = ratio.asin();
    let speed = |x: f64| start.cos() - x.cos() - ratio * (x - start);
    let (mut low, mut high) = (PI - start, TAU + start);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if speed(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let x = low - start;
    start.cos() * x - (low.sin() - start.sin()) - 0.5 * ratio * x * x
}

/// Slip after each cycle on a level base, by the relative motion of a rigid block in small steps.
fn both_ways(ratio: f64) -> Vec<f64> {
    let (omega, parts) = (TAU * FREQUENCY, 200_000);
    let step = 1.0 / FREQUENCY / f64::from(parts);
    let (mut velocity, mut slip, mut slips) = (0.0_f64, 0.0, vec![0.0]);
    for _ in 0..CYCLES {
        for part in 0..parts {
            let time = (f64::from(part) + 0.5) * step;
            let trial = velocity - AMPLITUDE * (omega * time).sin() * step;
            let held = ratio * AMPLITUDE * step;
            velocity = trial - trial.clamp(-held, held);
            slip += velocity * step;
        }
        slips.push(slip);
    }
    slips
}

fn block(figures: &mut Figures) -> Outcome<()> {
    let scale = AMPLITUDE / (TAU * FREQUENCY).powi(2);
    for ratio in [0.1, 0.5, 0.9] {
        // Friction 2 on the slope where g (mu cos - sin) is the yield acceleration.
        let friction: f64 = 2.0;
        let slope = friction.atan() - (ratio * AMPLITUDE * friction.atan().cos() / GRAVITY).asin();
        let slips = Shaken { friction, slope }.slips()?;
        let found = (slips[CYCLES] - slips[CYCLES - 1]) / scale;
        println!(
            "r = {ratio}, one way: slip per cycle {found:.6}, exact {:.6}",
            newmark(ratio)
        );
        let error = (found / newmark(ratio) - 1.0).abs();
        figures.at_most(
            &format!("joint_slip.newmark.one_way.r{ratio}.error"),
            error,
            2e-3,
        );
    }
    for ratio in [0.4, 0.7] {
        let friction = ratio * AMPLITUDE / GRAVITY;
        let slips = Shaken {
            friction,
            slope: 0.0,
        }
        .slips()?;
        let exact = both_ways(ratio);
        let largest = exact.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let differences = slips.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        let error = differences.fold(0.0, f64::max) / largest;
        println!("r = {ratio}, both ways: {slips:.6?} m, exact {exact:.6?} m");
        figures.at_most(
            &format!("joint_slip.newmark.two_way.r{ratio}.error"),
            error,
            2e-3,
        );
    }
    Ok(())
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    interface(&mut figures)?;
    block(&mut figures)?;
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
