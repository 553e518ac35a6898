//! Incident waves of a scene file, and the free field that is their sum.

use super::draft::Draft;
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::{IncidentField, ModelError, Vec3};
use powerhouse_wavefield::{
    Angle, Ground, HarmonicBurst, InputConvention, LayerDamping, PlaneWave, PlaneWaveParameters,
    QuietStart, QuietStartLimits, Ricker, RickerQuantity, Signal, Site, SmoothPulse, WaveError,
    ZeroMeanPulse, critical_angle, first_hit_corner,
};

use super::motion;
use super::origin::Origin;
use super::record::{PreparedRecord, cut_short, of_component};
use super::{layers, named, stations, vector};
use crate::spec::{
    self, At, Azimuth, Convention, Finite, Positive, Pulse, SceneSpec, Space, Wave, WaveAxis,
};
use powerhouse_laws::Material;
use powerhouse_scene::internal::box_corners;
use powerhouse_scene::{
    Error, Fault, InitialMotion, Problem, Remark, SceneText, magnitude, remark,
};

/// Hint on several media along the absorbing faces.
const ONE_MEDIUM: &str = "where a tunnel or lining runs through, its part in `through` of the boundary, rollers on the front and back faces in place of absorbing ones, or one `slice` of the mesh across its axis; else one medium at all absorbing faces, or the layers of the ground as `[[layer]]` tables, which all faces then cross";
/// Hint on a filtered record whose motion at the start of the run is not negligible.
pub(super) const QUIETER: &str = "the filter of the record's `baseline` rings before its start: a higher `corner`, or another kind such as velocity-polynomial, leaves less of that";

/// Help where a wave that moves the ground before it arrives leaves no quiet start.
pub(super) const FASTER: &str = "past a critical angle, and where waves decay in a layer, the ground moves before the wave arrives, the longer before the slower the motion: a `baseline` of the record of kind high-pass (`corner` of 0.1 to 0.3 Hz) leaves less of that";

