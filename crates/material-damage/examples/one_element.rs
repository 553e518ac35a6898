//! A finite element of another code around a law of this crate, which is all that it takes: a triaxial test.
//!
//! ```text
//!          axial strain
//!           | | | |
//!        +-----------+
//!   ->   |           |   <-   confining pressure on four sides
//!   ->   | one brick |   <-
//!        +-----------+
//! ```
//!
//! One brick with eight integration points, the elastic stiffness, and Newton's method with it for the free sides: the
//! law is evaluated with the committed history variables and trial strains, and what it returns is committed once the
//! sides are in equilibrium. Expected: the strength of Mohr-Coulomb, `-s1 = p N + 2 c sqrt(N)` with
//! `N = (1 + sin phi) / (1 - sin phi)`, and the path of [`PointDriver`].
//!
//! Run: `cargo run --release --example one_element`

use std::process::ExitCode;

use nalgebra::{SMatrix, SVector};
use powerhouse_material_damage::{Control, ElastoPlastic, MohrCoulomb, PointDriver, presets};
use powerhouse_model::{ConstitutiveLaw, Extents, LawInput, Strain, Stress};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;
type Matrix = SMatrix<f64, 24, 24>;
type Vector = SVector<f64, 24>;

/// Edge of the brick (m), confining pressure (Pa), axial strain at the end, and its steps.
const EDGE: f64 = 0.5;
const PRESSURE: f64 = 5e6;
const SHORTENING: f64 = 0.02;
const STEPS: usize = 100;
/// Corner `a` is on the far side of axis `c` if bit `c` of `a` is set.
fn side(a: usize, c: usize) -> f64 {
    f64::from(((a >> c) & 1) as u8) * 2.0 - 1.0
}

/// Strain of nodal displacements at a point of Gauss, rows xx yy zz xy yz zx.
fn strain_matrix(point: usize) -> SMatrix<f64, 6, 24> {
    let mut b = SMatrix::<f64, 6, 24>::zeros();
    for a in 0..8 {
        let share = |c: usize| 1.0 + side(a, c) * side(point, c) / 3f64.sqrt();
        let [x, y, z] =
            [0, 1, 2].map(|c| side(a, c) * share((c + 1) % 3) * share((c + 2) % 3) / (4.0 * EDGE));
        for (row, column, value) in [
            (0, 0, x),
            (1, 1, y),
            (2, 2, z),
            (3, 0, y),
            (3, 1, x),
            (4, 1, z),
            (4, 2, y),
            (5, 2, x),
            (5, 0, z),
        ] {
            b[(row, 3 * a + column)] = value;
        }
    }
    b
}

/// The brick: committed history variables of its points.
struct Brick<M> {
    law: M,
    points: Vec<SMatrix<f64, 6, 24>>,
    history: Vec<Vec<f64>>,
}

impl<M: ConstitutiveLaw> Brick<M> {
    fn new(law: M) -> Self {
        let history = vec![vec![0.0; law.history().len()]; 8];
        let points = (0..8).map(strain_matrix).collect();
        Self {
            law,
            points,
            history,
        }
    }
    /// Nodal forces (N), mean stress (Pa), and the history variables that would be committed.
    fn evaluate(&self, displacement: &Vector) -> (Vector, Stress, Vec<Vec<f64>>) {
        let (mut forces, mut mean) = (Vector::zeros(), Stress([0.0; 6]));
        let mut new = self.history.clone();
        let weight = EDGE.powi(3) / 8.0;
        for ((b, old), new) in self.points.iter().zip(&self.history).zip(&mut new) {
            let strain = Strain((b * displacement).into());
            let input = LawInput::new(strain, old).with_extents(Extents::uniform(EDGE));
            let stress = self.law.stress_change(&input, new);
            forces += b.transpose() * SVector::from(stress.0) * weight;
            for (mean, stress) in mean.0.iter_mut().zip(stress.0) {
                *mean += stress / 8.0;
            }
        }
        (forces, mean, new)
    }
    /// The elastic stiffness (N/m).
    fn stiffness(&self) -> Matrix {
        let medium = self.law.medium();
        let mut elastic = SMatrix::<f64, 6, 6>::zeros();
        for i in 0..6 {
            let mut unit = Strain([0.0; 6]);
            unit.0[i] = 1.0;
            elastic.set_column(
                i,
                &Stress::elastic(medium.lambda(), medium.shear(), &unit)
                    .0
                    .into(),
            );
        }
        let weight = EDGE.powi(3) / 8.0;
        let of_point = |b: &SMatrix<f64, 6, 24>| b.transpose() * elastic * b * weight;
        self.points.iter().map(of_point).sum()
    }
    /// Finds the free displacements at which they carry the load, and commits.
    fn solve(&mut self, displacement: &mut Vector, held: &[bool; 24], load: &Vector) -> Stress {
        let mut stiffness = self.stiffness();
        for i in (0..24).filter(|&i| held[i]) {
            stiffness.fill_row(i, 0.0);
            stiffness.fill_column(i, 0.0);
            stiffness[(i, i)] = 1.0;
        }
        let inverse = stiffness.try_inverse().unwrap_or_else(Matrix::zeros);
        let scale = PRESSURE * EDGE * EDGE;
        for _ in 0..5000 {
            let (forces, ..) = self.evaluate(displacement);
            let residual = Vector::from_fn(|i, _| if held[i] { 0.0 } else { load[i] - forces[i] });
            if residual.amax() < 1e-13 * scale {
                break;
            }
            *displacement += inverse * residual;
        }
        let (_, stress, history) = self.evaluate(displacement);
        self.history = history;
        stress
    }
}

