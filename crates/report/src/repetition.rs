//! Warnings of motions that may depend sensitively on the input.
//!
//! Cracking, yielding and slip may amplify a change of the waves by a millionth to the size of an acceleration; such
//! accelerations must not be used for design. Elastic bodies without joints are insensitive; for other bodies a
//! perturbation test is necessary, a second run under slightly larger waves.

use super::ReportCase;

/// The note on the sensitivity of a case; `None` if its motion is insensitive to the input.
pub(super) fn of(cases: &[ReportCase], name: &str) -> Option<&'static str> {
    let case = cases.iter().find(|case| case.outcome.name == name)?;
    let is_insensitive = (case.summary.as_ref()).is_some_and(|summary| !summary.path_dependent);
    (!is_insensitive).then_some("sensitivity to the input unknown: not for design")
}

/// The warning above the spectra of cases with unknown sensitivity.
pub(super) fn unknown(cases: &[ReportCase]) -> Option<String> {
    let names = cases.iter().map(|case| case.outcome.name.as_str());
    let unknown: Vec<&str> = names.filter(|name| of(cases, name).is_some()).collect();
    (!unknown.is_empty()).then(|| {
        format!(
            "it is unknown whether these motions depend sensitively on the input, and they must not be used for design \
             before it is known: laws or joints have history variables, and cracking, yielding or slip may amplify a \
             change of the waves by a millionth to the size of an acceleration. No perturbation test was run; \
             `powerhouse trade` runs one and names the sensitive histories. Cases: {}",
            unknown.join(", ")
        )
    })
}
