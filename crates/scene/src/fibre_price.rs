//! What fibres cost, before a run: by how much they lower the frequencies of the structure and of its motion.
//!
//! # Why so
//! *Rayleigh's quotient of the slowest mode*: the added inertia in the mode over its mass gives twice the relative change of
//! its frequency. The mode is that of the structure held where it joins the ground, by inverse iteration from uniform
//! accelerations and an irregular one. (The deflection under a uniform acceleration alone lies between the modes of all
//! parts that are held by themselves: for those of a powerhouse it gave 60 Hz in place of 37 Hz.)
//!
//! *What the input moves* has other frequencies. Below that of the mode the structure follows the ground, and what fibres
//! feel of its own inertia falls with the square of the frequency; above it they feel ever shorter bending waves, whose
//! square of the wave number grows as the frequency.
//!
//! *The ground strains what it holds*: across a fibre of radius of gyration `r` the velocity of a shear wave differs by
//! `2 pi f r / c` of itself, whatever the frequencies of the structure. A lining bends with the ground long before it
//! vibrates by itself.

use core::f64::consts::TAU;
use core::fmt;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{DMatrix, DVector};
use powerhouse_model::{
    EngineModel, Fibre, ModelSpec, NodalLoad, State, StaticOptions, Support, Vec3,
};

use crate::body::Piece;
use crate::fibres::fibres_of;
use crate::input_spectrum::InputSpectrum;
use crate::stage::WaterAtRest;
use crate::{Error, Scene};

/// Number of modes that are kept from one round of inverse iteration to the next, and most rounds.
const KEPT: usize = 2;
const MOST_ROUNDS: usize = 6;
/// Relative change of the frequency in a round at which it is known.
const KNOWN: f64 = 2e-3;
/// Tolerance of the static solutions: the quotient errs by its square.
const TOLERANCE: f64 = 1e-5;
/// Share of the greatest eigenvalue of the shapes of a round below which they are the same but for rounding.
const SAME: f64 = 1e-10;

/// Relative decrease of frequencies by fibres, estimated before the run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FibreShift {
    /// Lowest frequency (Hz) of the structure, held where it joins the ground.
    pub natural: f64,
    /// By how much the fibres lower that frequency (1).
    pub of_natural: f64,
    /// What the fibres do to the motion of the input; none without input.
    pub of_input: Option<InputShift>,
}

/// What fibres do to the motion of an input, estimated before the run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct InputShift {
    /// Frequency (Hz) below which the input has 99 % of the energy of its acceleration.
    pub frequency: f64,
    /// Relative decrease of a frequency of motion as high as that (1).
    pub shift: f64,
    /// Relative error of accelerations, and so of shear forces: the same decrease for all motion of the input, weighted by
    /// the energy of its acceleration (1).
    pub of_accelerations: f64,
    /// The same of axial forces and moments, which follow the strain of the ground: weighted by the energy of velocity (1).
    pub of_forces: f64,
}

/// What an estimated error of fibres leaves out.
pub const OF_FIBRES_ALONE: &str = "by the fibres alone and in elastic motion: the longer step has an error of its own, and where \
     joints slip or materials flow or crack, either may change accelerations altogether";

impl fmt::Display for FibreShift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "they lower the first frequency of the structure, {:.1} Hz where it is held at the ground, by {:.2} %",
            self.natural,
            100.0 * self.of_natural
        )?;
        let Some(input) = self.of_input else {
            return Ok(());
        };
        write!(
            f,
            ", and motion at {:.1} Hz, below which the input has 99 % of its energy, by {:.2} % (an estimate); \
             errors of accelerations and shear forces are about {:.1e}, of axial forces and moments {:.1e}, {OF_FIBRES_ALONE}",
            input.frequency,
            100.0 * input.shift,
            input.of_accelerations,
            input.of_forces
        )
    }
}

/// Slowest mode of a structure that is held where it joins the ground.
#[derive(Clone, Debug)]
pub(crate) struct ClampedMode {
    /// Frequency (Hz).
    frequency: f64,
    /// Displacement of the nodes of the mesh with a sum of mass times square of one.
    shape: Vec<Vec3>,
    /// Speed of the slowest shear waves in the ground (m/s); none without ground.
    ground_speed: Option<f64>,
}

