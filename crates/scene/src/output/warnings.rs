//! Warnings about the results of a run.

use powerhouse_model::{HourglassShare, Mesh};

use super::{Results, capacity, sampling};
use crate::{Remark, remark};

impl Results {
    /// Warnings about the results: large slips, large hourglass work, heavy fibres, unbalanced in-situ stress, and
    /// accelerations whose sampling interval is too long. Of several stages with large hourglass work in one set, the one with the largest.
    pub fn warnings(&self, mesh: &Mesh) -> Vec<Remark> {
        let shares = self.slip_shares(mesh).into_iter();
        let large = shares.filter(|(_, share)| *share > Self::SMALL_SLIP);
        let remark = |(joint, share): (&str, f64)| {
            Remark::from(remark::LargeSlip {
                joint: joint.into(),
                share,
            })
        };
        let mut warnings: Vec<Remark> = large.map(remark).collect();
        let resists = |stage: Option<&str>, sets: &[HourglassShare], warnings: &mut Vec<Remark>| {
            let large = sets
                .iter()
                .filter(|set| set.share() > HourglassShare::LIMIT);
            warnings.extend(large.map(|set| {
                Remark::from(remark::Hourglass {
                    stage: stage.map(String::from),
                    set: set.set.clone(),
                    share: set.share(),
                })
            }));
        };
        for stage in &self.stages {
            resists(Some(&stage.name), &stage.hourglass, &mut warnings);
        }
        resists(None, &self.run.hourglass, &mut warnings);
        let mut worst: Vec<Remark> = Vec::new();
        for warning in warnings {
            keep_worst(&mut worst, warning);
        }
        worst.extend(self.unbalanced());
        worst.extend(self.heavy_fibres());
        worst.extend(self.crack_energy());
        worst.extend(self.unsolved());
        worst.extend(self.section_uses().iter().filter_map(capacity::beyond));
        worst.extend(sampling::warnings(
            self.histories(),
            self.accelerations(),
            self.envelope.as_ref(),
        ));
        worst
    }
    /// Warning about fibres whose added inertia the motion felt.
    fn heavy_fibres(&self) -> Option<Remark> {
        let share = self.share_of_fibres()?;
        (share > Self::LIGHT_FIBRES).then_some(Remark::from(remark::HeavyFibres { share }))
    }
    /// Warning about energy that closing cracks give, or that the time integration of the laws errs by.
    fn crack_energy(&self) -> Option<Remark> {
        let most = |name| {
            let values = self.energies().column(name)?.values.iter();
            Some(values.fold(0.0_f64, |most, value| {
                if value.abs() > most.abs() {
                    *value
                } else {
                    most
                }
            }))
        };
        let of = |name| most(name).unwrap_or(0.0);
        let dissipated = of("plastic") + of("damage");
        let (recovery, integration) = (-of("recovery"), of("integration"));
        let is_large = recovery > Self::LARGE_RECOVERY * dissipated
            || integration.abs() > Self::LARGE_INTEGRATION * dissipated;
        (dissipated > 0.0 && is_large).then_some(Remark::from(remark::CrackEnergy {
            dissipated,
            recovery,
            integration,
        }))
    }
    /// Warning about steps of a bay that were not solved.
    fn unsolved(&self) -> Option<Remark> {
        let unsolved = self.run.unsolved?;
        let steps = self.run.steps;
        Some(Remark::from(remark::UnsolvedSteps { unsolved, steps }))
    }
    /// Warning about an in-situ stress that is not in equilibrium with the loads of the first stage, unless that stage
    /// changes the body.
    fn unbalanced(&self) -> Option<Remark> {
        let first = self.stages.first()?;
        let share = first.solution.unbalanced;
        let (displacement, node) = first.largest_displacement;
        let changes = first.excavated + first.cast > 0;
        (self.in_situ_stress && !changes && share > Self::BALANCED).then(|| {
            Remark::from(remark::Unbalanced {
                stage: first.name.clone(),
                share,
                displacement,
                node,
            })
        })
    }
}

/// Adds a warning; of those about the hourglass work of one set in several stages only the largest is kept.
fn keep_worst(warnings: &mut Vec<Remark>, warning: Remark) {
    let of_stage = |warning: &Remark| match warning {
        Remark::Hourglass(remark::Hourglass {
            stage: Some(_),
            set,
            share,
        }) => Some((set.clone(), *share)),
        _ => None,
    };
    let known = of_stage(&warning).and_then(|(set, share)| {
        let mut known = warnings.iter_mut();
        let found = known.find(|known| of_stage(known).is_some_and(|(other, _)| other == set));
        found.map(|known| (known, share))
    });
    match known {
        None => warnings.push(warning),
        Some((known, share)) => {
            if of_stage(known).is_some_and(|(_, least)| share > least) {
                *known = warning;
            }
        }
    }
}
