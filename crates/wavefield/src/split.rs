//! Split of a motion of three components into incident P, SV and SH waves.

use powerhouse_model::ParameterError;
use std::sync::Arc;

use crate::combined::combined;
use crate::layered::{Response, ResponsePlace};
use crate::sampled::{SampledSignal, SignalWindow};
use crate::signal::check_return;
use crate::{
    Angle, Complex, Ground, Signal, SignalSupport, SurfaceComponent, SurfaceReflection, WaveError,
    WaveKind, critical_angle,
};

/// Greatest condition number of the split over the band.
const LARGEST_CONDITION: f64 = 20.0;
/// Least motion of a component for a unit incident SH wave at the surface.
const LEAST_TRANSFER: f64 = 0.2;
/// Size of transfer functions, of which the regularisation is a share: that of a free surface.
const SURFACE: f64 = 2.0;
/// Motion of an incident wave over its peak (1) below which its beginning and end are left out.
const NEGLIGIBLE: f64 = 1e-9;

/// Place at which a motion of three components was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RecordedAt {
    /// Free surface of the ground.
    Surface,
    /// Outcrop of the half-space: a free surface of the half-space without the layers.
    Outcrop,
    /// Point within the ground.
    Within {
        /// Depth below the surface (m), above zero and at most 1e9.
        depth: f64,
        /// Regularisation r (1), 0.001 to 0.5.
        regularisation: f64,
    },
}

/// Parameters of the split of a recorded motion into incident plane waves.
///
/// In the frame of the waves (along their direction of travel, across it, up) the motion `(a, c, v)` at
/// the record's point is, frequency by frequency, `[a; v] = [Pa Sa; Pv Sv] [P; SV]` and `c = H SH`, with
/// the transfer functions of unit incident waves, each of its own horizontal slowness. The incident waves
/// solve these equations, so that their sum is the record at its point, and only there.
///
/// The condition number is the ratio of the singular values of the matrix: errors of one component are amplified by
/// as much in others. It is at most 20 at all frequencies of the band, and outside of the band what a smaller singular
/// value would need is not amplified further. Of a motion within the ground some waves cannot be recovered at some
/// frequencies: its equations are solved by least squares with the size of the waves, weighted by `(2 r)^2`, and the
/// condition number is that of this problem. The report states by how much the sum misses the record.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitParameters {
    /// Layers and half-space.
    pub ground: Ground,
    /// Place of the record.
    pub recorded: RecordedAt,
    /// Azimuth of all waves: horizontal direction of travel, from +x towards +y.
    pub azimuth: Angle,
    /// Incidence of P and SV in the half-space; SV below the critical angle. None where the record moves neither along the
    /// direction of travel nor up.
    pub p_sv: Option<[Angle; 2]>,
    /// Incidence of SH in the half-space. None where the record does not move across the direction of travel.
    pub sh: Option<Angle>,
    /// Lowest and highest frequency (Hz) between which the condition number must be small.
    pub band: [f64; 2],
}

/// Incident waves of a recorded motion.
pub struct SplitMotion {
    /// Displacement of the incident P wave.
    pub p: Option<Arc<dyn Signal>>,
    /// Displacement of the incident SV wave.
    pub sv: Option<Arc<dyn Signal>>,
    /// Displacement of the incident SH wave.
    pub sh: Option<Arc<dyn Signal>>,
    /// Quality of the split.
    pub report: SplitReport,
}

/// Quality of the split of a recorded motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitReport {
    /// Greatest condition number of the split over the band (1); one for SH alone.
    pub condition: f64,
    /// Frequency at which it occurs (Hz).
    pub frequency: f64,
    /// The band (Hz).
    pub band: [f64; 2],
    /// Greatest difference in acceleration between the sum of the waves and the record at its point, over the peak of the record's
    /// largest component (1).
    pub misfit: f64,
    /// Peak acceleration of the largest incident wave over that of the record's largest component (1).
    pub amplification: f64,
}

