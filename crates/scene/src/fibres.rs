//! Choice of the fibres of a scene: which nodes of thin bricks get added inertia, and how much.
//!
//! # Why so
//! *A thin brick limits the step by the change of its thickness*, a motion of its opposite faces against each other of
//! which waves and vibrations of the structure have next to nothing. Fibres make that motion slower and leave all
//! others.
//!
//! *Each element gets what it needs*: the bound of its own frequency times the ratio of the assembled model says how
//! long a step it permits by itself; the inertia that it lacks for the requested step follows from the square. The step
//! that is reached is computed afterwards, from the whole model.
//!
//! *Edges join nodes from the shortest on*, and one that would bring nodes of joints that are solved apart, or too many
//! nodes, into one fibre is left out: pairs are solved together where a fibre has nodes of several.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use powerhouse_model::{
    DisjointSets, ElementKind, EngineModel, Fibre, FibreModel, FrequencyBound, Mesh, ModelError,
    TimeIntegrator,
};

use crate::body::Piece;
use crate::fibre_price::ClampedMode;
use crate::input_spectrum::InputSpectrum;
use crate::resolution::PER_WAVELENGTH;
use crate::{Error, FibreChoice, FibreOptions, Scene};

/// Most nodes of a fibre.
pub(crate) const MOST_NODES: usize = 18;
/// Factor on the step up to which thin elements alone must limit it for fibres to be worth a try.
const NEARLY_TWICE: f64 = 1.5;
/// An edge of a fibre is shorter than this many times the way of a P wave in the requested step.
const REACH: f64 = 1.15;
/// It is of a family of parallel edges at most this many times as long as the shortest, and below this share of the
/// longest.
const ALIKE: f64 = 1.3;
const SHORT: f64 = 0.75;
/// Share of the shortest wavelength below which a part is thin: a fibre of a set that is not named is shorter than this
/// share of the wavelength that the longest edge of its part resolves.
const THIN: f64 = 0.2;

/// Families of parallel edges of a brick and of a wedge, by their local nodes.
const OF_BRICK: [&[[u8; 2]]; 3] = [
    &[[0, 1], [3, 2], [4, 5], [7, 6]],
    &[[0, 3], [1, 2], [4, 7], [5, 6]],
    &[[0, 4], [1, 5], [2, 6], [3, 7]],
];
const OF_WEDGE: [&[[u8; 2]]; 4] = [
    &[[0, 1], [3, 4]],
    &[[1, 2], [4, 5]],
    &[[0, 2], [3, 5]],
    &[[0, 3], [1, 4], [2, 5]],
];

/// A short edge of an element that needs added inertia.
#[derive(Clone, Copy, Debug)]
struct ShortEdge {
    length: f64,
    /// Its nodes, each that which stands for all with which it moves as one.
    nodes: [u32; 2],
    /// Added inertia that the element needs, over mass (1).
    added: f64,
    part: usize,
}

/// Part of a body as fibres need it.
#[derive(Clone, Debug)]
struct FibrePart {
    set: String,
    /// Speed of P waves (m/s).
    p_speed: f64,
    /// Longest edge of its elements (m).
    longest: f64,
}

/// Fibres with what was left out.
#[derive(Debug, Default)]
struct Found {
    fibres: Vec<Fibre>,
    parts: BTreeSet<usize>,
    cut_edges: usize,
    thick: usize,
    without: usize,
}

/// What the choice of fibres reads of a scene.
#[derive(Clone, Debug)]
pub(crate) struct FibreSite {
    mesh: Arc<Mesh>,
    part_of: Vec<Option<usize>>,
    parts: Vec<FibrePart>,
    /// Node that stands for those with which a node moves as one.
    stands_for: Vec<u32>,
    /// Constraint of such a node: one number for joints that are solved together, one for each node of other constraints.
    constraint_of: Vec<Option<u32>>,
    /// Names of the joints, with such nodes of theirs.
    joints: Vec<(String, Vec<u32>)>,
    /// Slowest mode of the structure, and spectrum of the input, if they are known.
    mode: Option<ClampedMode>,
    input: Option<InputSpectrum>,
}

