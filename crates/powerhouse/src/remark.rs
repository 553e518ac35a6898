//! What was found while a scene was composed.

use core::fmt;

use powerhouse_model::{Renewal, Vec3};
use powerhouse_wavefield::{BaselineReport, InputConversion, QuietStart, RecordReport};

use crate::doubt::{Doubt, Topic};
use crate::{DampingCost, Results, SceneDoubt};

/// Standard gravity (m/s2).
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Few accelerograms reach this peak (m/s2).
const LARGE_PEAK: f64 = 1.5 * STANDARD_GRAVITY;

/// Something that a user should know of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// What became of a record.
    Record {
        /// Its name in the scene.
        name: String,
        /// Peaks and end values as it enters the wave.
        report: RecordReport,
        /// What the baseline correction did, before the record was scaled.
        baseline: Option<BaselineReport>,
    },
    /// A record's file was read otherwise than it declares.
    RecordFile {
        /// The record's name in the scene.
        name: String,
        /// What was taken differently.
        doubt: String,
    },
    /// How a record that is not the incident wave became it.
    Conversion {
        /// The field's name.
        wave: String,
        /// What the record is.
        convention: &'static str,
        /// Factor and regularised division.
        conversion: InputConversion,
    },
    /// All waves were delayed alike, and those past the critical angle tapered, so that the body
    /// may start at rest.
    QuietStart {
        /// By how much all waves arrive later (s).
        padding: f64,
        /// The waves that needed it, and what each would have needed alone.
        waves: Vec<(String, QuietStart)>,
    },
    /// The records of prescribed motions were delayed alike, so that the body may start at rest.
    QuietMotion {
        /// By how much they come later (s).
        padding: f64,
        /// The records that needed it, and what their motion would have been at the start of the run
        /// over its peak: the larger share of displacement and velocity.
        records: Vec<(String, f64)>,
        /// By how much the waves of the scene come later (s), if it has some.
        waves: Option<f64>,
    },
    /// A record of the x or y of a wave whose azimuth turns them away from those of the mesh.
    TurnedAxis {
        /// The record's name in the scene.
        record: String,
        /// What the scene says that it is.
        convention: &'static str,
        /// The name of the same that says so.
        clear: &'static str,
        /// The wave's azimuth (degrees).
        azimuth: f64,
    },
    /// The in-situ stress of ground in a body that reaches above its level: there it is none.
    AboveGround {
        /// The level of the ground (m).
        level: f64,
        /// The height of the body (m).
        top: f64,
    },
    /// The run ends before most of a record has come.
    CutShort {
        /// Its name in the scene.
        name: String,
        /// The share of its Arias intensity that comes before the end.
        share: f64,
        /// When the run ends (s).
        run: f64,
        /// When the record ends (s), without what a filter put behind it.
        record: f64,
    },
    /// A side of the mesh, its top aside, that neither absorbs nor is held: waves are reflected
    /// there.
    OpenSide {
        /// The side, as boxes of bricks name it.
        side: &'static str,
        /// Its open area (m2).
        area: f64,
    },
    /// A free surface beside the absorbing faces on which the field has stress: the field's own
    /// surface lies elsewhere, or it has none.
    LoadedSurface {
        /// The largest traction of the field there over the shear impedance times the peak of its
        /// velocity.
        share: f64,
        /// Where it is largest (m).
        position: Vec3,
    },
    /// Nothing says where the structure is, from which springs take their distance.
    Scatterer {
        /// Where it was taken to be (m).
        position: Vec3,
    },
    /// The field enters through the layer around a region.
    Region {
        /// Elements of the region.
        inside: usize,
        /// Elements of the layer.
        layer: usize,
    },
    /// A record that drives nothing.
    UnusedRecord {
        /// Its name in the scene.
        name: String,
    },
    /// A set of a support or a load in which there is nothing: it holds or moves nothing.
    EmptySet {
        /// Its name.
        set: String,
    },
    /// A history of the state of an element whose law has no history variables.
    NoState {
        /// The name of the history.
        name: String,
        /// The element's number.
        element: u64,
    },
    /// Section forces through linear tetrahedra, which are too stiff in bending.
    TetrahedralSection {
        /// The name of the section.
        section: String,
        /// The set that it cuts.
        set: String,
        /// How many of the elements that it cuts are tetrahedra.
        elements: usize,
        /// How many it cuts.
        of: usize,
    },
    /// A joint moved farther than pairs that keep their nodes can follow; found after the run.
    LargeSlip {
        /// The joint's name.
        joint: String,
        /// Its largest slip or opening over the shortest edge of its facets.
        share: f64,
    },
    /// A joint that starts anew in a stage, or when the body starts to move after a tie: its opening, slip
    /// and energies count from there.
    JointAnew {
        /// The joint's name.
        joint: String,
        /// The stage; none when the body starts to move.
        stage: Option<String>,
        /// How it starts.
        renewal: Renewal,
    },
    /// A damped part touches an absorbing face, behind which the free field is elastic.
    DampedRim {
        /// The part's set.
        set: String,
    },
    /// A part that is not elastic touches an absorbing face, behind which the free field is.
    NonlinearRim {
        /// The part's set.
        set: String,
        /// Its law.
        law: String,
    },
    /// Damping proportional to stiffness meets a law with history variables: it acts with what is left of
    /// the stiffness at each point, and its stress is in no output.
    DampedHistory {
        /// The part's set.
        set: String,
        /// Its law.
        law: String,
    },
    /// Hourglass resistance took much of the internal work of a set; found after the run.
    Hourglass {
        /// The stage, none for the run.
        stage: Option<String>,
        /// The set.
        set: String,
        /// The share of the internal work.
        share: f64,
    },
    /// The stress of the ground before the first stage and what acts in it are out of balance; found after
    /// the stages.
    Unbalanced {
        /// The first stage.
        stage: String,
        /// Forces out of balance at its start over the load.
        share: f64,
        /// The largest displacement until they balanced (m).
        displacement: f64,
        /// The node's number.
        node: u64,
    },
    /// Accelerations that change from sample to sample by as much as they are large; found after the run.
    Undersampled {
        /// The name of the history.
        name: String,
        /// The interval of samples (s).
        interval: f64,
    },
    /// Greatest accelerations of an envelope that depend on how often it looks; found after the run.
    RareLooks {
        /// The greatest acceleration that every second look finds, over that of all looks.
        share: f64,
    },
    /// What damping by relaxation mechanisms costs a part.
    FlatDamping {
        /// The part's set.
        set: String,
        /// What it costs.
        cost: DampingCost,
    },
    /// A part is elastic and undamped along the absorbing faces.
    Rim {
        /// The part's set.
        set: String,
        /// The rim's width (m).
        width: f64,
        /// Elements of the rim.
        elements: usize,
        /// Elements of the part.
        of: usize,
    },
    /// What does not fit together in a material.
    Material {
        /// The part's set.
        set: String,
        /// What is said of it.
        doubt: String,
    },
    /// Something that can hardly be meant.
    Doubt(SceneDoubt),
}