/// Components of a motion in the frame of the waves.
struct Turned {
    along: Option<Arc<dyn Signal>>,
    across: Option<Arc<dyn Signal>>,
    up: Option<Arc<dyn Signal>>,
}

impl SplitParameters {
    /// Splits the components x, y and z of a motion; a component that is not given does not move.
    ///
    /// The waves are incident at the top of the half-space below the record's point, at the time axis of the record: a
    /// [`PlaneWave`](crate::PlaneWave) or [`LayeredWave`](crate::LayeredWave) has them as its signals with that point as
    /// its reference, and [`InputConvention::Incident`](crate::InputConvention).
    ///
    /// # Errors
    /// [`WaveError::IllConditioned`] where the condition number is above 20 in the band;
    /// [`WaveError::SplitPastCritical`] for SV past the critical angle; a component that none of the waves moves, or waves
    /// without a motion; [`WaveError::WeakComponent`] where SH hardly moves the surface in the band; a permanent displacement
    /// that is not that of the surface of a half-space; grazing incidence; a number outside its range.
    pub fn split(
        &self,
        components: [Option<Arc<dyn Signal>>; 3],
    ) -> Result<SplitMotion, WaveError> {
        self.check()?;
        let turned = self.turned(components);
        self.check_waves(&turned)?;
        let [least, most] = self.band;
        let mut report = SplitReport {
            condition: 1.0,
            frequency: least,
            band: [least, most],
            misfit: 0.0,
            amplification: 0.0,
        };
        let place = self.place()?;
        let response = Response::new(&place, self.p_sv, self.sh)?;
        let floor = match self.recorded {
            RecordedAt::Within { regularisation, .. } => (regularisation * SURFACE).powi(2),
            RecordedAt::Surface | RecordedAt::Outcrop => 0.0,
        };
        for frequency in band_frequencies(self.band, place.longest_delay()) {
            let condition = response.in_plane(frequency).map(|m| condition(&m, floor));
            if let Some(condition) = condition.filter(|c| c.is_nan() || *c > report.condition) {
                (report.condition, report.frequency) = (condition, frequency);
            }
            let across = response.across(frequency).map(|h| h.norm());
            if let Some(coefficient) = across.filter(|h| floor == 0.0 && *h < LEAST_TRANSFER) {
                return Err(WaveError::WeakComponent {
                    kind: WaveKind::SH,
                    component: SurfaceComponent::Y,
                    coefficient,
                    limit: LEAST_TRANSFER,
                });
            }
        }
        if let Some([p, sv]) = self.p_sv
            && (report.condition.is_nan() || report.condition > LARGEST_CONDITION)
        {
            return Err(WaveError::IllConditioned {
                p: p.degrees(),
                sv: sv.degrees(),
                condition: report.condition,
                frequency: report.frequency,
                limit: LARGEST_CONDITION,
                band: self.band,
            });
        }
        if place.ground.layers().is_empty() && place.depth == 0.0 {
            self.at_free_half_space(&place, &turned, report)
        } else {
            by_frequency(&place, &response, floor, &turned, report)
        }
    }

    fn check(&self) -> Result<(), WaveError> {
        ParameterError::check("azimuth", self.azimuth.degrees(), -1e6, 1e6)?;
        let [least, most] = self.band;
        ParameterError::check("band", least, 1e-6, 1e6)?;
        ParameterError::check("band", most, least, 1e6)?;
        if let RecordedAt::Within {
            depth,
            regularisation,
        } = self.recorded
        {
            ParameterError::check("depth", depth, f64::MIN_POSITIVE, 1e9)?;
            ParameterError::check("regularisation", regularisation, 1e-3, 0.5)?;
        }
        if let Some([_, sv]) = self.p_sv {
            let half_space = self.ground.half_space();
            if SurfaceReflection::new(WaveKind::SV, sv, &half_space)?.past_critical() {
                return Err(WaveError::SplitPastCritical {
                    degrees: sv.degrees(),
                    critical: critical_angle(&half_space).degrees(),
                });
            }
        }
        Ok(())
    }

