//! Plane waves in horizontal layers over a half-space.

mod ground;
mod heights;
mod known;
mod record;
mod response;
mod sampler;
mod stack;
mod states;
mod tables;
#[cfg(test)]
mod tests;
mod window;

use powerhouse_model::{
    ElasticMedium, FieldSampler, IncidentField, ModelError, ParameterError, Vec3,
};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

pub use ground::{Ground, GroundLayer, LayerDamping, LayerMechanism};
use heights::{Heights, MOST_HEIGHTS};
pub use known::KnownLayeredWaves;
pub(crate) use response::{Response, ResponsePlace};
use sampler::{LayeredPoint, LayeredSampler};
pub use tables::LayeredTablesReport;
use tables::{LayeredTables, Table};
use window::Arriving;

use crate::wave::direction;
use crate::{
    Angle, Complex, InputConvention, InputConversion, Signal, SignalSupport, SurfaceReflection,
    WaveError, WaveKind,
};

/// Parameters of a plane wave in layered ground: all but its time function.
///
/// Direction and displacement of the incident wave are those of
/// [`PlaneWaveParameters`](crate::PlaneWaveParameters), in the half-space below the layers.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredWaveParameters {
    /// Type of the incident wave.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical in the half-space, 0 straight up: at most 89 degrees for P,
    /// 89.9 for SV and SH.
    pub incidence: Angle,
    /// Azimuth: horizontal direction of travel, from +x towards +y.
    pub azimuth: Angle,
    /// Layers and half-space.
    pub ground: Ground,
    /// Reference point (m), at which the incident wave equals the signal; of a point above the top of the
    /// half-space its foot there.
    pub reference: Vec3,
    /// Time at which the signal's time zero passes the reference point (s).
    pub arrival: f64,
    /// Motion that the signal represents. An outcrop is that of the half-space. A record of the layered
    /// surface, or at a depth, is divided by its transfer function: its time zero becomes that of the
    /// incident wave at the top of the half-space below the record.
    pub convention: InputConvention,
    /// Lowest height z at which the field is sampled (m), such as the bottom of the mesh.
    pub lowest: f64,
    /// Time (s) from the arrival of the incident wave at a point up to which its motion is needed: what
    /// reverberates after it is left out, and saves memory. `None` for all of it.
    pub until: Option<f64>,
}

impl LayeredWaveParameters {
    /// Parameters of a vertically incident wave whose signal is the incident wave at time zero at the top
    /// of the half-space, sampled down to a height z (m). Change the fields that differ.
    pub fn vertical(kind: WaveKind, ground: Ground, lowest: f64) -> Self {
        Self {
            kind,
            incidence: Angle::ZERO,
            azimuth: Angle::ZERO,
            reference: Vec3::new(0.0, 0.0, ground.base()),
            ground,
            arrival: 0.0,
            convention: InputConvention::Incident,
            lowest,
            until: None,
        }
    }
}

impl LayeredWaveParameters {
    /// Slowness of the incident wave (s/m) in the half-space: its direction of travel over its speed. Its horizontal components are
    /// those of all waves in the layers, too.
    pub fn slowness(&self) -> Vec3 {
        direction(self.incidence, self.azimuth) / self.kind.speed(&self.ground.half_space())
    }

    /// Time (s) at which the incident wave, or the first wave that it lets into the layers, has the signal's
    /// time zero at a point; in layers that of the top of the half-space below the point.
    pub fn arrival_at(&self, point: &Vec3) -> f64 {
        let speed = self.kind.speed(&self.ground.half_space());
        let (rise, lift) = self.incidence.radians().sin_cos();
        let (across, along) = self.azimuth.radians().sin_cos();
        let offset = point - self.reference;
        let base = self.ground.base();
        let height = point.z.min(base) - self.reference.z.min(base);
        let travelled = rise * (along * offset.x + across * offset.y) + lift * height;
        self.arrival + travelled / speed
    }
}

/// Form, memory and accuracy of a layered field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayeredReport {
    /// Whether the field is at rest before the incident wave arrives. If not, waves decay with depth in
    /// the half-space or in a layer, and the field begins before it.
    pub causal: bool,
    /// Horizontal slowness of all waves (s/m).
    pub horizontal_slowness: f64,
    /// Number of samples of the transforms.
    pub samples: usize,
    /// Time between two records of a table (s).
    pub step: f64,
    /// Largest motion at the end of the window of the transforms over its peak (1).
    pub residue: f64,
    /// Memory of the table of one height at most (bytes); layers with damping take up to half as much
    /// more for their heights.
    pub bytes_of_height: usize,
    /// Memory of spectra and of all tables that were made so far (bytes).
    pub bytes: usize,
    /// Tables that were made so far.
    pub tables: LayeredTablesReport,
}

