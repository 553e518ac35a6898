//! Tables of named time histories.

use powerhouse_model::{Cadence, HistoryKind, HistoryVariable, StepView, interned};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::ObserveError;

/// A time history of one quantity, with name and unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the quantity, such as `crown.ux`.
    pub name: String,
    /// Unit of the values, such as `m/s2`.
    pub unit: &'static str,
    /// Values, one per time of the table.
    pub values: Vec<f64>,
    /// Value of largest magnitude of all observed steps, and its time (s).
    peak: Option<(f64, f64)>,
    /// Of a [mean](super::AccelerationRule::Mean) the value of largest magnitude of the steps themselves, and its time (s).
    instant: Option<(f64, f64)>,
    /// Whether the value holds until the next step, as flags do, and is not interpolated.
    holds: bool,
    /// Whether the value is the mean over the interval around its row, from the change of a velocity.
    is_mean: bool,
}

impl Serialize for Column {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self {
            name,
            unit,
            values,
            peak,
            instant,
            holds,
            is_mean,
        } = self;
        (name, unit, values, peak, instant, holds, is_mean).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        type Peak = Option<(f64, f64)>;
        type Parts = (String, String, Vec<f64>, Peak, Peak, bool, bool);
        let (name, unit, values, peak, instant, holds, is_mean) = Parts::deserialize(deserializer)?;
        let unit = interned(&unit);
        Ok(Self {
            name,
            unit,
            values,
            peak,
            instant,
            holds,
            is_mean,
        })
    }
}

/// Unit of accelerations.
const ACCELERATION: &str = "m/s2";
/// Number of samples before and after the greatest one over which [`Column::roughness`] sums.
const AROUND: usize = 8;

impl Column {
    /// A column of given values.
    pub fn new(name: impl Into<String>, unit: &'static str, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit,
            values,
            peak: None,
            instant: None,
            holds: false,
            is_mean: false,
        }
    }
    /// Value of largest magnitude and its time (s), the first of equal ones, where `times` are those of the values: that of
    /// all steps that were observed, of a displacement or velocity every step of the run, of a mean acceleration and all else
    /// that of the values. None without values.
    pub fn peak(&self, times: &[f64]) -> Option<(f64, f64)> {
        let samples = self.values.iter().copied().zip(times.iter().copied());
        let greatest = |a: (f64, f64), b: (f64, f64)| if b.0.abs() > a.0.abs() { b } else { a };
        self.peak.or_else(|| samples.reduce(greatest))
    }
    /// Of a mean acceleration the value of largest magnitude of all steps, and its time (s). It depends on mesh and step
    /// where bodies hit each other, without a limit; none of other columns.
    pub fn instant_peak(&self) -> Option<(f64, f64)> {
        self.instant
    }
    /// Raises the peak to a value at a time (s), if that is larger.
    pub(super) fn raise(&mut self, value: f64, time: f64) {
        raise(&mut self.peak, value, time);
    }
    /// Raises the peak to the value of a step at a time (s), of a mean that of the [instants](Self::instant_peak).
    pub(super) fn raise_in_step(&mut self, value: f64, time: f64) {
        if self.is_mean {
            raise(&mut self.instant, value, time)
        } else {
            self.raise(value, time)
        }
    }
    /// Roughness of a motion around its greatest sample, from which it follows how many samples there are per period:
    /// `4 sin^2(pi / n)` for a sinusoid with `n` samples per period (1 at six), whatever its phase and direction; 2 on
    /// average for noise, and for a peak of one sample.
    ///
    /// `sum a(i) . (2 a(i) - a(i-1) - a(i+1)) / sum a(i) . a(i)`, over the 17 samples around the greatest one: for a
    /// sinusoid the ratio of each pair of terms is the same, so that the number of periods among them does not matter.
    ///
    /// `components` are columns of one vector with equal lengths. None if there are none, if there are fewer than three
    /// samples, or if all samples around the greatest one are zero.
    pub fn roughness(components: &[Self]) -> Option<f64> {
        let product = |i: usize, j: usize| -> f64 {
            let values = components.iter().map(|column| &column.values);
            values.map(|values| values[i] * values[j]).sum()
        };
        let last = components.first()?.values.len().checked_sub(1)?;
        let greatest = (0..=last).max_by(|&i, &j| product(i, i).total_cmp(&product(j, j)))?;
        let around = greatest.saturating_sub(AROUND).max(1)..last.min(greatest + AROUND + 1);
        let (mut changes, mut size) = (0.0, 0.0);
        for i in around {
            changes += 2.0 * product(i, i) - product(i, i - 1) - product(i, i + 1);
            size += product(i, i);
        }
        (size > 0.0).then(|| changes / size)
    }
}