impl Scene {
    /// Sets the fibres of the dynamic run, in place of none: added inertia of the motion across thin parts, for a
    /// longer step.
    #[must_use]
    pub fn with_fibres(mut self, fibres: FibreOptions) -> Self {
        self.fibres = Some(fibres);
        self
    }
    /// The fibres that the scene asks for.
    pub fn fibres(&self) -> Option<&FibreOptions> {
        self.fibres.as_ref()
    }

    /// Whether elements with short edges alone would limit a step nearly twice as long, by the shortest edges of all
    /// elements: fibres may then make the step longer.
    pub fn has_thin_limits(&self) -> bool {
        let Ok(part_of) = self.part_of_elements() else {
            return false;
        };
        let speed = |element: usize| {
            let part = part_of[element].map(|part| &self.parts[part]);
            part.map(|part| part.material.medium().p_speed())
        };
        // Travel time through the shortest extent of each element, and whether that is a short one.
        let times = (0..self.mesh.element_count()).filter_map(|element| {
            let speed = speed(element)?;
            let means = mean_lengths(&self.mesh, element as u32);
            let [shortest, longest] = if means.is_empty() {
                [shortest_distance(&self.mesh, element as u32); 2]
            } else {
                [f64::min, f64::max].map(|of| means.iter().copied().reduce(of).unwrap_or(0.0))
            };
            Some((shortest / speed, shortest < SHORT * longest))
        });
        let times: Vec<(f64, bool)> = times.collect();
        let least = times
            .iter()
            .fold(f64::INFINITY, |least, (time, _)| least.min(*time));
        let limits = times
            .iter()
            .filter(|(time, _)| *time < NEARLY_TWICE * least);
        limits.clone().next().is_some() && limits.clone().all(|(_, is_thin)| *is_thin)
    }

    /// Prepares simulations that say what fibres cost, see
    /// [`Simulation::choose_fibres`](crate::Simulation::choose_fibres), although the scene may have none.
    #[must_use]
    pub fn with_price_of_fibres(mut self) -> Self {
        self.prices_fibres = true;
        self
    }

    /// What the choice of fibres needs of the scene.
    pub(crate) fn fibre_site(
        &self,
        pieces: &[Piece],
        present: Option<&[bool]>,
    ) -> Result<FibreSite, Error> {
        let mut tied = DisjointSets::new(self.mesh.node_count());
        for &(a, b) in self.periodic.iter().flat_map(|periodic| &periodic.pairs) {
            tied.join(a, b);
        }
        let nodes = 0..self.mesh.node_count() as u32;
        let stands_for: Vec<u32> = nodes.map(|node| tied.root(node)).collect();
        let of = |node: u32| stands_for[node as usize];
        let joints = self.joints.iter().map(|joint| {
            let nodes = joint.surface.pairs.iter().flat_map(|pair| pair.nodes);
            (joint.name.clone(), nodes.map(of).collect())
        });
        let joints: Vec<(String, Vec<u32>)> = joints.collect();
        // Joints with common nodes are solved together.
        let mut solved = DisjointSets::new(stands_for.len());
        for (_, nodes) in &joints {
            nodes
                .windows(2)
                .for_each(|pair| solved.join(pair[0], pair[1]));
        }
        let mut constraint_of = vec![None; stands_for.len()];
        for &node in joints.iter().flat_map(|(_, nodes)| nodes) {
            constraint_of[node as usize] = Some(solved.root(node));
        }
        for &node in self.constraints.iter().flat_map(|own| own.nodes()) {
            constraint_of[of(node) as usize] = Some(of(node));
        }
        let part_of = self.part_of_elements()?;
        let parts = self.parts.iter().map(|part| FibrePart {
            set: part.set.clone(),
            p_speed: part.material.medium().p_speed(),
            longest: 0.0,
        });
        let mut parts: Vec<FibrePart> = parts.collect();
        for (element, part) in (0..).zip(&part_of) {
            if let Some(part) = part {
                for edge in families(self.mesh.kind(element)).iter().copied().flatten() {
                    let longest = &mut parts[*part].longest;
                    *longest = longest.max(length(&self.mesh, element, edge));
                }
            }
        }
        let is_priced = self.prices_fibres || self.fibres.is_some();
        let (mode, input) = if is_priced {
            (self.clamped_mode(pieces, present)?, self.input_spectrum()?)
        } else {
            (None, None)
        };
        Ok(FibreSite {
            mode,
            input,
            mesh: self.mesh.clone(),
            part_of,
            parts,
            stands_for,
            constraint_of,
            joints,
        })
    }
}

