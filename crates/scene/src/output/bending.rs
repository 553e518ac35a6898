//! Warning about bending moments of sections through bricks that are too coarse for them.

use core::fmt;

use powerhouse_model::{
    BlockOptions, BlockPart, ElementKind, Mesh, NodalView, NodalViewMut, Operator, Quad, Vec3,
};
use powerhouse_observe::SectionGeometry;

use super::SectionRequest;
use crate::remark::{Kind, described};
use crate::{Kernel, Part, Remark, Topic, remark};

/// Error of the bending stiffness of a section through bricks, from their size and kernel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BendingError {
    /// Name of the section.
    pub section: String,
    /// Element set that it cuts.
    pub set: String,
    /// Kernel of the bricks.
    pub kernel: String,
    /// Median extent (m) of the bricks along the section's normal.
    pub length: f64,
    /// Extent (m) of the section across, such as the thickness of a lining.
    pub thickness: f64,
    /// Number of bricks across.
    pub layers: usize,
    /// Elastic bending stiffness of the bricks over that of the exact beam.
    pub factor: f64,
}

/// Length of bricks of full integration over the thickness of a section at which shear makes it 8 % too stiff in bending.
const LONGEST_OF_FULL: f64 = 0.45;
/// The same of bricks of one point, with their hourglass resistance.
const LONGEST_OF_ONE_POINT: f64 = 0.7;
/// Number of bricks of one point with elastic bending across a section from which on its moment is about that of a plastic
/// hinge: the excess falls with its square, from 1.7 times the moment with one brick.
const LAYERS_OF_A_HINGE: usize = 4;

impl BendingError {
    /// Largest error of the bending stiffness without a warning.
    pub const LIMIT: f64 = 0.1;
}

described!(BendingError, |_| Kind::Warning(Topic::Sections));

impl fmt::Display for BendingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            section,
            set,
            kernel,
            length,
            thickness,
            layers,
            factor,
        } = self;
        let verb = if *factor > 1.0 {
            "too stiff"
        } else {
            "too soft"
        };
        write!(
            f,
            "section '{section}' cuts bricks of '{set}' that are {verb} in bending: {length:.2} m long with {layers} across {thickness:.2} m, kernel '{kernel}', have {factor:.2} times the bending stiffness; where the ground imposes the curvature its moments err by about as much, axial forces do not. Within 10 % are bricks of 'hex8-natural', straight ones of any length, of 'hex8-full' at most {:.3} m long, of 'hex8-b-bar' the same with at least 3 across, and of 'hex8-one-point' at most {:.3} m long with at least 4 across",
            LONGEST_OF_FULL * thickness,
            LONGEST_OF_ONE_POINT * thickness
        )
    }
}

/// Warning about a section through bricks whose bending stiffness errs by more than [`BendingError::LIMIT`], or that form no
/// plastic hinge.
pub(crate) fn coarse_in_bending(
    mesh: &Mesh,
    request: &SectionRequest,
    geometry: &SectionGeometry,
    parts: &[Part],
) -> Option<Remark> {
    let [piece] = &geometry.pieces[..] else {
        return None;
    };
    // Of a frame or a ring the extents are not those of a wall.
    if super::sections::hollow(request, geometry).is_some() {
        return None;
    }
    let part = parts.iter().find(|part| part.set == request.set)?;
    let bricks = piece.elements.iter();
    if bricks.clone().any(|&e| mesh.kind(e) != ElementKind::Hex8) {
        return None;
    }
    let kernel = part.kernel_for(ElementKind::Hex8)?;
    let extent = |direction: &Vec3| median(bricks.clone().map(|&e| extent_of(mesh, e, direction)));
    let length = extent(&geometry.normal)?;
    let layers = (piece.depth / extent(&geometry.across)?).round().max(1.0) as usize;
    if kernel.bends_as_its_material() {
        let is_elastic = part.material.is_linear() || kernel.points() > 1;
        return (!is_elastic && layers < LAYERS_OF_A_HINGE).then(|| {
            Remark::from(remark::Hinge {
                section: request.cut.name.clone(),
                set: request.set.clone(),
                kernel: kernel.name().into(),
                layers,
            })
        });
    }
    let width = extent(&geometry.along)?;
    let size = [length / piece.depth, width / piece.depth];
    let factor = bending_stiffness(&kernel, part, size, layers)?;
    ((factor - 1.0).abs() > BendingError::LIMIT).then(|| {
        Remark::Bending(BendingError {
            section: request.cut.name.clone(),
            set: request.set.clone(),
            kernel: kernel.name().into(),
            length,
            thickness: piece.depth,
            layers,
            factor,
        })
    })
}

/// Extent (m) of an element along a direction.
fn extent_of(mesh: &Mesh, element: u32, direction: &Vec3) -> f64 {
    let nodes = mesh.nodes_of(element).iter();
    let along = nodes.map(|&node| mesh.positions()[node as usize].dot(direction));
    let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    high - low
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().filter(|&v| v > 0.0)
}

/// Elastic bending stiffness of `layers` bricks across a beam of unit thickness, of a length and a width, over that of the
/// beam: the energy of the nodal displacements `u_x = x z` of a unit curvature, which a brick can only follow by shearing,
/// or against its hourglass resistance. Strains across the beam are held in both.
fn bending_stiffness(
    kernel: &Kernel,
    part: &Part,
    [length, width]: [f64; 2],
    layers: usize,
) -> Option<f64> {
    const LAYERS: usize = 64;
    let low = Vec3::new(-0.5 * length, -0.5 * width, -0.5);
    let cells = [1, 1, layers.min(LAYERS)];
    let beam = Mesh::box_of_hexes(low, -low, cells, &part.set).ok()?;
    let elements: Vec<u32> = (0..beam.element_count() as u32).collect();
    let nodes: Vec<u32> = (0..beam.node_count() as u32).collect();
    let elastic = part.material.elastic();
    let factory = kernel.factory(&part.set, &elastic, BlockOptions::default());
    let block = factory
        .build(&BlockPart::new(&beam, &elements, &nodes))
        .ok()?;
    let bent = |x: &Vec3| Quad::from_vector(&Vec3::new(x.x * x.z, 0.0, 0.0));
    let displacement: Vec<Quad<f64>> = beam.positions().iter().map(bent).collect();
    let mut forces = vec![Quad::default(); nodes.len()];
    block.apply(
        Operator::Elastic,
        NodalView::F64(&displacement),
        NodalViewMut::F64(&mut forces),
    );
    let work = displacement.iter().zip(&forces);
    let work: f64 = work.map(|(u, f)| u.to_vector().dot(&f.to_vector())).sum();
    let exact = elastic.medium().constrained() * length * width / 12.0;
    Some(work / exact)
}
