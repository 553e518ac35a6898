//! Factors of a trade study: numerical options of a scene, as changes of its specification.

use core::iter;

use powerhouse::engine::{Hex8OnePoint, SolidKernel, StaticOptions};
use powerhouse::model::ElementKind;
use powerhouse::spec::{
    At, Damping, Fibres, Finite, Load, Part, Positive, Precision, Share, Stage, Step, StepFactor,
    Support, Time,
};
use powerhouse::{FileScene, Scene, SceneSpec, keys};
use toml::Table;

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
pub(crate) const FIBRES: &str = "fibres";
/// Names of levels.
pub(crate) const FLAT: &str = "flat";
pub(crate) const MIXED: &str = "mixed";
pub(crate) const TWICE: &str = "2 times the step";
/// Facet set at which an incident wave enters from below.
const BOTTOM: &str = "bottom";
/// Tolerances that stages of yielding rock still meet, and that the hand-over still takes.
const MET: [f64; 2] = [1.0e-10, 1.0e-4];
/// Least ratio of the band limits of flat damping.
const NARROWEST_BAND: f64 = 1.5;

/// Change of a scene by a level.
#[derive(Clone, Debug, PartialEq)]
enum Edit {
    /// No change: the scene's own setting.
    Nothing,
    /// Factor on the stable step (1).
    Safety(f64),
    /// Fibres for a factor on the step (1), in the sets of the scene's own, or in all thin parts.
    Fibres(f64),
    /// No fibres.
    WithoutFibres,
    /// Number format of the elements.
    Precision(Precision),
    /// Sampling interval of the output (s).
    Every(f64),
    /// The incident wave alone, at the bottom, in place of the full field.
    IncidentAtBottom,
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