/// Plane P, SV or SH wave that is incident on horizontal layers from the half-space below them: the
/// incident field of a layered site.
///
/// One horizontal slowness p serves all waves in all layers, so that the motion at a height is one
/// history, delayed by `p` times the distance along the direction of travel. These histories are computed
/// by reflection matrices in the frequency domain, which are stable at all thicknesses and frequencies,
/// and kept as tables, one for each height among the points: cubics through displacement and traction
/// and their derivatives. A causal field is computed with an exponential weight in time, so that what
/// still rings at the end of the window does not come back at its start; past the critical angle of the
/// half-space the part of constant spectrum is taken from tables of the analytic signal.
///
/// All samplers of a wave share its tables; [`report`](Self::report) gives their memory and errors of
/// interpolation. Points at one height to a millionth of the depth (or of the thinnest layer) share a
/// table; the tables of all heights take at most 2 GiB. Points of more than a thousand heights, as of tetrahedra, have
/// tables at fewer heights, between which their motion is interpolated by cubics, with an error that is measured and kept
/// below 1e-4 of the peak displacement.
///
/// Layers may be damped. The half-space is elastic: the incident wave of a damped one would grow
/// downwards. p is real and the same at all frequencies.
///
/// Sources: B. L. N. Kennett (1983), Seismic Wave Propagation in Stratified Media, ch. 6; K. Aki,
/// P. G. Richards (2002), Quantitative Seismology, ch. 5.
///
/// ```
/// use powerhouse_model::{ElasticMedium, FieldMotion, FieldSampler, IncidentField, Vec3};
/// use powerhouse_wavefield::*;
/// use std::sync::Arc;
/// // 20 m of soil over rock: SH waves straight up are amplified most at a quarter wavelength.
/// let soil = ElasticMedium::new(180e6, 0.25, 1800.0)?;
/// let rock = ElasticMedium::new(4.5e9, 0.25, 1800.0)?;
/// let ground = Ground::new(0.0, vec![GroundLayer::new(-20.0, soil)], rock)?;
/// let parameters = LayeredWaveParameters::vertical(WaveKind::SH, ground, -40.0);
/// let burst = HarmonicBurst::new(1.0, 0.25 * soil.s_speed() / 20.0, 40.0)?;
/// let wave = LayeredWave::new(parameters, Arc::new(burst))?;
/// let sampler = wave.prepare(&[Vec3::zeros()])?;
/// let mut largest = 0.0f64;
/// for step in 0..4000 {
///     let mut motion = [FieldMotion::default()];
///     sampler.add_motion(0.005 * f64::from(step), &mut motion);
///     largest = largest.max(motion[0].displacement.y);
/// }
/// // Twice the ratio of the impedances, which is five, less what the burst does not last for.
/// assert!((9.0..10.0).contains(&largest), "{largest}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct LayeredWave {
    parameters: LayeredWaveParameters,
    tables: Arc<LayeredTables>,
    /// Time at which the incident wave passes the foot of the reference point on the half-space (s).
    base_time: f64,
    causal: bool,
    residue: f64,
    support: SignalSupport,
    conversion: InputConversion,
    name: String,
}

impl core::fmt::Debug for LayeredWave {
    fn fmt(&self, formatter: &mut core::fmt::Formatter) -> core::fmt::Result {
        formatter
            .debug_struct("LayeredWave")
            .field("parameters", &self.parameters)
            .finish_non_exhaustive()
    }
}

