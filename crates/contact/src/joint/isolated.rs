//! Solution of isolated pairs in one pass: pairs that share no node with another, with effective masses
//! that are the same in all directions in which they move. This is hot code.

use powerhouse_model::{
    ConstraintWork, ContactLaw, ContactState, JointInputs, JointPair, JointRecord, JointResponses,
    JointState, Mat3, Vec3,
};

use super::Side;
use super::bookkeeping::{Outcome, bond_energy, update};
use super::strips::{Step, Window, Windows};

/// Number of pairs that the loops process side by side.
pub(super) const TILE: usize = 16;

/// One number of each pair of a tile.
type Row = [f64; TILE];

/// One vector of each pair of a tile, component by component.
type Rows = [Row; 3];

/// Relative rounding error of a 3 x 3 inversion.
const ROUNDING: f64 = 1e-14;

/// Inverse effective masses (1/kg) of a pair whose nodes have the same in all directions, or in all
/// but a tangent along which supports hold both of them, as at the ends of a slice: neither a motion
/// nor a force ever has a part along that one. None of other pairs. `undetermined` is the traction (Pa, local) along
/// directions in which motion does not determine it.
pub(super) fn isotropic_masses(
    pair: &JointPair,
    undetermined: &Vec3,
    inverse_mass: [&Mat3; 2],
) -> Option<[f64; 2]> {
    let [first, second] = inverse_mass;
    // The values of both if they are multiples of a matrix.
    let of_shape = |shape: Mat3, value: fn(&Mat3) -> f64| {
        let multiple = |matrix: &Mat3| {
            let value = value(matrix);
            let rest = (matrix - shape * value).amax();
            (rest <= ROUNDING * value.abs()).then_some(value)
        };
        Some([multiple(first)?, multiple(second)?])
    };
    let held_along = |(axis, traction): (Vec3, f64)| {
        let across = Mat3::identity() - axis * axis.transpose();
        (traction == 0.0).then(|| of_shape(across, |matrix| 0.5 * matrix.trace()))?
    };
    let tangents = [
        (pair.tangent, undetermined.y),
        (pair.normal.cross(&pair.tangent), undetermined.z),
    ];
    of_shape(Mat3::identity(), |matrix| matrix[(0, 0)])
        .or_else(|| tangents.into_iter().find_map(held_along))
}

/// Isolated pair with its nodes, initial conditions and masses.
#[derive(Clone, Copy, Debug)]
pub(super) struct IsolatedPair {
    /// Index among the pairs of the joint.
    pub(super) index: u32,
    /// Indices among the nodes of the joint: first side, second side.
    pub(super) nodes: [u32; 2],
    pub(super) pair: JointPair,
    pub(super) side: Side,
    /// Inverse effective masses (1/kg), not both zero.
    pub(super) inverse_mass: [f64; 2],
}

/// Up to [`TILE`] isolated pairs of one law, side by side, with all constants of a step.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Tile {
    count: usize,
    /// Indices among the pairs of the joint.
    index: [u32; TILE],
    /// Indices among the nodes of the joint: the heavier node of each pair, the lighter one.
    heavy: [u32; TILE],
    light: [u32; TILE],
    /// Side of the heavier nodes: 1 for the first side, -1 for the second.
    sign: Row,
    /// Share of a change of relative velocity that the heavier nodes take, with that sign.
    share: Row,
    /// Normals and both tangents.
    frame: [Rows; 3],
    /// Areas over which forces are tractions (m2).
    area: Row,
    /// Distance of the sides without displacement (m).
    gap: Row,
    /// Relative displacement from which opening and slip count (m).
    origin: Rows,
    /// Traction in the static state from which displacements count (Pa), local.
    preload: Rows,
    /// Traction per relative velocity that it stops, `1 / (dt W A)` (Pa s/m).
    stiffness: Row,
    /// Its inverse (m/(Pa s)).
    compliance: Row,
    /// Positions and distances to neighbours along the joint (m), for the law.
    position: Rows,
    spacing: Row,
}