    /// Applies the level to a scene.
    pub(crate) fn apply(&self, spec: &mut SceneSpec) {
        match &self.edit {
            Edit::Nothing => {}
            Edit::Safety(factor) => spec.time.safety = Share::new(*factor),
            Edit::Fibres(factor) => {
                if let Some(factor) = StepFactor::new(*factor) {
                    spec.time.fibres = spec.time.fibres.with_factor(factor).into();
                }
            }
            Edit::WithoutFibres => spec.time.fibres = Fibres::None.into(),
            Edit::Precision(precision) => spec.precision = *precision,
            Edit::Every(interval) => spec.output.every = Positive::new(*interval).map(At::from),
            Edit::IncidentAtBottom => {
                if let Some(boundary) = &mut spec.boundary {
                    let faces = (keys::INCIDENT_ONLY.to_owned(), vec![BOTTOM].into());
                    let input = Table::from_iter([faces]).into();
                    boundary.parameters.set(keys::INPUT, &input);
                }
            }
            Edit::Kernel { kernel, sets } => {
                for part in &mut spec.parts {
                    if sets.contains(&part.set) {
                        part.kernel = Some(kernel.clone().into());
                    }
                }
            }
            Edit::Boundary { kind, takes } => {
                if let Some(boundary) = &mut spec.boundary {
                    let takes = |key: &str| takes.iter().any(|taken| taken == key);
                    boundary.parameters.retain(takes);
                    (*boundary.kind).clone_from(kind);
                }
            }
            Edit::Ground { within, references } => {
                for (wave, reference) in spec.waves.iter_mut().zip(references) {
                    if wave.reference.is_none() {
                        wave.reference = Finite::array(*reference).map(At::from);
                    }
                }
                let own = &mut **spec.mesh.within.get_or_insert_default();
                for (side, bounds) in [&mut own.x, &mut own.y, &mut own.z].into_iter().zip(within) {
                    *side = bounds.and_then(Finite::array).or(*side);
                }
            }
            Edit::Tolerance(factor, [least, most]) => {
                for stage in &mut spec.stages {
                    let own = stage.tolerance.as_ref().map(|own| own.get());
                    let own = own.unwrap_or(StaticOptions::default().tolerance);
                    let changed = (factor * own).clamp(own.min(*least), own.max(*most));
                    stage.tolerance = Positive::new(changed).map(At::from);
                }
            }
            Edit::Damping { flat } => {
                for part in &mut spec.parts {
                    let Some((ratio, band)) = rayleigh(part) else {
                        continue;
                    };
                    let damping = match (flat, Positive::new(ratio.get())) {
                        (true, Some(ratio)) => Damping::Flat {
                            ratio: ratio.into(),
                            band: band.into(),
                            mechanisms: None,
                            reference: None,
                            high: None,
                        },
                        _ => Damping::None,
                    };
                    part.damping = Some(damping.into());
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
pub(crate) fn factors(scene: &FileScene, spec: &SceneSpec) -> Vec<Factor> {
    let found = [
        kernel(scene, &spec.parts),
        step(&spec.time),
        boundary(scene, spec),
        input(scene, spec),
        damping(&spec.parts),
        precision(spec.precision),
        fibres(scene, &spec.time),
        statics(&spec.stages),
        output(scene),
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
fn kernel(scene: &FileScene, parts: &[Part]) -> Option<Factor> {
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
        let named = parts.iter().find(|other| *other.set == part.set);
        let named = named
            .and_then(|other| other.kernel.as_deref())
            .map(String::as_str);
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
fn step(time: &Time) -> Option<Factor> {
    if *time.step != Step::Auto {
        return None;
    }
    let own = time.safety.map_or(1.0, Share::get);
    let half = 0.5 * own;
    Some(Factor::new(
        STEP,
        [
            Level::new(format!("{half} of the stable"), Edit::Safety(half)),
            Level::own(format!("{own} of the stable")),
        ],
        1,
    ))
}

/// The scene's own boundary, dashpots alone, and the boundaries of a program that do without keys of their own.
fn boundary(scene: &FileScene, spec: &SceneSpec) -> Option<Factor> {
    let registry = scene.registry()?;
    let own = spec.boundary.as_ref()?.kind.as_str();
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
fn input(scene: &FileScene, spec: &SceneSpec) -> Option<Factor> {
    scene.field().filter(|field| field.carries_stress())?;
    let boundary = spec.boundary.as_ref()?;
    let takes = scene.registry()?.boundary_keys(&boundary.kind)?;
    let input = boundary.parameters.get(keys::INPUT);
    if !takes.iter().any(|key| key == keys::INPUT)
        || input.is_some_and(|input| input.as_str() != Some(keys::FULL_FIELD))
        || !boundary.faces.iter().any(|face| face.as_str() == BOTTOM)
    {
        return None;
    }
    Some(Factor::new(
        INPUT,
        [
            Level::own("full field"),
            Level::new("incident wave at the bottom", Edit::IncidentAtBottom),
        ],
        0,
    ))
}

/// Damping: Rayleigh, flat over the same band, or none.
fn damping(parts: &[Part]) -> Option<Factor> {
    let bands: Vec<[Positive; 2]> = parts
        .iter()
        .filter_map(rayleigh)
        .map(|(_, band)| band)
        .collect();
    let is_wide = |[low, high]: &[Positive; 2]| high.get() >= NARROWEST_BAND * low.get();
    if bands.is_empty() || !bands.iter().all(is_wide) {
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
fn precision(own: Precision) -> Option<Factor> {
    let formats = [
        ("f64", Precision::F64),
        (MIXED, Precision::Mixed),
        ("f32", Precision::F32),
    ];
    let own = formats.iter().position(|(_, format)| *format == own)?;
    let level = |(name, format)| Level::new(name, Edit::Precision(format));
    Some(Factor::new(PRECISION, formats.map(level), own))
}

/// Fibres for twice and three times the step, or those of the scene; `None` if the step is given in seconds, or elements
/// that are not thin would limit a longer one.
fn fibres(scene: &Scene, time: &Time) -> Option<Factor> {
    if *time.step != Step::Auto || !scene.has_thin_limits() {
        return None;
    }
    let none = Level::new("none", Edit::Nothing);
    let level = |factor: f64| Level::new(format!("{factor} times the step"), Edit::Fibres(factor));
    let mut levels = vec![none, level(2.0), level(3.0)];
    let mut own = 0;
    if let Some(options) = scene.fibres() {
        let name = format!("{} times the step", options.factor);
        levels.retain(|level| level.name != name);
        levels[0].edit = Edit::WithoutFibres;
        levels.push(Level::own(name));
        own = levels.len() - 1;
    }
    Some(Factor::new(FIBRES, levels, own))
}

/// Tolerances of the stages: a hundredth of the given ones, the given ones, and a hundred times as much, within the
/// limits of [`MET`].
fn statics(stages: &[Stage]) -> Option<Factor> {
    if stages.is_empty() {
        return None;
    }
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
fn output(scene: &Scene) -> Option<Factor> {
    let own = scene.output().every;
    let level = |times: f64| {
        let every = times * own;
        Level::new(format!("every {every} s"), Edit::Every(every))
    };
    let mut levels: Vec<Level> = [1.0, 2.0, 4.0].map(level).into();
    levels[0].edit = Edit::Nothing;
    Some(Factor::new(OUTPUT, levels, 0))
}

/// The loads of the scene and of its stages.
fn loads(spec: &SceneSpec) -> impl Iterator<Item = &Load> {
    let of_stages = spec.stages.iter().flat_map(|stage| &stage.loads);
    spec.loads.iter().chain(of_stages).map(|load| &**load)
}

/// The sets with loads or prescribed motion.
pub(super) fn sets_acted_on(spec: &SceneSpec) -> Vec<&str> {
    let prescribed = spec.supports.iter().filter_map(|support| match &**support {
        Support::Prescribed { set, .. } => Some(set),
        _ => None,
    });
    let sets = loads(spec).filter_map(Load::set).chain(prescribed);
    sets.map(|set| set.as_str()).collect()
}

/// The sets of nodal forces.
pub(super) fn nodal_loads(spec: &SceneSpec) -> Vec<&str> {
    let nodal = loads(spec).filter_map(|load| match load {
        Load::Nodal { set, .. } => Some(set.as_str()),
        _ => None,
    });
    nodal.collect()
}

/// Damping ratio and frequencies (Hz) of the Rayleigh damping of a part.
fn rayleigh(part: &Part) -> Option<(Share, [Positive; 2])> {
    match part.damping.as_deref()? {
        Damping::Rayleigh { ratio, frequencies } => Some((*ratio, *frequencies)),
        _ => None,
    }
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
        let scene = FileScene::from(scene);
        let factor = kernel(&scene, &[]).unwrap();
        assert_eq!((factor.levels.len(), factor.own), (3, 1));
        let parts =
            ["bricks", "wedges"].map(|set| format!("[[part]]\nset = '{set}'\nmaterial = 'rock'\n"));
        let mut spec = with(&parts.concat());
        factor.levels[0].apply(&mut spec);
        let kernels = spec
            .parts
            .iter()
            .map(|part| part.kernel.as_deref().map(String::as_str));
        assert_eq!(kernels.collect::<Vec<_>>(), [Some("hex8-eas"), None]);
    }

    /// A scene with some tables.
    fn with(tables: &str) -> SceneSpec {
        let text = format!(
            "title = 'tables'\nmesh = {{ file = 'none.msh' }}\ntime = {{ duration = 1 }}\nmaterial = []\n{}{tables}",
            if tables.contains("[[part]]") {
                ""
            } else {
                "part = []\n"
            },
        );
        let file = powerhouse::SceneFile::parse(text, "tables.toml").unwrap();
        file.spec(None).unwrap()
    }

    /// Tolerances of stages are those of the file or the default ones, a hundredth and a hundred times as much, within
    /// the limits that statics can meet and a dynamic stage accepts.
    #[test]
    fn tolerances_stay_where_statics_can_meet_them() {
        let stages = ["tolerance = 1e-6", "", "tolerance = 1e-11"];
        let stages = stages.map(|keys| format!("[[stage]]\nname = 'stage'\n{keys}\n"));
        let spec = with(&stages.concat());
        let factor = statics(&spec.stages).unwrap();
        let tolerances = |level: usize| -> Vec<f64> {
            let mut spec = spec.clone();
            factor.levels[level].apply(&mut spec);
            let stages = spec.stages.iter();
            stages
                .map(|stage| stage.tolerance.as_ref().unwrap().get())
                .collect()
        };
        let expect = |level: usize, expected: [f64; 3]| {
            for (found, expected) in tolerances(level).into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found:e}");
            }
        };
        expect(0, [1e-8, 1e-10, 1e-11]);
        expect(2, [1e-4, 1e-6, 1e-9]);
        assert!(statics(&[]).is_none());
    }
}
