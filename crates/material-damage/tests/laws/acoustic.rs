//! Growth of short waves in a material that flows.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, LinearElastic, MohrCoulomb,
    MohrCoulombParameters, PlasticDamage, growth_of_flow, presets,
};
use powerhouse_model::ElasticMedium;

const MEDIUM: ElasticMedium = ElasticMedium {
    young: 25e9,
    poisson: 0.17,
    density: 2500.0,
};

fn mohr_coulomb(friction: f64, dilation: f64) -> MohrCoulombParameters {
    MohrCoulombParameters {
        medium: MEDIUM,
        friction,
        dilation,
        cohesion: 1.3e6,
        tension_strength: None,
    }
}

/// Flow of Mohr-Coulomb grows at the rates of an own calculation from the closed form of the tangent of ideal plasticity
/// (`C - C P N C / (N C P)`, every degree of direction), the less the more it dilates, and not at all if it is associated.
#[test]
fn rates_are_those_of_the_closed_form() {
    for (friction, dilation, expected) in [
        (47.7, 0.0, 638.0),
        (47.7, 5.0, 553.0),
        (47.7, 10.0, 473.0),
        (47.7, 15.0, 397.0),
        (47.7, 24.0, 271.0),
        (47.7, 35.0, 133.0),
        (47.7, 47.7, 0.0),
        (42.0, 0.0, 568.0),
        (42.0, 10.0, 410.0),
        (42.0, 20.0, 265.0),
        (42.0, 42.0, 0.0),
    ] {
        let surface = MohrCoulomb::new(mohr_coulomb(friction, dilation)).unwrap();
        let found = growth_of_flow(&ElastoPlastic::new(surface)).unwrap();
        let allowed = 0.005 * expected + 1.0;
        assert!(
            (found - expected).abs() < allowed,
            "{friction} {dilation}: {found} {expected}"
        );
    }
}

/// The rate does not depend on the scale of stress, and that of a law that softens, too, is that of its flow to 5 %, by which the part of its
/// tangent that softening has is known.
#[test]
fn rates_are_of_the_flow_alone() {
    for cohesion in [1e3, 1.3e6, 5e8] {
        let surface = MohrCoulomb::new(MohrCoulombParameters {
            cohesion,
            ..mohr_coulomb(47.7, 0.0)
        });
        let found = growth_of_flow(&ElastoPlastic::new(surface.unwrap())).unwrap();
        assert!((found - 638.0).abs() < 4.0, "{cohesion}: {found}");
    }
    let concrete: PlasticDamage<MohrCoulomb> = presets::paper_concrete().unwrap();
    let bare = MohrCoulomb::new(presets::PAPER_CONCRETE).unwrap();
    let [damaged, bare] = [
        growth_of_flow(&concrete),
        growth_of_flow(&ElastoPlastic::new(bare)),
    ];
    assert!(
        (damaged.unwrap() / bare.unwrap() - 1.0).abs() < 0.05,
        "{damaged:?} {bare:?}"
    );
}

/// The inscribed cone of Drucker and Prager does not grow in plane strain without dilation; an elastic law does not flow.
#[test]
fn cones_and_elastic_laws_do_not_grow() {
    let cone = DruckerPrager::new(DruckerPragerParameters {
        medium: MEDIUM,
        friction: 47.7,
        dilation: 0.0,
        cohesion: 1.3e6,
        fit: ConeFit::Inscribed,
    });
    let found = growth_of_flow(&ElastoPlastic::new(cone.unwrap())).unwrap();
    assert!(found < 10.0, "{found}");
    assert_eq!(growth_of_flow(&LinearElastic::new(MEDIUM)), None);
}
