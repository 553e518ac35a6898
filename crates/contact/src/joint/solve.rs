//! Solution for the impulses of connected pairs in one step.

use nalgebra::{DMatrix, DVector};
use powerhouse_model::{Bond, ContactLaw, ContactState, JointInput, JointState, Vec3};
use serde::{Deserialize, Serialize};

use super::matrices::Matrices;

/// Number of sweeps over a group in one step after which its solution counts as failed.
const MOST_SWEEPS: u32 = 20_000;
/// Number of sweeps after which pairs that stick are held instead.
const PATIENCE: u32 = 64;
/// Relative change of motion in one sweep at which a solution counts as converged; see [`Change`].
const TOLERANCE: f64 = 1e-11;

/// Number of sweeps after which the tolerance grows, see [`tolerance`].
const LONG: u32 = 256;

/// Relative change of motion that a solution may have at last, after [`MOST_SWEEPS`]: the effort of the joint states it.
const ROUGH: f64 = 1e-3;

/// Share of its change that the impulse of a softening pair takes, after a number of sweeps.
///
/// The steeper a bond softens, the more its traction falls as its trial grows, so that pairs which share a node may answer each other for
/// ever: by up to three times the change in one that is alone, at the steepest that a step resolves. A smaller share converges.
fn share(sweeps: u32) -> f64 {
    match sweeps / LONG {
        0 => 1.0,
        1..4 => 0.5,
        4..16 => 0.2,
        _ => 0.05,
    }
}

/// Tolerance after a number of sweeps.
///
/// It grows with their number: the shares of the faces of a corner are not unique under friction, and
/// where rounding has left gaps between them the sweeps may pass a force around for ever. Any motion that
/// obeys all of them is a solution, and a gap that it leaves is closed in the next step.
fn tolerance(sweeps: u32) -> f64 {
    if sweeps >= MOST_SWEEPS {
        return ROUGH;
    }
    TOLERANCE * (f64::from(sweeps.max(LONG)) / f64::from(LONG)).powi(3)
}

/// Effort of the solution of a group, and its residual.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Effort {
    /// Number of sweeps.
    pub(super) sweeps: u32,
    /// Relative change of the motion in the last sweep.
    pub(super) residual: f64,
}

/// Pair of a group in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<'a, L> {
    pub(super) law: &'a L,
    /// Input of the law: committed values, but for the state of a pair that was let go, which is the one
    /// that the law returned then, and trial and compliance, which are those of the last evaluation.
    pub(super) input: JointInput<'a>,
    /// Traction that acts without the joint's forces (Pa).
    pub(super) preload: Vec3,
    /// Impulse per traction, area times step (N s/Pa).
    pub(super) per_traction: f64,
    /// Whether the pair is held together whatever the impulse.
    pub(super) held: bool,
    /// Whether the pair was let go and is not to be held again in this step.
    let_go: bool,
    /// Whether its shear is reduced to the sliding strength.
    slides: bool,
    /// Whether its normal impulse is at its bound, where the sides part.
    parts: bool,
    /// State that the law returned in the last sweep, of a pair whose tractions follow its displacement.
    followed: Option<JointState>,
}

impl<'a, L: ContactLaw> Contact<'a, L> {
    /// Pair at the start of a step, with committed input; held if it stuck or is bonded.
    pub(super) fn new(law: &'a L, input: JointInput<'a>, preload: Vec3, per_traction: f64) -> Self {
        let state = &input.state;
        Self {
            law,
            input,
            preload,
            per_traction,
            held: state.contact == ContactState::Stick || state.bond == Bond::Intact,
            let_go: false,
            slides: false,
            parts: false,
            followed: None,
        }
    }

    /// Traction (Pa), preload included, of an impulse.
    pub(super) fn traction(&self, impulse: &Vec3) -> Vec3 {
        self.preload + impulse / self.per_traction
    }

    /// Whether the pair may bear tension while it is closed: by its bond, or as its law permits without
    /// one.
    fn bears_tension(&self) -> bool {
        let JointState { contact, bond, .. } = self.input.state;
        let closed = contact != ContactState::Open;
        bond == Bond::Intact || (closed && self.law.unbonded_tension(&self.input) > 0.0)
    }

    /// State of the pair after the step, under its final traction.
    pub(super) fn outcome(&self) -> JointState {
        if let (false, Some(state)) = (self.held, self.followed) {
            return state;
        }
        let contact = if self.held {
            ContactState::Stick
        } else if self.parts {
            ContactState::Open
        } else if self.slides {
            ContactState::Slide
        } else {
            ContactState::Stick
        };
        self.input.state.with_contact(contact)
    }

    /// Admissible normal impulse nearest to a trial; that of a pair that bears tension is the trial, until
    /// the pair is let go.
    fn normal(&mut self, trial: f64) -> f64 {
        self.parts = false;
        if self.bears_tension() {
            return trial;
        }
        // An open pair may bear the traction of a cohesive zone.
        let cohesive = self.law.unbonded_tension(&self.input);
        if cohesive > 0.0 {
            return trial.min((cohesive - self.preload.x) * self.per_traction);
        }
        // Decided here: the traction of the bounded impulse is zero but for rounding.
        let bound = -self.preload.x * self.per_traction;
        self.parts = trial >= bound;
        trial.min(bound)
    }

