//! Plane waves in a half-space or a full space.

use powerhouse_model::{
    ElasticMedium, FieldSampler, IncidentField, ModelError, ParameterError, Vec3,
};
use std::sync::{Arc, OnceLock};

use crate::analytic::{AnalyticTables, StartTaper};
use crate::body::BodySampler;
use crate::evanescent::AnalyticSampler;
use crate::partial::{Arrival, PartialWave, half_space_waves, rotated};
use crate::signal::check_return;
use crate::within::{WITHIN_REGULARISATION, WithinRecord, incident_of_within};
use crate::{
    Angle, Complex, InputConvention, InputConversion, Signal, SurfaceReflection, WaveError,
    WaveKind,
};

/// Domain in which a plane wave travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Site {
    /// A homogeneous half-space under a horizontal free surface.
    HalfSpace {
        /// Height z of the free surface (m).
        surface: f64,
    },
    /// A homogeneous full space: the incident wave alone, in any direction. The stress of the wave does
    /// not vanish on the top of a model, which therefore needs the field and an absorbing boundary too.
    FullSpace,
}

/// Parameters of a plane wave: all but its time function.
///
/// The direction of travel is `(sin a cos f, sin a sin f, cos a)`, `a` the incidence and `f` the
/// azimuth. For unit signal P has the displacement `(sin a, 0, cos a)`, SV `(cos a, 0, -sin a)`, SH
/// `(0, 1, 0)`, each rotated by the azimuth about the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWaveParameters {
    /// Type of the incident wave.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical, 0 straight up. Under a free surface at most 89 degrees
    /// for P, 89.9 for SV and 90 for SH; in a full space up to 180.
    pub incidence: Angle,
    /// Azimuth: horizontal direction of travel, from +x towards +y.
    pub azimuth: Angle,
    /// Elastic medium of the site.
    pub medium: ElasticMedium,
    /// Domain: half-space or full space.
    pub site: Site,
    /// Reference point (m), at which the incident wave equals the signal; see [`first_hit_corner`].
    pub reference: Vec3,
    /// Time at which the signal's time zero passes the reference point (s).
    pub arrival: f64,
    /// Motion that the signal represents.
    pub convention: InputConvention,
}

impl PlaneWaveParameters {
    /// Parameters of a vertically incident wave under a free surface at the given height z (m), with the
    /// signal as the incident wave at the origin at time zero. Change the fields that differ.
    pub fn vertical(kind: WaveKind, medium: ElasticMedium, surface: f64) -> Self {
        Self {
            kind,
            incidence: Angle::ZERO,
            azimuth: Angle::ZERO,
            medium,
            site: Site::HalfSpace { surface },
            reference: Vec3::zeros(),
            arrival: 0.0,
            convention: InputConvention::Incident,
        }
    }

    /// Unit vector of the incident wave's direction of travel.
    pub fn direction(&self) -> Vec3 {
        direction(self.incidence, self.azimuth)
    }

    /// Slowness of the incident wave (s/m): its direction of travel over its speed. Its horizontal components are those of
    /// the waves that the free surface reflects, too.
    pub fn slowness(&self) -> Vec3 {
        self.direction() / self.kind.speed(&self.medium)
    }
}

/// Unit vector of the direction of travel of a wave that comes from below.
pub(crate) fn direction(incidence: Angle, azimuth: Angle) -> Vec3 {
    let (sine, cosine) = incidence.radians().sin_cos();
    let (across, along) = azimuth.radians().sin_cos();
    Vec3::new(sine * along, sine * across, cosine)
}

/// Corner of the box from `low` to `high` that a plane wave of the given direction reaches first.
///
/// ```
/// use powerhouse_model::Vec3;
/// use powerhouse_wavefield::first_hit_corner;
/// let (low, high) = (Vec3::new(-80.0, -70.0, -150.0), Vec3::new(80.0, 70.0, 0.0));
/// let corner = first_hit_corner(&low, &high, &Vec3::new(-0.5, 0.0, 0.866));
/// assert_eq!(corner, Vec3::new(80.0, -70.0, -150.0));
/// ```
pub fn first_hit_corner(low: &Vec3, high: &Vec3, direction: &Vec3) -> Vec3 {
    low.zip_zip_map(
        high,
        direction,
        |low, high, direction| {
            if direction < 0.0 { high } else { low }
        },
    )
}

