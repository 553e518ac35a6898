//! Rock bolts: bars embedded in the solid elements that they cross.

mod bar;
mod block;
mod embedding;
mod grouted;
mod interpolation;
mod pattern;
mod tied;

use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    AXIAL_FORCE, ElementBlock, EmbeddedBars, EmbeddedElements, EngineError, Mesh, ParameterError,
    Vec3,
};

use bar::Bar;
use block::BoltBlock;
use embedding::{Segment, embed};

pub use pattern::BoltPattern;

/// Difference of the components of unit vectors within which bolts count as parallel.
const PARALLEL: f64 = 1.0e-12;

/// Axis of a bolt: a straight line from head to toe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltLine {
    /// Position of the head (m), the end at the rock surface.
    pub head: Vec3,
    /// Position of the toe (m), the end inside the rock.
    pub toe: Vec3,
}

/// End condition of a grouted bolt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum BoltEnd {
    /// Free end: load transfer by the grout alone.
    #[default]
    Free,
    /// End fixed to the rock, by a plate or an expansion shell.
    Anchored,
}

/// Grout with elastic-perfectly plastic shear transfer between bolt and rock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grout {
    /// Shear stiffness: shear force per length and relative displacement (N/m2), above zero.
    pub stiffness: f64,
    /// Shear strength: greatest shear force per length (N/m), above zero; infinite for grout that never slips.
    pub strength: f64,
    /// How the head of the bolt is held: by the grout alone, or anchored to the rock.
    pub head: BoltEnd,
    /// How the toe of the bolt is held: by the grout alone, or anchored to the rock.
    pub toe: BoltEnd,
}

/// Mechanical parameters of a bolt: bar, pretension and grout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltParameters {
    /// Young's modulus of the bar (Pa), above zero.
    pub young: f64,
    /// Cross-sectional area of the bar (m2), above zero.
    pub area: f64,
    /// Yield force of the bar (N), in tension and compression, above zero; infinite for an elastic
    /// bar.
    pub yield_force: f64,
    /// Axial force (N) at installation, 0 to the yield force.
    pub pretension: f64,
    /// Grout in which the bar may slip; none for a bar tied to the rock along its length.
    pub grout: Option<Grout>,
    /// Greatest length of a segment (m), to which the part in a larger element is divided; slip is linear within a
    /// segment. Infinite for no other limit than the element, and in grout than a quarter of the bolt and the length
    /// `sqrt(E A / k)` over which the grout hands over a force.
    pub longest_segment: f64,
}

/// Least number of segments of a bolt in grout, where none is asked for.
const LEAST_SEGMENTS: f64 = 4.0;

impl BoltParameters {
    /// An elastic steel bar (200 GPa) of a diameter (m), without pretension, tied to the
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

    /// Checks the ranges of all fields.
    ///
    /// # Errors
    /// The first field outside its permitted range; a pretension in grout without an anchored
    /// head and toe is not permitted.
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

    /// Greatest length of a segment (m) of a bolt of a length (m).
    fn longest_of(&self, length: f64) -> f64 {
        match &self.grout {
            Some(grout) if self.longest_segment.is_infinite() => {
                let transfer = (self.young * self.area / grout.stiffness).sqrt();
                transfer.min(length / LEAST_SEGMENTS)
            }
            _ => self.longest_segment,
        }
    }
}

/// One bolt with its segments in the host elements.
#[derive(Clone, Debug)]
struct Embedded {
    /// Unit vector from head to toe.
    direction: Vec3,
    segments: Vec<Segment>,
    /// Number of its first segment in the set.
    first_segment: u32,
}

/// A set of rock bolts with the same parameters, embedded in solid elements of a mesh.
///
/// The displacement of a bar is interpolated from its host elements by their shape functions, at any
/// position and angle, so that its strain is exact wherever theirs is. Its axial force
///
/// `N = clamp(N_0 + E A (e - e_p), -N_y, N_y)`
///
/// with the strain `e` since installation is limited by the yield force `N_y`. With [`Grout`] the bar has
/// an axial displacement `w` of its own: in every state the bar is in equilibrium with the grout,
/// `dN/dx = clamp(k (w - b . u - s), -c, c)`, solved along the bolt. `w` is an internal
/// variable without mass; it makes the bolt softer, never stiffer, and does not reduce the stable step. A grouted bar
/// that crosses an open joint is stretched by its opening; a tied bar is not.
///
/// ```
/// use powerhouse_elements::{BoltLine, BoltParameters, BoltSet};
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
/// *Bolts have no nodes of their own.* A bar element between nodes of its own would halve the stable step of
/// rock elements of its length, and grout springs would reduce it ten times as much. Embedded bars of 25 mm
/// reduce it by 0.1 % in elements of a metre.
#[derive(Clone, Debug)]
pub struct BoltSet {
    name: Arc<str>,
    parameters: BoltParameters,
    bolts: Arc<[Embedded]>,
}

