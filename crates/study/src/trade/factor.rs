//! Factors of a trade study: numerical options of a scene, as edits of its file.

use core::iter;

use powerhouse::engine::{Hex8OnePoint, SolidKernel, StaticOptions};
use powerhouse::model::ElementKind;
use powerhouse::{Scene, keys};
use toml::{Table, Value};

use crate::advice::Bounds;

/// Names of the factors.
pub(crate) const KERNEL: &str = "kernel";
pub(crate) const STEP: &str = "step";
pub(crate) const BOUNDARY: &str = "boundary";
pub(crate) const INPUT: &str = "input";
pub(crate) const DAMPING: &str = "damping";
pub(crate) const PRECISION: &str = "precision";
pub(crate) const STATICS: &str = "statics";
pub(crate) const OUTPUT: &str = "output";
/// Names of levels.
pub(crate) const FLAT: &str = "flat";
pub(crate) const MIXED: &str = "mixed";
/// Tolerances that stages of yielding rock still meet, and that the hand-over still takes.
const MET: [f64; 2] = [1.0e-10, 1.0e-4];
/// Least ratio of the band limits of flat damping.
const NARROWEST_BAND: f64 = 1.5;

/// Edit of a scene's file by a level.
#[derive(Clone, Debug, PartialEq)]
enum Edit {
    /// No edit: the scene's own setting.
    Nothing,
    /// Sets a key of a top-level table, or a top-level key.
    Set(Option<&'static str>, &'static str, Value),
    /// The kernel of the parts of some sets.
    Kernel { kernel: String, sets: Vec<String> },
    /// Another boundary, which takes these keys.
    Boundary { kind: String, takes: Vec<String> },
    /// Less ground; waves pass where they would in the whole, each at its reference point (m).
    Ground {
        within: Bounds,
        references: Vec<[f64; 3]>,
    },
    /// Multiplies the tolerance of every stage by a factor, within two limits unless it was beyond them.
    Tolerance(f64, [f64; 2]),
    /// Replaces Rayleigh damping by flat damping over the band of its two frequencies, or by none.
    Damping { flat: bool },
}

/// Level of a factor: one setting of a numerical option.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Name of the level, such as `mixed`.
    pub name: String,
    edit: Edit,
    /// Index among all levels of the factor that the scene allows.
    index: usize,
}

impl Level {
    fn new(name: impl Into<String>, edit: Edit) -> Self {
        Self {
            name: name.into(),
            edit,
            index: 0,
        }
    }
    pub(super) fn own(name: impl Into<String>) -> Self {
        Self::new(name, Edit::Nothing)
    }
    /// A level with the mesh reduced to a box and the reference points (m) of the waves unchanged.
    pub(super) fn less_ground(
        name: impl Into<String>,
        within: Bounds,
        references: Vec<[f64; 3]>,
    ) -> Self {
        Self::new(name, Edit::Ground { within, references })
    }

    /// Index among all levels of the factor, which names result folders.
    pub(super) fn index(&self) -> usize {
        self.index
    }