impl Remark {
    /// What of the results it is about.
    pub fn topic(&self) -> Topic {
        match self {
            Self::Record { .. }
            | Self::RecordFile { .. }
            | Self::Conversion { .. }
            | Self::QuietMotion { .. }
            | Self::CutShort { .. }
            | Self::TurnedAxis { .. }
            | Self::UnusedRecord { .. } => Topic::Input,
            Self::TetrahedralSection { .. } => Topic::Sections,
            Self::LargeSlip { .. } | Self::JointAnew { .. } => Topic::Joints,
            Self::NoState { .. }
            | Self::Undersampled { .. }
            | Self::RareLooks { .. }
            | Self::Doubt(SceneDoubt::ShortInterval { .. } | SceneDoubt::LongInterval { .. }) => {
                Topic::Histories
            }
            Self::Doubt(SceneDoubt::HeldField { .. } | SceneDoubt::AbsorbingSurface { .. }) => {
                Topic::Input
            }
            _ => Topic::Run,
        }
    }
    /// As files have it, whether it is a doubt or not.
    pub fn doubt(&self) -> Doubt {
        Doubt {
            about: self.topic(),
            text: self.to_string(),
        }
    }
    /// Whether it is a doubt about the result, not only a fact.
    pub fn is_warning(&self) -> bool {
        match self {
            Self::QuietMotion {
                padding,
                waves: Some(waves),
                ..
            } => padding != waves,
            Self::Doubt(doubt) => doubt.is_warning(),
            Self::Record { report, .. } => report.peak_acceleration > LARGE_PEAK,
            Self::Unbalanced { .. }
            | Self::Undersampled { .. }
            | Self::RareLooks { .. }
            | Self::DampedRim { .. }
            | Self::DampedHistory { .. }
            | Self::Hourglass { .. }
            | Self::LargeSlip { .. }
            | Self::TetrahedralSection { .. }
            | Self::NonlinearRim { .. }
            | Self::Material { .. }
            | Self::UnusedRecord { .. }
            | Self::CutShort { .. }
            | Self::TurnedAxis { .. }
            | Self::AboveGround { .. }
            | Self::EmptySet { .. }
            | Self::NoState { .. }
            | Self::RecordFile { .. }
            | Self::OpenSide { .. }
            | Self::LoadedSurface { .. } => true,
            Self::FlatDamping { .. }
            | Self::Rim { .. }
            | Self::Conversion { .. }
            | Self::QuietStart { .. }
            | Self::Region { .. }
            | Self::JointAnew { .. }
            | Self::QuietMotion { waves: None, .. }
            | Self::Scatterer { .. } => false,
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Doubt(doubt) => doubt.fmt(f),
            Self::Record {
                name,
                report,
                baseline,
            } => {
                write!(
                    f,
                    "record '{name}': PGA {:.3} m/s2 ({:.3} g), PGV {:.4} m/s, PGD {:.4} m; ends at {:.2e} m/s, {:.2e} m",
                    report.peak_acceleration,
                    report.peak_acceleration / STANDARD_GRAVITY,
                    report.peak_velocity,
                    report.peak_displacement,
                    report.end_velocity,
                    report.end_displacement
                )?;
                if report.peak_acceleration > LARGE_PEAK {
                    write!(
                        f,
                        ", which few records have ever reached: are its units declared as they are?"
                    )?;
                }
                if let Some(baseline) = baseline {
                    write!(
                        f,
                        "; baseline {} took at most {:.2e} m/s2 from it, it had ended at {:.2e} m/s, {:.2e} m",
                        baseline.correction.name(),
                        baseline.largest_change,
                        baseline.before.end_velocity,
                        baseline.before.end_displacement
                    )?;
                    if baseline.leading_pad > 0.0 {
                        let pad = baseline.leading_pad;
                        write!(
                            f,
                            " and begins {pad:.3} s before its own start with what the filter put there"
                        )?;
                    }
                }
                Ok(())
            }
            Self::RecordFile { name, doubt } => write!(f, "record '{name}': {doubt}"),
            Self::Conversion {
                wave,
                convention,
                conversion,
            } => match &conversion.within {
                None => write!(
                    f,
                    "{wave}: the incident wave is {:.4} of its record ({convention})",
                    conversion.amplitude.norm()
                ),
                Some(within) => write!(
                    f,
                    "{wave}: the incident wave was found from motion within the ground, regularised by {}, which misses {:.2e} of the record; it peaks at {:.3} of the record, where that has motion the ground passes on {:.3} or more",
                    within.regularisation,
                    within.misfit,
                    within.amplification,
                    within.least_transfer
                ),
            },
            Self::QuietStart { padding, waves } => {
                write!(
                    f,
                    "all waves arrive {padding:.3} s later so that the body may start at rest, the duration stays"
                )?;
                for (wave, start) in waves {
                    write!(
                        f,
                        "; {wave} needs {:.3} s, starts at {:.1e} of its peak or less and lost {:.1e} of it to a taper",
                        start.padding,
                        start.level.largest(),
                        start.removed
                    )?;
                }
                Ok(())
            }
            Self::QuietMotion {
                padding,
                records,
                waves,
            } => {
                write!(
                    f,
                    "prescribed motions come {padding:.3} s later so that the body may start at rest, the duration stays"
                )?;
                for (name, level) in records {
                    write!(
                        f,
                        "; what the filter put before record '{name}' has {level:.1e} of its peak at its own start"
                    )?;
                }
                match waves {
                    Some(waves) if waves != padding => {
                        write!(
                            f,
                            "; the waves come {waves:.3} s later: the two no longer fit together"
                        )
                    }
                    _ => Ok(()),
                }
            }
            Self::TurnedAxis {
                record,
                convention,
                clear,
                azimuth,
            } => write!(
                f,
                "record '{record}' is '{convention}' of a wave of azimuth {azimuth}: that is its direction of travel or the one across, not an axis of the mesh; '{clear}' says the same without this warning"
            ),
            Self::AboveGround { level, top } => write!(
                f,
                "the in-situ stress of the ground is zero above its level of {level} m, and the body reaches up to {top} m"
            ),
            Self::CutShort {
                name,
                share,
                run,
                record,
            } => write!(
                f,
                "the run ends at {run:.3} s, before record '{name}' at {record:.3} s: {:.1} % of its Arias intensity come before",
                100.0 * share
            ),
            Self::OpenSide { side, area } => write!(
                f,
                "{area:.4} m2 on the {side} of the mesh neither absorb nor are held: waves are reflected there"
            ),
            Self::LoadedSurface { share, position } => write!(
                f,
                "the free surface at ({:.3}, {:.3}, {:.3}) m would carry {:.1} % of the field's stress: the field's own surface lies elsewhere, or it has none",
                position.x,
                position.y,
                position.z,
                100.0 * share
            ),
            Self::Scatterer { position } => write!(
                f,
                "springs take their distance from ({:.3}, {:.3}, {:.3}) m, the middle of the parts that touch no absorbing face",
                position.x, position.y, position.z
            ),
            Self::Region { inside, layer } => write!(
                f,
                "the waves enter through {layer} elements around a region of {inside}; results outside of them hold scattered waves alone"
            ),
            Self::UnusedRecord { name } => {
                write!(
                    f,
                    "record '{name}' drives neither a wave nor a prescribed motion"
                )
            }
            Self::EmptySet { set } => write!(
                f,
                "a support or a load stands on the set '{set}', in which there is nothing: it does nothing"
            ),
            Self::NoState { name, element } => write!(
                f,
                "history '{name}' asks for the state of element {element}, whose law has no history variables"
            ),
            Self::LargeSlip { joint, share } => write!(
                f,
                "joint '{joint}' moved by {share:.2} of its facets' edges; its pairs keep their nodes, which holds up to about {:.2}",
                Results::SMALL_SLIP
            ),
            Self::TetrahedralSection {
                section,
                set,
                elements,
                of,
            } => write!(
                f,
                "section '{section}' cuts {elements} linear tetrahedra of '{set}' ({of} elements in all): its forces are wrong, bending moments by a factor of several, since such elements are too stiff in bending; mesh '{set}' with hexahedra or wedges, several across its thickness (finer tetrahedra come nearer slowly)"
            ),
            Self::JointAnew {
                joint,
                stage,
                renewal,
            } => {
                write!(
                    f,
                    "opening, slip and energies of joint '{joint}' count from "
                )?;
                match stage {
                    Some(stage) => write!(f, "where it stood before the stage '{stage}'")?,
                    None => write!(f, "where it stood when the body started to move")?,
                }
                match renewal {
                    Renewal::Grouted => write!(f, ": there it was grouted"),
                    Renewal::Released => write!(f, ": there its tie was taken off"),
                }
            }
            Self::NonlinearRim { set, law } => write!(
                f,
                "part '{set}' of the law '{law}' touches an absorbing face: the free field is elastic, so what yields there reflects its waves; give the part a rim"
            ),
            Self::DampedHistory { set, law } => write!(
                f,
                "part '{set}' of the law '{law}' has stiffness-proportional damping: where it yields or cracks the damping acts with what is left of the stiffness, and its stress adds to that of the law, up to the strength and beyond while it is elastic; outputs of stress and of sections do not contain it. Flat damping stays within the strength: damping = {{ kind = \"flat\", ... }}"
            ),
            Self::Hourglass { stage, set, share } => {
                let whence = match stage {
                    Some(stage) => format!("in stage '{stage}' "),
                    None => String::new(),
                };
                write!(
                    f,
                    "{whence}hourglass resistance takes {:.1} % of the internal work of set '{set}', more than 1 %: displacements and stresses there are its own in part; elements with the kernel \"hex8-full\" or \"hex8-b-bar\", or smaller ones, have less or none of it",
                    100.0 * share
                )
            }
            Self::Unbalanced {
                stage,
                share,
                displacement,
                node,
            } => write!(
                f,
                "the in-situ stress leaves {:.1} % of the load out of balance at the start of stage '{stage}', and the body moved by up to {displacement:.3e} m (node {node}) until it balanced: stress, density, gravity, surface loads and supports do not agree, and the stress is no longer the given one",
                100.0 * share
            ),
            Self::Undersampled { name, interval } => write!(
                f,
                "the acceleration of '{name}' changes around its peak from sample to sample by more than its own size: something rings faster than its samples of every {interval} s show, such as cracks that open or close, and its peak is that of the sample, not of the motion"
            ),
            Self::RareLooks { share } => write!(
                f,
                "every second look of the envelope alone finds {:.0} % of its greatest acceleration: its looks are so rare that they miss peaks, which a shorter interval (`every`) shows",
                100.0 * share
            ),
            Self::FlatDamping { set, cost } => write!(f, "damping of part '{set}': {cost}"),
            Self::Rim {
                set,
                width,
                elements,
                of,
            } => {
                let within = match *width {
                    0.0 => "touch the absorbing faces".to_owned(),
                    width => format!("touch the absorbing faces or are within {width} m of them"),
                };
                write!(
                    f,
                    "rim of part '{set}': {elements} of its {of} elements {within}; they are elastic and undamped"
                )
            }
            Self::Material { set, doubt } => write!(f, "material of part '{set}': {doubt}"),
            Self::DampedRim { set } => write!(
                f,
                "part '{set}' is damped and touches an absorbing face: the free field is elastic, so its waves are reflected there in part; give the part a rim"
            ),
        }
    }
}
