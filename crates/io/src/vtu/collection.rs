//! A time series of VTU files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::writer::{VtuField, VtuWriter};
use crate::xml::escaped;
use crate::{IoError, write_whole};

/// A PVD file and the VTU files beside it. The PVD is written anew, whole, after every instant, so
/// that a run which is cut short leaves a series that opens.
pub struct PvdCollection {
    file: PathBuf,
    writer: VtuWriter,
    instants: Vec<(f64, String)>,
}

impl PvdCollection {
    /// Starts a series whose collection file is `file` (such as `out/snapshots.pvd`); its instants
    /// go to a folder of the same name without the ending.
    pub fn new(file: impl Into<PathBuf>, writer: VtuWriter) -> Self {
        Self {
            file: file.into(),
            writer,
            instants: Vec::new(),
        }
    }

    /// The collection file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// How many instants have been written.
    pub fn len(&self) -> usize {
        self.instants.len()
    }

    /// Whether no instant has been written.
    pub fn is_empty(&self) -> bool {
        self.instants.is_empty()
    }

    /// Writes one instant at a time (s).
    ///
    /// # Errors
    /// As [`VtuWriter::write`].
    pub fn add(
        &mut self,
        time: f64,
        at_nodes: &[VtuField],
        in_elements: &[VtuField],
    ) -> Result<(), IoError> {
        let folder = self.file.with_extension("");
        let stem = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let name = format!("{stem}/{stem}_{:05}.vtu", self.instants.len());
        let instant = self.file.with_file_name(&name);
        self.writer.write(&instant, time, at_nodes, in_elements)?;
        self.instants.push((time, name));
        write_whole(&self.file, self.text().as_bytes())
    }

    fn text(&self) -> String {
        let mut text = String::from(concat!(
            r#"<?xml version="1.0"?>"#,
            "\n",
            r#"<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">"#,
            "\n<Collection>\n"
        ));
        for (time, name) in &self.instants {
            let _ = writeln!(
                text,
                r#"<DataSet timestep="{time}" group="" part="0" file="{}"/>"#,
                escaped(name)
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        text
    }
}
