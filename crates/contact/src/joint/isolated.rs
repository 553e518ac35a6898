//! Pairs that share no node with another, with effective masses that are the same in all directions
//! in which they move: one pass. This is hot code.

use powerhouse_model::{
    ConstraintWork, ContactLaw, ContactState, JointPair, JointRecord, JointState, Mat3,
    PredictedMotion, Vec3,
};

use super::Side;
use super::account::{Outcome, enter};

/// Pairs that go side by side through the loops.
const TILE: usize = 16;

/// One number of each pair of a tile.
type Row = [f64; TILE];

/// A vector of each pair of a tile, component by component.
type Rows = [Row; 3];

/// What is left by the rounding of a 3 x 3 inversion.
const ROUNDING: f64 = 1e-14;

/// The inverse effective masses (1/kg) of a pair whose nodes resist alike in all directions, or in all
/// but a tangent along which supports hold both of them, as at the ends of a slice: neither a motion
/// nor a force ever has a part along that one.
pub(super) fn alike(pair: &JointPair, side: &Side, inverse_mass: [&Mat3; 2]) -> Option<[f64; 2]> {
    let [first, second] = inverse_mass;
    // The values of both if they are of a shape, which they are multiples of.
    let of_shape = |shape: Mat3, value: fn(&Mat3) -> f64| {
        let multiple = |matrix: &Mat3| {
            let value = value(matrix);
            let rest = (matrix - shape * value).amax();
            (rest <= ROUNDING * value.abs()).then_some(value)
        };
        Some([multiple(first)?, multiple(second)?])
    };
    let held_along = |(axis, preload): (Vec3, f64)| {
        let across = Mat3::identity() - axis * axis.transpose();
        (preload == 0.0).then(|| of_shape(across, |matrix| 0.5 * matrix.trace()))?
    };
    let tangents = [
        (pair.tangent, side.preload.y),
        (pair.normal.cross(&pair.tangent), side.preload.z),
    ];
    of_shape(Mat3::identity(), |matrix| matrix[(0, 0)])
        .or_else(|| tangents.into_iter().find_map(held_along))
}

/// A pair with what depends on masses and step.
#[derive(Clone, Copy, Debug)]
pub(super) struct IsolatedPair {
    /// Place among the joint's pairs.
    pub(super) index: u32,
    /// Places among the joint's nodes: first side, second side.
    pub(super) nodes: [u32; 2],
    pub(super) pair: JointPair,
    pub(super) side: Side,
    /// Inverse effective masses (1/kg), not both zero.
    pub(super) inverse_mass: [f64; 2],
}

/// Some pairs of one law, side by side, with all that a step needs of them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Tile {
    count: usize,
    /// Places among the joint's pairs.
    index: [u32; TILE],
    /// Places among the joint's nodes: those that are harder to move, the others.
    heavy: [u32; TILE],
    light: [u32; TILE],
    /// Which side the heavy nodes are: 1 for the first side, -1 for the second.
    sign: Row,
    /// Share of a change of relative velocity that the heavy nodes take, with that sign.
    share: Row,
    /// Normals and both tangents.
    frame: [Rows; 3],
    /// Areas over which forces are tractions (m2).
    area: Row,
    /// Distance of the sides without displacement (m).
    gap: Row,
    /// Relative displacement that counts as none (m).
    origin: Rows,
    /// Traction in the static state that displacements are counted from (Pa), local.
    preload: Rows,
    /// Traction per relative velocity that it stops, `1 / (dt W A)` (Pa s/m).
    stiffness: Row,
    /// Its inverse (m/(Pa s)).
    compliance: Row,
}

impl Tile {
    /// Tiles of pairs, for a step (s).
    pub(super) fn all(pairs: &[IsolatedPair], step: f64) -> impl Iterator<Item = Self> {
        pairs.chunks(TILE).map(move |pairs| Self::new(pairs, step))
    }

