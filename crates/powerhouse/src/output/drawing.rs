//! Plots of histories, and pictures of fields on the body.

use std::path::Path;

use powerhouse_io::{
    FacetField, IoError, Picture, PictureField, Plot, PlotCurve, PlotPanel, SectionPlane,
    TableColumn, write_picture, write_plot,
};
use powerhouse_model::{Mesh, Vec3};

use super::file_name;
use super::joints::JointPicture;

/// Writes a plot of a table against its first column.
pub(super) fn plot(file: &Path, title: &str, columns: &[TableColumn]) -> Result<(), IoError> {
    write_plot(file, &Plot::of_table(title, columns))
}

/// One plot for each name of a table, with its columns `NAME.ux`, `NAME.uy` ... Returns file names and writers.
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

/// Writes a plot of the moments against the normal forces of a section over the run, in its interaction diagram.
pub(super) fn interaction(
    file: &Path,
    section: &str,
    [axial, moments]: &[TableColumn; 2],
    forces: [&[f64]; 2],
) -> Result<(), IoError> {
    let thousands = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| 1e-3 * v).collect() };
    let [borne_axial, borne] = [&axial.values, &moments.values].map(|v| thousands(v));
    let [of_run, moment_of_run] = forces.map(thousands);
    let plot = Plot {
        title: section.into(),
        label: "N, tension positive".into(),
        unit: "kN/m".into(),
        panels: vec![PlotPanel {
            label: "M".into(),
            unit: "kN m/m".into(),
            curves: vec![
                PlotCurve {
                    name: "borne",
                    x: &borne_axial,
                    y: &borne,
                },
                PlotCurve {
                    name: "of the run",
                    x: &of_run,
                    y: &moment_of_run,
                },
            ],
        }],
    };
    write_plot(file, &plot)
}

/// Writes a picture of a field on the active elements of the body, sectioned across y in the middle of its
/// bounding box.
pub(super) fn picture(
    file: &Path,
    (mesh, present): (&Mesh, Option<&[bool]>),
    (name, unit): (&str, &str),
    field: PictureField,
) -> Result<(), IoError> {
    let (low, high) = mesh.bounding_box();
    let mut picture = Picture::new(mesh, field, format!("{name} ({unit})"));
    picture.present = present;
    picture.section = Some(SectionPlane {
        point: (low + high) / 2.0,
        normal: -Vec3::y(),
    });
    write_picture(file, &picture)
}

/// Writes a picture of the facets of a joint, viewed along their mean normal; closed surfaces are sectioned across y
/// in their middle.
pub(super) fn joint_picture(
    file: &Path,
    mesh: &Mesh,
    joint: &str,
    JointPicture {
        name,
        unit,
        kinds,
        field,
    }: &JointPicture,
) -> Result<(), IoError> {
    let label = match kinds.is_empty() {
        true => format!("{name} ({unit})"),
        false => (*name).to_owned(),
    };
    let mut picture = Picture::new(mesh, PictureField::Facets(field), label);
    picture.title = format!("joint {joint}");
    picture.names = kinds;
    match face(field) {
        Some(normal) => {
            let aslant = picture.view.direction.normalize();
            let away = if normal.dot(&aslant) < 0.0 {
                -normal
            } else {
                normal
            };
            picture.view.direction = aslant + away;
        }
        None => {
            let corners = || field.positions.iter();
            let low = corners().fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
            let high = corners().fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
            let middle = (low + high) / 2.0;
            picture.title = format!("joint {joint}, its half beyond y = {:.4} m", middle.y);
            picture.section = Some(SectionPlane {
                point: middle,
                normal: -Vec3::y(),
            });
        }
    }
    write_picture(file, &picture)
}

/// Mean normal of facets; `None` for a closed or strongly curved surface.
fn face(field: &FacetField) -> Option<Vec3> {
    let (mut sum, mut area) = (Vec3::zeros(), 0.0);
    for facet in &field.facets {
        let corner = |index: usize| field.positions[facet[index] as usize];
        let last = facet.len() - 1;
        let normal = (corner(2) - corner(0)).cross(&(corner(last) - corner(1)));
        sum += normal;
        area += normal.norm();
    }
    (sum.norm() > 0.5 * area).then(|| sum.normalize())
}
