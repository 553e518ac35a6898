//! Time series of VTU files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use roxmltree::Document;

use super::writer::{VtuField, VtuWriter};
use crate::xml::escaped;
use crate::{IoError, read_whole, write_whole};

/// Greatest size of a collection file (bytes).
const MOST: u64 = 1 << 30;

/// Time series of results: a PVD file and the VTU files beside it. The PVD is written anew after every
/// instant, so that an interrupted run leaves a readable series.
pub struct PvdCollection {
    file: PathBuf,
    writer: VtuWriter,
    /// Time, part and file of each entry.
    entries: Vec<(f64, usize, String)>,
    /// Number of instants.
    instants: usize,
}

impl PvdCollection {
    /// Time series with the collection file `file` (such as `out/snapshots.pvd`); its instants are
    /// written to a folder of the same name without the extension.
    pub fn new(file: impl Into<PathBuf>, writer: VtuWriter) -> Self {
        Self {
            file: file.into(),
            writer,
            entries: Vec::new(),
            instants: 0,
        }
    }

    /// Path of the collection file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Entries written so far: time (s), part and file, from which [`restore`](Self::restore) goes on.
    pub fn entries(&self) -> &[(f64, usize, String)] {
        &self.entries
    }

    /// Goes on from a number of instants and their entries, whose files are beside the collection file.
    pub fn restore(&mut self, instants: usize, entries: Vec<(f64, usize, String)>) {
        (self.instants, self.entries) = (instants, entries);
    }

    /// Number of instants that have been written.
    pub fn len(&self) -> usize {
        self.instants
    }

    /// Whether no instant has been written.
    pub fn is_empty(&self) -> bool {
        self.instants == 0
    }

    /// Writes the fields of one instant at a time (s).
    ///
    /// # Errors
    /// As [`VtuWriter::write`].
    pub fn add(
        &mut self,
        time: f64,
        at_nodes: &[VtuField],
        in_elements: &[VtuField],
    ) -> Result<(), IoError> {
        self.add_with(time, at_nodes, in_elements, &[])
    }

    /// Writes the fields of one instant at a time (s), with further parts such as surfaces: of each the
    /// suffix of its file name, its writer, and its fields at nodes.
    ///
    /// # Errors
    /// As [`VtuWriter::write`].
    pub fn add_with(
        &mut self,
        time: f64,
        at_nodes: &[VtuField],
        in_elements: &[VtuField],
        parts: &[(&str, &VtuWriter, &[VtuField])],
    ) -> Result<(), IoError> {
        let folder = self.file.with_extension("");
        let stem = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let name = format!("{stem}/{stem}_{:05}", self.instants);
        let mut names = vec![format!("{name}.vtu")];
        let instant = self.file.with_file_name(&names[0]);
        self.writer.write(&instant, time, at_nodes, in_elements)?;
        for (part, writer, fields) in parts {
            let name = format!("{name}_{part}.vtu");
            writer.write(&self.file.with_file_name(&name), time, fields, &[])?;
            names.push(name);
        }
        let parts = names.into_iter().enumerate();
        let entries = parts.map(|(part, name)| (time, part, name));
        self.entries.extend(entries);
        self.instants += 1;
        write_whole(&self.file, self.text().as_bytes())
    }

    /// Removes entries whose files no longer exist, and writes the collection file anew if there were any.
    ///
    /// # Errors
    /// If the collection file cannot be written.
    pub fn keep_existing(&mut self) -> Result<(), IoError> {
        let before = self.entries.len();
        let file = &self.file;
        self.entries
            .retain(|(.., name)| file.with_file_name(name).exists());
        if self.entries.len() == before {
            Ok(())
        } else {
            write_whole(&self.file, self.text().as_bytes())
        }
    }

    fn text(&self) -> String {
        let mut text = String::from(concat!(
            r#"<?xml version="1.0"?>"#,
            "\n",
            r#"<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">"#,
            "\n<Collection>\n"
        ));
        for (time, part, name) in &self.entries {
            let _ = writeln!(
                text,
                r#"<DataSet timestep="{time}" group="" part="{part}" file="{}"/>"#,
                escaped(name)
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        text
    }
}

/// File of a PVD collection.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PvdEntry {
    /// Time (s).
    pub time: f64,
    /// Part of the body at this time: 0 is the body itself, others are its joints.
    pub part: usize,
    /// Path of the file, from where that of the collection begins.
    pub file: PathBuf,
}

/// Reads the list of files of a PVD collection, in the order of the file.
///
/// # Errors
/// [`IoError::File`]; [`IoError::Grid`] with the reason.
pub fn read_pvd(file: &Path) -> Result<Vec<PvdEntry>, IoError> {
    let bytes = read_whole(file, MOST).map_err(IoError::file(file))?;
    let fault = |reason: String| IoError::Grid {
        file: file.into(),
        reason,
    };
    let text = std::str::from_utf8(&bytes).map_err(|error| fault(error.to_string()))?;
    let document = Document::parse(text).map_err(|error| fault(error.to_string()))?;
    let root = document.root_element();
    if root.attribute("type") != Some("Collection") {
        return Err(fault("the file is not a collection".into()));
    }
    let mut entries = Vec::new();
    let sets = root
        .descendants()
        .filter(|node| node.has_tag_name("DataSet"));
    for (index, set) in sets.enumerate() {
        let number = |name: &str| {
            set.attribute(name)
                .and_then(|text| text.parse::<f64>().ok())
        };
        let time = number("timestep").filter(|time| time.is_finite());
        let part = set
            .attribute("part")
            .map_or(Some(0), |part| part.parse().ok());
        let (Some(time), Some(part), Some(name)) = (time, part, set.attribute("file")) else {
            let reason = format!("entry {index} lacks a time, a part or a file");
            return Err(fault(reason));
        };
        entries.push(PvdEntry {
            time,
            part,
            file: file.with_file_name(name),
        });
    }
    Ok(entries)
}
