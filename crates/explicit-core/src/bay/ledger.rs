//! Energy of a bay.
//!
//! What the elements store is that of the strain of `U` with `-s V` along y. With `s V.t_y` it adds up to the energy that the scheme keeps:
//! kinetic and strain energy less `s` times the flux of energy along y. In the scheme of linear bodies
//! the same sum is `1/2 V.(M - s^2 A) V + 1/2 U.K U`.

use powerhouse_model::{Operator, Quad, Vec3};

use crate::Model;
use crate::nodes::Nodes;

/// Energies (J) of a bay at the present time that neither elements nor masses have.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BayEnergy {
    /// `s V.t_y`, as far as the inertia of the groups does not have it.
    pub(crate) flux: f64,
    /// What the inertia of the groups has less than their mass.
    pub(crate) less: f64,
    /// Work against the skew forces in the first half of the present step, which the second half gives back.
    pub(crate) lent: f64,
}

impl Model {
    /// Displacements (m) of the nodes of all blocks for their energies, in a bay whose elements are not all linear; empty for other bodies, whose
    /// energies are those of the displacements of the nodes.
    pub(crate) fn displacements_of_bay(&self) -> Vec<Option<Vec<Quad<f64>>>> {
        let is_wanted = self.bay.as_ref().is_some_and(|bay| !bay.is_linear);
        let blocks = if is_wanted {
            0..self.blocks.len()
        } else {
            0..0
        };
        blocks
            .map(|block| self.delayed_displacement(block))
            .collect()
    }

    /// Energies of a bay between kick and drift; none of any other body.
    pub(crate) fn bay_energy(&mut self, step: f64) -> Option<BayEnergy> {
        let bay = self.bay.as_ref()?;
        let velocity: Vec<Vec3> = (0..bay.leads.len())
            .map(|g| self.bay_velocity(bay, g))
            .collect();
        let less = (bay.taken.iter().zip(&velocity))
            .map(|(taken, v)| 0.5 * taken * v.norm_squared())
            .sum();
        let previous = &self.groups.motion.previous;
        let turned = previous.iter().zip(&bay.motion.turned[0]);
        let lent = turned.map(|(v, turned)| 0.25 * step * v.dot(turned)).sum();
        if bay.is_linear {
            // The elements are read without the delay, of which the inertia has the energy.
            return Some(BayEnergy {
                flux: 0.0,
                less,
                lent,
            });
        }
        let Nodes::F64(arrays) = &self.nodes else {
            return None;
        };
        let slots = &self.subdomain.slots;
        let internal = |node: usize| arrays.internal(slots, node);
        let groups = self.groups.groups.iter().zip(&velocity);
        let power = groups.map(|(group, v)| bay.moment(group, internal).dot(v));
        let power: f64 = power.sum();
        let nodes = 0..self.mass.len();
        let delays: Vec<Vec3> = nodes
            .clone()
            .map(|node| bay.delay(node, |g| velocity[g]))
            .collect();
        // The forces are those at another velocity, and change with it nearly as linear ones do.
        let predicted = &bay.motion.predicted;
        let late = |g: usize| {
            predicted
                .get(g)
                .map_or_else(Vec3::zeros, |v| velocity[g] - v)
        };
        let late: Vec<Vec3> = nodes.map(|node| bay.delay(node, late)).collect();
        let slowness = bay.slowness;
        let forces = arrays.forces.clone();
        let elastic = self.elastic_product(Operator::Elastic, &delays, &|_| 1.0);
        let of_late = self.elastic_product(Operator::Elastic, &late, &|_| 1.0);
        if let Nodes::F64(arrays) = &mut self.nodes {
            arrays.forces = forces;
        }
        let bay = self.bay.as_ref()?;
        let groups = self.groups.groups.iter().zip(&velocity);
        let late: f64 = groups
            .map(|(group, v)| bay.moment(group, |node| of_late[node]).dot(v))
            .sum();
        let of_delays: f64 = elastic.iter().zip(&delays).map(|(f, u)| f.dot(u)).sum();
        Some(BayEnergy {
            flux: slowness * (power + late) + 0.5 * of_delays,
            less,
            lent,
        })
    }
}
