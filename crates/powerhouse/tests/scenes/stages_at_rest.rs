//! Static equilibrium of stages: methods, in-situ stress, damping, and failure to converge.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse::engine::{StageReport, StaticProgress, StressField};
use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{
    CompletedStage, Error, InSituStress, Remark, Results, RunHooks, Scene, StageSink, remark,
};

use super::stages::{BOLTS, MATERIALS, ROLLERS, TRENCH, folder, mesh, read};
use super::support::{Folder, run};

/// Parts with flat damping have their static stiffness in the stages, and the stress of the stages does not relax: without
/// input the body does not move, with cracked rock either, and its mechanisms dissipate nothing.
#[test]
fn what_stages_leave_does_not_relax() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, BOLTS, ROLLERS, TRENCH].concat();
    let text = text.replace("at = [2, 4, 12]", "at = [5, 4, 8]");
    // The law alone: hourglass resistance does not depend on frequency.
    let full = "material = \"rock\"\nkernel = \"hex8-full\"\n[[part]]";
    let text = text.replace("material = \"rock\"\n[[part]]", full);
    let weak = "law = \"mohr-coulomb\"\ncohesion = 3e4\nfriction = 30\ntensile_strength = 1e3\n";
    let weak = text.replacen("law = \"elastic\"\n", weak, 1);
    for text in [&text, &weak] {
        let damped = |reference: &str| {
            let damping = format!(
                "kernel = \"hex8-full\"\ndamping = {{ kind = \"flat\", ratio = 0.05, band = [0.5, 20], \
                 reference = {reference} }}\n"
            );
            let damped = text.replace("kernel = \"hex8-full\"\n", &damping);
            assert_ne!(&damped, text);
            run(read(&folder, &damped.replace("duration = 0.4", "duration = 2")).unwrap())
        };
        let undamped = run(read(&folder, text).unwrap());
        let (centre, at_rest) = (damped("\"centre\""), damped("\"static\""));
        let settled = |results: &Results| results.stages[1].largest_displacement.0;
        let [centred, rested, usual] = [&centre, &at_rest, &undamped].map(settled);
        assert!((rested / usual - 1.0).abs() < 1e-6, "{rested} {usual}");
        assert!(centred > 1.1 * usual, "{centred} {usual}");
        for found in [&centre, &at_rest] {
            for component in ["ux", "uy", "uz", "vx", "vy", "vz"] {
                let column = found.histories().column(&format!("corner.{component}"));
                let values = &column.unwrap().values;
                let most = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                assert!(most < 1e-10, "{component}: {most:e}");
            }
            assert!(found.hand_over.unwrap().difference < 1e-9);
        }
    }
}

/// Raises a flag as soon as a stage begins.
struct Raise(Arc<AtomicBool>);

impl StageSink for Raise {
    fn progress(&mut self, stage: &str, _progress: StaticProgress) {
        assert_eq!(stage, "trench");
        self.0.store(true, Ordering::Relaxed);
    }
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        panic!("{} has reached static equilibrium", stage.report.name)
    }
}

/// A cancellation flag that is raised during a stage ends the run at once.
#[test]
fn a_stage_may_be_interrupted() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let first = ROLLERS.replace(
        "\"ground\"",
        "\"trench\"\nexcavate = [\"trench\"]\nincrements = 5",
    );
    let first = first.replace("part = [{ set = \"lining\", material = \"rock\" }]\n", "");
    let text = [MATERIALS, &first].concat();
    let stop = Arc::new(AtomicBool::new(false));
    let hooks = RunHooks::default()
        .with_stop(stop.clone())
        .with_stages(Box::new(Raise(stop)));
    let ended = read(&folder, &text).unwrap().prepare().unwrap().run(hooks);
    assert!(
        matches!(&ended, Err(Error::Interrupted { stage }) if stage == "trench"),
        "{ended:?}"
    );
}

