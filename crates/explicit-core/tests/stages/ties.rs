//! What constraints hold together.

use powerhouse_explicit_core::{BuildModel, Leapfrog, run};
use powerhouse_model::{
    Constraint, ConstraintWork, Mesh, ModelSpec, PredictedMotion, RunError, RunOptions, State,
    StaticError, StaticOptions, Support, Vec3,
};

use super::{GRAVITY, bent_box, elastic_body, face_nodes, largest};

/// Gives the nodes of each pair one velocity.
pub(super) struct Weld {
    nodes: Vec<u32>,
    reported: bool,
}

impl Weld {
    /// Of nodes that follow each other pair by pair.
    pub(super) fn new(nodes: Vec<u32>) -> Self {
        Self {
            nodes,
            reported: true,
        }
    }
}

impl Constraint for Weld {
    fn name(&self) -> &str {
        "weld"
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn ties(&self) -> Vec<[u32; 2]> {
        let pairs = self.nodes.chunks_exact(2).filter(|_| self.reported);
        pairs.map(|pair| [pair[0], pair[1]]).collect()
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        for pair in 0..self.nodes.len() / 2 {
            let [a, b] = [2 * pair, 2 * pair + 1];
            let masses = [a, b].map(|place| 1.0 / motion.inverse_mass[place][(0, 0)]);
            let momentum = motion.velocity[a] * masses[0] + motion.velocity[b] * masses[1];
            let common = momentum / (masses[0] + masses[1]);
            motion.velocity[a] = common;
            motion.velocity[b] = common;
        }
        Ok(ConstraintWork::default())
    }
}

/// A mesh cut through at a height (m), and the nodes that face each other there, pair by pair.
pub(super) fn cut_through(whole: &Mesh, height: f64) -> (Mesh, Vec<u32>) {
    let (low, mut high) = whole.bounding_box();
    high.z = height;
    let lower = whole.elements_in_box(&low, &high);
    let upper: Vec<u32> = (0..whole.element_count() as u32)
        .filter(|element| !lower.contains(element))
        .collect();
    let split = whole.split_between(&lower, &upper).unwrap();
    let cut = split.mesh;
    // Copies follow all nodes and lie where the originals do.
    let copies = whole.node_count() as u32..cut.node_count() as u32;
    let pairs = copies.flat_map(|copy| {
        let place = cut.positions()[copy as usize];
        let original =
            (0..whole.node_count() as u32).find(|&node| cut.positions()[node as usize] == place);
        [original.unwrap(), copy]
    });
    let pairs = pairs.collect();
    (cut, pairs)
}

/// Two bodies that a constraint ties reach the same equilibrium as the one that they were cut from, to 1e-8, and
/// stand still when they are handed over: the tie bears what the ground does not. A constraint that
/// says nothing of what it holds is refused.
#[test]
fn tied_bodies_rest_as_one() {
    let size = Vec3::new(8.0, 6.0, 9.0);
    let whole = bent_box(size, [4, 3, 6], 0.3);
    let (cut, nodes) = cut_through(&whole, 4.5);
    let cut = &cut;
    assert_eq!(nodes.len(), 2 * 5 * 4);
    fn supported<'a>(mesh: &Mesh, builder: ModelSpec<'a>) -> ModelSpec<'a> {
        builder
            .support(Support::fixed(face_nodes(mesh, "bottom")))
            .gravity(GRAVITY + Vec3::x(), Box::new(|_: f64| 1.0))
    }
    let options = StaticOptions::default().with_tolerance(1.0e-11);
    let mut one = supported(&whole, elastic_body(&whole)).build().unwrap();
    one.equilibrate(&options, &mut |_| {}).unwrap();
    let weld = |reported| {
        let weld = Weld::new(nodes.clone());
        Box::new(Weld { reported, ..weld })
    };
    let welded = |reported| supported(cut, elastic_body(cut)).constraint(weld(reported));
    let mut two = welded(true).build().unwrap();
    two.equilibrate(&options, &mut |_| {}).unwrap();
    let deepest = largest((0..whole.node_count() as u32).map(|n| one.displacement(n)));
    for node in 0..whole.node_count() as u32 {
        let error = (two.displacement(node) - one.displacement(node)).norm();
        assert!(error < 1.0e-8 * deepest, "{error} {deepest}");
    }
    for pair in nodes.chunks_exact(2) {
        assert_eq!(two.displacement(pair[0]), two.displacement(pair[1]));
    }

    let state: State = two.state().next_stage(cut.node_count());
    let mut moving = welded(true).start(state.clone()).build().unwrap();
    moving.hand_over(1.0e-9).unwrap();
    run(
        &mut moving,
        &Leapfrog,
        &RunOptions::steps(2000),
        &mut [],
        &mut |_| {},
    )
    .unwrap();
    let all = || 0..cut.node_count() as u32;
    let moved = largest(all().map(|n| moving.displacement(n) - state.displacement[n as usize]));
    let speed = largest(all().map(|n| moving.velocity(n)));
    assert!(moved < 1.0e-10 && speed < 1.0e-10, "{moved} {speed}");

    let silent = welded(false)
        .build()
        .unwrap()
        .equilibrate(&options, &mut |_| {});
    assert!(matches!(silent, Err(StaticError::Constraint { name }) if name == "weld"));
}
