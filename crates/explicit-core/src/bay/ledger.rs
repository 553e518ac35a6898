//! Energy of a bay.
//!
//! In the scheme of linear bodies `1/2 V.(M - s^2 A) V + 1/2 U.K U` stays what it is: kinetic and strain energy less `s` times the flux
//! of energy along y. What laws lack of linear forces, `r` at the strain `e` half way between two steps, does the work
//! `(r- + r+).(e+ - e-) / 2` in a step, but for the change of `s V.(sum of o r)`. So the sum that stays has what the elements store and dissipate at
//! `e+` in place of `1/2 e+.K e+`.

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
        let placed = self
            .bay
            .as_ref()
            .map_or(&[][..], |bay| &bay.solution.placed);
        if placed.is_empty() {
            return Vec::new();
        }
        let of = |block: usize| {
            let nodes = self.subdomain.nodes_of(block).iter();
            Some(
                nodes
                    .map(|&node| Quad::from_vector(&placed[node as usize]))
                    .collect(),
            )
        };
        (0..self.blocks.len()).map(of).collect()
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
        let slowness = bay.slowness;
        let ([after, before], next) = (&bay.motion.lacking, &self.groups.motion.next);
        let pending = after.iter().zip(before).zip(next);
        let pending = pending.map(|(([force, moment], [earlier, moment_before]), v)| {
            let change = (moment - moment_before) * slowness;
            let impulse = (force + earlier) * (0.5 * step) + change;
            v.dot(&(impulse * 0.5 - moment * slowness))
        });
        let pending: f64 = pending.sum();
        let forces = arrays.forces.clone();
        let moved: Vec<Vec3> = arrays.displacement.iter().map(|u| u.to_vector()).collect();
        let placed = bay.solution.placed.clone();
        let [of_moved, of_placed] = [moved, placed].map(|places| {
            let product = self.elastic_product(Operator::Elastic, &places, &|_| 1.0);
            let both = places.iter().zip(&product);
            0.5 * both.map(|(u, f)| u.dot(f)).sum::<f64>()
        });
        if let Nodes::F64(arrays) = &mut self.nodes {
            arrays.forces = forces;
        }
        Some(BayEnergy {
            flux: pending + of_moved - of_placed,
            less,
            lent,
        })
    }
}
