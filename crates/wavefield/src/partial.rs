//! Partial waves: the incident, reflected and converted plane wave of a field.

use powerhouse_model::{ElasticMedium, FieldMotion, Vec3};

use crate::{Complex, SurfaceReflection};

/// Displacement and stress of a wave for unit displacement and unit velocity of its signal.
#[derive(Clone, Copy)]
pub(crate) struct Vectors {
    pub(crate) polarisation: [f64; 3],
    /// Stress per velocity of the signal (Pa s/m).
    pub(crate) stress: [f64; 6],
}

impl Vectors {
    /// Adds the wave's motion for a displacement (m) and velocity (m/s) of its signal.
    #[inline(always)]
    pub(crate) fn add(&self, (displacement, velocity): (f64, f64), motion: &mut FieldMotion) {
        for i in 0..3 {
            motion.displacement[i] += self.polarisation[i] * displacement;
            motion.velocity[i] += self.polarisation[i] * velocity;
        }
        for i in 0..6 {
            motion.stress.0[i] += self.stress[i] * velocity;
        }
    }
}

/// Plane wave `u = Re[P A(t - delay(x))]`, `delay(x) = base + s.(x - datum)`, with `A` the
/// signal, or its analytic signal where `P` or the slowness `s` are complex.
///
/// Its stress is `Re[S A'(t - delay)]`, `S = C : (-sym(s (x) P))`.
#[derive(Clone, Debug)]
pub(crate) struct PartialWave {
    /// Displacement vector P for unit signal (1).
    pub(crate) polarisation: [Complex; 3],
    /// Stress S for unit velocity of the signal (Pa s/m).
    pub(crate) stress: [Complex; 6],
    slowness: [Complex; 3],
    datum: Vec3,
    base: f64,
}

impl PartialWave {
    /// Wave of a displacement vector and a slowness vector (s/m) that passes `datum` at time `base` (s).
    pub(crate) fn new(
        polarisation: [Complex; 3],
        slowness: [Complex; 3],
        medium: &ElasticMedium,
        datum: Vec3,
        base: f64,
    ) -> Self {
        let (lambda, shear) = (medium.lambda(), medium.shear());
        let product = |i: usize, j: usize| -(slowness[i] * polarisation[j]);
        let volumetric = (product(0, 0) + product(1, 1) + product(2, 2)) * lambda;
        let direct = |i: usize| volumetric + product(i, i) * (2.0 * shear);
        let sheared = |i: usize, j: usize| (product(i, j) + product(j, i)) * shear;
        Self {
            polarisation,
            stress: [
                direct(0),
                direct(1),
                direct(2),
                sheared(0, 1),
                sheared(1, 2),
                sheared(2, 0),
            ],
            slowness,
            datum,
            base,
        }
    }

    /// Whether the wave is a real multiple of the signal, delayed by a real time.
    pub(crate) fn is_real(&self) -> bool {
        let mut numbers = self.polarisation.iter().chain(&self.slowness);
        numbers.all(|value| value.im == 0.0)
    }

    /// Whether the wave decays with depth.
    pub(crate) fn decays(&self) -> bool {
        self.slowness.iter().any(|value| value.im != 0.0)
    }

    /// Phase factor of a wave that does not decay, and its real vectors without that factor.
    pub(crate) fn phase_and_vectors(&self) -> (Complex, Vectors) {
        let largest = self
            .polarisation
            .iter()
            .fold(Complex::new(0.0, 0.0), |a, b| {
                if b.norm_sqr() > a.norm_sqr() { *b } else { a }
            });
        let phase = match largest.norm() {
            0.0 => Complex::new(1.0, 0.0),
            norm => largest / norm,
        };
        let real = |value: Complex| (value * phase.conj()).re;
        let vectors = Vectors {
            polarisation: self.polarisation.map(real),
            stress: self.stress.map(real),
        };
        (phase, vectors)
    }

    /// Delays the wave by a time (s).
    pub(crate) fn delay_by(&mut self, time: f64) {
        self.base += time;
    }

    /// Delay of the signal at a point (s); its imaginary part, never above zero below the surface, is
    /// the decay exponent per angular frequency.
    pub(crate) fn delay(&self, point: &Vec3) -> Complex {
        let offset = point - self.datum;
        let horizontal = self.slowness[0] * offset.x + self.slowness[1] * offset.y;
        // The vertical part first: at the surface it is the same number for all waves.
        (self.slowness[2] * offset.z + self.base) + horizontal
    }
}

/// Where and when an incident wave arrives in a half-space.
#[derive(Clone, Copy)]
pub(crate) struct Arrival {
    /// The point (m) that it passes at `time`.
    pub(crate) reference: Vec3,
    /// The time of arrival there (s).
    pub(crate) time: f64,
    /// Height z of the free surface (m).
    pub(crate) surface: f64,
}

/// Incident wave and its reflections. The amplitude converts the signal into the incident wave;
/// cosine and sine are those of the azimuth.
pub(crate) fn half_space_waves(
    reflection: &SurfaceReflection,
    amplitude: Complex,
    (cosine, sine): (f64, f64),
    medium: &ElasticMedium,
    arrival: Arrival,
) -> Vec<PartialWave> {
    let Arrival {
        reference,
        time,
        surface,
    } = arrival;
    let rise = reflection.vertical_slowness;
    let at_surface = Vec3::new(reference.x, reference.y, surface);
    let surface_time = Complex::new(rise, 0.0) * (surface - reference.z) + time;
    let downward = [Complex::new(-rise, 0.0), -reflection.converted_slowness];
    let [incident, same, converted] = reflection.polarisations();
    let rotated = |vector: [Complex; 3]| rotated(vector.map(|v| v * amplitude), cosine, sine);
    let slowness = |vertical: Complex| {
        let p = Complex::new(reflection.horizontal_slowness, 0.0);
        [p * cosine, p * sine, vertical]
    };
    let wave = |polarisation, vertical, datum, base| {
        PartialWave::new(
            rotated(polarisation),
            slowness(vertical),
            medium,
            datum,
            base,
        )
    };
    let mut waves = vec![
        wave(incident, Complex::new(rise, 0.0), reference, time),
        wave(same, downward[0], at_surface, surface_time.re),
    ];
    if reflection.converted != Complex::new(0.0, 0.0) {
        waves.push(wave(converted, downward[1], at_surface, surface_time.re));
    }
    waves
}

/// Vector rotated about the vertical.
pub(crate) fn rotated([x, y, z]: [Complex; 3], cosine: f64, sine: f64) -> [Complex; 3] {
    [x * cosine - y * sine, x * sine + y * cosine, z]
}
