//! Laws of rock and concrete: equivalence of file and Rust, errors and warnings.

use powerhouse::material::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, HoekBrownParameters,
    LeeFenves, LeeFenvesParameters, Mazars, MazarsParameters, MazarsTension, MohrCoulomb,
    MohrCoulombParameters, PlasticDamage, PlasticDamageParameters, Softening, SofteningPlasticity,
    SofteningPlasticityParameters, StrengthFall, TwoSurface, TwoSurfaceParameters, presets,
};
use powerhouse::{Error, Material, Remark};

use super::support::*;

/// The paper's rock, weak enough to yield under the cube's wave.
fn weak() -> MohrCoulombParameters {
    MohrCoulombParameters {
        cohesion: 2.0e4,
        tension_strength: Some(1.0e4),
        ..presets::PAPER_ROCK
    }
}

/// Every law of a file equals that of Rust to the last bit, including a preset with replaced parameters.
#[test]
fn laws_of_a_file_are_those_of_rust() {
    let variants = Variants::new("laws");
    let surface = || MohrCoulomb::new(weak()).unwrap();
    let cone = |fit, dilation| {
        let MohrCoulombParameters {
            medium,
            friction,
            cohesion,
            ..
        } = weak();
        DruckerPrager::new(DruckerPragerParameters {
            medium,
            friction,
            dilation,
            cohesion,
            fit,
        })
        .unwrap()
    };
    let softening = |fall, residual_strength| {
        let parameters = SofteningPlasticityParameters {
            surface: surface(),
            fall,
            residual_strength,
        };
        SofteningPlasticity::new(parameters).unwrap()
    };
    let rates = |rate| Softening::Rates {
        share: 0.9,
        rate,
        threshold: 1e-6,
    };
    let listed = TwoSurface::new(TwoSurfaceParameters {
        tension_strength: 1.0e4,
        compression_strength: 2.0e5,
        cohesion: 2.0e4,
        ..presets::PAPER_ROCK_LISTED
    });
    let mazars = |tension| {
        let law = Mazars::new(MazarsParameters {
            medium: ROCK,
            threshold: 2e-6,
            tension,
            compression_share: 1.1,
            compression_rate: 1e4,
            residual_stiffness: 0.01,
        });
        Material::from(law.unwrap())
    };
    let mass = HoekBrown::new(HoekBrownParameters {
        medium: ROCK,
        intact_strength: 3e5,
        intact_constant: 12.0,
        strength_index: 40.0,
        disturbance: 0.2,
        dilation_share: 0.5,
    });
    let crushed = LeeFenves::new(LeeFenvesParameters {
        medium: ROCK,
        tension_strength: 1e4,
        compression_strength: 8e4,
        compression_limit: 4e4,
        biaxial_ratio: 1.12,
        meridian_ratio: 0.7,
        dilation: 30.0,
        tension_energy: 1e5,
        compression_energy: 1e6,
        tension_damage: 0.8,
        compression_damage: 0.4,
        stiffness_recovery: 0.9,
        residual_stiffness: 0.01,
    });
    let usual = LeeFenves::new(LeeFenvesParameters {
        medium: ROCK,
        tension_strength: 1e4,
        compression_strength: 8e4,
        compression_limit: 8e4,
        tension_energy: 1e5,
        ..presets::PAPER_CONCRETE_LEE_FENVES
    });
    let damage = |tension, compression, recovery, residual| {
        let parameters = PlasticDamageParameters {
            surface: surface(),
            tension,
            compression,
            stiffness_recovery: recovery,
            residual_stiffness: residual,
        };
        Material::from(PlasticDamage::new(parameters).unwrap())
    };
    let weak = "preset = \"paper-rock\"\ncohesion = 2e4\ntensile_strength = 1e4\n";
    let rock = "young = 9e9\npoisson = 0.27\ndensity = 2750\n";
    let cases = [
        (
            format!("law = \"mohr-coulomb\"\n{weak}"),
            Material::from(ElastoPlastic::new(surface())),
        ),
        (
            format!("law = \"mohr-coulomb\"\n{weak}softening = {{ rate = 2e3, residual = 0.1 }}\n"),
            Material::from(softening(StrengthFall::Rate(2e3), 0.1)),
        ),
        (
            format!(
                "law = \"mohr-coulomb\"\n{weak}softening = {{ fracture_energy = 2e3, residual = 0.3 }}\n"
            ),
            Material::from(softening(StrengthFall::FractureEnergy { energy: 2e3 }, 0.3)),
        ),
        (
            format!(
                "law = \"drucker-prager\"\n{rock}friction = 42\ndilation = 10\ncohesion = 2e4\nfit = \"plane-strain\"\n"
            ),
            Material::from(ElastoPlastic::new(cone(ConeFit::PlaneStrain, 10.0))),
        ),
        (
            format!("law = \"drucker-prager\"\n{weak}"),
            Material::from(ElastoPlastic::new(cone(ConeFit::Inscribed, 0.0))),
        ),
        (
            format!("law = \"two-surface\"\n{weak}compressive_strength = 2e5\n"),
            Material::from(ElastoPlastic::new(listed.unwrap())),
        ),
        (
            format!(
                "law = \"plastic-damage\"\n{weak}tension = {{ rate = 9e3, share = 0.9, threshold = 1e-6 }}\ncompression = {{ share = 0.9, rate = 2e3, threshold = 1e-6 }}\nstiffness_recovery = 0.5\nresidual_stiffness = 0.02\n"
            ),
            damage(rates(9e3), rates(2e3), 0.5, 0.02),
        ),
        (
            format!("law = \"plastic-damage\"\n{weak}tension = {{ fracture_energy = 1e5 }}\n"),
            damage(
                Softening::FractureEnergy {
                    energy: 1e5,
                    threshold: 0.0,
                },
                Softening::None,
                1.0,
                1e-3,
            ),
        ),
        (
            format!(
                "law = \"mazars\"\n{rock}threshold = 2e-6\ntension = {{ rate = 6e5 }}\ncompression = {{ share = 1.1, rate = 1e4 }}\nresidual_stiffness = 0.01\n"
            ),
            mazars(MazarsTension::Rates {
                share: 1.0,
                rate: 6e5,
            }),
        ),
        (
            format!(
                "law = \"mazars\"\n{rock}threshold = 2e-6\ntension = {{ fracture_energy = 100, falling = \"stress\" }}\ncompression = {{ share = 1.1, rate = 1e4 }}\nresidual_stiffness = 0.01\n"
            ),
            mazars(MazarsTension::FallingStress { energy: 100.0 }),
        ),
        (
            format!(
                "law = \"hoek-brown\"\n{rock}intact_strength = 3e5\nintact_constant = 12\nstrength_index = 40\ndisturbance = 0.2\ndilation_share = 0.5\n"
            ),
            Material::from(ElastoPlastic::new(mass.unwrap())),
        ),
        (
            format!(
                "law = \"lee-fenves\"\n{rock}tensile_strength = 1e4\ncompressive_strength = 8e4\ncompressive_limit = 4e4\nbiaxial_ratio = 1.12\nmeridian_ratio = 0.7\ndilation = 30\ntension = {{ fracture_energy = 1e5, damage = 0.8 }}\ncompression = {{ fracture_energy = 1e6, damage = 0.4 }}\nstiffness_recovery = 0.9\nresidual_stiffness = 0.01\n"
            ),
            Material::from(crushed.unwrap()),
        ),
        (
            format!(
                "law = \"lee-fenves\"\npreset = \"paper-c25\"\n{rock}tensile_strength = 1e4\ncompressive_strength = 8e4\ntension = {{ fracture_energy = 1e5 }}\n"
            ),
            Material::from(usual.unwrap()),
        ),
    ];
    let elastic = run(cube_scene());
    for (keys, material) in cases {
        let twin = || cube_scene_made_of(cube(), &["rock"], &material);
        assert_ne!(
            run(twin()).histories(),
            elastic.histories(),
            "{keys} yields"
        );
        variants.equal((CUBE, &undamped(&keys)), twin());
    }
}