impl LayeredWave {
    /// Wave of the given parameters and signal.
    ///
    /// # Errors
    /// Grazing incidence; a surface record of a component that the wave hardly moves at some frequency of it;
    /// a signal with a permanent displacement where the field is not causal or the record is not of the incident
    /// wave or an outcrop; layers in which the motion does not die
    /// out within a million samples; a number outside its range.
    pub fn new(
        parameters: LayeredWaveParameters,
        signal: Arc<dyn Signal>,
    ) -> Result<Self, WaveError> {
        const FARTHEST: f64 = 1e9;
        const LARGEST_ANGLE: f64 = 89.9;
        let ground = &parameters.ground;
        let (kind, incidence) = (parameters.kind, parameters.incidence);
        ParameterError::check("azimuth", parameters.azimuth.degrees(), -1e6, 1e6)?;
        ParameterError::check("arrival", parameters.arrival, -FARTHEST, FARTHEST)?;
        ParameterError::check("lowest", parameters.lowest, -FARTHEST, ground.surface())?;
        if let Some(until) = parameters.until {
            ParameterError::check("until", until, 0.0, FARTHEST)?;
        }
        for (name, value) in ["reference.x", "reference.y", "reference.z"]
            .into_iter()
            .zip(parameters.reference.iter())
        {
            ParameterError::check(name, *value, -FARTHEST, FARTHEST)?;
        }
        let reflection = SurfaceReflection::new(kind, incidence, &ground.half_space())?;
        if incidence.degrees() > LARGEST_ANGLE * (1.0 + 1e-14) {
            return Err(WaveError::GrazingIncidence {
                kind,
                degrees: incidence.degrees(),
                limit: LARGEST_ANGLE,
            });
        }
        let arriving = Arriving {
            ground,
            kind,
            reflection: &reflection,
            signal: &*signal,
            lowest: parameters.lowest,
            until: parameters.until,
        };
        let (incident, conversion) =
            record::incident(&arriving, signal.clone(), parameters.convention)?;
        // The incident wave of a record of the surface or of a depth begins before it, in a window of its own.
        let earlier = signal.support().start - incident.support().start;
        let arriving = Arriving {
            signal: &*incident,
            until: parameters.until.map(|until| until + earlier.max(0.0)),
            ..arriving
        };
        let causal = arriving.is_causal();
        if !causal {
            crate::signal::check_return(&*incident, "a wave that is not causal in its layers")?;
        }
        let (tables, residue) = arriving.tables()?;
        let below = (ground.base() - parameters.reference.z).max(0.0);
        Ok(Self {
            name: format!(
                "{kind} wave at {:.4} degrees in layers",
                incidence.degrees()
            ),
            base_time: parameters.arrival + reflection.vertical_slowness * below,
            support: incident.support(),
            conversion,
            parameters,
            tables: Arc::new(tables),
            causal,
            residue,
        })
    }

    /// Parameters of the wave.
    pub fn parameters(&self) -> &LayeredWaveParameters {
        &self.parameters
    }

    /// Conversion of the record into the incident wave.
    pub fn conversion(&self) -> &InputConversion {
        &self.conversion
    }

    /// Whether the field is at rest before the incident wave arrives.
    pub fn is_causal(&self) -> bool {
        self.causal
    }

    /// Form of the field, and memory and accuracy of the tables made so far.
    pub fn report(&self) -> LayeredReport {
        LayeredReport {
            causal: self.causal,
            horizontal_slowness: self.tables.stack.slowness,
            samples: self.tables.window.length,
            step: self.tables.step(),
            residue: self.residue,
            bytes_of_height: self.tables.most_bytes(),
            bytes: self.tables.bytes_of_spectra() + self.tables.report().bytes,
            tables: self.tables.report(),
        }
    }

    /// Memory (bytes) that the spectra and the tables of some points take at most, those made before included. Points of more than a thousand
    /// heights have tables at fewer heights, which are made now.
    ///
    /// # Errors
    /// [`WaveError::TableMemory`].
    pub fn bytes_for(&self, points: &[Vec3]) -> Result<usize, WaveError> {
        let count = match self.heights_for(points)? {
            Some(heights) => heights.count(),
            None => self.heights_of(points),
        };
        let damped = self.parameters.ground.layers().iter();
        let share = if damped.clone().all(|layer| layer.damping.is_none()) {
            2
        } else {
            3
        };
        Ok(self.tables.bytes_of_spectra() + count * self.tables.most_bytes() * share / 2)
    }

    /// This wave delayed by a time (s); both share their tables.
    #[must_use]
    pub fn later(&self, time: f64) -> Self {
        let mut later = self.clone();
        later.parameters.arrival += time;
        later.base_time += time;
        later
    }

    /// Displacement at a height z (m) and a frequency (Hz) of a wave of unit displacement at the top of
    /// the half-space: along the direction of travel, across it, and up. Spectra are those of
    /// `exp(+i w t)`.
    ///
    /// # Errors
    /// A height above the surface, or below the lowest of the wave; a frequency that is not above zero.
    pub fn transfer(&self, height: f64, frequency: f64) -> Result<[Complex; 3], WaveError> {
        ParameterError::check("frequency", frequency, f64::MIN_POSITIVE, 1e9)?;
        self.check_heights([height].into_iter())?;
        let ground = &self.parameters.ground;
        let frequency = Complex::new(2.0 * PI * frequency, 0.0);
        let state = stack::transfer(ground, &self.tables.stack, height, frequency);
        let zero = Complex::new(0.0, 0.0);
        Ok(match self.tables.stack.order {
            1 => [zero, state[0], zero],
            _ => [state[0], zero, state[1]],
        })
    }

