//! Sets of records: studies of one scene under many motions, such as design codes ask for.
//!
//! A set is expanded into tables that a scene may have as well by hand, before anything else reads them: a record of the set's
//! name, the first of the set, and a case for each record and scale that has another file and factor for this record. So cases of a
//! set are cases in every respect, and the inputs of each are its own record alone.

use core::ops::Range;
use std::path::{Path, PathBuf};

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde_json::Value as Json;

use super::node::{Entry, Node, Table, Value};
use super::{At, Finite, Positive, Record, decode};
use powerhouse_scene::{Fault, Problem};

/// Key of the sets in a scene.
const SETS: &str = "record_set";
/// Keys of a set that are not those of its records.
const KEYS: [&str; 7] = [
    "name",
    "folder",
    "ending",
    "files",
    "components",
    "scales",
    "fragility",
];
/// Keys of a record that a set has in another form.
const OF_ONE: [&str; 2] = ["file", "factor"];

/// Set of ground motion records, in the place of one record: the scene gets a case for each of them and each scale, whose waves and
/// motions have it as the record of the set's name. All other keys are those of a `[[record]]`, and hold for every record of the
/// set. A scene has one set; without a case it has the first record at the least scale.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
#[schemars(transform = add_keys_of_records)]
pub struct RecordSet {
    /// Name to which waves and recorded motions refer.
    pub name: At<String>,
    /// Folder, relative to the scene file, whose files are the records, in the order of their names; folders in it and
    /// files whose name begins with a point are left out. A set has either a folder, files or components. Cases are named after the
    /// files without their ending.
    pub folder: Option<At<PathBuf>>,
    /// Last letters of the names of those files of the folder that are records, such as `.AT2`; all files by default.
    pub ending: Option<At<String>>,
    /// Files of the records.
    pub files: Option<At<Vec<At<PathBuf>>>>,
    /// Components of each record: files of one station, such as a pair of horizontal ones, which get the same scale.
    pub components: Option<At<Vec<At<SetComponents>>>>,
    /// Factors on the records after all other processing, each a stripe of the study, above 0: a case `NAME-x0.5` for the factor
    /// 0.5. One case `NAME` without a factor by default.
    pub scales: Option<At<Vec<Positive>>>,
    /// Fragility curves that are fitted to the results of a sweep over the set. They are no input of its cases.
    #[serde(default)]
    pub fragility: Vec<FragilityCurve>,
}

/// Files of the components of one record of a set.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct SetComponents {
    /// Name of the record, by which its cases are named; that of its first file without the ending by default.
    pub name: Option<At<String>>,
    /// Path of the file of the first horizontal component.
    pub x: Option<At<PathBuf>>,
    /// Path of the file of the second horizontal component.
    pub y: Option<At<PathBuf>>,
    /// Path of the file of the vertical component.
    pub z: Option<At<PathBuf>>,
}

/// Lognormal fragility curve: probability that a result exceeds a limit, against the intensity of the scaled record.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct FragilityCurve {
    /// Name of the curve.
    pub name: At<String>,
    /// Result of a case: a column of `sweep.csv`, such as `greatest damage`, with the unit in brackets if it has one.
    pub figure: String,
    /// Limit in the unit of the result: it is exceeded by a greater result, or, of a limit below 0, by a lesser one.
    pub limit: Finite,
    /// Period (s) at which the pseudo-acceleration, at 5 % of critical damping, is the intensity; by default the intensity is
    /// the peak acceleration. Of two horizontal components it is the geometric mean.
    pub period: Option<Positive>,
}

/// Case that a set of records adds to a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecordCase {
    /// Name of the case.
    pub case: String,
    /// Name of the record among those of the set.
    pub record: String,
    /// Factor on the record.
    pub scale: f64,
}

impl RecordCase {
    /// Case of a name for a record at a scale.
    pub fn new(case: impl Into<String>, record: impl Into<String>, scale: f64) -> Self {
        Self {
            case: case.into(),
            record: record.into(),
            scale,
        }
    }
}

/// A record of a set: its name, and the key and value by which its table names its files.
struct Member {
    name: At<String>,
    key: &'static str,
    files: Node,
}

