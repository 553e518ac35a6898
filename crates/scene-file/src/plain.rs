//! Translation of serde's words into the terms of scene files.

/// Name of a serde type in the terms of scene files.
pub(crate) fn plain(words: &str) -> String {
    match words {
        "f64" => "a number".into(),
        "u64" | "usize" => "a whole number".into(),
        "a nonzero usize" | "a nonzero u32" => "a whole number above 0".into(),
        "a string" | "string" | "path string" => "a text in quotes".into(),
        "a map" | "map" => "a table".into(),
        "a sequence" | "sequence" => "a list".into(),
        _ if words.starts_with("struct ") => "a table".into(),
        _ => words
            .replace("floating point", "the number")
            .replace("integer", "the number")
            .replace("an array of length", "a list of length")
            .replace("string \"", "the text \"")
            .replace('`', ""),
    }
}
