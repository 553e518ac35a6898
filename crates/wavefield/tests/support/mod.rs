//! Common functions of the tests of fields.

use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Mat3, Vec3};
use powerhouse_wavefield::{Angle, PlaneWave, PlaneWaveParameters, Signal, WaveKind};
use std::sync::Arc;

/// Surface of the half-spaces under test (m): not zero, so that a lost offset shows.
pub(crate) const SURFACE: f64 = 12.0;

/// A rock of a Poisson's ratio.
pub(crate) fn rock(poisson: f64) -> ElasticMedium {
    ElasticMedium::new(9e9, poisson, 2750.0).unwrap()
}

/// A wave under a free surface with an odd reference point.
pub(crate) fn wave(
    kind: WaveKind,
    poisson: f64,
    degrees: f64,
    azimuth: f64,
    signal: Arc<dyn Signal>,
) -> PlaneWave {
    PlaneWave::new(parameters(kind, poisson, degrees, azimuth), signal).unwrap()
}

/// Parameters of such a wave.
pub(crate) fn parameters(
    kind: WaveKind,
    poisson: f64,
    degrees: f64,
    azimuth: f64,
) -> PlaneWaveParameters {
    let mut parameters = PlaneWaveParameters::vertical(kind, rock(poisson), SURFACE);
    parameters.incidence = Angle::from_degrees(degrees);
    parameters.azimuth = Angle::from_degrees(azimuth);
    parameters.reference = Vec3::new(-80.0, 30.0, -150.0);
    parameters
}

/// The motion at one point and time.
pub(crate) fn motion(field: &dyn IncidentField, point: Vec3, time: f64) -> FieldMotion {
    let mut motion = [FieldMotion::default()];
    field
        .prepare(&[point])
        .unwrap()
        .add_motion(time, &mut motion);
    motion[0]
}

/// The largest component of a stress.
pub(crate) fn size(stress: &[f64; 6]) -> f64 {
    stress.iter().fold(0.0, |m, s| m.max(s.abs()))
}

/// Central difference of fourth order of a function of one number.
pub(crate) fn slope<const N: usize>(step: f64, value: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| value(k * step));
    core::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * step))
}

/// Residuals of `rho a = div sigma` and of `sigma = C : sym grad u`, relative to the largest term,
/// from differences over `step` metres and `step / speed` seconds.
pub(crate) fn residuals(
    field: &dyn IncidentField,
    point: Vec3,
    time: f64,
    step: f64,
) -> (f64, f64) {
    let medium = field.medium();
    let axis = |j: usize, s: f64| point + Vec3::ith(j, s);
    let array = |v: Vec3| [v.x, v.y, v.z];
    let acceleration = slope(step / medium.s_speed(), |s| {
        array(motion(field, point, time + s).velocity)
    });
    let mut divergence = Vec3::zeros();
    let mut gradient = Mat3::zeros();
    for j in 0..3 {
        let stress = slope(step, |s| motion(field, axis(j, s), time).stress.0);
        let row = powerhouse_model::Stress(stress).matrix();
        for i in 0..3 {
            divergence[i] += row[(i, j)];
        }
        let column = slope(step, |s| {
            array(motion(field, axis(j, s), time).displacement)
        });
        for i in 0..3 {
            gradient[(i, j)] = column[i];
        }
    }
    let inertia = Vec3::from(acceleration) * medium.density;
    let strain = powerhouse_model::Strain::from_gradient(&gradient);
    let elastic = powerhouse_model::Stress::elastic(medium.lambda(), medium.shear(), &strain);
    let stress = motion(field, point, time).stress;
    let difference: [f64; 6] = core::array::from_fn(|i| stress.0[i] - elastic.0[i]);
    (
        (inertia - divergence).norm() / inertia.norm().max(divergence.norm()),
        size(&difference) / size(&stress.0),
    )
}

/// When the last of the travelling waves passes a point: the reflected one of the incident's type.
pub(crate) fn latest_arrival(field: &PlaneWave, point: Vec3) -> f64 {
    let parameters = field.parameters();
    let speed = parameters.kind.speed(&parameters.medium);
    let mirrored = Vec3::new(point.x, point.y, 2.0 * SURFACE - point.z);
    parameters.arrival + (mirrored - parameters.reference).dot(&parameters.direction()) / speed
}