impl ClampedMode {
    /// What fibres cost in a model of the mesh, with an input; none of a model that shows no masses.
    pub(crate) fn shift(
        &self,
        fibres: &[Fibre],
        model: &dyn EngineModel,
        input: Option<&InputSpectrum>,
    ) -> Option<FibreShift> {
        let output = model.output()?;
        let positions = model.mesh().positions();
        // Added inertia in the mode over its mass; added inertia times the square of the radius of gyration, and mass.
        let (mut in_mode, mut across, mut whole) = (0.0, 0.0, 0.0);
        for fibre in fibres {
            let masses: Vec<f64> = fibre.nodes.iter().map(|&node| output.mass(node)).collect();
            let apart = |values: &[Vec3]| {
                let own = fibre.nodes.iter().map(|&node| values[node as usize]);
                let mass: f64 = masses.iter().sum();
                let mean = own.clone().zip(&masses).map(|(u, m)| u * *m).sum::<Vec3>() / mass;
                let squares = own.zip(&masses).map(|(u, m)| m * (u - mean).norm_squared());
                squares.sum::<f64>()
            };
            in_mode += fibre.added * apart(&self.shape);
            across += fibre.added * apart(positions);
            whole += masses.iter().sum::<f64>();
        }
        let natural = self.frequency;
        let at = |frequency: f64| {
            let ratio = frequency / natural;
            let of_structure = in_mode * if ratio < 1.0 { ratio * ratio } else { ratio };
            let of_ground = self.ground_speed.map_or(0.0, |speed| {
                across / whole.max(f64::MIN_POSITIVE) * (TAU * frequency / speed).powi(2)
            });
            0.5 * (of_structure + of_ground)
        };
        Some(FibreShift {
            natural,
            of_natural: 1.0 - 1.0 / (1.0 + in_mode).sqrt(),
            of_input: input.map(|input| {
                let [of_accelerations, of_forces] = input.root_mean_squares(at);
                InputShift {
                    frequency: input.highest(),
                    shift: at(input.highest()),
                    of_accelerations,
                    of_forces,
                }
            }),
        })
    }
}

/// Forces (N) at some nodes that static solutions are repeated with.
struct Forces {
    nodes: Vec<u32>,
    forces: Arc<Mutex<Vec<Vec3>>>,
}

impl NodalLoad for Forces {
    fn name(&self) -> &str {
        "inertia"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn add_forces(&mut self, _time: f64, forces: &mut [Vec3]) {
        let own = self.forces.lock().unwrap_or_else(PoisonError::into_inner);
        for (sum, force) in forces.iter_mut().zip(&*own) {
            *sum += force;
        }
    }
}

/// A structure that is held where it joins the ground, with the nodes that belong to it.
struct Clamped {
    model: Box<dyn EngineModel>,
    nodes: Vec<u32>,
    masses: Vec<f64>,
    forces: Arc<Mutex<Vec<Vec3>>>,
}

/// Displacements of the nodes of a structure.
type Shape = Vec<Vec3>;

impl Clamped {
    /// Displacement under the inertia of a shape; none where no static solution is found.
    fn deflect(&mut self, shape: &Shape) -> Option<Shape> {
        let loads = shape.iter().zip(&self.masses).map(|(u, mass)| u * *mass);
        *self.forces.lock().unwrap_or_else(PoisonError::into_inner) = loads.collect();
        let options = StaticOptions::default().with_tolerance(TOLERANCE);
        let statics = self.model.statics()?;
        statics.equilibrate(&options, &mut |_| {}).ok()?;
        let nodes = self.nodes.iter();
        Some(nodes.map(|&node| self.model.displacement(node)).collect())
    }

    fn product(&self, a: &Shape, b: &Shape) -> f64 {
        let products = a.iter().zip(b).zip(&self.masses);
        products.map(|((a, b), mass)| mass * a.dot(b)).sum()
    }

