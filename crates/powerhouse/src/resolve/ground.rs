//! Records, waves and the field that they make.

use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::{IncidentField, ModelError, Vec3};
use powerhouse_wavefield::{
    Angle, BaselineCorrection, BaselineReport, EndDisplacement, HarmonicBurst, InputConvention,
    PlaneWave, PlaneWaveParameters, QuietStartLimits, RecordReport, Ricker, RickerQuantity, Signal,
    Site, SmoothPulse, Superposition, SurfaceComponent, TimeHistory, WaveError, WaveKind,
    ZeroMeanPulse, first_hit_corner,
};

use super::{named, unique, vector};
use crate::fault::{Fault, Problem, SceneText};
use crate::format::{
    self, Azimuth, Baseline, Component, Convention, Finite, NonNegative, Positive, Pulse,
    SceneFile, Share, Space, Wave,
};
use crate::scene::InitialMotion;
use crate::{Error, Remark, Scene};

/// What lies within this share of the mesh's diagonal below the highest point is its top.
const TOP_TOLERANCE: f64 = 1e-6;

/// A record ready to drive waves.
pub(super) struct PreparedRecord {
    pub(super) history: TimeHistory,
    /// Lasting displacement (m).
    end: f64,
    convention: InputConvention,
    /// Time that the record gained before its former start (s).
    lead: f64,
    /// Where its convention stands in the scene file.
    place: core::ops::Range<usize>,
    pub(super) report: RecordReport,
    pub(super) baseline: Option<BaselineReport>,
    /// What was taken differently from what the file declares.
    pub(super) doubts: Vec<String>,
}

/// Reads and treats all records, by name.
pub(super) fn records(
    text: &SceneText,
    file: &SceneFile,
) -> Result<BTreeMap<String, PreparedRecord>, Fault> {
    let mut records = BTreeMap::new();
    for table in &file.records {
        let record = record(text, table)?;
        unique("record", &table.name, &mut records, record)?;
    }
    Ok(records)
}

fn record(text: &SceneText, table: &format::Record) -> Result<PreparedRecord, Fault> {
    let name = table.name.span();
    let (mut history, doubts) = super::record::read(text, table)?;
    if let Some(cut) = &table.cut {
        let taper = table.taper.map_or(0.0, NonNegative::get);
        history = cut_out(&history, cut.map(NonNegative::get), taper)
            .map_err(|error| Fault::refused(cut.span(), error))?;
    }
    let mut baseline = None;
    let correction = correction(&table.baseline);
    if correction != BaselineCorrection::None {
        let (corrected, report) = history
            .corrected(correction)
            .map_err(|error| Fault::refused(table.baseline.span(), error))?;
        (history, baseline) = (corrected, Some(report));
    }
    if let Some(peak) = table.peak {
        history = history
            .scaled_to_peak(peak.get())
            .map_err(|error| Fault::refused(name.clone(), error))?;
    }
    let end = table.end_displacement.map_or(0.0, Finite::get);
    // A record that does not come to rest is refused here, where its name stands.
    let signal = history.clone().into_signal(EndDisplacement::Declared(end));
    let report = signal
        .map_err(|error| Fault::refused(name, error))?
        .report();
    Ok(PreparedRecord {
        history,
        end,
        convention: convention(&table.convention),
        lead: baseline.map_or(0.0, |report| report.leading_pad),
        place: table.convention.span(),
        report,
        baseline,
        doubts,
    })
}

/// The part of a history between two times (s).
fn cut_out(
    history: &TimeHistory,
    [start, end]: [f64; 2],
    taper: f64,
) -> Result<TimeHistory, WaveError> {
    let first = (start / history.step()).round() as usize;
    let samples = history.acceleration();
    let from_start = samples.get(first..).unwrap_or_default().to_vec();
    TimeHistory::new(history.step(), from_start)?.first(end - start, taper)
}

