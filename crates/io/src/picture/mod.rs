//! Pictures of a mesh and a field on it, as PNG.
//!
//! A small z-buffer renderer of the surface: enough to look at a result without another program
//! and without a graphics card.

mod colour;
mod font;
mod frame;
mod raster;
mod surface;
mod view;

use std::path::Path;

use powerhouse_model::{Mesh, ParameterError, Vec3};

pub use colour::ColourMap;
use frame::Frame;
pub use view::PictureView;

use crate::{IoError, write_whole};

/// Least and greatest width and height of a picture (pixels).
const PIXELS: (f64, f64) = (64.0, 4096.0);

/// The numbers that a picture shows, in the mesh's order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PictureField<'a> {
    /// None: the elements are coloured by the element set they belong to.
    #[default]
    Sets,
    /// One number per node, interpolated between nodes.
    Nodal(&'a [f64]),
    /// One number per element.
    Elemental(&'a [f64]),
    /// Facets of their own in place of the body, such as those of a joint inside it.
    Facets(&'a FacetField),
}

/// Facets with a number at each corner, interpolated between corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacetField {
    /// Where the corners stand (m).
    pub positions: Vec<Vec3>,
    /// The corners of each facet round about, as indices into `positions`.
    pub facets: Vec<Vec<u32>>,
    /// One number per corner.
    pub values: Vec<f64>,
}

/// A plane that cuts the body open: elements or facets whose centroid lies on the side that the
/// normal points to are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// A point of the plane (m).
    pub point: Vec3,
    /// Its normal, of any length.
    pub normal: Vec3,
}

/// Displacements that move the nodes in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation<'a> {
    /// One displacement per node (m).
    pub displacement: &'a [Vec3],
    /// How many times larger than true they are drawn.
    pub factor: f64,
}

/// What a picture shows, and how.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// What colours it.
    pub field: PictureField<'a>,
    /// Stands on top of the picture; what the font does not have (it has ASCII) becomes `?`.
    pub title: String,
    /// Stands beside the colours; name and unit of the field.
    pub label: String,
    /// The numbers at the ends of the colours; none for those of what is in sight, made symmetric
    /// about zero for [`ColourMap::BlueRed`]. Numbers outside are drawn as the ends.
    pub range: Option<[f64; 2]>,
    /// Names of the numbers 0, 1, 2 ... of a field of kinds: they stand beside a colour for each,
    /// in place of a scale. None by default.
    pub names: &'a [&'a str],
    /// The colours.
    pub colours: ColourMap,
    /// Where the picture is taken from.
    pub view: PictureView,
    /// A plane that cuts the body open.
    pub section: Option<SectionPlane>,
    /// Which elements are there, one flag per element: rooms that are excavated and linings that are not cast
    /// yet are left out. None: all are.
    pub present: Option<&'a [bool]>,
    /// Displacements that move the nodes of the body.
    pub deformation: Option<Deformation<'a>>,
    /// Whether the edges of elements are drawn.
    pub edges: bool,
    /// Width (pixels), 64 to 4096.
    pub width: u32,
    /// Height (pixels), 64 to 4096.
    pub height: u32,
}

impl<'a> Picture<'a> {
    /// A picture of the whole mesh, 1200 by 900 pixels, seen from above and aside, with edges.
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
        let finite = |what: &str, place: usize, value: f64| {
            if value.is_finite() {
                Ok(())
            } else {
                let (file, what) = (file.into(), what.into());
                Err(IoError::NotFinite {
                    file,
                    what,
                    place,
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
        for (place, &value) in values.iter().enumerate() {
            finite(&self.label, place, value)?;
        }
        if let PictureField::Facets(FacetField {
            positions, facets, ..
        }) = self.field
        {
            for (place, position) in positions.iter().enumerate() {
                finite("a corner", place, position.sum())?;
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
            for (place, vector) in displacement.iter().enumerate() {
                finite("displacement", place, vector.sum() * factor)?;
            }
        }
        Ok(())
    }
}

/// Draws a picture and writes it as PNG.
///
/// # Errors
/// A setting outside its range, a field of the wrong length or with a number that is not finite,
/// a section that leaves nothing, or the operating system's error; each names the file.
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
    let mut encoder = png::Encoder::new(&mut out, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.pixels.as_flattened())?;
    writer.finish()?;
    Ok(out)
}
