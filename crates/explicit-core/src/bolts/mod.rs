//! Rock bolts: bars embedded in the elements that they cross.

mod bar;
mod block;
mod embedding;
mod hanging;
mod pattern;

use std::sync::Arc;

use powerhouse_model::{BuildBlock, Mesh, ParameterError, Vec3};

use crate::EngineError;
use bar::Bar;
use block::BoltBlock;
use embedding::{Segment, embed};

pub(crate) use block::AXIAL_FORCE;
pub use pattern::BoltPattern;

/// A bolt as a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltLine {
    /// Where it comes out of the rock (m).
    pub head: Vec3,
    /// Its other end (m).
    pub toe: Vec3,
}

/// How the end of a grouted bolt holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoltEnd {
    /// By the grout alone.
    #[default]
    Free,
    /// Fixed to the rock at its place, by a plate or an expansion shell.
    Anchored,
}

/// Grout in which a bolt may slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grout {
    /// Shear force per length and slip (N/m2).
    pub stiffness: f64,
    /// Greatest shear force per length (N/m), at which it slips on; infinite if it never does.
    pub strength: f64,
    /// How the head holds.
    pub head: BoltEnd,
    /// How the toe holds.
    pub toe: BoltEnd,
}

/// What bolts are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltParameters {
    /// Young's modulus (Pa).
    pub young: f64,
    /// Section (m2).
    pub area: f64,
    /// Axial force (N) at which the bar flows, in tension and compression; infinite if it never
    /// does.
    pub yield_force: f64,
    /// Axial force (N) that is locked in when the bolt is installed.
    pub pretension: f64,
    /// Grout that gives way; none ties the bar to the rock all along.
    pub grout: Option<Grout>,
    /// Longest segment (m), where elements are larger: slip is linear within a segment.
    pub longest_segment: f64,
}

impl BoltParameters {
    /// A bar of a diameter (m) of steel, 200 GPa, that never yields, without pretension, tied to the
    /// rock.
    ///
    /// # Errors
    /// A diameter that is not positive.
    pub fn steel(diameter: f64) -> Result<Self, ParameterError> {
        ParameterError::check("diameter", diameter, 1.0e-6, 10.0)?;
        Ok(Self {
            young: 200.0e9,
            area: 0.25 * core::f64::consts::PI * diameter * diameter,
            yield_force: f64::INFINITY,
            pretension: 0.0,
            grout: None,
            longest_segment: f64::INFINITY,
        })
    }

    /// Whether every field is in its range.
    ///
    /// # Errors
    /// The first that is not: a pretension beyond the yield force, or in grout without an anchored
    /// head and toe, which would let it go.
    pub fn check(&self) -> Result<(), ParameterError> {
        let positive =
            |name, value: f64| ParameterError::check(name, value, f64::MIN_POSITIVE, f64::MAX);
        let or_never = |name, value: f64| match value {
            f64::INFINITY => Ok(()),
            value => positive(name, value),
        };
        positive("young", self.young)?;
        positive("area", self.area)?;
        or_never("yield_force", self.yield_force)?;
        or_never("longest_segment", self.longest_segment)?;
        let mut most = self.yield_force.min(f64::MAX);
        if let Some(grout) = &self.grout {
            positive("grout stiffness", grout.stiffness)?;
            or_never("grout strength", grout.strength)?;
            if (grout.head, grout.toe) != (BoltEnd::Anchored, BoltEnd::Anchored) {
                most = 0.0;
            }
        }
        ParameterError::check("pretension", self.pretension, 0.0, most)
    }
}

/// One bolt with the elements that it crosses.
#[derive(Clone, Debug)]
struct Embedded {
    /// Unit vector from head to toe.
    direction: Vec3,
    segments: Vec<Segment>,
}

