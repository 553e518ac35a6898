//! Pictures and animations of a field.

use std::path::Path;

use powerhouse::io::{
    AnimationFile, ColourMap, Deformation, Picture, PictureField, PictureView, SectionPlane,
    VtuGrid, colour_range, shown_number, shown_unit, write_picture,
};
use powerhouse::model::Vec3;

use super::{FieldQuantity, RecordedFields, ScalarField};
use powerhouse_study::StudyError;

/// Field of the displacements by which a body is drawn deformed.
const DISPLACEMENT: &str = "displacement";
/// Greatest displacement of a body that is drawn with an automatic factor, over its diagonal (1).
const DRAWN: f64 = 0.05;

/// Difference of the ends of a field of integers from which colours are a scale, as those of reals, in place of one for each.
const MOST_KINDS: f64 = 8.0;
/// Distance over the size of the body below which a centroid counts as in a plane (1).
const ROUNDING: f64 = 1e-12;

/// Factor by which displacements are magnified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeformationFactor {
    /// A number.
    Factor(f64),
    /// The round number (1, 2 or 5 times a power of ten) with which the greatest displacement is drawn as at most a
    /// twentieth of the diagonal of the body.
    Automatic,
}

/// Picture of a quantity on the body, or on some of its element sets.
#[derive(Clone, Debug)]
pub struct FieldPicture {
    /// Quantity that colours the picture.
    pub quantity: FieldQuantity,
    /// Element sets that are drawn; all if there are none.
    pub sets: Vec<String>,
    /// Factor of the displacements by which the body is drawn deformed, relative to the mean motion of what is drawn; `None`:
    /// not deformed.
    pub deformation: Option<DeformationFactor>,
    /// Direction of view, away from the viewer; by default straight on of a slice, otherwise from above and aside.
    pub view: Option<Vec3>,
    /// Plane that cuts the body open, whichever way its normal points: elements with their centroid on the viewer's side are
    /// not drawn. By default it is in the middle of a body that is no slice, across the view or, from above and aside, across y.
    pub cut: Option<SectionPlane>,
    /// Whether the body is drawn whole, without a cut.
    pub whole: bool,
    /// Numbers at the ends of the colours, in the unit of the picture; by default the least and greatest, without single
    /// spikes.
    pub range: Option<[f64; 2]>,
    /// Width and height (pixels).
    pub size: [u32; 2],
}

/// Instants of an animation, and the time for which each is shown (s).
#[derive(Clone, Debug)]
pub struct Animation {
    /// Indices of the instants.
    pub instants: Vec<usize>,
    /// Time for which a picture is shown (s).
    pub seconds: f64,
}

/// What one instant shows.
struct Instant {
    grid: VtuGrid,
    /// Values in the unit of the picture, zero where nothing is drawn.
    field: ScalarField,
    /// Elements that are drawn.
    drawn: Vec<bool>,
    /// These elements, and their nodes.
    elements: Vec<u32>,
    nodes: Vec<u32>,
    view: PictureView,
    /// Plane behind which the elements are, if there is one.
    cut: Option<SectionPlane>,
    /// Displacements relative to the mean motion of these nodes (m); empty if the body is not drawn deformed.
    displacement: Vec<Vec3>,
}

/// What all pictures have in common.
#[derive(Clone, Copy)]
struct Common {
    /// Ends of the colours, and whether numbers are beyond them.
    colours: ([f64; 2], bool),
    /// Least and greatest number.
    values: [f64; 2],
    /// Factor of the displacements.
    factor: f64,
    extents: [Vec3; 2],
}

impl FieldPicture {
    /// Picture of a quantity, 1200 by 900 pixels, with everything else by default.
    pub fn new(quantity: impl Into<String>) -> Self {
        Self {
            quantity: FieldQuantity(quantity.into()),
            sets: Vec::new(),
            deformation: None,
            view: None,
            cut: None,
            whole: false,
            range: None,
            size: [1200, 900],
        }
    }

    /// Writes the picture of an instant (PNG).
    ///
    /// # Errors
    /// [`StudyError::NoSuchField`], [`StudyError::NothingDrawn`], element sets that the mesh does not have; files that cannot
    /// be read or written.
    pub fn write(
        &self,
        fields: &RecordedFields,
        index: usize,
        file: &Path,
    ) -> Result<(), StudyError> {
        let instant = self.instant(fields, index)?;
        let common = self.common(std::iter::once(Ok(Seen::of(&instant))))?;
        self.with_picture(fields, &instant, common, |picture| {
            write_picture(file, picture).map_err(powerhouse::Error::from)
        })
    }