/// Every static method reaches the same equilibrium; one that this build does not include is an error with its
/// position.
#[test]
fn stages_come_to_the_same_rest_by_every_method() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, BOLTS, ROLLERS, TRENCH].concat();
    let by = |method: &str| {
        let key = format!("name = \"trench\"\nmethod = \"{method}\"\n");
        read(&folder, &text.replace("name = \"trench\"\n", &key))
    };
    let rest = |scene: Scene| run(scene).stages[1].clone();
    let usual = rest(by("conjugate-gradients").unwrap());
    assert!(usual.solution.products > 0);
    let same = |found: &StageReport| {
        let [a, b] = [found, &usual].map(|stage| stage.largest_displacement.0);
        assert!((a / b - 1.0).abs() < 1e-6, "{found:?} {usual:?}");
    };
    let relaxed = rest(by("dynamic-relaxation").unwrap());
    same(&relaxed);
    assert!(relaxed.solution.steps > 0);
    for method in ["cholesky", "newton"] {
        if cfg!(feature = "direct") {
            let direct = rest(by(method).unwrap());
            same(&direct);
            assert!(direct.solution.factorisations > 0 && direct.solution.products == 0);
        } else {
            let refused = by(method).err().unwrap().to_string();
            assert!(refused.contains("this build does not include"), "{refused}");
        }
    }
}

/// The in-situ stress may be given by a table of all elements, with rows and columns in any order and in kPa; a fault is
/// reported with element or column.
#[test]
fn the_stress_of_the_ground_comes_from_a_table() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let field = StressField::geostatic(12.0, 2600.0 * 9.81, [0.5, 0.8]).unwrap();
    let stresses = field.of_elements(&mesh);
    let mut rows: Vec<String> = (mesh.element_tags().iter().zip(&stresses))
        .map(|(tag, stress)| {
            let [xx, yy, zz, xy, yz, zx] = stress.0.map(|s| s / 1e3);
            format!("{zz:e},{yy:e},{xx:e},{tag},{xy:e},{yz:e},{zx:e}\n")
        })
        .collect();
    rows.reverse();
    let header = "zz [kPa],yy [kPa],xx [kPa],element [1],xy [kPa],yz [kPa],zx [kPa]\n";
    let file = folder.join("stress.csv");
    let put = |header: &str, rows: &[String]| {
        std::fs::write(&file, format!("{header}{}", rows.concat())).unwrap();
        InSituStress::read(&file, &mesh)
    };
    let InSituStress::Elements(found) = put(header, &rows).unwrap() else {
        panic!("no elements")
    };
    for (found, stress) in found.iter().zip(&stresses) {
        for i in 0..6 {
            assert!((found.0[i] - stress.0[i]).abs() <= 1e-15 * stress.0[i].abs());
        }
    }
    let table = "[in_situ_stress]\nkind = \"elements\"\nfile = \"stress.csv\"\n";
    let ground = "[in_situ_stress]\nkind = \"ground\"\nlevel = 12\ndensity = 2600\nlateral = 0.5\n";
    let text = [MATERIALS, ROLLERS, TRENCH].concat();
    let text = text.replace("bolts = [\"nail\"]\n", "");
    let text = text.replace("bolts = [\"anchors\"]\n", "");
    let with_y = format!("{ground}lateral_y = 0.8\n");
    let by_field = run(read(&folder, &text.replace(ground, &with_y)).unwrap());
    let by_table = run(read(&folder, &text.replace(ground, table)).unwrap());
    for (a, b) in by_field.stages.iter().zip(&by_table.stages) {
        let [a, b] = [a, b].map(|stage| stage.largest_displacement.0);
        // Within its elements the stress of the table does not vary with height as that of the ground does.
        assert!((a - b).abs() < 5e-3 * a + 1e-12, "{a} {b}");
    }
    let told = |header: &str, rows: &[String], passages: &[&str]| {
        let fault = put(header, rows).unwrap_err().to_string();
        for passage in passages {
            assert!(fault.contains(passage), "{fault}");
        }
    };
    told(
        &header.replace("xy [kPa]", "xy [psi]"),
        &rows,
        &["stress.csv", "'xy'", "[psi]"],
    );
    told(
        &header.replace("yz [kPa]", "zy [kPa]"),
        &rows,
        &["no column 'yz'"],
    );
    told(
        header,
        &rows[1..],
        &[
            "1 elements",
            &format!("element {}", mesh.element_tags().last().unwrap()),
        ],
    );
    let twice = [&rows[..], &rows[..1]].concat();
    told(header, &twice, &["twice"]);
    let tag = format!(",{},", mesh.element_tags()[3]);
    let of_row = |to: &str| {
        rows.iter()
            .map(|row| row.replace(&tag, to))
            .collect::<Vec<_>>()
    };
    told(
        header,
        &of_row(",99999,"),
        &["element 99999 is not in the mesh"],
    );
    told(
        header,
        &of_row(",2.5,"),
        &["element 2.5 is not in the mesh"],
    );
    let mut odd = rows.clone();
    odd[0] = format!("nan{}", &odd[0][odd[0].find(',').unwrap()..]);
    told(header, &odd, &["not finite"]);
}

