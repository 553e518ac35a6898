//! Histories of motion, stress and state, and their accelerations up to a band.

use std::cell::RefCell;

use powerhouse_observe::{AccelerationRule, History, Motion, StressPlace};

use super::item::vectors;
use super::{
    OutputItem, OutputPlan, OutputPrice, OutputScale, OutputSite, Recorder, TableForm, TablePeaks,
    TablePlots, model,
};
use crate::{Error, Remark, remark};

/// Histories, and band-limited accelerations from which peaks and spectra are.
#[derive(Debug)]
pub(super) struct Histories;

/// Names of the tables.
pub(super) const HISTORIES: &str = "histories";
pub(super) const ACCELERATIONS: &str = "accelerations";
/// Columns of a relative displacement and of a stress.
const RELATIVE_COLUMNS: f64 = 4.0;
const STRESS_COLUMNS: f64 = 9.0;
/// Rows of band-limited accelerations to a period of the band.
const ROWS_OF_BAND: f64 = 5.0;

impl OutputItem for Histories {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        let history = histories(site, &mut into.remarks)?;
        if history.is_empty() {
            return Ok(());
        }
        if let Some(peaks) = history.motion_peaks() {
            into.observe(peaks);
        }
        let form = TableForm::new(HISTORIES, TablePlots::of_names(""), TablePeaks::All);
        into.table(form, history.recording(), |table| table);
        let limited = site.band.map(|band| history.band_limited(band)).transpose();
        if let Some(limited) = limited.map_err(model)?.flatten() {
            // Of accelerations the peaks are those of the band, whatever the interval of the histories.
            let form = TableForm::new(ACCELERATIONS, TablePlots::None, TablePeaks::InPlace);
            into.table(form, limited.recording(), |table| table);
            into.observe(limited);
        }
        into.observe(history);
        Ok(())
    }

    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let plan = &scale.plan;
        let motions = plan.histories.iter().map(|request| request.motion);
        let sampled = plan.sampled.iter();
        let columns = 3.0 * motions.clone().map(vectors).sum::<f64>()
            + STRESS_COLUMNS * plan.stresses.len() as f64
            + RELATIVE_COLUMNS * plan.relative.len() as f64
            + sampled
                .map(|request| request.sampler.columns().len() as f64)
                .sum::<f64>()
            + (scale.laws.variables.len() * plan.state.places.len()) as f64;
        let mut price = scale.table(columns, plan.every);
        let accelerations = motions.filter(|motion| motion.acceleration).count();
        if plan.accelerations == AccelerationRule::Mean && accelerations > 0 {
            let band = plan.band.unwrap_or(OutputPlan::BAND);
            let rows = (ROWS_OF_BAND * band * scale.duration).ceil();
            price += OutputPrice::of_numbers((1.0 + 3.0 * accelerations as f64) * rows);
        }
        price
    }
}

/// Histories of a plan, with remarks about requests that record nothing.
fn histories(site: &OutputSite, remarks: &mut Vec<Remark>) -> Result<History, Error> {
    let OutputSite {
        plan,
        mesh,
        present,
        state_variables,
        ..
    } = *site;
    let mut builder = History::builder(site.cadence()).accelerations(plan.accelerations);
    if let Some(present) = present {
        builder = builder.among(present);
    }
    for request in &plan.histories {
        if request.motion != Motion::default() {
            builder = builder.motion(&request.name, request.place.clone(), request.motion);
        }
    }
    for request in &plan.stresses {
        builder = match &request.place {
            StressPlace::Point(point) if request.at_point => {
                builder.stress_at(&request.name, point.clone())
            }
            place => builder.stress(&request.name, place.clone()),
        };
    }
    for request in &plan.state.places {
        builder = builder.state(&request.name, request.place.clone());
    }
    for request in &plan.relative {
        let (from, at) = (request.from.clone(), request.at.clone());
        builder = builder.relative(&request.name, from, at, Motion::DISPLACEMENT);
    }
    for request in &plan.sampled {
        builder = builder.sampled(&request.name, request.sampler.clone());
    }
    // In the order of the requests.
    let asked = RefCell::new(Vec::new());
    let variables = |element| {
        asked.borrow_mut().push(element);
        state_variables.of_element(element).to_vec()
    };
    let history = builder.build_with(mesh, variables).map_err(model)?;
    let places = plan.state.places.iter().zip(asked.into_inner());
    let without_state =
        places.filter(|(_, element)| state_variables.of_element(*element).is_empty());
    remarks.extend(without_state.map(|(request, element)| {
        Remark::from(remark::NoState {
            name: request.name.clone(),
            element: mesh.element_tags()[element as usize],
        })
    }));
    Ok(history)
}
