//! Topics of remarks, and which of them are warnings.

use super::{LARGE_CONDITION, LARGE_MISFIT, LARGE_PEAK, Remark};
use crate::SceneRemark;
use crate::message::{Message, Topic};

impl Remark {
    /// Topic of the remark: the results that it concerns.
    pub fn topic(&self) -> Topic {
        match self {
            Self::Record { .. }
            | Self::RecordFile { .. }
            | Self::RecordSource { .. }
            | Self::RecordSpectrum { .. }
            | Self::LargeCorrection { .. }
            | Self::WeakRecord { .. }
            | Self::PastCritical { .. }
            | Self::Layered { .. }
            | Self::EquivalentLinear { .. }
            | Self::BeyondStrainCurves { .. }
            | Self::LargeStrains { .. }
            | Self::Conversion { .. }
            | Self::Split { .. }
            | Self::DelayedMotion { .. }
            | Self::TruncatedRecord { .. }
            | Self::RotatedAxis { .. }
            | Self::Stations { .. }
            | Self::StationWindow { .. }
            | Self::UnusedRecord { .. } => Topic::Input,
            Self::TetrahedralSection { .. }
            | Self::PartialRing { .. }
            | Self::DividedSection { .. }
            | Self::HollowSection { .. }
            | Self::SectionThroughEnd { .. }
            | Self::Hinge { .. }
            | Self::BeyondCapacity { .. }
            | Self::HeavyFibres { .. }
            | Self::Bending(_) => Topic::Sections,
            Self::LargeSlip { .. }
            | Self::JointRenewed { .. }
            | Self::ReducedStrength { .. }
            | Self::Scene(SceneRemark::UndampedFriction { .. } | SceneRemark::WetJoint(_)) => {
                Topic::Joints
            }
            Self::Hourglass { .. } | Self::CrackEnergy { .. } => Topic::Energy,
            Self::NoState { .. }
            | Self::Undersampled { .. }
            | Self::SparseEnvelope { .. }
            | Self::Scene(SceneRemark::ShortInterval { .. } | SceneRemark::LongInterval { .. }) => {
                Topic::Histories
            }
            Self::Scene(
                SceneRemark::RestrainedField { .. }
                | SceneRemark::AsymmetricField { .. }
                | SceneRemark::PeriodicField { .. }
                | SceneRemark::AbsorbingSurface { .. }
                | SceneRemark::FirstOfRecordSet(_)
                | SceneRemark::PrescribedJump { .. }
                | SceneRemark::PrescribedVelocity { .. },
            ) => Topic::Input,
            _ => Topic::Run,
        }
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
        match self {
            Self::DelayedMotion {
                padding,
                waves: Some(waves),
                ..
            } => padding != waves,
            Self::Scene(warning) => warning.is_warning(),
            Self::AddedWater(water) => water.is_warning(),
            Self::PoreWater(material) => material.is_warning(),
            Self::Split { report, .. } => {
                report.condition > LARGE_CONDITION || report.misfit > LARGE_MISFIT
            }
            Self::Record { report, .. } => report.peak_acceleration > LARGE_PEAK,
            Self::RecordSpectrum { report, .. } => report.is_warning(),
            Self::StationWindow { run, report, .. } => run[1] > report.end,
            Self::Stations { report, .. } => report.error > LARGE_MISFIT,
            Self::Unbalanced { .. }
            | Self::Undersampled { .. }
            | Self::SparseEnvelope { .. }
            | Self::DampedRim { .. }
            | Self::DampedHistory { .. }
            | Self::Hourglass { .. }
            | Self::HeavyFibres { .. }
            | Self::LargeSlip { .. }
            | Self::TetrahedralSection { .. }
            | Self::DividedSection { .. }
            | Self::HollowSection { .. }
            | Self::SectionThroughEnd { .. }
            | Self::Bending(_)
            | Self::Hinge { .. }
            | Self::BeyondCapacity { .. }
            | Self::CrackEnergy { .. }
            | Self::NonlinearRim { .. }
            | Self::Material { .. }
            | Self::BeyondStrainCurves { .. }
            | Self::LargeStrains { .. }
            | Self::PartialRing { .. }
            | Self::UnusedRecord { .. }
            | Self::UnusedMaterial { .. }
            | Self::WeakRecord { .. }
            | Self::LargeCorrection { .. }
            | Self::TruncatedRecord { .. }
            | Self::RotatedAxis { .. }
            | Self::AboveGround { .. }
            | Self::EmptySet { .. }
            | Self::NoState { .. }
            | Self::RecordFile { .. }
            | Self::OpenSide { .. }
            | Self::LoadedSurface { .. }
            | Self::WaterWarning(_)
            | Self::ReducedStrength { .. } => true,
            Self::RecordSource { .. }
            | Self::FlatDamping { .. }
            | Self::Rim { .. }
            | Self::Conversion { .. }
            | Self::QuietStart { .. }
            | Self::PastCritical { .. }
            | Self::Layered { .. }
            | Self::EquivalentLinear { .. }
            | Self::StartedFrom { .. }
            | Self::Region { .. }
            | Self::Through { .. }
            | Self::JointRenewed { .. }
            | Self::DelayedMotion { waves: None, .. }
            | Self::Scatterer { .. } => false,
        }
    }
}
