//! Waves in a stack of layers at one frequency: reflection matrices from the surface down.
//!
//! The state `(u, traction / i w)` of a wave of horizontal slowness p is continuous at interfaces. In
//! every layer it is the sum of upgoing waves, whose amplitudes are kept at the layer's bottom, and of
//! downgoing waves, whose amplitudes are kept at its top: then only exponentials that do not grow
//! occur, at all thicknesses and frequencies (B. L. N. Kennett, 1983, Seismic Wave Propagation in
//! Stratified Media, ch. 6).

use powerhouse_model::ElasticMedium;

use super::ground::{Ground, LayerDamping};
use crate::{Complex, WaveKind};

pub(crate) const ZERO: Complex = Complex { re: 0.0, im: 0.0 };
const ONE: Complex = Complex { re: 1.0, im: 0.0 };

/// Relative distance of a slowness from that of a wave along a layer, below which it is moved
/// there: upgoing and downgoing waves would be the same. In the half-space waves of one direction
/// suffice.
const NEAREST: f64 = 1e-12;

/// Amplitudes of the waves of one layer: upgoing ones at its bottom (of the half-space: at its top),
/// downgoing ones at its top; P and SV, or SH alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amplitudes {
    pub(crate) up: [Complex; 2],
    pub(crate) down: [Complex; 2],
}

/// State of unit upgoing and downgoing waves of one layer, with their vertical slownesses.
///
/// Rows are `ux, uz, szz / i w, sxz / i w` of P and SV, or `uy, syz / i w` of SH, the stress over
/// the stack's scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns {
    pub(crate) slowness: [Complex; 2],
    up: [[Complex; 2]; 4],
    down: [[Complex; 2]; 4],
}

/// Greatest number of waves of a layer.
pub(crate) const WAVES: usize = 4;

/// Upgoing or downgoing wave of a layer at one frequency.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StackWave {
    /// Change of phase over a vertical distance, `w s` (1/m).
    pub(crate) phase: Complex,
    /// Displacement, and traction over `i w` (Pa s/m), where its amplitude is kept.
    pub(crate) state: [Complex; 4],
}

/// One layer, or the half-space, whose thickness is zero.
struct StackLayer {
    thickness: f64,
    medium: ElasticMedium,
    damping: LayerDamping,
    /// Columns, if they do not depend on the frequency.
    elastic: Option<Columns>,
}

/// Stack of layers for waves of one horizontal slowness.
pub(crate) struct Stack {
    /// Number of kinds of waves: 2 for P and SV, 1 for SH.
    pub(crate) order: usize,
    /// Horizontal slowness (s/m).
    pub(crate) slowness: f64,
    /// Column of the incident wave.
    pub(crate) incident: usize,
    /// Unit of stress over slowness of the states (Pa s/m).
    pub(crate) scale: f64,
    layers: Vec<StackLayer>,
}

impl Stack {
    /// Stack for a horizontal slowness (s/m), moved away from those of waves along a layer.
    pub(crate) fn new(ground: &Ground, kind: WaveKind, slowness: f64) -> Self {
        let order = if kind == WaveKind::SH { 1 } else { 2 };
        let count = ground.layers().len();
        let media = (0..count).map(|index| ground.medium(index));
        let speeds = media.flat_map(|medium| match order {
            1 => vec![medium.s_speed()],
            _ => vec![medium.p_speed(), medium.s_speed()],
        });
        let slowness = speeds.fold(slowness, |p, speed| {
            if (1.0 - p * speed).abs() < NEAREST {
                p * (1.0 - NEAREST)
            } else {
                p
            }
        });
        let half_space = ground.half_space();
        let mut stack = Self {
            order,
            slowness,
            incident: usize::from(kind == WaveKind::SV),
            scale: half_space.density * half_space.s_speed(),
            layers: Vec::with_capacity(count + 1),
        };
        for index in 0..=count {
            let layer = ground.layers().get(index);
            let damping = layer.map_or(LayerDamping::None, |layer| layer.damping.clone());
            let medium = ground.medium(index);
            let [top, bottom] = ground.extent(index);
            let elastic = damping
                .is_none()
                .then(|| stack.columns_of(&medium, ONE, ZERO));
            stack.layers.push(StackLayer {
                thickness: if layer.is_some() { top - bottom } else { 0.0 },
                medium,
                damping,
                elastic,
            });
        }
        stack
    }

    /// Number of layers above the half-space.
    pub(crate) fn count(&self) -> usize {
        self.layers.len() - 1
    }

    /// Modulus of a layer over that of its medium at an angular frequency (1/s).
    pub(crate) fn modulus(&self, index: usize, frequency: Complex) -> Complex {
        let rate = Complex::new(-frequency.im, frequency.re);
        self.layers[index].damping.modulus(rate)
    }

    /// Columns of a layer at an angular frequency (1/s), which is not zero if the layer is damped.
    pub(crate) fn columns(&self, index: usize, frequency: Complex) -> Columns {
        let layer = &self.layers[index];
        layer.elastic.unwrap_or_else(|| {
            let modulus = self.modulus(index, frequency);
            self.columns_of(&layer.medium, modulus, frequency)
        })
    }

