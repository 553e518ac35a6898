//! Layers by the equivalent linear method.

use std::sync::Arc;

use powerhouse::model::{ElasticMedium, FieldMotion, IncidentField, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, WaveKind,
};
use powerhouse::{EquivalentLayer, Remark, RunHooks, Scene, remark};

use super::{SITE, read};

/// A scene with keys of its layers of clay and of gravel, and with other passages replaced.
fn site(clay: &str, gravel: &str, others: &[(&str, &str)]) -> String {
    let mut text = SITE.to_owned();
    let clay = format!("bottom = -20\n{clay}\n#");
    let gravel = format!("bottom = -40\n{gravel}\n");
    let own = [
        ("bottom = -20 ", clay.as_str()),
        ("bottom = -40\n", &gravel),
    ];
    for (old, new) in own.iter().chain(others) {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    text
}

/// The layers of the remark, number of iterations and last change.
pub(super) fn figures(scene: &Scene) -> (Vec<EquivalentLayer>, usize, f64) {
    let found = scene.remarks().iter().find_map(|remark| match remark {
        Remark::EquivalentLinear(remark::EquivalentLinear {
            layers,
            iterations,
            change,
            ..
        }) => Some((layers.clone(), *iterations, *change)),
        _ => None,
    });
    found.expect("a remark")
}

/// Curves of one modulus and damping at all strains.
fn constant(modulus: f64, damping: f64) -> String {
    format!(
        "strain_curves = {{ kind = \"points\", strain = [1e-12, 1e-11, 0.1], modulus = [1, {modulus:?}, {modulus:?}], damping_ratio = [{damping:?}, {damping:?}, {damping:?}] }}"
    )
}

const CLAY: &str = "strain_curves = { kind = \"points\", strain = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2], modulus = [1, 0.97, 0.75, 0.3, 0.08], damping_ratio = [0.012, 0.018, 0.045, 0.12, 0.19] }";
const GRAVEL: &str = "strain_curves = { kind = \"darendeli\", plasticity = 0, pressure = 2e5 }";

/// In ground of one medium the strain is that of plane waves in a half-space, of any kind and angle, from their stress.
#[test]
fn strains_are_those_of_plane_waves() {
    let rock = ElasticMedium::new(5e9, 0.37, 2300.0).unwrap();
    let soft = "young = 5e9\npoisson = 0.37\ndensity = 2300\n#";
    for (kind, name, degrees) in [
        (WaveKind::SV, "sv", 15.0),
        (WaveKind::SH, "sh", 40.0),
        (WaveKind::P, "p", 30.0),
    ] {
        let incidence = format!("kind = \"{name}\"\nincidence = {degrees} ");
        let text = site(
            &constant(1.0, 0.0),
            "",
            &[
                ("young = 0.2e9\npoisson = 0.4\ndensity = 1800", soft),
                ("young = 0.9e9\npoisson = 0.4\ndensity = 2000", soft),
                ("kind = \"sv\"\nincidence = 15 ", &incidence),
            ],
        );
        let scene = read(&text).unwrap();
        let (layers, iterations, _) = figures(&scene);
        assert_eq!(iterations, 1);
        let [layer] = &layers[..] else {
            panic!("one layer");
        };
        assert_eq!((layer.modulus, layer.damping), (1.0, 0.0));

        let own = scene.layered_waves()[0].parameters().clone();
        let mut parameters = PlaneWaveParameters::vertical(kind, rock, 0.0);
        parameters.incidence = Angle::from_degrees(degrees);
        parameters.reference = own.reference;
        parameters.arrival = own.arrival;
        let pulse = Ricker::new(RickerQuantity::Displacement, 0.01, 3.0, 0.0).unwrap();
        // The pulse of a scene begins at its arrival.
        let start = powerhouse::wavefield::Signal::support(&pulse).start;
        parameters.arrival -= start;
        let wave = PlaneWave::new(parameters, Arc::new(pulse)).unwrap();
        let (low, high) = scene.mesh().bounding_box();
        let middle = Vec3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), -10.0);
        let sampler = wave.prepare(&[middle]).unwrap();
        let mut greatest = 0.0_f64;
        for sample in 0..6000 {
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(5e-4 * f64::from(sample), &mut motion);
            let [x, y, z, xy, yz, zx] = motion[0].stress.0;
            let stress = nalgebra::Matrix3::new(x, xy, zx, xy, y, yz, zx, yz, z);
            let principal = stress.symmetric_eigenvalues();
            greatest = greatest.max((principal.max() - principal.min()) / (2.0 * rock.shear()));
        }
        // Engineering strain is twice the difference over 2 G halves: (s1 - s3) / (2 G) is e1 - e3.
        let expected = 0.65 * greatest;
        let off = layer.strain / expected - 1.0;
        assert!(off.abs() < 2e-3, "{name}: {} {expected}", layer.strain);
    }
}

