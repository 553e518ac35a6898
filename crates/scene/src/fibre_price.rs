//! What fibres cost, before a run: by how much they lower the frequencies of the structure.
//!
//! # Why so
//! *Rayleigh's quotient needs a shape, no mode*: the deflection under a uniform acceleration of a structure that is
//! held where it joins the ground has nearly the lowest frequency, and the added inertia in it over its mass gives
//! twice the relative change.
//!
//! *Below that frequency the structure follows the ground*, and what fibres feel falls with the square of the
//! frequency; above it they feel ever shorter bending waves, whose square of the wave number grows as the frequency.

use core::fmt;
use std::collections::BTreeSet;

use powerhouse_model::{Constant, Fibre, ModelSpec, State, StaticOptions, Support, Vec3};

use crate::body::Piece;
use crate::{Error, Scene};

/// Acceleration of the static shapes (m/s2); results do not depend on it.
const ACCELERATION: f64 = 1.0;

/// Relative decrease of frequencies by fibres, estimated before the run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FibreShift {
    /// Lowest frequency (Hz) of the structure, held where it joins the ground, by Rayleigh's quotient.
    pub natural: f64,
    /// By how much the fibres lower that frequency (1).
    pub of_natural: f64,
    /// Frequency (Hz) below which the input has 99 % of the energy of its acceleration; none without input.
    pub input: Option<f64>,
    /// Estimated relative decrease of a frequency of motion as high as that of the input (1).
    pub of_input: Option<f64>,
}

impl fmt::Display for FibreShift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "they lower the first frequency of the structure, {:.1} Hz where it is held at the ground, by {:.2} %",
            self.natural,
            100.0 * self.of_natural
        )?;
        match (self.input, self.of_input) {
            (Some(input), Some(shift)) => write!(
                f,
                ", and motion at {input:.1} Hz, below which the input has 99 % of its energy, by {:.2} % (an estimate)",
                100.0 * shift
            ),
            _ => Ok(()),
        }
    }
}

/// Shape of a structure under a uniform acceleration.
#[derive(Clone, Debug)]
pub(crate) struct StaticShape {
    /// Frequency (Hz) by Rayleigh's quotient.
    frequency: f64,
    /// Displacement (m) and mass (kg) of the nodes of the mesh.
    motion: Vec<(Vec3, f64)>,
}

impl StaticShape {
    /// What fibres of the mesh cost, with an input up to a frequency (Hz).
    pub(crate) fn shift(&self, fibres: &[Fibre], input: Option<f64>) -> FibreShift {
        let whole: f64 = (self.motion.iter())
            .map(|(u, mass)| mass * u.norm_squared())
            .sum();
        let added = fibres.iter().map(|fibre| {
            let own = fibre.nodes.iter().map(|&node| self.motion[node as usize]);
            let mass: f64 = own.clone().map(|(_, mass)| mass).sum();
            if mass <= 0.0 {
                return 0.0;
            }
            let mean = own.clone().map(|(u, mass)| u * mass).sum::<Vec3>() / mass;
            let apart = own.map(|(u, mass)| mass * (u - mean).norm_squared());
            fibre.added * apart.sum::<f64>()
        });
        let added = added.sum::<f64>() / whole;
        let natural = self.frequency;
        let scale = |input: f64| {
            let ratio = input / natural;
            if ratio < 1.0 { ratio * ratio } else { ratio }
        };
        FibreShift {
            natural,
            of_natural: 1.0 - 1.0 / (1.0 + added).sqrt(),
            input,
            of_input: input.map(|input| 0.5 * added * scale(input)),
        }
    }
}

impl Scene {
    /// Shape of the structure, the parts that touch no absorbing face and whose elements are present, under a uniform
    /// acceleration: of three directions that with the lowest frequency. None without such parts, without anything
    /// that holds them, or where no static solution is found.
    pub(crate) fn static_shape(
        &self,
        pieces: &[Piece],
        present: Option<&[bool]>,
    ) -> Result<Option<StaticShape>, Error> {
        let behind = self.parts_behind_boundary()?;
        let own: Vec<&Piece> = (pieces.iter())
            .filter(|piece| !behind.contains(&piece.part))
            .collect();
        let is_present = |element: &u32| present.is_none_or(|present| present[*element as usize]);
        let of_structure = own.iter().flat_map(|piece| &piece.elements);
        let of_structure: BTreeSet<u32> = of_structure.copied().filter(is_present).collect();
        let others = 0..self.mesh.element_count() as u32;
        let others: Vec<u32> = others
            .filter(|element| !of_structure.contains(element))
            .collect();
        let beside: Vec<u32> = others.iter().copied().filter(is_present).collect();
        let mut held: BTreeSet<u32> = self.mesh.nodes_of_elements(&beside).into_iter().collect();
        let joints = self.joints.iter().flat_map(|joint| &joint.surface.pairs);
        held.extend(joints.flat_map(|pair| pair.nodes));
        let elements: Vec<u32> = of_structure.into_iter().collect();
        let nodes = self.mesh.nodes_of_elements(&elements);
        held.retain(|node| nodes.binary_search(node).is_ok());
        if elements.is_empty() || (held.is_empty() && self.supports.is_empty()) {
            return Ok(None);
        }
        let held: Vec<u32> = held.into_iter().collect();
        let mut lowest: Option<StaticShape> = None;
        for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
            let mut state = State::at_rest(self.mesh.node_count());
            state.remove(&others);
            let mut spec = ModelSpec::new(&self.mesh)
                .start(state)
                .support(Support::fixed(held.clone()))
                .gravity(axis * ACCELERATION, Box::new(Constant(1.0)));
            for support in &self.supports {
                spec = spec.support(support.clone());
            }
            for pairs in &self.periodic {
                spec = spec.periodic(pairs.clone());
            }
            for piece in &own {
                let part = &self.parts[piece.part];
                let elastic = piece.material.elastic();
                let factory = piece.resting(part, Some(&elastic));
                spec = spec.elements(piece.elements.clone(), factory);
            }
            if let Some(threads) = self.threads_taken() {
                spec = spec.threads(threads);
            }
            let mut model = self.engine.build(spec)?;
            let solved = model.equilibrate(&StaticOptions::default(), &mut |_| {});
            if solved.is_err() {
                continue;
            }
            let count = self.mesh.node_count() as u32;
            let motion: Vec<(Vec3, f64)> = (0..count)
                .map(|node| (model.displacement(node), model.mass(node)))
                .collect();
            let work = motion
                .iter()
                .map(|(u, mass)| mass * ACCELERATION * u.dot(&axis));
            let inertia = motion.iter().map(|(u, mass)| mass * u.norm_squared());
            let square = work.sum::<f64>() / inertia.sum::<f64>();
            let frequency = square.sqrt() / core::f64::consts::TAU;
            let is_lower = (lowest.as_ref()).is_none_or(|known| frequency < known.frequency);
            if frequency.is_finite() && frequency > 0.0 && is_lower {
                lowest = Some(StaticShape { frequency, motion });
            }
        }
        Ok(lowest)
    }
}