/// Adds the record and the cases of a set to the tables of a scene, whose paths are relative to a folder; returns its cases. What is
/// no list of tables is left for serde to reject.
///
/// # Errors
/// A second set; no records, two of one name, a folder that cannot be read; keys that records do not have.
pub(super) fn expand(root: &mut Node, folder: &Path) -> Result<Vec<RecordCase>, Fault> {
    let Some(root) = root.as_table_mut() else {
        return Ok(Vec::new());
    };
    let Some(Node {
        value: Value::List(sets),
        ..
    }) = root.get_mut(SETS)
    else {
        return Ok(Vec::new());
    };
    if let [_, second, ..] = &sets[..] {
        let reason =
            "a scene has one set of records; records of several components are one set, too";
        return Err(Fault::refused(second.span.clone(), reason));
    }
    let Some(node) = sets.first_mut() else {
        return Ok(Vec::new());
    };
    let Some(table) = node.as_table_mut() else {
        return Ok(Vec::new());
    };
    let of_records = table.split(|key| KEYS.contains(&key));
    if let Some((_, entry)) = of_records.iter().find(|(key, _)| OF_ONE.contains(key)) {
        let reason = "a [[record_set]] has `files`, `folder` or `components` in the place of `file`, and `scales` in that of `factor`";
        return Err(Fault::refused(entry.key.clone(), reason));
    }
    let set: RecordSet = node.read()?;
    let members = members(&set, folder)?;
    unique("fragility", set.fragility.iter().map(|curve| &curve.name))?;
    let scales = scales(&set)?;
    let record_of = |member: &Member, scale: Option<f64>, mut table: Table| {
        table.insert("name", entry(text_of(&set.name)));
        table.insert(member.key, entry(member.files.clone()));
        if let Some(scale) = scale {
            let span = set.scales.as_ref().map_or(0..0, At::span);
            let factor = Value::Float(scale);
            table.insert(
                "factor",
                entry(Node {
                    value: factor,
                    span,
                }),
            );
        }
        Node::table(set.name.span(), table)
    };
    let first = record_of(&members[0], scales[0], of_records);
    checked(&first)?;
    push(root, "record", first);
    let mut cases = Vec::new();
    for member in &members {
        for &scale in &scales {
            let case = match scale {
                Some(scale) => format!("{}-x{scale}", *member.name),
                None => member.name.to_string(),
            };
            let span = member.name.span();
            let record = record_of(member, scale, Table::default());
            let mut table = Table::default();
            table.insert("name", entry(text_of(&At::new(case.clone(), span.clone()))));
            let value = Value::List(vec![record]);
            table.insert(
                "record",
                entry(Node {
                    value,
                    span: span.clone(),
                }),
            );
            push(root, "case", Node::table(span, table));
            cases.push(RecordCase::new(
                case,
                member.name.as_str(),
                scale.unwrap_or(1.0),
            ));
        }
    }
    Ok(cases)
}

/// Scales of a set, rising; none for records as they are.
fn scales(set: &RecordSet) -> Result<Vec<Option<f64>>, Fault> {
    let Some(given) = &set.scales else {
        return Ok(vec![None]);
    };
    let mut scales: Vec<f64> = given.iter().map(|scale| scale.get()).collect();
    scales.sort_by(f64::total_cmp);
    if scales.is_empty() {
        return Err(none(given.span(), "no scale"));
    }
    if scales.windows(2).any(|pair| pair[0] == pair[1]) {
        let list = "scales".into();
        return Err(Fault::new(given.span(), Problem::SameEntry { list }));
    }
    Ok(scales.into_iter().map(Some).collect())
}

/// Records of a set, in their order; at least one.
fn members(set: &RecordSet, folder: &Path) -> Result<Vec<Member>, Fault> {
    if let (Some(ending), None) = (&set.ending, &set.folder) {
        let key = "folder".into();
        return Err(Fault::new(ending.span(), Problem::MissingKey { key }));
    }
    let (members, span): (Vec<Member>, _) = match (&set.folder, &set.files, &set.components) {
        (Some(own), None, None) => {
            let files = files_in(own, set.ending.as_ref(), folder)?;
            let members = files.iter().map(Member::of_file);
            (members.collect(), own.span())
        }
        (None, Some(files), None) => (files.iter().map(Member::of_file).collect(), files.span()),
        (None, None, Some(stations)) => {
            let members = stations.iter().map(Member::of_components);
            (members.collect::<Result<_, _>>()?, stations.span())
        }
        (of_folder, files, components) => {
            let given = [of_folder.is_some(), files.is_some(), components.is_some()];
            let found = given.into_iter().filter(|given| *given).count();
            let keys = &["folder", "files", "components"];
            return Err(Fault::new(set.name.span(), Problem::OneOf { keys, found }));
        }
    };
    if members.is_empty() {
        return Err(none(span, "no record"));
    }
    unique(
        "record of the set",
        members.iter().map(|member| &member.name),
    )?;
    Ok(members)
}