impl Tile {
    /// Tile of at most [`TILE`] pairs, for a step (s).
    pub(super) fn new(pairs: &[IsolatedPair], step: f64) -> Self {
        const ZEROS: Row = [0.0; TILE];
        let mut tile = Self {
            count: pairs.len(),
            index: [0; TILE],
            heavy: [0; TILE],
            light: [0; TILE],
            sign: ZEROS,
            share: ZEROS,
            frame: [[ZEROS; 3]; 3],
            area: ZEROS,
            gap: ZEROS,
            origin: [ZEROS; 3],
            preload: [ZEROS; 3],
            stiffness: ZEROS,
            compliance: ZEROS,
            position: [ZEROS; 3],
            spacing: ZEROS,
        };
        for (k, own) in pairs.iter().enumerate() {
            let [first, second] = own.inverse_mass;
            let [first_node, second_node] = own.nodes;
            let (heavy, light, sign, least) = if first <= second {
                (first_node, second_node, 1.0, first)
            } else {
                (second_node, first_node, -1.0, second)
            };
            tile.index[k] = own.index;
            (tile.heavy[k], tile.light[k], tile.sign[k]) = (heavy, light, sign);
            tile.share[k] = sign * (least / (first + second));
            let JointPair {
                normal, tangent, ..
            } = own.pair;
            for (rows, axis) in tile
                .frame
                .iter_mut()
                .zip([normal, tangent, normal.cross(&tangent)])
            {
                put(rows, k, &axis);
            }
            tile.area[k] = own.pair.projected_area;
            tile.gap[k] = own.side.gap;
            put(&mut tile.origin, k, &own.side.origin);
            put(&mut tile.preload, k, &own.side.preload);
            put(&mut tile.position, k, &own.pair.position);
            tile.spacing[k] = own.pair.spacing;
            tile.compliance[k] = step * (first + second) * own.pair.projected_area;
            tile.stiffness[k] = 1.0 / tile.compliance[k];
        }
        tile
    }
}

#[inline(always)]
fn put(rows: &mut Rows, k: usize, vector: &Vec3) {
    for c in 0..3 {
        rows[c][k] = vector[c];
    }
}

#[inline(always)]
fn get(rows: &Rows, k: usize) -> Vec3 {
    Vec3::new(rows[0][k], rows[1][k], rows[2][k])
}

/// Working arrays of a tile in one step: components along normals and tangents, unless stated
/// otherwise.
#[repr(align(64))]
pub(super) struct TileStep {
    /// Relative displacement and velocities before the step and as predicted, in space.
    displacement: Rows,
    previous: Rows,
    predicted: Rows,
    /// Tangential displacement at which a pair sticks (m), and 1 if it does.
    anchor: [Row; 2],
    stuck: Row,
    /// Opening at which a pair counts as closed (m), old and then new; used with history only.
    dilation: Row,
    /// Relative displacement, gap included, from the origin of the pair (m).
    offset: Rows,
    /// Relative velocity before the step (m/s).
    before: Rows,
    /// Velocity that has to be taken off to end the step closed and at the point of sticking (m/s), and
    /// the whole velocity to be taken off to stop there.
    hold: Rows,
    excess: Rows,
    /// Trial traction: that of a pair that sticks (Pa).
    trial: Rows,
    /// Traction admitted by the law, and new state.
    traction: [Vec3; TILE],
    state: [JointState; TILE],
    /// Change of relative velocity, and relative velocity after it (m/s), in space.
    change: Rows,
    after: Rows,
    /// Work of the traction along the normal and along the tangents, and of the preload (J).
    across: Row,
    along: Row,
    external: Row,
    /// Length of the tangential path in the step (m).
    path: Row,
}

impl Default for TileStep {
    fn default() -> Self {
        const ZEROS: Row = [0.0; TILE];
        const VECTORS: Rows = [ZEROS; 3];
        Self {
            displacement: VECTORS,
            previous: VECTORS,
            predicted: VECTORS,
            anchor: [ZEROS; 2],
            stuck: ZEROS,
            dilation: ZEROS,
            offset: VECTORS,
            before: VECTORS,
            hold: VECTORS,
            excess: VECTORS,
            trial: VECTORS,
            traction: [Vec3::zeros(); TILE],
            state: [JointState::default(); TILE],
            change: VECTORS,
            after: VECTORS,
            across: ZEROS,
            along: ZEROS,
            external: ZEROS,
            path: ZEROS,
        }
    }
}

