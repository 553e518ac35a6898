//! What results say of water in the ground, and what is refused.

use std::sync::Arc;

use powerhouse::engine::{Engine, ExplicitOnRanks};
use powerhouse::io::read_vtu;
use powerhouse::model::{Ranks, ThreadRanks};
use powerhouse::{ResultFolder, RunHooks, RunNotes, TimeStep};

use super::support::run;
use super::water_stages::{
    COLUMN, Column, GRAVITY, HEIGHT, PORES, SAND, WATER, close, columns, first, moved,
};

/// At rest under a water table K0 holds between effective stresses, by name in the results; total stress stays total.
#[test]
fn results_name_effective_stresses_and_pressures() {
    for column in columns() {
        let results = column.run(COLUMN);
        for z in [2.5, 5.5, 7.5, 10.5] {
            let at = |name: &str| first(&results, &format!("z{z}.{name}"));
            let total = -2000.0 * GRAVITY * (HEIGHT - z);
            let pressure = WATER * (9.0_f64 - z).max(0.0);
            let effective = total + pressure;
            for (name, expected) in [
                ("zz", total),
                ("xx", 0.5 * effective - pressure),
                ("pore_pressure", pressure),
                ("effective_zz", effective),
                ("effective_xx", 0.5 * effective),
                ("effective_yy", 0.5 * effective),
                ("effective_xy", 0.0),
                ("effective_yz", 0.0),
                ("effective_zx", 0.0),
                ("vertical_stress_at_rest", effective),
                ("excess_pore_pressure", 0.0),
            ] {
                close(at(name), expected, total.abs(), &format!("{name} at {z}"));
            }
            assert_eq!(at("pore_pressure_ratio"), 0.0);
        }
        assert!(moved(&results) < 1e-13, "{:e}", moved(&results));
    }
}

/// Files of stages, of snapshots and of the state at the end have the pressure of the water and the effective stress of every element, beside
/// the total stress.
#[test]
fn files_have_effective_stress_beside_total_stress() {
    let load = 5e4;
    let text = format!(
        "{COLUMN}[[stage]]\nname = \"fill\"\nundrained = true\ntolerance = 1e-12\n\
         load = [{{ kind = \"pressure\", set = \"top\", pressure = {load} }}]\n\
         [output.snapshots]\nevery = 0.01\nquantities = [\"stress\", \"state\"]\n"
    );
    // The upper part is dry.
    let old = "set = \"upper\"\nmaterial = \"sand\"";
    assert!(text.contains(old));
    let text = text.replace(old, "set = \"upper\"\nmaterial = \"clay\"");
    let column = Column::new(0.3, [1, 1], "hex8-natural");
    let scene = column.read(&text).unwrap();
    let mesh = scene.mesh().clone();
    let out = ResultFolder::new(column.folder.join("out"));
    let simulation = scene.prepare().unwrap();
    let hooks = RunHooks::default()
        .with_stages(out.stages(&simulation).unwrap())
        .with_snapshots(out.snapshots(&simulation).unwrap());
    let results = simulation.run(hooks).unwrap();
    let notes = RunNotes::default();
    out.write(("column", &mesh), &results, &notes, None)
        .unwrap();
    let rise = PORES * load / (SAND + PORES);
    for (file, rise) in [
        ("stages/1-ground.vtu", 0.0),
        ("stages/2-fill.vtu", rise),
        ("snapshots/snapshots_00001.vtu", rise),
    ] {
        let load = if rise > 0.0 { load } else { 0.0 };
        let grid = read_vtu(&out.path().join(file)).unwrap();
        let field = |name: &str| {
            let mut fields = grid.in_elements.iter();
            let found = fields.find(|field| field.name == name);
            &found.unwrap_or_else(|| panic!("{file}: {name}")).values
        };
        assert_eq!(grid.mesh.element_count(), 12, "{file}");
        for element in 0..12 {
            let z = grid.mesh.centroid(element as u32).z;
            let total = -2000.0 * GRAVITY * (HEIGHT - z) - load;
            let is_wet = z < 8.0;
            let pressure = if is_wet {
                WATER * (9.0 - z) + rise
            } else {
                0.0
            };
            let off = |found: f64, expected: f64| (found - expected).abs() / 2e5;
            assert!(
                off(field("stress")[6 * element + 2], total) < 1e-6,
                "{file}"
            );
            assert!(
                off(field("pore_pressure")[element], pressure) < 1e-6,
                "{file}"
            );
            // Snapshots have nothing of elements without water.
            if is_wet {
                let found = field("effective_zz")[element];
                assert!(off(found, total + pressure) < 1e-6, "{file} {found}");
                let side = field("stress")[6 * element] + pressure;
                assert!(off(field("effective_xx")[element], side) < 1e-6, "{file}");
            }
        }
    }
    let state = results.state.unwrap();
    let of = |name: &str| {
        let (_, peak) = state.peaks.iter().find(|(v, _)| v.name == name).unwrap();
        peak.values.iter().copied().fold(0.0, f64::max)
    };
    close(
        of("pore_pressure"),
        WATER * 8.5 + rise,
        1e5,
        "greatest pressure",
    );
    let at_rest = 2000.0 * GRAVITY * 4.5 - WATER * 1.5;
    close(
        of("pore_pressure_ratio"),
        rise / at_rest,
        1.0,
        "greatest ratio",
    );
    let grid = read_vtu(&out.path().join("state.vtu")).unwrap();
    for name in [
        "pore_pressure",
        "pore_pressure_ratio",
        "excess_pore_pressure",
    ] {
        let mut fields = grid.in_elements.iter();
        assert!(fields.any(|field| field.name == name), "{name}");
    }
}

