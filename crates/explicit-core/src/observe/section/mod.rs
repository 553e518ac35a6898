//! Forces and moments of sections.

mod functional;
mod plane;

use powerhouse_model::{
    Cadence, ElasticMedium, Fields, Flow, Mesh, ModelError, Observer, ParameterError, StepView,
    Vec3,
};

use super::{HistoryTable, ObserveError, Recording, check_cadence};
use crate::BlockFactory;
use functional::{Functional, RESULTANTS};
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

/// The elements of a cut that share a kernel, a material and, if a stage cast them, the stage.
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
/// They are those of the whole stress, of what stages left too, but for that of stiffness damping.
///
/// # Method
/// The integrals are not taken over the plane. They are the virtual work of the internal forces
/// on a motion that leaves the negative side, moves the positive side rigidly by a unit along or
/// about an axis through the centroid, and rises evenly from one to the other over the length of
/// an element across the plane. Elements that lie wholly on one side do no work. The sum balances
/// the loads on the positive side to rounding, on any mesh, be the lining one element thick,
/// because it is made of the forces with which the engine computes: those of the mean stress of the
/// step, and for what that does not carry (bending inside an element, hourglass resistance) those
/// of the elastic operator of the run's own kernel. With a law that is not elastic the first stay
/// exact; the second are exact for one-point kernels, whose hourglass resistance is elastic, and
/// elastic estimates for others.
///
/// Loads and inertia inside the element length around the plane count by halves, as they should
/// where they are spread evenly; the error is of second order in that length. Where the elements
/// end next to the plane the rise is cut short to what there is of them, so that a plane may lie on
/// the end of a pillar; an end that runs obliquely within that length is not recognised.
///
/// Memory: per cut 144 bytes a node and 288 an element of the layers next to the plane; 8 per
/// column and row.
///
/// ```
/// use powerhouse_explicit_core::observe::{Cut, CutSource, SectionForces};
/// use powerhouse_explicit_core::{BlockOptions, Hex8OnePoint, solid};
/// use powerhouse_model::{Cadence, ElasticMedium, Mesh, Vec3};
/// # use powerhouse_model::{ConstitutiveLaw, HistoryVariable, Lane, LawInput, Stress};
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let pillar = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 3.0, 8.0), [2, 3, 8], "pillar")?;
/// let medium = ElasticMedium::new(25.0e9, 0.17, 2500.0)?;
/// let factory = solid("pillar", Hex8OnePoint::DEFAULT, Linear(medium), BlockOptions::default());
/// let mut forces = SectionForces::new(Cadence::Seconds(0.01))?;
/// let cut = Cut {
///     name: "foot".into(),
///     point: Vec3::zeros(),
///     normal: Vec3::z(),
///     along: Vec3::y(),
///     within: None,
/// };
/// let elements = pillar.element_set("pillar")?;
/// let source = CutSource { elements, factory: &*factory, medium };
/// let section = forces.add_cut(&pillar, &cut, &[source])?;
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
    functionals: Vec<Functional>,
    /// Works to be taken off, of the displacement at which the elements are strained by nothing; not
    /// known before the first step that is seen.
    reference: Option<[f64; RESULTANTS]>,
}

impl Sensor {
    /// The works of the displacements at which elements were cast.
    fn of_casts(&self, view: &dyn StepView) -> Result<[f64; RESULTANTS], ObserveError> {
        let mut works = [0.0; RESULTANTS];
        for functional in &self.functionals {
            let mut casts = functional.elements.iter().map(|&e| view.cast_at(e));
            let cast = casts.next().flatten();
            let place = |cast: Option<&[Vec3]>| cast.map(<[Vec3]>::as_ptr);
            if casts.any(|other| place(other) != place(cast)) {
                return Err(ObserveError::SeveralCasts {
                    cut: self.geometry.name.clone(),
                });
            }
            if let Some(displacement) = cast {
                functional.add_nodal(|node| displacement[node as usize], &mut works);
            }
        }
        Ok(works)
    }
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
    /// Nodes within 1e-6 of the mesh's diagonal count as on the plane.
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
        let chosen: Vec<Vec<u32>> = sources
            .iter()
            .map(|source| elements_in_box(mesh, cut, source.elements))
            .collect();
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
        let section = section.ok_or_else(|| ObserveError::EmptyCut {
            cut: cut.name.clone(),
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
        let mut functionals = Vec::new();
        for (source, elements) in sources.iter().zip(&chosen) {
            let elements = section.strained(mesh, elements);
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
        self.sections.push(Sensor {
            geometry,
            functionals,
            reference: None,
        });
        Ok(&self.sections[self.sections.len() - 1].geometry)
    }

    /// From now on displacement counts from this one (m, absolute, one per mesh node), at which the
    /// elements of the cuts are strained by nothing. By default it counts from where the stages cast
    /// them, and from zero for what has been there all along. Holds for the cuts added so far.
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
                functional.add_nodal(|node| displacement[node as usize], &mut works);
            }
            section.reference = Some(works);
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
        for section in &mut self.sections {
            let reference = match section.reference {
                Some(reference) => reference,
                None => section.of_casts(view)?,
            };
            section.reference = Some(reference);
            let mut works = reference.map(|work| -work);
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