/// Sink that records the stress of every element (Pa) with the height of its centroid (m).
#[derive(Clone, Default)]
struct Stresses(Arc<std::sync::Mutex<Vec<StressAtHeight>>>);

/// A height (m) and the stress there (Pa).
type StressAtHeight = (f64, [f64; 6]);

impl StageSink for Stresses {
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        let elements = stage.stress.iter().enumerate();
        let of = elements.map(|(e, stress)| (stage.mesh.centroid(e as u32).z, stress.0));
        *self.0.lock().unwrap() = of.collect();
        Ok(())
    }
}

/// The geostatic stress is zero above its level, as for joints: elements above, supported at their sides, have the
/// horizontal stress nu / (1 - nu) of their weight alone, elements below keep their ratio in addition. A body that
/// reaches above the level has a warning, one below has none.
#[test]
fn ground_has_no_stress_above_its_level() {
    const NU: f64 = 0.25;
    const LATERAL: f64 = 0.5;
    const WEIGHT: f64 = 2600.0 * 9.81;
    for (height, level) in [(60.0, 30.0), (40.0, 8.0), (60.0, 60.0), (20.0, 50.0)] {
        let folder = Folder::new("level");
        let high = Vec3::new(4.0, 4.0, height);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [1, 1, 10], "rock").unwrap();
        write_gmsh(folder.join("trench.msh"), &mesh).unwrap();
        let mut text = format!(
            "title = \"level\"\nmesh = {{ file = \"trench.msh\" }}\n\
             material = [{{ name = \"rock\", law = \"elastic\", young = 2e9, poisson = {NU}, density = 2600 }}]\n\
             part = [{{ set = \"rock\", material = \"rock\" }}]\nload = [{{ kind = \"gravity\" }}]\n\
             in_situ_stress = {{ kind = \"ground\", level = {level}, density = 2600, lateral = {LATERAL} }}\n\
             time = {{ duration = 0.01 }}\nstage = [{{ name = \"ground\" }}]\n"
        );
        for face in ["left", "right", "front", "back", "bottom"] {
            text += &format!("[[support]]\nkind = \"roller\"\nset = \"{face}\"\n");
        }
        let simulation = read(&folder, &text).unwrap().prepare().unwrap();
        let warned = simulation.remarks().iter().any(|remark| {
            matches!(remark, Remark::AboveGround(remark::AboveGround { level: at, top })
                if *at == level && *top == height && remark.is_warning())
        });
        assert_eq!(warned, level < height);
        let stresses = Stresses::default();
        simulation
            .equilibrate(None, Some(Box::new(stresses.clone())))
            .unwrap();
        // The weight above an element: what its own ground left out, elastic under fixed sides.
        for (z, stress) in stresses.0.lock().unwrap().iter() {
            let own = WEIGHT * (level - z).max(0.0);
            let all = WEIGHT * (height - z);
            let lateral = LATERAL * own + NU / (1.0 - NU) * (all - own);
            for (found, expected) in [
                (stress[2], -all),
                (stress[0], -lateral),
                (stress[1], -lateral),
            ] {
                // The level cuts no element, or the middle of one half below it.
                let error = (found - expected).abs() / (WEIGHT * height);
                assert!(error < 1e-6, "{level} {z}: {found} {expected}");
            }
        }
    }
}