    fn columns_of(&self, medium: &ElasticMedium, modulus: Complex, frequency: Complex) -> Columns {
        let p = self.slowness;
        let lambda = modulus * medium.lambda();
        let shear = modulus * medium.shear();
        let constrained = modulus * medium.constrained();
        let root = root(modulus);
        let (cp, cs) = (root * medium.p_speed(), root * medium.s_speed());
        let vertical = |c: Complex| {
            let square = (ONE - c * p) * (ONE + c * p) / (c * c);
            let s = self::root(square);
            // Waves decay in their direction.
            let growth = if frequency == ZERO {
                s.im
            } else {
                (frequency * s).im
            };
            if growth > 0.0 { -s } else { s }
        };
        let (xi, eta) = (vertical(cp), vertical(cs));
        let mut columns = Columns {
            slowness: [xi, eta],
            up: [[ZERO; 2]; 4],
            down: [[ZERO; 2]; 4],
        };
        let scale = 1.0 / self.scale;
        if self.order == 1 {
            columns.slowness = [eta, ZERO];
            columns.up[0][0] = ONE;
            columns.up[1][0] = -shear * eta * scale;
            columns.down[0][0] = ONE;
            columns.down[1][0] = shear * eta * scale;
            return columns;
        }
        let state = |x: Complex, z: Complex, s: Complex| {
            [
                x,
                z,
                -(lambda * p * x + constrained * s * z) * scale,
                -(shear * (z * p + s * x)) * scale,
            ]
        };
        let waves = [
            (state(cp * p, cp * xi, xi), state(cp * p, -cp * xi, -xi)),
            (state(cs * eta, -cs * p, eta), state(cs * eta, cs * p, -eta)),
        ];
        for (column, (up, down)) in waves.into_iter().enumerate() {
            for row in 0..4 {
                columns.up[row][column] = up[row];
                columns.down[row][column] = down[row];
            }
        }
        columns
    }

    /// Amplitudes of all layers and of the half-space for a unit incident displacement at the top of
    /// the half-space, at an angular frequency (1/s).
    pub(crate) fn amplitudes(&self, frequency: Complex, out: &mut [Amplitudes]) {
        let (n, count) = (self.order, self.count());
        let mut upward = vec![[[ZERO; 2]; 2]; count];
        let mut reflection = vec![[[ZERO; 2]; 2]; count + 1];
        let mut passed = vec![[ZERO; 2]; count];
        let mut here = self.columns(0, frequency);
        // No traction at the surface.
        let mut matrix = [[ZERO; 4]; 4];
        let mut right = [[ZERO; 2]; 4];
        for row in 0..n {
            for column in 0..n {
                matrix[row][column] = here.down[n + row][column];
                right[row][column] = -here.up[n + row][column];
            }
        }
        solve(&mut matrix, &mut right, n, n);
        for row in 0..n {
            reflection[0][row][..n].copy_from_slice(&right[row][..n]);
        }
        for index in 0..count {
            let below = self.columns(index + 1, frequency);
            let distance = self.layers[index].thickness;
            let phases = here.slowness.map(|s| propagated(frequency * s * distance));
            passed[index] = phases;
            let mut at_bottom = [[ZERO; 2]; 2];
            for row in 0..n {
                for column in 0..n {
                    at_bottom[row][column] =
                        phases[row] * reflection[index][row][column] * phases[column];
                }
            }
            let mut matrix = [[ZERO; 4]; 4];
            let mut right = [[ZERO; 2]; 4];
            for row in 0..2 * n {
                for column in 0..n {
                    let mut sum = here.up[row][column];
                    for (k, reflected) in at_bottom.iter().enumerate().take(n) {
                        sum += here.down[row][k] * reflected[column];
                    }
                    matrix[row][column] = sum;
                    matrix[row][n + column] = -below.down[row][column];
                    right[row][column] = below.up[row][column];
                }
            }
            solve(&mut matrix, &mut right, 2 * n, n);
            for row in 0..n {
                upward[index][row][..n].copy_from_slice(&right[row][..n]);
                reflection[index + 1][row][..n].copy_from_slice(&right[n + row][..n]);
            }
            here = below;
        }
        let mut up = [ZERO; 2];
        up[self.incident] = ONE;
        out[count] = Amplitudes {
            up,
            down: product(&reflection[count], &up),
        };
        for index in (0..count).rev() {
            // At the top of the layer below upgoing waves have the amplitudes `up`.
            let at_bottom = product(&upward[index], &up);
            let phases = passed[index];
            up = [at_bottom[0] * phases[0], at_bottom[1] * phases[1]];
            out[index] = Amplitudes {
                up: at_bottom,
                down: product(&reflection[index], &up),
            };
        }
    }

