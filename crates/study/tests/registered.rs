//! What a program registers, laws, boundaries and kernels, is known to every study of a scene.

use std::sync::Arc;

use powerhouse::boundary::Viscous;
use powerhouse::engine::Hex8Full;
use powerhouse::model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, ElasticMedium, HistoryVariable, LawInput,
    ModelError, PointLaw, Stress,
};
use powerhouse::{FileScene, Kernel, Material, Registry};
use powerhouse_study::saving::{Change, FormatError};
use powerhouse_study::sweep::Sweep;
use powerhouse_study::trade::{Goal, NoProgress, Trade};
use powerhouse_study::{advise_boundary, check, sweep};

use crate::block::Folder;

/// Soil whose shear modulus falls with the shear strain (Hardin & Drnevich 1972).
#[derive(Clone)]
struct Hyperbolic {
    medium: ElasticMedium,
    reference_strain: f64,
}

impl PointLaw for Hyperbolic {
    fn name(&self) -> &str {
        "hyperbolic"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        &[]
    }
    fn stress_change(&self, input: &LawInput<f64>, _new_history: &mut [f64]) -> Stress {
        let [.., xy, yz, zx] = input.strain.0;
        let shear_strain = (xy * xy + yz * yz + zx * zx).sqrt();
        let softening = 1.0 / (1.0 + shear_strain / self.reference_strain);
        let mut stress = Stress::elastic(self.medium.lambda(), self.medium.shear(), &input.strain);
        for shear in &mut stress.0[3..] {
            *shear *= softening;
        }
        stress
    }
}

/// Keys of the law.
#[derive(serde::Deserialize, powerhouse::schemars::JsonSchema)]
#[schemars(crate = "powerhouse::schemars")]
#[serde(deny_unknown_fields)]
struct HyperbolicKeys {
    /// Strain at which half the modulus is left.
    reference_strain: f64,
}

/// No keys.
#[derive(serde::Deserialize, powerhouse::schemars::JsonSchema)]
#[schemars(crate = "powerhouse::schemars")]
#[serde(deny_unknown_fields)]
struct NoKeys {}

/// The dashpots of the software under a name of a program.
struct Dashpots(Viscous);

impl AbsorbingBoundary for Dashpots {
    fn name(&self) -> &str {
        "dashpots"
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        self.0.build(site)
    }
}

/// The names of the software, a law, two boundaries and a kernel.
fn own() -> Registry {
    let mut registry = Registry::default();
    registry.add_law("hyperbolic", |keys: HyperbolicKeys| {
        Ok(Material::from_point_law(Hyperbolic {
            medium: ElasticMedium::new(9e9, 0.27, 2750.0)?,
            reference_strain: keys.reference_strain,
        }))
    });
    let dashpots = || Arc::new(Dashpots(Viscous::default()));
    registry.add_boundary("dashpots", move |_: NoKeys| Ok(dashpots()));
    registry.add_boundary("tuned", move |_: HyperbolicKeys| Ok(dashpots()));
    registry.add_kernel("my-brick", Kernel::own(Hex8Full));
    registry
}

/// A block of a registered law under a wave.
const SCENE: &str = r#"
title = "block"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "hyperbolic"
reference_strain = 1e-2
[[part]]
set = "rock"
material = "rock"
[[wave]]
kind = "sv"
incidence = 20
pulse = { kind = "smooth", displacement = 0.01, duration = 0.25 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 120]
speed_ratio = 1
[time]
duration = 0.3
[output]
every = 0.01
[[output.history]]
name = "middle"
at = [60, 60, 60]
quantities = ["displacement"]
"#;

impl Folder {
    fn read(&self) -> FileScene {
        FileScene::from_file_with(self.scene(), &own()).unwrap()
    }
}

/// A case of a scene with a registered law runs in a sweep that is given the registry, and in no other; it is
/// run again when the version of the registry changes, and not before.
#[test]
fn a_registered_law_is_swept() {
    let folder = Folder::new("sweep", &format!("{SCENE}[[case]]\nname = \"whole\"\n"), 4);
    assert!(Sweep::of_file(folder.scene(), Some(folder.out())).is_err());
    /// Counts the cases that were finished before.
    #[derive(Default)]
    struct Kept(usize);
    impl sweep::SweepWatch for Kept {
        fn reused(&mut self, _case: &str) {
            self.0 += 1;
        }
    }
    let kept = |registry: &Registry| {
        let sweep = Sweep::of_file_with(folder.scene(), Some(folder.out()), registry).unwrap();
        let mut watch = Kept::default();
        let outcomes = sweep.run(None, &mut watch).unwrap();
        assert_eq!(outcomes.len(), 1);
        assert!(outcomes[0].steps > 3);
        watch.0
    };
    assert_eq!(kept(&own()), 0);
    assert_eq!(kept(&own()), 1);
    assert_eq!(kept(&own().with_version("2")), 0);
}

