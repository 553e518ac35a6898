//! Energy balance of a slice.
//!
//! At the present time, between the velocities `v-` and `v+` of x and z half a step before and after it, a linear slice
//! conserves, with the stiffness `K` of `U` and the inertia `M - s^2 A`,
//!
//! `1/2 v-.(M - s^2 A) v+  +  1/2 v_y.(M - s^2 A) v_y  +  1/2 u.K u  -  dt^2/8 v_y.K v_y`,
//!
//! the invariant of central differences: y has its displacement at half steps. With the mean velocity `V` of x and z, and
//! the energy of the elements, whose strain has the part `-s V`, it is the sum of
//!
//! - the kinetic energy `1/2 V.M V`,
//! - the energy of elements,
//! - `s V.T - s^2/2 V.(A_consistent - A_lumped) V`: less the flux of energy along y times `s`, the column "delay",
//! - `-1/8 dv.(M - s^2 A) dv - dt^2/8 v_y.K v_y` with `dv = v+ - v-`, the column "time step".

use powerhouse_model::{BlockEnergy, Vec3};
use serde::{Deserialize, Serialize};

use crate::Model;
use crate::ledger::{Reading, total_energy};
use crate::node_group::NodeGroup;
use crate::nodes::Nodes;

/// Works of nodal forces (J): of loads, and dissipated or stored by dashpots, springs and mass damping.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Works {
    loads: f64,
    dashpots: f64,
    springs: f64,
    mass_damping: f64,
}

impl core::ops::AddAssign for Works {
    fn add_assign(&mut self, other: Self) {
        self.loads += other.loads;
        self.dashpots += other.dashpots;
        self.springs += other.springs;
        self.mass_damping += other.mass_damping;
    }
}

impl Works {
    /// Works of the load (N), dashpot and spring, elongated by some vector (m), of a group in the halves of a step between two
    /// velocities (m/s).
    pub(super) fn of(
        group: &NodeGroup,
        [load, stretch]: [Vec3; 2],
        velocities: [Vec3; 2],
        step: f64,
    ) -> [Self; 2] {
        let [before, after] = velocities;
        let mean = (before + after) * 0.5;
        let dashpot = group.dashpot * mean;
        let spring = group.spring * (stretch + (after - before) * (0.25 * step));
        velocities.map(|velocity| {
            let along = velocity * (0.5 * step);
            Self {
                loads: load.dot(&along),
                dashpots: dashpot.dot(&along),
                springs: spring.dot(&along),
                mass_damping: group.mass_damping * mean.dot(&along),
            }
        })
    }
}

/// Works of nodal forces of a slice since its balance began.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DelayedWork {
    /// Energy when the balance began (J); none before.
    origin: Option<f64>,
    /// Until the present time.
    all: Works,
    /// In the second half of the present step of x and z.
    second: Works,
    /// Largest stored energy or work of loads so far (J).
    scale: f64,
}

impl DelayedWork {
    /// Begins a step.
    pub(super) fn begin_step(&mut self) {
        self.second = Works::default();
    }

    /// Adds the works of a group along y, whose step is `whole` past the present time, or of x and z, whose first half is
    /// before it.
    pub(super) fn add(&mut self, [first, second]: &[Works; 2], whole: bool) {
        if whole {
            self.all += *first;
            self.all += *second;
            return;
        }
        if self.origin.is_some() {
            self.all += *first;
        }
        self.second += *second;
    }

    /// Adds the second half of the works of x and z.
    pub(super) fn end_plane(&mut self) {
        let second = core::mem::take(&mut self.second);
        self.all += second;
    }
}

/// Energy of a slice at the present time (J), without works.
struct Stored {
    kinetic: f64,
    time_step: f64,
    delay: f64,
    blocks: Vec<BlockEnergy>,
}

impl Stored {
    fn total(&self) -> f64 {
        let of_blocks: f64 = self.blocks.iter().map(BlockEnergy::total).sum();
        self.kinetic + self.time_step + self.delay + of_blocks
    }
}