fn correction(baseline: &Baseline) -> BaselineCorrection {
    match *baseline {
        Baseline::None => BaselineCorrection::None,
        Baseline::Mean {} => BaselineCorrection::Mean,
        Baseline::AccelerationPolynomial { order } => {
            BaselineCorrection::AccelerationPolynomial { order }
        }
        Baseline::LeastVelocity { order } => BaselineCorrection::LeastVelocity { order },
        Baseline::VelocityPolynomial { order } => BaselineCorrection::VelocityPolynomial { order },
        Baseline::HighPass { corner, order } => BaselineCorrection::HighPass {
            corner: corner.get(),
            order,
        },
    }
}

fn convention(convention: &Convention) -> InputConvention {
    let surface = InputConvention::SurfaceComponent;
    match convention {
        Convention::Incident => InputConvention::Incident,
        Convention::Outcrop => InputConvention::Outcrop,
        Convention::SurfaceX => surface(SurfaceComponent::X),
        Convention::SurfaceY => surface(SurfaceComponent::Y),
        Convention::SurfaceZ => surface(SurfaceComponent::Z),
        Convention::Within(within) => InputConvention::Within {
            depth: within.depth.get(),
            component: match within.component {
                Component::X => SurfaceComponent::X,
                Component::Y => SurfaceComponent::Y,
                Component::Z => SurfaceComponent::Z,
            },
            regularisation: within.regularisation.map_or(0.05, Share::get),
        },
    }
}

/// The sum of all waves, in the medium behind the absorbing faces.
pub(super) fn field(
    file: &SceneFile,
    scene: &mut Scene,
    records: &BTreeMap<String, PreparedRecord>,
) -> Result<Option<Arc<dyn IncidentField>>, Fault> {
    let (Some(first), Some(section)) = (file.waves.first(), &file.boundary) else {
        return match file.waves.first() {
            // A wave needs a boundary to come in through.
            Some(wave) => {
                let key = "boundary".into();
                Err(Fault::new(
                    wave.incidence.span(),
                    Problem::MissingKey { key },
                ))
            }
            None => Ok(None),
        };
    };
    let faces = section
        .faces
        .first()
        .map_or(section.kind.span(), |face| face.span());
    let refused = |error: Error| Fault::refused(faces.clone(), error);
    let media = scene.media_behind_boundary().map_err(refused)?;
    let &[medium] = &media[..] else {
        let count = media.len();
        return Err(Fault::new(faces, Problem::SeveralMedia { count }));
    };
    for part in scene.parts_behind_boundary().map_err(refused)? {
        let part = &scene.parts[part];
        if part.damping != Default::default() {
            scene.remarks.push(Remark::DampedRim {
                set: part.set.clone(),
            });
        }
    }
    let (low, high) = scene.mesh.bounding_box();
    if file.ground.space == Space::FullSpace && !absorbs_on_top(scene).map_err(refused)? {
        scene.remarks.push(Remark::OpenTop);
    }
    let surface = file.ground.surface.as_ref().map_or(high.z, |at| at.get());
    let mut fields: Vec<Box<dyn IncidentField>> = Vec::new();
    for table in &file.waves {
        let mut parameters = PlaneWaveParameters::vertical(
            match table.kind {
                format::WaveKind::P => WaveKind::P,
                format::WaveKind::Sv => WaveKind::SV,
                format::WaveKind::Sh => WaveKind::SH,
            },
            medium,
            surface,
        );
        if file.ground.space == Space::FullSpace {
            parameters.site = Site::FullSpace;
        }
        parameters.incidence = Angle::from_degrees(table.incidence.get());
        parameters.azimuth = Angle::from_degrees(table.azimuth.map_or(0.0, Azimuth::get));
        parameters.reference = match &table.reference {
            Some(reference) => vector(reference),
            None => first_hit_corner(&low, &high, &parameters.direction()),
        };
        parameters.arrival = table.arrival.map_or(0.0, Finite::get);
        let wave = plane_wave(table, parameters, records)?;
        fields.push(Box::new(quiet(wave, (low, high), table, scene)?));
    }
    let sum = Superposition::new(fields)
        .map_err(|error| Fault::refused(first.incidence.span(), error))?;
    Ok(Some(Arc::new(sum)))
}