    /// Impulse of a pair whose tractions follow its displacement, from the last one and the relative velocity that it leaves,
    /// with the relative velocity per impulse (1/kg); none for other pairs.
    fn following(&mut self, impulse: &Vec3, left: &Vec3, mobility: f64) -> Option<Vec3> {
        let follows = mobility > 0.0 && self.law.follows_displacement(&self.input.state);
        if !follows {
            self.followed = None;
            return None;
        }
        self.input.trial = self.traction(&(impulse + left / mobility));
        self.input.compliance = mobility * self.per_traction;
        let mut new_history = self.input.history.to_vec();
        let response = self.law.admissible(&self.input, &mut new_history);
        self.followed = Some(response.state);
        self.slides = true;
        Some((response.traction - self.preload) * self.per_traction)
    }

    /// Derivative of the sliding strength with respect to the pressure.
    fn friction(&self) -> f64 {
        let strength = |normal| self.law.sliding_strength(normal, &self.input);
        let growth = strength(-2.0) - strength(-1.0);
        if growth.is_finite() { growth } else { 0.0 }
    }

    /// Admissible tangential impulse nearest to a trial beside a normal one, and whether the pair slides;
    /// `mobility` is the relative velocity per tangential impulse (1/kg).
    fn tangential(&mut self, normal: f64, trial: [f64; 2], mobility: f64) -> ([f64; 2], bool) {
        let pressure = self.preload.x + normal / self.per_traction;
        let total = [0, 1].map(|i| self.preload[i + 1] + trial[i] / self.per_traction);
        self.input.trial = Vec3::new(pressure, total[0], total[1]);
        self.input.compliance = mobility * self.per_traction;
        let strength = self.law.sliding_strength(pressure, &self.input);
        let shear = (total[0] * total[0] + total[1] * total[1]).sqrt();
        if shear <= strength && strength > 0.0 {
            return (trial, false);
        }
        let share = if shear > 0.0 { strength / shear } else { 0.0 };
        let cut = [0, 1].map(|i| (total[i] * share - self.preload[i + 1]) * self.per_traction);
        (cut, true)
    }
}

/// Solves for the impulses of a group, starting from `impulses`.
///
/// Pairs that are held have no relative velocity; they are eliminated. Where that does not determine their impulses, those
/// nearest to `reference` are taken. The others are solved by
/// projected Gauss-Seidel sweeps: the normal impulse from no normal motion, then the tangential one
/// changed by the slip over the greatest tangential eigenvalue and reduced to the sliding strength. Where
/// shear moves the normal, too, the normal step is shortened by friction times that, without which the
/// sweeps diverge under a large coefficient. (Slipping along the trial direction instead errs by up
/// to 120 % of the force where a dashpot makes masses differ elevenfold; taking the direction of the
/// last slip diverges.)
///
/// Of the held pairs whose traction the law does not admit the worst is let go, and so on until all
/// others hold. Sweeps over pairs that turn out to stick may not converge, most of all around a
/// closed ring, where impulses are not unique: those are held after [`PATIENCE`] sweeps.
///
/// # Errors
/// Sweeps and residual if it has not converged after [`MOST_SWEEPS`], or if pairs do not yield that were let go four times
/// each: twice is enough for a pair whose law breaks its bond.
pub(super) fn solve<L: ContactLaw>(
    (coupling, matrices): (&DMatrix<f64>, &mut Matrices),
    contacts: &mut [Contact<L>],
    (excess, reference): (&DVector<f64>, &DVector<f64>),
    impulses: &mut DVector<f64>,
) -> Result<Effort, Effort> {
    let mut effort = Effort::default();
    let mut chances = 4 * contacts.len();
    loop {
        let held: Vec<bool> = contacts.iter().map(|contact| contact.held).collect();
        if matrices.held != held {
            *matrices = Matrices::new(coupling, &held);
        }
        let mut free = matrices.free_part(impulses);
        effort.residual = 0.0;
        if !free.is_empty() {
            let rest = matrices.free_excess(excess);
            effort.residual = sweep(matrices, contacts, &rest, &mut free, &mut effort.sweeps);
        }
        matrices.complete((excess, reference), &free, impulses);
        if effort.residual > tolerance(effort.sweeps) {
            let sticks = |(a, contact): (usize, &mut Contact<L>)| {
                let traction = contact.traction(&impulse_of(impulses, a));
                let pressed = traction.x < 0.0 || contact.bears_tension();
                let hold = !(contact.held || contact.let_go || contact.slides) && pressed;
                contact.held |= hold;
                hold
            };
            let any = contacts
                .iter_mut()
                .enumerate()
                .map(sticks)
                .fold(false, |a, b| a | b);
            if !any && effort.sweeps >= MOST_SWEEPS {
                return Err(effort);
            }
        } else if !let_go_worst(contacts, impulses) {
            return Ok(effort);
        } else if chances == 0 {
            return Err(effort);
        } else {
            chances -= 1;
        }
    }
}

