//! Laws of rock and concrete: in a file as in Rust, and what is refused or doubted of them.

use powerhouse::material::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, Mazars, MazarsParameters,
    MazarsTension, MohrCoulomb, MohrCoulombParameters, PlasticDamage, PlasticDamageParameters,
    Softening, TwoSurface, TwoSurfaceParameters, presets,
};
use powerhouse::{Error, Material, Remark};

use crate::support::*;

const ELASTIC: &str = "law = \"elastic\"\nyoung = 9.0e9\npoisson = 0.27\ndensity = 2750\n";

/// The paper's rock, weak enough to yield under the cube's wave.
fn weak() -> MohrCoulombParameters {
    MohrCoulombParameters {
        cohesion: 2.0e4,
        tension_strength: Some(1.0e4),
        ..presets::PAPER_ROCK
    }
}

/// Every law of a file is the one of Rust to the last bit, a preset with replaced parameters
/// included.
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
    let mazars = Mazars::new(MazarsParameters {
        medium: ROCK,
        threshold: 2e-6,
        tension: MazarsTension::Rates {
            share: 1.0,
            rate: 6e5,
        },
        compression_share: 1.1,
        compression_rate: 1e4,
        residual_stiffness: 0.01,
    });
    let damage = |tension, compression, recovery, residual| {
        let parameters = PlasticDamageParameters {
            surface: surface(),
            tension,
            compression,
            stiffness_recovery: recovery,
            residual_stiffness: residual,
        };
        Material::new(PlasticDamage::new(parameters).unwrap())
    };
    let weak = "preset = \"paper-rock\"\ncohesion = 2e4\ntensile_strength = 1e4\n";
    let rock = "young = 9e9\npoisson = 0.27\ndensity = 2750\n";
    let cases = [
        (
            format!("law = \"mohr-coulomb\"\n{weak}"),
            Material::new(ElastoPlastic::new(surface())),
        ),
        (
            format!(
                "law = \"drucker-prager\"\n{rock}friction = 42\ndilation = 10\ncohesion = 2e4\nfit = \"plane-strain\"\n"
            ),
            Material::new(ElastoPlastic::new(cone(ConeFit::PlaneStrain, 10.0))),
        ),
        (
            format!("law = \"drucker-prager\"\n{weak}"),
            Material::new(ElastoPlastic::new(cone(ConeFit::Inscribed, 0.0))),
        ),
        (
            format!("law = \"two-surface\"\n{weak}compressive_strength = 2e5\n"),
            Material::new(ElastoPlastic::new(listed.unwrap())),
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
            Material::new(mazars.unwrap()),
        ),
    ];
    let elastic = run(cube_scene());
    for (keys, material) in cases {
        let twin = || cube_scene_made_of(cube(), &["rock"], &material);
        assert_ne!(run(twin()).histories, elastic.histories, "{keys} yields");
        variants.equal((ELASTIC, &keys), twin());
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

/// What is wrong with a law is shown at the key that is at fault, or at its table.
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
            "only a Drucker-Prager surface has a fit",
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
            "the preset has no parameters of this law",
        ),
        (
            "law = \"mazars\"\npreset = \"paper-c25\"\ntension = { rate = 1e4 }\n",
            9,
            "B e0 = 0.508",
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

/// Elements in which a softening law snaps back are refused before the first step, with the largest
/// permitted width, the element and its set; at its place in a file, and in Rust alike.
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
    let Err(Error::Scene(fault)) = variants.read(ELASTIC, keys).unwrap().prepare() else {
        panic!("a cube of 50 m elements is accepted");
    };
    let told = fault.to_string();
    // The material of the part.
    assert_eq!(fault.position(), (12, 12), "{told}");
    let twin = cube_scene_made_of(cube(), &["rock"], &Material::new(law));
    let Err(error) = twin.prepare() else {
        panic!("the twin is accepted");
    };
    for told in [told, error.to_string()] {
        for passage in [
            "element ",
            "set 'rock'",
            "50.0000 m wide",
            &largest.to_string(),
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
            .part(powerhouse::Part::new("rock", Material::new(law)))
            .prepare()
    };
    assert!(small(0.99).is_ok() && small(1.01).is_err());
}

/// What does not fit together in a material, and rock that yields at an absorbing face, are told.
#[test]
fn doubts_are_told() {
    let variants = Variants::new("laws-doubts");
    let scene = variants.read(ELASTIC, "law = \"mohr-coulomb\"\npreset = \"paper-rock\"\n");
    let simulation = scene.unwrap().prepare().unwrap();
    let warnings = simulation.remarks().iter().filter(|r| r.is_warning());
    let told: Vec<String> = warnings.map(Remark::to_string).collect();
    for passage in [
        "part 'rock': the tensile strength of 1.3000e6 Pa lies beyond the apex",
        "a uniaxial compressive strength of 4.7167e6 Pa, not the listed 3.5000e7 Pa",
        "part 'rock' of the law 'mohr-coulomb' touches an absorbing face",
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

/// Rock that cracks and crushes early.
fn cracking() -> Material {
    let rates = |rate| Softening::Rates {
        share: 1.0,
        rate,
        threshold: 0.0,
    };
    let law = PlasticDamage::new(PlasticDamageParameters {
        surface: MohrCoulomb::new(weak()).unwrap(),
        tension: rates(2e4),
        compression: rates(5e3),
        stiffness_recovery: 1.0,
        residual_stiffness: 1e-2,
    });
    Material::new(law.unwrap())
}

/// With yielding and damage the energy balance closes to rounding, plastic and damage energy never
/// fall, recovered energy comes back in a column of its own, and what the integration of a step
/// leaves falls with the step.
#[test]
fn energies_of_plastic_flow_and_damage_are_told() {
    let energies = |share: f64| {
        let scene = cube_scene_made_of(cube(), &["rock"], &cracking());
        let mut plan = scene.output_plan().clone();
        plan.energies = Some(0.01);
        let scene = scene
            .output(plan)
            .step(powerhouse::TimeStep::OfStable(share));
        let results = run(scene.energy_residual(powerhouse::ResidualLimit::Share(1e-9)));
        let residual = results.energy_residual().unwrap();
        assert!(residual.largest < 1e-9, "{residual:?}");
        assert!(residual.share_of_input.unwrap() < 1e-9, "{residual:?}");
        let column = |name: &str| results.energies.column(name).unwrap().values.clone();
        let rising = |values: &[f64], sign: f64| {
            assert!(
                values
                    .windows(2)
                    .all(|pair| sign * (pair[1] - pair[0]) >= 0.0)
            );
            sign * values.last().unwrap()
        };
        let plastic = rising(&column("plastic"), 1.0);
        let damage = rising(&column("damage"), 1.0);
        let recovered = rising(&column("recovery"), -1.0);
        assert!(plastic > 0.0 && damage > 0.0 && recovered > 0.0);
        column("integration").last().unwrap().abs() / (plastic + damage)
    };
    let (coarse, fine) = (energies(1.0), energies(0.25));
    assert!(coarse < 0.1, "{coarse}");
    // Of first order in the step: a quarter; a half proves that it falls.
    assert!(fine < 0.5 * coarse, "{fine} after {coarse}");
}

/// What laws remember is recorded at places, in envelopes and snapshots by name, and the summary
/// names the largest damage and where it is; in a file as in Rust.
#[test]
fn what_laws_remember_is_recorded() {
    let variants = Variants::new("laws-state");
    let keys = "law = \"plastic-damage\"\npreset = \"paper-rock\"\ncohesion = 2e4\ntensile_strength = 1e4\ntension = { rate = 2e4 }\ncompression = { rate = 5e3 }\nresidual_stiffness = 0.01\n";
    let text = CUBE.replacen(ELASTIC, keys, 1)
        + "quantities = [\"displacement\", \"velocity\", \"acceleration\", \"state\"]\n[output.envelope]\nquantities = [\"state\"]\nevery = 0.05\n[output.snapshots]\nquantities = [\"displacement\", \"state\"]\nevery = 0.2\n";
    let path = variants.0.0.join("cube.toml");
    let scene = powerhouse::Scene::from_toml(text, path, &powerhouse::Registry::default()).unwrap();
    let out = powerhouse::ResultFolder::new(variants.0.0.join("out"));
    let mesh = scene.mesh().clone();
    let hooks = powerhouse::RunHooks {
        snapshots: Some(out.snapshots(&mesh, &[]).unwrap()),
        ..Default::default()
    };
    let results = scene.prepare().unwrap().run(hooks).unwrap();
    let twin = cube_scene_made_of(cube(), &["rock"], &cracking());
    let mut plan = twin.output_plan().clone();
    plan = plan.state("surface", powerhouse::model::Vec3::new(150.0, 150.0, 0.0));
    let twin = run(twin.output(plan));
    assert_eq!(results.histories, twin.histories);
    for name in ["damage", "plastic_strain_zx", "yield_state"] {
        let column = results
            .histories
            .column(&format!("surface.{name}"))
            .unwrap();
        assert!(column.values.iter().any(|v| *v != 0.0), "{name}");
    }
    let last = |results: &powerhouse::Results, name: &str| {
        let state = results.state.as_ref().unwrap();
        let (_, field) = state.peaks.iter().find(|(v, _)| v.name == name).unwrap();
        field.values.clone()
    };
    // What never falls is the same whether it is looked at often or at the end.
    let torn = last(&results, "damage_tension");
    assert_eq!(torn, last(&twin, "damage_tension"));
    assert!(torn.iter().all(|d| (0.0..1.0).contains(d)) && torn.iter().any(|d| *d > 0.1));
    out.write(("cube", &mesh), &results, &[], None).unwrap();
    let summary = std::fs::read_to_string(out.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let peaks = summary["peaks"].as_array().unwrap();
    let peak = peaks
        .iter()
        .find(|peak| peak["name"] == "damage_tension")
        .unwrap();
    let most = torn.iter().copied().fold(0.0, f64::max);
    // Numbers of JSON are read to a rounding.
    assert!((peak["value"].as_f64().unwrap() - most).abs() < 1e-12);
    let place = torn.iter().position(|d| *d == most).unwrap();
    let element = mesh.element_tags()[results.state.as_ref().unwrap().elements[place] as usize];
    assert_eq!(peak["place"], format!("element {element}"));
    for (file, names) in [
        ("state.vtu", ["damage_tension", "damage_type"]),
        ("snapshots/snapshots_00001.vtu", ["damage", "yield_state"]),
    ] {
        let bytes = std::fs::read(out.path().join(file)).unwrap();
        let head = String::from_utf8_lossy(&bytes);
        for name in names {
            assert!(head.contains(&format!("Name=\"{name}\"")), "{file}: {name}");
        }
    }
    assert!(out.path().join("pictures/damage_tension.png").exists());
}

/// State belongs to elements: asked for at a node it is refused at its place.
#[test]
fn nodes_have_no_state() {
    let variants = Variants::new("laws-nodes");
    let old = "at = [150, 150, 0]";
    let Err(Error::Scene(fault)) = variants.read(old, "node = 1\nquantities = [\"state\"]") else {
        panic!("a node has a state");
    };
    assert!(
        fault.to_string().contains("stress or state at a node"),
        "{fault}"
    );
}
