//! Errors of signals, waves and fields.

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

use crate::{SurfaceComponent, WaveKind};

/// Errors of building or sampling a signal or a wave field.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WaveError {
    /// A parameter is outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// There are fewer samples than an operation on a time history needs.
    #[error("{given} samples given, at least {least} needed for {operation}")]
    TooFewSamples {
        /// Operation that needs the samples.
        operation: &'static str,
        /// Number of samples.
        given: usize,
        /// Least number of samples.
        least: usize,
    },
    /// An operation on a time history or signal would need more samples than permitted.
    #[error("{operation} needs {needed:.0} samples, more than the permitted {most}")]
    TooManySamples {
        /// Operation that needs the samples.
        operation: &'static str,
        /// Number of samples needed.
        needed: f64,
        /// Greatest permitted number.
        most: usize,
    },
    /// A sample of acceleration is not a finite number.
    #[error("sample {index} is {value}, not a finite number")]
    SampleNotFinite {
        /// Index of the sample, from 0.
        index: usize,
        /// Value of the sample.
        value: f64,
    },
    /// The history is zero throughout, so that [`TimeHistory::scaled_to_peak`](crate::TimeHistory::scaled_to_peak) cannot
    /// scale it.
    #[error("the history is zero throughout and cannot be scaled to a peak")]
    ZeroPeak,
    /// A zone has another characteristic period than those of the code.
    #[error("the characteristic period of a zone is 0.35, 0.4 or 0.45 s, not {given}")]
    ZonePeriod {
        /// Period that was given (s).
        given: f64,
    },
    /// The velocity at the end of the record is above 1 % of its peak, so that it cannot be the signal of a wave
    /// ([`TimeHistory::into_signal`](crate::TimeHistory::into_signal)).
    #[error(
        "end velocity {velocity:.4e} m/s is above {limit:.4e} m/s, 1 % of the peak velocity; correct the baseline"
    )]
    EndVelocity {
        /// Velocity at the last sample (m/s).
        velocity: f64,
        /// Permitted magnitude (m/s).
        limit: f64,
    },
    /// The displacement at the end of the record differs from the declared one by more than 1 % of its peak, so that it
    /// cannot be the signal of a wave ([`TimeHistory::into_signal`](crate::TimeHistory::into_signal)).
    #[error(
        "end displacement {displacement:.4e} m differs from the declared {declared:.4e} m by more than {limit:.4e} m, 1 % of the peak displacement; correct the baseline or declare it"
    )]
    EndDisplacement {
        /// Displacement at the last sample (m).
        displacement: f64,
        /// Declared end displacement (m).
        declared: f64,
        /// Permitted difference (m).
        limit: f64,
    },
    /// The incidence is grazing: under a free surface the wave and its reflection cancel.
    #[error(
        "{kind} incidence of {} degrees is above {limit} degrees: a wave along the free surface cancels with its reflection; take a smaller angle, or a full space, whose stress does not vanish on top", rounded(*degrees)
    )]
    GrazingIncidence {
        /// Type of the incident wave.
        kind: WaveKind,
        /// Angle of incidence from the vertical (degrees).
        degrees: f64,
        /// Greatest permitted angle (degrees).
        limit: f64,
    },
    /// A point is above the free surface, where the field is not defined.
    #[error("point {index} at z = {height} m is above the free surface at z = {surface} m")]
    AboveSurface {
        /// Index of the point in the list that was given.
        index: usize,
        /// Height z of the point (m).
        height: f64,
        /// Height of the free surface (m).
        surface: f64,
    },
    /// A coordinate of a point is not a finite number.
    #[error("point {index} has a coordinate that is not a finite number")]
    PointNotFinite {
        /// Index of the point.
        index: usize,
    },
    /// The surface coefficient of the recorded component is too small to divide by, when a wave is built of a record of
    /// the surface; or the wave has no motion in the component of a record at a depth.
    #[error(
        "the surface moves by {coefficient:.4} of the incident {kind} wave in {component:?}, less than the permitted {limit}: the incident wave cannot be recovered from this component"
    )]
    WeakComponent {
        /// Type of the incident wave.
        kind: WaveKind,
        /// Component of the record.
        component: SurfaceComponent,
        /// Magnitude of the surface coefficient: surface amplitude per unit incident amplitude (1).
        coefficient: f64,
        /// Least permitted magnitude (1).
        limit: f64,
    },
    /// The input convention refers to a free surface, but the site is a full space.
    #[error("the input convention '{convention}' refers to a free surface; a full space has none")]
    NoSurface {
        /// Name of the input convention.
        convention: &'static str,
    },
    /// The signal has a permanent displacement, but it is to be phase-shifted or divided by a
    /// transfer function.
    #[error(
        "the signal ends at a displacement of {displacement:.4e} m; {operation} needs a signal that returns to zero, since the phase shift of a permanent displacement grows without bound"
    )]
    PermanentDisplacement {
        /// Operation that needs the signal to return to zero.
        operation: &'static str,
        /// Displacement after the signal's end (m).
        displacement: f64,
    },
    /// The motion at the start is above the threshold, even with the greatest permitted padding, in
    /// [`PlaneWave::with_quiet_start`](crate::PlaneWave::with_quiet_start).
    #[error(
        "with {padding} s of padding the field starts at {level:.3e} of its peak, above the threshold of {threshold:.3e}"
    )]
    NotQuiet {
        /// Greatest permitted padding (s).
        padding: f64,
        /// Motion at the start over the peak, with that padding (1).
        level: f64,
        /// Requested threshold (1).
        threshold: f64,
    },
    /// The P and SV waves of a split move the ground too much alike at some frequency of the band.
    #[error(
        "P at {} and SV at {} degrees move the place of the record too much alike: the condition number of the split is {condition:.1} at {frequency:.4} Hz, above {limit} in the band from {} to {} Hz; errors of one component would be amplified by as much in another. Take smaller angles, or a narrower band", rounded(*p), rounded(*sv), band[0], band[1]
    )]
    IllConditioned {
        /// Incidence of P (degrees).
        p: f64,
        /// Incidence of SV (degrees).
        sv: f64,
        /// Greatest condition number over the band (1).
        condition: f64,
        /// Frequency at which it occurs (Hz).
        frequency: f64,
        /// Greatest permitted condition number.
        limit: f64,
        /// Lowest and highest frequency of the band (Hz).
        band: [f64; 2],
    },
    /// The SV wave of a split is past the critical angle, so that the incident waves would not be causal.
    #[error(
        "a record is split into SV waves below the critical angle of {critical:.4} degrees alone, and SV comes in at {} degrees: past it the incident waves would begin before the record", rounded(*degrees)
    )]
    SplitPastCritical {
        /// Incidence of SV (degrees).
        degrees: f64,
        /// Critical angle (degrees).
        critical: f64,
    },
    /// A component of a recorded motion is moved by none of the waves that it is to be split into.
    #[error("the record moves {}, which takes {waves}, but no incidence of {waves} is given", way(*component))]
    MotionWithoutWave {
        /// Component in the frame of the waves.
        component: SurfaceComponent,
        /// Waves that move it.
        waves: &'static str,
    },
    /// A recorded motion has no component that waves with a given incidence would move.
    #[error(
        "an incidence of {waves} is given, but the record has no component that {waves} would move"
    )]
    WaveWithoutMotion {
        /// The waves.
        waves: &'static str,
    },
    /// A layer of the ground cannot be one.
    #[error("layer {} of the ground, whose top is {depth} m deep, {defect}", index + 1)]
    Layer {
        /// Index of the layer from the uppermost, from 0; the number of layers for the half-space.
        index: usize,
        /// Depth of its top below the surface (m).
        depth: f64,
        /// What is wrong with it.
        defect: LayerDefect,
    },
    /// A point lies below the lowest height of a layered field.
    #[error(
        "point {index} at z = {height} m is below the lowest height of the field, z = {lowest} m"
    )]
    BelowLowest {
        /// Index of the point in the list that was given.
        index: usize,
        /// Height z of the point (m).
        height: f64,
        /// Lowest height z (m).
        lowest: f64,
    },
    /// The stress at a point is wanted in a medium that is not that of its layer.
    #[error(
        "point {index}, {depth} m deep, is in another medium than the layer of the field there"
    )]
    OtherMedium {
        /// Index of the point in the list that was given.
        index: usize,
        /// Depth of the point below the surface (m).
        depth: f64,
    },
    /// The tables of a layered field take more memory than permitted.
    #[error(
        "the tables of the layered field at {heights} heights take {bytes} bytes, more than the permitted {most}: a shorter record or damped layers take less"
    )]
    TableMemory {
        /// Number of heights so far.
        heights: usize,
        /// Memory of their tables (bytes).
        bytes: usize,
        /// Permitted memory (bytes).
        most: usize,
    },
    /// A superposition was given no fields.
    #[error("a superposition needs at least one field")]
    NoFields,
    /// The fields of a superposition are in different media.
    #[error("field {index} is in another medium than field 0")]
    MediaDiffer {
        /// Index of the field whose medium differs from that of field 0.
        index: usize,
    },
}