/// Adds the sum of all waves to the scene, in the medium along the absorbing faces, or in layers with a damping; or the motions
/// at stations.
pub(super) fn field(
    (text, file): (&SceneText, &SceneSpec),
    mut scene: Draft,
    records: &BTreeMap<String, PreparedRecord>,
    materials: &BTreeMap<String, Material>,
    damping: &[LayerDamping],
) -> Result<Draft, Fault> {
    if let Some(stations) = stations::section(file)? {
        return stations::field(text, stations, scene);
    }
    let first = match (file.waves.first(), file.motions.first()) {
        (Some(wave), _) => Some(wave.incidence.span()),
        (None, Some(motion)) => Some(motion.incidence.span()),
        (None, None) => None,
    };
    let missing = |span, key: &str| Fault::new(span, Problem::MissingKey { key: key.into() });
    let first = match (first, file.layers.first(), &file.boundary) {
        (Some(first), _, Some(_)) => first,
        // A wave needs a boundary through which it enters the mesh.
        (Some(first), _, None) => return Err(missing(first, "boundary")),
        (None, Some(layer), _) => return Err(missing(layer.material.span(), "wave")),
        (None, None, _) => return Ok(scene),
    };
    if !file.layers.is_empty() {
        return layers::field(file, scene, records, materials, damping);
    }
    let faces = scene.places.faces.clone();
    let refused = |error: Error| Fault::refused(faces.clone(), error);
    let media = scene.media_behind_boundary().map_err(refused)?;
    let &[medium] = &media[..] else {
        let count = media.len();
        let media = scene.media_at_faces().map_err(refused)?;
        let problem = Problem::SeveralMedia { count, media };
        return Err(Fault::new(faces, problem).with_help(ONE_MEDIUM));
    };
    let (low, high) = scene.mesh.bounding_box();
    let level = scene.level_of_sides();
    let level = level.map_err(|error| Fault::refused(scene.places.faces.clone(), error))?;
    let surface = file.ground.surface.as_ref().map_or(level, |at| at.get());
    let (mut waves, mut origins) = (Vec::new(), Vec::new());
    for table in &file.waves {
        let mut parameters = PlaneWaveParameters::vertical(table.kind, medium, surface);
        if file.ground.space == Space::FullSpace {
            parameters.site = Site::FullSpace;
        }
        parameters.incidence = Angle::from_degrees(table.incidence.get());
        parameters.azimuth = Angle::from_degrees(table.azimuth.map_or(0.0, Azimuth::get));
        parameters.reference = match &table.reference {
            Some(reference) => vector(reference),
            None => first_hit_corner(&low, &high, &parameters.direction()),
        };
        parameters.arrival = table.arrival.as_ref().map_or(0.0, |arrival| arrival.get());
        if let Some(remark) = unclear_axis(table, file) {
            scene.remarks.push(remark);
        }
        let wave = plane_wave(table, parameters, records, scene.magnitudes_allowed)?;
        let convention = wave.parameters().convention;
        if convention != InputConvention::Incident {
            scene.remarks.push(Remark::from(remark::Conversion {
                wave: wave.name().into(),
                convention: convention.name(),
                conversion: *wave.conversion(),
            }));
        }
        origins.push(Origin::of_wave(table, records)?);
        waves.push(wave);
    }
    let mut splits = Vec::with_capacity(file.motions.len());
    for table in &file.motions {
        if file.ground.space == Space::FullSpace {
            return Err(motion::in_full_space(table, records)?);
        }
        let ground = Ground::new(surface, Vec::new(), medium)
            .map_err(|error| Fault::refused(table.incidence.span(), error))?;
        let split = motion::split(table, &ground, records, &scene)?;
        let parameters = split.waves.iter().map(|wave| {
            let mut parameters = PlaneWaveParameters::vertical(wave.kind, medium, surface);
            parameters.incidence = wave.incidence;
            parameters.azimuth = split.azimuth;
            parameters.reference = split.reference;
            parameters
        });
        let mut parameters: Vec<PlaneWaveParameters> = parameters.collect();
        let corners = box_corners(&low, &Vec3::new(high.x, high.y, high.z.min(surface)));
        let travel = parameters.iter().map(|wave| travel_time(wave, &corners));
        let arrival = split.arrival(travel, scene.start);
        for (parameters, wave) in parameters.iter_mut().zip(&split.waves) {
            parameters.arrival = arrival - split.origin.lead;
            let wave = PlaneWave::new(*parameters, wave.signal.clone());
            waves.push(wave.map_err(|error| Fault::refused(table.incidence.span(), error))?);
            origins.push(split.origin.clone());
        }
        splits.push((waves.len() - 1, split));
    }
    let waves = quiet(waves, &origins, (low, high), &mut scene)?;
    let arrivals: Vec<f64> = waves.iter().map(|wave| wave.parameters().arrival).collect();
    scene.remarks.extend(
        splits
            .iter()
            .map(|(last, split)| split.remark(arrivals[*last])),
    );
    note_arrivals(&origins, &mut scene, &arrivals);
    let driven = scene.change(|scene| scene.with_plane_waves(waves));
    driven.map_err(|error| Fault::refused(first, error))
}

/// Keeps when the records of the waves begin, of several waves of a record the latest, and warns of those that the run
/// cuts short; from the arrivals of the waves (s).
pub(super) fn note_arrivals(origins: &[Origin], scene: &mut Draft, arrivals: &[f64]) {
    let mut latest: Vec<(&str, &PreparedRecord, f64)> = Vec::new();
    for (&arrival, origin) in arrivals.iter().zip(origins) {
        let Some((name, record)) = &origin.record else {
            continue;
        };
        match latest.iter_mut().find(|(known, ..)| known == name) {
            Some((.., last)) => *last = last.max(arrival),
            None => latest.push((name, record, arrival)),
        }
    }
    for (name, record, arrival) in latest {
        scene.record_arrivals.insert(name.into(), arrival);
        let remark = cut_short(name, record, arrival, scene);
        scene.remarks.extend(remark);
    }
}

