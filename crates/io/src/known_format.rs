//! Names of formats of other programs, by their content.

use std::io::Read;

/// Bytes that are searched for marks.
const HEAD: usize = 4096;

/// Name of a format of another program that a file has, if its first bytes tell.
///
/// ```
/// assert_eq!(powerhouse_io::known_format(b"CDF\x02\x00"), Some("a NetCDF file, such as Exodus"));
/// assert_eq!(powerhouse_io::known_format(b"1 2 3"), None);
/// ```
pub fn known_format(bytes: &[u8]) -> Option<&'static str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let starts = |mark: &[u8]| bytes.starts_with(mark);
    let head = &bytes[..bytes.len().min(HEAD)];
    let has = |mark: &str| head.windows(mark.len()).any(|part| part == mark.as_bytes());
    if starts(b"CDF\x01") || starts(b"CDF\x02") || starts(b"CDF\x05") {
        return Some("a NetCDF file, such as Exodus");
    }
    if starts(b"\x89HDF\r\n\x1a\n") {
        return Some(if has("INFOS_GENERALES") || has("ENS_MAA") {
            "a MED file (HDF5)"
        } else {
            "an HDF5 file, such as MED, Exodus or H5DRM"
        });
    }
    for (mark, name) in [
        (&b"PK\x03\x04"[..], "a ZIP archive"),
        (b"\x1f\x8b", "a file compressed by gzip"),
        (b"%PDF", "a PDF"),
        (b"$MeshFormat", "a Gmsh mesh"),
        (b"# vtk DataFile", "a VTK file"),
        (b"MeshVersionFormatted", "a Medit mesh"),
        (b"*KEYWORD", "an LS-DYNA file (k)"),
        (b"* FLAC3D", "a FLAC3D grid"),
        (b"*FLAC3D", "a FLAC3D grid"),
        (b"/COM,ANSYS", "an ANSYS archive (cdb)"),
        (b"/PREP7", "an ANSYS archive (cdb)"),
        (b"    -1\n", "a universal file (UNV)"),
        (b"    -1\r\n", "a universal file (UNV)"),
    ] {
        if starts(mark) {
            return Some(name);
        }
    }
    for (mark, name) in [
        ("<VTKFile", "a VTK file of XML, such as VTU"),
        ("* GRIDPOINTS", "a FLAC3D grid"),
        ("\n*KEYWORD\n", "an LS-DYNA file (k)"),
        ("\n*KEYWORD\r", "an LS-DYNA file (k)"),
        ("\nNBLOCK,", "an ANSYS archive (cdb)"),
        ("nblock,", "an ANSYS archive (cdb)"),
        ("\nBEGIN BULK", "a Nastran file (bdf)"),
        ("\nGRID*", "a Nastran file (bdf)"),
        ("\nGRID,", "a Nastran file (bdf)"),
        ("\nGRID  ", "a Nastran file (bdf)"),
        ("MeshVersionFormatted", "a Medit mesh"),
    ] {
        if has(mark) {
            return Some(name);
        }
    }
    None
}

/// Whether a file is an Abaqus input file: by its content, or by its extension `.inp` if the content has no mark.
///
/// A file that cannot be opened counts by its extension.
pub fn is_inp(file: &std::path::Path) -> bool {
    let by_name = || {
        file.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("inp"))
    };
    let mut head = Vec::new();
    let read =
        std::fs::File::open(file).and_then(|file| file.take(HEAD as u64).read_to_end(&mut head));
    if read.is_err() || known_format(&head).is_some() {
        return read.is_err() && by_name();
    }
    let start = head
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(&head)
        .trim_ascii_start();
    match start.first() {
        Some(b'*') => true,
        Some(b'$') => false,
        _ => by_name(),
    }
}