    /// The slowest combinations of shapes and the squares of their circular frequencies, from the slowest on, given what
    /// each shape is the deflection of.
    fn slowest(&self, loads: &[Shape], shapes: &[Shape]) -> Vec<(f64, Shape)> {
        let count = shapes.len();
        let of = |with: &[Shape]| {
            let all = DMatrix::from_fn(count, count, |i, j| self.product(&shapes[i], &with[j]));
            (&all + all.transpose()) * 0.5
        };
        let (mass, stiffness) = (of(shapes), of(loads));
        // Shapes with a unit mass, without those that are the same.
        let eigen = mass.symmetric_eigen();
        let most = eigen.eigenvalues.amax();
        let kept = (0..count).filter(|&i| eigen.eigenvalues[i] > SAME * most);
        let columns: Vec<DVector<f64>> = kept
            .map(|i| eigen.eigenvectors.column(i) / eigen.eigenvalues[i].sqrt())
            .collect();
        if columns.is_empty() {
            return Vec::new();
        }
        let base = DMatrix::from_columns(&columns);
        let reduced = (base.transpose() * stiffness * &base).symmetric_eigen();
        let mut found: Vec<(f64, Shape)> = (reduced.eigenvalues.iter().enumerate())
            .map(|(mode, &square)| {
                let weights = &base * reduced.eigenvectors.column(mode);
                let at = |node: usize| {
                    let parts = shapes.iter().zip(weights.iter());
                    parts.map(|(shape, weight)| shape[node] * *weight).sum()
                };
                (square, (0..self.nodes.len()).map(at).collect())
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }
}

/// A number of -1 to 1 that differs irregularly from one integer to the next (the mixer of Steele, Lea & Flood 2014).
fn irregular(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

impl Scene {
    /// The slowest mode of the structure, the parts that touch no absorbing face and whose elements are present, held where
    /// it joins others and at joints. None without such parts, without anything that holds them, or where no static
    /// solution is found.
    pub(crate) fn clamped_mode(
        &self,
        pieces: &[Piece],
        present: Option<&[bool]>,
    ) -> Result<Option<ClampedMode>, Error> {
        let Some(mut clamped) = self.clamped(pieces, present)? else {
            return Ok(None);
        };
        let count = clamped.nodes.len();
        let mut loads: Vec<Shape> = [Vec3::x(), Vec3::y(), Vec3::z()]
            .map(|axis| vec![axis; count])
            .into();
        let noise = |node: usize| Vec3::from_fn(|c, _| irregular(3 * node as u64 + c as u64));
        loads.push((0..count).map(noise).collect());
        let mut found: Option<(f64, Shape)> = None;
        for _ in 0..MOST_ROUNDS {
            let mut shapes = Vec::with_capacity(loads.len());
            for load in &loads {
                match clamped.deflect(load) {
                    Some(shape) => shapes.push(shape),
                    None => return Ok(None),
                }
            }
            let mut slowest = clamped.slowest(&loads, &shapes);
            slowest.truncate(KEPT);
            let Some((square, shape)) = slowest.first().cloned() else {
                return Ok(None);
            };
            let is_known = found.is_some_and(|(before, _)| {
                (square.sqrt() - before.sqrt()).abs() <= KNOWN * square.sqrt()
            });
            found = Some((square, shape));
            if is_known {
                break;
            }
            loads = slowest.into_iter().map(|(_, shape)| shape).collect();
        }
        let behind = self.parts_behind_boundary()?;
        let speeds = behind
            .iter()
            .map(|&part| self.parts[part].material.medium().s_speed());
        let ground_speed = speeds.reduce(f64::min);
        let mode = found.filter(|(square, _)| square.is_finite() && *square > 0.0);
        Ok(mode.map(|(square, own)| {
            let mut shape = vec![Vec3::zeros(); self.mesh.node_count()];
            for (&node, u) in clamped.nodes.iter().zip(own) {
                shape[node as usize] = u;
            }
            ClampedMode {
                frequency: square.sqrt() / TAU,
                shape,
                ground_speed,
            }
        }))
    }

    fn clamped(
        &self,
        pieces: &[Piece],
        present: Option<&[bool]>,
    ) -> Result<Option<Clamped>, Error> {
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
        let forces = Arc::new(Mutex::new(vec![Vec3::zeros(); nodes.len()]));
        let mut state = State::at_rest(self.mesh.node_count());
        state.remove(&others);
        let mut spec = ModelSpec::new(&self.mesh)
            .start(state)
            .support(Support::fixed(held.into_iter().collect::<Vec<u32>>()))
            .load(Box::new(Forces {
                nodes: nodes.clone(),
                forces: forces.clone(),
            }));
        for support in &self.supports {
            spec = spec.support(support.clone());
        }
        for pairs in &self.periodic {
            spec = spec.periodic(pairs.clone());
        }
        for piece in &own {
            let part = &self.parts[piece.part];
            let elastic = piece.material.elastic();
            let factory = piece.resting(part, Some(&elastic), &WaterAtRest::default());
            spec = spec.elements(piece.elements.clone(), factory);
        }
        if let Some(threads) = self.threads_taken() {
            spec = spec.threads(threads);
        }
        let mut model = self.engine.build(spec)?;
        if fibres_of(model.as_mut()).is_none() {
            // Of an engine without fibres, as on several ranks, each of which knows its own nodes.
            return Ok(None);
        }
        let Some(output) = model.output() else {
            return Ok(None);
        };
        Ok(Some(Clamped {
            masses: nodes.iter().map(|&node| output.mass(node)).collect(),
            model,
            nodes,
            forces,
        }))
    }
}

#[cfg(test)]
mod tests {
    use powerhouse_material_damage::LinearElastic;
    use powerhouse_model::{ElasticMedium, Mesh};

    use super::*;
    use crate::{FibreOptions, Part};

    /// Of two cantilevers of different length, a plate that is held along a line, the price is that of the longer one: its
    /// frequency is Bernoulli's, and the shift is that of the added rotary inertia in its first mode (Blevins 1979: the
    /// integral of the square of its slope is 4.6478 over the square of its length times that of its deflection).
    #[test]
    fn the_price_is_that_of_the_slowest_mode() {
        let (young, density) = (30e9, 2500.0);
        for (below, above, layers) in [(3.0, 4.0, 2), (5.0, 3.5, 1)] {
            let thickness = 0.1 * layers as f64;
            let pieces = ((below + above) * 4.0) as usize;
            let high = Vec3::new(0.4, thickness, below + above);
            let mesh =
                Mesh::box_of_hexes(Vec3::zeros(), high, [1, layers, pieces], "plate").unwrap();
            let held = mesh.positions().iter().enumerate();
            let held = held.filter(|(_, x)| (x.z - below).abs() < 1e-9);
            let held: Vec<u32> = held.map(|(node, _)| node as u32).collect();
            assert_eq!(held.len(), 2 * (layers + 1));
            let medium = ElasticMedium::new(young, 0.0, density).unwrap();
            let scene = Scene::new("plate", mesh)
                .part(Part::new("plate", LinearElastic::new(medium).into()))
                .support(Support::fixed(held))
                .with_fibres(FibreOptions::new(2.0).in_sets(["plate"]))
                .with_duration(0.01);
            let simulation = scene.prepare().unwrap();
            let choice = simulation.fibres().unwrap();
            let shift = choice.shift.unwrap();
            let length = f64::max(below, above);
            let gyration = thickness / 12.0_f64.sqrt();
            let exact = 1.875_104_f64.powi(2) / (TAU * length * length)
                * gyration
                * (young / density).sqrt();
            let error = shift.natural / exact - 1.0;
            assert!(error.abs() < 0.02, "{length} m: {shift:?}, {exact} Hz");
            // Of the nodes of one layer, or of two.
            let square = thickness * thickness / if layers == 1 { 4.0 } else { 8.0 };
            let expected = 0.5 * choice.most_added() * 4.6478 * square / (length * length);
            let error = shift.of_natural / expected - 1.0;
            assert!(error.abs() < 0.04, "{length} m: {shift:?}, {expected}");
            assert!(shift.of_input.is_none());
        }
    }
}