/// The axial stress of the brick in every step (Pa): first the pressure, then the axial strain.
fn tested(law: impl ConstitutiveLaw) -> Vec<f64> {
    let mut brick = Brick::new(law);
    let pressed = |a: usize, c: usize| -side(a, c) * PRESSURE * EDGE * EDGE / 4.0;
    let load = Vector::from_fn(|i, _| pressed(i / 3, i % 3));
    // Three sides are roller-supported.
    let mut held = [false; 24];
    (0..24).for_each(|i| held[i] = side(i / 3, i % 3) < 0.0);
    let mut displacement = Vector::zeros();
    let mut stress = vec![brick.solve(&mut displacement, &held, &load).0[2]];
    let start = displacement;
    for step in 1..=STEPS {
        let axial = SHORTENING * EDGE * step as f64 / STEPS as f64;
        for a in (0..8).filter(|&a| side(a, 2) > 0.0) {
            held[3 * a + 2] = true;
            displacement[3 * a + 2] = start[3 * a + 2] - axial;
        }
        stress.push(brick.solve(&mut displacement, &held, &load).0[2]);
    }
    stress
}

fn figures() -> Outcome<[(&'static str, f64, f64); 2]> {
    let rock = presets::PAPER_ROCK;
    let found = tested(ElastoPlastic::new(MohrCoulomb::new(rock)?));

    let mut point = PointDriver::new(ElastoPlastic::new(MohrCoulomb::new(rock)?));
    let all = [Control::Stress(-PRESSURE), Control::Stress(0.0)];
    point.advance([all[0], all[0], all[0], all[1], all[1], all[1]], 1)?;
    let mut target = [all[0], all[0], all[0], all[1], all[1], all[1]];
    target[2] = Control::Strain(point.state().strain.0[2] - SHORTENING);
    let expected = point.advance(target, STEPS)?;
    let pairs = found[1..].iter().zip(&expected);
    let apart = pairs.map(|(a, state)| (a - state.stress.0[2]).abs());
    let difference = apart.fold(0.0, f64::max) / PRESSURE;

    let angle = rock.friction.to_radians();
    let ratio = (1.0 + angle.sin()) / (1.0 - angle.sin());
    let strength = PRESSURE * ratio + 2.0 * rock.cohesion * ratio.sqrt();
    let error = (found[STEPS] + strength).abs() / strength;
    println!("axial stress at the end: {:.4} MPa", found[STEPS] / 1e6);
    Ok([
        ("one_element.strength", error, 1e-8),
        ("one_element.difference_of_point_driver", difference, 1e-7),
    ])
}

fn main() -> Outcome<ExitCode> {
    let mut missed = 0;
    for (name, value, limit) in figures()? {
        println!("figure {name} {value:.6e}\n    limit {limit:e}");
        // NaN misses its limit, too.
        missed += u8::from(value.is_nan() || value > limit);
    }
    Ok(ExitCode::from(missed))
}

#[cfg(test)]
mod tests {
    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        for (name, value, limit) in super::figures().unwrap() {
            assert!(value <= limit, "{name}: {value:e}");
        }
    }
}
