//! Kernels and laws, one by one.

use powerhouse::engine::Explicit;
use powerhouse_elements::{
    Hex8BBar, Hex8Eas, Hex8Full, Hex8Natural, Hex8OnePoint, Pyramid5, SolidKernel, Tet4, Tet10,
    Wedge6,
};
use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, HoekBrownParameters,
    LeeFenves, LinearElastic, Mazars, MohrCoulomb, MohrCoulombParameters, SofteningPlasticity,
    SofteningPlasticityParameters, StrengthFall, TwoSurface, media, presets,
};
use powerhouse_model::{
    BlockOptions, ConstitutiveLaw, ElementKernel, LaneWidth, Mesh, ModelSpec, Rayleigh, Support,
    Vec3,
};

use super::naive::Naive;
use super::plain::Plain;
use super::{Case, LIMIT, SET, boxed, face};

/// Several blocks on two threads, fixed at the bottom.
fn on_its_bottom<'a>(mesh: &'a Mesh) -> impl Fn(ModelSpec<'a>) -> ModelSpec<'a> {
    let bottom = face(mesh, "bottom");
    move |spec| {
        let spec = spec.support(Support::fixed(bottom.clone()));
        spec.block_size(48).threads(2)
    }
}

/// Elastic elements of a kernel with Rayleigh damping, straight and bent, in lanes and one by one.
fn kernel<K, const N: usize, const P: usize>(of_engine: SolidKernel, kernel: K)
where
    K: ElementKernel<N, P>,
{
    let make = match N {
        8 => Mesh::box_of_hexes,
        6 => Mesh::box_of_wedges,
        5 => Mesh::box_of_pyramids,
        _ => Mesh::box_of_tets,
    };
    let boxed = |bend: f64| match N {
        10 => boxed(make, bend).with_midpoints().unwrap(),
        _ => boxed(make, bend),
    };
    let damping = Rayleigh {
        mass: 3.0,
        stiffness: 1e-5,
    };
    for (bend, lanes) in [
        (0.0, LaneWidth::Native),
        (0.05, LaneWidth::Native),
        (0.05, LaneWidth::One),
    ] {
        let mesh = boxed(bend);
        let law = LinearElastic::new(media::ROCK);
        let mut options = BlockOptions::default();
        (options.damping, options.lanes) = (damping, lanes);
        let solid = of_engine.factory(SET, law, options);
        let plain = Plain {
            set: SET,
            kernel: kernel.clone(),
            law,
            damping,
        };
        let case = Case {
            name: format!("{} bent by {bend}, {lanes:?}", kernel.name()),
            mesh: &mesh,
            speed: 0.5,
            conditions: &on_its_bottom(&mesh),
        };
        case.check(solid, plain.boxed());
    }
}

/// A body of every kernel moves as that of the plain kernel, straight and bent.
#[test]
fn kernels_move_alike() {
    let one_point = Hex8OnePoint::default();
    kernel(SolidKernel::Hex8OnePoint(one_point), one_point);
    kernel(SolidKernel::Hex8Natural, Hex8Natural);
    kernel(SolidKernel::Hex8Eas, Hex8Eas::new(&media::ROCK));
    kernel(SolidKernel::Hex8Full, Hex8Full);
    kernel(SolidKernel::Hex8BBar, Hex8BBar);
    kernel(SolidKernel::Tet4, Tet4);
    kernel(SolidKernel::Wedge6, Wedge6);
    kernel(SolidKernel::Pyramid5, Pyramid5);
    kernel(SolidKernel::Tet10, Tet10::new(&media::ROCK));
}

/// Fails if a body of a law moves differently, or as if it were elastic.
///
/// Yielding, and still more softening, enlarge any difference: permitted is the growth of a difference of
/// [`LIMIT`] in the initial velocities, where that is more.
fn law<M: ConstitutiveLaw>(law: M) {
    let mesh = boxed(Mesh::box_of_hexes, 0.05);
    let case = Case {
        name: law.name().into(),
        mesh: &mesh,
        speed: 0.5,
        conditions: &on_its_bottom(&mesh),
    };
    let plain = || {
        let plain = Plain {
            set: SET,
            kernel: Hex8Full,
            law: law.clone(),
            damping: Rayleigh::default(),
        };
        plain.boxed()
    };
    let options = BlockOptions::default();
    let elastic = SolidKernel::Hex8Full.factory(SET, LinearElastic::new(law.medium()), options);
    let (elastic, step) = case.run(&Explicit, elastic, None);
    let (undisturbed, _) = case.run(&Naive, plain(), Some(step));
    let mut velocity = case.velocity();
    for velocity in velocity.iter_mut().step_by(2) {
        *velocity *= 1.0 + LIMIT;
    }
    let (disturbed, _) = case.run_from(&velocity, &Naive, plain(), Some(step));
    let permitted = undisturbed
        .differences(&disturbed)
        .map(|enlarged| enlarged.max(LIMIT));
    let solid = SolidKernel::Hex8Full.factory(SET, law.clone(), options);
    let found = case.check_within(solid, plain(), permitted);
    let apart = elastic.differences(&found)[0];
    assert!(apart > 1e-3, "{} stays elastic", case.name);
}

/// Bodies of yielding rock move as with the law evaluated point by point.
#[test]
fn yielding_laws_move_alike() {
    let rock = presets::PAPER_ROCK;
    let MohrCoulombParameters {
        medium,
        friction,
        cohesion,
        ..
    } = rock;
    law(ElastoPlastic::new(MohrCoulomb::new(rock).unwrap()));
    let cone = DruckerPrager::new(DruckerPragerParameters {
        medium,
        friction,
        dilation: 10.0,
        cohesion,
        fit: ConeFit::Inscribed,
    });
    law(ElastoPlastic::new(cone.unwrap()));
    law(ElastoPlastic::new(
        TwoSurface::new(presets::PAPER_ROCK_LISTED).unwrap(),
    ));
    let mass = HoekBrown::new(HoekBrownParameters {
        medium,
        intact_strength: 5.0e7,
        intact_constant: 10.0,
        strength_index: 40.0,
        disturbance: 0.0,
        dilation_share: 0.3,
    });
    law(ElastoPlastic::new(mass.unwrap()));
}

/// Bodies of softening rock and cracking concrete move as with the law evaluated point by point.
#[test]
fn damaging_laws_move_alike() {
    law(presets::paper_concrete().unwrap());
    law(Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap());
    law(LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap());
    let softening = SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: MohrCoulomb::new(presets::PAPER_ROCK).unwrap(),
        fall: StrengthFall::FractureEnergy { energy: 2.0e4 },
        residual_strength: 0.1,
    });
    law(softening.unwrap());
}

/// Supports along oblique normals, two at a node, hold as they do one by one.
#[test]
fn oblique_supports_hold_alike() {
    let mesh = boxed(Mesh::box_of_hexes, 0.05);
    let (bottom, left) = (face(&mesh, "bottom"), face(&mesh, "left"));
    let case = Case {
        name: "oblique supports".into(),
        mesh: &mesh,
        speed: 0.5,
        conditions: &|spec| {
            spec.support(Support::roller(bottom.clone(), Vec3::new(0.2, -0.3, 1.0)))
                .support(Support::roller(left.clone(), Vec3::new(2.0, 0.5, 0.1)))
        },
    };
    case.check_elastic();
}