/// Families of parallel edges of an element; none of kinds that get no fibres.
fn families(kind: ElementKind) -> &'static [&'static [[u8; 2]]] {
    match kind {
        ElementKind::Hex8 => &OF_BRICK,
        ElementKind::Wedge6 => &OF_WEDGE,
        _ => &[],
    }
}

/// Mean length of the edges of each family of an element (m).
fn mean_lengths(mesh: &Mesh, element: u32) -> Vec<f64> {
    let families = families(mesh.kind(element)).iter();
    let mean = |family: &&[[u8; 2]]| {
        let lengths = family.iter().map(|edge| length(mesh, element, edge));
        lengths.sum::<f64>() / family.len() as f64
    };
    families.map(mean).collect()
}

/// Shortest distance of two nodes of an element (m).
fn shortest_distance(mesh: &Mesh, element: u32) -> f64 {
    let at = |node: &u32| mesh.positions()[*node as usize];
    let nodes = mesh.nodes_of(element);
    let pairs =
        (nodes.iter().enumerate()).flat_map(|(i, a)| nodes[..i].iter().map(move |b| (a, b)));
    pairs.fold(f64::INFINITY, |least, (a, b)| {
        least.min((at(a) - at(b)).norm())
    })
}

/// Length of an edge of an element (m).
fn length(mesh: &Mesh, element: u32, edge: &[u8; 2]) -> f64 {
    let nodes = mesh.nodes_of(element);
    let [first, second] = edge.map(|end| mesh.positions()[nodes[end as usize] as usize]);
    (second - first).norm()
}

/// The fibres of a model; none if it cannot have fibres.
pub(crate) fn fibres_of(model: &mut dyn EngineModel) -> Option<&mut dyn FibreModel> {
    model
        .frequencies()
        .and_then(|frequencies| frequencies.fibres())
}

/// Sets the fibres of a model, which must be none if it cannot have fibres.
pub(crate) fn set_fibres(model: &mut dyn EngineModel, fibres: &[Fibre]) -> Result<(), ModelError> {
    match (fibres_of(model), fibres) {
        (Some(own), _) => own.set_fibres(fibres),
        (None, []) => Ok(()),
        (None, _) => Err(ModelError::lacking("fibres")),
    }
}