/// Whether an absorbing face covers a part of the top of the mesh's box.
fn absorbs_on_top(scene: &Scene) -> Result<bool, Error> {
    let (low, high) = scene.mesh.bounding_box();
    let top = high.z - TOP_TOLERANCE * (high - low).norm();
    let faces = scene.absorbing_facets()?;
    let mut facets = faces.iter().flat_map(|(_, facets)| facets.iter());
    Ok(facets.any(|&facet| scene.mesh.facet_geometry(facet).centroid.z >= top))
}

fn plane_wave(
    table: &Wave,
    mut parameters: PlaneWaveParameters,
    records: &BTreeMap<String, PreparedRecord>,
) -> Result<PlaneWave, Fault> {
    let factor = table.factor.map_or(1.0, Finite::get);
    let mut place = table.incidence.span();
    let signal: Arc<dyn Signal> = match (&table.record, &table.pulse) {
        (Some(name), None) => {
            let record = named("record", name, records)?;
            parameters.convention = record.convention;
            parameters.arrival -= record.lead;
            place = record.place.clone();
            let scaled = record.history.scaled(factor);
            let signal = scaled.and_then(|history| {
                history.into_signal(EndDisplacement::Declared(factor * record.end))
            });
            Arc::new(signal.map_err(|error| Fault::refused(name.span(), error))?)
        }
        (None, Some(pulse)) => {
            self::pulse(pulse, factor).map_err(|error| Fault::refused(pulse.span(), error))?
        }
        (record, pulse) => {
            return Err(Fault::new(
                place,
                Problem::OneOf {
                    keys: &["record", "pulse"],
                    found: usize::from(record.is_some()) + usize::from(pulse.is_some()),
                },
            ));
        }
    };
    PlaneWave::new(parameters, signal).map_err(|error| match error {
        WaveError::WeakComponent { .. } | WaveError::NoSurface { .. } => {
            Fault::refused(place, error)
        }
        WaveError::GrazingIncidence { .. } => Fault::refused(table.incidence.span(), error)
            .with_help("a smaller angle, or `space = \"full-space\"` under [ground]"),
        _ => Fault::refused(table.incidence.span(), error),
    })
}

fn pulse(pulse: &Pulse, factor: f64) -> Result<Arc<dyn Signal>, WaveError> {
    Ok(match pulse {
        Pulse::Smooth {
            displacement,
            duration,
        } => Arc::new(SmoothPulse::new(
            factor * displacement.get(),
            duration.get(),
        )?),
        Pulse::ZeroMean {
            displacement,
            duration,
        } => Arc::new(ZeroMeanPulse::new(
            factor * displacement.get(),
            duration.get(),
        )?),
        Pulse::Ricker {
            displacement,
            frequency,
            delay,
        } => Arc::new(Ricker::new(
            RickerQuantity::Displacement,
            factor * displacement.get(),
            frequency.get(),
            delay.map_or(1.5 / frequency.get(), Positive::get),
        )?),
        Pulse::Burst {
            displacement,
            frequency,
            cycles,
        } => Arc::new(HarmonicBurst::new(
            factor * displacement.get(),
            frequency.get(),
            cycles.get(),
        )?),
    })
}

/// A body at rest needs a field at rest: past the critical angle the field begins before the
/// record does, so it is delayed and tapered.
fn quiet(
    wave: PlaneWave,
    (low, high): (Vec3, Vec3),
    table: &Wave,
    scene: &mut Scene,
) -> Result<PlaneWave, Fault> {
    if wave.is_causal() || scene.initial == InitialMotion::Field {
        return Ok(wave);
    }
    let corners: Vec<Vec3> = (0..8)
        .map(|corner| {
            let pick = |axis: usize| {
                if corner >> axis & 1 == 0 {
                    low[axis]
                } else {
                    high[axis]
                }
            };
            Vec3::new(pick(0), pick(1), pick(2))
        })
        .collect();
    let (wave, start) = wave
        .with_quiet_start(&corners, scene.start, &QuietStartLimits::default())
        .map_err(|error: ModelError| Fault::refused(table.incidence.span(), error))?;
    scene.remarks.push(Remark::QuietStart {
        wave: wave.name().to_owned(),
        start,
    });
    Ok(wave)
}
