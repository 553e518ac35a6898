//! Water in the pores of the ground: effective stress, stages and runs.

use powerhouse::engine::{PoreWater, WaterPressure};
use powerhouse::material::{
    Control, ElastoPlastic, MohrCoulomb, MohrCoulombParameters, PointDriver,
};
use powerhouse::model::{ElasticMedium, PointAdapter, Stress, Vec3};
use powerhouse::{FileScene, InSituStress, Material, Registry, Remark, WeightLayer};

use super::stages::{MATERIALS, ROLLERS, TRENCH, folder, mesh, read};
use super::support::{CUBE, ELASTIC, Variants, run};

/// Undrained triaxial compression ends where the effective mean stress of an elastic path meets the surface, for any share of
/// the water; pressure and strength have closed forms.
#[test]
fn undrained_strength_is_that_of_the_effective_path() {
    let medium = ElasticMedium::new(40e6, 0.25, 2000.0).unwrap();
    let (friction, cohesion) = (30.0_f64, 5e3);
    let surface = MohrCoulomb::new(MohrCoulombParameters {
        medium,
        friction,
        dilation: 0.0,
        cohesion,
        tension_strength: None,
    })
    .unwrap();
    let dry = Material::from(ElastoPlastic::new(surface));
    for (bulk_modulus, pressure) in [(2.2e9, 100e3), (1e7, 100e3), (2.2e9, 250e3)] {
        let water = PoreWater::new(bulk_modulus, 0.4).unwrap();
        let law = PointAdapter::new(dry.with_pore_water(water.clone()).law().clone());
        let start = Stress([-pressure, -pressure, -pressure, 0.0, 0.0, 0.0]);
        let mut point = PointDriver::new(law).with_initial(start).unwrap();
        let states = point
            .advance(Control::triaxial(-pressure, -0.05), 400)
            .unwrap();
        // q = M (p' + c cot phi), p' = p0 + q r / 3.
        let sine = friction.to_radians().sin();
        let slope = 6.0 * sine / (3.0 - sine);
        let share = medium.bulk() / (medium.bulk() + water.stiffness());
        let strength = slope * (pressure + cohesion / friction.to_radians().tan())
            / (1.0 - slope * share / 3.0);
        let last = states.last().unwrap();
        let shear = last.stress.0[0] - last.stress.0[2];
        assert!((shear / strength - 1.0).abs() < 1e-8, "{shear} {strength}");
        // Two thirds of the deviator are shear; the pressure is the rest of its mean.
        let excess = *last.history.last().unwrap();
        let expected = (1.0 - share) * strength / 3.0;
        assert!(
            (excess / expected - 1.0).abs() < 1e-8,
            "{excess} {expected}"
        );
    }
}

/// The waves and the run of saturated elastic ground are those of its undrained medium.
#[test]
fn saturated_ground_moves_as_its_undrained_medium() {
    let variants = Variants::new("saturated");
    let skeleton = ElasticMedium::new(9e9, 0.27, 2750.0).unwrap();
    let undrained = PoreWater::new(2.2e9, 0.15).unwrap().undrained(&skeleton);
    let waves = CUBE.replace("kind = \"sv\"", "kind = \"p\"");
    let wet = waves.replacen(
        ELASTIC,
        &format!("{ELASTIC}pore_water = {{ porosity = 0.15 }}\n"),
        1,
    );
    let (young, poisson) = (undrained.young, undrained.poisson);
    let stiff = format!(
        "law = \"elastic\"\nyoung = {young:.17e}\npoisson = {poisson:.17}\ndensity = 2750\n"
    );
    let stiff = waves.replacen(ELASTIC, &stiff, 1);
    assert!(wet != waves && stiff != waves);
    let [wet, stiff, dry] =
        [&wet, &stiff, &waves].map(|text| run(variants.read_text(text).unwrap()));
    let column = |results: &powerhouse::Results, name: &str| {
        results.histories().column(name).unwrap().values.clone()
    };
    let mut largest = 0.0_f64;
    for name in ["surface.ux", "surface.uy", "surface.uz"] {
        let [wet, stiff, dry] = [&wet, &stiff, &dry].map(|results| column(results, name));
        let peak = stiff
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        for ((wet, stiff), dry) in wet.iter().zip(&stiff).zip(&dry) {
            assert!((wet - stiff).abs() < 1e-7 * peak, "{name}: {wet} {stiff}");
            largest = largest.max((wet - dry).abs() / peak);
        }
    }
    assert!(largest > 0.05, "{largest}");
}

const WATER: &str = "pore_water = { porosity = 0.3, level = 9 }\n";