    /// Times (s) at which the signal's motion begins at the first of some points and ends, without its
    /// reverberation, at the last.
    pub(crate) fn times(&self, points: &[Vec3]) -> [f64; 2] {
        let delays = points.iter().map(|point| {
            let key = self.tables.key(point.z);
            self.base_time - self.tables.advance(key) + self.along(point)
        });
        let [first, last] = delays.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], delay| {
            [a.min(delay), b.max(delay)]
        });
        [self.support.start + first, self.support.end + last]
    }

    /// Step of the signal (s).
    pub(crate) fn signal_step(&self) -> f64 {
        self.support.step
    }

    /// Delay (s) by the distance from the reference point along the direction of travel.
    fn along(&self, point: &Vec3) -> f64 {
        let (sine, cosine) = self.parameters.azimuth.radians().sin_cos();
        let offset = point - self.parameters.reference;
        self.tables.stack.slowness * (cosine * offset.x + sine * offset.y)
    }

    fn check_points(&self, points: &[Vec3]) -> Result<(), WaveError> {
        let is_finite = |point: &Vec3| point.iter().all(|coordinate| coordinate.is_finite());
        if let Some(index) = points.iter().position(|point| !is_finite(point)) {
            return Err(WaveError::PointNotFinite { index });
        }
        self.check_heights(points.iter().map(|point| point.z))
    }

    fn check_heights(&self, heights: impl Iterator<Item = f64>) -> Result<(), WaveError> {
        let (surface, lowest) = (self.parameters.ground.surface(), self.parameters.lowest);
        // Tolerance for the rounding of coordinates in mesh files.
        let rounding = 1e-6 * surface.abs().max(lowest.abs()).max(1.0);
        for (index, height) in heights.enumerate() {
            if height > surface + rounding {
                return Err(WaveError::AboveSurface {
                    index,
                    height,
                    surface,
                });
            }
            if height < lowest - rounding {
                return Err(WaveError::BelowLowest {
                    index,
                    height,
                    lowest,
                });
            }
        }
        Ok(())
    }

    /// Layer of a point whose medium is the given one: that at its height or, on an interface, one of
    /// both.
    fn layer_of(
        &self,
        index: usize,
        point: &Vec3,
        medium: &ElasticMedium,
    ) -> Result<usize, WaveError> {
        let ground = &self.parameters.ground;
        let key = self.tables.key(point.z);
        let below = self.tables.layer_of(key);
        let is_interface = below > 0 && self.tables.key(ground.extent(below)[0]) == key;
        let mut layers = [Some(below), is_interface.then(|| below - 1)]
            .into_iter()
            .flatten();
        let found = layers.find(|layer| are_alike(&ground.medium(*layer), medium));
        found.ok_or(WaveError::OtherMedium {
            index,
            depth: ground.surface() - point.z,
        })
    }

    /// Number of different heights of some points.
    fn heights_of(&self, points: &[Vec3]) -> usize {
        let mut keys: Vec<i64> = points.iter().map(|p| self.tables.key(p.z)).collect();
        keys.sort_unstable();
        keys.dedup();
        keys.len()
    }

    /// Heights between which the motion of some points is interpolated; none for points of few heights.
    fn heights_for(&self, points: &[Vec3]) -> Result<Option<Arc<Heights>>, WaveError> {
        if self.heights_of(points) <= MOST_HEIGHTS {
            return Ok(None);
        }
        Ok(Some(self.tables.heights(self.parameters.lowest)?))
    }

    fn sampler(
        &self,
        points: &[Vec3],
        layers: &[usize],
    ) -> Result<Box<dyn FieldSampler>, WaveError> {
        let ground = &self.parameters.ground;
        let p = self.tables.stack.slowness;
        let heights = self.heights_for(points)?;
        // The height, or those around it, of each point, and its damped layer.
        let places = points.iter().zip(layers).map(|(point, &layer)| {
            let damping = ground.layers().get(layer).map(|layer| &layer.damping);
            let damped = damping.filter(|damping| !damping.is_none()).map(|_| layer);
            let around = match &heights {
                None => vec![(self.tables.key(point.z), 1.0)],
                Some(heights) => heights.around(layer, self.tables.depth(point.z)).to_vec(),
            };
            (damped, around)
        });
        let places: Vec<Place> = places.collect();
        let all = places.iter().flat_map(|(damped, around)| {
            let used = around.iter().filter(|(_, weight)| *weight != 0.0);
            used.map(move |(key, _)| (*key, *damped))
        });
        let damped = all.clone().filter_map(|(key, layer)| Some((key, layer?)));
        self.tables.make(all.clone().map(|(key, _)| key), damped)?;
        let mut tables = Known::new(|key| self.tables.at(key));
        let mut products = Known::new(|(key, layer)| self.tables.product(key, layer));
        let mut prepared = Vec::with_capacity(points.len());
        for (index, ((point, &layer), (damped, around))) in
            points.iter().zip(layers).zip(&places).enumerate()
        {
            let medium = ground.medium(layer);
            let (lambda, shear) = (medium.lambda(), medium.shear());
            let coupling = match self.tables.stack.order {
                1 => p * shear,
                _ => p * 4.0 * shear * (lambda + shear) / medium.constrained(),
            };
            for &(key, weight) in around.iter().filter(|(_, weight)| *weight != 0.0) {
                prepared.push(LayeredPoint {
                    index: index as u32,
                    table: tables.place(key)?,
                    product: match damped {
                        Some(layer) => Some(products.place((key, *layer))?),
                        None => None,
                    },
                    delay: self.base_time - self.tables.advance(key) + self.along(point),
                    weight,
                    share: lambda / medium.constrained(),
                    coupling,
                    across: lambda / (2.0 * (lambda + shear)),
                });
            }
        }
        prepared.sort_by_key(|point| point.table);
        let (sine, cosine) = self.parameters.azimuth.radians().sin_cos();
        Ok(Box::new(LayeredSampler {
            of: self.tables.clone(),
            tables: tables.all,
            products: products.all,
            points: prepared,
            count: points.len(),
            turn: [cosine, sine],
        }))
    }
}