    /// Waves of a layer at an angular frequency (1/s): of each kind that upwards and that downwards.
    pub(crate) fn waves(
        &self,
        index: usize,
        frequency: Complex,
        amplitudes: &Amplitudes,
    ) -> [StackWave; WAVES] {
        let columns = self.columns(index, frequency);
        // The incident wave passes a depth of the half-space earlier; the state is given after its own arrival.
        let earlier = if index == self.count() {
            frequency * columns.slowness[self.incident]
        } else {
            ZERO
        };
        let n = self.order;
        core::array::from_fn(|wave| {
            let kind = wave / 2;
            if kind >= n {
                return StackWave {
                    phase: ZERO,
                    state: [ZERO; 4],
                };
            }
            let own = frequency * columns.slowness[kind];
            let (phase, vectors, amplitude) = match wave % 2 {
                0 => (own, &columns.up, amplitudes.up[kind]),
                _ => (own + earlier, &columns.down, amplitudes.down[kind]),
            };
            StackWave {
                phase,
                state: core::array::from_fn(|row| {
                    if row >= n {
                        vectors[row][kind] * amplitude * self.scale
                    } else {
                        vectors[row][kind] * amplitude
                    }
                }),
            }
        })
    }

    /// Distances (m) that the waves of a layer have travelled at a depth below its top.
    pub(crate) fn distances(&self, (index, depth): (usize, f64)) -> [f64; WAVES] {
        let up = if index == self.count() {
            0.0
        } else {
            self.layers[index].thickness - depth
        };
        [up, depth, up, depth]
    }

    /// State in a layer at a distance (m) below its top: displacement, and traction over `i w`
    /// (Pa s/m) of the unit incident wave.
    pub(crate) fn state(
        &self,
        place: (usize, f64),
        amplitudes: &Amplitudes,
        frequency: Complex,
    ) -> [Complex; 4] {
        let waves = self.waves(place.0, frequency, amplitudes).into_iter();
        let mut state = [ZERO; 4];
        for (wave, distance) in waves.zip(self.distances(place)) {
            let factor = propagated(wave.phase * distance);
            for (value, share) in state.iter_mut().zip(wave.state) {
                *value += share * factor;
            }
        }
        state
    }
}

/// State at a height z (m) and an angular frequency (1/s, not zero) for a unit incident displacement at the top of the
/// half-space.
pub(crate) fn transfer(
    ground: &Ground,
    stack: &Stack,
    height: f64,
    frequency: Complex,
) -> [Complex; 4] {
    let index = ground.layer_at(height);
    let depth = (ground.extent(index)[0] - height).max(0.0);
    let none = Amplitudes {
        up: [ZERO; 2],
        down: [ZERO; 2],
    };
    let mut amplitudes = vec![none; stack.count() + 1];
    stack.amplitudes(frequency, &mut amplitudes);
    let state = stack.state((index, depth), &amplitudes[index], frequency);
    // A state in the half-space is that after the arrival of the incident wave there.
    let advance = if index == stack.count() {
        stack.columns(index, frequency).slowness[stack.incident].re * depth
    } else {
        0.0
    };
    let earlier = propagated(frequency * -advance);
    state.map(|value| value * earlier)
}

/// Factor of a wave after a change of its phase, `exp(-i phase)`.
pub(crate) fn propagated(phase: Complex) -> Complex {
    Complex::new(phase.im, -phase.re).exp()
}

/// Root with a real part that is not negative, without angles.
fn root(square: Complex) -> Complex {
    let norm = square.norm_sqr().sqrt();
    let greater = (0.5 * (norm + square.re.abs())).sqrt();
    let lesser = if greater > 0.0 {
        0.5 * square.im.abs() / greater
    } else {
        0.0
    };
    if square.re >= 0.0 {
        Complex::new(greater, lesser.copysign(square.im))
    } else {
        Complex::new(lesser, greater.copysign(square.im))
    }
}

fn product(matrix: &[[Complex; 2]; 2], vector: &[Complex; 2]) -> [Complex; 2] {
    core::array::from_fn(|row| matrix[row][0] * vector[0] + matrix[row][1] * vector[1])
}

/// Solves a system of `rows` equations for `columns` right sides in place, by elimination with
/// partial pivoting.
fn solve(
    matrix: &mut [[Complex; 4]; 4],
    right: &mut [[Complex; 2]; 4],
    rows: usize,
    columns: usize,
) {
    for k in 0..rows {
        let mut pivot = k;
        for row in k + 1..rows {
            if matrix[row][k].norm_sqr() > matrix[pivot][k].norm_sqr() {
                pivot = row;
            }
        }
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        let inverse = ONE / matrix[k][k];
        let (pivot_row, pivot_right) = (matrix[k], right[k]);
        for row in k + 1..rows {
            let factor = matrix[row][k] * inverse;
            for column in k + 1..rows {
                matrix[row][column] -= factor * pivot_row[column];
            }
            for column in 0..columns {
                right[row][column] -= factor * pivot_right[column];
            }
        }
    }
    for k in (0..rows).rev() {
        let inverse = ONE / matrix[k][k];
        for column in 0..columns {
            let mut sum = right[k][column];
            for j in k + 1..rows {
                sum -= matrix[k][j] * right[j][column];
            }
            right[k][column] = sum * inverse;
        }
    }
}
