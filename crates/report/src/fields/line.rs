//! Values of fields along a line.

use std::path::Path;

use powerhouse::io::{TableColumn, VtuGrid};
use powerhouse::model::{Located, Vec3};

use super::{FieldQuantity, ScalarField};
use powerhouse_study::StudyError;

/// Distance of a point from the nearest element, over the size of the body, up to which it is in it (1).
const NEAR: f64 = 1e-9;

/// Straight line, or one with corners, along which values of fields are read at equal distances.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldLine {
    /// Corners (m), two at least.
    pub corners: Vec<Vec3>,
    /// Number of points, both ends included.
    pub points: usize,
}

/// Values of fields at the points of a line.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LineTable {
    /// Distance from the start of the line (m), position (m), and a column of each quantity.
    pub columns: Vec<TableColumn>,
    /// Number of points in no active element, which are left out.
    pub outside: usize,
    /// Rows before which points are left out, but for those at the start of the line.
    pub gaps: Vec<usize>,
}

impl FieldLine {
    /// Table of quantities at the points of the line: distance from its start (m), position (m), and a column of each
    /// quantity. Of fields at nodes values are interpolated, of those in elements they are of the element around the point.
    /// Points in no active element, such as those in an opening, are left out.
    ///
    /// # Errors
    /// [`StudyError::NoSuchField`]; [`StudyError::Line`] without two distinct corners or two points, or if no point is in the
    /// body.
    pub fn table(
        &self,
        grid: &VtuGrid,
        quantities: &[FieldQuantity],
        file: &Path,
    ) -> Result<LineTable, StudyError> {
        let fault = |reason: &str| StudyError::Line {
            reason: reason.into(),
        };
        let is_finite = self
            .corners
            .iter()
            .all(|corner| corner.iter().all(|x| x.is_finite()));
        let length: f64 = self
            .corners
            .windows(2)
            .map(|ends| (ends[1] - ends[0]).norm())
            .sum();
        if !is_finite || length == 0.0 || self.points < 2 {
            return Err(fault(
                "a line needs two distinct points of finite coordinates",
            ));
        }
        let fields: Vec<ScalarField> = (quantities.iter())
            .map(|quantity| quantity.of(grid, file))
            .collect::<Result<_, _>>()?;
        let elements = 0..grid.mesh.element_count() as u32;
        let is_there = |e: &u32| {
            grid.present
                .as_ref()
                .is_none_or(|present| present[*e as usize])
        };
        let elements: Vec<u32> = elements.filter(is_there).collect();
        let (low, high) = grid.mesh.bounding_box();
        let tolerance = NEAR * (high - low).norm();
        let mut columns = vec![TableColumn::new("distance", "m", Vec::new())];
        columns.extend(["x", "y", "z"].map(|name| TableColumn::new(name, "m", Vec::new())));
        let named = quantities.iter().zip(&fields);
        columns.extend(named.map(|(quantity, field)| {
            TableColumn::new(quantity.to_string(), field.unit.clone(), Vec::new())
        }));
        let (mut outside, mut is_gap, mut gaps) = (0, false, Vec::new());
        for index in 0..self.points {
            let distance = length * index as f64 / (self.points - 1) as f64;
            let point = self.at(distance);
            let found = grid.mesh.locate_among(&elements, &[point], tolerance);
            let Some(located) = found.ok().and_then(|mut found| found.pop()) else {
                outside += 1;
                is_gap = true;
                continue;
            };
            let row = columns[0].values.len();
            if core::mem::take(&mut is_gap) && row > 0 {
                gaps.push(row);
            }
            let values = fields.iter().map(|field| value(field, &located));
            let row = [distance, point.x, point.y, point.z]
                .into_iter()
                .chain(values);
            columns
                .iter_mut()
                .zip(row)
                .for_each(|(column, value)| column.values.push(value));
        }
        if outside == self.points {
            let [low, high] = [low, high].map(<[f64; 3]>::from);
            Err(fault(&format!(
                "no point of the line is in an active element; the body is from {low:?} to {high:?} m, and may \
                     have openings"
            )))
        } else {
            Ok(LineTable {
                columns,
                outside,
                gaps,
            })
        }
    }

    /// Point at a distance from the start (m).
    fn at(&self, distance: f64) -> Vec3 {
        let mut before = 0.0;
        for ends in self.corners.windows(2) {
            let along = ends[1] - ends[0];
            let length = along.norm();
            if length > 0.0 && distance <= before + length {
                return ends[0] + along * ((distance - before) / length);
            }
            before += length;
        }
        self.corners.last().copied().unwrap_or_default()
    }
}

/// Value of a field at a place in an element.
fn value(field: &ScalarField, located: &Located) -> f64 {
    if field.is_nodal {
        located
            .interpolate(|node| Vec3::x() * field.values[node as usize])
            .x
    } else {
        field.values[located.element as usize]
    }
}
