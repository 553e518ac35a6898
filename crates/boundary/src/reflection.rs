//! What springs and dashpots send back: closed forms for plane waves.
//!
//! Before a run these tell what a boundary costs: at normal incidence dashpots with B = 1 absorb
//! everything and those with B = 1.1 return 4.8 % of the amplitude for ever; springs return the
//! more, the lower the frequency.

use nalgebra::{Complex, Matrix2, Vector2};
use powerhouse_model::{ElasticMedium, ParameterError};

use crate::FaceCoefficients;

/// The kind of the wave that arrives at a boundary from inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneWave {
    /// Compressional.
    P,
    /// Shear, moving in the plane of incidence.
    Sv,
}

/// Displacement amplitudes of what returns, for an arriving wave of amplitude one.
///
/// Past the critical angle of an arriving shear wave the compressional part is not a wave; its
/// number is then the factor of the vector `(sin, 0, cos)` with a complex cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Compressional wave.
    pub p: Complex<f64>,
    /// Shear wave.
    pub sv: Complex<f64>,
}

impl Reflection {
    /// The energy that returns per energy that arrives, through the same area of the boundary.
    pub fn energy(&self, medium: &ElasticMedium, wave: PlaneWave, incidence: f64) -> f64 {
        let p_cosine = refracted_cosine(medium, wave, PlaneWave::P, incidence).re;
        let sv_cosine = refracted_cosine(medium, wave, PlaneWave::Sv, incidence).re;
        let (p_speed, s_speed) = (medium.p_speed(), medium.s_speed());
        let arriving = match wave {
            PlaneWave::P => p_speed * p_cosine,
            PlaneWave::Sv => s_speed * sv_cosine,
        };
        (self.p.norm_sqr() * p_speed * p_cosine + self.sv.norm_sqr() * s_speed * sv_cosine)
            / arriving
    }
}

/// The plane waves that a face of springs and dashpots returns for one that arrives under
/// `incidence` (rad, from the normal, 0 to below pi/2) with angular frequency `frequency` (rad/s).
///
/// With the outward normal n, the amplitudes make the tractions of all waves balance springs and
/// dashpots, `sigma n = -(K + i w C) u`. A wave with polarisation d, direction p and speed c has
/// `sigma n = -(i w/c) [lambda (d.p) n + G (d (p.n) + p (d.n))] u`.
///
/// # Errors
/// [`ParameterError`] for an angle or frequency outside its range.
///
/// ```
/// use powerhouse_boundary::{FaceCoefficients, reflection::{PlaneWave, reflection}};
/// use powerhouse_model::ElasticMedium;
/// let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0)?;
/// let dashpots = FaceCoefficients::viscous(&rock);
/// assert!(reflection(&rock, &dashpots, PlaneWave::P, 0.0, 10.0)?.p.norm() < 1e-15);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
pub fn reflection(
    medium: &ElasticMedium,
    face: &FaceCoefficients,
    wave: PlaneWave,
    incidence: f64,
    frequency: f64,
) -> Result<Reflection, ParameterError> {
    let right_angle = core::f64::consts::FRAC_PI_2;
    ParameterError::check("incidence", incidence, 0.0, right_angle - 1.0e-6)?;
    ParameterError::check("frequency", frequency, f64::MIN_POSITIVE, f64::MAX)?;
    let returning = [PlaneWave::P, PlaneWave::Sv].map(|kind| {
        let cosine = refracted_cosine(medium, wave, kind, incidence);
        let sine = refracted_sine(medium, wave, kind, incidence);
        imbalance(medium, face, frequency, kind, sine, -cosine)
    });
    let sine = refracted_sine(medium, wave, wave, incidence);
    let cosine = refracted_cosine(medium, wave, wave, incidence);
    let arriving = imbalance(medium, face, frequency, wave, sine, cosine);
    let matrix = Matrix2::from_columns(&returning);
    let determinant = matrix.determinant();
    let replaced = |column| {
        let mut replaced = matrix;
        replaced.set_column(column, &-arriving);
        replaced.determinant() / determinant
    };
    Ok(Reflection {
        p: replaced(0),
        sv: replaced(1),
    })
}

/// The traction of a wave of amplitude one in the plane x, n, plus what springs and dashpots
/// carry, divided by `i w`.
fn imbalance(
    medium: &ElasticMedium,
    face: &FaceCoefficients,
    frequency: f64,
    kind: PlaneWave,
    sine: f64,
    cosine: Complex<f64>,
) -> Vector2<Complex<f64>> {
    let sine = Complex::from(sine);
    let direction = [sine, cosine];
    let (polarisation, speed) = match kind {
        PlaneWave::P => (direction, medium.p_speed()),
        PlaneWave::Sv => ([cosine, -sine], medium.s_speed()),
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

fn speed(medium: &ElasticMedium, kind: PlaneWave) -> f64 {
    match kind {
        PlaneWave::P => medium.p_speed(),
        PlaneWave::Sv => medium.s_speed(),
    }
}

/// The sine of a wave's angle with the same slowness along the face as the arriving one.
fn refracted_sine(
    medium: &ElasticMedium,
    arriving: PlaneWave,
    kind: PlaneWave,
    incidence: f64,
) -> f64 {
    incidence.sin() * speed(medium, kind) / speed(medium, arriving)
}

/// The cosine of that angle; past the critical angle `-i` times a positive number, so that
/// spectra `exp(i w t)` decay away from the face.
fn refracted_cosine(
    medium: &ElasticMedium,
    arriving: PlaneWave,
    kind: PlaneWave,
    incidence: f64,
) -> Complex<f64> {
    let sine = refracted_sine(medium, arriving, kind, incidence);
    let square = (1.0 - sine) * (1.0 + sine);
    if square >= 0.0 {
        Complex::new(square.sqrt(), 0.0)
    } else {
        Complex::new(0.0, -(-square).sqrt())
    }
}
