//! Forces and moments of sections.

mod functional;
mod polygon;

use powerhouse_model::{
    Cadence, ElasticMedium, Fields, Flow, Mesh, ModelError, Observer, ParameterError, StepView,
    Vec3,
};

use super::{HistoryTable, ObserveError, Recording, check_cadence};
use crate::BlockFactory;
use functional::{Functional, RESULTANTS};
use polygon::{Plane, PlaneArea};

/// A named plane through elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Its name.
    pub name: String,
    /// A point of the plane (m).
    pub point: Vec3,
    /// The plane's normal, of any length. The forces are those with which the side that it points
    /// to pulls at the other.
    pub normal: Vec3,
    /// A direction in the plane, along which forces per metre are taken: the axis of a tunnel,
    /// the width of a wall. What it has along the normal is taken off.
    pub along: Vec3,
    /// Only elements with their [centroid](Mesh::centroid) in this box (m) count, so that a plane
    /// through a ring gives one section and not two.
    pub within: Option<(Vec3, Vec3)>,
}

/// The elements of a cut that share a kernel and a material.
#[derive(Clone, Copy)]
pub struct CutSource<'a> {
    /// Mesh indices; those that the plane does not meet are passed over.
    pub elements: &'a [u32],
    /// What makes blocks of them in the run.
    pub factory: &'a dyn BlockFactory,
    /// Their elastic medium.
    pub medium: ElasticMedium,
}

/// A section's shape and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionGeometry {
    /// The cut's name.
    pub name: String,
    /// Area (m2).
    pub area: f64,
    /// Centroid (m), about which moments are taken.
    pub centroid: Vec3,
    /// Extent (m) along the cut's direction `along`, by which forces per metre are divided.
    pub width: f64,
    /// Extent (m) across it: the thickness of a lining.
    pub depth: f64,
    /// Unit normal `n`.
    pub normal: Vec3,
    /// Unit vector `b` along, in the plane.
    pub along: Vec3,
    /// Unit vector `t = b x n` across, in the plane.
    pub across: Vec3,
    /// How many elements the plane meets.
    pub elements: usize,
}

/// Normal force, shear forces, torsion and bending moments of cuts through linings and pillars.
///
/// With the section's centroid `c`, its axes `n`, `t` (across), `b` (along) and the
/// coordinates `(t, b)` from `c`, the columns of a cut `crown` are
/// ```text
/// crown.axial          integral of sigma_nn dA      (N), tension positive
/// crown.shear_across   integral of sigma_nt dA      (N)
/// crown.shear_along    integral of sigma_nb dA      (N)
/// crown.torsion        integral of t sigma_nb - b sigma_nt dA   (N m)
/// crown.moment_across  integral of t sigma_nn dA    (N m), positive with tension at positive t
/// crown.moment_along   integral of b sigma_nn dA    (N m)
/// crown.axial_per_metre, crown.shear_per_metre   axial and shear_across over the width (N/m)
/// crown.moment_per_metre   moment_across over the width (N m/m)
/// ```
/// They are those of the change of stress, without that of stiffness damping.
///
/// # Method
/// The integrals are not taken over the plane. They are the virtual work of the internal forces
/// on a motion that moves all nodes on the positive side rigidly, by a unit along or about an axis
/// through the centroid, and leaves the others: elements that lie wholly on one side do no work,
/// and what remains is the sum over the elements that the plane meets of the nodal forces on the
/// positive side. These balance the loads on that side to rounding, on any mesh, be the lining one
/// element thick, because they are the forces with which the engine computes: those of the mean
/// stress of the step, and for what it does not carry (bending inside an element, hourglass
/// resistance) those of the elastic operator of the run's own kernel. With a law that is not
/// elastic the first stay exact; the second are exact for one-point kernels, whose hourglass
/// resistance is elastic, and elastic estimates for others.
///
/// Between the plane and the nodes on its positive side loads and inertia are not counted, nor
/// what the rest of the ground does to the cut elements: an error of the order of the element
/// length over the length on which these change. A plane along element sides has none.
///
/// Memory: per cut 144 bytes a node and 288 an element that the plane meets; 8 per column and row.
pub struct SectionForces {
    cadence: Cadence,
    sections: Vec<Section>,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

struct Section {
    geometry: SectionGeometry,
    functionals: Vec<Functional>,
    /// Works to be taken off, of the reference displacement.
    reference: [f64; RESULTANTS],
}

/// Names and units of the columns of a cut.
const COLUMNS: [(&str, &str); 9] = [
    ("axial", "N"),
    ("shear_across", "N"),
    ("shear_along", "N"),
    ("torsion", "N m"),
    ("moment_across", "N m"),
    ("moment_along", "N m"),
    ("axial_per_metre", "N/m"),
    ("shear_per_metre", "N/m"),
    ("moment_per_metre", "N m/m"),
];

impl SectionForces {
    /// Without cuts yet.
    ///
    /// # Errors
    /// A cadence out of range.
    pub fn new(cadence: Cadence) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        Ok(Self {
            cadence,
            sections: Vec::new(),
            row: Vec::new(),
            recording: Recording::default(),
        })
    }