    /// Applies the level to a scene's file.
    pub(crate) fn apply(&self, file: &mut Table) {
        match &self.edit {
            Edit::Nothing => {}
            Edit::Set(None, key, value) => {
                file.insert((*key).into(), value.clone());
            }
            Edit::Set(Some(section), key, value) => {
                let section = file.entry(*section).or_insert_with(|| Table::new().into());
                if let Value::Table(table) = section {
                    table.insert((*key).into(), value.clone());
                }
            }
            Edit::Kernel { kernel, sets } => {
                for part in tables(file, "part") {
                    let set = part.get("set").and_then(Value::as_str);
                    if set.is_some_and(|set| sets.iter().any(|other| other == set)) {
                        part.insert("kernel".into(), kernel.as_str().into());
                    }
                }
            }
            Edit::Boundary { kind, takes } => {
                if let Some(Value::Table(boundary)) = file.get_mut("boundary") {
                    let takes = |key: &str| takes.iter().any(|taken| taken == key);
                    boundary.retain(|key, _| keys::BOUNDARY.contains(&key) || takes(key));
                    boundary.insert(keys::KIND.into(), kind.as_str().into());
                }
            }
            Edit::Ground { within, references } => {
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
            Edit::Tolerance(factor, [least, most]) => {
                for stage in tables(file, "stage") {
                    let own = stage.get("tolerance").and_then(number);
                    let own = own.unwrap_or(StaticOptions::default().tolerance);
                    stage.insert(
                        "tolerance".into(),
                        (factor * own).clamp(own.min(*least), own.max(*most)).into(),
                    );
                }
            }
            Edit::Damping { flat } => {
                for part in tables(file, "part") {
                    let Some((ratio, band)) = rayleigh(part) else {
                        continue;
                    };
                    part.insert("damping".into(), "none".into());
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

/// Factor of a trade study: a numerical option of a scene with its possible levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Name of the factor, such as `precision`.
    pub name: &'static str,
    /// Levels, the most accurate first.
    pub levels: Vec<Level>,
    /// Index in [`levels`](Self::levels) of the scene's own level.
    pub own: usize,
}

impl Factor {
    pub(super) fn new(name: &'static str, levels: impl Into<Vec<Level>>, own: usize) -> Self {
        let mut levels = levels.into();
        for (index, level) in levels.iter_mut().enumerate() {
            level.index = index;
        }
        Self { name, levels, own }
    }

    /// The factor without levels finer than the scene's own; `None` if there are none.
    pub(super) fn as_given_at_best(&self) -> Option<Self> {
        (self.own > 0).then(|| Self {
            name: self.name,
            levels: self.levels[self.own..].into(),
            own: 0,
        })
    }

    /// The factor reduced to the scene's own level.
    pub(super) fn fixed(self) -> Self {
        let own = self.levels.into_iter().nth(self.own);
        Self {
            name: self.name,
            levels: own.into_iter().collect(),
            own: 0,
        }
    }
}

/// The factors of a scene, the most important first.
pub(crate) fn factors(scene: &Scene, file: &Table) -> Vec<Factor> {
    let found = [
        kernel(scene, file),
        step(file),
        boundary(scene, file),
        input(scene, file),
        damping(file),
        precision(file),
        statics(file),
        output(scene, file),
    ];
    found.into_iter().flatten().collect()
}

/// The kernels of bricks that are compared, the most accurate first. Others are stiffer in bending, and are compared where a scene
/// has them.
const COMPARED_KERNELS: [SolidKernel; 3] = [
    SolidKernel::Hex8Eas,
    SolidKernel::Hex8Natural,
    SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT),
];

/// The name of the fastest kernel of bricks.
pub(crate) fn one_point() -> &'static str {
    SolidKernel::Hex8OnePoint(Default::default()).name()
}

/// The kernels of hexahedra, those of a program after those of the software, for all
/// parts that have hexahedra and no kernel of other elements; `None` without such
/// parts.
fn kernel(scene: &Scene, file: &Table) -> Option<Factor> {
    let mesh = scene.mesh();
    let (mut names, mut sets) = (Vec::new(), Vec::new());
    for part in scene.parts() {
        let elements = mesh.element_set(&part.set).ok()?;
        let own = part.kernel.as_ref();
        let of_others = own.is_some_and(|kernel| kernel.kind() != ElementKind::Hex8);
        if of_others || !elements.iter().any(|&e| mesh.kind(e) == ElementKind::Hex8) {
            continue;
        }
        // A registered kernel may have another name of its own.
        let named = (listed(file, "part").find(|other| text(other, "set") == Some(&part.set)))
            .and_then(|other| text(other, "kernel"));
        let name = named.or(own.map(|kernel| kernel.name()));
        let default = SolidKernel::default_for(ElementKind::Hex8).map(SolidKernel::name);
        names.extend(name.or(default).map(str::to_owned));
        sets.push(part.set.to_string());
    }
    names.sort_unstable();
    names.dedup();
    let own = match &names[..] {
        [] => return None,
        [name] => name.clone(),
        several => several.join(" and "),
    };
    let level = |kernel: &str| {
        let (kernel, sets) = (kernel.to_owned(), sets.clone());
        Level::new(kernel.clone(), Edit::Kernel { kernel, sets })
    };
    let mut levels: Vec<Level> = COMPARED_KERNELS.map(|kernel| level(kernel.name())).into();
    if let Some(registry) = scene.registry() {
        let is_of_bricks = |name: &&str| {
            let kernel = registry.kernel_named(name);
            kernel.is_some_and(|kernel| kernel.kind() == ElementKind::Hex8)
        };
        levels.extend(
            registry
                .added_kernel_names()
                .filter(is_of_bricks)
                .map(level),
        );
    }
    let known = levels.iter().position(|level| level.name == own);
    let index = known.unwrap_or_else(|| {
        levels.insert(1, Level::own(own));
        1
    });
    levels[index].edit = Edit::Nothing;
    Some(Factor::new(KERNEL, levels, index))
}

/// Half of the scene's safety factor of the stable step, and the factor itself; `None` if the step is given in seconds.
fn step(file: &Table) -> Option<Factor> {
    let time = file.get("time")?.as_table()?;
    if time
        .get("step")
        .is_some_and(|step| step.as_str() != Some("auto"))
    {
        return None;
    }
    let own = time.get("safety").and_then(number).unwrap_or(1.0);
    let finer = Edit::Set(Some("time"), "safety", Value::Float(0.5 * own));
    Some(Factor::new(
        STEP,
        [
            Level::new(format!("{} of the stable", 0.5 * own), finer),
            Level::own(format!("{own} of the stable")),
        ],
        1,
    ))
}

/// The scene's own boundary, dashpots alone, and the boundaries of a program that do without keys of their own.
fn boundary(scene: &Scene, file: &Table) -> Option<Factor> {
    let registry = scene.registry()?;
    let own = file
        .get("boundary")?
        .as_table()?
        .get(keys::KIND)?
        .as_str()?;
    let added = registry.added_boundary_names();
    let others = iter::once(keys::VISCOUS)
        .chain(added.filter(|name| *name != keys::VISCOUS))
        .filter(|name| registry.boundary_without_keys(name).is_some());
    let level = |kind: &str| {
        let takes = registry.boundary_keys(kind).unwrap_or_default();
        let kind = kind.to_owned();
        Level::new(kind.clone(), Edit::Boundary { kind, takes })
    };
    let mut levels = vec![Level::own(own)];
    levels.extend(others.filter(|name| *name != own).map(level));
    (levels.len() > 1).then(|| Factor::new(BOUNDARY, levels, 0))
}

/// Input: the full field on every face, or only the incident wave at the bottom.
fn input(scene: &Scene, file: &Table) -> Option<Factor> {
    scene.field().filter(|field| field.carries_stress())?;
    let boundary = file.get("boundary")?.as_table()?;
    let kind = boundary.get(keys::KIND)?.as_str()?;
    let takes = scene.registry()?.boundary_keys(kind)?;
    let input = boundary.get(keys::INPUT);
    if !takes.iter().any(|key| key == keys::INPUT)
        || input.is_some_and(|input| input.as_str() != Some(keys::FULL_FIELD))
    {
        return None;
    }
    let faces = boundary.get(keys::FACES)?.as_array()?;
    if !faces.iter().any(|face| face.as_str() == Some("bottom")) {
        return None;
    }
    let mut incident = Table::new();
    incident.insert(keys::INCIDENT_ONLY.into(), vec!["bottom"].into());
    let incident = Edit::Set(Some("boundary"), keys::INPUT, incident.into());
    Some(Factor::new(
        INPUT,
        [
            Level::own("full field"),
            Level::new("incident wave at the bottom", incident),
        ],
        0,
    ))
}

/// Damping: Rayleigh, flat over the same band, or none.
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
        DAMPING,
        [
            Level::own("rayleigh"),
            Level::new(FLAT, Edit::Damping { flat: true }),
            Level::new("none", Edit::Damping { flat: false }),
        ],
        0,
    ))
}

