//! Free-field ground motion: time histories and plane waves in a half-space, layers or a full space.
//!
//! A [`Signal`] is the displacement of a wave as a function of time: a test pulse ([`SmoothPulse`],
//! [`RaisedCosinePulse`], [`ZeroMeanPulse`], [`Ricker`], [`HarmonicBurst`]) or a record
//! ([`TimeHistory`], made into a [`RecordSignal`]). A [`PlaneWave`] propagates it through a medium,
//! with the reflections of a free surface, and is the
//! [`IncidentField`](powerhouse_model::IncidentField) of a boundary; several add up in a
//! [`Superposition`]. A [`LayeredWave`] is its form in horizontal layers over a half-space
//! ([`Ground`]). The motion that a record represents (the incident wave, an outcrop, the
//! surface, the motion at a depth) is its [`InputConvention`]; [`SplitParameters`] split a record of three
//! components into P, SV and SH waves. A [`StationField`] has the motions of a regional model at stations.
//!
//! ```
//! use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
//! use powerhouse_wavefield::{
//!     Angle, PlaneWave, PlaneWaveParameters, Site, SmoothPulse, WaveKind, first_hit_corner,
//! };
//! use std::sync::Arc;
//!
//! // A cube of 1200 m under a free surface and an SV wave at 15 degrees.
//! let rock = ElasticMedium::new(10e9, 0.3, 3000.0)?;
//! let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, rock, 1200.0);
//! parameters.incidence = Angle::from_degrees(15.0);
//! parameters.reference = first_hit_corner(
//!     &Vec3::zeros(),
//!     &Vec3::repeat(1200.0),
//!     &parameters.direction(),
//! );
//! let wave = PlaneWave::new(parameters, Arc::new(SmoothPulse::new(1.0, 0.8)?))?;
//!
//! let sampler = wave.prepare(&[Vec3::new(600.0, 600.0, 1200.0)])?;
//! let mut motion = [FieldMotion::default()];
//! sampler.add_motion(1.160849 + 0.4, &mut motion);
//! assert!((motion[0].displacement.x - 1.9207186).abs() < 1e-6);
//! assert!((motion[0].displacement.z + 0.5369212).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//! SI units, z up, tension positive, free surface horizontal. Incidence is measured from the
//! vertical, azimuth from +x towards +y. Spectra are those of `exp(+i w t)`. Time zero of a signal
//! is its arrival at the reference point.
//!
//! # Why so
//! *A record becomes a signal only if it ends at rest.* Its displacement acts on the springs of a
//! boundary, so a drift would displace the whole model; [`TimeHistory::into_signal`] checks the record
//! and defines the motion after its end.
//!
//! *Piecewise-linear acceleration* is the usual reading of a digitised record, and the one assumption
//! under which velocity, displacement, response spectrum and Fourier spectrum are all exact.
//!
//! *One horizontal slowness.* The delay of every wave is `(x - x0).s` with the same horizontal
//! slowness, in any direction. Stress follows from velocity, `-(1/c) sym(d (x) p) v`, so that no
//! derivative in space is taken. At the surface the delays of all waves are the same number, and
//! the coefficients let the traction vanish to rounding.
//!
//! *Past the critical angle* the reflected waves are phase-shifted by an amount that no delay can
//! express, and the P wave decays with depth, each frequency at its own rate. Both follow from one
//! function, the signal's analytic continuation above the real axis of time: a phase shift is a
//! complex factor, decay is an imaginary delay. It is tabulated over time and height for all points
//! together, and quintics through its values and derivatives are evaluated at complex arguments. All
//! waves, the incident one too, use the same tables, so that the traction at the surface vanishes to
//! rounding there as well.
//!
//! *In layers one history for each height.* With one horizontal slowness everything at a height moves
//! alike, later by the distance. So a field of any number of layers, with all that reverberates in
//! them, costs a look-up in a table of the point's height, whatever their number, and none of the
//! transforms is made during a run. Propagator matrices would lose all digits where waves decay across a
//! layer, stiffness matrices at low frequencies; reflection matrices lose none.
//!
//! *A quiet start.* Such a field begins before its incident wave, and its forerunner decays only as
//! a power of time. A field that is cut off does not satisfy the equation of motion. Here it is
//! multiplied by a function of time that is analytic down to the depth of the points: the product
//! satisfies the equation of motion and leaves the surface free, and the part that is removed is
//! reported ([`QuietStart`]).

mod analytic;
mod angle;
mod body;
mod combined;
mod convention;
mod design_spectrum;
mod error;
mod evanescent;
mod fourier;
mod hermite;
mod history;
mod layered;
mod matching;
mod partial;
mod pulse;
mod quiet;
mod reflection;
mod sampled;
mod signal;
mod spectrum;
mod split;
mod stations;
mod superposition;
mod wave;
mod within;

pub use angle::Angle;
pub use convention::{InputConvention, InputConversion, SurfaceComponent};
pub use design_spectrum::{
    Asce7, ChineseSite, DesignSpectrum, Eurocode8, Eurocode8Ground, Eurocode8Type, Nb35047,
    characteristic_period,
};
pub use error::{LayerDefect, WaveError};
pub use history::{
    BaselineCorrection, BaselineReport, EndDisplacement, RecordReport, RecordSignal, TimeHistory,
};
pub use layered::{
    Ground, GroundLayer, KnownLayeredWaves, LayerDamping, LayerMechanism, LayeredReport,
    LayeredTablesReport, LayeredWave, LayeredWaveParameters,
};
pub use matching::{MatchReport, SpectralBand, SpectralMisfit};
pub use pulse::{
    HarmonicBurst, RaisedCosinePulse, Ricker, RickerQuantity, SmoothPulse, ZeroMeanPulse,
};
pub use quiet::{QuietStart, QuietStartLimits, StartLevel};
pub use reflection::{SurfaceReflection, WaveKind, critical_angle};
pub use signal::{Signal, SignalMotion, SignalSupport};
pub use spectrum::{OscillatorResponse, SpectralLine, broadened_spectrum};
pub use split::{RecordedAt, SplitMotion, SplitParameters, SplitReport};
pub use stations::{
    StationError, StationField, StationInterpolation, StationParameters, StationReport,
};
pub use superposition::Superposition;
pub use wave::{PlaneWave, PlaneWaveParameters, Site, first_hit_corner};
pub use within::WithinReport;

/// Complex number, for spectra of `exp(+i w t)`.
pub type Complex = nalgebra::Complex<f64>;
