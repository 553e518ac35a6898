//! Flat damping and rims: every key of a file is equivalent to its counterpart in Rust, and cost and effect are
//! reported.

use powerhouse::engine::{Rayleigh, SolidKernel};
use powerhouse::material::{
    DampingBand, ElastoPlastic, LinearElastic, MohrCoulomb, MohrCoulombParameters,
    ReferenceFrequency, RelaxationSpectrum, presets,
};
use powerhouse::model::{ElasticMedium, HistoryVariable, LawInput, Mesh, PointLaw, Stress};
use powerhouse::{Damping, Error, FileScene, Material, Part, Registry, Remark, Scene, remark};

use super::support::*;

const KERNEL: &str = "kernel = \"hex8-full\"\n";
/// Band that contains the cube's wave of 0.4 s.
const BAND: &str = "kind = \"flat\", ratio = 0.05, band = [0.5, 20]";

fn flat(mechanisms: usize, reference: ReferenceFrequency) -> Damping {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms,
    };
    Damping::Flat {
        spectrum: RelaxationSpectrum::fit(band).unwrap(),
        reference,
    }
}

fn elastic() -> Material {
    Material::from(LinearElastic::new(ROCK))
}

/// Rock that yields under the cube's wave.
fn weak() -> Material {
    let surface = MohrCoulomb::new(MohrCoulombParameters {
        cohesion: 2.0e4,
        tension_strength: Some(1.0e4),
        ..presets::PAPER_ROCK
    });
    Material::from(ElastoPlastic::new(surface.unwrap()))
}

const WEAK: &str =
    "law = \"mohr-coulomb\"\npreset = \"paper-rock\"\ncohesion = 2e4\ntensile_strength = 1e4\n";

/// The cube's scene with its parts replaced, on a mesh.
fn cube_with(mesh: Mesh, parts: Vec<Part>) -> Scene {
    let base = cube_scene();
    let scene = Scene::new("cube", mesh)
        .with_shared_field(base.field().unwrap().clone())
        .with_boundary(base.boundary().unwrap().clone())
        .with_duration(0.6)
        .with_output(base.output().clone());
    parts.into_iter().fold(scene, Scene::part)
}

fn damped(material: Material, damping: Damping) -> Scene {
    let part = Part::new("rock", material).with_kernel(SolidKernel::Hex8Full);
    cube_with(cube(), vec![part.with_damping(damping)])
}

/// The largest displacement along x at the surface (m).
fn peak(results: &powerhouse::Results) -> f64 {
    let column = results.histories().column("surface.ux").unwrap();
    column.values.iter().fold(0.0, |most, u| most.max(u.abs()))
}

/// Flat damping of a file is that of Rust to the last bit, with a law that yields too, and damps.
#[test]
fn flat_damping_of_a_file_is_that_of_rust() {
    let variants = Variants::new("damping-flat");
    let undamped = run(cube_scene());
    for (keys, mechanisms, reference) in [
        ("", 3, ReferenceFrequency::Centre),
        (
            ", mechanisms = 2, reference = 2.5",
            2,
            ReferenceFrequency::At(2.5),
        ),
        (", reference = \"static\"", 3, ReferenceFrequency::Static),
        (", reference = \"centre\"", 3, ReferenceFrequency::Centre),
    ] {
        let keys = format!("{KERNEL}damping = {{ {BAND}{keys} }}\n");
        let twin = || damped(elastic(), flat(mechanisms, reference));
        variants.equal((KERNEL, &keys), twin());
        let (with, without) = (peak(&run(twin())), peak(&undamped));
        assert!(with < 0.98 * without, "{keys}: {with} of {without}");
    }
    let text = CUBE.replace(ELASTIC, WEAK);
    let text = text.replace(KERNEL, &format!("{KERNEL}damping = {{ {BAND} }}\n"));
    let twin = || damped(weak(), flat(3, ReferenceFrequency::Centre));
    variants.equal((CUBE, &text), twin());
    assert_ne!(
        run(twin()).histories(),
        run(damped(weak(), Damping::None)).histories()
    );
}

