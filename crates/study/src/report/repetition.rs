//! Whether the motions of cases repeat.
//!
//! Cracks, yield and slip may amplify a change of the waves by a millionth to all of an acceleration; what does
//! not repeat is no figure for design. Elastic bodies without joints repeat. Of others it is known only by a
//! second run under waves that hardly differ.

use super::CaseFiles;

/// What a reader must know of the repetition of the case of a name; nothing if its motion repeats.
pub(super) fn of(cases: &[CaseFiles], name: &str) -> Option<&'static str> {
    let case = cases.iter().find(|case| case.outcome.name == name)?;
    // Summaries of an older version do not say it.
    let repeats = case.summary["path_dependent"] == false;
    (!repeats).then_some("unknown whether it repeats: not for design")
}

/// The warning above the spectra of cases of which some are not known to repeat.
pub(super) fn unknown(cases: &[CaseFiles]) -> Option<String> {
    let names = cases.iter().map(|case| case.outcome.name.as_str());
    let unknown: Vec<&str> = names.filter(|name| of(cases, name).is_some()).collect();
    (!unknown.is_empty()).then(|| {
        format!(
            "it is unknown whether these motions repeat, and they are no figures for design before it is known: laws \
             or joints have history variables, and cracks, yield or slip may amplify waves larger by a millionth \
             to all of an acceleration. No second run was made; `powerhouse trade` makes one and names what does \
             not repeat. Cases: {}",
            unknown.join(", ")
        )
    })
}