/// A motion that softens the clay by a quarter.
const MODERATE: (&str, &str) = ("displacement = 0.01", "displacement = 0.0003");

/// Modulus and damping are those of the curves at the effective strain, which is the strain of ground with that modulus and damping;
/// parts and layers have them alike, and the bulk modulus of small strain.
#[test]
fn iterations_end_at_a_fixed_point() {
    let scene = read(&site(CLAY, GRAVEL, &[MODERATE])).unwrap();
    let (layers, iterations, change) = figures(&scene);
    assert!(
        (2..20).contains(&iterations) && change <= 0.01,
        "{iterations} {change}"
    );
    let [clay, gravel] = &layers[..] else {
        panic!("two layers");
    };
    println!("figure equivalent_linear.clay {clay:?} after {iterations} iterations");
    assert!((0.1..0.9).contains(&clay.modulus), "{clay:?}");
    assert!((0.5..1.0).contains(&gravel.modulus), "{gravel:?}");
    // Interpolated by hand between the points of the curves, in the decade of the strain.
    let decade = clay.strain.log10();
    let (index, share) = (decade.floor(), decade - decade.floor());
    let at = |values: [f64; 5]| {
        let below = (index + 6.0) as usize;
        values[below] + share * (values[below + 1] - values[below])
    };
    assert!((clay.modulus / at([1.0, 0.97, 0.75, 0.3, 0.08]) - 1.0).abs() < 0.0101);
    assert!((clay.damping / at([0.012, 0.018, 0.045, 0.12, 0.19]) - 1.0).abs() < 0.0101);

    let known = [clay, gravel].map(|of| constant(of.modulus, of.damping));
    let again = read(&site(&known[0], &known[1], &[MODERATE])).unwrap();
    for (first, second) in layers.iter().zip(figures(&again).0) {
        let off = second.strain / first.strain - 1.0;
        assert!(off.abs() < 1e-6, "{first:?} {second:?}");
    }

    let ground = &scene.layered_waves()[0].parameters().ground;
    let medium = ground.medium_at(-10.0);
    let whole = ElasticMedium::new(0.2e9, 0.4, 1800.0).unwrap();
    assert!((medium.shear() / whole.shear() / clay.modulus - 1.0).abs() < 1e-9);
    assert!((medium.bulk() / whole.bulk() - 1.0).abs() < 1e-9);
    // A stricter tolerance ends nearer.
    let strict =
        "[ground]\nequivalent_linear = { tolerance = 1e-5, iterations = 60 }\n\n[[support]]";
    let strict = read(&site(CLAY, GRAVEL, &[MODERATE, ("[[support]]", strict)])).unwrap();
    let (finer, more, last) = figures(&strict);
    assert!(more > iterations && last <= 1e-5);
    assert!((finer[0].strain / clay.strain - 1.0).abs() < 0.03);
}

