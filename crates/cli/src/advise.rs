//! `powerhouse advise`.

use std::path::Path;
use std::process::ExitCode;

use powerhouse_study::{advise_boundary, advise_box};

use crate::terminal::say_on;
use crate::{Outcome, WARNED, read_case};

/// Reads a relative error above 0 and up to 1, such as `5%` or `0.05`.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let share = number(text).filter(|share| *share > 0.0 && *share <= 1.0);
    share.ok_or_else(|| "a share above 0 and up to 1, such as 5% or 0.05".into())
}

/// A number, or one in per cent; `None` for other text.
pub(crate) fn number(text: &str) -> Option<f64> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    number
        .trim()
        .parse::<f64>()
        .ok()
        .map(|number| unit * number)
}

/// Prints the comparison of absorbing boundaries; the exit status is 1 if none meets the permitted error.
pub(crate) fn boundary(path: &Path, case: Option<String>, error: f64) -> Outcome {
    let advice = advise_boundary(&read_case(path, case)?, error)?;
    say_on!("{advice}");
    Ok(match advice.recommended() {
        Some(_) => ExitCode::SUCCESS,
        None => ExitCode::from(WARNED),
    })
}

/// Prints the smallest box of ground; the exit status is 1 if the present one already exceeds the permitted error.
pub(crate) fn ground(path: &Path, case: Option<String>, error: f64) -> Outcome {
    let scene = read_case(path, case)?;
    let advice = advise_box(&scene, error)?;
    say_on!("{advice}");
    Ok(if advice.unchanged <= advice.error {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(WARNED)
    })
}

#[cfg(test)]
mod tests {
    use super::share;

    /// Shares are numbers or percentages; other text is an error.
    #[test]
    fn shares_are_read() {
        assert_eq!(share("0.05"), Ok(0.05));
        assert!((share("2.5%").unwrap() - 0.025).abs() < 1e-15);
        for wrong in ["", "%", "0", "-1%", "five", "101%", "1.01", "nan"] {
            assert!(share(wrong).is_err(), "{wrong}");
        }
    }
}