impl Tile {
    /// Indices of its pairs among those of the joint.
    #[inline(always)]
    pub(super) fn pairs(&self) -> &[u32] {
        &self.index[..self.count]
    }

    /// Computes the trial tractions.
    #[inline(always)]
    pub(super) fn predict<const HISTORY: bool>(
        &self,
        step: &mut TileStep,
        windows: &Windows,
        motion: &Step,
    ) {
        for k in 0..self.count {
            let (heavy, light) = (self.heavy[k] as usize, self.light[k] as usize);
            let relative = |values: &[Vec3]| values[light] - values[heavy];
            let predicted = windows.velocity.get(light) - windows.velocity.get(heavy);
            put(&mut step.displacement, k, &relative(motion.displacement));
            put(&mut step.previous, k, &relative(motion.previous));
            put(&mut step.predicted, k, &predicted);
            let record = windows.records.get(self.index[k] as usize);
            step.state[k] = record.state;
            let [first, second] = record.anchor.unwrap_or_default();
            (step.anchor[0][k], step.anchor[1][k]) = (first, second);
            let stuck = record.anchor.is_some() && record.state.contact == ContactState::Stick;
            step.stuck[k] = f64::from(u8::from(stuck));
            if HISTORY {
                step.dilation[k] = record.dilation;
            }
        }
        let rate = 1.0 / motion.step;
        for k in 0..TILE {
            for rows in [
                &mut step.displacement,
                &mut step.previous,
                &mut step.predicted,
            ] {
                for c in 0..3 {
                    rows[c][k] *= self.sign[k];
                }
            }
        }
        for k in 0..TILE {
            for c in 0..3 {
                let axis = &self.frame[c];
                let along =
                    |v: &Rows| v[0][k] * axis[0][k] + v[1][k] * axis[1][k] + v[2][k] * axis[2][k];
                let mut offset = along(&step.displacement);
                // Closes the gap, and takes a pair that sticks back by what rounding has moved it.
                let held = if c == 0 {
                    offset += self.gap[k];
                    offset -= self.origin[c][k];
                    if HISTORY {
                        offset - step.dilation[k]
                    } else {
                        offset
                    }
                } else {
                    offset -= self.origin[c][k];
                    (offset - step.anchor[c - 1][k]) * step.stuck[k]
                };
                step.offset[c][k] = offset;
                step.before[c][k] = along(&step.previous);
                let hold = held * rate;
                step.hold[c][k] = hold;
                let excess = along(&step.predicted) + hold;
                step.excess[c][k] = excess;
                step.trial[c][k] = self.preload[c][k] + excess * self.stiffness[k];
            }
        }
        for k in 0..self.count {
            step.traction[k] = get(&step.trial, k);
        }
    }

    /// Evaluates the law; rows are the committed and the new history of so many variables per pair.
    #[inline(always)]
    pub(super) fn admit<L: ContactLaw>(
        &self,
        law: &L,
        step: &mut TileStep,
        motion: &Step,
        (variables, [old, new]): (usize, &mut [Vec<f64>; 2]),
    ) {
        let count = self.count;
        let mut inputs = JointInputs::default();
        (inputs.step, inputs.time) = (motion.step, motion.time);
        inputs.slip_rate = [&step.before[1][..count], &step.before[2][..count]];
        inputs.opening = &step.offset[0][..count];
        inputs.compliance = &self.compliance[..count];
        inputs.area = &self.area[..count];
        inputs.position = [0, 1, 2].map(|c| &self.position[c][..count]);
        let (tractions, states) = (&mut step.traction[..count], &mut step.state[..count]);
        let mut responses = JointResponses::new(tractions, states);
        if variables > 0 {
            (inputs.variables, inputs.history) = (variables, &old[..count * variables]);
            inputs.opening_rate = &step.before[0][..count];
            inputs.shear_displacement = [1, 2].map(|c| &step.offset[c][..count]);
            inputs.spacing = &self.spacing[..count];
            let new = &mut new[..count * variables];
            responses = responses.with_history(new, &mut step.dilation[..count]);
        }
        law.admit(&inputs, &mut responses);
    }