/// Parts with a preset, and no damping of their own, have that of the preset where waves are incident, behind a rim of
/// the elements that touch the absorbing faces; a text switches both off.
#[test]
fn presets_are_damped_where_waves_are_incident() {
    let variants = Variants::new("damping-default");
    let text = CUBE.replace(ELASTIC, WEAK);
    let rock = |scene: &Scene| {
        let part = &scene.parts()[0];
        (part.damping.clone(), part.rim)
    };
    let scene = variants.read(CUBE, &text).unwrap();
    let (damping, rim) = rock(&scene);
    let Damping::Flat {
        spectrum,
        reference,
    } = damping.clone()
    else {
        panic!("{damping:?}");
    };
    let band = spectrum.band();
    assert_eq!((band.ratio, reference), (0.02, ReferenceFrequency::Centre));
    assert_eq!(rim, Some(0.0));
    let part = Part::new("rock", weak()).with_kernel(SolidKernel::Hex8Full);
    let twin = part.clone().with_damping(damping.clone()).with_rim(0.0);
    variants.equal((CUBE, &text), cube_with(cube(), vec![twin]));
    let simulation = scene.prepare().unwrap();
    let told: Vec<String> = simulation
        .remarks()
        .iter()
        .map(ToString::to_string)
        .collect();
    let told = told.join("\n");
    for passage in [
        "damping of part 'rock' (that of the preset of its material; `damping = \"none\"` switches it off): 2.000 %",
        "touch the absorbing faces; they are elastic and undamped",
    ] {
        assert!(told.contains(passage), "{told}");
    }

    // Switched off, it is that of Rust, which damps nothing by itself.
    let off = text.replace(KERNEL, &format!("{KERNEL}damping = \"none\"\n"));
    variants.equal((CUBE, &off), cube_with(cube(), vec![part.clone()]));
    // Damping or a rim of one's own takes the place of the default.
    let own = text.replace(KERNEL, &format!("{KERNEL}damping = {{ {BAND} }}\n"));
    let (of_own, rim) = rock(&variants.read(CUBE, &own).unwrap());
    assert_eq!((of_own, rim), (flat(3, ReferenceFrequency::Centre), None));
    let rimmed = text.replace(KERNEL, &format!("{KERNEL}elastic_rim = 40\n"));
    assert_eq!(
        rock(&variants.read(CUBE, &rimmed).unwrap()),
        (damping, Some(40.0))
    );
    // Without waves nothing is damped.
    let still = text.replace(WAVE, "");
    assert_eq!(
        rock(&variants.read(CUBE, &still).unwrap()),
        (Damping::None, None)
    );
}

/// In layers with the damping of the preset the field is damped alike, and the part has no rim.
#[test]
fn a_damped_field_needs_no_default_rim() {
    let variants = Variants::new("damping-layers");
    let text = CUBE.replace(ELASTIC, WEAK);
    let layers = |damping: &str| {
        let half_space = "[[layer]]\nmaterial = \"granite\"\n";
        let above = format!("[[layer]]\nmaterial = \"granite\"\nbottom = -400\n{damping}");
        text.replace("[boundary]", &format!("{above}{half_space}[boundary]"))
    };
    let rim = |text: &str| variants.read(CUBE, text).unwrap().parts()[0].rim;
    let alike = "damping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }\n";
    assert_eq!(rim(&layers(alike)), None);
    assert_eq!(rim(&layers("")), Some(0.0));
    assert_eq!(rim(&layers("damping = \"none\"\n")), Some(0.0));
}

/// A text other than "none" is no damping.
#[test]
fn other_texts_are_no_damping() {
    let variants = Variants::new("damping-texts");
    let text = CUBE.replace(KERNEL, &format!("{KERNEL}damping = \"flat\"\n"));
    let error = variants.read(CUBE, &text).err().unwrap().to_string();
    let wanted = "found a string, expected a table with the key 'kind', or \"none\"";
    assert!(error.contains(wanted), "{error}");
}

/// The cost of flat damping is reported before a run and agrees with the stable step.
#[test]
fn the_cost_of_flat_damping_is_reported() {
    let step = |damping| {
        let mut simulation = damped(elastic(), damping).prepare().unwrap();
        let step = simulation.stable_step().unwrap().step;
        let cost = simulation.remarks().iter().find_map(|remark| match remark {
            Remark::FlatDamping(remark::FlatDamping { set, cost, .. }) if set == "rock" => {
                Some((*cost, remark.to_string()))
            }
            _ => None,
        });
        (step, cost)
    };
    let (undamped, none) = step(Damping::None);
    assert!(none.is_none());
    let (shortened, cost) = step(flat(3, ReferenceFrequency::Centre));
    let (cost, told) = cost.unwrap();
    // Both steps are found to 1 %.
    assert!(
        (shortened / undamped - cost.step).abs() < 0.02,
        "{} {told}",
        shortened / undamped
    );
    assert!((cost.step - 0.905).abs() < 0.01, "{}", cost.step);
    assert_eq!(cost.variables, 18);
    assert!(cost.deviation < 0.013 && cost.speeds[0] < 0.96 && cost.speeds[1] > 1.05);
    for passage in [
        "part 'rock'",
        "5.000 % of critical from 0.5 to 20 Hz",
        "18 more history variables",
        "the static stiffness is 0.8",
    ] {
        assert!(told.contains(passage), "{passage}: {told}");
    }
    let (_, at_rest) = step(flat(3, ReferenceFrequency::Static));
    let at_rest = at_rest.unwrap().0;
    assert!(
        at_rest.step < cost.step && at_rest.speeds[0] > 1.0 && at_rest.static_stiffness == 1.0,
        "{at_rest:?}"
    );
}

