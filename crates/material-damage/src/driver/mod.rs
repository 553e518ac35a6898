//! Material point driver: one integration point of a law under paths of strain and stress.

mod loading;

use nalgebra::{DMatrix, DVector};
use powerhouse_model::{
    ConstitutiveLaw, Extents, LawInput, ParameterError, PointLocation, Strain, Stress,
};

use crate::MaterialError;

/// Greatest number of corrections of the free strains in one step.
const MOST_CORRECTIONS: usize = 60;
/// Greatest number of halvings of one correction.
const MOST_HALVINGS: usize = 12;
/// Greatest number of sweeps of a singular value decomposition; matrices of six rows need some ten.
const MOST_ROTATIONS: usize = 200;
/// Share of the residual above which a correction is slow: at a kink the difference quotients may be
/// of different sides. The observed change then corrects the tangent (Broyden 1965).
const SLOW_CONVERGENCE: f64 = 0.3;
/// Greatest number of such corrections of a tangent.
const MOST_TANGENT_CORRECTIONS: usize = 6;
/// Tolerance of stresses, relative to the largest stress at the point; corrections continue as long
/// as the residual decreases.
const TOLERANCE: f64 = 1.0e-9;
/// Tolerance of stresses in rounding errors of the elastic stress of the strain.
const ROUNDINGS: f64 = 4.0;
/// Stiffness below this share of Young's modulus counts as zero and is replaced by the elastic one.
const NO_STIFFNESS: f64 = 1.0e-7;
/// Strain step of the difference quotient, relative to the strain at which stresses are of the
/// size of those at the point; smaller where less is left to correct, so that it crosses no kink.
const DIFFERENCE: f64 = 1.0e-6;

/// Prescribed quantity of one component at a material point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// Prescribed total strain (1); engineering strain of a shear component.
    Strain(f64),
    /// Prescribed total stress (Pa).
    Stress(f64),
}

/// State of a material point at the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct PointState {
    /// Total strain (1), engineering shears.
    pub strain: Strain,
    /// Total stress, initial stress included (Pa).
    pub stress: Stress,
    /// History variables in the order of the law.
    pub history: Vec<f64>,
    /// Work of the stress since the start, by the trapezoidal rule (J/m3).
    pub work: f64,
}

/// Material point driver: evaluates a law at one point along a path of strain and stress, without a mesh.
///
/// Of every component, xx yy zz xy yz zx, either the strain or the stress is prescribed, independently
/// of the others; the other strains are found by Newton's method with difference quotients.
/// [`Control::uniaxial`], [`Control::triaxial`], [`Control::plane_strain`],
/// [`Control::biaxial`] and [`Control::simple_shear`] are the usual laboratory tests; in sequence they
/// make load cycles.
///
/// ```
/// use powerhouse_material_damage::{Control, PointDriver, presets};
///
/// let concrete = presets::paper_concrete()?;
/// let mut point = PointDriver::new(concrete).with_size(0.5)?;
/// let pulled = point.advance(Control::uniaxial(3.0e-4), 100)?;
/// let peak = pulled.iter().map(|r| r.stress.0[2]).fold(0.0, f64::max);
/// assert!((0.9e6..1.01e6).contains(&peak), "the surface yields at {peak}");
/// let pressed = point.advance(Control::uniaxial(-2.0e-3), 100)?;
/// assert!(pressed[99].stress.0[2] < -5.0e6, "closed cracks carry pressure");
/// # Ok::<(), powerhouse_material_damage::MaterialError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PointDriver<M> {
    law: M,
    initial: Stress,
    extents: Extents<f64>,
    steps: usize,
    now: PointState,
}

impl<M: ConstitutiveLaw> PointDriver<M> {
    /// Point without strain, initial stress or history, in an element of 1 m.
    pub fn new(law: M) -> Self {
        let now = PointState {
            strain: Strain::default(),
            stress: Stress::default(),
            history: vec![0.0; law.history().len()],
            work: 0.0,
        };
        Self {
            law,
            initial: Stress::default(),
            extents: Extents::uniform(1.0),
            steps: 0,
            now,
        }
    }

    /// This point with an initial stress at zero strain (Pa).
    ///
    /// # Errors
    /// If the stress is not finite.
    pub fn with_initial(mut self, initial: Stress) -> Result<Self, MaterialError> {
        finite(&initial.0, "initial stress", 0)?;
        self.initial = initial;
        self.now.stress = initial;
        Ok(self)
    }

    /// This point in an element of another width (m), the same in all directions.
    ///
    /// # Errors
    /// If the width is not positive.
    pub fn with_size(self, size: f64) -> Result<Self, MaterialError> {
        ParameterError::check("size", size, f64::MIN_POSITIVE, f64::MAX)?;
        self.with_extents(Extents::uniform(size))
    }

    /// This point in an element whose widths differ by direction (m).
    ///
    /// # Errors
    /// If a width is not positive.
    pub fn with_extents(mut self, extents: Extents<f64>) -> Result<Self, MaterialError> {
        for width in extents.principal() {
            ParameterError::check("extents", width, f64::MIN_POSITIVE, f64::MAX)?;
        }
        self.extents = extents;
        Ok(self)
    }