impl Model {
    /// The energy of a slice between the new velocities of x and z and the new displacements.
    fn stored_in_slice(&self, step: f64) -> Option<Stored> {
        let blocks = self.block_energies(step, true);
        let (Some(slice), Nodes::F64(arrays)) = (&self.delayed, &self.nodes) else {
            return None;
        };
        let motion = slice.motion.as_ref()?;
        let s = slice.slowness;
        let slots = &self.subdomain.slots;
        // The forces are those with the velocities of x and z half a step before.
        let at_forces = |group: usize| {
            let (before, after) = (motion.before(group), motion.velocity(group));
            Vec3::new(before.x, after.y, before.z)
        };
        let mean = |group: usize| motion.centred(group)[1];
        let along = &motion.axial.velocity;
        let (mut kinetic, mut delay, mut time_step) = (0.0, 0.0, 0.0);
        for (index, group) in self.groups.groups.iter().enumerate() {
            let [low, high] = slice.sides[index].map(|node| arrays.internal(slots, node as usize));
            let velocity = mean(index);
            let rigidity = slice.lumping.rigidity(index);
            let known = (high - low) * slice.half;
            let traction = match slice.is_linear {
                // The displacement along y is that half a step later, and nothing in the forces follows velocities.
                true => {
                    let late = slice.coupling.traction(index, along) * (0.5 * step);
                    known - late - rigidity.component_mul(&velocity) * s
                }
                false => {
                    let late = rigidity.component_mul(&(velocity - at_forces(index)));
                    known + (slice.lumping.spread(index, at_forces) - late) * s
                }
            };
            kinetic += 0.5 * group.mass * velocity.norm_squared();
            let spread = slice.lumping.spread(index, mean);
            delay += s * velocity.dot(&traction) - 0.5 * s * s * velocity.dot(&spread);
            let mut change = motion.velocity(index) - motion.before(index);
            change.y = 0.0;
            let inertia = slice.inertia(index);
            time_step -= 0.125 * inertia.component_mul(&change).dot(&change);
            let force = slice.coupling.stiffness(index, along);
            time_step -= 0.125 * step * step * force * velocity.y;
        }
        Some(Stored {
            kinetic,
            time_step,
            delay,
            blocks,
        })
    }

    /// Whether the body is a slice or a bay under waves along y.
    pub(crate) fn is_delayed(&self) -> bool {
        self.delayed.is_some() || self.bay.is_some()
    }

    /// Whether no element has history variables.
    pub(crate) fn is_linear(&self) -> bool {
        self.blocks.iter().all(|block| block.history().is_empty())
    }

    /// Begins the energy balance of a slice at the present time, unless it has begun.
    pub(super) fn begin_slice_balance(&mut self, step: f64) {
        let begins = |slice: &super::DelayedSlice| slice.work.origin.is_none();
        if self.ledger.is_none() || !self.delayed.as_ref().is_some_and(begins) {
            return;
        }
        let stored = self.stored_in_slice(step).map(|stored| stored.total());
        if let Some(slice) = &mut self.delayed {
            slice.work.origin = stored;
        }
    }

    /// Reads the energy balance of a slice; none if no ledger is open.
    pub(crate) fn read_slice_ledger(&mut self, step: f64) -> Option<Reading> {
        self.ledger.as_ref()?;
        let stored = self.stored_in_slice(step)?;
        let hourglass = self.hourglass_shares();
        let team = &self.ranks.team;
        let sum = total_energy(stored.blocks.iter(), team);
        let work = &mut self.delayed.as_mut()?.work;
        let works = work.all;
        let initial = work.origin.unwrap_or(0.0);
        let spent = [
            ("kinetic", stored.kinetic),
            ("delay", stored.delay),
            ("time step", stored.time_step),
            ("elastic", sum.elastic),
            ("bending", sum.bending),
            ("hourglass", sum.hourglass),
            ("plastic", sum.plastic),
            ("damage", sum.damage),
            ("recovery", sum.recovery),
            ("integration", sum.integration),
            ("relaxation", sum.relaxation),
            ("stiffness damping", sum.damping),
            ("mass damping", works.mass_damping),
            ("dashpots", works.dashpots),
            ("springs", works.springs),
        ];
        let balance: f64 = spent.iter().map(|(_, energy)| energy).sum();
        let residual = balance - works.loads - initial;
        work.scale = (work.scale)
            .max(stored.kinetic.abs() + sum.total().abs())
            .max(works.loads.abs());
        let relative = if work.scale > 0.0 {
            residual / work.scale
        } else {
            residual
        };
        let mut columns = spent.to_vec();
        columns.extend([
            ("initial", initial),
            ("loads", works.loads),
            ("residual", residual),
        ]);
        Some(Reading {
            columns,
            residual: relative,
            worst_set: hourglass
                .first()
                .map_or_else(String::new, |share| share.set.clone()),
            hourglass,
            fibres: [0.0; 2],
        })
    }
}