    /// Adds a cut through the elements of one or more sources.
    ///
    /// Nodes within 1e-6 of the mesh's diagonal count as on the plane, and with the positive side.
    ///
    /// # Errors
    /// A direction without length, a plane that meets no element, a name that stands twice, a
    /// factory that does not take its elements.
    pub fn add_cut(
        &mut self,
        mesh: &Mesh,
        cut: &Cut,
        sources: &[CutSource],
    ) -> Result<&SectionGeometry, ObserveError> {
        let (normal, along) = axes(cut)?;
        let (low, high) = mesh.bounding_box();
        let plane = Plane {
            point: cut.point,
            normal,
            tolerance: 1e-6 * (high - low).norm(),
        };
        let met: Vec<Vec<u32>> = sources
            .iter()
            .map(|source| elements_met(mesh, cut, &plane, source.elements))
            .collect();
        let geometry = geometry(mesh, cut, &plane, along, &met)?;
        let axes = [geometry.normal, geometry.across, geometry.along];
        let virtual_motion = |node: u32| {
            let position = &mesh.positions()[node as usize];
            core::array::from_fn(|k| match plane.positive(position) {
                None => Vec3::zeros(),
                Some(_) if k < 3 => axes[k],
                Some(_) => axes[k - 3].cross(&(position - geometry.centroid)),
            })
        };
        let mut functionals = Vec::new();
        for (source, elements) in sources.iter().zip(met) {
            if !elements.is_empty() {
                let functional = Functional::new(
                    mesh,
                    elements,
                    source.factory,
                    &source.medium,
                    virtual_motion,
                );
                functionals.push(functional.map_err(|source| ObserveError::Refused {
                    cut: cut.name.clone(),
                    source,
                })?);
            }
        }
        {
            let mut table = self.recording.lock();
            for (column, unit) in COLUMNS {
                table.add_column(format!("{}.{column}", cut.name), unit)?;
            }
        }
        self.sections.push(Section {
            geometry,
            functionals,
            reference: [0.0; RESULTANTS],
        });
        Ok(&self.sections[self.sections.len() - 1].geometry)
    }

    /// From now on displacement counts from this one (m, one per mesh node), at which the elements
    /// of the cuts are strained by nothing: what is cast later is stress-free in the deformed
    /// state. By default it counts from zero.
    ///
    /// # Errors
    /// If there are not as many displacements as nodes.
    pub fn set_reference_displacement(
        &mut self,
        displacement: &[Vec3],
    ) -> Result<(), ObserveError> {
        for section in &mut self.sections {
            let mut works = [0.0; RESULTANTS];
            for functional in &section.functionals {
                let least = functional.nodes.last().map_or(0, |&last| last as usize + 1);
                let count = displacement.len() as f64;
                ParameterError::check("displacements", count, least as f64, f64::MAX)?;
                functional.add_nodal(|node| displacement[node as usize], 1.0, &mut works);
            }
            section.reference = works;
        }
        Ok(())
    }