    /// Current state of the point.
    pub fn state(&self) -> &PointState {
        &self.now
    }

    /// Law of the point.
    pub fn law(&self) -> &M {
        &self.law
    }

    /// Advances the point to the target in equal steps and returns the state after each.
    ///
    /// # Errors
    /// [`MaterialError::NotFinite`] if a target or a response is not finite,
    /// [`MaterialError::Unreachable`] if no strain gives the stress (past a peak, for example); the
    /// point then remains at the state before that step.
    pub fn advance(
        &mut self,
        target: [Control; 6],
        steps: usize,
    ) -> Result<Vec<PointState>, MaterialError> {
        let mut states = Vec::with_capacity(steps);
        self.advance_into(target, steps, &mut states)?;
        Ok(states)
    }

    /// Advances the point to the target in equal steps and appends the state after each, in a failure of those before it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub fn advance_into(
        &mut self,
        target: [Control; 6],
        steps: usize,
        states: &mut Vec<PointState>,
    ) -> Result<(), MaterialError> {
        let start = self.now.clone();
        for step in 1..=steps {
            let share = step as f64 / steps as f64;
            let between = |from: f64, to: f64| {
                if step == steps {
                    to
                } else {
                    from + share * (to - from)
                }
            };
            let here = core::array::from_fn(|i| match target[i] {
                Control::Strain(end) => Control::Strain(between(start.strain.0[i], end)),
                Control::Stress(end) => Control::Stress(between(start.stress.0[i], end)),
            });
            self.step(here)?;
            states.push(self.now.clone());
        }
        Ok(())
    }

    /// Stress and history of a strain, from the current history.
    fn respond(&self, strain: &Strain) -> Result<(Stress, Vec<f64>), MaterialError> {
        finite(&strain.0, "strain", self.steps)?;
        let mut history = self.now.history.clone();
        let origin = PointLocation::new([0.0; 3], &[0]);
        let input = LawInput::new(*strain, &self.now.history)
            .with_initial(self.initial)
            .with_extents(self.extents)
            .with_location(&origin);
        let stress = self.initial + self.law.stress_change(&input, &mut history);
        finite(&stress.0, "stress", self.steps)?;
        finite(&history, "history", self.steps)?;
        Ok((stress, history))
    }

    /// Advances the point by one step to its target.
    fn step(&mut self, target: [Control; 6]) -> Result<(), MaterialError> {
        let mut driven = self.now.strain;
        let mut free = Vec::new();
        for (i, control) in target.into_iter().enumerate() {
            match control {
                Control::Strain(value) => driven.0[i] = value,
                Control::Stress(value) => {
                    finite(&[value], "target", self.steps)?;
                    free.push((i, value));
                }
            }
        }
        // If the elastic first guess ends in a corner of the surface that no correction leaves, such as
        // the apex, a guess of constant volume or of unchanged free strains may succeed.
        let mut found = None;
        for guess in [Guess::Elastic, Guess::ConstantVolume, Guess::Held] {
            let mut strain = driven;
            match self.equilibrate(&mut strain, &free, guess) {
                Ok((stress, history)) => {
                    found = Some(Ok((strain, stress, history)));
                    break;
                }
                Err(error @ MaterialError::Unreachable { .. }) => {
                    found.get_or_insert(Err(error));
                }
                Err(error) => return Err(error),
            }
        }
        let (strain, stress, history) = match found {
            Some(found) => found?,
            None => return Ok(()),
        };
        let moved = strain - self.now.strain;
        let mean = (stress + self.now.stress) * 0.5;
        self.now = PointState {
            strain,
            stress,
            history,
            work: self.now.work + mean.work(&moved),
        };
        self.steps += 1;
        Ok(())
    }

    /// Difference quotients of the free stresses, each in the direction of the correction, so that it is
    /// of the side on which it is used.
    fn quotients(
        &self,
        strain: &Strain,
        free: &[(usize, f64)],
        residual: &DVector<f64>,
        scale: f64,
    ) -> Result<DMatrix<f64>, MaterialError> {
        let difference = residual
            .amax()
            .clamp(1.0e-4 * DIFFERENCE * scale, DIFFERENCE * scale);
        let difference = difference / self.law.medium().young;
        let mut tangent = DMatrix::zeros(free.len(), free.len());
        for (column, &(index, _)) in free.iter().enumerate() {
            let mut moved = *strain;
            let towards = -residual[column].signum() * difference;
            moved.0[index] += towards;
            let stress = self.respond(&moved)?.0;
            let rest = free.iter().map(|&(i, to)| stress.0[i] - to);
            let moved = DVector::from_iterator(free.len(), rest) - residual;
            tangent.set_column(column, &(moved / towards));
        }
        Ok(tangent)
    }

    /// Solves for the free strains whose stresses are the targets.
    fn equilibrate(
        &self,
        strain: &mut Strain,
        free: &[(usize, f64)],
        guess: Guess,
    ) -> Result<(Stress, Vec<f64>), MaterialError> {
        let medium = self.law.medium();
        let modulus = medium.young;
        let rest = |stress: &Stress| {
            DVector::from_iterator(free.len(), free.iter().map(|&(i, to)| stress.0[i] - to))
        };
        if free.is_empty() {
            return self.respond(strain);
        }
        let elastic = |strain: &Strain| Stress::elastic(medium.lambda(), medium.shear(), strain);
        let moved = self.now.stress + elastic(&(*strain - self.now.strain));
        let stiffness = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let mut unit = Strain::default();
            unit.0[free[column].0] = 1.0;
            elastic(&unit).0[free[row].0]
        });
        match guess {
            Guess::Elastic => correct(strain, free, 1.0, &solve(stiffness, &rest(&moved), modulus)),
            Guess::ConstantVolume => {
                let normals = free.iter().filter(|(index, _)| *index < 3).count();
                let driven: f64 = (0..3).map(|i| strain.0[i] - self.now.strain.0[i]).sum();
                for &(index, _) in free.iter().filter(|(index, _)| *index < 3) {
                    strain.0[index] -= driven / normals as f64;
                }
            }
            Guess::Held => {}
        }

        let mut answer = self.respond(strain)?;
        let mut residual = rest(&answer.0);
        let scale = self.now.stress.0.iter().chain(&answer.0.0);
        let scale = scale.fold(0.0_f64, |most, s| most.max(s.abs()));
        let largest = strain.0.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
        let tolerance = (TOLERANCE * scale).max(ROUNDINGS * f64::EPSILON * modulus * largest);
        // Tangent corrected by the change observed along the last step, and the number of corrections.
        let mut corrected: Option<(DMatrix<f64>, usize)> = None;
        for _ in 0..MOST_CORRECTIONS {
            if residual.amax() == 0.0 {
                break;
            }
            let (mut tangent, mut tangent_corrections) = match corrected.take() {
                Some(kept) => kept,
                None => (self.quotients(strain, free, &residual, scale)?, 0),
            };
            let mut correction = solve(tangent.clone(), &residual, modulus);
            let mut share = 1.0;
            let mut halvings = 0;
            let (moved, next, remaining) = loop {
                let mut moved = *strain;
                correct(&mut moved, free, share, &correction);
                let next = self.respond(&moved)?;
                let remaining = rest(&next.0);
                let gained = remaining.norm() < residual.norm();
                let length = correction.norm_squared();
                let corrections_left =
                    tangent_corrections < MOST_TANGENT_CORRECTIONS && length > 0.0;
                if halvings == 0
                    && corrections_left
                    && remaining.norm() > SLOW_CONVERGENCE * residual.norm()
                {
                    let seen = &residual - &remaining;
                    let missed = seen - &tangent * &correction;
                    tangent += missed * correction.transpose() / length;
                    tangent_corrections += 1;
                    if gained {
                        corrected = Some((tangent, tangent_corrections));
                        break (moved, next, remaining);
                    }
                    correction = solve(tangent.clone(), &residual, modulus);
                    continue;
                }
                if gained || halvings == MOST_HALVINGS {
                    break (moved, next, remaining);
                }
                share *= 0.5;
                halvings += 1;
            };
            if residual.amax() <= tolerance && remaining.norm() >= residual.norm() {
                break;
            }
            (*strain, answer, residual) = (moved, next, remaining);
        }
        if residual.amax() <= tolerance {
            return Ok(answer);
        }
        Err(MaterialError::Unreachable {
            step: self.steps,
            residual: residual.amax(),
            tolerance,
        })
    }
}