impl FibreSite {
    /// Chooses fibres for a model, sets them and computes its stable step with an integration scheme.
    ///
    /// # Errors
    /// An unknown set, a factor out of range, a model that cannot have fibres, or an error of the stable step.
    pub(crate) fn choose(
        &self,
        options: &FibreOptions,
        model: &mut dyn EngineModel,
        integrator: &dyn TimeIntegrator,
    ) -> Result<FibreChoice, Error> {
        options.check(&self.mesh)?;
        let fibres = fibres_of(model).ok_or_else(|| {
            let reason = "the engine, ranks or a device compute without them";
            ModelError::refused("fibres", reason)
        })?;
        fibres.set_fibres(&[])?;
        let bounds = fibres.element_frequencies();
        let without = model.stable_step(integrator)?;
        let found = self.find(options, &bounds, without.assembled_limit);
        set_fibres(model, &found.fibres)?;
        let step = model.stable_step(integrator)?.step;
        let mut sizes = BTreeMap::new();
        for fibre in &found.fibres {
            *sizes.entry(fibre.nodes.len()).or_default() += 1;
        }
        let sets = found.parts.iter().map(|&part| self.parts[part].set.clone());
        let in_fibres: BTreeSet<u32> = (found.fibres.iter())
            .flat_map(|fibre| &fibre.nodes)
            .copied()
            .collect();
        let touches =
            |(_, nodes): &&(String, Vec<u32>)| nodes.iter().any(|n| in_fibres.contains(n));
        let joints = self.joints.iter().filter(touches);
        let joints = joints.map(|(name, _)| name.clone()).collect();
        let (mode, input) = (self.mode.as_ref(), self.input.as_ref());
        Ok(FibreChoice {
            shift: mode.and_then(|mode| mode.shift(&found.fibres, model, input)),
            factor: options.factor,
            sets: sets.collect(),
            joints,
            sizes,
            step_without: without.step,
            step,
            cut_edges: found.cut_edges,
            thick: found.thick,
            without: found.without,
            fibres: found.fibres,
        })
    }

    /// The fibres for a requested factor on the stability limit (s) of a model, from the frequency bounds of its elements.
    fn find(&self, options: &FibreOptions, bounds: &[FrequencyBound], limit: f64) -> Found {
        let highest = bounds
            .iter()
            .fold(0.0_f64, |most, bound| most.max(bound.frequency));
        // Of the element with the highest frequency the limit is that of the model.
        let permitted = |bound: &FrequencyBound| limit * highest / bound.frequency;
        let requested = options.factor * limit;
        let named = options.sets.as_ref().map(|sets| {
            let elements = sets
                .iter()
                .filter_map(|set| self.mesh.element_set(set).ok());
            elements.flatten().copied().collect::<BTreeSet<u32>>()
        });
        let mut found = Found::default();
        let mut short = Vec::new();
        for bound in bounds.iter().filter(|bound| permitted(bound) < requested) {
            let is_named = named
                .as_ref()
                .is_none_or(|named| named.contains(&bound.element));
            let added = (requested / permitted(bound)).powi(2) - 1.0;
            let before = short.len();
            if is_named {
                self.add_short_edges(bound.element, (added, requested), &mut short);
            }
            found.without += usize::from(short.len() == before);
        }
        let is_thin = |part: usize, extent: f64| {
            named.is_some() || extent < THIN * PER_WAVELENGTH * self.parts[part].longest
        };
        self.join(short, is_thin, &mut found);
        found
    }

    /// Adds the short edges of an element with the inertia that it needs, for a requested step (s).
    fn add_short_edges(
        &self,
        element: u32,
        (added, requested): (f64, f64),
        out: &mut Vec<ShortEdge>,
    ) {
        let Some(part) = self.part_of[element as usize] else {
            return;
        };
        let families = families(self.mesh.kind(element));
        let means = mean_lengths(&self.mesh, element);
        let shortest = means.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = means.iter().copied().fold(0.0, f64::max);
        let nodes = self.mesh.nodes_of(element);
        for (family, mean) in families.iter().zip(means) {
            if mean > ALIKE * shortest || mean >= SHORT * longest {
                continue;
            }
            for edge in family.iter() {
                let length = length(&self.mesh, element, edge);
                let mut nodes = edge.map(|end| self.stands_for[nodes[end as usize] as usize]);
                nodes.sort_unstable();
                if length < REACH * self.parts[part].p_speed * requested && nodes[0] != nodes[1] {
                    out.push(ShortEdge {
                        length,
                        nodes,
                        added,
                        part,
                    });
                }
            }
        }
    }