/// The surface of the box moves as the field of the softened layers, whose motion is not that of small strain.
#[test]
fn a_box_moves_like_its_equivalent_layers() {
    let surface = |scene: &Scene, times: &[f64]| -> Vec<f64> {
        let sampler = scene.layered_waves()[0]
            .prepare(&[Vec3::new(0.0, 2.0, 0.0)])
            .unwrap();
        let at = |time: &f64| {
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(*time, &mut motion);
            motion[0].displacement.x
        };
        times.iter().map(at).collect()
    };
    let scene = read(&site(CLAY, GRAVEL, &[MODERATE])).unwrap();
    let softened = scene.layered_waves()[0].clone();
    let small = read(&site("", "", &[MODERATE])).unwrap();
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let times = results.histories().times.clone();
    let column = results.histories().column("surface.ux").unwrap();
    let again = read(&site(CLAY, GRAVEL, &[MODERATE])).unwrap();
    assert_eq!(
        softened.parameters().arrival,
        again.layered_waves()[0].parameters().arrival
    );
    let error = |field: &[f64]| {
        let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
        let off = squares(&mut field.iter().zip(&column.values).map(|(a, b)| a - b));
        (off / squares(&mut field.iter().copied())).sqrt()
    };
    let own = error(&surface(&again, &times));
    let of_small_strain = error(&surface(&small, &times));
    println!("figure equivalent_linear.box {own:.4}, small strain {of_small_strain:.3}");
    assert!(own < 0.06, "{own}");
    assert!(of_small_strain > 0.2, "{of_small_strain}");
}

/// Ground at rest has the moduli of small strain, whatever the motion makes of them: stages settle as without curves, and
/// stages that name a material have that.
#[test]
fn stages_have_the_moduli_of_small_strain() {
    let settled = |clay: &str, of_stage: &str| {
        let stage = format!(
            "[[load]]\nkind = \"gravity\"\n[[stage]]\nname = \"rest\"\n{of_stage}support = [{{ kind = \"roller\", set = \"left\" }}, {{ kind = \"roller\", set = \"right\" }}, {{ kind = \"roller\", set = \"bottom\" }}]\n[boundary]"
        );
        let text = site(clay, "", &[("[boundary]", &stage), MODERATE]);
        let simulation = read(&text).unwrap().prepare().unwrap();
        let body = simulation.equilibrate(None, None).unwrap().unwrap();
        body.stages()[0].largest_displacement.0
    };
    let elastic = settled("", "");
    let own = settled(CLAY, "");
    assert!((own / elastic - 1.0).abs() < 1e-9, "{own} {elastic}");
    let other = settled(CLAY, "part = [{ set = \"clay\", material = \"gravel\" }]\n");
    assert!(other < 0.8 * elastic, "{other} {elastic}");
}

/// The run begins in equilibrium, with the stress of the stages and the moduli of the motion: until the wave arrives nothing moves,
/// and stress is the weight above.
#[test]
fn a_run_begins_at_rest_under_the_weight_of_soft_ground() {
    let stage = "[[load]]\nkind = \"gravity\"\n[[stage]]\nname = \"rest\"\nsupport = [{ kind = \"roller\", set = \"left\" }, { kind = \"roller\", set = \"right\" }, { kind = \"roller\", set = \"bottom\" }]\n[boundary]";
    let below = "[[output.history]]\nname = \"below\"\nat = [2, 2, -10]\nquantities = [\"stress\"]\n[[output.history]]\nname = \"surface\"";
    let still = ("displacement = 0.01", "displacement = 0.0003");
    let text = site(
        CLAY,
        GRAVEL,
        &[
            ("[boundary]", stage),
            still,
            ("duration = 3", "duration = 2.5"),
            ("[[output.history]]\nname = \"surface\"", below),
        ],
    );
    let scene = read(&text).unwrap();
    let (layers, ..) = figures(&scene);
    assert!(layers[0].modulus < 0.9, "{layers:?}");
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let column = |name: &str| results.histories().column(name).unwrap().values.clone();
    let (moved, stress) = (column("surface.ux"), column("below.zz"));
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // The wave comes after 0.2 s; its motion is a thousand times what the start may move.
    let early = results
        .histories()
        .times
        .iter()
        .take_while(|time| **time < 0.05)
        .count();
    assert!(early > 3 && most(&moved[..early]) < 1e-3 * most(&moved));
    let vertical = column("surface.uz");
    assert!(
        most(&vertical[..early]) < 1e-3 * most(&moved),
        "{}",
        most(&vertical[..early])
    );
    // The centre of the element lies 10 m deep, to half of an element.
    let weight = 1800.0 * 9.81 * 10.0;
    assert!(
        (stress[0] / -weight - 1.0).abs() < 0.02,
        "{} {weight}",
        stress[0]
    );
}