/// Layers of ground are in equilibrium under their weights: vertical stress is the weight above, horizontal stress the share
/// of its layer, and nothing moves.
#[test]
fn layers_of_ground_rest_under_their_weights() {
    const DENSITIES: [f64; 3] = [1800.0, 2100.0, 2650.0];
    const ENDS: [f64; 3] = [32.0, 20.0, 0.0];
    for lateral in [[0.9, 0.45, 0.2], [0.3, 1.4, 0.7]] {
        let folder = Folder::new("weights");
        let high = Vec3::new(4.0, 4.0, 40.0);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [1, 1, 10], "all").unwrap();
        let (mut text, mut layers) = (String::from("title = \"weights\"\n"), Vec::new());
        text += "mesh = { file = \"trench.msh\" }\nload = [{ kind = \"gravity\" }]\n";
        text += "time = { duration = 0.01 }\n";
        let mut top = 40.0;
        let mut parts = String::new();
        for (i, bottom) in ENDS.into_iter().enumerate() {
            let (name, density) = (format!("layer{i}"), DENSITIES[i]);
            let lies_in = |e: &u32| (bottom..top).contains(&mesh.centroid(*e).z);
            let elements = (0..10).filter(lies_in).collect();
            mesh.set_element_set(&name, elements).unwrap();
            parts += &format!(
                "[[material]]\nname = \"{name}\"\nlaw = \"elastic\"\nyoung = 2e9\npoisson = 0.25\n\
                 density = {density}\n[[part]]\nset = \"{name}\"\nmaterial = \"{name}\"\n"
            );
            let end = if i < 2 {
                format!("bottom = {bottom}, ")
            } else {
                String::new()
            };
            let along_y = lateral[i] + 0.1;
            layers.push(format!(
                "{{ {end}density = {density}, lateral = {}, lateral_y = {along_y} }}",
                lateral[i]
            ));
            top = bottom;
        }
        text += &format!(
            "in_situ_stress = {{ kind = \"layers\", level = 40, layers = [{}] }}\n{parts}[[stage]]\nname = \"ground\"\n",
            layers.join(", ")
        );
        for face in ["left", "right", "front", "back", "bottom"] {
            text += &format!("[[support]]\nkind = \"roller\"\nset = \"{face}\"\n");
        }
        write_gmsh(folder.join("trench.msh"), &mesh).unwrap();
        let simulation = read(&folder, &text).unwrap().prepare().unwrap();
        // The body does not reach above the level of its layers, which is that of the uppermost.
        let mut remarks = simulation.remarks().iter();
        assert!(!remarks.any(|remark| matches!(remark, Remark::AboveGround(_))));
        let stresses = Stresses::default();
        let body = simulation
            .equilibrate(None, Some(Box::new(stresses.clone())))
            .unwrap();
        let moved = body.unwrap().stages()[0].largest_displacement.0;
        assert!(moved < 1e-12, "{moved}");
        for (z, stress) in stresses.0.lock().unwrap().iter() {
            let (mut above, mut weight, mut share) = (40.0, 0.0, 0.0);
            for (i, bottom) in ENDS.into_iter().enumerate() {
                weight += 9.81 * DENSITIES[i] * (above - bottom.max(*z)).max(0.0);
                if *z < above {
                    share = lateral[i];
                }
                above = bottom;
            }
            let expected = [-share * weight, -(share + 0.1) * weight, -weight];
            for (found, expected) in stress.iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-9,
                    "{z}: {found} {expected}"
                );
            }
        }
    }
}