/// Number format of the elements.
fn precision(file: &Table) -> Option<Factor> {
    const FORMATS: [&str; 3] = ["f64", MIXED, "f32"];
    let own = file.get("precision").map_or(Some("f64"), Value::as_str)?;
    let own = FORMATS.iter().position(|format| *format == own)?;
    let level =
        |format: &'static str| Level::new(format, Edit::Set(None, "precision", format.into()));
    Some(Factor::new(PRECISION, FORMATS.map(level), own))
}

/// Tolerances of the stages: a hundredth of the given ones, the given ones, and a hundred times as much, within the
/// limits of [`MET`].
fn statics(file: &Table) -> Option<Factor> {
    file.get("stage")?.as_array()?;
    let level = |name: &str, factor| Level::new(name, Edit::Tolerance(factor, MET));
    Some(Factor::new(
        STATICS,
        [
            level("a hundredth", 0.01),
            Level::own("as given"),
            level("a hundred times", 100.0),
        ],
        1,
    ))
}

/// Sampling interval of the output: as given, two and four times as long.
fn output(scene: &Scene, file: &Table) -> Option<Factor> {
    file.get("output")?.as_table()?;
    let own = scene.output().every;
    let level = |times: f64| {
        let every = times * own;
        let edit = Edit::Set(Some("output"), "every", Value::Float(every));
        Level::new(format!("every {every} s"), edit)
    };
    let mut levels: Vec<Level> = [1.0, 2.0, 4.0].map(level).into();
    levels[0].edit = Edit::Nothing;
    Some(Factor::new(OUTPUT, levels, 0))
}

