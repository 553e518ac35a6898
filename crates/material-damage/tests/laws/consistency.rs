//! Consistency checks of material parameters.

use powerhouse_material_damage::{
    Finding, LeeFenves, LeeFenvesParameters, MohrCoulomb, MohrCoulombParameters, TwoSurface,
    TwoSurfaceParameters, YieldSurface, presets,
};
use powerhouse_model::ElasticMedium;

/// For the paper's rock and concrete, cut-offs without effect and compressive
/// strengths that disagree with cohesion and friction are reported, with the actual values.
#[test]
fn the_papers_strengths_are_reported_as_inconsistent() {
    for (p, listed, expected) in [
        (
            presets::PAPER_ROCK,
            35.0e6,
            [1.3e6, 1.166143e6, 0.934980e6, 4.716677e6],
        ),
        (
            presets::PAPER_CONCRETE,
            16.7e6,
            [1.27e6, 1.182909e6, 1.005864e6, 6.720590e6],
        ),
    ] {
        let findings = MohrCoulomb::new(p).unwrap().findings(Some(listed));
        let [
            Finding::InactiveCutOff {
                listed: tension,
                apex,
                in_force,
            },
            Finding::CompressiveStrength {
                listed: compression,
                in_force: implied,
            },
        ] = findings[..]
        else {
            panic!("{findings:?}");
        };
        assert_eq!(compression, listed);
        for (found, expected) in [tension, apex, in_force, implied].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1.0, "{found} {expected}");
        }
        assert!(findings[0].to_string().contains("without effect"));
    }
}

/// A surface through two strengths is consistent; a cut-off below the listed strength and a nearly
/// incompressible medium are reported.
#[test]
fn consistent_numbers_have_no_findings() {
    let medium = ElasticMedium::new(25.0e9, 0.17, 2500.0).unwrap();
    let p = MohrCoulombParameters::through_strengths(medium, 16.7e6, 1.27e6).unwrap();
    let surface = MohrCoulomb::new(p).unwrap();
    assert!((surface.uniaxial_compression() - 16.7e6).abs() < 1e-9 * 16.7e6);
    assert!((surface.uniaxial_tension() - 1.27e6).abs() < 1e-9 * 1.27e6);
    assert_eq!(surface.findings(Some(16.7e6)), []);
    assert!(MohrCoulombParameters::through_strengths(medium, 1.0e6, 2.0e6).is_err());

    let cut = MohrCoulombParameters {
        tension_strength: Some(1.1e6),
        ..presets::PAPER_ROCK
    };
    let findings = MohrCoulomb::new(cut).unwrap().findings(None);
    assert!(
        matches!(findings[..], [Finding::TensileStrength { .. }]),
        "{findings:?}"
    );
    let medium = ElasticMedium {
        poisson: 0.497,
        ..medium
    };
    let soft = MohrCoulombParameters {
        tension_strength: None,
        medium,
        ..presets::PAPER_ROCK
    };
    let findings = MohrCoulomb::new(soft).unwrap().findings(None);
    assert_eq!(findings, [Finding::NearlyIncompressible { poisson: 0.497 }]);
    let concrete = LeeFenvesParameters {
        medium,
        compression_limit: 16.7e6,
        compression_strength: 16.7e6,
        ..presets::PAPER_CONCRETE_LEE_FENVES
    };
    let findings = LeeFenves::new(concrete).unwrap().findings();
    assert_eq!(findings, [Finding::NearlyIncompressible { poisson: 0.497 }]);
}

/// A cohesion that is inconsistent with the listed strengths is reported, a consistent one is not.
#[test]
fn an_inconsistent_cohesion_is_reported() {
    let n: f64 = 6.678_793;
    for (p, expected) in [
        (presets::PAPER_CONCRETE_LISTED, 0.5 * 16.7e6 / n.sqrt()),
        (presets::PAPER_ROCK_LISTED, 7.79149e6),
    ] {
        let findings = TwoSurface::new(p).unwrap().findings();
        let [Finding::Cohesion { listed, in_force }] = findings[..] else {
            panic!("{findings:?}");
        };
        assert_eq!(listed, p.cohesion);
        assert!(
            (in_force / expected - 1.0).abs() < 1e-3,
            "{in_force} {expected}"
        );
        let kept = TwoSurfaceParameters {
            cohesion: 1.01 * in_force,
            ..p
        };
        assert_eq!(TwoSurface::new(kept).unwrap().findings(), []);
    }
}