/// Impulse of one pair (N s).
fn impulse_of(impulses: &DVector<f64>, pair: usize) -> Vec3 {
    impulses.fixed_rows::<3>(3 * pair).into_owned()
}

/// Lets go the pair whose traction exceeds the admissible one by most; returns false if there is none.
fn let_go_worst<L: ContactLaw>(contacts: &mut [Contact<L>], impulses: &DVector<f64>) -> bool {
    let mut worst: Option<(usize, f64, JointState)> = None;
    for (a, contact) in contacts.iter().enumerate() {
        let trial = contact.traction(&impulse_of(impulses, a));
        let mut input = contact.input;
        input.trial = trial;
        let mut new_history = input.history.to_vec();
        let response = contact.law.admissible(&input, &mut new_history);
        let (admitted, state) = (response.traction, response.state);
        let stays = if contact.held {
            admitted == trial && state.contact == ContactState::Stick
        } else if contact.followed.is_some() {
            true
        } else {
            // A pair that slides and bears tension is held along its normal; it may still crack.
            !contact.bears_tension() || state.contact != ContactState::Open
        };
        let over = (trial - admitted).norm() * contact.per_traction;
        if !stays && worst.is_none_or(|(_, most, _)| over > most) {
            worst = Some((a, over, state));
        }
    }
    let Some((a, _, state)) = worst else {
        return false;
    };
    let contact = &mut contacts[a];
    (contact.held, contact.let_go, contact.input.state) = (false, true, state);
    true
}

/// Measure of the change of motion by a sweep.
///
/// In units in which each direction of each pair has the effective mass one: motion
/// `(S p)_i / sqrt(S_ii)` over impulses `p_i sqrt(S_ii)`. Impulses themselves need not converge:
/// where the gaps of pairs of one corner, or around a closed ring, differ by rounding, sweeps pass a
/// force from one to the other, which moves nothing.
struct Change {
    scale: DVector<f64>,
    motion: DVector<f64>,
}

impl Change {
    fn new(schur: &DMatrix<f64>, impulses: &DVector<f64>) -> Self {
        let root = |own: f64| if own > 0.0 { 1.0 / own.sqrt() } else { 0.0 };
        Self {
            scale: schur.diagonal().map(root),
            motion: schur * impulses,
        }
    }

    /// Relative change since the last call.
    fn since(&mut self, schur: &DMatrix<f64>, impulses: &DVector<f64>) -> f64 {
        let motion = schur * impulses;
        let change = (&motion - &self.motion).component_mul(&self.scale).amax();
        let sizes = schur.diagonal().component_mul(impulses);
        let size = sizes.component_mul(&self.scale).amax();
        self.motion = motion;
        if change > 0.0 { change / size } else { 0.0 }
    }
}

/// Sweeps over the free pairs until the motion no longer changes, [`PATIENCE`] times at most; returns the
/// relative change in the last sweep.
fn sweep<L: ContactLaw>(
    matrices: &Matrices,
    contacts: &mut [Contact<L>],
    excess: &DVector<f64>,
    impulses: &mut DVector<f64>,
    sweeps: &mut u32,
) -> f64 {
    let schur = &matrices.schur;
    let left = |row: usize, impulses: &DVector<f64>| {
        let taken: f64 = (0..impulses.len())
            .map(|k| schur[(row, k)] * impulses[k])
            .sum();
        excess[row] - taken
    };
    // Impulses that move nothing are only made admissible.
    let by = |left: f64, own: f64| if own > 0.0 { left / own } else { 0.0 };
    let mut change = Change::new(schur, impulses);
    let mut residual = 0.0;
    for _ in 0..PATIENCE {
        let (share, mut followed) = (share(*sweeps), false);
        let free = contacts.iter_mut().filter(|contact| !contact.held);
        for (b, contact) in free.enumerate() {
            let row = 3 * b;
            let now = impulses.fixed_rows::<3>(row).into_owned();
            let rest = Vec3::from([0, 1, 2].map(|c| left(row + c, impulses)));
            let most = [0, 1, 2].map(|c| schur[(row + c, row + c)]);
            let most = most.into_iter().fold(matrices.tangential[b], f64::max);
            if let Some(impulse) = contact.following(&now, &rest, most) {
                followed = true;
                let taken = if share < 1.0 {
                    now + (impulse - now) * share
                } else {
                    impulse
                };
                impulses.fixed_rows_mut::<3>(row).copy_from(&taken);
                continue;
            }
            let own = schur[(row, row)] + contact.friction() * matrices.mixed[b];
            impulses[row] = contact.normal(impulses[row] + by(left(row, impulses), own));
            let own = matrices.tangential[b];
            let trial = [row + 1, row + 2].map(|i| impulses[i] + by(left(i, impulses), own));
            let (cut, slides) = contact.tangential(impulses[row], trial, own);
            (impulses[row + 1], impulses[row + 2]) = (cut[0], cut[1]);
            contact.slides = slides;
        }
        *sweeps += 1;
        residual = change.since(schur, impulses);
        if followed {
            residual /= share;
        }
        if residual <= TOLERANCE {
            break;
        }
    }
    residual
}
