//! Section forces and moments.

mod functional;
mod pieces;
mod plane;
mod ramp;
mod ring;
mod unfolded;

use powerhouse_model::{
    Cadence, Fields, Flow, Mesh, ModelError, Observer, Reach, Selection, StateError, StepView, Vec3,
};

use super::{HistoryTable, ObserveError, Recording, check_cadence, table_cadence};
use functional::Functional;
pub use pieces::SectionPiece;
use plane::{Intersection, Plane, intersect};
pub use ring::{RingSection, SectionRing};
use unfolded::Unfolded;

/// A cross section: a named plane through elements, of which section forces are recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSection {
    /// Name of the section.
    pub name: String,
    /// A point of the plane (m).
    pub point: Vec3,
    /// Normal of the plane, of any length but zero. The section forces are those that the positive side, to which it
    /// points, exerts on the negative side.
    pub normal: Vec3,
    /// Direction of the width of the section, along which forces per metre are taken, such as the axis of a tunnel or
    /// the length of a wall. Its component along the normal is ignored.
    pub along: Vec3,
    /// Box (lower and upper corner, m) of the [centroids](Mesh::centroid) of the elements to be included, which selects
    /// one of the two sections of a plane through a ring; none includes all elements.
    pub within: Option<(Vec3, Vec3)>,
}

impl CrossSection {
    /// Whether a centroid (m) is in the box of the section.
    fn is_within(&self, centroid: &Vec3) -> bool {
        let inside = |(low, high): (Vec3, Vec3)| {
            (0..3).all(|i| low[i] <= centroid[i] && centroid[i] <= high[i])
        };
        self.within.is_none_or(inside)
    }
}

/// Geometry of a section: area, centroid, extents and axes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SectionGeometry {
    /// Name of the section.
    pub name: String,
    /// Area (m2).
    pub area: f64,
    /// Centroid (m), about which moments are taken.
    pub centroid: Vec3,
    /// Extent (m) along `along`, by which forces per metre are divided.
    pub width: f64,
    /// Extent (m) along `across`, such as the thickness of a lining.
    pub depth: f64,
    /// Unit normal `n`.
    pub normal: Vec3,
    /// Unit vector `b` along, in the plane.
    pub along: Vec3,
    /// Unit vector `t = b x n` across, in the plane.
    pub across: Vec3,
    /// Number of elements that the plane intersects.
    pub elements: usize,
    /// Whether the plane cuts a face at which the elements end: what acts on the part of the face beyond the plane is missing, and a
    /// share of what supports it is not.
    pub cuts_end: bool,
    /// Pieces of the section whose elements do not touch each other: more than one where the plane cuts, say, the crown
    /// and the invert of a lining, whose forces and moments are then those of both about the common centroid.
    pub pieces: Vec<SectionPiece>,
}

/// Observer of section forces: normal force, shear forces, torsion and bending moments of sections through linings and
/// pillars.
///
/// With the section's centroid `c`, its axes `n`, `t` (across), `b` (along) and the
/// coordinates `(t, b)` from `c`, the columns of a section `crown` are
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
/// They are resultants of the total stress, including that of earlier stages, but without the stress of stiffness
/// damping, which no output of stress includes.
///
/// # Method
/// The integrals are computed as virtual work of the internal forces, not by integration over the plane. The virtual
/// motion is zero on the negative side, a unit rigid motion along or
/// about an axis through the centroid on the positive side, and linear between them over the length of
/// an element across the plane. Elements wholly on one side do no work. The result is in equilibrium with
/// the loads on the positive side to rounding, on any mesh and with any law, even for a cracked lining of one
/// element, because it uses the nodal forces of the solution itself.
///
/// Loads and inertia within the element length around the plane count by halves, which is right
/// where they are uniform; the error is of second order in that length. A plane may lie on an end of the elements, such as the foot
/// of a pillar or the springline of a half model, or near it, the end being at any angle to the plane: the motion is constant on the
/// whole end face, so that its support does no work, and the resultants of up to three ramps beside the end are extrapolated to the
/// plane. A body of a single element between two ends shows its mean. Where the elements on the two sides of a plane differ in length,
/// two ramps are interpolated in the same way.
///
/// Of a body that [repeats](Self::with_joined_ends) along the normal of a section a ramp goes on in the next period, so that the
/// resultants on its two ends are the same, and those of a body of one layer of elements are the same everywhere in it.
///
/// Cost: at each observation the law is evaluated once more in the elements next to the plane.
/// Memory: per section 144 bytes a node of each of these elements; 8 per column and row.
///
/// ```
/// use powerhouse_observe::{SectionForces, CrossSection};
/// use powerhouse_model::{Cadence, Mesh, Vec3};
/// let pillar = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 3.0, 8.0), [2, 3, 8], "pillar")?;
/// let mut forces = SectionForces::new(Cadence::Seconds(0.01))?;
/// let foot = CrossSection {
///     name: "foot".into(),
///     point: Vec3::zeros(),
///     normal: Vec3::z(),
///     along: Vec3::y(),
///     within: None,
/// };
/// let section = forces.add_section(&pillar, &foot, pillar.element_set("pillar")?)?;
/// assert!((section.area - 6.0).abs() < 1e-12 && (section.width - 3.0).abs() < 1e-12);
/// // `forces` is passed to a run; `recording` gives access to the table afterwards.
/// let recording = forces.recording();
/// assert!(recording.read(|table| table.column("foot.axial_per_metre").is_some()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SectionForces {
    cadence: Cadence,
    sections: Vec<Sensor>,
    /// Pairs of nodes (mesh indices) at opposite ends of a body that repeats beyond them.
    pairs: Vec<(u32, u32)>,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