    /// Writes an animation (PNG of several pictures) with one scale of colours, of lengths and of displacements.
    ///
    /// Files are read twice: once for the scales, once for the pictures.
    ///
    /// # Errors
    /// As [`write`](Self::write); a number of instants or a time outside its range.
    pub fn animate(
        &self,
        fields: &RecordedFields,
        animation: &Animation,
        file: &Path,
    ) -> Result<(), StudyError> {
        let instants = &animation.instants;
        let mut output = AnimationFile::new(file, instants.len(), animation.seconds)
            .map_err(powerhouse::Error::from)?;
        let seen = instants
            .iter()
            .map(|index| Ok(Seen::of(&self.instant(fields, *index)?)));
        let common = self.common(seen)?;
        for index in instants {
            let instant = self.instant(fields, *index)?;
            self.with_picture(fields, &instant, common, |picture| {
                output.add(picture).map_err(powerhouse::Error::from)
            })?;
        }
        Ok(())
    }

    /// Reads what an instant shows.
    fn instant(&self, fields: &RecordedFields, index: usize) -> Result<Instant, StudyError> {
        let file = fields.file(index);
        let grid = fields.read(index)?;
        let mut field = self.quantity.of(&grid, file)?;
        let mut drawn = vec![self.sets.is_empty(); grid.mesh.element_count()];
        for set in &self.sets {
            for &element in grid.mesh.element_set(set)? {
                drawn[element as usize] = true;
            }
        }
        if let Some(present) = &grid.present {
            let present = drawn.iter_mut().zip(present);
            present.for_each(|(drawn, is_there)| *drawn &= is_there);
        }
        let (elements, nodes) = nodes_of(&grid, &drawn);
        let body = corners(&grid, &nodes);
        let centroids: Vec<Vec3> = (elements.iter())
            .map(|&element| grid.mesh.centroid(element))
            .collect();
        let (view, cut) = self.view_into(body, &centroids);
        if let Some(SectionPlane { point, normal }) = &self.cut {
            let (centre, half) = ((body[0] + body[1]) / 2.0, (body[1] - body[0]) / 2.0);
            let (at, middle) = (point.dot(normal), centre.dot(normal));
            let reach = half.dot(&normal.abs());
            let (low, high) = (middle - reach, middle + reach);
            if !elements.is_empty() && !(low..=high).contains(&at) {
                let extent = [low, high];
                return Err(StudyError::CutOutside { at, extent });
            }
        }
        let is_empty = elements.is_empty();
        if let Some(plane) = &cut {
            let slack = ROUNDING * (body[1] - body[0]).norm();
            for element in elements {
                let beyond = (grid.mesh.centroid(element) - plane.point).dot(&plane.normal);
                drawn[element as usize] = beyond <= slack;
            }
        }
        let (elements, nodes) = nodes_of(&grid, &drawn);
        if elements.is_empty() {
            return Err(StudyError::NothingDrawn {
                file: file.into(),
                extents: (!is_empty).then_some(body.map(Into::into)),
            });
        }
        let shown = if field.is_nodal { &nodes } else { &elements };
        let (_, factor) = shown_unit(&field.unit);
        let mut values = vec![0.0; field.values.len()];
        for &index in shown {
            values[index as usize] = factor * field.values[index as usize];
        }
        field.values = values;
        let displacement = match self.deformation {
            None => Vec::new(),
            Some(_) => relative_displacement(&grid, &nodes)
                .ok_or_else(|| StudyError::NoDisplacement { file: file.into() })?,
        };
        Ok(Instant {
            grid,
            field,
            drawn,
            elements,
            nodes,
            view,
            cut,
            displacement,
        })
    }

    /// View of a body of a box (m) with the centroids of its elements, and the plane that cuts it, with its normal towards
    /// the viewer.
    fn view_into(
        &self,
        body: [Vec3; 2],
        centroids: &[Vec3],
    ) -> (PictureView, Option<SectionPlane>) {
        let (mut view, mut cut) = PictureView::into_body(body, centroids);
        if let Some(direction) = self.view {
            view = PictureView::along(direction);
            cut = cut.map(|plane| SectionPlane {
                normal: direction,
                ..plane
            });
        }
        if self.whole || self.cut.is_some() {
            cut = self.cut;
        }
        let towards_viewer = |plane: SectionPlane| SectionPlane {
            normal: if plane.normal.dot(&view.direction) > 0.0 {
                -plane.normal
            } else {
                plane.normal
            },
            ..plane
        };
        (view, cut.map(towards_viewer))
    }

