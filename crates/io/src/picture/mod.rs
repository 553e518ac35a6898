//! Pictures of a mesh and a field on it, as PNG.
//!
//! A z-buffer renderer of the surface shows a result without another program and without a graphics
//! card.

mod animation;
mod colour;
mod frame;
mod lettering;
mod raster;
mod shown;
mod surface;
mod view;

use std::path::Path;

use powerhouse_model::{Mesh, ParameterError, Vec3};

pub use animation::AnimationFile;
pub use colour::ColourMap;
use frame::Frame;
pub use shown::{colour_range, shown_number, shown_unit};
pub use view::PictureView;

use crate::{IoError, write_whole};

/// Least and greatest width and height of a picture (pixels).
const PIXELS: (f64, f64) = (64.0, 4096.0);

/// Field that colours a picture, in the order of the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PictureField<'a> {
    /// No field: the elements have the colour of their element set.
    #[default]
    Sets,
    /// One number per node, interpolated between nodes.
    Nodal(&'a [f64]),
    /// One number per element, constant in it.
    Elemental(&'a [f64]),
    /// Separate facets instead of the body, such as those of a joint inside it.
    Facets(&'a FacetField),
}

/// Facets with a number at each corner, interpolated between corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacetField {
    /// Positions of the corners (m).
    pub positions: Vec<Vec3>,
    /// Corners of each facet in order around it, as indices into `positions`.
    pub facets: Vec<Vec<u32>>,
    /// One number per corner.
    pub values: Vec<f64>,
}

/// Cutting plane of a picture: elements or facets with their centroid on the side of the normal are
/// not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// Point of the plane (m).
    pub point: Vec3,
    /// Normal of the plane, of any length.
    pub normal: Vec3,
}

/// Displacements by which a picture is drawn deformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation<'a> {
    /// One displacement per node (m).
    pub displacement: &'a [Vec3],
    /// Factor by which displacements are magnified (1).
    pub factor: f64,
}

/// Picture of a mesh with a field: content and appearance.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// Mesh that is drawn.
    pub mesh: &'a Mesh,
    /// Field that colours it.
    pub field: PictureField<'a>,
    /// Title at the top, in lines; characters other than Latin and Greek letters and signs become `?`.
    pub title: String,
    /// Label of the colour scale: name and unit of the field.
    pub label: String,
    /// Numbers at the ends of the colour scale. `None` takes the least and greatest number shown, made
    /// symmetric about zero for [`ColourMap::BlueRed`]. Numbers outside have the colours of the ends.
    pub range: Option<[f64; 2]>,
    /// Names of the numbers 0, 1, 2 ... of a field of categories: a legend with a colour for each
    /// replaces the colour scale. Empty for a field of numbers.
    pub names: &'a [&'a str],
    /// Colour map of the field.
    pub colours: ColourMap,
    /// Direction of view.
    pub view: PictureView,
    /// Cutting plane that opens the body.
    pub section: Option<SectionPlane>,
    /// Box (lower and upper corner, m) that the picture shows: elements or facets with their centroid outside are not drawn.
    pub close_up: Option<[Vec3; 2]>,
    /// Box (lower and upper corner, m) that the picture is scaled to, such as one for all pictures of an animation. `None`:
    /// what is drawn.
    pub extents: Option<[Vec3; 2]>,
    /// Active elements, one flag per element: excavated rooms and linings that are not cast yet are not
    /// drawn. `None`: all are active.
    pub present: Option<&'a [bool]>,
    /// Displacements by which the body is drawn deformed.
    pub deformation: Option<Deformation<'a>>,
    /// Whether the edges of elements are drawn.
    pub edges: bool,
    /// Width (pixels), 64 to 4096.
    pub width: u32,
    /// Height (pixels), 64 to 4096.
    pub height: u32,
}

impl<'a> Picture<'a> {
    /// Picture of the whole mesh, 1200 by 900 pixels, in a view from above and aside, with edges.
    pub fn new(mesh: &'a Mesh, field: PictureField<'a>, label: impl Into<String>) -> Self {
        Self {
            mesh,
            field,
            title: String::new(),
            label: label.into(),
            range: None,
            names: &[],
            colours: ColourMap::default(),
            view: PictureView::aslant(),
            section: None,
            close_up: None,
            extents: None,
            present: None,
            deformation: None,
            edges: true,
            width: 1200,
            height: 900,
        }
    }

