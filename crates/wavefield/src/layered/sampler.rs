//! Sampler of a layered field.

use std::sync::Arc;

use powerhouse_model::{FieldMotion, FieldSampler};

use super::tables::{LayeredTables, Table};

/// Constants of one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayeredPoint {
    /// Position in the motion that is asked for.
    pub(crate) index: u32,
    /// Table of displacement and traction.
    pub(crate) table: u32,
    /// Table of the relaxing modulus times velocity, in damped layers.
    pub(crate) product: Option<u32>,
    /// Time of arrival of the incident wave at the height of the table (s).
    pub(crate) delay: f64,
    /// Weight of the table in the motion of the point (1).
    pub(crate) weight: f64,
    /// Stress along the layer per normal stress (1), and per velocity (Pa s/m).
    pub(crate) share: f64,
    pub(crate) coupling: f64,
    /// Stress across the direction of travel per sum of the others (1).
    pub(crate) across: f64,
}

/// Sampler of waves in layers: per point one look-up in the table of its height, or four in those around it.
///
/// Of P and SV `sxx = l/(l + 2 G) szz - 4 p G (l + G)/(l + 2 G) vx` and
/// `syy = l/(2 (l + G)) (sxx + szz)`, of SH `sxy = -p G vy`, in the medium of the point.
pub(crate) struct LayeredSampler {
    pub(crate) of: Arc<LayeredTables>,
    pub(crate) tables: Vec<Arc<Table>>,
    pub(crate) products: Vec<Arc<Table>>,
    /// Points in the order of their tables, once for each of their tables.
    pub(crate) points: Vec<LayeredPoint>,
    /// Number of points.
    pub(crate) count: usize,
    /// Cosine and sine of the azimuth.
    pub(crate) turn: [f64; 2],
}

/// Weights of cubic interpolation: of the values and derivatives at both ends, for the value and for
/// the derivative times the step.
struct Cubic {
    value: [f64; 4],
    rate: [f64; 4],
}

impl Cubic {
    #[inline(always)]
    fn at(s: f64) -> Self {
        let rest = 1.0 - s;
        let rise = s * s * (3.0 - 2.0 * s);
        let slope = 6.0 * s * rest;
        Self {
            value: [1.0 - rise, rise, s * rest * rest, -s * s * rest],
            rate: [-slope, slope, rest * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)],
        }
    }
}

impl Table {
    /// Both records around a time, with the weights of interpolation; none outside of the table.
    #[inline(always)]
    fn around<const W: usize>(&self, time: f64) -> Option<(&[f64; W], &[f64; W], Cubic)> {
        let position = (time - self.start) * self.per_step;
        // Out of its range the conversion saturates, beyond any table.
        let index = position as i32;
        let first = usize::try_from(index).ok()?.checked_mul(W)?;
        let records = self.values.get(first..)?.get(..2 * W)?;
        let (a, b) = records.split_at(W);
        let (a, b) = (a.try_into().ok()?, b.try_into().ok()?);
        (position >= 0.0).then(|| (a, b, Cubic::at(position - f64::from(index))))
    }

    /// Values at a time, and derivatives of the first `R`: `Q` quantities in records of `W = 2 Q`.
    #[inline(always)]
    fn values<const Q: usize, const W: usize, const R: usize>(
        &self,
        time: f64,
    ) -> Option<([f64; Q], [f64; R])> {
        let (a, b, cubic) = self.around::<W>(time)?;
        let mixed =
            |k: usize, w: &[f64; 4]| w[0] * a[k] + w[1] * b[k] + w[2] * a[Q + k] + w[3] * b[Q + k];
        let values = core::array::from_fn(|k| mixed(k, &cubic.value));
        let rates = core::array::from_fn(|k| mixed(k, &cubic.rate) * self.per_step);
        Some((values, rates))
    }
}

impl Table {
    /// Number of records, of waves with a number of displacements in their plane.
    pub(crate) fn samples(&self, order: usize) -> usize {
        self.values.len() / (4 * order)
    }

