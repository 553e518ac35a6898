//! Elements, supports and loads common to the static and dynamic models of a scene.

use core::f64::consts::TAU;
use std::collections::HashSet;

use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, DelayedPairs, ElementKind, ModelSpec, ParameterError,
    Precision, Prescribed, Rayleigh,
};

use crate::acting::{StagedLoad, function};
use crate::stage::WaterAtRest;
use crate::{Error, HighDamping, Kernel, Part, Remark, Scene, remark};
use powerhouse_laws::{Damping, DampingCost, Material};

/// Most elements whose highest frequency is sought together.
const AT_ONCE: usize = 4096;

/// Elements of one part with one kernel and one material.
pub(crate) struct Piece {
    /// Index of the part in the scene.
    pub(crate) part: usize,
    /// Mesh indices of the elements.
    pub(crate) elements: Vec<u32>,
    /// Material in the dynamic run.
    pub(crate) material: Material,
    kernel: Kernel,
    damping: Rayleigh,
    rim: bool,
}

impl Piece {
    /// Block factory of the dynamic model.
    pub(crate) fn moving(
        &self,
        part: &Part,
        precision: Precision,
        water: &WaterAtRest,
    ) -> Box<dyn BlockFactory> {
        let mut options = BlockOptions::default();
        options.precision = precision;
        options.damping = self.damping;
        let material = water.of(self.material.clone());
        self.kernel.factory(&part.set, &material, options)
    }
    /// Block factory of static models, in double precision, with the dynamic material or another one.
    pub(crate) fn resting(
        &self,
        part: &Part,
        other: Option<&Material>,
        water: &WaterAtRest,
    ) -> Box<dyn BlockFactory> {
        let material = match other {
            None => self.material.clone(),
            Some(other) if self.rim => other.elastic(),
            Some(other) => other.clone(),
        };
        let options = BlockOptions::default();
        let material = water.of(material);
        self.kernel.factory(&part.set, &material, options)
    }
}

impl Scene {
    /// Elements of all parts by kind, rims separately, and remarks about them.
    pub(super) fn pieces(&self, rims: &[HashSet<u32>]) -> Result<(Vec<Piece>, Vec<Remark>), Error> {
        let (mut pieces, mut remarks) = (Vec::new(), Vec::new());
        for (place, (part, rim)) in self.parts.iter().zip(rims).enumerate() {
            let warnings = part.material.warnings().iter();
            remarks.extend(warnings.map(|warning| {
                Remark::from(remark::Material {
                    set: part.set.clone(),
                    warning: warning.clone(),
                })
            }));
            let kinds = self.by_kind(part)?;
            if let Some(kernel) = part.unused_kernel(kinds.iter().map(|(kind, _)| *kind)) {
                return Err(Error::UnusedKernel {
                    set: part.set.clone(),
                    kernel: kernel.name().into(),
                });
            }
            let moving = part.moving_material()?;
            remarks.extend(self.facts(part, &moving, rim)?);
            let mut divided = Vec::new();
            for (kind, elements) in kinds {
                let kernel = part.kernel_for(kind).ok_or_else(|| Error::NoKernel {
                    element: self.mesh.element_tags()[elements[0] as usize],
                    set: part.set.clone(),
                    kind: kind.name(),
                })?;
                let (at_rim, inner): (Vec<u32>, Vec<u32>) = if rim.is_empty() {
                    (Vec::new(), elements)
                } else {
                    (elements.iter()).partition(|element| rim.contains(element))
                };
                divided.push((kernel, inner, at_rim));
            }
            let mut damping = part.damping.rayleigh();
            if part.high != 0.0 {
                let all = divided
                    .iter()
                    .map(|(kernel, inner, _)| (kernel, &inner[..]));
                let high = self.high_damping(part, &moving, all)?;
                damping.stiffness += high.coefficient;
                remarks.push(Remark::HighDamping(high));
            }
            for (kernel, inner, at_rim) in divided {
                for (elements, material, damping, rim) in [
                    (inner, moving.clone(), damping, false),
                    (at_rim, part.material.elastic(), Rayleigh::default(), true),
                ] {
                    if !elements.is_empty() {
                        pieces.push(Piece {
                            part: place,
                            elements,
                            material,
                            kernel: kernel.clone(),
                            damping,
                            rim,
                        });
                    }
                }
            }
        }
        Ok((pieces, remarks))
    }