/// A segment of a bolt within one element; where [`BoltParameters::longest_segment`] divides the part in an element,
/// several segments have the same host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoltSegment {
    /// Mesh index of the host element.
    pub element: u32,
    /// Distance of the start of the segment from the head (m).
    pub start: f64,
    /// Length of the segment (m).
    pub length: f64,
}

impl BoltSet {
    /// A set of bolts along `lines`, embedded in the elements `hosts` (mesh indices of active elements).
    ///
    /// # Errors
    /// A parameter outside its permitted range; a bolt without length, or one that leaves the host elements by more
    /// than a thousandth of its length.
    pub fn new(
        name: &str,
        mesh: &Mesh,
        hosts: &[u32],
        lines: &[BoltLine],
        parameters: BoltParameters,
    ) -> Result<Self, EngineError> {
        parameters.check()?;
        let segments = embed(mesh, hosts, lines, |length| parameters.longest_of(length))?;
        let mut first_segment = 0;
        let mut directions = BTreeMap::new();
        let bolts = lines.iter().zip(segments).map(|(line, segments)| {
            let first = first_segment;
            first_segment += segments.len() as u32;
            // Bolts that are parallel but for rounding have the bits of one direction, whose nodal values they share.
            let direction = (line.toe - line.head).normalize();
            let key = [0, 1, 2].map(|c| (direction[c] / PARALLEL).round() as i64);
            Embedded {
                direction: *directions.entry(key).or_insert(direction),
                segments,
                first_segment: first,
            }
        });
        Ok(Self {
            name: name.into(),
            parameters,
            bolts: bolts.collect(),
        })
    }

    /// Name of the set.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Number of bolts in the set, each of one or more segments.
    pub fn len(&self) -> usize {
        self.bolts.len()
    }
    /// Whether the set has no bolts.
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

    /// Greatest relative error of the greatest force of a bolt in grout (1) that its segments make in ground that is stretched
    /// uniformly, against the closed form of an elastic bar; 0 for bars without grout.
    pub fn segment_error(&self) -> f64 {
        let Some(grout) = self.parameters.grout else {
            return 0.0;
        };
        let error = |bolt: &Embedded| {
            let lengths = bolt.segments.iter().map(|segment| segment.length);
            let bar = Bar::new(&self.parameters, grout, lengths.collect());
            let [found, right] = bar.stretched_force();
            (found / right - 1.0).abs()
        };
        self.bolts.iter().map(error).fold(0.0, f64::max)
    }

    /// One element block of all these bolts; an engine [divides](EmbeddedElements) them into several.
    pub fn block(&self) -> Box<dyn ElementBlock> {
        let all: Vec<usize> = (0..self.bolts.len()).collect();
        Box::new(BoltBlock::new(self, &all))
    }

    /// Axial forces (N, tension positive) of all segments in a state, bolt by bolt; none if the state
    /// has no such bolts.
    pub fn axial_forces(&self, state: &powerhouse_model::State) -> Option<Vec<f64>> {
        let name = format!("{}/{AXIAL_FORCE}", self.name);
        let field = state.history.iter().find(|field| field.name == name)?;
        Some(field.values.clone())
    }
}

impl EmbeddedBars for BoltSet {
    fn name(&self) -> &str {
        &self.name
    }
    fn segment_count(&self) -> usize {
        self.bolts.iter().map(|bolt| bolt.segments.len()).sum()
    }
}

impl EmbeddedElements for BoltSet {
    fn name(&self) -> &str {
        &self.name
    }
    fn hosts(&self) -> Vec<Option<u32>> {
        let first = |bolt: &Embedded| Some(bolt.segments.first()?.element);
        self.bolts.iter().map(first).collect()
    }
    fn block_of(&self, units: &[usize]) -> Box<dyn ElementBlock> {
        Box::new(BoltBlock::new(self, units))
    }
}
