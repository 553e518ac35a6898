//! Invariance of results under lane width, common shape and common motion.

use super::*;

/// Everything that a block computes has the same bits in lanes of one and of many, for every
/// kernel and precision, damped, with and without history variables, with inactive elements; in one lane there
/// are more elements than a law is evaluated for in one call.
#[test]
fn lane_width_leaves_no_trace() {
    fn bits<M: ConstitutiveLaw>(
        kernel: SolidKernel,
        law: M,
        precision: Precision,
        lanes: LaneWidth,
    ) -> Vec<u64> {
        let mesh = distorted(kernel.kind(), [4, 3, 3]);
        let mut fixture = Fixture::of(mesh, kernel, law, options(precision, lanes, 2e-4));
        let (u, v) = (fixture.noise(1, 1e-3), fixture.noise(2, 1e-1));
        let single = |values: &[Quad<f64>]| -> Vec<Quad<f32>> {
            let round = |q: &Quad<f64>| Quad::from_vector(&q.to_vector());
            values.iter().map(round).collect()
        };
        let (u32s, v32s) = (single(&u), single(&v));
        let views = match precision {
            Precision::F32 => (NodalView::F32(&u32s), NodalView::F32(&v32s)),
            _ => (NodalView::F64(&u), NodalView::F64(&v)),
        };
        let count = fixture.block.elements().len();
        let stresses: Vec<Stress> = (0..count)
            .map(|e| Stress([e as f64 * 1e4, -2e6, 0.0, 1e5, 0.0, 3e5]))
            .collect();
        fixture.block.set_initial_stress(&stresses);
        let active: Vec<bool> = (0..count).map(|e| e % 5 != 3).collect();
        fixture.block.stateful_mut().unwrap().set_active(&active);
        let mut numbers = Vec::new();
        for step in 0..3 {
            let context = BlockContext::new(when(step, 1e-4), views.0, views.1).with_ledger(true);
            for force in fixture.forces_at(&context).unwrap() {
                numbers.extend(force.iter());
            }
            let energy = fixture.block.energy(&context);
            numbers.extend([energy.elastic, energy.hourglass, energy.damping]);
            numbers.extend([energy.plastic, energy.bending, energy.damage]);
            fixture.block.commit();
            fixture.block.set_reference_displacement(views.1);
            let mut mean = vec![Stress::default(); count];
            fixture.block.add_stress(views.0, &mut mean);
            numbers.extend(mean.iter().flat_map(|stress| stress.0));
        }
        for field in fixture.block.history() {
            numbers.extend(field.values);
        }
        let bounds = fixture.block.frequency_bounds();
        numbers.extend(bounds.iter().map(|bound| bound.frequency));
        assert!(numbers.iter().all(|number| number.is_finite()));
        numbers.iter().map(|number| number.to_bits()).collect()
    }
    for kernel in SolidKernel::ALL {
        for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
            let of = |lanes| bits(kernel, Linear(rock()), precision, lanes);
            assert_eq!(of(LaneWidth::One), of(LaneWidth::Native), "{kernel:?}");
            let of = |lanes| bits(kernel, Softening(rock()), precision, lanes);
            assert_eq!(of(LaneWidth::One), of(LaneWidth::Native), "{kernel:?}");
            let of = |lanes| bits(kernel, Yielding(rock(), 5e-5), precision, lanes);
            assert_eq!(of(LaneWidth::One), of(LaneWidth::Native), "{kernel:?}");
        }
    }
}

/// Where all elements are alike, or all straight, a block computes what it computes in a mesh where
/// one element of another shape keeps it from noticing.
#[test]
fn equal_shapes_leave_no_trace() {
    for kernel in SolidKernel::ALL {
        let (low, high) = (Vec3::new(20.0, -3.0, 7.0), Vec3::new(20.3, -2.6, 7.9));
        let kind = kernel.kind();
        let regular = generator(kind)(low, high, [3, 3, 3], "rock").unwrap();
        let moved = regular.clone().map_positions(|x| {
            let corner = (x - high).norm() < 1e-9;
            if corner { x + Vec3::repeat(0.05) } else { x }
        });
        let (regular, moved) = (of_kind(kind, regular), of_kind(kind, moved.unwrap()));
        let count = regular.node_count();
        let of = |mesh: Mesh| {
            let mut fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
            let u = fixture.noise(6, 1e-3);
            let rest = zeros(u.len());
            let mut masses = fixture.masses();
            let mut bounds: Vec<f64> = fixture
                .block
                .frequency_bounds()
                .iter()
                .map(|bound| bound.frequency)
                .collect();
            // Only the last cell has another shape.
            let elements = fixture.mesh.element_count() as u32;
            let touched: Vec<u32> = (elements - elements / 27..elements)
                .flat_map(|element| fixture.mesh.nodes_of(element).to_vec())
                .collect();
            let mut forces = fixture.forces(&u, &rest);
            for node in touched {
                let place = fixture.place(node);
                forces[place] = Vec3::zeros();
                masses[place] = 0.0;
            }
            bounds.truncate(bounds.len() - bounds.len() / 27);
            (forces, masses, bounds)
        };
        let (regular, moved) = (of(regular), of(moved));
        let scale = largest(&regular.0);
        for place in 0..count {
            assert!((regular.0[place] - moved.0[place]).norm() < 1e-12 * scale);
            assert!((regular.1[place] - moved.1[place]).abs() < 1e-10 * 2750.0 * 1e-3);
        }
        for (a, b) in regular.2.iter().zip(&moved.2) {
            assert!((a - b).abs() < 1e-8 * a, "{} {a} {b}", kernel.name());
        }
    }
}

/// Single precision on differences loses nothing to a large common displacement; forces agree with
/// double precision to the rounding of single.
#[test]
fn mixed_precision_sees_only_differences() {
    for kernel in SolidKernel::ALL {
        let of = |precision| {
            let options = options(precision, LaneWidth::Native, 0.0);
            let mut fixture = Fixture::new(kernel, Linear(rock()), options);
            let mut noise = Noise(11);
            let u = fixture.field(|_| noise.vector() * 1e-6 + Vec3::new(40.0, -30.0, 20.0));
            fixture.forces(&u, &zeros(u.len()))
        };
        let (exact, mixed) = (of(Precision::F64), of(Precision::Mixed));
        let error = exact.iter().zip(&mixed).map(|(a, b)| (a - b).norm());
        let error = error.fold(0.0, f64::max) / largest(&exact);
        assert!(error < 2e-6, "{} {error}", kernel.name());
    }
}