    /// Two displacements, velocities and tractions at a time; of SH waves the second ones are zero. None outside of the table.
    pub(crate) fn state(&self, order: usize, time: f64) -> Option<[f64; 6]> {
        Some(match order {
            1 => {
                let ([u, syz], [v]) = self.values::<2, 4, 1>(time)?;
                [u, 0.0, v, 0.0, syz, 0.0]
            }
            _ => {
                let ([ux, uz, szz, sxz], [vx, vz]) = self.values::<4, 8, 2>(time)?;
                [ux, uz, vx, vz, szz, sxz]
            }
        })
    }
}

impl LayeredSampler {
    /// Displacement and velocity outside of a table: what remains, or the far part of a field that is
    /// not causal.
    #[cold]
    fn outside(&self, table: &Table, time: f64) -> ([f64; 2], [f64; 2]) {
        if let Some(statics) = &self.of.statics {
            let components = if self.of.stack.order == 1 {
                [1, 1]
            } else {
                [0, 2]
            };
            let [a, b] = components.map(|component| statics.value(component, time));
            return ([a.0, b.0], [a.1, b.1]);
        }
        if time > table.start {
            (self.of.remaining, [0.0; 2])
        } else {
            ([0.0; 2], [0.0; 2])
        }
    }

    /// Velocity under the modulus of a damped layer; the velocity itself of an undamped one.
    #[inline(always)]
    fn under_modulus(&self, point: &LayeredPoint, time: f64, velocity: f64) -> f64 {
        match point.product {
            None => velocity,
            Some(product) => self.products[product as usize]
                .values::<1, 2, 0>(time)
                .map_or(0.0, |([value], _)| value),
        }
    }

    fn add_in_plane(&self, time: f64, motion: &mut [FieldMotion]) {
        let [c, s] = self.turn;
        for point in &self.points {
            let table = &self.tables[point.table as usize];
            let local = time - point.delay;
            let ([ux, uz, szz, sxz], [vx, vz]) =
                table.values::<4, 8, 2>(local).unwrap_or_else(|| {
                    let ([ux, uz], velocity) = self.outside(table, local);
                    ([ux, uz, 0.0, 0.0], velocity)
                });
            let w = point.weight;
            let sheared = w * self.under_modulus(point, local, vx);
            let [ux, uz, szz, sxz, vx, vz] = [ux, uz, szz, sxz, vx, vz].map(|value| w * value);
            let sxx = point.share * szz - point.coupling * sheared;
            let syy = point.across * (sxx + szz);
            let sum = &mut motion[point.index as usize];
            sum.displacement.x += c * ux;
            sum.displacement.y += s * ux;
            sum.displacement.z += uz;
            sum.velocity.x += c * vx;
            sum.velocity.y += s * vx;
            sum.velocity.z += vz;
            sum.stress.0[0] += c * c * sxx + s * s * syy;
            sum.stress.0[1] += s * s * sxx + c * c * syy;
            sum.stress.0[2] += szz;
            sum.stress.0[3] += c * s * (sxx - syy);
            sum.stress.0[4] += s * sxz;
            sum.stress.0[5] += c * sxz;
        }
    }

    fn add_across(&self, time: f64, motion: &mut [FieldMotion]) {
        let [c, s] = self.turn;
        for point in &self.points {
            let table = &self.tables[point.table as usize];
            let local = time - point.delay;
            let ([u, syz], [v]) = table.values::<2, 4, 1>(local).unwrap_or_else(|| {
                let ([u, _], [v, _]) = self.outside(table, local);
                ([u, 0.0], [v])
            });
            let w = point.weight;
            let sxy = -point.coupling * w * self.under_modulus(point, local, v);
            let [u, syz, v] = [u, syz, v].map(|value| w * value);
            let sum = &mut motion[point.index as usize];
            sum.displacement.x -= s * u;
            sum.displacement.y += c * u;
            sum.velocity.x -= s * v;
            sum.velocity.y += c * v;
            sum.stress.0[0] -= 2.0 * c * s * sxy;
            sum.stress.0[1] += 2.0 * c * s * sxy;
            sum.stress.0[3] += (c * c - s * s) * sxy;
            sum.stress.0[4] += c * syz;
            sum.stress.0[5] -= s * syz;
        }
    }
}

impl FieldSampler for LayeredSampler {
    fn len(&self) -> usize {
        self.count
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let motion = &mut motion[..self.count];
        match self.of.stack.order {
            1 => self.add_across(time, motion),
            _ => self.add_in_plane(time, motion),
        }
    }
}
