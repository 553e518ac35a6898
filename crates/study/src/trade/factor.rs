//! What a scene leaves to choose, as changes of its file.

use powerhouse::Scene;
use powerhouse::engine::StaticOptions;
use powerhouse::model::ElementKind;
use toml::{Table, Value};

use crate::advice::Bounds;

/// The kernels of bricks, the one with most points first.
const FULL: &str = "hex8-full";
const ONE_POINT: &str = "hex8-one-point";
/// Keys that belong to springs, not to dashpots alone.
const OF_SPRINGS: [&str; 7] = ["a", "b", "distance", "x", "y", "z", "spreading"];
/// Tolerances that stages of yielding rock still meet, and that the hand-over still takes.
const MET: [f64; 2] = [1.0e-10, 1.0e-4];
/// A spectrum of flat damping cannot be narrower.
const NARROWEST_BAND: f64 = 1.5;

/// What a level changes of a scene's file.
#[derive(Clone, Debug, PartialEq)]
enum Change {
    /// Nothing: the scene as it stands.
    Nothing,
    /// A key of a table at the top, or at the top itself.
    Set(Option<&'static str>, &'static str, Value),
    /// The kernel of the parts of some sets.
    Kernel {
        kernel: &'static str,
        sets: Vec<String>,
    },
    /// Dashpots without springs.
    Dashpots,
    /// Less ground; waves pass where they would in the whole, each at its reference point (m).
    Ground {
        within: Bounds,
        references: Vec<[f64; 3]>,
    },
    /// The tolerance of every stage times a factor, brought between two limits if it was not beyond them.
    Tolerance(f64, [f64; 2]),
    /// Flat damping in place of Rayleigh's, over the band of its two frequencies; or none.
    Damping { flat: bool },
}

/// One way to do what a factor leaves open.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Its name, such as `mixed`.
    pub name: String,
    change: Change,
    /// Its place among all that the scene allows.
    place: usize,
}

impl Level {
    fn new(name: impl Into<String>, change: Change) -> Self {
        Self {
            name: name.into(),
            change,
            place: 0,
        }
    }
    pub(super) fn own(name: impl Into<String>) -> Self {
        Self::new(name, Change::Nothing)
    }
    /// Less ground, between bounds; waves pass where they would in the whole, each at its reference point (m).
    pub(super) fn less_ground(
        name: impl Into<String>,
        within: Bounds,
        references: Vec<[f64; 3]>,
    ) -> Self {
        Self::new(name, Change::Ground { within, references })
    }

    /// Its place among all levels of its factor, by which results are kept.
    pub(super) fn place(&self) -> usize {
        self.place
    }

    /// Changes a scene's file.
    pub(crate) fn apply(&self, file: &mut Table) {
        match &self.change {
            Change::Nothing => {}
            Change::Set(None, key, value) => {
                file.insert((*key).into(), value.clone());
            }
            Change::Set(Some(section), key, value) => {
                let section = file.entry(*section).or_insert_with(|| Table::new().into());
                if let Value::Table(table) = section {
                    table.insert((*key).into(), value.clone());
                }
            }
            Change::Kernel { kernel, sets } => {
                for part in tables(file, "part") {
                    let set = part.get("set").and_then(Value::as_str);
                    if set.is_some_and(|set| sets.iter().any(|other| other == set)) {
                        part.insert("kernel".into(), (*kernel).into());
                    }
                }
            }
            Change::Dashpots => {
                if let Some(Value::Table(boundary)) = file.get_mut("boundary") {
                    boundary.insert("kind".into(), "viscous".into());
                    OF_SPRINGS.iter().for_each(|key| {
                        boundary.remove(*key);
                    });
                }
            }
            Change::Ground { within, references } => {
                for (wave, reference) in tables(file, "wave").zip(references) {
                    let reference = Value::from(reference.to_vec());
                    wave.entry("reference").or_insert(reference);
                }
                let Some(Value::Table(mesh)) = file.get_mut("mesh") else {
                    return;
                };
                let own = mesh.entry("within").or_insert_with(|| Table::new().into());
                if let Value::Table(own) = own {
                    let named = within.iter().zip(["x", "y", "z"]);
                    own.extend(named.filter_map(|(pair, name)| {
                        Some((name.to_owned(), Value::from((*pair)?.to_vec())))
                    }));
                }
            }
            Change::Tolerance(factor, [least, most]) => {
                for stage in tables(file, "stage") {
                    let own = stage.get("tolerance").and_then(number);
                    let own = own.unwrap_or(StaticOptions::default().tolerance);
                    stage.insert(
                        "tolerance".into(),
                        (factor * own).clamp(own.min(*least), own.max(*most)).into(),
                    );
                }
            }
            Change::Damping { flat } => {
                for part in tables(file, "part") {
                    let Some((ratio, band)) = rayleigh(part) else {
                        continue;
                    };
                    part.remove("damping");
                    if *flat {
                        let mut damping = Table::new();
                        damping.insert("kind".into(), "flat".into());
                        damping.insert("ratio".into(), ratio.into());
                        damping.insert("band".into(), band.to_vec().into());
                        part.insert("damping".into(), damping.into());
                    }
                }
            }
        }
    }
}