/// A section with the functional of its stress resultants.
struct Sensor {
    geometry: SectionGeometry,
    functional: Functional,
}

/// Names and units of the columns of a section.
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
    /// An observer without sections.
    ///
    /// # Errors
    /// A cadence out of range.
    pub fn new(cadence: Cadence) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        Ok(Self {
            cadence,
            sections: Vec::new(),
            pairs: Vec::new(),
            row: Vec::new(),
            recording: Recording::default(),
        })
    }

    /// Joins the two ends of a body that repeats beyond them, by their pairs of nodes (mesh indices) of one motion or one that is delayed, for the
    /// sections that are added afterwards: those normal to the translation of the pairs are not at an end anywhere.
    #[must_use]
    pub fn with_joined_ends(mut self, pairs: impl IntoIterator<Item = (u32, u32)>) -> Self {
        self.pairs.extend(pairs);
        self
    }

    /// Adds a section through some elements (mesh indices), of which bars and elements that the plane
    /// does not intersect are ignored; returns its geometry.
    ///
    /// Nodes within 1e-6 of the mesh's diagonal count as on the plane.
    ///
    /// # Errors
    /// A direction without length, a plane that intersects no element, a duplicate name.
    pub fn add_section(
        &mut self,
        mesh: &Mesh,
        section: &CrossSection,
        elements: &[u32],
    ) -> Result<&SectionGeometry, ObserveError> {
        let (normal, along) = axes(section)?;
        let chosen = elements_in_box(mesh, section, elements);
        let (low, high) = mesh.bounding_box();
        let plane = |own_positive| Plane {
            point: section.point,
            normal,
            tolerance: 1e-6 * (high - low).norm(),
            own_positive,
        };
        // Elements that only touch the plane from its positive side count if no others are intersected.
        let intersection = intersect(mesh, plane(true), &chosen)
            .or_else(|| intersect(mesh, plane(false), &chosen));
        let intersection = intersection.ok_or_else(|| {
            let unbounded = CrossSection {
                within: None,
                ..section.clone()
            };
            let all = elements_in_box(mesh, &unbounded, elements);
            ObserveError::EmptySection {
                section: section.name.clone(),
                outside: intersect(mesh, plane(true), &all)
                    .or_else(|| intersect(mesh, plane(false), &all))
                    .is_some(),
            }
        })?;
        let unfolded = self.unfolded(mesh, section, &plane(true), elements)?;
        let (body, chosen, ramp) = match &unfolded {
            Some((unfolded, intersection)) => {
                let all = unfolded.elements();
                let ramp = intersection.ramp(&unfolded.mesh, &all);
                (&unfolded.mesh, all, ramp)
            }
            None => {
                let ramp = intersection.ramp(mesh, &chosen);
                (mesh, chosen, ramp)
            }
        };
        let geometry = intersection.geometry(mesh, section, along, ramp.cuts_end);
        let axes = [geometry.normal, geometry.across, geometry.along];
        let share = |node: u32| {
            let position = body.positions()[node as usize];
            ramp.factor((position - section.point).dot(&normal))
        };
        let virtual_motion = |node: u32| {
            let position = &body.positions()[node as usize];
            let share = share(node);
            core::array::from_fn(|k| {
                let rigid = match k {
                    0..3 => axes[k],
                    _ => axes[k - 3].cross(&(position - geometry.centroid)),
                };
                rigid * share
            })
        };
        let is_strained = |&element: &u32| {
            let mut shares = body.nodes_of(element).iter().map(|&node| share(node));
            let first = shares.next();
            shares.any(|other| Some(other) != first)
        };
        let strained: Vec<u32> = chosen.iter().copied().filter(is_strained).collect();
        let original = |element: u32| {
            let unfolded = unfolded.as_ref();
            unfolded.map_or(element, |(body, _)| body.originals[element as usize])
        };
        let functional = Functional::new(body, &strained, original, virtual_motion);
        {
            let mut table = self.recording.lock();
            for (column, unit) in COLUMNS {
                table.add_column(format!("{}.{column}", section.name), unit)?;
            }
        }
        self.sections.push(Sensor {
            geometry,
            functional,
        });
        Ok(&self.sections[self.sections.len() - 1].geometry)
    }

    /// The body beside itself where it repeats along the normal of a section, with its intersection with the plane; none elsewhere.
    fn unfolded(
        &self,
        mesh: &Mesh,
        section: &CrossSection,
        plane: &Plane,
        elements: &[u32],
    ) -> Result<Option<(Unfolded, Intersection)>, ObserveError> {
        let found = Unfolded::around(mesh, plane, &self.pairs, section, elements)?;
        Ok(found.and_then(|unfolded| {
            let all = unfolded.elements();
            let other = Plane {
                own_positive: !plane.own_positive,
                ..*plane
            };
            let cut = intersect(&unfolded.mesh, *plane, &all)
                .or_else(|| intersect(&unfolded.mesh, other, &all))?;
            Some((unfolded, cut))
        }))
    }

    /// Geometries of all sections, in the order in which they were added.
    pub fn geometries(&self) -> impl Iterator<Item = &SectionGeometry> {
        self.sections.iter().map(|section| &section.geometry)
    }

    /// Shared access to the table.
    pub fn recording(&self) -> Recording<HistoryTable> {
        self.recording.clone()
    }
}