/// Raises a peak to a value at a time (s), if that is larger.
fn raise(peak: &mut Option<(f64, f64)>, value: f64, time: f64) {
    if peak.is_none_or(|(peak, _)| value.abs() > peak.abs()) {
        *peak = Some((value, time));
    }
}

/// A table of time histories with common times.
///
/// Times of an observer with an interval in seconds longer than a step are the multiples of that interval. A row at an
/// instant between two steps has values on the straight line between those of the two, which for displacements is the path
/// of central differences, whose velocity is constant between steps; flags are those of the later step. Accelerations by the rule
/// of [means](super::AccelerationRule::Mean) are those over the interval around the row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HistoryTable {
    /// Times (s), rising.
    pub times: Vec<f64>,
    /// Columns, each as long as `times`.
    pub columns: Vec<Column>,
    /// Time (s) and values of the last observed step, with the velocities of means after those of the columns.
    before: Option<(f64, Vec<f64>)>,
    /// The same at the start of the interval over which the next means are taken.
    start: Option<(f64, Vec<f64>)>,
    /// Row whose means are not known yet.
    open: Option<(f64, Vec<f64>)>,
}

impl HistoryTable {
    /// A table of given times (s) and columns.
    pub fn new(times: Vec<f64>, columns: Vec<Column>) -> Self {
        Self {
            times,
            columns,
            ..Self::default()
        }
    }
    /// The column with a name; none if there is no such column.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
    /// Adds an empty column.
    pub(super) fn add_column(
        &mut self,
        name: String,
        unit: &'static str,
    ) -> Result<(), ObserveError> {
        if self.column(&name).is_some() {
            return Err(ObserveError::NameTwice { name });
        }
        self.columns.push(Column::new(name, unit, Vec::new()));
        Ok(())
    }
    /// Adds an empty column for a history variable.
    pub(super) fn add_variable(
        &mut self,
        name: String,
        variable: &HistoryVariable,
    ) -> Result<(), ObserveError> {
        self.add_column(name, variable.unit)?;
        if let Some(column) = self.columns.last_mut() {
            column.holds = variable.kind == HistoryKind::Flags;
        }
        Ok(())
    }
    /// Makes the columns of accelerations from an index on means.
    pub(super) fn take_means(&mut self, from: usize) {
        let columns = self.columns[from..].iter_mut();
        for column in columns.filter(|column| column.unit == ACCELERATION) {
            column.is_mean = true;
        }
    }
    /// Whether there are columns of means.
    pub(super) fn has_means(&self) -> bool {
        self.columns.iter().any(|column| column.is_mean)
    }
    /// Names of the columns.
    pub(super) fn names(&self) -> Vec<String> {
        self.columns
            .iter()
            .map(|column| column.name.clone())
            .collect()
    }
    /// Takes the values of an observed step, one per column and then a velocity per column of means: raises the peaks, and adds
    /// the row that the step completes, if it completes one.
    ///
    /// Means are over the interval from half of it before the row to half of it behind it, and exact: the change of the velocity
    /// over its length. Where half of it is no longer than a step, they are the accelerations of the steps, which are means over
    /// a step.
    pub(super) fn see(&mut self, cadence: Cadence, view: &dyn StepView, row: &[f64]) {
        let (time, step) = (view.time(), view.step());
        let half = self.half(cadence).filter(|half| *half > step);
        for (column, &value) in self.columns.iter_mut().zip(row) {
            match half {
                Some(_) => column.raise_in_step(value, time),
                None => column.raise(value, time),
            }
        }
        if !matches!(cadence, Cadence::Seconds(interval) if interval > step) {
            return self.push(time, row);
        }
        let before = self.before.replace((time, row.to_vec()));
        if half.is_some() && view.number() == 0 {
            self.start.clone_from(&self.before);
        }
        let cadence = half.map_or(cadence, Cadence::Seconds);
        let Some(multiple) = cadence.multiple(view.number(), time, step) else {
            return;
        };
        let (instant, values) = match before {
            _ if Cadence::is_same_time(multiple, time, step) => (multiple, row.to_vec()),
            Some((earlier, mut values)) if earlier < multiple => {
                let share = (multiple - earlier) / (time - earlier);
                for (index, (value, &later)) in values.iter_mut().zip(row).enumerate() {
                    let holds = self.columns.get(index).is_some_and(|column| column.holds);
                    *value = if holds {
                        later
                    } else {
                        *value + share * (later - *value)
                    };
                }
                (multiple, values)
            }
            // Nothing is known before this step.
            _ if half.is_some() && view.number() > 0 => return,
            _ => (time, row.to_vec()),
        };
        match half {
            None => self.push(instant, &values),
            Some(half) if (multiple / half).round().rem_euclid(2.0) == 0.0 => {
                self.open = Some((instant, values));
            }
            Some(_) => {
                self.complete(instant, &values);
                self.start = Some((instant, values));
            }
        }
    }
    /// Half of the interval of a cadence (s), of a table with means.
    pub(super) fn half(&self, cadence: Cadence) -> Option<f64> {
        match cadence {
            Cadence::Seconds(interval) if self.has_means() => Some(0.5 * interval),
            _ => None,
        }
    }
    /// Adds the row whose means end at an instant (s) with these values, if there is one; not one whose interval began before
    /// the first observed step of a motion that began earlier.
    fn complete(&mut self, instant: f64, values: &[f64]) {
        let (Some((time, mut row)), Some((start, first))) = (self.open.take(), &self.start) else {
            return;
        };
        // A run of a single step knows no change.
        if *start < instant {
            let velocities = self.columns.len()..;
            let means = (0..self.columns.len()).filter(|index| self.columns[*index].is_mean);
            for (index, velocity) in means.zip(velocities) {
                row[index] = (values[velocity] - first[velocity]) / (instant - start);
            }
        }
        for (column, &value) in self.columns.iter_mut().zip(&row) {
            if column.is_mean {
                column.raise(value, time);
            }
        }
        self.push(time, &row);
    }
    /// Completes the last row at the end of a run, with the means up to its last step.
    pub(super) fn end_means(&mut self) {
        if let Some((time, values)) = self.before.take() {
            self.complete(time, &values);
            self.before = Some((time, values));
        }
    }
    /// Whether no step was observed yet.
    pub(super) fn is_new(&self) -> bool {
        self.times.is_empty() && self.before.is_none()
    }
    /// Adds the last observed step as the last row, whatever its time, of a table whose final values count.
    pub(super) fn end(&mut self) {
        let last = self.times.last().copied();
        let later = self
            .before
            .take()
            .filter(|(time, _)| last.is_none_or(|last| *time > last));
        if let Some((time, row)) = later {
            self.push(time, &row);
        }
    }
    /// Adds a row, one value per column.
    pub(super) fn push(&mut self, time: f64, row: &[f64]) {
        self.times.push(time);
        for (column, &value) in self.columns.iter_mut().zip(row) {
            column.values.push(value);
        }
    }
}