/// Stages in ground below a water level are drained and have the displacements of the dry skeleton; the run begins at rest and
/// nothing moves, with rock that has yielded in the stages, too.
#[test]
fn a_body_stays_at_rest_after_drained_stages() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, ROLLERS, TRENCH].concat();
    let text = text
        .replace("at = [2, 4, 12]", "at = [5, 4, 8]")
        .replace("bolts = [\"nail\"]\n", "");
    let text = text.replace("bolts = [\"anchors\"]\n", "");
    let text = text.replace("lateral = 0.5\n", "lateral = 0.5\nwater = { level = 9 }\n");
    // Bricks whose bending has moduli of its own have those of the undrained medium.
    let text = text.replace(
        "material = \"rock\"\n",
        "material = \"rock\"\nkernel = \"hex8-full\"\n",
    );
    let rock = "poisson = 0.25\ndensity = 2600\n";
    let wet = |text: &str| text.replacen(rock, &format!("{rock}{WATER}"), 1);
    let weak = "law = \"mohr-coulomb\"\ncohesion = 3e3\nfriction = 26\ntensile_strength = 1e3\n";
    let weak = text.replacen("law = \"elastic\"\n", weak, 1);
    let weak = weak.replace("pressure = 2e4", "pressure = 2e3");
    let dry = run(read(&folder, &text).unwrap());
    let (elastic, yielding) = (wet(&text), wet(&weak));
    for text in [&elastic, &yielding] {
        let found = run(read(&folder, text).unwrap());
        let settled = found.stages[1].largest_displacement.0;
        let of_dry = dry.stages[1].largest_displacement.0;
        if text == &elastic {
            assert!((settled / of_dry - 1.0).abs() < 1e-6, "{settled} {of_dry}");
            // The solver knows that the water is drained: a law is corrected at least twice, Hooke's once.
            for (wet, dry) in found.stages.iter().zip(&dry.stages) {
                let [wet, dry] = [wet, dry].map(|stage| stage.solution.products);
                assert!(wet <= 3 * dry, "{wet} products for {dry}");
            }
        } else {
            assert!(settled > 1.0001 * of_dry, "{settled} {of_dry}");
        }
        for component in ["ux", "uy", "uz", "vx", "vy", "vz"] {
            let column = found.histories().column(&format!("corner.{component}"));
            let values = &column.unwrap().values;
            let most = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            assert!(most < 1e-10, "{component}: {most:e}");
        }
        assert!(found.hand_over.unwrap().difference < 1e-9);
    }
}

/// A water level needs an in-situ stress; parameters outside their range, and strain curves, are refused by place; the scene
/// says what the water does.
#[test]
fn water_in_pores_is_refused_by_name_and_described() {
    let variants = Variants::new("pore-water");
    let with = |water: &str| variants.read(ELASTIC, &format!("{ELASTIC}pore_water = {water}\n"));
    let refused = |water: &str| with(water).err().unwrap().to_string();
    let level = refused("{ porosity = 0.2, level = -5 }");
    assert!(
        level.contains("a water level in a scene without [in_situ_stress]"),
        "{level}"
    );
    for (water, wanted) in [
        ("{ porosity = 0 }", "above 0 and at most 1"),
        ("{ porosity = 1.2 }", "above 0 and at most 1"),
        ("{ level = -5 }", "porosity"),
        ("{ porosity = 0.2, bulk_modulus = -1 }", "a number above 0"),
        ("{ porosity = 0.2, permeability = 0 }", "a number above 0"),
        ("{ porosity = 0.2, conductivity = 1e-6 }", "conductivity"),
    ] {
        let message = refused(water);
        assert!(message.contains(wanted), "{water}: {message}");
    }
    let scene = with("{ porosity = 0.2 }").unwrap();
    let fact = scene
        .remarks()
        .iter()
        .find(|remark| matches!(remark, Remark::PoreWater(_)));
    let fact = fact.unwrap();
    assert!(!fact.is_warning());
    let text = fact.to_string();
    for wanted in [
        "'granite'",
        "1.100e10 Pa",
        "drained 2022 m/s",
        "in the run no water flows",
    ] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
}