/// Warning about a record along x or y of a wave whose azimuth is not 0.
pub(super) fn unclear_axis(table: &Wave, file: &SceneSpec) -> Option<Remark> {
    let azimuth = table.azimuth.map_or(0.0, Azimuth::get);
    let name = table.record.as_ref()?;
    let record = file.records.iter().find(|record| *record.name == **name)?;
    let (convention, clear) = match &*record.convention {
        Convention::SurfaceX => ("surface-x", "surface-along"),
        Convention::SurfaceY => ("surface-y", "surface-across"),
        Convention::Within(within) => match within.component {
            Some(WaveAxis::X) => ("x", "along"),
            Some(WaveAxis::Y) => ("y", "across"),
            _ => return None,
        },
        _ => return None,
    };
    (azimuth % 360.0 != 0.0).then(|| {
        Remark::from(remark::RotatedAxis {
            record: name.to_string(),
            convention,
            clear,
            azimuth,
        })
    })
}

/// Record of a wave: by its name, or by name and component.
pub(super) fn component<'r>(
    name: &At<String>,
    component: Option<&At<spec::Component>>,
    records: &'r BTreeMap<String, PreparedRecord>,
) -> Result<&'r PreparedRecord, Fault> {
    let Some(component) = component else {
        return named("record", name, records);
    };
    let full = format!("{}.{}", **name, component.letter());
    named("record", &At::new(full, component.span()), records)
}

fn plane_wave(
    table: &Wave,
    mut parameters: PlaneWaveParameters,
    records: &BTreeMap<String, PreparedRecord>,
    allowed: bool,
) -> Result<PlaneWave, Fault> {
    let motion = motion(table, records, allowed)?;
    parameters.convention = motion.convention;
    parameters.arrival -= motion.lead;
    PlaneWave::new(parameters, motion.signal)
        .map_err(|error| refused_wave(table, motion.span, error))
}

/// Fault of a wave that was refused; `span` is that of its convention.
pub(super) fn refused_wave(table: &Wave, span: core::ops::Range<usize>, error: WaveError) -> Fault {
    match error {
        WaveError::WeakComponent { .. } | WaveError::NoSurface { .. } => {
            Fault::refused(span, error)
        }
        WaveError::GrazingIncidence { .. } => Fault::refused(table.incidence.span(), error)
            .with_help("a smaller angle, or `space = \"full-space\"` under [ground]"),
        _ => Fault::refused(table.incidence.span(), error),
    }
}

/// Motion that a wave brings.
pub(super) struct WaveMotion {
    pub(super) signal: Arc<dyn Signal>,
    pub(super) convention: InputConvention,
    /// Lead of its record (s).
    pub(super) lead: f64,
    /// Byte range of the convention of its record, or of its incidence.
    pub(super) span: core::ops::Range<usize>,
}