/// Unit normal, and unit vector along in the plane.
fn axes(section: &CrossSection) -> Result<(Vec3, Vec3), ObserveError> {
    let refused = |what: &'static str, vector: &Vec3| ObserveError::NoDirection {
        section: section.name.clone(),
        what,
        x: vector.x,
        y: vector.y,
        z: vector.z,
    };
    let finite = |unit: &Vec3| unit.iter().all(|x| x.is_finite());
    let normal = section.normal.try_normalize(0.0).filter(finite);
    let normal = normal.ok_or_else(|| refused("normal", &section.normal))?;
    let in_plane = |along: Vec3| (along - normal * normal.dot(&along)).try_normalize(1e-6);
    let along = section
        .along
        .try_normalize(0.0)
        .and_then(in_plane)
        .filter(finite);
    Ok((
        normal,
        along.ok_or_else(|| refused("along", &section.along))?,
    ))
}

/// Solid elements in the section's box.
fn elements_in_box(mesh: &Mesh, section: &CrossSection, elements: &[u32]) -> Vec<u32> {
    let in_box = |&element: &u32| {
        let centroid = mesh.centroid(element);
        mesh.kind(element).is_solid() && section.is_within(&centroid)
    };
    elements.iter().copied().filter(in_box).collect()
}

impl Observer for SectionForces {
    fn name(&self) -> &str {
        "section forces"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn reach(&self) -> Reach {
        let sections = self.sections.iter();
        let elements = sections.flat_map(|section| section.functional.elements());
        Reach::NONE
            .with_elements(Selection::These(elements.collect()))
            .with_element_forces()
    }
    fn cadence(&self) -> Cadence {
        table_cadence(self.cadence)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            StateError::expect_same("the list of columns", found.names(), here.names())
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.row.clear();
        for section in &self.sections {
            let works = section.functional.works(view);
            let works = works.ok_or_else(|| ObserveError::NoForces {
                section: section.geometry.name.clone(),
            })?;
            let [
                axial,
                shear_across,
                shear_along,
                torsion,
                about_across,
                about_along,
            ] = works;
            // Tension at positive t has a negative moment about b: t x n = -b.
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
        (self.recording.lock()).see(self.cadence, view, &self.row);
        Ok(Flow::Continue)
    }
}
