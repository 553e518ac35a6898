//! Recorded motions of a scene file, split into incident waves.

use super::draft::Draft;
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::Vec3;
use powerhouse_wavefield::{
    Angle, Ground, RecordedAt, Signal, SplitParameters, SplitReport, WaveError, WaveKind,
};

use super::ground::component;
use super::ordered;
use super::origin::Origin;
use super::record::{PreparedRecord, of_components};
use crate::spec::{At, Azimuth, Component, Finite, Incidence, Motion, Positive};
use powerhouse_scene::{Fault, Problem, Remark, magnitude, remark};

/// Band (Hz) in which the split of a motion is checked by default.
const BAND: [f64; 2] = [0.1, 15.0];
const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Z];

/// Incident wave of a motion.
pub(super) struct SplitWave {
    pub(super) kind: WaveKind,
    pub(super) incidence: Angle,
    pub(super) signal: Arc<dyn Signal>,
}

/// Incident waves of a motion.
pub(super) struct Split<'r> {
    pub(super) waves: Vec<SplitWave>,
    pub(super) azimuth: Angle,
    /// Top of the half-space below the record's point (m), where the waves have the time axis of the record.
    pub(super) reference: Vec3,
    pub(super) origin: Origin<'r>,
    /// Time at which the record begins at its point (s), if it is given.
    given: Option<f64>,
    /// The record's point (m).
    place: Vec3,
    /// Components that do not move.
    still: String,
    report: SplitReport,
}

impl Split<'_> {
    /// Time at which the record begins at its point (s); by default that at which the first wave reaches the body at the start
    /// of the run, from the travel times of the waves to it (s).
    pub(super) fn arrival(&self, travel: impl Iterator<Item = f64>, start: f64) -> f64 {
        self.given
            .unwrap_or_else(|| start - travel.fold(f64::INFINITY, f64::min))
    }

    /// Remark about the split, whose waves have an arrival (s).
    pub(super) fn remark(&self, arrival: f64) -> Remark {
        let (name, _) = self.origin.record.clone().unzip();
        let waves = self.waves.iter();
        let waves = waves.map(|wave| (wave.kind, wave.incidence.degrees()));
        Remark::from(remark::Split {
            record: name.unwrap_or_default(),
            waves: waves.collect(),
            azimuth: self.azimuth.degrees(),
            report: self.report,
            place: self.place,
            arrival: arrival + self.origin.lead,
            still: self.still.clone(),
        })
    }
}

/// Fault of a motion in a full space.
pub(super) fn in_full_space(
    table: &Motion,
    records: &BTreeMap<String, PreparedRecord>,
) -> Result<Fault, Fault> {
    let (_, record) = moving(table, records)?[0];
    let convention = "surface, outcrop or within";
    Ok(Fault::refused(
        record.convention.span(),
        WaveError::NoSurface { convention },
    ))
}

/// Components that a motion has.
fn moving<'r>(
    table: &Motion,
    records: &'r BTreeMap<String, PreparedRecord>,
) -> Result<Vec<(Component, &'r PreparedRecord)>, Fault> {
    let (given, span) = match &table.components {
        Some(given) => (&given[..], given.span()),
        None => (&COMPONENTS[..], table.record.span()),
    };
    if given.is_empty() {
        let (found, expected) = (
            "no component".into(),
            "one or more of \"x\", \"y\", \"z\"".into(),
        );
        return Err(Fault::new(span, Problem::Value { found, expected }));
    }
    let name = &table.record;
    let moving = given.iter().map(|&letter| {
        let own = At::new(letter, span.clone());
        let record = component(name, Some(&own), records);
        let record = record.map_err(|fault| match table.components {
            Some(_) => fault,
            None => fault.with_help(
                "a [[motion]] takes a record with `components` of x, y and z; give its own `components`, such as [\"x\", \"z\"], if the others do not move",
            ),
        })?;
        Ok((letter, record))
    });
    moving.collect()
}

