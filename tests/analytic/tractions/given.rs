//! A given stress in equilibrium: the tractions are its own, whatever holds the body.

use nalgebra::Rotation3;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{Mat3, State, StaticMethod, Stress, Vec3};

use super::{Body, Cut, Held, Law, Random, at_rest, difference, settled, spec, tractions};

const KERNELS: [SolidKernel; 3] = [
    SolidKernel::ONE_POINT,
    SolidKernel::Hex8Full,
    SolidKernel::Hex8Natural,
];
const METHODS: [StaticMethod; 2] = [
    StaticMethod::ConjugateGradients,
    StaticMethod::DynamicRelaxation,
];

/// State with an initial stress that depends on the place of an element.
fn stressed(body: &Body, stress: impl Fn(&Vec3) -> Stress) -> State {
    let mut state = State::default();
    state.displacement = vec![Vec3::zeros(); body.mesh.node_count()];
    state.velocity = state.displacement.clone();
    let elements = 0..body.mesh.element_count() as u32;
    state.initial_stress = elements
        .map(|element| stress(&body.mesh.centroid(element)))
        .collect();
    state
}

/// The tractions of every pair are those of a uniform stress, `sigma n`, to 1e-9 of the greatest one: with joints through
/// faces, around blocks and prisms and at edges, turned anyhow, with faces that are fixed, moved, or on rollers where the
/// stress has no shear, by both static methods and every law; and they stay so at rest with the supports or without them.
#[test]
fn tractions_of_a_uniform_stress() {
    let mut random = Random::new(1);
    for round in 0..54 {
        let cut = Cut::ALL[round % Cut::ALL.len()];
        let brick = Vec3::from_fn(|_, _| random.between(0.6, 1.7));
        let body = Body::new(cut, [3, 2, 3], brick, &random.vector(1.5));
        let held = random.of(&[Held::Fixed, Held::Prescribed, Held::Rollers]);
        let (kernel, law, method) = (
            random.of(&KERNELS),
            random.of(&Law::ALL),
            METHODS[round / 9 % 2],
        );
        let principal = Vec3::from_fn(|_, _| random.between(-2.0e6, -0.3e6));
        // Rollers admit no shear along the faces.
        let turn = if held == Held::Rollers {
            Vec3::zeros()
        } else {
            random.vector(1.0)
        };
        let own = Mat3::from_columns(&body.axes) * Rotation3::new(turn).into_inner();
        let matrix = own * Mat3::from_diagonal(&principal) * own.transpose();
        let stress = Stress::from_matrix(&matrix);
        let pairs = body.surface.pairs.iter();
        let expected: Vec<Vec3> = pairs.map(|pair| stress.traction(&pair.normal)).collect();
        let what = format!("{round}: {cut:?} {held:?} {kernel:?} {law:?} {method:?}");
        let built = |held: Held| held.on(&body, spec(&body, kernel, [media::ROCK; 2], law));
        let stage = built(held).start(stressed(&body, |_| stress));
        let state = settled(&body, stage, method, 1.0e-10);
        let error = difference(&tractions(&body, &state), &expected);
        assert!(error < 1.0e-9, "{what}: {error:e}");
        // Twice: what a stage leaves is what the next one finds.
        let again = settled(&body, built(held).start(state), method, 1.0e-10);
        for later in [held, Held::Absorbing, Held::Slice] {
            let error = difference(&at_rest(&body, built(later), &again, 40), &expected);
            assert!(error < 1.0e-9, "{what}, then {later:?}: {error:e}");
        }
    }
}

/// Mean places of the facets at each pair.
fn middles(body: &Body) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::zeros(), 0.0); body.surface.pairs.len()];
    for facet in &body.surface.facets {
        let nodes = facet.nodes.iter();
        let middle = nodes
            .map(|&node| body.mesh.positions()[node as usize])
            .sum::<Vec3>();
        for pair in facet.pairs.iter().flatten() {
            let (sum, count) = &mut sums[*pair as usize];
            *sum += middle / facet.nodes.len() as f64;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// In ground with a lateral pressure of 0.3 to 2 times the vertical one, which grows with depth, every pair of a joint that
/// dips into faces on rollers, or goes around a block or an octagon, has the mean traction of that stress over its facets, to
/// 1e-9 of the greatest one. Where bricks are sheared by 60 degrees and more or have other angles, the stress of their middles is
/// in equilibrium only as far as the mesh is fine: to 2 % on a coarse mesh, to 0.6 of that on one of half the size.
#[test]
fn tractions_of_geostatic_stress() {
    let (level, weight) = (16.0, media::ROCK.density * 9.81);
    for (round, cut) in Cut::ALL.into_iter().enumerate() {
        for (lateral, method) in [
            (0.3, METHODS[0]),
            (0.8, METHODS[1]),
            (2.0, METHODS[round % 2]),
        ] {
            let error = |size: f64| {
                // Joints through the box have twice as many bricks of half the size, the others bodies of half the size.
                let half = match cut {
                    Cut::Plane { .. } => [3.0, 1.0, 3.0].map(|count| (count / size) as usize),
                    _ => [4, 2, 4],
                };
                let body = Body::new(cut, half, Vec3::repeat(size), &(Vec3::z() * round as f64));
                let axes = Mat3::from_columns(&body.axes);
                let of = |at: &Vec3| {
                    let own = Vec3::new(lateral, 0.8, 1.0) * (weight * (at.z - level));
                    Stress::from_matrix(&(axes * Mat3::from_diagonal(&own) * axes.transpose()))
                };
                let kernel = SolidKernel::Hex8Natural;
                let spec = spec(&body, kernel, [media::ROCK; 2], Law::Friction)
                    .gravity(Vec3::z() * -9.81, Box::new(|_: f64| 1.0))
                    .start(stressed(&body, of));
                let state = settled(&body, Held::Rollers.on(&body, spec), method, 1.0e-8);
                let pairs = body.surface.pairs.iter().zip(middles(&body));
                let expected: Vec<Vec3> = pairs
                    .map(|(pair, middle)| of(&middle).traction(&pair.normal))
                    .collect();
                difference(&tractions(&body, &state), &expected)
            };
            let errors = [error(1.0), error(0.5)];
            println!("{cut:?} {lateral} {method:?}: {errors:?}");
            let is_distorted = match cut {
                Cut::Plane { dip } => dip > 45.0,
                other => other == Cut::Octagon,
            };
            let limits = if is_distorted {
                [0.02, 0.6 * errors[0]]
            } else {
                [1.0e-9; 2]
            };
            let holds = errors
                .iter()
                .zip(limits)
                .all(|(error, limit)| *error < limit);
            assert!(holds, "{cut:?} {lateral}: {errors:?}");
        }
    }
}
