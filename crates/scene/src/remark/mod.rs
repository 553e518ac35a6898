//! Remarks: facts and warnings about a scene and its results.

mod equivalent_layer;
mod kind;
mod record_spectrum;
mod saturated;
mod stations;
mod text;
mod water_warning;

pub use equivalent_layer::EquivalentLayer;
pub use record_spectrum::RecordSpectrumReport;
pub use saturated::{SaturatedMaterial, Seepage};
pub use water_warning::{WaterReason, WaterWarning};

use powerhouse_model::{Renewal, Vec3};
use powerhouse_observe::SectionPiece;
use powerhouse_wavefield::{
    BaselineReport, InputConversion, LayeredReport, QuietStart, RecordReport, SplitReport,
    StationReport, WaveKind,
};

use crate::{AddedWater, BendingError, SceneRemark};
use powerhouse_laws::DampingCost;

/// Standard gravity (m/s2).
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Peak ground acceleration above which the unit is probably wrong (m/s2).
const LARGE_PEAK: f64 = 1.5 * STANDARD_GRAVITY;
/// Condition number of the split of a motion, and difference of its waves from the record over its peak acceleration, above
/// which it is warned of.
const LARGE_CONDITION: f64 = 5.0;
const LARGE_MISFIT: f64 = 0.01;