/// Splits the record of a table into waves that are incident on the ground.
pub(super) fn split<'r>(
    table: &Motion,
    ground: &Ground,
    records: &'r BTreeMap<String, PreparedRecord>,
    scene: &Draft,
) -> Result<Split<'r>, Fault> {
    let moving = moving(table, records)?;
    let factor = table.factor.map_or(1.0, Finite::get);
    let mut components = [const { None }; 3];
    for (letter, record) in &moving {
        let peak = factor.abs() * record.report.peak_acceleration;
        if let (Err(magnitude), true) = (
            magnitude::RECORDED_PEAK.check("peak of the motion", peak),
            peak > 0.0 && !scene.magnitudes_allowed,
        ) {
            // The weaker components of a record may be small.
            let largest = moving
                .iter()
                .map(|(_, other)| other.report.peak_acceleration);
            if record.report.peak_acceleration >= largest.fold(0.0, f64::max) {
                return Err(Fault::of_magnitude(table.record.span(), magnitude));
            }
        }
        let signal = record.signal(factor);
        let signal = signal.map_err(|error| Fault::refused(table.record.span(), error))?;
        components[*letter as usize] = Some(signal as Arc<dyn Signal>);
    }
    let by_peak = |a: &&(Component, &PreparedRecord), b: &&(Component, &PreparedRecord)| {
        let of = |record: &PreparedRecord| record.report.peak_acceleration;
        of(a.1).total_cmp(&of(b.1))
    };
    let Some((_, largest)) = moving.iter().max_by(by_peak) else {
        let key = "components".into();
        return Err(Fault::new(table.record.span(), Problem::MissingKey { key }));
    };
    let recorded = of_components(&largest.convention)?;
    let parameters = parameters(table, ground, recorded)?;
    let split = parameters.split(components).map_err(|error| match error {
        WaveError::PermanentDisplacement { .. } => Fault::refused(table.record.span(), error),
        WaveError::MotionWithoutWave { .. } => Fault::refused(table.incidence.span(), error)
            .with_help("`components` names those that move; the others are then still"),
        WaveError::WeakComponent { .. } => Fault::refused(largest.convention.span(), error),
        WaveError::IllConditioned { .. } => {
            let band = table.band.as_ref().map(At::span);
            Fault::refused(band.unwrap_or(table.incidence.span()), error)
        }
        _ => Fault::refused(table.incidence.span(), error),
    })?;
    let (low, high) = scene.mesh.bounding_box();
    let [x, y] = match &table.at {
        Some(at) => [at[0].get(), at[1].get()],
        None => [0.5 * (low.x + high.x), 0.5 * (low.y + high.y)],
    };
    let height = match recorded {
        RecordedAt::Surface => ground.surface(),
        RecordedAt::Outcrop => ground.base(),
        RecordedAt::Within { depth, .. } => ground.surface() - depth,
    };
    let [p, sv] = parameters.p_sv.map_or([Angle::ZERO; 2], |angles| angles);
    let waves = [
        (WaveKind::P, p, split.p),
        (WaveKind::SV, sv, split.sv),
        (WaveKind::SH, parameters.sh.unwrap_or(Angle::ZERO), split.sh),
    ];
    let waves = waves.into_iter().filter_map(|(kind, incidence, signal)| {
        Some(SplitWave {
            kind,
            incidence,
            signal: signal?,
        })
    });
    let still = COMPONENTS
        .iter()
        .filter(|c| moving.iter().all(|(m, _)| m != *c));
    Ok(Split {
        waves: waves.collect(),
        azimuth: parameters.azimuth,
        reference: Vec3::new(x, y, ground.base()),
        origin: Origin {
            incidence: table.incidence.span(),
            times: [table.arrival.as_ref().map(At::span), None],
            is_timed: table.arrival.is_some(),
            lead: largest.lead,
            record: Some((table.record.to_string(), largest)),
        },
        given: table.arrival.as_ref().map(|arrival| arrival.get()),
        place: Vec3::new(x, y, height),
        still: still.map(|c| c.letter()).collect(),
        report: split.report,
    })
}

fn parameters(
    table: &Motion,
    ground: &Ground,
    recorded: RecordedAt,
) -> Result<SplitParameters, Fault> {
    let angle = |incidence: Incidence| Angle::from_degrees(incidence.get());
    let missing = |key: &str| {
        let key = key.into();
        Fault::new(table.incidence.span(), Problem::MissingKey { key })
    };
    let p_sv = match (table.incidence.p, table.incidence.sv) {
        (Some(p), Some(sv)) => Some([angle(p), angle(sv)]),
        (None, None) => None,
        (Some(_), None) => return Err(missing("sv")),
        (None, Some(_)) => return Err(missing("p")),
    };
    let sh = table.incidence.sh.map(angle);
    if p_sv.is_none() && sh.is_none() {
        return Err(missing("sv"));
    }
    let band = match &table.band {
        Some(band) => {
            let frequencies = band.map(Positive::get);
            ordered(band.span(), frequencies)?;
            frequencies
        }
        None => BAND,
    };
    Ok(SplitParameters {
        ground: ground.clone(),
        recorded,
        azimuth: Angle::from_degrees(table.azimuth.map_or(0.0, Azimuth::get)),
        p_sv,
        sh,
        band,
    })
}
