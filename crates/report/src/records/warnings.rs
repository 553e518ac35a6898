//! Warnings of many runs, those that differ in numbers and names alone together.

use super::super::run_warnings::RunWarnings;
use super::CASES_PAGE;

/// Most kinds of warnings that are stated.
const MOST: usize = 10;

/// The warnings of the runs, one of each kind with the number of runs that have such a one.
pub(super) fn grouped(warnings: &RunWarnings, runs: usize) -> Vec<String> {
    let mut kinds: Vec<(String, &str, Vec<&str>)> = Vec::new();
    for (text, cases) in warnings.with_cases() {
        let kind = kind(text);
        match kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((.., of)) => of.extend(cases),
            None => kinds.push((kind, text, cases.to_vec())),
        }
    }
    for (.., cases) in &mut kinds {
        cases.sort_unstable();
        cases.dedup();
    }
    // Those of most runs first; of as many, in the order of the runs.
    kinds.sort_by_key(|(.., cases)| std::cmp::Reverse(cases.len()));
    let further = kinds.len().saturating_sub(MOST);
    let texts = kinds.iter().take(MOST).map(|(_, text, cases)| {
        if cases.len() == runs {
            return format!("in all {runs} cases, such as {}: {text}", cases[0]);
        }
        format!(
            "in {} of {runs} cases, such as {}: {text}",
            cases.len(),
            cases[0]
        )
    });
    let more =
        (further > 0).then(|| format!("{further} further kinds of warnings are in {CASES_PAGE}"));
    texts.chain(more).collect()
}

/// A text without its numbers and quoted names.
fn kind(text: &str) -> String {
    let mut kind = String::with_capacity(text.len());
    for (index, piece) in text.split('\'').enumerate() {
        // Between quotes.
        if index % 2 == 1 {
            kind.push('\'');
            continue;
        }
        let mut in_number = false;
        for letter in piece.chars() {
            let goes_on = in_number && matches!(letter, '.' | 'e' | '-' | '+');
            let is_digit = letter.is_ascii_digit();
            if is_digit && !in_number {
                kind.push('#');
            }
            if !(is_digit || goes_on) {
                kind.push(letter);
            }
            in_number = is_digit || goes_on;
        }
    }
    // Lists of names count as one.
    while kind.contains("', '") {
        kind = kind.replace("', '", "'");
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::kind;

    /// Warnings that differ in numbers and names have one kind, others have not.
    #[test]
    fn a_kind_is_without_numbers_and_names() {
        let [one, other, third] = [
            "section 'crown' is at 1.34 times what it bears (-340.8 to 3.4e-2 kN m/m)",
            "section 'left', 'right' is at 26 times what it bears (-1 to 1.5e+3 kN m/m)",
            "section 'left' is at 26 times what it weighs",
        ]
        .map(kind);
        assert_eq!(one, other);
        assert_ne!(other, third);
    }
}
