//! Factories of blocks of solid elements.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, ElementBlock, ElementExtent, ElementKernel, ElementKind,
    EngineError, Extents, Geometry, KernelArithmetic, ModelError, PointLaw, Precision, Vec3,
};

use super::Block;
use super::account::Account;
use super::any_law::AnyLaw;
use super::frequency::HighestSquares;
use super::history::History;
use super::law::BatchLaw;
use super::law_forms::LawForms;
use super::locations::Locations;
use super::memory::Connectivity;
use super::numbers::AlignedNumbers;
use super::operations::Moduli;
use super::pore_water::{Drainage, VARIABLES as OF_WATER};
use super::transfer::NodeScalar;
use crate::lanes::{Arrangement, Lanes};

/// Makes a factory of blocks of solid elements from a label, any kernel, any law and options.
///
/// ```
/// use powerhouse_model::BlockOptions;
/// use powerhouse_elements::{Hex8OnePoint, solid};
/// # use powerhouse_model::*;
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     const LINEAR: bool = true;
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let law = Linear(ElasticMedium::new(9.0e9, 0.27, 2750.0)?);
/// let rock = solid("rock", Hex8OnePoint::default(), law, BlockOptions::default());
/// assert_eq!((rock.label(), rock.kind()), ("rock", ElementKind::Hex8));
/// # Ok::<(), ParameterError>(())
/// ```
pub fn solid<K, const N: usize, const P: usize>(
    label: &str,
    kernel: K,
    law: impl Into<AnyLaw>,
    options: BlockOptions,
) -> Box<dyn BlockFactory>
where
    K: ElementKernel<N, P>,
{
    of_any_law(label, kernel, law.into(), options)
}

/// A factory of solid blocks; compiled once for each kernel.
pub(crate) fn of_any_law<K, const N: usize, const P: usize>(
    label: &str,
    kernel: K,
    law: AnyLaw,
    options: BlockOptions,
) -> Box<dyn BlockFactory>
where
    K: ElementKernel<N, P>,
{
    Box::new(Solid::<K, N, P> {
        label: label.into(),
        kernel,
        law,
        options,
    })
}

struct Solid<K, const N: usize, const P: usize> {
    label: Arc<str>,
    kernel: K,
    law: AnyLaw,
    options: BlockOptions,
}

impl<K, const N: usize, const P: usize> BlockFactory for Solid<K, N, P>
where
    K: ElementKernel<N, P>,
{
    fn label(&self) -> &str {
        &self.label
    }
    fn kind(&self) -> ElementKind {
        self.kernel.kind()
    }
    fn options(&self) -> BlockOptions {
        self.options
    }
    fn relative_cost(&self) -> f64 {
        relative_cost(P, (!self.law.is_linear()).then(|| self.law.history().len()))
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        let law = self.law.in_lanes().cloned();
        let precision = match self.options.precision {
            Precision::Mixed | Precision::F32 if part.double => Precision::F64,
            precision => precision,
        };
        Ok(match precision {
            Precision::F64 => {
                let law = law.map(|law| -> Arc<dyn BatchLaw<f64>> { law });
                Box::new(self.block::<f64>(part, law)?)
            }
            Precision::Mixed | Precision::F32 => {
                let law = law.map(|law| -> Arc<dyn BatchLaw<f32>> { law });
                Box::new(self.block::<f32>(part, law)?)
            }
        })
    }
}

/// Cost of a step of an element over that of an elastic brick with one point, from its number of points and, unless its
/// law is linear, the number of history variables of a point.
///
/// A fifth for each further point, and for each point a tenth for a law and a twentieth for each of its variables. By the
/// benchmarks `step` and `law` that is right for elastic bricks of any shape and for flat damping, and between the cost before
/// anything yields and while everything does for a law. Blocks of parallelepipeds with several points cost less.
fn relative_cost(points: usize, history: Option<usize>) -> f64 {
    let of_law = history.map_or(0.0, |variables| 0.1 + 0.05 * variables as f64);
    1.0 + 0.2 * (points - 1) as f64 + points as f64 * of_law
}