/// Published materials are found by their names: medium and size limit are those of the preset.
#[test]
fn presets_are_found_by_name() {
    let variants = Variants::new("laws-presets");
    for (keys, young) in [
        ("law = \"plastic-damage\"\npreset = \"paper-c25\"\n", 25.0e9),
        ("law = \"plastic-damage\"\npreset = \"C30\"\n", 32.836568e9),
        ("law = \"mazars\"\npreset = \"paper-c25\"\n", 25.0e9),
        ("law = \"mohr-coulomb\"\npreset = \"C20\"\n", 29.961949e9),
        ("law = \"lee-fenves\"\npreset = \"C30\"\n", 32.836568e9),
        ("law = \"lee-fenves\"\npreset = \"paper-c25\"\n", 25.0e9),
        ("law = \"two-surface\"\npreset = \"paper-c25\"\n", 25.0e9),
    ] {
        // Without the wave, whose ground would be another one.
        let scene = variants.read(ELASTIC, keys);
        let Err(error) = scene else {
            let found = scene.unwrap().parts()[0].material.medium().young;
            assert!((found - young).abs() < 1e-6 * young, "{keys}: {found}");
            continue;
        };
        panic!("{keys}: {error}");
    }
}

/// A fault of a law is reported at the key concerned, or at its table.
#[test]
fn faults_have_their_place() {
    let variants = Variants::new("laws-faults");
    let rock = "preset = \"paper-rock\"";
    let cases = [
        ("law = \"mohr-coulomb\"\n", 5, "the key 'young' is missing"),
        (
            "law = \"mohr-coulomb\"\nyoung = 1e9\npoisson = 0.2\ndensity = 2e3\nfriction = 30\n",
            5,
            "the key 'cohesion' is missing",
        ),
        (
            "law = \"mohr-coulomb\"\npreset = \"paper-rok\"\n",
            8,
            "'paper-rok' is not permitted here",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\ndilation = 50\n",
            9,
            "dilation = 50 degrees is above friction = 42 degrees",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\nfriction = 80\n",
            9,
            "outside its permitted range [0, 75]",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\nfit = \"inscribed\"\n",
            9,
            "unknown key 'fit'",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\ntensile_strength = 1e13\n",
            9,
            "outside its permitted range",
        ),
        (
            "law = \"two-surface\"\nPRESET\ncompressive_strength = 2e6\n",
            9,
            "strength",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\nfit = \"inscribed\"\n",
            9,
            "the key 'fit' is permitted with surface",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\ntension = { rate = 1e3, fracture_energy = 100 }\n",
            9,
            "either fracture_energy, or rate",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\ntension = { rate = -1e3 }\n",
            9,
            "expected a number above 0",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\nstiffness_recovery = 2\n",
            9,
            "outside its permitted range [0, 1]",
        ),
        (
            "law = \"mazars\"\nPRESET\n",
            8,
            "the preset contains no parameters of this law",
        ),
        (
            "law = \"mazars\"\npreset = \"paper-c25\"\ntension = { rate = 1e4 }\n",
            9,
            "B e0 = 0.508",
        ),
        (
            "law = \"mazars\"\npreset = \"paper-c25\"\ntension = { falling = \"stress\", rate = 1e4 }\n",
            9,
            "either fracture_energy, or rate",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\nsoftening = { residual = 0.2 }\n",
            9,
            "either fracture_energy or rate must be given",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\nsoftening = { rate = 10, residual = 0.0005 }\n",
            9,
            "outside its permitted range [0.001, 1]",
        ),
        (
            "law = \"mohr-coulomb\"\nPRESET\nsoftening = { rate = 10 }\n",
            9,
            "the key 'residual' is missing",
        ),
        (
            "law = \"hoek-brown\"\nyoung = 1e9\npoisson = 0.2\ndensity = 2e3\n",
            5,
            "the key 'intact_strength' is missing",
        ),
        (
            "law = \"hoek-brown\"\nyoung = 1e9\npoisson = 0.2\ndensity = 2e3\nintact_strength = 5e7\nintact_constant = 10\nstrength_index = 120\n",
            13,
            "strength_index = 120 is outside its permitted range [5, 100]",
        ),
        (
            "law = \"lee-fenves\"\nPRESET\n",
            8,
            "the preset contains no parameters of this law",
        ),
        (
            "law = \"lee-fenves\"\nyoung = 1e9\npoisson = 0.2\ndensity = 2e3\ntensile_strength = 1e6\ncompressive_strength = 1e7\n",
            5,
            "the key 'tension.fracture_energy' is missing",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ncompressive_limit = 1e6\n",
            9,
            "outside its permitted range",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ncompressive_strength = 1e6\n",
            9,
            "outside its permitted range",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ndilation = 70\n",
            9,
            "dilation = 70 is outside its permitted range [1, ",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ntension = { damage = 2 }\n",
            9,
            "outside its permitted range [0, 1]",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ntension = { damage = -2 }\n",
            9,
            "expected a number of 0 or above",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ntension = { damge = 0.2 }\n",
            9,
            "unknown key 'tension.damge'",
        ),
        (
            "law = \"lee-fenves\"\npreset = \"C30\"\ntension = 0.2\n",
            9,
            "found the number 0.2, expected a table",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\ntension = 3\n",
            9,
            "found the number 3, expected a table",
        ),
        (
            "law = \"plastic-damage\"\nPRESET\ntensile_strength = -1\n",
            9,
            "expected a number of 0 or above",
        ),
        (
            "law = \"two-surface\"\nPRESET\nyoung = \"stiff\"\n",
            9,
            "expected a number above 0",
        ),
        // An unknown key is reported before the missing one of which it may be the cause.
        (
            "law = \"mohr-coulomb\"\nyuong = 1e9\npoisson = 0.2\n",
            8,
            "unknown key 'yuong'",
        ),
    ];
    for (keys, line, message) in cases {
        let keys = keys.replace("PRESET", rock);
        let Err(Error::Scene(fault)) = variants.read(ELASTIC, &keys) else {
            panic!("{keys}");
        };
        let told = fault.to_string();
        assert!(told.contains(message), "{keys}: {told}");
        assert_eq!(fault.position().0, line, "{keys}: {told}");
    }
}