/// Something that a scene leaves to choose.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Its name, such as `precision`.
    pub name: &'static str,
    /// The ways to do it, the most accurate first.
    pub levels: Vec<Level>,
    /// That of the scene as it stands.
    pub own: usize,
}

impl Factor {
    pub(super) fn new(name: &'static str, levels: impl Into<Vec<Level>>, own: usize) -> Self {
        let mut levels = levels.into();
        for (place, level) in levels.iter_mut().enumerate() {
            level.place = place;
        }
        Self { name, levels, own }
    }

    /// The factor without the levels that are finer than what the scene has; none if there are none.
    pub(super) fn as_given_at_best(&self) -> Option<Self> {
        (self.own > 0).then(|| Self {
            name: self.name,
            levels: self.levels[self.own..].into(),
            own: 0,
        })
    }

    /// The factor with nothing left to choose: what the scene has.
    pub(super) fn fixed(self) -> Self {
        let own = self.levels.into_iter().nth(self.own);
        Self {
            name: self.name,
            levels: own.into_iter().collect(),
            own: 0,
        }
    }
}

/// What a scene leaves to choose, what matters most first.
pub(crate) fn factors(scene: &Scene, file: &Table) -> Vec<Factor> {
    let found = [
        kernel(scene),
        step(file),
        boundary(file),
        input(scene, file),
        damping(file),
        precision(file),
        statics(file),
        output(scene, file),
    ];
    found.into_iter().flatten().collect()
}

/// The kernels that bricks may have, if there are bricks, in all parts that have some and do not choose a kernel
/// of other elements.
fn kernel(scene: &Scene) -> Option<Factor> {
    let mesh = scene.mesh();
    let (mut names, mut sets) = (Vec::new(), Vec::new());
    for part in scene.parts() {
        let elements = mesh.element_set(&part.set).ok()?;
        let own = part.kernel.as_ref();
        let of_others = own.is_some_and(|kernel| kernel.kind() != ElementKind::Hex8);
        if of_others || !elements.iter().any(|&e| mesh.kind(e) == ElementKind::Hex8) {
            continue;
        }
        names.push(own.map_or(ONE_POINT, |kernel| kernel.name()).to_owned());
        sets.push(part.set.to_string());
    }
    names.sort_unstable();
    names.dedup();
    let own = match &names[..] {
        [] => return None,
        [name] => name.clone(),
        several => several.join(" and "),
    };
    let level = |kernel: &'static str| {
        let sets = sets.clone();
        Level::new(kernel, Change::Kernel { kernel, sets })
    };
    let mut levels = vec![level(FULL), level(ONE_POINT)];
    let known = levels.iter().position(|level| level.name == own);
    let place = known.unwrap_or_else(|| {
        levels.insert(1, Level::own(own));
        1
    });
    levels[place].change = Change::Nothing;
    Some(Factor::new("kernel", levels, place))
}

/// The scene's share of the stable step, and half of it; nothing if the step is given in seconds.
fn step(file: &Table) -> Option<Factor> {
    let time = file.get("time")?.as_table()?;
    if time
        .get("step")
        .is_some_and(|step| step.as_str() != Some("auto"))
    {
        return None;
    }
    let own = time.get("safety").and_then(number).unwrap_or(1.0);
    let finer = Change::Set(Some("time"), "safety", Value::Float(0.5 * own));
    Some(Factor::new(
        "step",
        [
            Level::new(format!("{} of the stable", 0.5 * own), finer),
            Level::own(format!("{own} of the stable")),
        ],
        1,
    ))
}