    /// Ground and depth of the record's point.
    fn place(&self) -> Result<ResponsePlace, WaveError> {
        let half_space = self.ground.half_space();
        let (ground, depth) = match self.recorded {
            RecordedAt::Surface => (self.ground.clone(), 0.0),
            RecordedAt::Outcrop => (
                Ground::new(self.ground.base(), Vec::new(), half_space)?,
                0.0,
            ),
            RecordedAt::Within { depth, .. } => (self.ground.clone(), depth),
        };
        Ok(ResponsePlace { ground, depth })
    }

    fn turned(&self, [x, y, z]: [Option<Arc<dyn Signal>>; 3]) -> Turned {
        let (sine, cosine) = self.azimuth.radians().sin_cos();
        Turned {
            along: combined(&[(cosine, &x), (sine, &y)]),
            across: combined(&[(-sine, &x), (cosine, &y)]),
            up: z,
        }
    }

    /// Rejects components that none of the waves moves, and waves without a motion.
    fn check_waves(&self, turned: &Turned) -> Result<(), WaveError> {
        let (in_plane, across) = ("P and SV", "SH");
        let of = [
            (
                &turned.along,
                SurfaceComponent::X,
                in_plane,
                self.p_sv.is_none(),
            ),
            (
                &turned.up,
                SurfaceComponent::Z,
                in_plane,
                self.p_sv.is_none(),
            ),
            (
                &turned.across,
                SurfaceComponent::Y,
                across,
                self.sh.is_none(),
            ),
        ];
        for (motion, component, waves, missing) in of {
            if motion.is_some() && missing {
                return Err(WaveError::MotionWithoutWave { component, waves });
            }
        }
        let is_still = turned.along.is_none() && turned.up.is_none();
        if self.p_sv.is_some() && is_still {
            return Err(WaveError::WaveWithoutMotion { waves: in_plane });
        }
        if self.sh.is_some() && turned.across.is_none() {
            return Err(WaveError::WaveWithoutMotion { waves: across });
        }
        Ok(())
    }

    /// Split at the surface of a half-space, where the coefficients are real and the same at all frequencies.
    fn at_free_half_space(
        &self,
        place: &ResponsePlace,
        turned: &Turned,
        mut report: SplitReport,
    ) -> Result<SplitMotion, WaveError> {
        let half_space = place.ground.half_space();
        let surface = |kind: WaveKind, incidence: Angle| {
            let reflection = SurfaceReflection::new(kind, incidence, &half_space)?;
            Ok::<_, WaveError>(reflection.surface_motion().map(|value| value.re))
        };
        let (mut p, mut sv, mut sh) = (None, None, None);
        if let Some([of_p, of_sv]) = self.p_sv {
            let [pa, _, pv] = surface(WaveKind::P, of_p)?;
            let [sa, _, sv_up] = surface(WaveKind::SV, of_sv)?;
            let determinant = pa * sv_up - pv * sa;
            let inverse = [
                [sv_up / determinant, -sa / determinant],
                [-pv / determinant, pa / determinant],
            ];
            let [of_p, of_sv] =
                inverse.map(|[along, up]| combined(&[(along, &turned.along), (up, &turned.up)]));
            (p, sv) = (of_p, of_sv);
            for (row, matrix) in [[pa, sa], [pv, sv_up]].into_iter().enumerate() {
                for column in 0..2 {
                    let product = matrix[0] * inverse[0][column] + matrix[1] * inverse[1][column];
                    let exact = f64::from(u8::from(row == column));
                    report.misfit = report.misfit.max((product - exact).abs());
                }
            }
        }
        if let Some(incidence) = self.sh {
            let [_, across, _] = surface(WaveKind::SH, incidence)?;
            sh = combined(&[(1.0 / across, &turned.across)]);
        }
        let recorded = [&turned.along, &turned.across, &turned.up];
        let recorded = recorded.map(|signal| largest_acceleration(signal.as_deref()));
        let incident = [&p, &sv, &sh].map(|signal| largest_acceleration(signal.as_deref()));
        report.amplification = over(largest(&incident), largest(&recorded));
        Ok(SplitMotion { p, sv, sh, report })
    }
}