    /// Changes the velocities by the admitted tractions.
    #[inline(always)]
    pub(super) fn correct(
        &self,
        step: &mut TileStep,
        motion: &Step,
        velocities: &mut Window<Vec3>,
    ) {
        let mut traction: Rows = [[0.0; TILE]; 3];
        let mut sticks: Row = [0.0; TILE];
        for k in 0..self.count {
            put(&mut traction, k, &step.traction[k]);
            let admitted = step.traction[k] == get(&step.trial, k);
            let stick = admitted && step.state[k].contact == ContactState::Stick;
            sticks[k] = f64::from(u8::from(stick));
        }
        let half = 0.5 * motion.step;
        for k in 0..TILE {
            let sticks = sticks[k] > 0.0;
            let mut local = [0.0; 3];
            let mut path = [0.0; 3];
            let mut left = [0.0; 3];
            for c in 0..3 {
                let admitted = (traction[c][k] - self.preload[c][k]) * self.compliance[k];
                let hold = step.hold[c][k];
                local[c] = if sticks { hold } else { admitted };
                left[c] = if sticks {
                    -hold
                } else {
                    step.excess[c][k] - hold - admitted
                };
                path[c] = (step.before[c][k] + left[c]) * (half * self.area[k]);
            }
            for c in 0..3 {
                let [normal, tangent, second] = &self.frame;
                let change =
                    normal[c][k] * local[0] + tangent[c][k] * local[1] + second[c][k] * local[2];
                let predicted = step.predicted[c][k];
                // Without anything to hold both velocities get the same bits.
                step.change[c][k] = if sticks { predicted + change } else { change };
                step.after[c][k] = if sticks { -change } else { predicted - change };
            }
            step.across[k] = traction[0][k] * path[0];
            step.along[k] = traction[1][k] * path[1] + traction[2][k] * path[2];
            let preload = |c: usize| self.preload[c][k] * path[c];
            step.external[k] = preload(0) + preload(1) + preload(2);
            step.path[k] = (left[1] * left[1] + left[2] * left[2]).sqrt() * motion.step;
        }
        for k in 0..TILE {
            for c in 0..3 {
                step.change[c][k] *= self.share[k];
                step.after[c][k] *= self.sign[k];
            }
        }
        for k in 0..self.count {
            let heavy = velocities.at(self.heavy[k] as usize);
            *heavy += get(&step.change, k);
            let velocity = *heavy;
            *velocities.at(self.light[k] as usize) = velocity + get(&step.after, k);
        }
    }

    /// Updates the records by the step and sets its work.
    #[inline(always)]
    pub(super) fn update<L: ContactLaw, const HISTORY: bool>(
        &self,
        (law, step): (&L, &TileStep),
        records: &mut Window<JointRecord>,
        motion: &Step,
        (variables, [old, new]): (usize, &[Vec<f64>; 2]),
        works: &mut Window<ConstraintWork>,
    ) {
        for k in 0..self.count {
            let mut work = ConstraintWork::default();
            let bond = if HISTORY {
                let own = k * variables..(k + 1) * variables;
                bond_energy(law, &old[own.clone()], &new[own], self.area[k])
            } else {
                None
            };
            let outcome = Outcome {
                time: motion.time,
                offset: get(&step.offset, k),
                traction: step.traction[k],
                state: step.state[k],
                dilation: if HISTORY { step.dilation[k] } else { 0.0 },
                bond,
                across: step.across[k],
                along: step.along[k],
                path: step.path[k],
            };
            let index = self.index[k] as usize;
            update::<HISTORY>(records.at(index), &outcome, &mut work);
            work.external -= step.external[k];
            *works.at(index) = work;
        }
    }
}

/// Part of an offset (m) that the trial traction takes off: the gap, and for a pair that sticks what
/// rounding has moved it along its tangents.
#[inline(always)]
pub(super) fn held_back(offset: &Vec3, record: &JointRecord) -> Vec3 {
    match record.anchor {
        Some([first, second]) if record.state.contact == ContactState::Stick => {
            Vec3::new(offset.x, offset.y - first, offset.z - second)
        }
        _ => Vec3::new(offset.x, 0.0, 0.0),
    }
}