/// Springs and dashpots, or dashpots alone.
fn boundary(file: &Table) -> Option<Factor> {
    let boundary = file.get("boundary")?.as_table()?;
    if boundary.get("kind")?.as_str()? != "viscous-spring" {
        return None;
    }
    Some(Factor::new(
        "boundary",
        [
            Level::own("viscous-spring"),
            Level::new("viscous", Change::Dashpots),
        ],
        0,
    ))
}

/// The full field on every face, or the incident wave alone at the bottom.
fn input(scene: &Scene, file: &Table) -> Option<Factor> {
    scene.field()?;
    let boundary = file.get("boundary")?.as_table()?;
    let input = boundary.get("input");
    if input.is_some_and(|input| input.as_str() != Some("full-field")) {
        return None;
    }
    let faces = boundary.get("faces")?.as_array()?;
    if !faces.iter().any(|face| face.as_str() == Some("bottom")) {
        return None;
    }
    let mut incident = Table::new();
    incident.insert("incident-only".into(), vec!["bottom"].into());
    let incident = Change::Set(Some("boundary"), "input", incident.into());
    Some(Factor::new(
        "input",
        [
            Level::own("full field"),
            Level::new("incident wave at the bottom", incident),
        ],
        0,
    ))
}

/// Rayleigh damping, flat damping over the same band, or none.
fn damping(file: &Table) -> Option<Factor> {
    let parts = file.get("part")?.as_array()?;
    let bands: Vec<[f64; 2]> = (parts.iter())
        .filter_map(|part| rayleigh(part.as_table()?))
        .map(|(_, band)| band)
        .collect();
    let wide = bands
        .iter()
        .all(|[low, high]| *high >= NARROWEST_BAND * low);
    if bands.is_empty() || !wide {
        return None;
    }
    Some(Factor::new(
        "damping",
        [
            Level::own("rayleigh"),
            Level::new("flat", Change::Damping { flat: true }),
            Level::new("none", Change::Damping { flat: false }),
        ],
        0,
    ))
}

fn precision(file: &Table) -> Option<Factor> {
    const FORMATS: [&str; 3] = ["f64", "mixed", "f32"];
    let own = file.get("precision").map_or(Some("f64"), Value::as_str)?;
    let own = FORMATS.iter().position(|format| *format == own)?;
    let level =
        |format: &'static str| Level::new(format, Change::Set(None, "precision", format.into()));
    Some(Factor::new("precision", FORMATS.map(level), own))
}

/// The tolerances of the stages, a hundredth of them, and a hundred times as much, as far as statics can
/// meet them and a dynamic stage takes them over.
fn statics(file: &Table) -> Option<Factor> {
    file.get("stage")?.as_array()?;
    let level = |name: &str, factor| Level::new(name, Change::Tolerance(factor, MET));
    Some(Factor::new(
        "statics",
        [
            level("a hundredth", 0.01),
            Level::own("as given"),
            level("a hundred times", 100.0),
        ],
        1,
    ))
}

/// The time between samples, and two and four times that.
fn output(scene: &Scene, file: &Table) -> Option<Factor> {
    file.get("output")?.as_table()?;
    let own = scene.output().every;
    let level = |times: f64| {
        let every = times * own;
        let change = Change::Set(Some("output"), "every", Value::Float(every));
        Level::new(format!("every {every} s"), change)
    };
    let mut levels: Vec<Level> = [1.0, 2.0, 4.0].map(level).into();
    levels[0].change = Change::Nothing;
    Some(Factor::new("output", levels, 0))
}

/// The tables of an array of them.
pub(super) fn tables<'a>(file: &'a mut Table, key: &str) -> impl Iterator<Item = &'a mut Table> {
    let array = file.get_mut(key).and_then(Value::as_array_mut);
    array.into_iter().flatten().filter_map(Value::as_table_mut)
}

/// Tables of loads of the scene and of its stages.
fn loads(file: &Table) -> impl Iterator<Item = &Value> {
    let of_stages = listed(file, "stage").filter_map(|stage| stage.get("load")?.as_array());
    listed(file, "load").chain(of_stages.flatten())
}

fn listed<'a>(file: &'a Table, key: &str) -> impl Iterator<Item = &'a Value> {
    let array = file.get(key).and_then(Value::as_array);
    array.into_iter().flatten()
}