/// Split by the transfer functions, frequency by frequency.
fn by_frequency(
    place: &ResponsePlace,
    response: &Response,
    floor: f64,
    turned: &Turned,
    mut report: SplitReport,
) -> Result<SplitMotion, WaveError> {
    const OPERATION: &str = "the split of a motion";
    let moving = [&turned.along, &turned.up, &turned.across];
    let supports = moving
        .iter()
        .filter_map(|signal| Some(signal.as_ref()?.support()));
    let Some(support) = supports.reduce(SignalSupport::with) else {
        return Err(WaveError::NoFields);
    };
    for signal in moving.into_iter().flatten() {
        check_return(&**signal, OPERATION)?;
    }
    let window = SignalWindow::new(support, place.longest_delay(), OPERATION)?;
    // Spectra of displacement, velocity and acceleration of the components along, up and across.
    let mut spectra = moving.map(|signal| {
        let samples = match signal {
            Some(signal) => window.samples(&**signal),
            None => [(); 3].map(|()| vec![0.0; window.count()]),
        };
        samples.map(|samples| window.spectrum(&samples))
    });
    let recorded = moving.map(|signal| largest_acceleration(signal.as_deref()));
    let mut missed = spectra
        .each_ref()
        .map(|[.., acceleration]| acceleration.clone());
    for index in 0..spectra[0][0].len() {
        let frequency = index as f64 * window.bin();
        if let Some(matrix) = response.in_plane(frequency) {
            let inverse = inverse(&matrix, floor);
            let [along, up, _] = &mut spectra;
            for (along, up) in along.iter_mut().zip(up.iter_mut()) {
                [along[index], up[index]] = product(&inverse, [along[index], up[index]]);
            }
            let [a, v] = product(&matrix, [spectra[0][2][index], spectra[1][2][index]]);
            missed[0][index] -= a;
            missed[1][index] -= v;
        }
        if let Some(h) = response.across(frequency) {
            let inverse = h.conj() / (h.norm_sqr() + floor);
            for across in &mut spectra[2] {
                across[index] *= inverse;
            }
            missed[2][index] -= h * spectra[2][2][index];
        }
    }
    let missed = missed.map(|spectrum| {
        let samples = window.inverse(&spectrum);
        largest(&samples)
    });
    report.misfit = over(largest(&missed), largest(&recorded));
    let mut incident = spectra.map(|spectra| {
        let mut samples = spectra.map(|spectrum| window.inverse(&spectrum));
        window.fade(&mut samples);
        samples
    });
    let peaks = incident
        .each_ref()
        .map(|[.., acceleration]| largest(acceleration));
    report.amplification = over(largest(&peaks), largest(&recorded));
    let mut signals = incident.each_mut().map(|samples| {
        let [first, last] = moving_samples(samples);
        let start = window.start() + first as f64 * window.step();
        let samples = samples.each_ref().map(|values| &values[first..=last]);
        Some(Arc::new(SampledSignal::new(start, window.step(), samples)) as Arc<dyn Signal>)
    });
    if turned.along.is_none() && turned.up.is_none() {
        (signals[0], signals[1]) = (None, None);
    }
    if turned.across.is_none() {
        signals[2] = None;
    }
    let [p, sv, sh] = signals;
    Ok(SplitMotion { p, sv, sh, report })
}

/// Frequencies of a band: as many as the longest delay of a wave (s) needs for the resonances to be seen.
fn band_frequencies([least, most]: [f64; 2], delay: f64) -> impl Iterator<Item = f64> {
    const LEAST_COUNT: f64 = 2_000.0;
    const MOST_COUNT: f64 = 20_000.0;
    let needed = 16.0 * delay * (most - least);
    let count = needed.clamp(LEAST_COUNT, MOST_COUNT).ceil() as usize;
    (0..=count).map(move |i| least + (most - least) * i as f64 / count as f64)
}

