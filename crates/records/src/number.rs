//! Numbers in the notations of Fortran and spreadsheets.

use crate::{RecordError, RecordFault};

/// Parses one number; `D` is an exponent letter too. `line` and `column` are its position.
pub(crate) fn number(text: &str, line: usize, column: usize) -> Result<f64, RecordError> {
    let fault = |fault| RecordError::content(line, column, fault);
    let allowed = |c: char| c.is_ascii_digit() || "+-.eEdD".contains(c);
    let not_a_number = || {
        fault(RecordFault::NotANumber {
            text: text.chars().take(40).collect(),
        })
    };
    if !text.chars().all(allowed) {
        let lower = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        if ["nan", "inf", "infinity"].contains(&lower.as_str()) {
            return Err(fault(RecordFault::NotFinite { text: text.into() }));
        }
        return Err(not_a_number());
    }
    let mut spelled = text.replace(['D', 'd'], "E");
    if let Some(sign) = bare_exponent(text) {
        spelled.insert(sign, 'E');
    }
    let value: f64 = spelled.parse().map_err(|_| not_a_number())?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(fault(RecordFault::NotFinite { text: text.into() }))
    }
}

/// Offset of the exponent that Fortran writes without a letter if it has three digits, as in
/// `.123-101`.
fn bare_exponent(text: &str) -> Option<usize> {
    let sign = text.len().checked_sub(4)?;
    let (mantissa, exponent) = text.split_at_checked(sign)?;
    let digits = exponent.strip_prefix(['+', '-'])?;
    let is_bare = digits.bytes().all(|byte| byte.is_ascii_digit())
        && mantissa.contains('.')
        && mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.')
        && !mantissa.contains(['e', 'E', 'd', 'D']);
    is_bare.then_some(sign)
}

/// Whether the sign at `at` belongs to such an exponent of the number that starts at `from`.
fn continues(line: &str, from: usize, at: usize) -> bool {
    let behind = line.as_bytes().get(at + 4);
    behind.is_none_or(|byte| byte.is_ascii_whitespace() || b",+-".contains(byte))
        && line
            .get(from..at + 4)
            .is_some_and(|text| bare_exponent(text).is_some())
}

/// Splits a line of fixed-width numbers, which may touch where a sign separates them; each with its
/// column, from 1.
pub(crate) fn fixed_width(line: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut start = None;
    let mut previous = ' ';
    for (at, c) in line.char_indices() {
        let blank = c.is_whitespace() || c == ',';
        let sign = (c == '-' || c == '+') && !"eEdD".contains(previous);
        if let Some(from) = start
            && (blank || (sign && !continues(line, from, at)))
        {
            found.push((from + 1, &line[from..at]));
            start = None;
        }
        if !blank && start.is_none() {
            start = Some(at);
        }
        previous = c;
    }
    if let Some(from) = start {
        found.push((from + 1, &line[from..]));
    }
    found
}
