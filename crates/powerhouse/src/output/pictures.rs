//! What can be looked at without another program: curves as SVG, greatest values as PNG.

use std::path::{Path, PathBuf};

use powerhouse_explicit_core::observe::EnvelopeTable;
use powerhouse_io::{
    IoError, Picture, PictureField, Plot, SectionPlane, TableColumn, write_picture, write_plot,
};
use powerhouse_model::{Mesh, Vec3};

/// Draws a plot for each place of a table, `plots/PLACE.svg`; the part of a column's name before
/// its last dot is the place.
pub(super) fn draw_histories(
    folder: &Path,
    columns: &[TableColumn],
) -> Result<Vec<PathBuf>, IoError> {
    let Some((time, others)) = columns.split_first() else {
        return Ok(Vec::new());
    };
    let place_of = |column: &TableColumn| -> String {
        let name = &column.name;
        name.rsplit_once('.')
            .map_or(name.as_str(), |(place, _)| place)
            .into()
    };
    let mut places: Vec<(String, Vec<TableColumn>)> = Vec::new();
    for column in others {
        let place = place_of(column);
        match places.iter_mut().find(|(known, _)| *known == place) {
            Some((_, columns)) => columns.push(column.clone()),
            None => places.push((place, vec![time.clone(), column.clone()])),
        }
    }
    let mut files = Vec::with_capacity(places.len());
    for (place, columns) in &places {
        let allowed = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
        let name = place.replace(|c| !allowed(c), "_");
        let file = folder.join("plots").join(format!("{name}.svg"));
        write_plot(&file, &Plot::of_table(place.as_str(), columns))?;
        files.push(file);
    }
    Ok(files)
}

/// Draws greatest displacements and principal stresses on the body, cut open across y through the
/// middle of what was tracked.
pub(super) fn draw_envelope(
    folder: &Path,
    mesh: &Mesh,
    envelope: &EnvelopeTable,
) -> Result<Vec<PathBuf>, IoError> {
    let (low, high) = mesh.bounding_box();
    let section = SectionPlane {
        point: (low + high) / 2.0,
        normal: -Vec3::y(),
    };
    let spread = |indices: &[u32], values: &[f64], count: usize| {
        let mut all = vec![0.0; count];
        for (&index, &value) in indices.iter().zip(values) {
            all[index as usize] = value;
        }
        all
    };
    let nodal = |values| spread(&envelope.nodes, values, mesh.node_count());
    let elemental = |values| spread(&envelope.elements, values, mesh.element_count());
    let fields = [
        (
            "largest displacement (m)",
            nodal(&envelope.displacement.values),
            true,
        ),
        (
            "largest acceleration (m/s2)",
            nodal(&envelope.acceleration.values),
            true,
        ),
        (
            "greatest principal stress (Pa)",
            elemental(&envelope.greatest_stress.values),
            false,
        ),
    ];
    let mut files = Vec::new();
    for (label, values, at_nodes) in &fields {
        if values.iter().all(|value| *value == 0.0) {
            continue;
        }
        let field = match at_nodes {
            true => PictureField::Nodal(values),
            false => PictureField::Elemental(values),
        };
        let mut picture = Picture::new(mesh, field, *label);
        picture.title = (*label).into();
        picture.section = Some(section);
        let name = label.split(" (").next().unwrap_or(label).replace(' ', "_");
        let file = folder.join("plots").join(format!("{name}.png"));
        write_picture(&file, &picture)?;
        files.push(file);
    }
    Ok(files)
}