/// Motion of a wave: its record or its pulse.
pub(super) fn motion(
    table: &Wave,
    records: &BTreeMap<String, PreparedRecord>,
    allowed: bool,
) -> Result<WaveMotion, Fault> {
    let factor = table.factor.map_or(1.0, Finite::get);
    let span = table.incidence.span();
    if let (Some(component), None) = (&table.component, &table.record) {
        let key = "record".into();
        return Err(Fault::new(component.span(), Problem::MissingKey { key }));
    }
    match (&table.record, &table.pulse) {
        (Some(name), None) => {
            let record = component(name, table.component.as_ref(), records)?;
            let peak = factor.abs() * record.report.peak_acceleration;
            if let (Err(magnitude), true) = (
                magnitude::RECORDED_PEAK.check("peak of the wave", peak),
                factor != 0.0 && !allowed && record.report.peak_acceleration > 0.0,
            ) {
                return Err(Fault::of_magnitude(name.span(), magnitude));
            }
            let signal = record.signal(factor);
            Ok(WaveMotion {
                signal: signal.map_err(|error| Fault::refused(name.span(), error))?,
                convention: of_component(&record.convention)?,
                lead: record.lead,
                span: record.convention.span(),
            })
        }
        (None, Some(pulse)) => Ok(WaveMotion {
            signal: self::pulse(pulse, factor)
                .map_err(|error| Fault::refused(pulse.span(), error))?,
            convention: InputConvention::Incident,
            lead: 0.0,
            span,
        }),
        (record, pulse) => Err(Fault::new(
            span,
            Problem::OneOf {
                keys: &["record", "pulse"],
                found: usize::from(record.is_some()) + usize::from(pulse.is_some()),
            },
        )),
    }
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

/// Delays all waves so that the field is negligible at the start of a body at rest. Waves whose motion begins before
/// their record (past the critical angle, in the lead of a filter, or for within motions) determine the delay and are
/// tapered. A wave whose given arrival is before the start is an error.
fn quiet(
    waves: Vec<PlaneWave>,
    origins: &[Origin],
    (low, high): (Vec3, Vec3),
    scene: &mut Draft,
) -> Result<Vec<PlaneWave>, Fault> {
    if scene.initial == InitialMotion::Field {
        return Ok(waves);
    }
    let limits = QuietStartLimits::default();
    let mut quiet = Vec::with_capacity(waves.len());
    for (wave, origin) in waves.into_iter().zip(origins) {
        let refused = |error: ModelError| Fault::refused(origin.incidence.clone(), error);
        let of_ends = scene.check_wave_at_ends(&wave);
        of_ends.map_err(|error| Fault::refused(origin.incidence.clone(), error))?;
        let top = match wave.parameters().site {
            Site::HalfSpace { surface } => high.z.min(surface),
            Site::FullSpace => high.z,
        };
        let corners = box_corners(&low, &Vec3::new(high.x, high.y, top));
        let level = wave.start_level(&corners, scene.start).map_err(refused)?;
        if level.largest() < limits.threshold {
            quiet.push((wave, None));
            continue;
        }
        let (parameters, lead) = (wave.parameters(), origin.lead);
        let given = parameters.arrival + lead;
        if origin.is_timed && given + travel_time(parameters, &corners) < scene.start {
            return Err(origin.early(wave.name(), level.largest(), scene));
        }
        let (wave, start) = wave
            .with_quiet_start(&corners, scene.start, &limits)
            .map_err(|error| {
                if lead > 0.0 {
                    refused(error).with_help(QUIETER)
                } else {
                    refused(error).with_help(FASTER)
                }
            })?;
        quiet.push((wave, Some(start)));
    }
    let own = |start: &Option<QuietStart>| start.map_or(0.0, |start| start.padding);
    let padding = quiet
        .iter()
        .map(|(_, start)| own(start))
        .fold(0.0, f64::max);
    let delayed = quiet.iter();
    let delayed = delayed.map(|(wave, start)| wave.later(padding - own(start)));
    let delayed: Vec<PlaneWave> = delayed.collect();
    let needed = quiet.into_iter();
    let needed = needed.filter_map(|(wave, start)| Some((wave.name().to_owned(), start?)));
    let waves: Vec<(String, QuietStart)> = needed.collect();
    for wave in delayed.iter().filter(|wave: &&PlaneWave| !wave.is_causal()) {
        let start = waves.iter().find(|(name, _)| name == wave.name());
        let tapered = start.filter(|(_, start)| start.taper > 0.0);
        scene.remarks.push(Remark::from(remark::PastCritical {
            wave: wave.name().into(),
            critical: critical_angle(&wave.parameters().medium).degrees(),
            removed: tapered.map(|(_, start)| start.removed),
        }));
    }
    if !waves.is_empty() {
        scene
            .remarks
            .push(remark::QuietStart { padding, waves }.into());
    }
    Ok(delayed)
}

/// Travel time (s) of a wave from its reference point to the first of some points.
fn travel_time(parameters: &PlaneWaveParameters, points: &[Vec3]) -> f64 {
    let slowness = parameters.direction() / parameters.kind.speed(&parameters.medium);
    let delays = points
        .iter()
        .map(|point| (point - parameters.reference).dot(&slowness));
    delays.fold(f64::INFINITY, f64::min)
}
