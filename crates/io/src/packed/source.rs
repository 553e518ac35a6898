//! The mesh file from which a packed mesh was made.

use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

use crate::{IoError, file_checksum};

/// The mesh file from which a packed mesh was made, as it was then.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedSource {
    /// Path relative to the folder of the packed mesh, with `/` between its parts.
    pub name: String,
    /// Length (bytes).
    pub length: u64,
    /// Value of its checksum.
    pub checksum: u64,
}

impl PackedSource {
    /// The source of a packed mesh.
    pub(super) fn of(source: &Path, packed: &Path) -> Result<Self, IoError> {
        let found = || -> std::io::Result<Self> {
            Ok(Self {
                name: relative(source, packed)?,
                length: fs::metadata(source)?.len(),
                checksum: file_checksum(source)?.value(),
            })
        };
        found().map_err(IoError::file(source))
    }

    /// Length and checksum as numbers of 32 bits.
    pub(super) fn numbers(&self) -> [u32; 4] {
        let halves = |number: u64| [number as u32, (number >> 32) as u32];
        let ([a, b], [c, d]) = (halves(self.length), halves(self.checksum));
        [a, b, c, d]
    }

    /// The source with a name, and the numbers of its length and checksum.
    pub(super) fn read(name: &str, numbers: &[u32]) -> Option<Self> {
        let &[a, b, c, d] = numbers else {
            return None;
        };
        let whole = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        Some(Self {
            name: name.into(),
            length: whole(a, b),
            checksum: whole(c, d),
        })
    }

    /// The path of the source of a packed mesh that was written at a time, if it has changed; none if it is not there.
    pub(super) fn changed(&self, packed: &Path, written: Option<Duration>) -> Option<PathBuf> {
        let folder = packed.parent().unwrap_or(Path::new(""));
        let path = folder.join(&self.name);
        let found = fs::metadata(&path).ok()?;
        let is_newer = match (date(&found), written) {
            (Some(source), Some(packed)) => source > packed,
            _ => true,
        };
        // Its checksum would take the time that a packed mesh saves: an older file of the same length is the same.
        let has_changed = found.len() != self.length
            || (is_newer && file_checksum(&path).ok()?.value() != self.checksum);
        has_changed.then_some(path)
    }
}

/// Date of the last change of a file, as time since 1970.
pub(super) fn date(file: &fs::Metadata) -> Option<Duration> {
    file.modified().ok()?.duration_since(UNIX_EPOCH).ok()
}

/// The path of a file relative to the folder of another one.
fn relative(file: &Path, other: &Path) -> std::io::Result<String> {
    let file = file.canonicalize()?;
    let folder = match other.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize()?;
    let (file, folder): (Vec<Component>, Vec<Component>) =
        (file.components().collect(), folder.components().collect());
    let common = file.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    let up = folder[common..].iter().map(|_| "..".to_owned());
    let down = file[common..]
        .iter()
        .map(|part| part.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<String>>().join("/"))
}
