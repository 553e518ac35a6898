//! Translation of serde's messages into the terms of scene files.

use super::Problem;

impl Problem {
    /// Parses the message of a serde or toml error. serde reports unknown names, types and ranges only in its
    /// messages, in the wording of `serde::de::Error`.
    pub(super) fn from_serde(message: &str) -> Self {
        let after = |start: &str| message.strip_prefix(start);
        if let Some(rest) = after("unknown field ")
            && let Some((key, permitted)) = name_and_others(rest)
        {
            return Self::UnknownKey { key, permitted };
        }
        // Wording of toml in the table of an enum variant.
        if let Some(rest) = after("unexpected keys in table: ")
            && let Some((keys, permitted)) = rest.split_once(", available keys: ")
        {
            let names = |list: &str| list.split(", ").map(str::to_owned).collect::<Vec<_>>();
            return Self::UnknownKey {
                key: names(keys).swap_remove(0),
                permitted: names(permitted),
            };
        }
        if let Some(rest) = after("unknown variant ")
            && let Some((found, permitted)) = name_and_others(rest)
        {
            return Self::UnknownChoice { found, permitted };
        }
        if let Some(rest) = after("missing field ") {
            let key = rest.trim_matches('`').to_owned();
            return Self::MissingKey { key };
        }
        let value = ["invalid type: ", "invalid value: ", "invalid length "]
            .iter()
            .find_map(|start| after(start));
        match value.and_then(|rest| rest.split_once(", expected ")) {
            Some((found, expected)) => Self::Value {
                found: plain(found),
                expected: plain(expected),
            },
            None => Self::Syntax {
                message: message.to_owned(),
            },
        }
    }
}

/// The first name in backticks and all later ones.
fn name_and_others(text: &str) -> Option<(String, Vec<String>)> {
    let mut names = text.split('`').skip(1).step_by(2).map(str::to_owned);
    Some((names.next()?, names.collect()))
}

/// Name of a serde type in the terms of scene files.
fn plain(words: &str) -> String {
    match words {
        "f64" => "a number".into(),
        "u64" | "usize" => "a whole number".into(),
        "a nonzero usize" | "a nonzero u32" => "a whole number above 0".into(),
        "a string" | "string" | "path string" => "a text in quotes".into(),
        "a map" | "map" => "a table".into(),
        "a sequence" | "sequence" => "a list".into(),
        _ => words
            .replace("floating point", "the number")
            .replace("integer", "the number")
            .replace("an array of length", "a list of length")
            .replace("string \"", "the text \"")
            .replace('`', ""),
    }
}