/// Registered boundaries that do without keys and registered kernels are levels of a trade of a scene with a
/// registered law, and are run.
#[test]
fn registered_parts_are_traded() {
    let scene = SCENE.replacen("[[part]]\n", "[[part]]\nkernel = \"hex8-full\"\n", 1);
    let folder = Folder::new("trade", &scene, 4);
    let trade = Trade::of_file_with(folder.scene(), Some(folder.out()), &own()).unwrap();
    let mut trade = (trade.window(0.2).only(&["boundary", "kernel"]).unwrap()).with_every_history();
    let levels = |name: &str| -> Vec<String> {
        let mut factors = trade.factors().iter();
        let factor = factors.find(|factor| factor.name == name).unwrap();
        factor
            .levels
            .iter()
            .map(|level| level.name.clone())
            .collect()
    };
    assert_eq!(
        levels("boundary"),
        ["viscous-spring", "viscous", "dashpots"]
    );
    assert_eq!(
        levels("kernel"),
        [
            "hex8-eas",
            "hex8-full",
            "hex8-natural",
            "hex8-one-point",
            "my-brick"
        ]
    );
    let report = trade.run(Goal::Front, None, &mut NoProgress).unwrap();
    assert!(report.failed.is_empty(), "{:?}", report.failed);
    let error = |name: &str| {
        let mut cases = report.cases.iter();
        cases.find(|case| case.name == name).unwrap().error
    };
    // The same brick, one point at a time.
    let (own, built_in) = (error("kernel my-brick"), error("kernel hex8-full"));
    assert!(
        own > 0.0 && (own - built_in).abs() < 1e-9,
        "{own} {built_in}"
    );
    // The same dashpots.
    let (own, built_in) = (error("boundary dashpots"), error("boundary viscous"));
    assert!(
        own > 0.0 && (own - built_in).abs() < 1e-12,
        "{own} {built_in}"
    );
}

/// Savings of a scene with a registered law are measured on the scene itself; a change that is refused is
/// named with the reason.
#[test]
fn savings_know_registered_laws() {
    let mixed = Folder::new("mixed", &format!("precision = \"mixed\"\n{SCENE}"), 4);
    let format = FormatError::of(&mixed.read()).unwrap().unwrap();
    let known = format.error.share.or(format.error.least);
    assert!(known.is_some_and(|error| error < 0.1), "{format:?}");

    // Flat damping in series with a law for one point is not possible.
    let damping = "damping = { kind = \"rayleigh\", ratio = 0.01, frequencies = [1, 10] }\n";
    let damped = SCENE.replace("[[wave]]", &format!("{damping}[[wave]]"));
    let damped = Folder::new("damped", &damped, 4);
    let report = check(damped.read()).unwrap();
    let refused: Vec<&Change> = report
        .refused
        .iter()
        .map(|refused| &refused.change)
        .collect();
    assert_eq!(refused, [&Change::FlatDamping], "{:?}", report.refused);
    assert!(
        report.refused[0].reason.contains("hyperbolic"),
        "{:?}",
        report.refused
    );
}

/// A registered boundary that does without keys is a candidate of advice; others are left out with the reason.
#[test]
fn a_registered_boundary_is_a_candidate() {
    let folder = Folder::new("advice", SCENE, 4);
    let advice = advise_boundary(&folder.read(), 0.05).unwrap();
    let mut candidates = advice.candidates.iter();
    let found = candidates.find(|candidate| candidate.kind.name() == "dashpots");
    let found = found.unwrap();
    assert!(!found.kind.resists_static_loads());
    // Waves that come straight on are absorbed.
    assert!(
        found.reflected.iter().all(|share| *share < 1e-12),
        "{:?}",
        found.reflected
    );
    assert_eq!(advice.condition(&found.kind).unwrap().name(), "dashpots");
    let left_out: Vec<&str> = advice
        .left_out
        .iter()
        .map(|out| out.name.as_str())
        .collect();
    assert_eq!(left_out, ["tuned"]);
    assert!(advice.to_string().contains("tuned is no candidate"));

    // A registry of another program knows nothing of it.
    let text = SCENE.replace(
        "hyperbolic\"\nreference_strain = 1e-2",
        "elastic\"\nyoung = 9e9\npoisson = 0.27\ndensity = 2750",
    );
    let plain = FileScene::from_toml(text, folder.scene(), &Registry::default()).unwrap();
    let advice = advise_boundary(&plain, 0.05).unwrap();
    assert!(advice.left_out.is_empty());
    assert!(
        advice
            .candidates
            .iter()
            .all(|candidate| candidate.kind.name() != "dashpots")
    );
}