/// What the method cannot have is refused at its key; strains beyond the curves are warned of.
#[test]
fn what_does_not_fit_the_method_is_refused() {
    let refused = |clay: &str, others: &[(&str, &str)], wanted: &str| {
        let told = read(&site(clay, "", others)).err();
        let told = told
            .unwrap_or_else(|| panic!("{clay} was accepted"))
            .to_string();
        assert!(told.contains(wanted), "{clay}: {told}");
    };
    let damped = format!("{CLAY}\ndamping = {{ kind = \"flat\", ratio = 0.02, band = [0.5, 20] }}");
    refused(&damped, &[], "that of the curves");
    let part = "set = \"clay\"\ndamping = \"none\"";
    refused(CLAY, &[("set = \"clay\"", part)], "no damping of a part");
    let plastic = "law = \"mohr-coulomb\"\npreset = \"paper-rock\"\n#";
    let elastic = "law = \"elastic\"\nyoung = 0.2e9\npoisson = 0.4\ndensity = 1800";
    let plastic = plastic.replace('#', "# young = 0.2e9");
    refused(CLAY, &[(elastic, &plastic)], "the law 'mohr-coulomb'");
    let same = [(
        "material = \"gravel\"\nbottom",
        "material = \"clay\"\nbottom",
    )];
    refused(CLAY, &same, "a material of its own");
    let half_space = format!("material = \"rock\"\n{CLAY}\n\n[[support]]");
    refused(
        "",
        &[("material = \"rock\"\n\n[[support]]", &half_space)],
        "a half-space of one modulus",
    );
    for (curves, wanted) in [
        (
            "{ kind = \"points\", strain = [1e-4, 1e-5], modulus = [1, 0.9], damping_ratio = [0.01, 0.02] }",
            "strain",
        ),
        (
            "{ kind = \"points\", strain = [1e-5, 1e-4], modulus = [1], damping_ratio = [0.01, 0.02] }",
            "modulus",
        ),
        (
            "{ kind = \"points\", strain = [1e-5], modulus = [1.2], damping_ratio = [0.01] }",
            "at most 1",
        ),
        (
            "{ kind = \"darendeli\", plasticity = 300, pressure = 1e5 }",
            "plasticity",
        ),
        (
            "{ kind = \"points\", strain = [1e-9], modulus = [1], damping_ratio = [0.3] }",
            "at most 0.2",
        ),
        ("{ kind = \"seed\" }", "'seed' is not permitted"),
    ] {
        refused(&format!("strain_curves = {curves}"), &[], wanted);
    }
    let ground =
        |settings: &str| format!("[ground]\nequivalent_linear = {settings}\n\n[[support]]");
    let few = ground("{ iterations = 1, tolerance = 1e-6 }");
    refused(
        CLAY,
        &[("[[support]]", &few)],
        "a change of modulus or damping",
    );
    let idle = ground("{ strain_ratio = 0.5 }");
    refused(
        "",
        &[("[[support]]", &idle)],
        "a layer with `strain_curves`",
    );

    let short = "strain_curves = { kind = \"points\", strain = [1e-7, 1e-6], modulus = [1, 0.9], damping_ratio = [0.01, 0.02] }";
    let scene = read(&site(short, "", &[])).unwrap();
    let warned = scene.remarks().iter().find(|remark| {
        matches!(remark, Remark::BeyondStrainCurves(remark::BeyondStrainCurves { material, .. }) if material == "clay")
    });
    assert!(warned.is_some_and(Remark::is_warning));
}