/// Elements with snap-back of a softening law are errors before the first step, with the largest permitted width, the
/// element and its set; in a file with its position, and in Rust.
#[test]
fn elements_that_snap_back_are_refused() {
    let variants = Variants::new("laws-sizes");
    let keys =
        "law = \"plastic-damage\"\npreset = \"paper-rock\"\ntension = { fracture_energy = 133 }\n";
    let law = PlasticDamage::new(PlasticDamageParameters {
        surface: MohrCoulomb::new(presets::PAPER_ROCK).unwrap(),
        tension: Softening::FractureEnergy {
            energy: 133.0,
            threshold: 0.0,
        },
        compression: Softening::None,
        stiffness_recovery: 1.0,
        residual_stiffness: 1e-3,
    })
    .unwrap();
    let largest = law.largest_size().unwrap();
    let Err(Error::Scene(fault)) = variants.read(CUBE, &undamped(keys)).unwrap().prepare() else {
        panic!("a cube of 50 m elements is accepted");
    };
    let told = fault.to_string();
    // The material of the part.
    assert_eq!(fault.position(), (12, 12), "{told}");
    // A section through such elements, which is evaluated first, changes nothing.
    let cut = "\n[[output.section]]\nname = \"wall\"\nset = \"rock\"\nat = [160, 150, -10]\nnormal = [1, 0, 0]\nalong = [0, 1, 0]\n";
    let text = undamped(keys) + cut;
    let path = variants.0.join("cube.toml");
    let scene = powerhouse::FileScene::from_toml(text, path, &powerhouse::Registry::default());
    let Err(Error::Scene(fault)) = scene.unwrap().prepare() else {
        panic!("a cut makes a cube of 50 m elements acceptable");
    };
    assert_eq!(fault.position(), (12, 12), "{fault}");
    let twin = cube_scene_made_of(cube(), &["rock"], &Material::from(law));
    let Err(error) = twin.prepare() else {
        panic!("the twin is accepted");
    };
    for told in [told, error.to_string()] {
        for passage in [
            "element ",
            "set 'rock'",
            "50.0000 m wide",
            &format!("{largest:.4}"),
            "snaps back in tension",
        ] {
            assert!(told.contains(passage), "{passage}: {told}");
        }
    }
    // Elements a little smaller than the limit are accepted.
    let small = |share: f64| {
        let scale = share * largest / 50.0;
        let mesh = cube().map_positions(|x| x * scale).unwrap();
        let scene = powerhouse::Scene::new("small", mesh);
        scene
            .part(powerhouse::Part::new("rock", Material::from(law)))
            .prepare()
    };
    assert!(small(0.99).is_ok() && small(1.01).is_err());
}