/// Remark: a fact or a warning about a scene or its results ([`is_warning`](Self::is_warning)).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// Fact: peaks of a processed ground motion record; a warning if its peak acceleration is above 1.5 g.
    Record {
        /// Name of the record.
        name: String,
        /// Peaks and end values of the processed record.
        report: RecordReport,
        /// Report of the baseline correction, before the record was scaled.
        baseline: Option<BaselineReport>,
    },
    /// Fact: format, station, component and time of a record, and what was concluded from the content of its file.
    RecordSource {
        /// Name of the record.
        name: String,
        /// The facts, in words.
        source: String,
    },
    /// Fact: the spectrum to which a record was scaled or matched, and how near it came; a warning where the factor is beyond 4 or
    /// wavelets changed the record much.
    RecordSpectrum {
        /// Name of the record.
        name: String,
        /// What was reached.
        report: Box<RecordSpectrumReport>,
    },
    /// Warning: the baseline correction changes a record more than it does an accelerogram.
    LargeCorrection {
        /// Name of the record.
        name: String,
        /// Largest change of the acceleration over its peak.
        share: f64,
        /// Displacement at the end before the correction (m).
        drift: f64,
    },
    /// Warning: the peak of a record is weak for a design motion, so that its unit is probably another one.
    WeakRecord {
        /// Name of the record.
        name: String,
        /// Peak acceleration of the processed record (m/s2).
        peak: f64,
        /// Key that fixes the peak: `peak`, or `units` of the file.
        key: &'static str,
    },
    /// Fact: an SV wave is past the critical angle.
    PastCritical {
        /// Name of the wave.
        wave: String,
        /// Critical angle (degrees).
        critical: f64,
        /// Largest displacement that a taper removed from the start of the field, over its peak; none without taper.
        removed: Option<f64>,
    },
    /// Fact: a wave travels in layered ground, whose motion is kept in tables of height and time.
    Layered {
        /// Name of the wave.
        wave: String,
        /// Form of the field.
        report: LayeredReport,
        /// Memory of the field (bytes): before the scene is prepared, of tables at the heights of the absorbing faces, at most;
        /// then of all that were made.
        bytes: usize,
    },
    /// Fact: modulus and damping of layers by the equivalent linear method.
    EquivalentLinear {
        /// The layers, from the uppermost down.
        layers: Vec<EquivalentLayer>,
        /// Effective strain over the greatest one (1).
        strain_ratio: f64,
        /// Number of iterations.
        iterations: usize,
        /// Change of modulus or damping in the last one, over its value (1).
        change: f64,
    },
    /// Warning: effective strains for which the equivalent linear method is too crude.
    LargeStrains {
        /// Materials of the layers.
        materials: Vec<String>,
        /// Effective shear strain (1) above which a warning is given.
        limit: f64,
    },
    /// Warning: the effective strain of an equivalent linear layer is beyond its curves.
    BeyondStrainCurves {
        /// Material of the layer.
        material: String,
        /// Effective shear strain (1).
        strain: f64,
        /// Greatest strain of the curves (1).
        greatest: f64,
    },
    /// Fact: the run started from a state of another run.
    StartedFrom {
        /// The origin of the run, in words.
        origin: String,
    },
    /// Warning: rays of a ring of sections meet no element.
    PartialRing {
        /// Name of the ring.
        ring: String,
        /// Number of rays that meet none, and of all.
        missed: [usize; 2],
        /// Angles of the first and last of them (degrees).
        angles: [f64; 2],
    },
    /// Warning: no part and no stage uses a material.
    UnusedMaterial {
        /// Name of the material.
        name: String,
    },
    /// Warning: a record file was read differently from its declaration, as with another number of samples.
    RecordFile {
        /// Name of the record.
        name: String,
        /// Difference from the declaration, in words.
        warning: String,
    },
    /// Fact: conversion of a record whose convention is not `incident` to the incident wave.
    Conversion {
        /// Name of the wave.
        wave: String,
        /// Convention of the record: type of the recorded motion.
        convention: &'static str,
        /// Factor, or regularised division by the transfer function.
        conversion: InputConversion,
    },
    /// Fact: a recorded motion was split into incident waves; a warning if their condition number is above 5, or their
    /// sum misses the record by more than 1 % of its peak acceleration.
    Split {
        /// Name of the record.
        record: String,
        /// Types of the waves, and their angles of incidence (degrees).
        waves: Vec<(WaveKind, f64)>,
        /// Azimuth of the waves (degrees).
        azimuth: f64,
        /// Quality of the split.
        report: SplitReport,
        /// The record's point (m).
        place: Vec3,
        /// Time at which the record begins there (s).
        arrival: f64,
        /// Letters of the components that do not move.
        still: String,
    },
    /// Fact: all waves were delayed by the same time, and those past the critical angle tapered, so that the body
    /// starts at rest.
    QuietStart {
        /// Delay of all waves (s).
        padding: f64,
        /// Names of the waves that are not below 1e-4 of their peak at the start, with the delay of each alone.
        waves: Vec<(String, QuietStart)>,
    },
    /// Fact: the records of prescribed motions were delayed by the same time, so that the body starts at rest; a
    /// warning if the waves have another delay.
    DelayedMotion {
        /// Delay of all prescribed motions (s).
        padding: f64,
        /// Records that needed a delay, with their motion at the start of the run over its peak: the larger ratio
        /// of displacement and velocity.
        records: Vec<(String, f64)>,
        /// Delay of the waves of the scene (s), if there are any.
        waves: Option<f64>,
    },
    /// Warning: a record is declared along x or y of a wave whose azimuth is not 0, so that these axes are not those
    /// of the mesh.
    RotatedAxis {
        /// Name of the record.
        record: String,
        /// Convention (or component of a within motion) given in the scene.
        convention: &'static str,
        /// Name in the coordinates of the wave that has the same meaning without this warning.
        clear: &'static str,
        /// Azimuth of the wave (degrees).
        azimuth: f64,
    },
    /// Warning: the body at the start of the first stage reaches above the level of a geostatic in-situ stress, which is
    /// zero there.
    AboveGround {
        /// Height z of the ground surface (m).
        level: f64,
        /// Greatest height z of the body (m).
        top: f64,
    },
    /// Warning: the run ends before 95 % of the Arias intensity of a record of the waves has arrived.
    TruncatedRecord {
        /// Name of the record.
        name: String,
        /// Share of the Arias intensity that arrives before the end of the run, 0 to 0.95.
        share: f64,
        /// Time at the end of the run (s).
        run: f64,
        /// Time at the end of the record (s), its arrival included, without the extension by a filter.
        record: f64,
    },
    /// Warning: a side of the mesh other than its top is neither absorbing nor supported, and reflects waves.
    OpenSide {
        /// Side of the bounding box: `left`, `right` (x), `front`, `back` (y) or `bottom`.
        side: &'static str,
        /// Area of its free facets (m2).
        area: f64,
    },
    /// Warning: the free field has traction on a free surface of the mesh beside the absorbing faces, because its own
    /// free surface lies elsewhere or does not exist.
    LoadedSurface {
        /// Largest traction of the field there over the product of shear impedance and peak velocity (1), above 0.01.
        share: f64,
        /// Position of the point with the largest traction (m).
        position: Vec3,
    },
    /// Fact: the scatterer (centre of the structure), from which boundary springs take their distance, has its default
    /// position.
    Scatterer {
        /// Position of the scatterer (m).
        position: Vec3,
    },
    /// Fact: a part of a structure runs through absorbing faces, where it takes the field of the ground.
    Through {
        /// Element set of the part.
        set: String,
        /// The faces.
        faces: Vec<String>,
        /// Area of the part over that of these faces (1).
        share: f64,
        /// Impedance of S waves of the part over that of the ground there (1), the one farthest from one.
        contrast: f64,
        /// Greatest extent of the part on a face (m).
        width: f64,
    },
    /// Fact: the free field enters through the layer around a domain reduction region.
    Region {
        /// Number of elements of the region.
        inside: usize,
        /// Number of elements of the layer.
        layer: usize,
    },
    /// Fact: motions at the stations of a file enter around the region.
    Stations {
        /// Path of the file.
        file: String,
        /// Metres in a unit of its coordinates.
        scale: f64,
        /// Directions of its coordinates in the mesh.
        axes: [&'static str; 3],
        /// Directions of the rows of its motions.
        rows: [&'static str; 3],
        /// Sampling.
        report: StationReport,
    },
    /// Warning: the run goes on after the motions of a file of stations, or, a fact, begins before them.
    StationWindow {
        /// Path of the file.
        file: String,
        /// Start and end of the run (s).
        run: [f64; 2],
        /// Sampling.
        report: StationReport,
    },
    /// Warning: a record is used by no wave or prescribed motion.
    UnusedRecord {
        /// Name of the record.
        name: String,
    },
    /// Warning: the set of a support, load or added mass is empty, so that it has no effect.
    EmptySet {
        /// Name of the set.
        set: String,
    },
    /// Warning: a history requests the history variables of an element whose law has none, and records nothing.
    NoState {
        /// Name of the history.
        name: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Warning: section forces are computed from linear tetrahedra, which are too stiff in bending.
    TetrahedralSection {
        /// Name of the section.
        section: String,
        /// Element set that it cuts.
        set: String,
        /// Number of cut tetrahedra.
        elements: usize,
        /// Number of cut elements.
        of: usize,
    },
    /// Warning: a section cuts several pieces that do not touch, whose forces it adds up.
    DividedSection {
        /// Name of the section.
        section: String,
        /// Element set that it cuts.
        set: String,
        /// Cut elements, area, centroid and extents of each piece.
        pieces: Vec<SectionPiece>,
        /// Least and greatest `half_extent` (m) that keep the piece nearest to the section's point alone; none if no value
        /// does.
        half_extent: Option<[f64; 2]>,
    },
    /// Warning: a section fills less than half of its extents, as that of a closed lining: its forces are those of a frame.
    HollowSection {
        /// Name of the section.
        section: String,
        /// Element set that it cuts.
        set: String,
        /// Area over the product of width and depth (1), below 0.5.
        filled: f64,
        /// Extent (m) along the section's `along`.
        width: f64,
        /// Extent (m) across.
        depth: f64,
    },
    /// Warning: a section cuts a face at which its elements end, whose support enters its forces.
    SectionThroughEnd {
        /// Name of the section.
        section: String,
        /// Element set that it cuts.
        set: String,
    },
    /// Warning: a section cuts bricks that are too coarse for its bending moments.
    Bending(BendingError),
    /// Warning: a section cuts a part that may crack or yield with few bricks across of a kernel with one integration point
    /// and elastic bending, which forms no plastic hinge.
    Hinge {
        /// Name of the section.
        section: String,
        /// Element set that it cuts.
        set: String,
        /// Kernel of the bricks.
        kernel: String,
        /// Number of bricks across.
        layers: usize,
    },
    /// Warning after the run: forces of a section were beyond what its reinforcement bears.
    BeyondCapacity {
        /// Name of the section.
        section: String,
        /// Greatest utilisation (1), above one; infinite where no moment is borne.
        utilisation: f64,
        /// First time beyond (s).
        from: f64,
        /// Time of the greatest utilisation (s).
        time: f64,
        /// Normal force at that time (N/m), tension positive.
        axial: f64,
        /// Moment at that time (N m/m).
        moment: f64,
        /// Least and greatest moment that the section bears with that force (N m/m); none if it does not bear the force.
        borne: Option<[f64; 2]>,
    },
    /// Warning after the run: the stiffness that returned when cracks closed, or the time integration of laws, gave or
    /// took energy of the size of that which plastic flow and damage took.
    CrackEnergy {
        /// Energy that plastic flow and damage took (J).
        dissipated: f64,
        /// Energy that the recovery of stiffness gave to the body (J).
        recovery: f64,
        /// Energy by which the time integration of the laws errs (J).
        integration: f64,
    },
    /// Warning after the run: slip or opening of a joint is above a tenth of the shortest edge, too large for node pairs
    /// that are fixed (small-slip assumption).
    LargeSlip {
        /// Name of the joint.
        joint: String,
        /// Largest accumulated slip or opening of a pair over the shortest edge of the facets (1).
        share: f64,
    },
    /// Fact: a joint is re-initialised in a construction stage or at the start of the run, from where its opening,
    /// slip and energies are counted.
    JointRenewed {
        /// Name of the joint.
        joint: String,
        /// Name of the last stage that does so; `None` for the start of the run.
        stage: Option<String>,
        /// Whether it is grouted, or its tie is removed.
        renewal: Renewal,
    },
    /// Warning: the strength of a joint is reduced where the mesh does not resolve the failure of its bond.
    ReducedStrength {
        /// Name of the joint.
        joint: String,
        /// Least factor of a strength (1).
        factor: f64,
        /// Area of the pairs whose strength is reduced (m2).
        area: f64,
        /// Area of all pairs (m2).
        of: f64,
    },
    /// Warning: a damped part without a rim touches an absorbing face, although the free field is elastic.
    DampedRim {
        /// Element set of the part.
        set: String,
    },
    /// Warning: a part with a nonlinear law and no rim touches an absorbing face, although the free field is elastic.
    NonlinearRim {
        /// Element set of the part.
        set: String,
        /// Name of the law.
        law: String,
    },
    /// Warning: a part with a nonlinear law has stiffness-proportional damping, which is proportional to the degraded
    /// stiffness and whose stress is not contained in any output.
    DampedHistory {
        /// Element set of the part.
        set: String,
        /// Name of the law.
        law: String,
    },
    /// Warning after the run: the work of hourglass resistance is above 1 % of the internal work of a set.
    Hourglass {
        /// Name of the stage, of several that with the largest share; `None` for the dynamic run.
        stage: Option<String>,
        /// Name of the element set.
        set: String,
        /// Greatest work of hourglass resistance over the greatest internal work (1).
        share: f64,
    },
    /// Warning after the run: the added inertia of fibres has more than 1 % of the kinetic energy of their masses.
    HeavyFibres {
        /// Its share (1), see [`Results::share_of_fibres`](crate::Results::share_of_fibres).
        share: f64,
    },
    /// Warning after the run: the in-situ stress is not in equilibrium with loads and supports of the first stage, by
    /// more than 5 % of the load; only if that stage neither excavates nor casts.
    Unbalanced {
        /// Name of the first stage.
        stage: String,
        /// Unbalanced force at the start of the stage over the force of the load (1).
        share: f64,
        /// Largest displacement until equilibrium (m).
        displacement: f64,
        /// Number of the node with this displacement in the mesh file.
        node: u64,
    },
    /// Warning after the run: the sampling interval of an acceleration history is too long for its frequencies: fewer than
    /// about six samples per period around its peak, or samples that miss a twentieth of the greatest band-limited acceleration, of
    /// instants that of all steps.
    Undersampled {
        /// Name of the history.
        name: String,
        /// Mean sampling interval (s).
        interval: f64,
        /// Band (Hz) of the accelerations from which peaks and spectra are; none if they are from these samples.
        band: Option<f64>,
    },
    /// Warning after the run: the sampling interval of an acceleration envelope is too long, so that peaks are missed:
    /// every second sample has less than 0.9 of its greatest acceleration.
    SparseEnvelope {
        /// Greatest acceleration of every second sample over that of all samples (1).
        share: f64,
    },
    /// Fact: accuracy and cost of flat damping of a part.
    FlatDamping {
        /// Element set of the part.
        set: String,
        /// Accuracy and cost.
        cost: DampingCost,
        /// Whether it is the default damping of the material.
        by_default: bool,
    },
    /// Fact: a material has water in its pores.
    PoreWater(SaturatedMaterial),
    /// Warning: water in the pores of a material is probably not what is meant.
    WaterWarning(WaterWarning),
    /// Added mass of water beside a facet set; a warning if the facets lean too much for its formula.
    AddedWater(AddedWater),
    /// Fact: elements of a part along the absorbing faces are elastic and undamped (rim).
    Rim {
        /// Element set of the part.
        set: String,
        /// Width of the rim (m); 0 for the elements that touch the faces.
        width: f64,
        /// Number of elements of the rim.
        elements: usize,
        /// Number of elements of the part.
        of: usize,
    },
    /// Warning: parameters of a material are inconsistent ([`Material::warnings`](powerhouse_laws::Material::warnings)).
    Material {
        /// Element set of the part.
        set: String,
        /// Description of the inconsistency.
        warning: String,
    },
    /// Warning about an implausible value or combination in a scene, or the fact [`SceneRemark::MeshFile`].
    Scene(SceneRemark),
}
