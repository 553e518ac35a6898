//! The energy balance of a run.

use powerhouse_model::Cadence;
use powerhouse_observe::EnergyHistory;

use super::{
    OutputItem, OutputPrice, OutputScale, OutputSite, Recorder, Results, TableForm, TablePeaks,
    TablePlots, model,
};
use crate::Error;

/// The energy balance.
#[derive(Debug)]
pub(super) struct Energies;

/// Name of the table.
pub(super) const ENERGIES: &str = "energies";
/// Number of its columns.
const COLUMNS: f64 = 19.0;
/// Column of the residual.
const RESIDUAL: &str = "residual";
/// Columns of external work.
const INPUTS: [&str; 2] = ["loads", "prescribed motion"];

impl OutputItem for Energies {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        if let Some(every) = site.plan.energies {
            let energies = EnergyHistory::new(Cadence::Seconds(every)).map_err(model)?;
            let form = TableForm::new(ENERGIES, TablePlots::One, TablePeaks::None);
            into.table(form, energies.recording(), |table| table);
            into.observe(energies);
        }
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let every = scale.plan.energies;
        every.map_or_else(OutputPrice::default, |every| scale.table(COLUMNS, every))
    }
}

/// Residual of the energy balance of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyResidual {
    /// Residual at the end of the run (J).
    pub energy: f64,
    /// Its absolute value over the work of loads and prescribed motions at the end (1); zero where no residual was above
    /// rounding, none without such work.
    pub share_of_input: Option<f64>,
    /// Largest absolute residual at the samples of the run beyond the rounding of works that cancel, over the largest stored
    /// energy or external work until then (1).
    pub largest: f64,
}

impl Results {
    /// Names and final values (J) of the energies that were ever other than zero, the residual left out; empty if energies
    /// were not recorded.
    pub fn energy_terms(&self) -> Vec<(&str, f64)> {
        let columns = self.energies().columns.iter();
        columns
            .filter(|column| column.name != RESIDUAL && column.values.iter().any(|v| *v != 0.0))
            .filter_map(|column| Some((column.name.as_str(), *column.values.last()?)))
            .collect()
    }
    /// Residual of the energy balance; `None` if energies were not recorded.
    pub fn energy_residual(&self) -> Option<EnergyResidual> {
        let last = |name| self.energies().column(name)?.values.last().copied();
        let energy = last(RESIDUAL)?;
        let input: f64 = INPUTS.iter().filter_map(|name| last(name)).sum();
        let largest = self.run.energy_residual;
        let share = || match largest {
            // The input may be rounding, too.
            0.0 => 0.0,
            _ => (energy / input).abs(),
        };
        Some(EnergyResidual {
            energy,
            share_of_input: (input != 0.0).then(share),
            largest,
        })
    }
}
