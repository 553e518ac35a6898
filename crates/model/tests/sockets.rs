//! What blocks, constraints and kernels without additional capabilities do.

use powerhouse_model::{
    BlockContext, BlockEnergy, BlockStiffness, Constraint, ConstraintParts, ConstraintWork,
    ElementBlock, ElementFault, ElementKernel, ElementKind, FrequencyBound, Geometry, Hourglass,
    KernelArithmetic, Lane, Mat3, NodalView, NodalViewMut, Operator, PredictedMotion, ProgramError,
    Quad, Rayleigh, RunError, StepTime, Strain, Stress, Vec3,
};

/// A chain of springs (N/m) between successive nodes, each with its own stiffness in every direction; without springs
/// it has no capability.
struct Chain {
    nodes: Vec<u32>,
    springs: Vec<Mat3>,
}

impl ElementBlock for Chain {
    fn label(&self) -> &str {
        "chain"
    }
    fn elements(&self) -> &[u32] {
        &[]
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, _context: &BlockContext, _out: NodalViewMut) -> Result<(), ElementFault> {
        Ok(())
    }
    fn add_mass(&self, _out: &mut [f64]) {}
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        (!self.springs.is_empty()).then_some(self as &dyn BlockStiffness)
    }
}

impl BlockStiffness for Chain {
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut forces = vec![Vec3::zeros(); self.nodes.len()];
        for (first, spring) in self.springs.iter().enumerate() {
            let force = spring * (x.vector(first + 1) - x.vector(first));
            forces[first] -= force;
            forces[first + 1] += force;
        }
        if let NodalViewMut::F64(out) = out {
            for (out, force) in out.iter_mut().zip(&forces) {
                *out = Quad::from_vector(force);
            }
        }
    }
}

/// A block without capabilities has no damping, stiffness, energy, history and state, and its program is refused by its name.
#[test]
fn a_bare_block_has_nothing_but_forces() {
    let mut chain = Chain {
        nodes: vec![3, 8],
        springs: Vec::new(),
    };
    let block: &mut dyn ElementBlock = &mut chain;
    let moved = [Quad::new(1.0, -2.0, 0.5), Quad::new(0.0, 4.0, 3.0)];
    let mut out = [Quad::new(7.0, 7.0, 7.0); 2];
    let view = NodalView::F64(&moved);
    block.apply(Operator::Static, view, NodalViewMut::F64(&mut out));
    assert_eq!(out.map(|force| force.to_vector()), [Vec3::zeros(); 2]);
    let mut diagonal = [Mat3::identity(); 2];
    block.diagonal(Operator::Elastic, &mut diagonal);
    assert_eq!(diagonal, [Mat3::identity(); 2]);
    block.each_matrix(Operator::Elastic, &mut |_, _| panic!("it has no matrix"));
    assert_eq!(block.damping(), Rayleigh::default());
    assert!(!block.reads_velocity(0.3, true));
    let when = StepTime {
        number: 4,
        time: 0.2,
        step: 0.1,
    };
    let context = BlockContext::new(when, view, view).with_ledger(true);
    assert_eq!(block.energy(&context), BlockEnergy::default());
    block.commit();
    assert!(block.history().is_empty() && block.shown_history(0, "damage").is_none());
    assert!(block.saved().is_none() && block.saved_mut().is_none());
    let refused = block.program(0.1, 1).unwrap_err();
    assert_eq!(
        refused,
        ProgramError::None {
            name: "chain".into()
        }
    );
}