impl<K, const N: usize, const P: usize> Solid<K, N, P>
where
    K: ElementKernel<N, P>,
{
    fn block<S: NodeScalar>(
        &self,
        part: &BlockPart,
        law: Option<Arc<dyn BatchLaw<S>>>,
    ) -> Result<Block<K, S, N, P>, ModelError> {
        let refused = |error: EngineError| ModelError::refused(self.kernel.name(), error);
        let lanes = Lanes::new(self.options.lanes);
        let arrangement = lanes.arrangement::<S>();
        let (medium, water) = (self.law.medium(), self.law.pore_water());
        let moduli = Moduli {
            lambda: medium.lambda(),
            shear: medium.shear(),
            skeleton: self.law.skeleton().lambda(),
            water: water.map_or(0.0, |water| water.stiffness()),
            is_drained: self.law.drainage() == Drainage::Drained,
            hourglass: self.kernel.hourglass_moduli(&medium).unwrap_or_default(),
        };
        let connectivity = self.connect(part, arrangement.width).map_err(refused)?;
        let padded = connectivity.len();
        let alike = alike::<N>(part);

        let length = self.kernel.geometry_len();
        let stored = if alike { arrangement.width } else { padded };
        let mut geometry = AlignedNumbers::<S>::zeros(stored * length);
        let wide = if law.is_some() { stored } else { 0 };
        let mut extents = AlignedNumbers::<S>::zeros(6 * wide);
        let mut widths = [0.0; 6];
        let mut shapes: Vec<([Vec3; N], [f64; N])> = Vec::new();
        let mut one = vec![0.0; length];
        for element in 0..padded {
            if element < part.elements.len() && !(alike && element > 0) {
                let mesh_element = part.elements[element];
                let corners = corners_of(part, mesh_element);
                self.kernel.geometry(&corners, &mut one);
                let volume = self.volume(part, mesh_element, &one).map_err(refused)?;
                if let Some(law) = &law {
                    let of_element = Extents::of_element(self.kernel.kind(), &corners);
                    self.check_extents(part, mesh_element, law.as_ref(), &of_element)
                        .map_err(refused)?;
                    widths = of_element.0;
                }
                let shares = self.kernel.node_shares(&corners);
                let masses = shares.map(|share| share * volume * medium.density);
                self.check_masses(part, mesh_element, &masses)
                    .map_err(refused)?;
                shapes.push((corners, masses));
            }
            if element < stored {
                for (index, number) in one.iter().enumerate() {
                    geometry.as_mut_slice()[arrangement.place(element, index, length)] =
                        S::from_f64(*number);
                }
            }
            if element < wide {
                for (index, number) in widths.iter().enumerate() {
                    extents.as_mut_slice()[arrangement.place(element, index, 6)] =
                        S::from_f64(*number);
                }
            }
        }
        let squares = lanes.dispatch::<f64, _>(HighestSquares {
            kernel: &self.kernel,
            moduli,
            elements: &shapes,
        });
        let pressures = water.map(|_| {
            let elements = part.elements.iter();
            let pressure = |&element: &u32| {
                let height = part.mesh.centroid(element).z;
                self.law.pore_pressure(element, height)
            };
            elements.map(pressure).collect()
        });
        // Copied, since a collection of the list itself would keep the memory of the corners.
        let masses = shapes.iter().map(|(_, masses)| *masses).collect();
        let frequencies = squares.into_iter().map(f64::sqrt).collect();
        let variables = law.as_ref().map_or(&[][..], |law| law.history());
        let own = law.as_ref().map_or(0, |_| self.kernel.own_history());
        let batches = (padded / arrangement.width, arrangement.width);
        Ok(Block {
            label: self.label.clone(),
            kernel: self.kernel.clone(),
            moduli,
            damping: self.options.damping,
            lanes,
            arrangement,
            elements: part.elements.to_vec(),
            nodes: part.nodes.to_vec(),
            connectivity: Connectivity::new(connectivity),
            geometry,
            extents,
            locations: law
                .as_ref()
                .filter(|law| law.uses_location())
                .map(|_| self.locations(part, &arrangement, padded)),
            masses,
            frequencies,
            active: None,
            reference: None,
            initial: AlignedNumbers::zeros(0),
            pore_pressures: pressures.unwrap_or_default(),
            history: History::new(variables, (P, own), batches)
                .with_water(water.map_or(0, |_| OF_WATER.len())),
            static_displacement: Vec::new(),
            committed_displacement: None,
            account: Account::default(),
            shown: Mutex::default(),
            is_linear_ground: self.law.is_linear_ground(),
            forces_at_rest: None,
            law: LawForms::new(law),
        })
    }

    /// Locations of the integration points of all elements, whole batches: the last element is repeated.
    fn locations<S: NodeScalar>(
        &self,
        part: &BlockPart,
        arrangement: &Arrangement,
        padded: usize,
    ) -> Locations<S> {
        let mut locations = Locations::zeros(padded, P);
        for element in 0..padded {
            let mesh_element = part.elements[element.min(part.elements.len() - 1)];
            let points = self.kernel.point_positions(&corners_of(part, mesh_element));
            let number = part.mesh.element_tags()[mesh_element as usize];
            locations.set(
                arrangement,
                element,
                number,
                &points.map(|point| point.into()),
            );
        }
        locations
    }

    /// Local node indices of each element, whole batches: the last element is repeated.
    fn connect(&self, part: &BlockPart, width: usize) -> Result<Vec<[u32; N]>, EngineError> {
        let local_of: HashMap<u32, u32> = part.nodes.iter().copied().zip(0..).collect();
        let padded = part.elements.len().next_multiple_of(width);
        let mut connectivity = Vec::with_capacity(padded);
        for &element in part.elements {
            let tag = part.mesh.element_tags()[element as usize];
            let kind = part.mesh.kind(element);
            if kind != self.kernel.kind() {
                return Err(EngineError::ElementKind {
                    element: tag,
                    set: self.label.to_string(),
                    found: kind.name(),
                    expected: self.kernel.kind().name(),
                });
            }
            part.mesh.check_edges(element)?;
            let nodes = part.mesh.nodes_of(element);
            let mut local = [0; N];
            for a in 0..N {
                local[a] = *local_of
                    .get(&nodes[a])
                    .ok_or_else(|| EngineError::UnlistedNode {
                        element: tag,
                        set: self.label.to_string(),
                        node: part.mesh.node_tags()[nodes[a] as usize],
                    })?;
            }
            connectivity.push(local);
        }
        if let Some(&last) = connectivity.last() {
            connectivity.resize(padded, last);
        }
        Ok(connectivity)
    }

    /// Checks that every node has a positive lumped mass.
    fn check_masses(
        &self,
        part: &BlockPart,
        element: u32,
        masses: &[f64; N],
    ) -> Result<(), EngineError> {
        match masses.iter().position(|&m| !(m > 0.0 && m.is_finite())) {
            None => Ok(()),
            Some(a) => Err(EngineError::NoLumpedMass {
                element: part.mesh.element_tags()[element as usize],
                set: self.label.to_string(),
                node: part.mesh.node_tags()[part.mesh.nodes_of(element)[a] as usize],
                mass: masses[a],
            }),
        }
    }

    /// Checks the greatest and the least width of an element by the law.
    fn check_extents<S: NodeScalar>(
        &self,
        part: &BlockPart,
        element: u32,
        law: &dyn BatchLaw<S>,
        extents: &Extents<f64>,
    ) -> Result<(), EngineError> {
        let [greatest, _, least] = extents.principal();
        for (extent, size) in [
            (ElementExtent::Greatest, greatest),
            (ElementExtent::Least, least),
        ] {
            law.accept_size(size)
                .map_err(|error| EngineError::ElementSize {
                    element: part.mesh.element_tags()[element as usize],
                    set: self.label.to_string(),
                    extent,
                    size,
                    reason: error.to_string(),
                })?;
        }
        Ok(())
    }

    /// Volume of an element, of which every integration point must have a positive share.
    fn volume(&self, part: &BlockPart, element: u32, geometry: &[f64]) -> Result<f64, EngineError> {
        let volumes = self.kernel.volumes(Geometry::<f64>::new((), geometry));
        match volumes.iter().find(|&&v| !(v > 0.0 && v.is_finite())) {
            None => Ok(volumes.iter().sum()),
            Some(&volume) => Err(EngineError::NoVolume {
                set: self.label.to_string(),
                element: part.mesh.element_tags()[element as usize],
                volume,
            }),
        }
    }
}

/// Whether all elements are translations of the first one, within the rounding of the coordinates.
fn alike<const N: usize>(part: &BlockPart) -> bool {
    let Some(&first) = part.elements.first() else {
        return false;
    };
    let relative = |element: u32| {
        let corners = corners_of::<N>(part, element);
        corners.map(|corner| corner - corners[0])
    };
    let shape = relative(first);
    part.elements.iter().all(|&element| {
        let tolerance = coordinate_rounding(&corners_of::<N>(part, element));
        let other = relative(element);
        shape
            .iter()
            .zip(&other)
            .all(|(a, b)| (a - b).amax() <= tolerance)
    })
}

/// Rounding error of differences of the coordinates of an element (m).
pub(crate) fn coordinate_rounding<const N: usize>(corners: &[Vec3; N]) -> f64 {
    let largest = corners.iter().map(|corner| corner.amax());
    4.0 * f64::EPSILON * largest.fold(0.0, f64::max)
}

fn corners_of<const N: usize>(part: &BlockPart, element: u32) -> [Vec3; N] {
    let nodes = part.mesh.nodes_of(element);
    core::array::from_fn(|a| part.mesh.positions()[nodes[a] as usize])
}
