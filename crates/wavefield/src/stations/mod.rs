//! Motions that are given at stations: the incident field of a regional model.

mod error;
mod places;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use powerhouse_model::{
    ElasticMedium, FieldMotion, FieldSampler, IncidentField, ModelError, ParameterError, Vec3,
};

pub use error::StationError;
use places::Places;

/// Greatest difference between the change of the displacement over a step and that of the trapezoidal rule of the velocity,
/// over the step times the peak velocity. Four samples in a period differ by 0.2.
const OTHER_VELOCITY: f64 = 0.25;

/// Motions at stations, from which a [`StationField`] is made.
#[derive(Clone, Debug)]
pub struct StationParameters {
    /// Name of the field in reports, such as that of the file.
    pub name: String,
    /// Positions of the stations (m).
    pub positions: Vec<Vec3>,
    /// Whether each station is on the inner side of the layer through which the field enters; `None` if that is not known.
    pub inner: Option<Vec<bool>>,
    /// Elastic medium of the ground at the stations.
    pub medium: ElasticMedium,
    /// Time of the first sample (s).
    pub start: f64,
    /// Time between two samples (s), above zero.
    pub step: f64,
    /// Number of samples of a station, at least two.
    pub samples: usize,
    /// Whether the motions have velocities.
    pub has_velocity: bool,
    /// Motions, station by station and sample by sample: displacement x, y, z (m), then, if they have it, velocity x, y, z
    /// (m/s).
    pub motion: Vec<f64>,
    /// Greatest distance between a point and its station (m), above zero.
    pub tolerance: f64,
}

/// Interpolation between the samples of a [`StationField`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationInterpolation {
    /// Straight line between displacements.
    Linear,
    /// Cubic through displacements and velocities.
    Hermite,
}

/// Sampling of a [`StationField`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationReport {
    /// Number of stations.
    pub stations: usize,
    /// Number of samples of each.
    pub samples: usize,
    /// Time between two samples (s).
    pub step: f64,
    /// Time of the first sample (s).
    pub start: f64,
    /// Time of the last sample (s).
    pub end: f64,
    /// Interpolation between them.
    pub interpolation: StationInterpolation,
    /// Estimate of the greatest error of the displacement between samples over its peak (1): what interpolation from every
    /// second sample misses of those between, over 4 (linear) or 16 (Hermite), the ratios of the errors of both steps.
    pub error: f64,
    /// Greatest displacement (m).
    pub peak_displacement: f64,
    /// Greatest acceleration (m/s2), from the velocity or else the displacement of neighbouring samples.
    pub peak_acceleration: f64,
    /// Greatest displacement of the last sample (m).
    pub end_displacement: f64,
    /// Greatest velocity of the last sample (m/s); without velocities that of the last step.
    pub end_velocity: f64,
    /// Memory of the samples (bytes).
    pub bytes: usize,
}

/// Samples of all stations.
#[derive(Debug)]
struct Samples {
    start: f64,
    step: f64,
    count: usize,
    has_velocity: bool,
    motion: Vec<f64>,
}

/// Incident field whose motions are given at stations, such as those of a regional model around a site.
///
/// It is known at its stations alone and has no stress: it enters through the layer of elements around a region by the
/// domain reduction method, which needs the displacement of the nodes of that layer and nothing else (Bielak et al. 2003; masses
/// are lumped). A point has the motion of the station nearest to it, within the tolerance. Between samples the displacement is
/// a cubic through displacements and velocities, or a straight line without velocities; before the first and after the
/// last sample it is held. The velocity is the derivative of the displacement.
///
/// ```
/// use powerhouse_model::{ElasticMedium, FieldMotion, FieldSampler, IncidentField, Vec3};
/// use powerhouse_wavefield::{StationField, StationParameters};
/// let field = StationField::new(StationParameters {
///     name: "one station".into(),
///     positions: vec![Vec3::new(10.0, 0.0, 0.0)],
///     inner: None,
///     medium: ElasticMedium::new(1e9, 0.3, 2000.0)?,
///     start: 0.0,
///     step: 0.1,
///     samples: 3,
///     has_velocity: false,
///     motion: vec![0.0, 0.0, 0.0, 0.02, 0.0, 0.0, 0.01, 0.0, 0.0],
///     tolerance: 1e-3,
/// })?;
/// let mut motion = [FieldMotion::default()];
/// field.prepare(&[Vec3::new(10.0, 0.0, 0.0)])?.add_motion(0.05, &mut motion);
/// assert!((motion[0].displacement.x - 0.01).abs() < 1e-15);
/// assert!(!field.carries_stress());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct StationField {
    name: String,
    medium: ElasticMedium,
    places: Arc<Places>,
    inner: Option<Arc<[bool]>>,
    samples: Arc<Samples>,
    report: StationReport,
}