    /// Viscosity of a part whose elements are given with their kernels.
    fn high_damping<'e>(
        &self,
        part: &Part,
        moving: &Material,
        divided: impl Iterator<Item = (&'e Kernel, &'e [u32])>,
    ) -> Result<HighDamping, Error> {
        ParameterError::check("high", part.high, 0.0, 1.0)?;
        let mut highest = 0.0_f64;
        for (kernel, elements) in divided {
            let factory = kernel.factory(&part.set, moving, BlockOptions::default());
            for elements in elements.chunks(AT_ONCE) {
                let nodes = self.mesh.nodes_of_elements(elements);
                let block = factory.build(&BlockPart::new(&self.mesh, elements, &nodes))?;
                let bounds = block.frequency_bounds().into_iter();
                highest = bounds.map(|bound| bound.frequency).fold(highest, f64::max);
            }
        }
        Ok(HighDamping {
            set: part.set.clone(),
            ratio: part.high,
            highest: highest / TAU,
            coefficient: if highest > 0.0 {
                2.0 * part.high / highest
            } else {
                0.0
            },
        })
    }

    /// Adds supports, periodic pairs, prescribed motions, loads and weights of the scene and its stages to a model: in
    /// a stage with their values at the start of the run, in the dynamic run as functions of time.
    pub(crate) fn acted_on<'a>(
        &self,
        mut spec: ModelSpec<'a>,
        stage: Option<usize>,
    ) -> ModelSpec<'a> {
        let held_at = stage.map(|_| self.start);
        let stages = &self.stages[..stage.map_or(self.stages.len(), |stage| stage + 1)];
        for support in &self.supports {
            spec = spec.support(support.clone());
        }
        for pairs in &self.periodic {
            spec = spec.periodic(pairs.clone());
        }
        spec = match (&self.delayed, stage) {
            (None, _) => spec,
            (Some(pairs), Some(_)) => spec.periodic(pairs.clone()),
            (Some(pairs), None) => spec.delayed(DelayedPairs {
                pairs: pairs.pairs.clone(),
                slowness: self.slowness_along_y(),
                stiff: self.stiff_elements(),
            }),
        };
        for driven in &self.prescribed {
            spec = spec.prescribed(Prescribed {
                nodes: driven.nodes.clone(),
                direction: driven.direction,
                displacement: function(&driven.displacement, held_at),
            });
        }
        let loads = stages.iter().flat_map(|stage| &stage.loads);
        for staged in self.loads.iter().chain(loads) {
            if self.is_applied(staged, stage) {
                spec = spec.load(staged.load.held(held_at));
            }
        }
        let weights = stages.iter().flat_map(|stage| &stage.weights);
        for (acceleration, history) in self.weights.iter().chain(weights) {
            spec = spec.gravity(*acceleration, function(history, held_at));
        }
        spec
    }

    /// Returns whether a load is not yet removed in a stage, or in the dynamic run.
    fn is_applied(&self, staged: &StagedLoad, stage: Option<usize>) -> bool {
        let Some(name) = &staged.removed_in else {
            return true;
        };
        let removal = self.stages.iter().position(|stage| stage.name == *name);
        matches!((stage, removal), (Some(stage), Some(removal)) if stage < removal)
    }

    /// Remarks about the flat damping and the rim of a part.
    fn facts(
        &self,
        part: &Part,
        moving: &Material,
        rim: &HashSet<u32>,
    ) -> Result<Vec<Remark>, Error> {
        let mut facts = Vec::new();
        let set = || part.set.clone();
        if let Damping::Flat {
            spectrum,
            reference,
        } = &part.damping
        {
            facts.push(Remark::from(remark::FlatDamping {
                set: set(),
                cost: DampingCost::of(&part.material, moving, (spectrum, *reference))?,
                by_default: part.damping == *part.material.default_damping(),
            }));
        }
        if let Damping::Rayleigh(rayleigh) = &part.damping
            && rayleigh.stiffness != 0.0
            && !part.material.is_linear()
        {
            facts.push(Remark::from(remark::DampedHistory {
                set: set(),
                law: part.material.name().into(),
            }));
        }
        if let Some(width) = part.rim {
            let of = self.mesh.element_set(&part.set)?.len();
            facts.push(Remark::from(remark::Rim {
                set: set(),
                width,
                elements: rim.len(),
                of,
            }));
            let changes = part.damping != Damping::None || !part.material.is_linear();
            if rim.len() == of && (changes || width > 0.0) {
                facts.push(remark::WholeRim { set: set() }.into());
            }
        }
        Ok(facts)
    }

    /// Elements of a part by kind.
    fn by_kind(&self, part: &Part) -> Result<Vec<(ElementKind, Vec<u32>)>, Error> {
        let mut kinds: Vec<(ElementKind, Vec<u32>)> = Vec::new();
        for &element in self.mesh.element_set(&part.set)? {
            let kind = self.mesh.kind(element);
            match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, elements)) => elements.push(element),
                None => kinds.push((kind, vec![element])),
            }
        }
        Ok(kinds)
    }
}