/// What is wrong with a layer of the ground.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayerDefect {
    /// It does not lie below the layer before it, or below the surface.
    #[error(
        "ends at z = {bottom} m, which is not below its top at z = {top} m: layers are given from the uppermost down"
    )]
    NotBelow {
        /// Height z of its top (m).
        top: f64,
        /// Height z of its bottom (m).
        bottom: f64,
    },
    /// It is too thin.
    #[error("is {thickness:.3e} m thick, less than the permitted {least} m")]
    Thin {
        /// Thickness (m).
        thickness: f64,
        /// Least permitted thickness (m).
        least: f64,
    },
    /// Its medium is softer or lighter than any ground.
    #[error("has a {quantity} of {value:.4e}, less than the {least} of any ground (SI units)")]
    Soft {
        /// Quantity.
        quantity: &'static str,
        /// Its value (kg/m3 or m/s).
        value: f64,
        /// Least permitted value.
        least: f64,
    },
    /// A number of its medium or damping is outside its range.
    #[error("has a number outside its range: {0}")]
    Parameter(ParameterError),
}

/// Direction of a component in the frame of the waves, in words.
fn way(component: SurfaceComponent) -> &'static str {
    match component {
        SurfaceComponent::X => "along the direction of travel",
        SurfaceComponent::Y => "across the direction of travel",
        SurfaceComponent::Z => "up and down",
    }
}

/// Degrees without the rounding of their conversion.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

impl WaveError {
    /// Returns an error if an operation needs more samples than permitted.
    pub(crate) fn check_samples(
        operation: &'static str,
        needed: f64,
        most: usize,
    ) -> Result<(), Self> {
        if needed.is_finite() && needed <= most as f64 {
            return Ok(());
        }
        Err(Self::TooManySamples {
            operation,
            needed,
            most,
        })
    }
}

impl From<WaveError> for ModelError {
    fn from(error: WaveError) -> Self {
        Self::refused("wave field", error)
    }
}