/// The matrix and the nodal diagonal blocks of a block follow from its product alone.
#[test]
fn diagonals_follow_from_products() {
    let springs = [
        Mat3::new(4.0, 1.0, 0.0, 1.0, 3.0, -0.5, 0.0, -0.5, 2.0),
        Mat3::new(7.0, 0.0, 2.0, 0.0, 5.0, 0.25, 2.0, 0.25, 9.0),
    ];
    let chain = Chain {
        nodes: vec![11, 2, 5],
        springs: springs.to_vec(),
    };
    let block: &dyn ElementBlock = &chain;
    let mut diagonal = [Mat3::zeros(); 3];
    block.diagonal(Operator::Elastic, &mut diagonal);
    assert_eq!(diagonal, [springs[0], springs[0] + springs[1], springs[1]]);
    let mut calls = 0;
    block.each_matrix(Operator::Elastic, &mut |nodes, matrix| {
        calls += 1;
        assert_eq!((nodes, matrix.len()), (&[0, 1, 2][..], 81));
        // Force at the second node under a displacement of the third along z.
        let column: Vec<f64> = (3..6).map(|row| matrix[9 * row + 8]).collect();
        assert_eq!(column, [-2.0, -0.25, -9.0]);
    });
    assert_eq!(calls, 1);
}

/// A constraint that says nothing of parts is one part, which cannot be restricted; it has no joints and no state.
#[test]
fn a_bare_constraint_is_one_part() {
    struct Held([u32; 3]);
    impl Constraint for Held {
        fn name(&self) -> &str {
            "held"
        }
        fn nodes(&self) -> &[u32] {
            &self.0
        }
        fn correct(&mut self, _motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
            Ok(ConstraintWork::default())
        }
    }
    let mut held = Held([9, 4, 6]);
    let parts = ConstraintParts::of(&held);
    assert_eq!(parts.iter().collect::<Vec<_>>(), [&[9, 4, 6][..]]);
    let constraint: &mut dyn Constraint = &mut held;
    assert!(constraint.restricted().is_none() && constraint.coupled().is_none());
    assert!(constraint.jointed().is_none() && constraint.jointed_mut().is_none());
    assert!(constraint.saved().is_none() && constraint.saved_mut().is_none());
    assert!(constraint.ties().is_empty());
}

/// A kernel without modes computes with nodal values; it has no hourglass forces and no history variables.
#[test]
fn a_bare_kernel_computes_with_nodal_values() {
    #[derive(Clone)]
    struct Bar;
    impl ElementKernel<2, 1> for Bar {
        fn name(&self) -> &'static str {
            "bar"
        }
        fn kind(&self) -> ElementKind {
            ElementKind::Bar2
        }
        fn geometry_len(&self) -> usize {
            1
        }
        fn geometry(&self, corners: &[Vec3; 2], out: &mut [f64]) {
            out[0] = corners[1].x - corners[0].x;
        }
        fn point_positions(&self, corners: &[Vec3; 2]) -> [Vec3; 1] {
            [(corners[0] + corners[1]) / 2.0]
        }
        fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
            [geometry.get(0)]
        }
        fn node_shares(&self, _corners: &[Vec3; 2]) -> [f64; 2] {
            [0.5, 0.5]
        }
        fn strains<L: Lane>(&self, geometry: Geometry<L>, _modes: &[[L; 3]; 2]) -> [Strain<L>; 1] {
            [Strain([geometry.constant(0.0); 6])]
        }
        fn forces<L: Lane>(
            &self,
            geometry: Geometry<L>,
            _stresses: &[Stress<L>; 1],
            _hourglass: &Hourglass<L>,
            _modes: &[[L; 3]; 2],
        ) -> [[L; 3]; 2] {
            [[geometry.constant(0.0); 3]; 2]
        }
    }
    let nodal = [[1.0, 2.0, 3.0], [-4.0, 5.0, 0.5]];
    let numbers = [2.0];
    let geometry = || Geometry::new((), &numbers);
    assert_eq!(Bar.modes(&nodal), nodal);
    assert_eq!(Bar.nodal_forces(&nodal), nodal);
    assert_eq!(Bar.elastic_forces(geometry(), [1e9, 2e9], &nodal), None);
    let hourglass = Hourglass::new([3.0; 3]);
    let energy = Bar.hourglass_energy(geometry(), &hourglass, &nodal);
    assert!(energy.is_none() && !Bar.hourglass_is_bending());
    assert_eq!((Bar.own_history(), Bar.own_strains()), (0, 0));
    let mut strains = [Strain([0.25; 6])];
    Bar.add_own_strains(geometry(), &[], &mut strains);
    assert_eq!(strains[0].0, [0.25; 6]);
}
