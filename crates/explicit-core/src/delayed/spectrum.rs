//! Highest frequency of the gyroscopic operator of a slice.
//!
//! With velocities `v` of x and z, displacements `w` of y, inertia `M` less `s^2 A`, stiffness `K` of both and the skew coupling
//! `D` of a linear slice, `M v' = -K u - D w'` and `M w'' = -K w + D^T v`, so that `x = (v, w)` obeys `x'' = -L x`:
//!
//! `L (v, w) = (M^-1 (K v - D b), b)` with `b = M^-1 (K w - D^T v)`,
//!
//! which is self-adjoint in the product `v.M v + w.K w`. Its largest eigenvalue is the square of the highest frequency, and
//! the staggered scheme is stable up to `2 / w` exactly.

use powerhouse_model::{Operator, Vec3};

use crate::Model;
use crate::spectrum::{HighestEigenvalue, Tridiagonal, noise};

/// A vector of the operator by group: `v` in x and z, `w` in y; and `K w`.
#[derive(Clone)]
struct Pair {
    x: Vec<Vec3>,
    force: Vec<f64>,
}

impl Pair {
    /// Adds another vector times a factor.
    fn add(&mut self, other: &Self, factor: f64) {
        for (a, b) in self.x.iter_mut().zip(&other.x) {
            *a += b * factor;
        }
        for (a, b) in self.force.iter_mut().zip(&other.force) {
            *a += b * factor;
        }
    }
    fn scale(&mut self, factor: f64) {
        self.x.iter_mut().for_each(|x| *x *= factor);
        self.force.iter_mut().for_each(|x| *x *= factor);
    }
}

impl Model {
    /// Highest eigenvalue of the gyroscopic operator (rad2/s2), by the Lanczos method; `reference` is some frequency
    /// (rad/s) of the order of the highest one. None if the body is no slice.
    pub(crate) fn highest_of_slice(&mut self, reference: f64) -> Option<HighestEigenvalue> {
        self.delayed.as_ref()?;
        let mut present = self.start_of_slice(reference);
        let mut previous: Option<Pair> = None;
        let mut tridiagonal = Tridiagonal::default();
        let size = self.slice_product(&present, &present).sqrt();
        if size == 0.0 {
            return Some(tridiagonal.found);
        }
        present.scale(1.0 / size);
        loop {
            let mut next = self.gyroscopic_product(&present);
            let alpha = self.slice_product(&next, &present);
            next.add(&present, -alpha);
            if let (Some(previous), Some(beta)) = (&previous, tridiagonal.last()) {
                next.add(previous, -beta);
            }
            let beta = self.slice_product(&next, &next).max(0.0).sqrt();
            if tridiagonal.extend(alpha, beta) {
                return Some(tridiagonal.found);
            }
            next.scale(1.0 / beta);
            previous = Some(core::mem::replace(&mut present, next));
        }
    }

    /// A reproducible pseudo-random vector.
    fn start_of_slice(&mut self, reference: f64) -> Pair {
        let count = self.groups.groups.len();
        let x = (0..count).map(|g| {
            let v = Vec3::from_fn(|c, _| noise((3 * g + c) as u64));
            Vec3::new(v.x, v.y / reference.max(f64::MIN_POSITIVE), v.z)
        });
        let mut start = Pair {
            x: x.collect(),
            force: vec![0.0; count],
        };
        self.release(&mut start.x);
        let displacement: Vec<Vec3> = start.x.iter().map(|x| Vec3::new(0.0, x.y, 0.0)).collect();
        let still = vec![Vec3::zeros(); count];
        let (forces, _) = self.slice_response(&displacement, &still);
        start.force = forces.iter().map(|force| force.y).collect();
        start
    }

    /// Sets the components along fixed axes, and those of groups without mass, to zero.
    fn release(&self, vector: &mut [Vec3]) {
        let Some(slice) = &self.delayed else {
            return;
        };
        for ((x, held), group) in vector.iter_mut().zip(&slice.held).zip(&self.groups.groups) {
            for (c, held) in held.iter().enumerate() {
                if *held || group.mass <= 0.0 {
                    x[c] = 0.0;
                }
            }
        }
    }

    /// Inner product in which the operator is self-adjoint.
    fn slice_product(&self, a: &Pair, b: &Pair) -> f64 {
        let Some(slice) = &self.delayed else {
            return 0.0;
        };
        let mut sum = 0.0;
        for g in 0..slice.mass.len() {
            let mass = slice.inertia(g);
            sum += a.x[g].x * mass.x * b.x[g].x + a.x[g].z * mass.z * b.x[g].z;
            sum += 0.5 * (a.x[g].y * b.force[g] + b.x[g].y * a.force[g]);
        }
        sum
    }

    /// Internal forces (N) and `T` (N m) of all groups of a linear slice, from displacement (m) and velocity (m/s).
    fn slice_response(
        &mut self,
        displacement: &[Vec3],
        velocity: &[Vec3],
    ) -> (Vec<Vec3>, Vec<Vec3>) {
        let Some(slice) = &self.delayed else {
            return Default::default();
        };
        let side = |&(group, sign): &(u32, f64)| {
            let (u, v) = (displacement[group as usize], velocity[group as usize]);
            u + v * (sign * slice.slowness * slice.half)
        };
        let nodes: Vec<Vec3> = slice.place.iter().map(side).collect();
        let forces = self.elastic_product(Operator::Elastic, &nodes, &|_| 1.0);
        let Some(slice) = &self.delayed else {
            return Default::default();
        };
        let of_sides = slice.sides.iter().enumerate().map(|(group, sides)| {
            let [low, high] = sides.map(|node| forces[node as usize]);
            let spread = slice.lumping.spread(group, |g| velocity[g]);
            (
                low + high,
                (high - low) * slice.half + spread * slice.slowness,
            )
        });
        of_sides.unzip()
    }

    /// Product of the operator with a vector.
    fn gyroscopic_product(&mut self, of: &Pair) -> Pair {
        let count = of.x.len();
        let still = vec![Vec3::zeros(); count];
        let plane = |x: &Vec3| Vec3::new(x.x, 0.0, x.z);
        let velocity: Vec<Vec3> = of.x.iter().map(plane).collect();
        // `T` of y follows displacements of x and z, its rate therefore their velocities.
        let (coupling, tractions) = self.slice_response(&velocity, &velocity);
        let mut motion = vec![Vec3::zeros(); count];
        let mut along = vec![Vec3::zeros(); count];
        for (g, group) in self.groups.groups.iter().enumerate() {
            let Some(slice) = &self.delayed else {
                continue;
            };
            if group.mass <= 0.0 || slice.held[g][1] {
                continue;
            }
            let turned = group.gyroscopic * velocity[g];
            let force = of.force[g] + coupling[g].y + tractions[g].y * slice.slowness + turned.y;
            along[g].y = -force / slice.inertia(g).y;
        }
        for (motion, (velocity, along)) in motion.iter_mut().zip(velocity.iter().zip(&along)) {
            *motion = velocity + along;
        }
        let (forces, tractions) = self.slice_response(&motion, &along);
        let mut product = Pair {
            x: still,
            force: forces.iter().map(|force| -force.y).collect(),
        };
        if let Some(slice) = &self.delayed {
            for (g, group) in self.groups.groups.iter().enumerate() {
                let mass = slice.inertia(g);
                let turned = group.gyroscopic * along[g];
                let force = forces[g] + tractions[g] * slice.slowness + turned;
                product.x[g] = Vec3::new(force.x / mass.x, -along[g].y, force.z / mass.z);
            }
        }
        self.release(&mut product.x);
        product
    }
}