/// Files of a folder, relative to that of the scene, in the order of their names.
fn files_in(
    own: &At<PathBuf>,
    ending: Option<&At<String>>,
    folder: &Path,
) -> Result<Vec<At<PathBuf>>, Fault> {
    let path = folder.join(&**own);
    let refused = |error: &dyn core::fmt::Display| {
        Fault::refused(own.span(), format!("{}: {error}", path.display()))
    };
    let mut names = Vec::new();
    for found in std::fs::read_dir(&path).map_err(|error| refused(&error))? {
        let found = found.map_err(|error| refused(&error))?;
        // A link counts as what it leads to.
        let is_file = found.path().is_file();
        let name = found.file_name().into_string();
        let name = name.map_err(|name| refused(&format!("the name {name:?} is not in UTF-8")))?;
        let is_record = ending.is_none_or(|ending| name.ends_with(ending.as_str()));
        if is_file && is_record && !name.starts_with('.') {
            names.push(name);
        }
    }
    names.sort_unstable();
    let file = |name: String| At::new(own.join(name), own.span());
    Ok(names.into_iter().map(file).collect())
}

impl Member {
    fn of_file(file: &At<PathBuf>) -> Self {
        Self {
            name: stem(file),
            key: "file",
            files: path_of(file),
        }
    }

    fn of_components(station: &At<SetComponents>) -> Result<Self, Fault> {
        let files = [("x", &station.x), ("y", &station.y), ("z", &station.z)];
        let given = files
            .iter()
            .filter_map(|(key, file)| Some((*key, file.as_ref()?)));
        let Some((_, first)) = given.clone().next() else {
            let key = "x".into();
            return Err(Fault::new(station.span(), Problem::MissingKey { key }));
        };
        let mut table = Table::default();
        for (key, file) in given {
            table.insert(key, entry(path_of(file)));
        }
        Ok(Self {
            name: station.name.clone().unwrap_or_else(|| stem(first)),
            key: "components",
            files: Node::table(station.span(), table),
        })
    }
}

/// Name of a file without its folder and ending.
fn stem(file: &At<PathBuf>) -> At<String> {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    At::new(name.into_owned(), file.span())
}

fn path_of(file: &At<PathBuf>) -> Node {
    text_of(&At::new(file.to_string_lossy().into_owned(), file.span()))
}

fn text_of(text: &At<String>) -> Node {
    Node {
        value: Value::Text(text.to_string()),
        span: text.span(),
    }
}

/// A value under a key with the byte range of the value.
fn entry(node: Node) -> Entry {
    let key = node.span.clone();
    Entry { key, node }
}

/// Adds a table to a list of a scene, which is made if there is none.
fn push(root: &mut Table, list: &str, table: Node) {
    if root.get(list).is_none() {
        let span = table.span.clone();
        let value = Value::List(Vec::new());
        root.insert(list, entry(Node { value, span }));
    }
    if let Some(Node {
        value: Value::List(tables),
        ..
    }) = root.get_mut(list)
    {
        tables.push(table);
    }
}

/// Checks the keys of a record of a set, which are those of the set.
fn checked(record: &Node) -> Result<(), Fault> {
    let mut record = record.clone();
    decode::tag_tables(&mut record)?;
    let read = record.read::<Record>();
    read.map(|_| ())
        .map_err(|fault| fault.with_permitted(&KEYS))
}

fn unique<'n>(
    what: &'static str,
    names: impl Iterator<Item = &'n At<String>> + Clone,
) -> Result<(), Fault> {
    for (index, name) in names.clone().enumerate() {
        if names.clone().take(index).any(|other| other == name) {
            return Err(name.duplicate(what));
        }
    }
    Ok(())
}

fn none(span: Range<usize>, found: &str) -> Fault {
    let (found, expected) = (found.into(), "one or more".into());
    Fault::new(span, Problem::Value { found, expected })
}

/// Adds the keys of records to the schema of a set.
fn add_keys_of_records(schema: &mut Schema) {
    let mut record = Record::json_schema(&mut SchemaGenerator::default());
    let own = record.get_mut("properties").map(Json::take);
    let set = schema.get_mut("properties").and_then(Json::as_object_mut);
    if let (Some(Json::Object(own)), Some(set)) = (own, set) {
        for (key, value) in own {
            if !OF_ONE.contains(&key.as_str()) {
                set.entry(key).or_insert(value);
            }
        }
    }
    if let Some(required) = schema.get_mut("required").and_then(Json::as_array_mut) {
        required.push("convention".into());
    }
}