impl core::fmt::Debug for StationField {
    fn fmt(&self, formatter: &mut core::fmt::Formatter) -> core::fmt::Result {
        formatter
            .debug_struct("StationField")
            .field("name", &self.name)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl StationField {
    /// Field of the motions at stations.
    ///
    /// # Errors
    /// A number outside its range or not finite, lists whose lengths do not agree, two stations within twice the tolerance
    /// of each other, or velocities that are not those of the displacements.
    pub fn new(parameters: StationParameters) -> Result<Self, StationError> {
        let StationParameters {
            name,
            positions,
            inner,
            medium,
            start,
            step,
            samples: count,
            has_velocity,
            motion,
            tolerance,
        } = parameters;
        const FARTHEST: f64 = 1e9;
        ParameterError::check("start", start, -FARTHEST, FARTHEST)?;
        ParameterError::check("step", step, f64::MIN_POSITIVE, FARTHEST)?;
        ParameterError::check("samples", count as f64, 2.0, FARTHEST)?;
        ParameterError::check("tolerance", tolerance, f64::MIN_POSITIVE, FARTHEST)?;
        let stations = positions.len();
        let width = width(has_velocity);
        let expected = stations
            .checked_mul(count)
            .and_then(|n| n.checked_mul(width));
        let flags = inner.as_ref().map_or(stations, Vec::len);
        for (what, found, expected) in [
            ("side", flags, Some(stations)),
            ("number", motion.len(), expected),
        ] {
            if Some(found) != expected || stations == 0 {
                return Err(StationError::Count {
                    what,
                    found,
                    stations,
                });
            }
        }
        if let Some(index) = motion.iter().position(|number| !number.is_finite()) {
            return Err(StationError::NotFinite {
                station: index / (count * width),
                sample: index / width % count,
            });
        }
        let samples = Samples {
            start,
            step,
            count,
            has_velocity,
            motion,
        };
        let report = samples.report(stations);
        samples.check_velocity(stations)?;
        Ok(Self {
            name,
            medium,
            places: Arc::new(Places::new(positions, tolerance)?),
            inner: inner.map(Into::into),
            samples: Arc::new(samples),
            report,
        })
    }

    /// Sampling of the field, and its error between samples.
    pub fn report(&self) -> &StationReport {
        &self.report
    }
}

/// Numbers of a sample.
fn width(has_velocity: bool) -> usize {
    if has_velocity { 6 } else { 3 }
}

impl Samples {
    fn vector(&self, station: usize, sample: usize, first: usize) -> Vec3 {
        let at = (station * self.count + sample) * width(self.has_velocity) + first;
        Vec3::new(self.motion[at], self.motion[at + 1], self.motion[at + 2])
    }
    fn displacement(&self, station: usize, sample: usize) -> Vec3 {
        self.vector(station, sample, 0)
    }
    fn velocity(&self, station: usize, sample: usize) -> Vec3 {
        self.vector(station, sample, 3)
    }

    /// Displacement and velocity at a share `s` of the interval between two samples.
    fn between(&self, station: usize, (first, last): (usize, usize), s: f64) -> (Vec3, Vec3) {
        let step = self.step * (last - first) as f64;
        let (u0, u1) = (
            self.displacement(station, first),
            self.displacement(station, last),
        );
        let slope = (u1 - u0) / step;
        if !self.has_velocity {
            return (u0 + (u1 - u0) * s, slope);
        }
        // u0 + s (u1 - u0) + s (1 - s) step ((1 - s) (v0 - slope) - s (v1 - slope))
        let start = self.velocity(station, first) - slope;
        let end = self.velocity(station, last) - slope;
        let r = 1.0 - s;
        let bend = start * (s * r * r * step) - end * (s * s * r * step);
        let velocity = slope + start * (r * (1.0 - 3.0 * s)) - end * (s * (2.0 - 3.0 * s));
        (u0 + (u1 - u0) * s + bend, velocity)
    }

    /// Displacement and velocity of a station at a time.
    fn at(&self, station: usize, time: f64) -> (Vec3, Vec3) {
        let last = self.count - 1;
        let place = (time - self.start) / self.step;
        // A time that is not a number has the motion of the first sample.
        if place.is_nan() || place < 0.0 {
            return (self.displacement(station, 0), Vec3::zeros());
        }
        if place > last as f64 {
            return (self.displacement(station, last), Vec3::zeros());
        }
        let first = (place as usize).min(last - 1);
        self.between(station, (first, first + 1), place - first as f64)
    }

    fn report(&self, stations: usize) -> StationReport {
        let mut peak_displacement = 0.0_f64;
        let (mut missed, mut change) = (0.0_f64, 0.0_f64);
        let (mut end_displacement, mut end_velocity) = (0.0_f64, 0.0_f64);
        let last = self.count - 1;
        for station in 0..stations {
            for sample in 0..=last {
                let here = self.displacement(station, sample);
                peak_displacement = peak_displacement.max(here.norm());
                if sample > 0 && self.has_velocity {
                    let rise = self.velocity(station, sample) - self.velocity(station, sample - 1);
                    change = change.max(rise.norm() / self.step);
                }
                if sample == 0 || sample == last {
                    continue;
                }
                let (between, _) = self.between(station, (sample - 1, sample + 1), 0.5);
                missed = missed.max((between - here).norm());
                if !self.has_velocity {
                    let around = self.displacement(station, sample - 1)
                        + self.displacement(station, sample + 1);
                    change = change.max((around - here * 2.0).norm() / (self.step * self.step));
                }
            }
            end_displacement = end_displacement.max(self.displacement(station, last).norm());
            let velocity = if self.has_velocity {
                self.velocity(station, last)
            } else {
                self.between(station, (last - 1, last), 1.0).1
            };
            end_velocity = end_velocity.max(velocity.norm());
        }
        let (interpolation, ratio) = if self.has_velocity {
            (StationInterpolation::Hermite, 16.0)
        } else {
            (StationInterpolation::Linear, 4.0)
        };
        StationReport {
            stations,
            samples: self.count,
            step: self.step,
            start: self.start,
            end: self.start + last as f64 * self.step,
            interpolation,
            error: if peak_displacement > 0.0 {
                missed / ratio / peak_displacement
            } else {
                0.0
            },
            peak_displacement,
            peak_acceleration: change,
            end_displacement,
            end_velocity,
            bytes: size_of_val(&self.motion[..]),
        }
    }

    /// Rejects velocities that are not the derivatives of the displacements.
    fn check_velocity(&self, stations: usize) -> Result<(), StationError> {
        if !self.has_velocity {
            return Ok(());
        }
        let (mut peak, mut worst) = (0.0_f64, (0.0_f64, 0));
        for station in 0..stations {
            for sample in 1..self.count {
                let (v0, v1) = (
                    self.velocity(station, sample - 1),
                    self.velocity(station, sample),
                );
                let slope = (self.displacement(station, sample)
                    - self.displacement(station, sample - 1))
                    / self.step;
                peak = peak.max(v1.norm()).max(slope.norm());
                let off = (slope - (v0 + v1) * 0.5).norm();
                if off > worst.0 {
                    worst = (off, station);
                }
            }
        }
        let (off, station) = worst;
        if off > OTHER_VELOCITY * peak {
            Err(StationError::OtherVelocity {
                station,
                share: off / peak,
            })
        } else {
            Ok(())
        }
    }
}

impl IncidentField for StationField {
    fn name(&self) -> &str {
        &self.name
    }

    fn medium(&self) -> ElasticMedium {
        self.medium
    }

    fn carries_stress(&self) -> bool {
        false
    }

    fn stations(&self) -> Option<&[Vec3]> {
        Some(self.places.positions())
    }

    fn check_layer(&self, nodes: &[Vec3], inner: &[bool]) -> Result<(), ModelError> {
        let stations = self.places.of_points(nodes)?;
        let Some(sides) = &self.inner else {
            return Ok(());
        };
        let of_nodes = nodes.iter().zip(inner).zip(stations);
        let mut others =
            of_nodes.filter(|((_, inner), station)| sides[*station as usize] != **inner);
        match others.next() {
            None => Ok(()),
            Some(((node, &inner), _)) => Err(StationError::OtherSide {
                node: (*node).into(),
                inner,
                count: 1 + others.count(),
            }
            .into()),
        }
    }

    /// None: incident and reflected waves are not known apart.
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }

    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        Ok(Box::new(StationSampler {
            stations: self.places.of_points(points)?,
            samples: self.samples.clone(),
        }))
    }
}

/// Sampler of some of the stations.
struct StationSampler {
    stations: Vec<u32>,
    samples: Arc<Samples>,
}

impl FieldSampler for StationSampler {
    fn len(&self) -> usize {
        self.stations.len()
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        for (motion, &station) in motion.iter_mut().zip(&self.stations) {
            let (displacement, velocity) = self.samples.at(station as usize, time);
            motion.displacement += displacement;
            motion.velocity += velocity;
        }
    }
}