/// Squares of the singular values of a matrix, the greater one first.
fn singular_squares([[a, b], [c, d]]: &[[Complex; 2]; 2]) -> [f64; 2] {
    let sum = [a, b, c, d]
        .iter()
        .map(|value| value.norm_sqr())
        .sum::<f64>();
    let determinant = (a * d - b * c).norm();
    let root = (sum * sum - 4.0 * determinant * determinant)
        .max(0.0)
        .sqrt();
    let greater = 0.5 * (sum + root);
    [greater, determinant * determinant / greater]
}

/// Condition number of a matrix, with a regularisation.
fn condition(matrix: &[[Complex; 2]; 2], floor: f64) -> f64 {
    let [greater, lesser] = singular_squares(matrix);
    ((greater + floor) / (lesser + floor)).sqrt()
}

/// Inverse of a matrix, regularised and with the condition number limited.
///
/// It is `f(M^H M) M^H` with `f(x) = 1 / max(x + floor, largest / 400)`.
fn inverse(matrix: &[[Complex; 2]; 2], floor: f64) -> [[Complex; 2]; 2] {
    let [[a, b], [c, d]] = *matrix;
    let [greater, lesser] = singular_squares(matrix);
    let least = (greater + floor) / (LARGEST_CONDITION * LARGEST_CONDITION);
    if floor == 0.0 && lesser >= least {
        let determinant = a * d - b * c;
        return [
            [d / determinant, -b / determinant],
            [-c / determinant, a / determinant],
        ];
    }
    let of = |square: f64| 1.0 / (square + floor).max(least);
    let (of_greater, of_lesser) = (of(greater), of(lesser));
    // f(A) = f1 I + slope (A - s1 I), A = M^H M.
    let slope = if greater - lesser > 1e-12 * greater {
        (of_greater - of_lesser) / (greater - lesser)
    } else {
        0.0
    };
    let constant = of_greater - slope * greater;
    let square = [
        [a.conj() * a + c.conj() * c, a.conj() * b + c.conj() * d],
        [b.conj() * a + d.conj() * c, b.conj() * b + d.conj() * d],
    ];
    let adjoint = [[a.conj(), c.conj()], [b.conj(), d.conj()]];
    core::array::from_fn(|row| {
        core::array::from_fn(|column| {
            let sum = square[row][0] * adjoint[0][column] + square[row][1] * adjoint[1][column];
            adjoint[row][column] * constant + sum * slope
        })
    })
}

fn product(matrix: &[[Complex; 2]; 2], [x, y]: [Complex; 2]) -> [Complex; 2] {
    matrix.map(|[a, b]| a * x + b * y)
}

/// First and last sample outside of which displacement, velocity and acceleration are negligible.
fn moving_samples(samples: &[Vec<f64>; 3]) -> [usize; 2] {
    let last = samples[0].len() - 1;
    let mut range = [last, 0];
    for values in samples {
        let least = NEGLIGIBLE * largest(values);
        let moves = |value: &f64| value.abs() > least;
        if let (Some(first), Some(end)) = (
            values.iter().position(moves),
            values.iter().rposition(moves),
        ) {
            range = [range[0].min(first), range[1].max(end)];
        }
    }
    if range[0] < range[1] {
        range
    } else {
        [0, last.min(1)]
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn over(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// Peak acceleration of a signal (m/s2), at its steps.
fn largest_acceleration(signal: Option<&dyn Signal>) -> f64 {
    let Some(signal) = signal else { return 0.0 };
    let SignalSupport { start, end, step } = signal.support();
    let count = ((end - start) / step).ceil() as usize;
    let values = (0..=count).map(|i| signal.motion(start + i as f64 * step).acceleration);
    values.fold(0.0, |most, value| most.max(value.abs()))
}
