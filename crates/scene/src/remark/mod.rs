//! Remarks: facts and warnings about a scene and its results.
//!
//! Each remark is a type of its own with its fields, its [topic](Topic), its text, and whether it is a fact or a warning;
//! [`Remark`] is any one of them.
//!
//! # Why so
//! *A remark is written in one place*, in the file of what it is about, and has one line in the list of [`Remark`]: a new one
//! needs no more.

/// Declares a remark whose text is one format string: its struct, its kind with its topic, and the arguments of [`format!`], in
/// which each field has its name. A remark whose kind or text depends on more is a struct that implements [`Item`].
macro_rules! remark {
    (
        $(#[$doc:meta])*
        pub struct $name:ident { $($(#[$of_field:meta])* pub $field:ident: $type:ty,)* }
        $kind:ident($topic:ident), $($text:tt)+
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name { $($(#[$of_field])* pub $field: $type,)* }

        impl $crate::remark::Item for $name {
            fn kind(&self) -> $crate::remark::Kind {
                $crate::remark::Kind::$kind($crate::Topic::$topic)
            }
            fn text(&self) -> String {
                let Self { $($field),* } = self;
                format!($($text)+)
            }
        }
    };
}

/// Makes a type with a `Display` a remark: the type, and a function that returns its kind.
macro_rules! described {
    ($type:ty, $kind:expr) => {
        impl $crate::remark::Item for $type {
            fn kind(&self) -> $crate::remark::Kind {
                let kind: fn(&Self) -> $crate::remark::Kind = $kind;
                kind(self)
            }
            fn text(&self) -> String {
                self.to_string()
            }
        }
    };
}
pub(crate) use described;

mod boundary;
mod equivalent_linear;
mod field;
mod joint;
mod mesh;
mod motion;
mod output;
mod part;
mod record;
mod record_spectrum;
mod region;
mod run;
mod saturated;
mod scene_file;
mod section;
mod stage;
mod water_warning;

pub use boundary::*;
pub use equivalent_linear::*;
pub use field::*;
pub use joint::*;
pub use mesh::*;
pub use motion::*;
pub use output::*;
pub use part::*;
pub use record::*;
pub use record_spectrum::RecordSpectrumReport;
pub use region::*;
pub use run::*;
pub use saturated::{SaturatedMaterial, Seepage};
pub use scene_file::*;
pub use section::*;
pub use stage::*;
pub use water_warning::{WaterReason, WaterWarning};

use core::fmt;

use crate::{
    AddedWater, BayTimes, BendingError, FibreChoice, FirstOfSet, HighDamping, Magnitude, Message,
    StiffPart, Topic, WetJoint,
};

/// Difference of the waves of a split motion from the record, or of a straight line from the motion of stations, over the peak,
/// above which it is warned of.
const LARGE_MISFIT: f64 = 0.01;

/// Whether a remark is a fact or a warning, and the results that it concerns.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Fact(Topic),
    Warning(Topic),
}

impl Kind {
    /// Kind of a remark that is a warning on a condition, and else a fact.
    pub(crate) fn warning_if(condition: bool, topic: Topic) -> Self {
        if condition {
            Self::Warning(topic)
        } else {
            Self::Fact(topic)
        }
    }
}

/// Kind and text of a remark.
pub(crate) trait Item {
    /// Whether it is a fact or a warning, and its topic.
    fn kind(&self) -> Kind;
    /// Its text, one sentence.
    fn text(&self) -> String;
}

/// Declares the remark that is any of those in the list: variant and type of each.
macro_rules! remarks {
    ($(#[$doc:meta])* $all:ident { $($name:ident($item:ty),)* }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum $all {
            $(#[doc = concat!("See [`", stringify!($item), "`].")] $name($item),)*
        }

        impl $all {
            fn item(&self) -> &dyn Item {
                match self { $(Self::$name(item) => item,)* }
            }
        }

        $(impl From<$item> for $all {
            fn from(item: $item) -> Self {
                Self::$name(item)
            }
        })*
    };
}

remarks! {
    /// Remark: a fact or a warning about a scene or its results ([`is_warning`](Self::is_warning)).
    ///
    /// ```
    /// use powerhouse_scene::{Remark, Topic, remark};
    /// let remark = Remark::from(remark::UnusedMaterial { name: "clay".into() });
    /// assert!(remark.is_warning() && remark.topic() == Topic::Run);
    /// assert_eq!(remark.to_string(), "material 'clay' is used by no part and no stage");
    /// ```
    Remark {
        Record(Record),
        RecordSource(RecordSource),
        RecordFile(RecordFile),
        RecordSpectrum(RecordSpectrum),
        LargeCorrection(LargeCorrection),
        WeakRecord(WeakRecord),
        Conversion(Conversion),
        Split(Split),
        RotatedAxis(RotatedAxis),
        TruncatedRecord(TruncatedRecord),
        UnusedRecord(UnusedRecord),
        PastCritical(PastCritical),
        Layered(Layered),
        QuietStart(QuietStart),
        DelayedMotion(DelayedMotion),
        PrescribedJump(PrescribedJump),
        PrescribedVelocity(PrescribedVelocity),
        EquivalentLinear(EquivalentLinear),
        LargeStrains(LargeStrains),
        BeyondStrainCurves(BeyondStrainCurves),
        RestrainedField(RestrainedField),
        AsymmetricField(AsymmetricField),
        PeriodicField(PeriodicField),
        AbsorbingSurface(AbsorbingSurface),
        LoadedSurface(LoadedSurface),
        Relief(Relief),
        Region(Region),
        Stations(Stations),
        StationWindow(StationWindow),
        OpenSide(OpenSide),
        Scatterer(Scatterer),
        ScattererAbove(ScattererAbove),
        SphericalSpreading(SphericalSpreading),
        Through(Through),
        DampedRim(DampedRim),
        NonlinearRim(NonlinearRim),
        Rim(Rim),
        WholeRim(WholeRim),
        UnusedMaterial(UnusedMaterial),
        EmptySet(EmptySet),
        Material(Material),
        DampedHistory(DampedHistory),
        FlatDamping(FlatDamping),
        LargeSlip(LargeSlip),
        JointRenewed(JointRenewed),
        ReducedStrength(ReducedStrength),
        UndampedFriction(UndampedFriction),
        CutBolts(CutBolts),
        CoarseBolts(CoarseBolts),
        UnsupportedBody(UnsupportedBody),
        SuddenGravity(SuddenGravity),
        IdleStages(IdleStages),
        WeightlessGround(WeightlessGround),
        AboveGround(AboveGround),
        Unbalanced(Unbalanced),
        TetrahedralSection(TetrahedralSection),
        DividedSection(DividedSection),
        HollowSection(HollowSection),
        SectionThroughEnd(SectionThroughEnd),
        Hinge(Hinge),
        BeyondCapacity(BeyondCapacity),
        PartialRing(PartialRing),
        NoState(NoState),
        RelativeInBay(RelativeInBay),
        Undersampled(Undersampled),
        SparseEnvelope(SparseEnvelope),
        ShortInterval(ShortInterval),
        LongInterval(LongInterval),
        StartedFrom(StartedFrom),
        Threads(Threads),
        NoEnergyBalance(NoEnergyBalance),
        Hourglass(Hourglass),
        CrackEnergy(CrackEnergy),
        HeavyFibres(HeavyFibres),
        UnsolvedSteps(UnsolvedSteps),
        MeshFile(MeshFile),
        MeshContent(MeshContent),
        MeshLeftOut(MeshLeftOut),
        MeshKeywords(MeshKeywords),
        MeshOrder(MeshOrder),
        OldPackedMesh(OldPackedMesh),
        FormerKey(FormerKey),
        ChangedKeys(ChangedKeys),
        Bending(BendingError),
        PoreWater(SaturatedMaterial),
        WaterWarning(WaterWarning),
        AddedWater(AddedWater),
        Fibres(Box<FibreChoice>),
        Magnitude(Magnitude),
        HighDamping(HighDamping),
        WetJoint(WetJoint),
        StiffPart(StiffPart),
        BayTimes(BayTimes),
        FirstOfRecordSet(FirstOfSet),
    }
}

impl Remark {
    /// Topic of the remark: the results that it concerns.
    pub fn topic(&self) -> Topic {
        let (Kind::Fact(topic) | Kind::Warning(topic)) = self.item().kind();
        topic
    }
    /// Text and topic, as written to result files.
    pub fn message(&self) -> Message {
        Message {
            about: self.topic(),
            text: self.to_string(),
        }
    }
    /// Returns whether the remark is a warning (`true`) or a fact (`false`).
    pub fn is_warning(&self) -> bool {
        matches!(self.item().kind(), Kind::Warning(_))
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.item().text())
    }
}

/// Comma-separated list of quoted names.
pub(crate) fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    names.join(", ")
}