    /// Scales of colours, displacements and lengths for all instants.
    fn common(
        &self,
        mut all: impl Iterator<Item = Result<Seen, StudyError>>,
    ) -> Result<Common, StudyError> {
        let Seen {
            colours: [low, high],
            values: [least, most],
            corners: [lower, upper],
            moved,
        } = all.try_fold(Seen::NONE, |seen, next| next.map(|next| seen.and(&next)))?;
        let factor = match self.deformation {
            None => 0.0,
            Some(DeformationFactor::Factor(factor)) => factor,
            Some(DeformationFactor::Automatic) => {
                round_below(DRAWN * (upper - lower).norm() / moved)
            }
        };
        let margin = Vec3::repeat(factor.abs() * moved);
        // Numbers of both signs have colours that are symmetric about zero.
        let size = low.abs().max(high);
        let by_default = if low < 0.0 && high > 0.0 {
            [-size, size]
        } else {
            [low, high]
        };
        let [low, high] = self.range.unwrap_or(by_default);
        Ok(Common {
            colours: ([low, high], least < low || most > high),
            values: [least, most],
            factor,
            extents: [lower - margin, upper + margin],
        })
    }

    /// Passes the picture of an instant on.
    fn with_picture(
        &self,
        fields: &RecordedFields,
        instant: &Instant,
        Common {
            colours: (range, is_cut),
            values: [first, last],
            factor,
            extents,
        }: Common,
        draw: impl FnOnce(&Picture) -> Result<(), powerhouse::Error>,
    ) -> Result<(), StudyError> {
        let Instant {
            grid,
            field,
            drawn,
            view,
            cut,
            displacement,
            ..
        } = instant;
        // Few integers have a colour each; fractions between them mean nothing.
        // Numbers from 0 up have the same colours in all pictures.
        let lowest = first.min(0.0);
        let has_kinds = field.is_whole && self.range.is_none() && last - lowest < MOST_KINDS;
        let from = if has_kinds { lowest } else { 0.0 };
        let numbers: Vec<f64> = field.values.iter().map(|value| value - from).collect();
        let content = if field.is_nodal {
            PictureField::Nodal(&numbers)
        } else {
            PictureField::Elemental(&numbers)
        };
        let kinds = 0..if has_kinds {
            (last - lowest) as u32 + 1
        } else {
            0
        };
        let kinds: Vec<String> = kinds
            .map(|kind| (from + f64::from(kind)).to_string())
            .collect();
        let kinds: Vec<&str> = kinds.iter().map(String::as_str).collect();
        let (unit, _) = shown_unit(&field.unit);
        let mut picture = Picture::new(&grid.mesh, content, unit);
        picture.names = &kinds;
        picture.present = Some(drawn);
        [picture.width, picture.height] = self.size;
        picture.view = *view;
        picture.range = Some(range);
        if range[0] < 0.0 && range[1] > 0.0 {
            picture.colours = ColourMap::BlueRed;
        }
        let time = grid
            .time
            .map(|time| format!(" at {} s", shown_number(time)));
        let [least, most] = spread(instant.values()).map(shown_number);
        let mut title = format!(
            "{}\n{}{}: {least} to {most} {unit}",
            fields.title(),
            self.quantity,
            time.unwrap_or_default(),
        );
        title.truncate(title.trim_end().len());
        if is_cut && !has_kinds {
            let [low, high] = range.map(shown_number);
            title += &format!(", colours from {low} to {high}");
        }
        let mut notes = Vec::new();
        if !self.sets.is_empty() {
            notes.push(self.sets.join(", "));
        }
        if let Some(plane) = cut {
            notes.push(format!("cut at {}", place(plane)));
        }
        if self.deformation.is_some() {
            notes.push(format!(
                "deformed {} times, relative to the mean motion",
                shown_number(factor)
            ));
            picture.deformation = Some(Deformation {
                displacement,
                factor,
            });
            picture.extents = Some(extents);
        }
        if !notes.is_empty() {
            title += &format!("\n{}", notes.join("; "));
        }
        picture.title = title;
        Ok(draw(&picture)?)
    }
}

impl Instant {
    /// Numbers that are drawn.
    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let shown = if self.field.is_nodal {
            &self.nodes
        } else {
            &self.elements
        };
        shown.iter().map(|&index| self.field.values[index as usize])
    }
}