    fn new(pairs: &[IsolatedPair], step: f64) -> Self {
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

/// Corrects the motion of isolated pairs; returns what their forces did.
///
/// The stick trial is the traction that ends a step without overlap and without slip,
/// `T = T0 + (w + g / dt) / (dt W A)` with `W = 1/a_i + 1/a_j` (Wang, Chen & Xiao 2019, Eq. 20, for
/// velocities half a step apart and effective masses `a`). The law cuts it down.
pub(super) fn correct<L: ContactLaw>(
    law: &L,
    tiles: &[Tile],
    records: &mut [JointRecord],
    motion: &mut PredictedMotion,
) -> ConstraintWork {
    // Wider instructions where the processor has them; they change no bit.
    pulp::Arch::new().dispatch(Pass {
        law,
        tiles,
        records,
        motion,
    })
}

/// The pass over the tiles of a law. A type of its own, since a closure handed to the dispatch may
/// end up in a function that knows nothing of the processor.
struct Pass<'a, 'm, L> {
    law: &'a L,
    tiles: &'a [Tile],
    records: &'a mut [JointRecord],
    motion: &'a mut PredictedMotion<'m>,
}

impl<L: ContactLaw> pulp::NullaryFnOnce for Pass<'_, '_, L> {
    type Output = ConstraintWork;
    #[inline(always)]
    fn call(self) -> ConstraintWork {
        let mut work = ConstraintWork::default();
        let mut step = TileStep::default();
        for tile in self.tiles {
            tile.predict(&mut step, self.records, self.motion);
            let count = tile.count;
            self.law
                .admit(&mut step.traction[..count], &mut step.state[..count]);
            tile.correct(&mut step, self.motion);
            tile.book(&step, self.records, self.motion, &mut work);
        }
        work
    }
}

/// What a step is about to do to a tile: everything along normals and tangents, unless it says
/// otherwise.
#[repr(align(64))]
struct TileStep {
    /// Relative displacement and velocities before the step and as predicted, in space.
    displacement: Rows,
    previous: Rows,
    predicted: Rows,
    /// Where a pair sticks along its tangents (m), and 1 if it does.
    anchor: [Row; 2],
    stuck: Row,
    /// Relative displacement, gap included, from the pair's origin (m).
    offset: Rows,
    /// Relative velocity before the step (m/s).
    before: Rows,
    /// The velocity that would have to go for the pair to end the step closed and where it sticks
    /// (m/s), and all that would have to go for it to stop there.
    hold: Rows,
    excess: Rows,
    /// The traction of a pair that sticks (Pa).
    trial: Rows,
    /// What the law made of it, and of the state.
    traction: [Vec3; TILE],
    state: [JointState; TILE],
    /// Change of relative velocity, and what it leaves (m/s), in space.
    change: Rows,
    after: Rows,
    /// Work of the traction across the pair and along it, and of the preload (J).
    across: Row,
    along: Row,
    external: Row,
    /// Length of the path along the tangents in the step (m).
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
    /// Finds the trial tractions.
    #[inline(always)]
    fn predict(&self, step: &mut TileStep, records: &[JointRecord], motion: &PredictedMotion) {
        for k in 0..self.count {
            let (heavy, light) = (self.heavy[k] as usize, self.light[k] as usize);
            let relative = |values: &[Vec3]| values[light] - values[heavy];
            put(&mut step.displacement, k, &relative(motion.displacement));
            put(&mut step.previous, k, &relative(motion.previous));
            put(&mut step.predicted, k, &relative(motion.velocity));
            let record = &records[self.index[k] as usize];
            step.state[k] = record.state;
            let [first, second] = record.anchor.unwrap_or_default();
            (step.anchor[0][k], step.anchor[1][k]) = (first, second);
            let stuck = record.anchor.is_some() && record.state.contact == ContactState::Stick;
            step.stuck[k] = f64::from(u8::from(stuck));
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
                // The gap is to go, and for a pair that sticks what rounding has moved it.
                let held = if c == 0 {
                    offset += self.gap[k];
                    offset -= self.origin[c][k];
                    offset
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

    /// Changes the velocities by what the law admits.
    #[inline(always)]
    fn correct(&self, step: &mut TileStep, motion: &mut PredictedMotion) {
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
                // Where there is nothing to hold back both velocities get the same bits.
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
            let heavy = &mut motion.velocity[self.heavy[k] as usize];
            *heavy += get(&step.change, k);
            let velocity = *heavy;
            motion.velocity[self.light[k] as usize] = velocity + get(&step.after, k);
        }
    }

    /// Writes the step into the records and adds up its work.
    #[inline(always)]
    fn book(
        &self,
        step: &TileStep,
        records: &mut [JointRecord],
        motion: &PredictedMotion,
        work: &mut ConstraintWork,
    ) {
        for k in 0..self.count {
            let outcome = Outcome {
                time: motion.time,
                offset: get(&step.offset, k),
                traction: step.traction[k],
                state: step.state[k],
                across: step.across[k],
                along: step.along[k],
                path: step.path[k],
            };
            enter(&mut records[self.index[k] as usize], &outcome, work);
            work.external -= step.external[k];
        }
    }
}

/// What of an offset (m) is to go: the gap, and for a pair that sticks what rounding has moved it
/// along its tangents.
#[inline(always)]
pub(super) fn held_back(offset: &Vec3, record: &JointRecord) -> Vec3 {
    match record.anchor {
        Some([first, second]) if record.state.contact == ContactState::Stick => {
            Vec3::new(offset.x, offset.y - first, offset.z - second)
        }
        _ => Vec3::new(offset.x, 0.0, 0.0),
    }
}