/// Plane P, SV or SH wave with its reflections from the free surface: the incident field of a site.
///
/// The sampler of a [`prepare`](IncidentField::prepare)d set of points does one table look-up per
/// wave and point. Below the critical angle the waves are real multiples of the signal, exact at
/// all times. Past it ([`critical_angle`](crate::critical_angle)) the reflected waves are computed
/// from tables of the analytic signal, and begin before the incident wave arrives: see
/// [`start_level`](Self::start_level) and [`with_quiet_start`](Self::with_quiet_start). The tables
/// agree with the formulas to 1e-6 of the peak displacement and 1e-4 of the peak velocity for
/// pulses whose acceleration has corners (1e-7 for smooth ones, 1e-3 of the velocity for a record
/// with a corner at every sample). All samplers of a wave share them: about 15 MB for a record of
/// 20 s and a box 100 m deep.
///
/// Sources: K. Aki, P. G. Richards (2002), Quantitative Seismology, ch. 5; X. Wang, J. Chen,
/// M. Xiao (2019), Soil Dyn. Earthq. Eng. 119, Eqs. 4-10, whose delays are replaced by
/// `t - (x - x0).s` with one horizontal slowness for all waves.
#[derive(Clone)]
pub struct PlaneWave {
    parameters: PlaneWaveParameters,
    pub(crate) signal: Arc<dyn Signal>,
    waves: Vec<PartialWave>,
    conversion: InputConversion,
    taper: Option<StartTaper>,
    /// Tables of the analytic signal, made when first needed; clones share them.
    tables: Arc<OnceLock<AnalyticTables>>,
    name: String,
}

impl core::fmt::Debug for PlaneWave {
    fn fmt(&self, formatter: &mut core::fmt::Formatter) -> core::fmt::Result {
        formatter
            .debug_struct("PlaneWave")
            .field("parameters", &self.parameters)
            .field("conversion", &self.conversion)
            .finish_non_exhaustive()
    }
}

impl PlaneWave {
    /// Wave of the given parameters and signal.
    ///
    /// # Errors
    /// Grazing incidence under a free surface; a convention that needs a free surface in a full space, or
    /// a component whose surface coefficient is too small; a signal with a permanent displacement where
    /// it is to be phase-shifted; a number outside its range.
    pub fn new(
        parameters: PlaneWaveParameters,
        signal: Arc<dyn Signal>,
    ) -> Result<Self, WaveError> {
        const FARTHEST: f64 = 1e9;
        let PlaneWaveParameters {
            kind,
            incidence,
            azimuth,
            medium,
            site,
            reference,
            arrival,
            convention,
        } = parameters;
        let medium = ElasticMedium::new(medium.young, medium.poisson, medium.density)?;
        ParameterError::check("azimuth", azimuth.degrees(), -1e6, 1e6)?;
        ParameterError::check("arrival", arrival, -FARTHEST, FARTHEST)?;
        for (name, value) in ["reference.x", "reference.y", "reference.z"]
            .into_iter()
            .zip(reference.iter())
        {
            ParameterError::check(name, *value, -FARTHEST, FARTHEST)?;
        }
        let (sine, cosine) = azimuth.radians().sin_cos();
        let mut conversion = InputConversion {
            amplitude: Complex::new(1.0, 0.0),
            within: None,
        };
        let mut signal = signal;
        let waves = match site {
            Site::HalfSpace { surface } => {
                ParameterError::check("surface", surface, -FARTHEST, FARTHEST)?;
                let reflection = SurfaceReflection::new(kind, incidence, &medium)?;
                conversion.amplitude = convention.amplitude(&reflection)?;
                if let InputConvention::Within {
                    depth,
                    component,
                    regularisation,
                } = convention
                {
                    let record = WithinRecord {
                        depth,
                        component,
                        regularisation: regularisation.unwrap_or(WITHIN_REGULARISATION),
                    };
                    let (found, report) = incident_of_within(&*signal, &reflection, record)?;
                    signal = Arc::new(found);
                    conversion.within = Some(report);
                }
                half_space_waves(
                    &reflection,
                    conversion.amplitude,
                    (cosine, sine),
                    &medium,
                    Arrival {
                        reference,
                        time: arrival,
                        surface,
                    },
                )
            }
            Site::FullSpace => {
                ParameterError::check("incidence", incidence.degrees(), 0.0, 180.0)?;
                if convention != InputConvention::Incident {
                    return Err(WaveError::NoSurface {
                        convention: convention.name(),
                    });
                }
                vec![full_space_wave(&parameters, (cosine, sine))]
            }
        };
        let wave = Self {
            name: format!("{kind} wave at {:.4} degrees", incidence.degrees()),
            parameters,
            signal,
            waves,
            conversion,
            taper: None,
            tables: Arc::default(),
        };
        if !wave.is_causal() {
            check_return(&*wave.signal, "a wave past the critical angle")?;
        }
        Ok(wave)
    }

