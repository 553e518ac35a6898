//! Plots of histories, and pictures of fields on the body.

use std::path::Path;

use powerhouse_io::{
    FacetField, IoError, Picture, PictureField, PictureView, Plot, PlotCurve, PlotPanel,
    SectionPlane, TableColumn, colour_range, shown_number, shown_unit, write_picture, write_plot,
};
use powerhouse_model::{Mesh, Vec3};

use crate::joints::JointPicture;
use powerhouse_scene::{PlottedCurve, TablePlot};

/// Writes a plot of a table against its first column.
pub(crate) fn table_plot(file: &Path, title: &str, columns: &[TableColumn]) -> Result<(), IoError> {
    write_plot(file, &Plot::of_table(title, columns))
}

/// Writes the plot of a list.
pub(crate) fn list_plot(file: &Path, plot: &TablePlot) -> Result<(), IoError> {
    let [label, unit] = plot.axis.map(String::from);
    let plot = Plot {
        title: plot.title.clone(),
        label,
        unit,
        panels: (plot.panels.iter())
            .map(|([label, unit], curves)| PlotPanel {
                label: label.clone(),
                unit: unit.clone(),
                curves: (curves.iter())
                    .map(|PlottedCurve { name, x, y }| PlotCurve { name, x, y })
                    .collect(),
            })
            .collect(),
        gaps: Vec::new(),
    };
    write_plot(file, &plot)
}

/// What pictures of fields have in common.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    /// Title of the scene.
    pub(crate) title: &'a str,
    pub(crate) mesh: &'a Mesh,
    /// Active elements; none if all are.
    pub(crate) present: Option<&'a [bool]>,
    /// Time at the end of the run (s).
    pub(crate) time: f64,
}

/// Surroundings of a structure that are drawn, over its greatest extent (1).
const SURROUNDINGS: f64 = 0.25;

impl Shown<'_> {
    /// Writes a picture of a field on the active elements of the body, of a slice straight on, otherwise sectioned across y in
    /// the middle; of a box (m) alone if one is given. Single numbers far beyond all others do not stretch the colours.
    pub(crate) fn picture(
        &self,
        file: &Path,
        (name, unit): (&str, &str),
        field: PictureField,
        close_up: Option<[Vec3; 2]>,
    ) -> Result<(), IoError> {
        let (unit, factor) = shown_unit(unit);
        let scaled = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| factor * v).collect() };
        let (values, is_nodal) = match field {
            PictureField::Nodal(values) => (scaled(values), true),
            PictureField::Elemental(values) => (scaled(values), false),
            PictureField::Sets | PictureField::Facets(_) => (Vec::new(), false),
        };
        let field = if is_nodal {
            PictureField::Nodal(&values)
        } else {
            PictureField::Elemental(&values)
        };
        let (low, high) = self.mesh.bounding_box();
        let [low, high] =
            close_up.map_or([low, high], |[from, to]| [low.sup(&from), high.inf(&to)]);
        let mut picture = Picture::new(self.mesh, field, unit);
        picture.present = self.present;
        picture.close_up = close_up;
        let elements = 0..self.mesh.element_count() as u32;
        let centroids: Vec<Vec3> = match close_up {
            None => elements
                .filter(|&element| self.present.is_none_or(|present| present[element as usize]))
                .map(|element| self.mesh.centroid(element))
                .collect(),
            Some(_) => Vec::new(),
        };
        (picture.view, picture.section) = PictureView::into_body([low, high], &centroids);
        let seen = self.seen(&values, is_nodal, close_up);
        let [least, most] = ends(&seen).map(shown_number);
        let mut title = format!(
            "{}\n{name} of the run to {} s: {least} to {most} {unit}",
            self.title,
            shown_number(self.time),
        );
        title.truncate(title.trim_end().len());
        picture.range = colour_range(&seen);
        if let Some([least, most]) = picture.range {
            title.push_str(&format!(
                ", colours from {} to {}",
                shown_number(least),
                shown_number(most)
            ));
        }
        picture.title = title;
        write_picture(file, &picture)
    }

    /// Numbers of the active elements, or of their nodes, in a box.
    fn seen(&self, values: &[f64], is_nodal: bool, close_up: Option<[Vec3; 2]>) -> Vec<f64> {
        let is_shown = |element: &u32| {
            let centre = self.mesh.centroid(*element);
            self.present
                .is_none_or(|present| present[*element as usize])
                && close_up.is_none_or(|[low, high]| {
                    (0..3).all(|axis| (low[axis]..=high[axis]).contains(&centre[axis]))
                })
        };
        let elements = 0..self.mesh.element_count() as u32;
        let elements: Vec<u32> = elements.filter(is_shown).collect();
        let of = |indices: &[u32]| {
            indices
                .iter()
                .map(|&index| values[index as usize])
                .collect()
        };
        if is_nodal {
            of(&self.mesh.nodes_of_elements(&elements))
        } else {
            of(&elements)
        }
    }
}

/// The least and the greatest number; zeros without numbers.
fn ends(values: &[f64]) -> [f64; 2] {
    let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of));
    [least, most].map(|end| end.unwrap_or(0.0))
}

/// Box of a structure with its surroundings (m); none if that is most of the body.
pub(crate) fn close_up(mesh: &Mesh, structure: Option<[Vec3; 2]>) -> Option<[Vec3; 2]> {
    let [low, high] = structure?;
    let around = Vec3::repeat(SURROUNDINGS * (high - low).max());
    let (low, high) = (low - around, high + around);
    let (least, most) = mesh.bounding_box();
    let seen = high.inf(&most) - low.sup(&least);
    let is_smaller = (0..3).any(|axis| seen[axis] < 0.7 * (most - least)[axis]);
    is_smaller.then_some([low, high])
}

/// Writes a picture of the facets of a joint, viewed along their mean normal; closed surfaces are sectioned across y
/// in their middle.
pub(crate) fn joint_picture(
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
    let label = if kinds.is_empty() {
        format!("{name} ({unit})")
    } else {
        (*name).to_owned()
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
