//! Remarks about keys of the scene file.

remark! {
    /// Fact: key of the scene file that has another name now, and is read under both.
    pub struct FormerKey {
        /// Table of the key, such as `output.section`.
        pub table: &'static str,
        /// Name in the file.
        pub former: &'static str,
        /// Name that replaces it.
        pub present: &'static str,
    }
    Fact(Run),
    "the key '{former}' of [{table}] is called '{present}' now; it is read under both names"
}

remark! {
    /// Fact: keys of the scene file that were changed for this scene, such as by `--set`.
    pub struct ChangedKeys {
        /// The changes, each as `KEY=VALUE`.
        pub changes: Vec<String>,
    }
    Fact(Run),
    "keys of the scene file that are changed here: {}",
    changes.join(", ")
}
