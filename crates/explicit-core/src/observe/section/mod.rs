//! Forces and moments of sections.

mod functional;
mod plane;

use powerhouse_model::{Cadence, Fields, Flow, Mesh, ModelError, Observer, StepView, Vec3};

use super::{HistoryTable, ObserveError, Recording, check_cadence};
use functional::Functional;
use plane::{Plane, meet};

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
/// They are those of the whole stress, of what stages left too, but for that of stiffness damping, which
/// acts on the nodes and is in no output of stress.
///
/// # Method
/// The integrals are not taken over the plane. They are the virtual work of the internal forces
/// on a motion that leaves the negative side, moves the positive side rigidly by a unit along or
/// about an axis through the centroid, and rises evenly from one to the other over the length of
/// an element across the plane. Elements that lie wholly on one side do no work. The sum balances
/// the loads on the positive side to rounding, on any mesh and with any law, be the lining one
/// element thick and cracked, because it is made of the forces with which the engine computes.
///
/// Loads and inertia inside the element length around the plane count by halves, as they should
/// where they are spread evenly; the error is of second order in that length. Where the elements
/// end next to the plane the rise is cut short to what there is of them, so that a plane may lie on
/// the end of a pillar; an end that runs obliquely within that length is not recognised.
///
/// Cost: at each reading the law is asked once more at the points of the layers next to the plane.
/// Memory: per cut 144 bytes a node of each element of these layers; 8 per column and row.
///
/// ```
/// use powerhouse_explicit_core::observe::{Cut, SectionForces};
/// use powerhouse_model::{Cadence, Mesh, Vec3};
/// let pillar = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 3.0, 8.0), [2, 3, 8], "pillar")?;
/// let mut forces = SectionForces::new(Cadence::Seconds(0.01))?;
/// let cut = Cut {
///     name: "foot".into(),
///     point: Vec3::zeros(),
///     normal: Vec3::z(),
///     along: Vec3::y(),
///     within: None,
/// };
/// let section = forces.add_cut(&pillar, &cut, pillar.element_set("pillar")?)?;
/// assert!((section.area - 6.0).abs() < 1e-12 && (section.width - 3.0).abs() < 1e-12);
/// // `forces` goes into a run; `recording` shows the table afterwards.
/// let recording = forces.recording();
/// assert!(recording.read(|table| table.column("foot.axial_per_metre").is_some()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SectionForces {
    cadence: Cadence,
    sections: Vec<Sensor>,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

struct Sensor {
    geometry: SectionGeometry,
    functional: Functional,
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

    /// Adds a cut through some elements (mesh indices); those that are no solids, and those that the plane
    /// does not meet, are passed over.
    ///
    /// Nodes within 1e-6 of the mesh's diagonal count as on the plane.
    ///
    /// # Errors
    /// A direction without length, a plane that meets no element, a name that stands twice.
    pub fn add_cut(
        &mut self,
        mesh: &Mesh,
        cut: &Cut,
        elements: &[u32],
    ) -> Result<&SectionGeometry, ObserveError> {
        let (normal, along) = axes(cut)?;
        let chosen = elements_in_box(mesh, cut, elements);
        let (low, high) = mesh.bounding_box();
        let plane = |own_positive| Plane {
            point: cut.point,
            normal,
            tolerance: 1e-6 * (high - low).norm(),
            own_positive,
        };
        // Elements that only touch the plane from its positive side count as met if no others are.
        let section =
            meet(mesh, plane(true), &chosen).or_else(|| meet(mesh, plane(false), &chosen));
        let section = section.ok_or_else(|| {
            let unbounded = Cut {
                within: None,
                ..cut.clone()
            };
            let all = elements_in_box(mesh, &unbounded, elements);
            ObserveError::EmptyCut {
                cut: cut.name.clone(),
                outside: meet(mesh, plane(true), &all)
                    .or_else(|| meet(mesh, plane(false), &all))
                    .is_some(),
            }
        })?;
        let geometry = section.geometry(cut, along);
        let axes = [geometry.normal, geometry.across, geometry.along];
        let virtual_motion = |node: u32| {
            let position = &mesh.positions()[node as usize];
            let share = section.ramp(position);
            core::array::from_fn(|k| {
                let rigid = match k {
                    0..3 => axes[k],
                    _ => axes[k - 3].cross(&(position - geometry.centroid)),
                };
                rigid * share
            })
        };
        let strained = section.strained(mesh, &chosen);
        let functional = Functional::new(mesh, &strained, virtual_motion);
        {
            let mut table = self.recording.lock();
            for (column, unit) in COLUMNS {
                table.add_column(format!("{}.{column}", cut.name), unit)?;
            }
        }
        self.sections.push(Sensor {
            geometry,
            functional,
        });
        Ok(&self.sections[self.sections.len() - 1].geometry)
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

/// Solid elements in the cut's box.
fn elements_in_box(mesh: &Mesh, cut: &Cut, elements: &[u32]) -> Vec<u32> {
    let in_box = |&element: &u32| {
        let centroid = mesh.centroid(element);
        let inside = |(low, high): (Vec3, Vec3)| {
            (0..3).all(|i| low[i] <= centroid[i] && centroid[i] <= high[i])
        };
        mesh.kind(element).is_solid() && cut.within.is_none_or(inside)
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
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.row.clear();
        for section in &self.sections {
            let works = section.functional.works(view);
            let works = works.ok_or_else(|| ObserveError::NoForces {
                cut: section.geometry.name.clone(),
            })?;
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