    /// Joins the nodes of short edges to fibres, from the shortest edge on.
    fn join(
        &self,
        mut short: Vec<ShortEdge>,
        is_thin: impl Fn(usize, f64) -> bool,
        found: &mut Found,
    ) {
        // Lengths that differ by rounding are equal.
        let class = |edge: &ShortEdge| (1e6 * edge.length.ln()).round() as i64;
        short.sort_by_key(|edge| (class(edge), edge.nodes));
        let mut sets = DisjointSets::new(self.stands_for.len());
        // Number of nodes of each set and constraint of some of them, by its representative.
        let mut sizes: BTreeMap<u32, (usize, Option<u32>)> = BTreeMap::new();
        let alone = |node: u32| (1, self.constraint_of[node as usize]);
        let (mut kept, mut cut) = (Vec::new(), BTreeSet::new());
        for edge in short {
            let [a, b] = edge.nodes.map(|node| sets.root(node));
            if a != b {
                let [first, second] = [a, b].map(|root| {
                    let known = sizes.get(&root).copied();
                    known.unwrap_or_else(|| alone(root))
                });
                let count = first.0 + second.0;
                let are_apart = first.1.is_some() && second.1.is_some() && first.1 != second.1;
                if count > MOST_NODES || are_apart {
                    // Elements share it.
                    cut.insert(edge.nodes);
                    continue;
                }
                sets.join(a, b);
                sizes.insert(sets.root(a), (count, first.1.or(second.1)));
            }
            kept.push(edge);
        }
        found.cut_edges = cut.len();
        let mut fibres: BTreeMap<u32, (BTreeSet<u32>, f64, BTreeSet<usize>)> = BTreeMap::new();
        for edge in kept {
            let (nodes, added, parts) = fibres.entry(sets.root(edge.nodes[0])).or_default();
            nodes.extend(edge.nodes);
            *added = added.max(edge.added);
            parts.insert(edge.part);
        }
        for (nodes, added, parts) in fibres.into_values() {
            let nodes: Vec<u32> = nodes.into_iter().collect();
            let extent = self.extent(&nodes);
            if !parts.iter().all(|&part| is_thin(part, extent)) {
                found.thick += 1;
                continue;
            }
            found.parts.extend(parts);
            found.fibres.push(Fibre { nodes, added });
        }
    }

    /// Largest distance of two of some nodes (m).
    fn extent(&self, nodes: &[u32]) -> f64 {
        let at = |node: &u32| self.mesh.positions()[*node as usize];
        let pairs = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a, b)));
        pairs.fold(0.0, |most: f64, (a, b)| most.max((at(a) - at(b)).norm()))
    }
}

#[cfg(test)]
mod tests {
    use powerhouse_material_damage::LinearElastic;
    use powerhouse_model::{ElasticMedium, Vec3};

    use super::*;
    use crate::Part;