/// The tables of an array of tables.
pub(crate) fn tables<'a>(file: &'a mut Table, key: &str) -> impl Iterator<Item = &'a mut Table> {
    let array = file.get_mut(key).and_then(Value::as_array_mut);
    array.into_iter().flatten().filter_map(Value::as_table_mut)
}

/// The tables of all loads of the scene and of its stages.
fn loads(file: &Table) -> impl Iterator<Item = &Value> {
    let of_stages = listed(file, "stage").filter_map(|stage| stage.get("load")?.as_array());
    listed(file, "load").chain(of_stages.flatten())
}

fn listed<'a>(file: &'a Table, key: &str) -> impl Iterator<Item = &'a Value> {
    let array = file.get(key).and_then(Value::as_array);
    array.into_iter().flatten()
}

fn text<'a>(table: &'a Value, key: &str) -> Option<&'a str> {
    table.get(key)?.as_str()
}

/// The sets with loads or prescribed motion.
pub(super) fn sets_acted_on(file: &Table) -> Vec<&str> {
    let prescribed =
        listed(file, "support").filter(|table| text(table, "kind") == Some("prescribed"));
    let sets = loads(file).chain(prescribed);
    sets.filter_map(|table| text(table, "set")).collect()
}

/// The sets of nodal forces.
pub(super) fn nodal_loads(file: &Table) -> Vec<&str> {
    let nodal = loads(file).filter(|table| text(table, "kind") == Some("nodal"));
    nodal.filter_map(|table| text(table, "set")).collect()
}

/// Damping ratio and frequencies (Hz) of the Rayleigh damping of a part.
fn rayleigh(part: &Table) -> Option<(f64, [f64; 2])> {
    let damping = part.get("damping")?.as_table()?;
    if damping.get("kind")?.as_str()? != "rayleigh" {
        return None;
    }
    let frequencies = damping.get("frequencies")?.as_array()?;
    let frequency = |index: usize| number(frequencies.get(index)?);
    Some((
        number(damping.get("ratio")?)?,
        [frequency(0)?, frequency(1)?],
    ))
}

/// The value of an integer or a float.
pub(crate) fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|x| x as f64))
}

/// Factors with given numbers of levels without edits.
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

    /// Kernels of hexahedra are set for parts with hexahedra, and not for others.
    #[test]
    fn kernels_of_bricks_are_for_bricks() {
        use powerhouse::Part;
        use powerhouse::material::{LinearElastic, media};
        use powerhouse::model::{ElementKind, Mesh, Vec3};
        let mut builder = Mesh::builder();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0]];
        for (tag, height) in [(1, 0.0), (6, 1.0)] {
            for (index, [x, y]) in corners.into_iter().enumerate() {
                builder.node(tag + index as u64, Vec3::new(x, y, height));
            }
        }
        let brick = [1, 2, 3, 4, 6, 7, 8, 9];
        builder.element(1, ElementKind::Hex8, &brick, &["bricks"]);
        builder.element(2, ElementKind::Wedge6, &[2, 5, 3, 7, 10, 8], &["wedges"]);
        let mut scene = Scene::new("both", builder.build().unwrap());
        for set in ["bricks", "wedges"] {
            scene = scene.part(Part::new(set, LinearElastic::new(media::ROCK).into()));
        }
        let factor = kernel(&scene, &Table::new()).unwrap();
        assert_eq!((factor.levels.len(), factor.own), (3, 1));
        let mut file: Table =
            toml::from_str("[[part]]\nset = \"bricks\"\n[[part]]\nset = \"wedges\"").unwrap();
        factor.levels[0].apply(&mut file);
        let kernels: Vec<Option<&str>> = listed(&file, "part")
            .map(|part| text(part, "kernel"))
            .collect();
        assert_eq!(kernels, [Some("hex8-eas"), None]);
    }

    /// Tolerances of stages are those of the file or the default ones, a hundredth and a hundred times as much, within
    /// the limits that statics can meet and a dynamic stage accepts.
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
