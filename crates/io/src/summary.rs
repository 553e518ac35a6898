//! Summaries as JSON.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use crate::{IoError, write_whole};

/// Writes a serialisable summary as indented JSON, with keys in the order of its fields.
///
/// JSON has no numbers that are not finite; they would become `null`. So a summary must not have
/// any `null`: absent values are left out (`skip_serializing_if`).
///
/// # Errors
/// [`IoError::Null`] with the path of the value, or the operating system's error.
pub fn write_summary(file: &Path, summary: &impl Serialize) -> Result<(), IoError> {
    let json = |source| IoError::Json {
        file: file.into(),
        source,
    };
    let value = serde_json::to_value(summary).map_err(json)?;
    if let Some(path) = first_null(&value) {
        return Err(IoError::Null {
            file: file.into(),
            path,
        });
    }
    let mut text = serde_json::to_vec_pretty(summary).map_err(json)?;
    text.push(b'\n');
    write_whole(file, &text)
}

/// Path of the first `null`, such as `.peaks[2].value`.
fn first_null(value: &Value) -> Option<String> {
    match value {
        Value::Null => Some(String::new()),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(index, item)| first_null(item).map(|rest| format!("[{index}]{rest}"))),
        Value::Object(fields) => fields
            .iter()
            .find_map(|(key, item)| first_null(item).map(|rest| format!(".{key}{rest}"))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Peak {
        probe: &'static str,
        value: f64,
    }
    #[derive(Serialize)]
    struct Summary {
        title: &'static str,
        peaks: Vec<Peak>,
    }

    /// Keys keep their order; a value that is not finite is an error with its path.
    #[test]
    fn a_summary_holds_only_finite_numbers() {
        let file = std::env::temp_dir().join(format!("powerhouse-{}-sum.json", std::process::id()));
        let mut summary = Summary {
            title: "box",
            peaks: vec![Peak {
                probe: "crown",
                value: 0.25,
            }],
        };
        write_summary(&file, &summary).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.find("title") < text.find("peaks"));
        assert!(text.contains("0.25"));
        summary.peaks[0].value = f64::NAN;
        let message = write_summary(&file, &summary).unwrap_err().to_string();
        assert!(message.contains(".peaks[0].value"), "{message}");
        std::fs::remove_file(file).unwrap();
    }
}