    /// Parameters of the wave.
    pub fn parameters(&self) -> &PlaneWaveParameters {
        &self.parameters
    }

    /// Conversion of the record into the incident wave.
    pub fn conversion(&self) -> &InputConversion {
        &self.conversion
    }

    /// Whether all waves are delayed real multiples of the signal. If not, the field begins before the
    /// signal does.
    pub fn is_causal(&self) -> bool {
        self.waves.iter().all(PartialWave::is_real)
    }

    /// Partial waves of the field, the incident one first.
    pub(crate) fn partial_waves(&self) -> &[PartialWave] {
        &self.waves
    }

    /// This wave delayed by a time (s), with the taper that it has. Equal delays of several waves keep
    /// their relative arrivals.
    #[must_use]
    pub fn later(&self, time: f64) -> Self {
        self.delayed(time, self.taper)
    }

    /// This wave delayed by a time (s), with a taper.
    pub(crate) fn delayed(&self, time: f64, taper: Option<StartTaper>) -> Self {
        let mut later = self.clone();
        later.parameters.arrival += time;
        for wave in &mut later.waves {
            wave.delay_by(time);
        }
        if later.taper != taper {
            later.taper = taper;
            later.tables = Arc::default();
        }
        later
    }

    /// Tables of the analytic signal.
    fn tables(&self) -> Result<&AnalyticTables, WaveError> {
        if let Some(tables) = self.tables.get() {
            return Ok(tables);
        }
        let tables = AnalyticTables::new(&*self.signal, self.taper)?;
        Ok(self.tables.get_or_init(|| tables))
    }

    fn check_points(&self, points: &[Vec3]) -> Result<(), WaveError> {
        let mut reach = 1.0f64;
        for (index, point) in points.iter().enumerate() {
            if !point.iter().all(|coordinate| coordinate.is_finite()) {
                return Err(WaveError::PointNotFinite { index });
            }
            reach = reach.max(point.amax());
        }
        if let Site::HalfSpace { surface } = self.parameters.site {
            // Tolerance for the rounding of coordinates in mesh files.
            let highest = surface + 1e-6 * reach;
            if let Some(index) = points.iter().position(|point| point.z > highest) {
                return Err(WaveError::AboveSurface {
                    index,
                    height: points[index].z,
                    surface,
                });
            }
        }
        Ok(())
    }
}

impl IncidentField for PlaneWave {
    fn name(&self) -> &str {
        &self.name
    }

    fn medium(&self) -> ElasticMedium {
        self.parameters.medium
    }

    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        let mut incident = self.clone();
        incident.waves.truncate(1);
        incident.parameters.site = Site::FullSpace;
        incident.name = format!("incident {}", self.name);
        Some(Box::new(incident))
    }

    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        self.check_points(points)?;
        if self.is_causal() {
            let signal = self.signal.clone();
            return Ok(Box::new(BodySampler::new(signal, &self.waves, points)));
        }
        let tables = self.tables()?;
        Ok(Box::new(AnalyticSampler::new(tables, &self.waves, points)))
    }
}

fn full_space_wave(parameters: &PlaneWaveParameters, (cosine, sine): (f64, f64)) -> PartialWave {
    let (rise, lift) = parameters.incidence.radians().sin_cos();
    let polarisation = match parameters.kind {
        WaveKind::P => [rise, 0.0, lift],
        WaveKind::SV => [lift, 0.0, -rise],
        WaveKind::SH => [0.0, 1.0, 0.0],
    };
    let real = |vector: [f64; 3]| vector.map(|value| Complex::new(value, 0.0));
    let slowness = 1.0 / parameters.kind.speed(&parameters.medium);
    PartialWave::new(
        rotated(real(polarisation), cosine, sine),
        rotated(real([rise * slowness, 0.0, lift * slowness]), cosine, sine),
        &parameters.medium,
        parameters.reference,
        parameters.arrival,
    )
}