    /// Shapes and axes of the sections, in the order of their cuts.
    pub fn geometries(&self) -> impl Iterator<Item = &SectionGeometry> {
        self.sections.iter().map(|section| &section.geometry)
    }

    /// The table that the forces fill.
    pub fn recording(&self) -> Recording<HistoryTable> {
        self.recording.clone()
    }
}

/// Unit normal and unit vector along, at right angles.
fn axes(cut: &Cut) -> Result<(Vec3, Vec3), ObserveError> {
    let refused = |what: &'static str, vector: &Vec3| ObserveError::NoDirection {
        cut: cut.name.clone(),
        what,
        x: vector.x,
        y: vector.y,
        z: vector.z,
    };
    let finite = |unit: &Vec3| unit.iter().all(|x| x.is_finite());
    let normal = cut.normal.try_normalize(0.0).filter(finite);
    let normal = normal.ok_or_else(|| refused("normal", &cut.normal))?;
    let in_plane = |along: Vec3| (along - normal * normal.dot(&along)).try_normalize(1e-6);
    let along = cut
        .along
        .try_normalize(0.0)
        .and_then(in_plane)
        .filter(finite);
    Ok((normal, along.ok_or_else(|| refused("along", &cut.along))?))
}

/// Solid elements in the cut's box with nodes on both sides of the plane.
fn elements_met(mesh: &Mesh, cut: &Cut, plane: &Plane, elements: &[u32]) -> Vec<u32> {
    let positive = |&node: &u32| plane.positive(&mesh.positions()[node as usize]).is_some();
    let met = |&element: &u32| {
        let nodes = mesh.nodes_of(element);
        let above = nodes.iter().filter(|node| positive(node)).count();
        mesh.kind(element).is_solid() && above > 0 && above < nodes.len()
    };
    let in_box = |&element: &u32| {
        let centroid = mesh.centroid(element);
        cut.within.is_none_or(|(low, high)| {
            (0..3).all(|i| low[i] <= centroid[i] && centroid[i] <= high[i])
        })
    };
    elements
        .iter()
        .copied()
        .filter(met)
        .filter(in_box)
        .collect()
}

fn geometry(
    mesh: &Mesh,
    cut: &Cut,
    plane: &Plane,
    along: Vec3,
    met: &[Vec<u32>],
) -> Result<SectionGeometry, ObserveError> {
    let mut polygons = PlaneArea::default();
    for &element in met.iter().flatten() {
        let nodes = mesh.nodes_of(element).iter();
        let corners: Vec<Vec3> = nodes.map(|&node| mesh.positions()[node as usize]).collect();
        polygons.add(plane, mesh.kind(element), &corners);
    }
    if polygons.area <= 0.0 {
        return Err(ObserveError::EmptyCut {
            cut: cut.name.clone(),
        });
    }
    let across = along.cross(&plane.normal);
    Ok(SectionGeometry {
        name: cut.name.clone(),
        area: polygons.area,
        centroid: polygons.first_moment / polygons.area,
        width: polygons.extent(&along),
        depth: polygons.extent(&across),
        normal: plane.normal,
        along,
        across,
        elements: met.iter().map(Vec::len).sum(),
    })
}

impl Observer for SectionForces {
    fn name(&self) -> &str {
        "section forces"
    }
    fn fields(&self) -> Fields {
        Fields {
            stress: !self.sections.is_empty(),
            ..Fields::default()
        }
    }
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.row.clear();
        for section in &self.sections {
            let mut works = section.reference.map(|work| -work);
            for functional in &section.functionals {
                functional.add(view, &mut works);
            }
            let [
                axial,
                shear_across,
                shear_along,
                torsion,
                about_across,
                about_along,
            ] = works;
            // About b the moment of a tension at positive t is negative: t x n = -b.
            let (moment_across, moment_along) = (-about_along, about_across);
            let width = section.geometry.width;
            self.row.extend([
                axial,
                shear_across,
                shear_along,
                torsion,
                moment_across,
                moment_along,
                axial / width,
                shear_across / width,
                moment_across / width,
            ]);
        }
        self.recording.lock().push(view.time(), &self.row);
        Ok(Flow::Continue)
    }
}