/// Ranks that share the ground have the same bits of what a run shows of its water, after a stage with another level and an undrained one.
#[test]
fn ranks_show_the_same_water() {
    let text = format!(
        "{COLUMN}[[stage]]\nname = \"drawdown\"\nwater = [{{ level = 6 }}]\n\
         [[stage]]\nname = \"fill\"\nundrained = true\n\
         load = [{{ kind = \"pressure\", set = \"top\", pressure = 5e4 }}]\n\
         [[load]]\nkind = \"pressure\"\nset = \"top\"\npressure = 1e4\n\
         function = {{ kind = \"ricker\", frequency = 100, delay = 0.01 }}\n"
    );
    let column = Column::new(0.4, [2, 1], "hex8-natural");
    let of = |engine: Option<Arc<dyn Engine>>| {
        let scene = column.read(&text).unwrap().into_scene();
        let scene = scene.with_step(TimeStep::OfStable(0.9));
        run(match engine {
            Some(engine) => scene.with_engine(engine),
            None => scene,
        })
    };
    let alone = of(None);
    let shared = ThreadRanks::run(2, |ranks| {
        let leads = ranks.rank() == 0;
        let engine = Arc::new(ExplicitOnRanks::new(Box::new(ranks)));
        let histories = of(Some(engine)).histories().clone();
        Ok(leads.then_some(histories))
    });
    let shared = shared.into_iter().map(Result::unwrap);
    let shared = shared.flatten().next().unwrap();
    // The lowest and the highest part are in blocks of their own.
    for place in ["z2.5", "z10.5"] {
        for name in ["pore_pressure", "effective_zz", "pore_pressure_ratio"] {
            let [alone, shared] = [alone.histories(), &shared].map(|table| {
                let column = table.column(&format!("{place}.{name}"));
                column.unwrap().values.clone()
            });
            assert_eq!(alone, shared, "{place} {name}");
            assert!(
                alone.iter().any(|value| *value != alone[0]),
                "{place} {name}"
            );
        }
    }
}

/// What cannot be done is refused by name.
#[test]
fn water_of_stages_is_refused_by_name() {
    let column = Column::new(0.0, [1, 1], "hex8-full");
    let stage = |keys: &str| format!("{COLUMN}[[stage]]\nname = \"later\"\n{keys}\n");
    let dry = |keys: &str| stage(keys).replace("pore_water = { porosity = 0.4, level = 9 }\n", "");
    let clay = |keys: &str| {
        let old = "set = \"plug\"\nmaterial = \"sand\"";
        stage(keys).replace(old, "set = \"plug\"\nmaterial = \"clay\"")
    };
    for (text, wanted) in [
        (
            stage("water = [{ level = 3, set = \"pit\" }]"),
            "there is no element set 'pit'",
        ),
        (
            clay("water = [{ level = 3, set = \"plug\" }]"),
            "no element of set 'plug' is active in this stage and has water in its pores",
        ),
        (
            stage("water = [{ level = 3, set = \"plug\" }]\nexcavate = [\"plug\"]"),
            "no element of set 'plug' is active",
        ),
        (
            stage("water = [{ level = 3, set = \"plug\" }, { level = 4, set = \"all\" }]"),
            "of set 'all' has another water level in the same stage",
        ),
        (
            stage("water = [{ level = 3 }, { level = 4 }]"),
            "two water levels of the stage name no set",
        ),
        (
            stage("water = [{ level = 3 }]\nundrained = true"),
            "a water level in an undrained stage",
        ),
        (
            dry("undrained = true"),
            "an undrained stage in a body without water",
        ),
        (
            dry("water = [{ level = 3 }]"),
            "a water level in a body without water",
        ),
        (
            stage(
                "excavate = [\"upper\"]\n[[stage]]\nname = \"fill\"\ncast = [\"upper\"]\nwater = [{ level = 3, set = \"upper\" }]",
            ),
            "is cast in this stage, with pores without pressure",
        ),
        (stage("water = [{ set = \"plug\" }]"), "level"),
        (
            stage("water = [{ level = 3, pressures = [[12, 0], [0, 1]] }]"),
            "one of `level` and `pressures`",
        ),
        (
            stage("water = [{ pressures = [[11, 0], [0, 1e4]] }]"),
            "has its centre at z = 11.5 m, and the table of pressures reaches from 0 to 11 m",
        ),
        (
            stage("water = [{ pressures = [[12, 0], [12, 1e4]] }]"),
            "height",
        ),
        (
            COLUMN.replace(
                "porosity = 0.4, level = 9",
                "porosity = 0.4, pressures = [[12, 0], [1, 1e4]]",
            ),
            "with its centre at z = 0.5 m",
        ),
        (
            COLUMN.replace("water = { level = 9 }", "water = { density = 1025 }"),
            "level",
        ),
        (stage("water = [{ level = 3, density = 0 }]"), "above 0"),
        (stage("water = [{ level = 3, porosity = 0.3 }]"), "porosity"),
        (stage("undrained = 1"), "expected a boolean"),
    ] {
        let message = column.read(&text).err().unwrap().to_string();
        assert!(message.contains(wanted), "{wanted}: {message}");
        assert!(message.contains("column.toml:"), "{message}");
    }
}
