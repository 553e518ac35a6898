//! Reflection coefficients of springs and dashpots for plane waves, in closed form.
//!
//! They state the accuracy of a boundary before a run: at normal incidence dashpots with B = 1 absorb
//! all of the wave and those with B = 1.1 reflect 4.8 % of the amplitude; springs reflect more, the
//! lower the frequency.

use nalgebra::{Complex, Matrix2, Vector2};
use powerhouse_model::{ElasticMedium, ParameterError};

use crate::FaceCoefficients;

/// Type of a plane body wave, incident on a boundary face or reflected by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyWave {
    /// Compressional wave.
    P,
    /// Shear wave, polarised in the plane of incidence.
    Sv,
}

/// Displacement amplitudes of the reflected waves per unit amplitude of the incident wave.
///
/// Past the critical angle of an incident shear wave the compressional part decays away from the face;
/// its amplitude is then the factor of the vector `(sin, 0, cos)` with a complex cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Amplitude of the reflected compressional wave (1).
    pub p: Complex<f64>,
    /// Amplitude of the reflected shear wave (1).
    pub sv: Complex<f64>,
}

impl Reflection {
    /// Ratio of reflected to incident energy flux through the face (1).
    pub fn energy(&self, medium: &ElasticMedium, wave: BodyWave, incidence: f64) -> f64 {
        let p_cosine = refracted_cosine(medium, wave, BodyWave::P, incidence).re;
        let sv_cosine = refracted_cosine(medium, wave, BodyWave::Sv, incidence).re;
        let (p_speed, s_speed) = (medium.p_speed(), medium.s_speed());
        let incident = match wave {
            BodyWave::P => p_speed * p_cosine,
            BodyWave::Sv => s_speed * sv_cosine,
        };
        (self.p.norm_sqr() * p_speed * p_cosine + self.sv.norm_sqr() * s_speed * sv_cosine)
            / incident
    }
}

/// Reflection coefficients of a face of springs and dashpots for a plane wave incident at
/// `incidence` (rad, from the normal, 0 to below pi/2) with angular frequency `frequency` (rad/s).
///
/// With the outward normal n, the amplitudes are such that the tractions of all waves balance springs and
/// dashpots, `sigma n = -(K + i w C) u`. A wave with polarisation d, direction p and speed c has
/// `sigma n = -(i w/c) [lambda (d.p) n + G (d (p.n) + p (d.n))] u`.
///
/// # Errors
/// [`ParameterError`] if the angle or the frequency is outside its range.
///
/// ```
/// use powerhouse_boundary::{FaceCoefficients, reflection::{BodyWave, reflection}};
/// use powerhouse_model::ElasticMedium;
/// let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0)?;
/// let dashpots = FaceCoefficients::viscous(&rock);
/// assert!(reflection(&rock, &dashpots, BodyWave::P, 0.0, 10.0)?.p.norm() < 1e-15);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
pub fn reflection(
    medium: &ElasticMedium,
    face: &FaceCoefficients,
    wave: BodyWave,
    incidence: f64,
    frequency: f64,
) -> Result<Reflection, ParameterError> {
    let right_angle = core::f64::consts::FRAC_PI_2;
    ParameterError::check("incidence", incidence, 0.0, right_angle - 1.0e-6)?;
    ParameterError::check("frequency", frequency, f64::MIN_POSITIVE, f64::MAX)?;
    let reflected = [BodyWave::P, BodyWave::Sv].map(|kind| {
        let cosine = refracted_cosine(medium, wave, kind, incidence);
        let sine = refracted_sine(medium, wave, kind, incidence);
        imbalance(medium, face, frequency, kind, sine, -cosine)
    });
    let sine = refracted_sine(medium, wave, wave, incidence);
    let cosine = refracted_cosine(medium, wave, wave, incidence);
    let incident = imbalance(medium, face, frequency, wave, sine, cosine);
    let matrix = Matrix2::from_columns(&reflected);
    let determinant = matrix.determinant();
    let replaced = |column| {
        let mut replaced = matrix;
        replaced.set_column(column, &-incident);
        replaced.determinant() / determinant
    };
    Ok(Reflection {
        p: replaced(0),
        sv: replaced(1),
    })
}

/// Traction of a wave of unit amplitude in the plane x, n, plus the forces of springs and dashpots
/// per area, divided by `i w`.
fn imbalance(
    medium: &ElasticMedium,
    face: &FaceCoefficients,
    frequency: f64,
    kind: BodyWave,
    sine: f64,
    cosine: Complex<f64>,
) -> Vector2<Complex<f64>> {
    let sine = Complex::from(sine);
    let direction = [sine, cosine];
    let (polarisation, speed) = match kind {
        BodyWave::P => (direction, medium.p_speed()),
        BodyWave::Sv => ([cosine, -sine], medium.s_speed()),
    };
    let [dx, dn] = polarisation;
    let [px, pn] = direction;
    let (lambda, shear) = (medium.lambda(), medium.shear());
    let tangential = -(dx * pn + px * dn) * shear / speed;
    let normal = -((dx * px + dn * pn) * lambda + dn * pn * (2.0 * shear)) / speed;
    let support = |dashpot: f64, spring: f64| Complex::new(dashpot, -spring / frequency);
    Vector2::new(
        tangential + support(face.tangential_dashpot, face.tangential_spring) * dx,
        normal + support(face.normal_dashpot, face.normal_spring) * dn,
    )
}

fn speed(medium: &ElasticMedium, kind: BodyWave) -> f64 {
    match kind {
        BodyWave::P => medium.p_speed(),
        BodyWave::Sv => medium.s_speed(),
    }
}

/// Sine of a wave's angle by Snell's law: its slowness along the face is that of the incident wave.
fn refracted_sine(
    medium: &ElasticMedium,
    incident: BodyWave,
    kind: BodyWave,
    incidence: f64,
) -> f64 {
    incidence.sin() * speed(medium, kind) / speed(medium, incident)
}

/// Cosine of that angle; past the critical angle `-i` times a positive number, so that
/// spectra `exp(i w t)` decay away from the face.
fn refracted_cosine(
    medium: &ElasticMedium,
    incident: BodyWave,
    kind: BodyWave,
    incidence: f64,
) -> Complex<f64> {
    let sine = refracted_sine(medium, incident, kind, incidence);
    let square = (1.0 - sine) * (1.0 + sine);
    if square >= 0.0 {
        Complex::new(square.sqrt(), 0.0)
    } else {
        Complex::new(0.0, -(-square).sqrt())
    }
}