/// With a permeability the scene says how far pressure spreads during the run, and warns where much of it would flow away.
#[test]
fn the_time_of_consolidation_is_compared_with_the_run() {
    let variants = Variants::new("seepage");
    let remark = |permeability: f64| {
        let water = format!("pore_water = {{ porosity = 0.2, permeability = {permeability:e} }}\n");
        let scene = variants
            .read(ELASTIC, &format!("{ELASTIC}{water}"))
            .unwrap();
        let mut remarks = scene.remarks().iter();
        let found = remarks.find(|remark| matches!(remark, Remark::PoreWater(_)));
        found.unwrap().clone()
    };
    let skeleton = ElasticMedium::new(9e9, 0.27, 2750.0).unwrap();
    let modulus = skeleton.p_speed().powi(2) * 2750.0;
    // Half of the cube is the way; sqrt(4 T / pi) = 10 % of it at the limit.
    let limit = core::f64::consts::PI / 400.0 * 150.0 * 150.0 / 0.6 * 9810.0 / modulus;
    for (share, warns) in [(1e-6, false), (0.98, false), (1.02, true), (1e3, true)] {
        let found = remark(share * limit);
        assert_eq!(found.is_warning(), warns, "{found}");
        let Remark::PoreWater(material) = &found else {
            panic!("{found}");
        };
        let seepage = material.seepage.unwrap();
        let distance = (share * limit * modulus / 9810.0 * 0.6).sqrt();
        assert!((seepage.distance() / distance - 1.0).abs() < 1e-12);
        let expected = (0.1 * share.sqrt()).min(1.0);
        assert!((seepage.share() / expected - 1.0).abs() < 1e-12, "{found}");
        let text = found.to_string();
        assert_eq!(
            text.contains("the ground is not undrained"),
            warns,
            "{text}"
        );
        assert!(text.contains("from a body of 300 m"), "{text}");
    }
}

/// In-situ stress of ground with water is total: its vertical part is the weight, and K0 holds between effective stresses, in
/// each layer; above the level and without water nothing changes.
#[test]
fn lateral_ratios_hold_between_effective_stresses() {
    let folder = folder(&mesh());
    let registry = Registry::default();
    let at = |keys: &str, z: f64| -> [f64; 3] {
        let text = [MATERIALS, ROLLERS].concat();
        let old = "kind = \"ground\"\nlevel = 12\ndensity = 2600\nlateral = 0.5\n";
        assert!(text.contains(old));
        let text = text.replace(old, keys);
        let path = folder.join("trench.toml");
        let scene = FileScene::from_toml(text, path, &registry).unwrap();
        let point = Vec3::new(1.0, 1.0, z);
        let stress = match scene.in_situ_stress() {
            Some(InSituStress::Layers(fields)) => {
                let mut below = fields.iter().rev();
                below.find(|field| z <= field.surface).unwrap().at(&point)
            }
            other => panic!("{other:?}"),
        };
        [stress.0[0], stress.0[1], stress.0[2]]
    };
    let layered = "kind = \"layers\"\nlevel = 12\nlayers = [{ bottom = 6, density = 2000, lateral = 0.5 }, \
                   { density = 2200, lateral = 0.8, lateral_y = 1.1 }]\nwater = { level = 8.4 }\n";
    let one =
        "kind = \"ground\"\nlevel = 12\ndensity = 2000\nlateral = 0.5\nwater = { level = 8.4 }\n";
    let g = 9.81;
    for z in [11.0, 9.0, 7.0] {
        let vertical = -2000.0 * g * (12.0 - z);
        let pressure = 1000.0 * g * (8.4_f64 - z).max(0.0);
        let side = 0.5 * (vertical + pressure) - pressure;
        for keys in [one, layered] {
            let found = at(keys, z);
            for (found, expected) in found.into_iter().zip([side, side, vertical]) {
                assert!((found - expected).abs() < 1e-6, "{z}: {found} {expected}");
            }
        }
    }
    for z in [5.0, 1.0] {
        let vertical = -g * (2000.0 * 6.0 + 2200.0 * (6.0 - z));
        let pressure = 1000.0 * g * (8.4 - z);
        let [x, y] = [0.8, 1.1].map(|share| share * (vertical + pressure) - pressure);
        let found = at(layered, z);
        for (found, expected) in found.into_iter().zip([x, y, vertical]) {
            assert!((found - expected).abs() < 1e-6, "{z}: {found} {expected}");
        }
    }
    // A level above the ground presses on it, and not beyond the pores.
    let layer = WeightLayer {
        bottom: f64::NEG_INFINITY,
        unit_weight: 2e4,
        lateral: [0.5, 0.5],
    };
    let lake = WaterPressure::hydrostatic(3.0, 1e4).unwrap();
    let flooded = InSituStress::layers_in_water(0.0, &[layer], &lake).unwrap();
    let InSituStress::Layers(fields) = flooded else {
        panic!("layers")
    };
    assert_eq!(fields.len(), 1);
    assert_eq!(
        fields[0].at(&Vec3::new(0.0, 0.0, -2.0)).0[..3],
        [-45e3, -45e3, -40e3]
    );
}