/// User-defined law without tension, whose elastic part is not defined.
struct NoTension;

impl PointLaw for NoTension {
    fn name(&self) -> &str {
        "no-tension"
    }
    fn medium(&self) -> ElasticMedium {
        ROCK
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn stress_change(&self, input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
        let stress = Stress::elastic(ROCK.lambda(), ROCK.shear(), &input.strain);
        if stress.mean() > 0.0 {
            Stress([0.0; 6])
        } else {
            stress
        }
    }
}

#[derive(serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct NoKeys {}

/// A fault of damping or a rim is reported at the value concerned.
#[test]
fn faults_have_their_place() {
    let folder = Variants::new("damping-faults").0;
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let mut registry = Registry::default();
    registry.add_law("no-tension", |_: NoKeys| {
        Ok(Material::from_point_law(NoTension))
    });
    let read = |law: &str, keys: &str| {
        let text = CUBE
            .replace(ELASTIC, law)
            .replace(KERNEL, &format!("{KERNEL}{keys}\n"));
        FileScene::from_toml(text, folder.join("cube.toml"), &registry)
    };
    for (keys, message) in [
        (
            "damping = { kind = \"flat\", ratio = §0.3, band = [0.5, 20] }",
            "ratio = 0.3 is outside",
        ),
        (
            "damping = { kind = \"flat\", ratio = §0, band = [0.5, 20] }",
            "expected a number above 0",
        ),
        (
            "damping = { kind = \"flat\", ratio = 0.05, band = §[20, 0.5] }",
            "the lower one first",
        ),
        (
            "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10], mechanisms = §5 }",
            "mechanisms = 5 is outside",
        ),
        (
            "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10], reference = §\"top\" }",
            "expected \"centre\", \"static\" or a number above 0",
        ),
        (
            "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10], reference = §2e7 }",
            "reference = 20000000 is outside",
        ),
        (
            "damping = §{ kind = \"flat\", ratio = 0.05 }",
            "the key 'band' is missing",
        ),
        (
            "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10], §frequencies = [1, 2] }",
            "unknown key 'frequencies'",
        ),
        ("elastic_rim = §-1", "expected a number of 0 or above"),
    ] {
        let column = keys.chars().position(|c| c == '§').unwrap() + 1;
        let Err(Error::Scene(fault)) = read(ELASTIC, &keys.replace('§', "")) else {
            panic!("{keys}");
        };
        let told = fault.to_string();
        assert!(told.contains(message), "{keys}: {told}");
        assert_eq!(fault.position(), (15, column), "{keys}: {told}");
    }
    let own = format!("damping = {{ {BAND} }}");
    let Err(Error::Scene(fault)) = read("law = \"no-tension\"\n", &own) else {
        panic!("flat damping of a law without elastic part was accepted");
    };
    assert_eq!(fault.position(), (12, 11), "{fault}");
    assert!(
        fault
            .to_string()
            .contains("flat damping is not available for the law 'no-tension'")
    );
}

/// The cube with its inner and outer elements in two sets, the outer ones within a distance of the
/// absorbing faces.
fn cut(width: f64) -> Mesh {
    let mut mesh = cube();
    let (low, high) = mesh.bounding_box();
    let is_outer = |element: &u32| {
        let centre = mesh.centroid(*element);
        let half = 25.0;
        let sides = (0..3).any(|axis| centre[axis] - half < low[axis] + width - 1e-3);
        let upper = (0..2).any(|axis| centre[axis] + half > high[axis] - width + 1e-3);
        sides || upper
    };
    let elements = 0..mesh.element_count() as u32;
    let (outer, inner): (Vec<u32>, Vec<u32>) = elements.partition(is_outer);
    mesh.set_element_set("inner", inner).unwrap();
    mesh.set_element_set("outer", outer).unwrap();
    mesh
}

/// Rayleigh coefficients of the mass or of the stiffness alone are damping as both are; two zeros are none.
#[test]
fn any_coefficient_is_damping() {
    for (mass, stiffness) in [(0.0, 2e-4), (0.5, 0.0), (0.5, 2e-4)] {
        let rayleigh = Rayleigh { mass, stiffness };
        assert_eq!(Damping::from(rayleigh), Damping::Rayleigh(rayleigh));
    }
    assert_eq!(Damping::from(Rayleigh::default()), Damping::None);
}

/// A part with a rim is damped and plastic inside, elastic and undamped along the absorbing faces; the rim is reported,
/// and there is no warning about reflected waves.
#[test]
fn a_rim_is_elastic_and_undamped() {
    let variants = Variants::new("damping-rim");
    let rayleigh = Rayleigh {
        mass: 0.5,
        stiffness: 0.0,
    };
    let of = |set: &str, material| Part::new(set, material).with_kernel(SolidKernel::Hex8Full);
    for (width, elements) in [(0.0, 136), (50.0, 136), (60.0, 200)] {
        let keys = format!(
            "{KERNEL}damping = {{ kind = \"coefficients\", mass = 0.5, stiffness = 0 }}\nelastic_rim = {width}\n"
        );
        let text = CUBE.replace(ELASTIC, WEAK).replace(KERNEL, &keys);
        let rimmed = of("rock", weak()).with_damping(rayleigh).with_rim(width);
        variants.equal((CUBE, &text), cube_with(cube(), vec![rimmed.clone()]));
        let two = vec![
            of("inner", weak()).with_damping(rayleigh),
            of("outer", elastic()),
        ];
        let twin = run(cube_with(cut(width.max(50.0)), two));
        let simulation = cube_with(cube(), vec![rimmed]).prepare().unwrap();
        let told: Vec<String> = simulation.remarks().iter().map(Remark::to_string).collect();
        let rim = format!("rim of part 'rock': {elements} of its 216 elements");
        assert!(
            told.iter().any(|told| told.starts_with(&rim)),
            "{rim}: {told:?}"
        );
        assert!(
            !told
                .iter()
                .any(|told| told.contains("free field is elastic")),
            "{told:?}"
        );
        let found = simulation.run(Default::default()).unwrap();
        assert_eq!(found.histories(), twin.histories(), "{width}");
        // Rims have no history variables.
        let state = found.state.unwrap();
        assert_eq!(state.elements.len(), 216 - elements);
    }
    // Without a rim both have warnings.
    let bare = cube_with(cube(), vec![of("rock", weak()).with_damping(rayleigh)]);
    let simulation = bare.prepare().unwrap();
    let warned = simulation
        .remarks()
        .iter()
        .filter(|remark| matches!(remark, Remark::DampedRim(_) | Remark::NonlinearRim(_)));
    assert_eq!(warned.count(), 2);
}

/// A rim of a part far from the absorbing faces is an error, in a file at its value.
#[test]
fn a_rim_without_elements_is_refused() {
    let mesh = cut(100.0);
    let folder = Folder::new("rim-idle");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &mesh).unwrap();
    let part = "set = \"outer\"\nmaterial = \"granite\"\n";
    let text = CUBE.replace(
        "set = \"rock\"\nmaterial = \"granite\"\n",
        &format!("{part}[[part]]\nset = \"inner\"\nmaterial = \"granite\"\nelastic_rim = 20\n"),
    );
    let scene = FileScene::from_toml(text, folder.join("cube.toml"), &Registry::default()).unwrap();
    let Err(Error::Scene(fault)) = scene.prepare() else {
        panic!("an idle rim is accepted");
    };
    assert_eq!(fault.position(), (17, 15), "{fault}");
    let parts = [("inner", Some(20.0)), ("outer", None)].map(|(set, rim)| {
        let part = Part::new(set, elastic());
        match rim {
            Some(width) => part.with_rim(width),
            None => part,
        }
    });
    let Err(error) = cube_with(mesh, parts.to_vec()).prepare() else {
        panic!("an idle rim is accepted");
    };
    assert!(matches!(error, Error::EmptyRim { set, width: 20.0 } if set == "inner"));
    // A scene without absorbing faces has no rim either.
    let free = Scene::new("free", cube()).part(Part::new("rock", elastic()).with_rim(10.0));
    assert!(matches!(free.prepare(), Err(Error::EmptyRim { .. })));
}