/// Inconsistent material parameters, and plastic rock along an absorbing face, have warnings.
#[test]
fn warnings_are_reported() {
    let variants = Variants::new("laws-warnings");
    let scene = variants.read(
        CUBE,
        &undamped("law = \"mohr-coulomb\"\npreset = \"paper-rock\"\n"),
    );
    let simulation = scene.unwrap().prepare().unwrap();
    let warnings = simulation.remarks().iter().filter(|r| r.is_warning());
    let told: Vec<String> = warnings.map(Remark::to_string).collect();
    for passage in [
        "part 'rock': the tensile strength of 1.3000e6 Pa is beyond the apex",
        "a uniaxial compressive strength of 4.7167e6 Pa, not the listed 3.5000e7 Pa",
        "part 'rock' with the law 'mohr-coulomb' touches an absorbing face",
    ] {
        assert!(
            told.iter().any(|t| t.contains(passage)),
            "{passage}: {told:?}"
        );
    }
    let elastic = variants.read("poisson = 0.27", "poisson = 0.495");
    let simulation = elastic.unwrap().prepare().unwrap();
    let remarks = simulation.remarks().iter().map(Remark::to_string);
    let told: Vec<String> = remarks.collect();
    assert!(
        told.iter()
            .any(|t| t.contains("Poisson's ratio 0.495 is nearly 0.5"))
    );
    assert!(!told.iter().any(|t| t.contains("yields")), "{told:?}");
}