/// Ranges of what one or more instants show.
#[derive(Clone, Copy)]
struct Seen {
    /// Ends of the colours.
    colours: [f64; 2],
    /// Least and greatest number.
    values: [f64; 2],
    /// Lower and upper corner of the body (m).
    corners: [Vec3; 2],
    /// Greatest displacement relative to the mean motion (m).
    moved: f64,
}

impl Seen {
    /// Ranges of no instant.
    const NONE: Self = Self {
        colours: [f64::INFINITY, f64::NEG_INFINITY],
        values: [f64::INFINITY, f64::NEG_INFINITY],
        corners: [
            Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
            Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
        ],
        moved: 0.0,
    };

    fn of(instant: &Instant) -> Self {
        let numbers: Vec<f64> = instant.values().collect();
        let spread = spread(numbers.iter().copied());
        let moved = instant
            .nodes
            .iter()
            .filter_map(|&node| instant.displacement.get(node as usize));
        Self {
            colours: colour_range(&numbers).unwrap_or(spread),
            values: spread,
            corners: corners(&instant.grid, &instant.nodes),
            moved: moved.fold(0.0, |most, u| u.norm().max(most)),
        }
    }

    fn and(&self, other: &Self) -> Self {
        let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            colours: wider(self.colours, other.colours),
            values: wider(self.values, other.values),
            corners: [
                self.corners[0].inf(&other.corners[0]),
                self.corners[1].sup(&other.corners[1]),
            ],
            moved: self.moved.max(other.moved),
        }
    }
}

/// Displacements less their mean over some nodes (m); `None` without the field.
fn relative_displacement(grid: &VtuGrid, nodes: &[u32]) -> Option<Vec<Vec3>> {
    let field = grid
        .at_nodes
        .iter()
        .find(|f| f.name == DISPLACEMENT && f.components == 3)?;
    let (vectors, _) = field.values.as_chunks::<3>();
    let mean = nodes
        .iter()
        .map(|&node| Vec3::from(vectors[node as usize]))
        .sum::<Vec3>();
    let mean = mean / nodes.len().max(1) as f64;
    Some(
        vectors
            .iter()
            .map(|vector| Vec3::from(*vector) - mean)
            .collect(),
    )
}

/// Least and greatest of some numbers.
fn spread(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    })
}

/// Elements with a flag, and their nodes.
fn nodes_of(grid: &VtuGrid, flags: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let flagged = (0..).zip(flags).filter(|(_, flag)| **flag);
    let elements: Vec<u32> = flagged.map(|(element, _)| element).collect();
    let nodes = grid.mesh.nodes_of_elements(&elements);
    (elements, nodes)
}

/// Where a plane is, as a text.
fn place(plane: &SectionPlane) -> String {
    let normal = plane.normal.normalize();
    let axis = (0..3).find(|&axis| normal[axis].abs() > 1.0 - ROUNDING);
    match axis {
        Some(axis) => {
            let name = ["x", "y", "z"][axis];
            format!("{name} = {} m", shown_number(plane.point[axis]))
        }
        None => {
            let [x, y, z] = [plane.point.x, plane.point.y, plane.point.z].map(shown_number);
            format!("{x}, {y}, {z} m")
        }
    }
}

/// Lower and upper corner of some nodes (m).
fn corners(grid: &VtuGrid, nodes: &[u32]) -> [Vec3; 2] {
    let infinite = Vec3::repeat(f64::INFINITY);
    let positions = nodes
        .iter()
        .map(|&node| grid.mesh.positions()[node as usize]);
    let (low, high) = positions.fold((infinite, -infinite), |(low, high), p| {
        (low.inf(&p), high.sup(&p))
    });
    [low, high]
}

/// Greatest of 1, 2 and 5 times a power of ten that is not above a number; 1 for a number that is not finite or not positive.
fn round_below(number: f64) -> f64 {
    if !number.is_finite() || number <= 0.0 {
        return 1.0;
    }
    let power = 10_f64.powf(number.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|digit| digit * power);
    // The logarithm of a power of ten may be rounded up.
    steps
        .into_iter()
        .find(|step| *step <= number)
        .unwrap_or(0.5 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors are round numbers that are not above the given one, over all magnitudes.
    #[test]
    fn factors_are_round() {
        for (number, round) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (2.0, 2.0),
            (734.0, 500.0),
            (0.061, 0.05),
        ] {
            assert!(
                (round_below(number) / round - 1.0).abs() < 1e-12,
                "{number}"
            );
        }
        for number in [0.0, f64::INFINITY, f64::NAN] {
            assert_eq!(round_below(number), 1.0);
        }
    }
}