/// Bolts of one make, embedded in elements of a mesh.
///
/// The displacement of a bar is that of the elements around it, by their shape functions, at any
/// position and angle: an exact strain wherever theirs is. Its axial force
///
/// `N = clamp(N_0 + E A (e - e_p), -N_y, N_y)`
///
/// with the strain `e` since it was installed flows at `N_y`. In grout that gives way the bar has
/// an axial displacement `w` of its own: in every state the bar is in balance with the grout,
/// `dN/dx = clamp(k (w - b . u - s), -c, c)`, solved along the bolt. `w` is no unknown of the
/// motion and has no mass; it makes the bolt softer, never stiffer, and so costs no step. A bar
/// that crosses an open joint is one bar in grout; tied all along, it does not feel the joint.
///
/// ```
/// use powerhouse_explicit_core::{BoltLine, BoltParameters, BoltSet};
/// use powerhouse_model::{Mesh, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(6.0), [3, 3, 3], "rock")?;
/// let line = BoltLine { head: Vec3::new(3.0, 3.0, 0.0), toe: Vec3::new(2.0, 3.5, 5.0) };
/// let steel = BoltParameters::steel(0.025)?;
/// let bolts = BoltSet::new("bolts", &mesh, mesh.element_set("rock")?, &[line], steel)?;
/// let length: f64 = bolts.segments(0).map(|segment| segment.length).sum();
/// assert!((length - (line.toe - line.head).norm()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Why so
/// *No nodes of their own.* A bar element between nodes of its own would halve the stable step of
/// rock elements of its length, and springs of grout cost ten times as much. Embedded bars of 25 mm
/// cost 0.1 % in elements of a metre.
#[derive(Clone, Debug)]
pub struct BoltSet {
    name: Arc<str>,
    parameters: BoltParameters,
    bolts: Vec<Embedded>,
}

/// A piece of a bolt within one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltSegment {
    /// Mesh index of the element.
    pub element: u32,
    /// Distance of its start from the head (m).
    pub start: f64,
    /// Its length (m).
    pub length: f64,
}

impl BoltSet {
    /// Bolts in some elements (mesh indices): those that are there.
    ///
    /// # Errors
    /// A parameter out of its range; a bolt without length, or that leaves the elements by more
    /// than a thousandth of its length.
    pub fn new(
        name: &str,
        mesh: &Mesh,
        hosts: &[u32],
        lines: &[BoltLine],
        parameters: BoltParameters,
    ) -> Result<Self, EngineError> {
        parameters.check()?;
        let segments = embed(mesh, hosts, lines, parameters.longest_segment)?;
        let bolts = lines.iter().zip(segments);
        Ok(Self {
            name: name.into(),
            parameters,
            bolts: bolts
                .map(|(line, segments)| Embedded {
                    direction: (line.toe - line.head).normalize(),
                    segments,
                })
                .collect(),
        })
    }

    /// The name of the set.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// How many bolts.
    pub fn len(&self) -> usize {
        self.bolts.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bolts.is_empty()
    }
    /// The segments of a bolt from head to toe.
    ///
    /// # Panics
    /// If there is no such bolt.
    pub fn segments(&self, bolt: usize) -> impl ExactSizeIterator<Item = BoltSegment> + '_ {
        self.bolts[bolt].segments.iter().map(|segment| BoltSegment {
            element: segment.element,
            start: segment.start,
            length: segment.length,
        })
    }

    /// What [`ModelBuilder::embed`](crate::ModelBuilder::embed) takes.
    pub fn block(&self) -> BuildBlock {
        let set = self.clone();
        Box::new(move |numbering| Box::new(BoltBlock::new(&set, numbering)))
    }

    /// Axial forces (N, tension positive) of all segments, bolt after bolt, in a state; none if it
    /// does not know these bolts.
    pub fn axial_forces(&self, state: &powerhouse_model::State) -> Option<Vec<f64>> {
        let name = format!("{}/{AXIAL_FORCE}", self.name);
        let field = state.history.iter().find(|field| field.name == name)?;
        Some(field.values.clone())
    }

    /// The bars as their laws see them.
    fn bars(&self) -> Vec<Bar> {
        let lengths = |bolt: &Embedded| bolt.segments.iter().map(|s| s.length).collect();
        let bars = self.bolts.iter().map(lengths);
        bars.map(|lengths| Bar::new(&self.parameters, lengths))
            .collect()
    }
}
