//! Plots of histories and pictures of the body.

use std::path::Path;

use powerhouse_io::{
    IoError, Picture, PictureField, Plot, SectionPlane, TableColumn, write_picture, write_plot,
};
use powerhouse_model::{Mesh, Vec3};

/// Writes a plot of a table against its first column.
pub(super) fn plot(file: &Path, title: &str, columns: &[TableColumn]) -> Result<(), IoError> {
    write_plot(file, &Plot::of_table(title, columns))
}

/// A plot for each name of a table: the columns `NAME.ux`, `NAME.uy` ... together. Each comes with
/// the name of its file and writes itself.
pub(super) fn plots(
    columns: &[TableColumn],
) -> Vec<(String, impl FnOnce(&Path) -> Result<(), IoError> + use<>)> {
    let Some((time, others)) = columns.split_first() else {
        return Vec::new();
    };
    let mut groups: Vec<(&str, Vec<TableColumn>)> = Vec::new();
    for column in others {
        let (name, component) = column.name.rsplit_once('.').unwrap_or((&column.name, ""));
        let own = TableColumn {
            name: component.into(),
            ..column.clone()
        };
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, group)) => group.push(own),
            None => groups.push((name, vec![time.clone(), own])),
        }
    }
    groups
        .into_iter()
        .filter(|(_, group)| !group[0].values.is_empty())
        .map(|(name, group)| {
            let title = name.to_owned();
            let write = move |file: &Path| plot(file, &title, &group);
            (file_name(name), write)
        })
        .collect()
}

/// A name as part of a file's name.
pub(super) fn file_name(name: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    name.chars().map(plain).collect()
}

/// Writes a picture of a field on the body, cut open across y in the middle of its box.
pub(super) fn picture(
    file: &Path,
    mesh: &Mesh,
    (name, unit): (&str, &str),
    field: PictureField,
) -> Result<(), IoError> {
    let (low, high) = mesh.bounding_box();
    let mut picture = Picture::new(mesh, field, format!("{name} ({unit})"));
    picture.section = Some(SectionPlane {
        point: (low + high) / 2.0,
        normal: -Vec3::y(),
    });
    write_picture(file, &picture)
}