/// Damped layer of a point, and the heights around it with their weights.
type Place = (Option<usize>, Vec<(i64, f64)>);

/// Tables in the order of their first use.
struct Known<K, F> {
    places: BTreeMap<K, u32>,
    all: Vec<Arc<Table>>,
    make: F,
}

impl<K: Ord + Copy, F: Fn(K) -> Result<Arc<Table>, WaveError>> Known<K, F> {
    fn new(make: F) -> Self {
        Self {
            places: BTreeMap::new(),
            all: Vec::new(),
            make,
        }
    }

    /// Place of a table, which is made if it is not known.
    fn place(&mut self, key: K) -> Result<u32, WaveError> {
        if let Some(place) = self.places.get(&key) {
            return Ok(*place);
        }
        let place = self.all.len() as u32;
        self.all.push((self.make)(key)?);
        self.places.insert(key, place);
        Ok(place)
    }
}

/// Whether density and wave speeds of two media agree to 1e-6.
fn are_alike(a: &ElasticMedium, b: &ElasticMedium) -> bool {
    let of = |m: &ElasticMedium| [m.density, m.p_speed(), m.s_speed()];
    let pairs = of(a).into_iter().zip(of(b));
    pairs.fold(true, |alike, (a, b)| alike && (a - b).abs() <= 1e-6 * b)
}

impl IncidentField for LayeredWave {
    fn name(&self) -> &str {
        &self.name
    }

    fn medium(&self) -> ElasticMedium {
        self.parameters.ground.half_space()
    }

    fn interfaces(&self) -> &[f64] {
        self.parameters.ground.interfaces()
    }

    fn medium_at(&self, point: &Vec3) -> ElasticMedium {
        self.parameters.ground.medium_at(point.z)
    }

    /// None: the incident wave alone exists only below the layers.
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }

    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        self.check_points(points)?;
        let layers = points.iter();
        let layers = layers.map(|point| self.tables.layer_of(self.tables.key(point.z)));
        Ok(self.sampler(points, &layers.collect::<Vec<_>>())?)
    }

    fn prepare_in(
        &self,
        points: &[Vec3],
        media: &[ElasticMedium],
    ) -> Result<Box<dyn FieldSampler>, ModelError> {
        self.check_points(points)?;
        let of_points = points.iter().zip(media).enumerate();
        let layers = of_points.map(|(index, (point, medium))| self.layer_of(index, point, medium));
        Ok(self.sampler(points, &layers.collect::<Result<Vec<_>, _>>()?)?)
    }
}