/// First guess of the free strains of a step.
#[derive(Clone, Copy)]
enum Guess {
    /// Strains of an elastic step.
    Elastic,
    /// Strains of a step of constant volume.
    ConstantVolume,
    /// Strains of the step before.
    Held,
}

/// Subtracts a share of a correction from the free strains.
fn correct(strain: &mut Strain, free: &[(usize, f64)], share: f64, correction: &DVector<f64>) {
    for (row, &(i, _)) in free.iter().enumerate() {
        strain.0[i] -= share * correction[row];
    }
}

/// Strains of a residual stress; directions without stiffness (on an edge of a yield surface, for
/// example) are taken as elastic.
fn solve(tangent: DMatrix<f64>, residual: &DVector<f64>, modulus: f64) -> DVector<f64> {
    let parts = tangent.try_svd(true, true, f64::EPSILON, MOST_ROTATIONS);
    let Some((Some(left), Some(right), values)) =
        parts.map(|parts| (parts.u, parts.v_t, parts.singular_values))
    else {
        return residual / modulus;
    };
    let mut scaled = left.transpose() * residual;
    for (entry, stiffness) in scaled.iter_mut().zip(values.iter()) {
        let is_none = *stiffness < NO_STIFFNESS * modulus;
        *entry /= if is_none { modulus } else { *stiffness };
    }
    right.transpose() * scaled
}

fn finite(numbers: &[f64], what: &'static str, step: usize) -> Result<(), MaterialError> {
    if numbers.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(MaterialError::NotFinite { step, what })
    }
}