    /// A plate of thin bricks in layers, with elements of one frequency (rad/s) but in its first column of bricks.
    fn plate(layers: usize) -> (FibreSite, Vec<FrequencyBound>) {
        let high = Vec3::new(4.0, 3.0, 0.1 * layers as f64);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [4, 3, layers], "plate").unwrap();
        let first = mesh.elements_in_box(&Vec3::zeros(), &Vec3::new(1.0, 3.0, high.z));
        mesh.set_element_set("first", first).unwrap();
        let count = mesh.element_count() as u32;
        let medium = ElasticMedium::new(30e9, 0.2, 2500.0).unwrap();
        let scene =
            Scene::new("plate", mesh).part(Part::new("plate", LinearElastic::new(medium).into()));
        let bounds = (0..count).map(|element| FrequencyBound::new(element, 6e4));
        (scene.fibre_site(&[], None).unwrap(), bounds.collect())
    }

    fn sizes(found: &Found) -> Vec<(usize, usize)> {
        let mut sizes = BTreeMap::new();
        for fibre in &found.fibres {
            *sizes.entry(fibre.nodes.len()).or_default() += 1;
        }
        sizes.into_iter().collect()
    }

    /// Each column of nodes through a plate is a fibre with the square of the requested step less one, in a named set
    /// those of its elements alone; elements that permit the requested step need none.
    #[test]
    fn nodes_through_the_thickness_are_a_fibre() {
        for layers in [1, 2, 4] {
            let (site, mut bounds) = plate(layers);
            let limit = 2.0 / 6e4;
            for (factor, added) in [(1.5, 1.25), (2.0, 3.0), (3.0, 8.0)] {
                let found = site.find(&FibreOptions::new(factor), &bounds, limit);
                assert_eq!(sizes(&found), [(layers + 1, 20)]);
                let is_as_requested = |fibre: &Fibre| (fibre.added - added).abs() < 1e-12;
                assert!(found.fibres.iter().all(is_as_requested));
                let named = FibreOptions::new(factor).in_sets(["first"]);
                let found = site.find(&named, &bounds, limit);
                assert_eq!(sizes(&found), [(layers + 1, 8)]);
                assert_eq!(found.without, 9 * layers);
            }
            bounds
                .iter_mut()
                .skip(1)
                .for_each(|bound| bound.frequency = 2e4);
            let found = site.find(&FibreOptions::new(2.0), &bounds, limit);
            assert_eq!(sizes(&found), [(2, 4)]);
        }
    }

    /// A fibre has nodes of joints that are solved together alone, 18 nodes at most, and counts nodes that move as one
    /// once; in sets that are not named it is not longer than twice the longest edge.
    #[test]
    fn fibres_are_cut_where_joints_or_their_number_of_nodes_demand_it() {
        let (mut site, bounds) = plate(4);
        let (options, limit) = (FibreOptions::new(2.0), 2.0 / 6e4);
        let of_height = |site: &FibreSite, height: f64| -> Vec<usize> {
            let nodes = site.mesh.positions().iter().enumerate();
            let at = nodes.filter(|(_, x)| (x.z - height).abs() < 1e-9);
            at.map(|(node, _)| node).collect()
        };
        for (top, expected, cut) in [(7, [(5, 20)], 0), (8, [(4, 20)], 20)] {
            for (height, joint) in [(0.0, 7), (0.4, top)] {
                for node in of_height(&site, height) {
                    site.constraint_of[node] = Some(joint);
                }
            }
            let found = site.find(&options, &bounds, limit);
            assert_eq!((&sizes(&found)[..], found.cut_edges), (&expected[..], cut));
        }
        let jointed = |fibre: &Fibre| {
            let own = fibre
                .nodes
                .iter()
                .filter_map(|&node| site.constraint_of[node as usize]);
            own.collect::<BTreeSet<u32>>().len()
        };
        let found = site.find(&options, &bounds, limit);
        assert!(found.fibres.iter().all(|fibre| jointed(fibre) == 1));
        // The faces at the ends of the plate move as one.
        let (mut site, bounds) = plate(4);
        let positions = site.mesh.positions().to_vec();
        for node in 0..positions.len() {
            let (x, first) = (positions[node], Vec3::new(0.0, 3.0, 0.0));
            let partner = positions
                .iter()
                .position(|other| (other + first - x).norm() < 1e-9);
            site.stands_for[node] = partner.unwrap_or(node) as u32;
        }
        assert_eq!(sizes(&site.find(&options, &bounds, limit)), [(5, 15)]);
        let (site, bounds) = plate(20);
        let found = site.find(&options, &bounds, limit);
        assert_eq!(
            (sizes(&found), found.cut_edges),
            (vec![(3, 20), (18, 20)], 20)
        );
        let (mut site, bounds) = plate(15);
        site.parts[0].longest = 0.7;
        let found = site.find(&options, &bounds, limit);
        assert_eq!((sizes(&found), found.thick), (vec![], 20));
        let named = options.in_sets(["plate"]);
        assert_eq!(sizes(&site.find(&named, &bounds, limit)), [(16, 20)]);
    }
}
