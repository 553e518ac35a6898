//! Components of one station.

use crate::{Record, RecordError, RecordFault};

/// Treatment of components of unequal length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthRule {
    /// All are truncated to the length of the shortest.
    Cut,
    /// All are padded with zeros at the end to the length of the longest.
    Pad,
}

/// Brings the components of one station to a common length, with a warning in each that changes.
///
/// # Errors
/// [`RecordFault::StepsDiffer`] if the time steps differ by more than 1e-6 of the first.
pub fn common_length(components: &mut [Record], rule: LengthRule) -> Result<(), RecordError> {
    let Some(expected) = components.first().map(|first| first.step) else {
        return Ok(());
    };
    for (component, record) in components.iter().enumerate() {
        if (record.step - expected).abs() > 1e-6 * expected {
            let fault = RecordFault::StepsDiffer {
                component,
                found: record.step,
                expected,
            };
            return Err(RecordError::content(0, 0, fault));
        }
    }
    let lengths = components.iter().map(|record| record.samples.len());
    let length = match rule {
        LengthRule::Cut => lengths.min(),
        LengthRule::Pad => lengths.max(),
    }
    .unwrap_or(0);
    for record in components {
        let before = record.samples.len();
        if before != length {
            record.warnings.push(format!(
                "{before} samples changed to {length} for a common length"
            ));
            record.samples.resize(length, 0.0);
        }
    }
    Ok(())
}