    fn check(&self, file: &Path) -> Result<(), IoError> {
        let setting = |source| IoError::Setting {
            file: file.into(),
            source,
        };
        let within = |name, value, least, most| {
            ParameterError::check(name, value, least, most).map_err(setting)
        };
        within("width", f64::from(self.width), PIXELS.0, PIXELS.1)?;
        within("height", f64::from(self.height), PIXELS.0, PIXELS.1)?;
        within(
            "view.direction",
            self.view.direction.norm(),
            f64::MIN_POSITIVE,
            f64::MAX,
        )?;
        within("view.up", self.view.up.norm(), f64::MIN_POSITIVE, f64::MAX)?;
        if let Some(section) = &self.section {
            within("section.point", section.point.norm(), 0.0, f64::MAX)?;
            within(
                "section.normal",
                section.normal.norm(),
                f64::MIN_POSITIVE,
                f64::MAX,
            )?;
        }
        let boxes = [
            (["close_up.low", "close_up.high"], &self.close_up),
            (["extents.low", "extents.high"], &self.extents),
        ];
        for ([lower, upper], corners) in boxes {
            let Some([low, high]) = corners else { continue };
            for axis in 0..3 {
                within(lower, low[axis], f64::MIN, f64::MAX)?;
                within(upper, high[axis], low[axis], f64::MAX)?;
            }
        }
        if let Some([low, high]) = self.range {
            within("range.low", low, f64::MIN, f64::MAX)?;
            within("range.high", high, low, f64::MAX)?;
        }
        let length = |what: &str, found: usize, expected: usize| {
            if found == expected {
                Ok(())
            } else {
                let (file, what) = (file.into(), what.into());
                Err(IoError::Length {
                    file,
                    what,
                    found,
                    expected,
                })
            }
        };
        let finite = |what: &str, index: usize, value: f64| {
            if value.is_finite() {
                Ok(())
            } else {
                let (file, what) = (file.into(), what.into());
                Err(IoError::NotFinite {
                    file,
                    what,
                    index,
                    value,
                })
            }
        };
        if let Some(present) = self.present {
            length("present", present.len(), self.mesh.element_count())?;
        }
        let (values, expected) = match self.field {
            PictureField::Sets => (&[][..], 0),
            PictureField::Nodal(values) => (values, self.mesh.node_count()),
            PictureField::Elemental(values) => (values, self.mesh.element_count()),
            PictureField::Facets(field) => (&field.values[..], field.positions.len()),
        };
        length(&self.label, values.len(), expected)?;
        for (index, &value) in values.iter().enumerate() {
            finite(&self.label, index, value)?;
        }
        if let PictureField::Facets(FacetField {
            positions, facets, ..
        }) = self.field
        {
            for (index, position) in positions.iter().enumerate() {
                finite("a corner", index, position.sum())?;
            }
            for (facet, nodes) in facets.iter().enumerate() {
                let known = nodes.iter().all(|&node| (node as usize) < positions.len());
                if nodes.len() < 3 || !known {
                    let (file, corners) = (file.into(), positions.len());
                    return Err(IoError::Facet {
                        file,
                        facet,
                        corners,
                    });
                }
            }
        }
        if let Some(Deformation {
            displacement,
            factor,
        }) = &self.deformation
        {
            length("displacement", displacement.len(), self.mesh.node_count())?;
            within("deformation.factor", *factor, f64::MIN, f64::MAX)?;
            for (index, vector) in displacement.iter().enumerate() {
                finite("displacement", index, vector.sum() * factor)?;
            }
        }
        Ok(())
    }
}

/// Draws a picture and writes it as PNG.
///
/// # Errors
/// If a setting is outside its range, the field has the wrong length or a number that is not finite,
/// the section leaves nothing, or the file cannot be written; each names the file.
///
/// ```no_run
/// # use powerhouse_io::{Picture, PictureField, SectionPlane, write_picture};
/// # use powerhouse_model::{Mesh, Vec3};
/// # fn draw(mesh: &Mesh, peak: &[f64]) -> Result<(), powerhouse_io::IoError> {
/// let mut picture = Picture::new(mesh, PictureField::Nodal(peak), "peak velocity (m/s)");
/// picture.section = Some(SectionPlane { point: Vec3::zeros(), normal: -Vec3::y() });
/// write_picture("out/peak.png".as_ref(), &picture)
/// # }
/// ```
pub fn write_picture(file: &Path, picture: &Picture) -> Result<(), IoError> {
    picture.check(file)?;
    let Some(image) = frame::draw(picture) else {
        return Err(IoError::NothingToDraw { file: file.into() });
    };
    let png = encoded(&image).map_err(|error| {
        let source = std::io::Error::other(error);
        IoError::file(file)(source)
    })?;
    write_whole(file, &png)
}

fn encoded(image: &Frame) -> Result<Vec<u8>, png::EncodingError> {
    let mut out = Vec::new();
    let mut writer = encoder(&mut out, image).write_header()?;
    writer.write_image_data(image.pixels.as_flattened())?;
    writer.finish()?;
    Ok(out)
}

/// Encoder of pictures of the size of one.
fn encoder<W: std::io::Write>(out: W, image: &Frame) -> png::Encoder<'static, W> {
    let mut encoder = png::Encoder::new(out, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
}