fn word<'a>(table: &'a Value, key: &str) -> Option<&'a str> {
    table.get(key)?.as_str()
}

/// Sets that are loaded or moved.
pub(super) fn sets_acted_on(file: &Table) -> Vec<&str> {
    let moved = listed(file, "support").filter(|table| word(table, "kind") == Some("prescribed"));
    let sets = loads(file).chain(moved);
    sets.filter_map(|table| word(table, "set")).collect()
}

/// Sets of forces at nodes.
pub(super) fn nodal_loads(file: &Table) -> Vec<&str> {
    let nodal = loads(file).filter(|table| word(table, "kind") == Some("nodal"));
    nodal.filter_map(|table| word(table, "set")).collect()
}

/// Ratio and frequencies (Hz) of the Rayleigh damping of a part.
fn rayleigh(part: &Table) -> Option<(f64, [f64; 2])> {
    let damping = part.get("damping")?.as_table()?;
    if damping.get("kind")?.as_str()? != "rayleigh" {
        return None;
    }
    let frequencies = damping.get("frequencies")?.as_array()?;
    let frequency = |place: usize| number(frequencies.get(place)?);
    Some((
        number(damping.get("ratio")?)?,
        [frequency(0)?, frequency(1)?],
    ))
}

/// A number, whole or not.
pub(super) fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|x| x as f64))
}

/// Factors of so many levels each, which change nothing.
#[cfg(test)]
pub(super) fn test_factors(levels: &[usize]) -> Vec<Factor> {
    let factor = |&count: &usize| {
        let levels = (0..count).map(|i| Level::own(i.to_string()));
        Factor::new("factor", levels.collect::<Vec<Level>>(), 0)
    };
    levels.iter().map(factor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kernels of bricks are chosen for parts that have bricks, and not for others.
    #[test]
    fn kernels_of_bricks_are_for_bricks() {
        use powerhouse::Part;
        use powerhouse::material::{LinearElastic, media};
        use powerhouse::model::{ElementKind, Mesh, Vec3};
        let mut builder = Mesh::builder();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0]];
        for (tag, height) in [(1, 0.0), (6, 1.0)] {
            for (place, [x, y]) in corners.into_iter().enumerate() {
                builder.node(tag + place as u64, Vec3::new(x, y, height));
            }
        }
        let brick = [1, 2, 3, 4, 6, 7, 8, 9];
        builder.element(1, ElementKind::Hex8, &brick, &["bricks"]);
        builder.element(2, ElementKind::Wedge6, &[2, 5, 3, 7, 10, 8], &["wedges"]);
        let mut scene = Scene::new("both", builder.build().unwrap());
        for set in ["bricks", "wedges"] {
            scene = scene.part(Part::new(set, LinearElastic::new(media::ROCK).into()));
        }
        let factor = kernel(&scene).unwrap();
        assert_eq!((factor.levels.len(), factor.own), (2, 1));
        let mut file: Table =
            toml::from_str("[[part]]\nset = \"bricks\"\n[[part]]\nset = \"wedges\"").unwrap();
        factor.levels[0].apply(&mut file);
        let kernels: Vec<Option<&str>> = listed(&file, "part")
            .map(|part| word(part, "kernel"))
            .collect();
        assert_eq!(kernels, [Some(FULL), None]);
    }

    /// Tolerances of stages are those of the file or the default ones, a hundredth and a hundred times as
    /// much, between what statics meet and what a run takes over.
    #[test]
    fn tolerances_stay_where_statics_can_meet_them() {
        let text = "[[stage]]\ntolerance = 1e-6\n[[stage]]\n[[stage]]\ntolerance = 1e-11";
        let file: Table = toml::from_str(text).unwrap();
        let factor = statics(&file).unwrap();
        let tolerances = |level: usize| -> Vec<f64> {
            let mut file = file.clone();
            factor.levels[level].apply(&mut file);
            tables(&mut file, "stage")
                .map(|stage| number(&stage["tolerance"]).unwrap())
                .collect()
        };
        let expect = |level: usize, expected: [f64; 3]| {
            for (found, expected) in tolerances(level).into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found:e}");
            }
        };
        expect(0, [1e-8, 1e-10, 1e-11]);
        expect(2, [1e-4, 1e-6, 1e-9]);
        assert!(statics(&Table::new()).is_none());
    }
}
