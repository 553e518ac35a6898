//! Output requests: every key of a scene file gives the plan of the Rust interface.

use powerhouse::engine::observe::{
    CrossSection, Motion, ObservationPoint, Place, SectionReinforcement, SnapshotFields,
    StressPlace,
};
use powerhouse::model::Vec3;
use powerhouse::{EnvelopeRequest, OutputPlan, SectionRequest, SnapshotRequest};

use super::support::*;

const HISTORY: &str = "[[output.history]]\nname = \"surface\"\nat = [150, 150, 0]\n";

/// Plan of the file without its history.
fn plan() -> OutputPlan {
    OutputPlan::default().with_every(0.01).with_energies(0.006)
}

/// Every location, quantity and sampling interval of a file is in the plan.
#[test]
fn plans() {
    let variants = Variants::new("plans");
    let spot = Vec3::new(20.0, 30.0, -40.0);
    let near = ObservationPoint::at(Vec3::new(20.0, 30.0, 0.4)).within(0.5);
    let stress = Motion::default();
    let velocity = Motion::VELOCITY;
    for (keys, expected) in [
        (
            "[[output.history]]\nname = \"p\"\nnode = 17\nquantities = [\"velocity\"]",
            plan().history("p", Place::Node(17), velocity),
        ),
        (
            "[[output.history]]\nname = \"p\"\nset = \"left\"",
            plan().history("p", Place::NodeSet("left".into()), Motion::ALL),
        ),
        (
            "[[output.history]]\nname = \"p\"\nat = [20, 30, -40]\nquantities = [\"stress\", \"displacement\"]",
            plan()
                .history("p", spot, Motion::DISPLACEMENT)
                .stress("p", spot),
        ),
        (
            "[[output.history]]\nname = \"p\"\nat = [20, 30, -40]\nquantities = [\"stress\"]",
            plan().stress("p", spot),
        ),
        (
            "[[output.history]]\nname = \"p\"\nelement = 8",
            plan().stress("p", StressPlace::Element(8)),
        ),
        (
            "[[output.history]]\nname = \"p\"\nat = [20, 30, 0.4]\nwithin = 0.5\nin_set = \"rock\"",
            plan().history("p", near.clone().among("rock"), Motion::ALL),
        ),
        (
            "[[output.relative]]\nname = \"p\"\nat = [20, 30, 0.4]\nfrom_node = 12\nwithin = 0.5",
            plan().relative("p", near, Place::Node(12)),
        ),
        (
            "[[output.relative]]\nname = \"p\"\nset = \"top\"\nfrom_set = \"bottom\"",
            plan().relative(
                "p",
                Place::NodeSet("top".into()),
                Place::NodeSet("bottom".into()),
            ),
        ),
        (
            "[[output.relative]]\nname = \"p\"\nnode = 3\nfrom = [20, 30, -40]",
            plan().relative("p", Place::Node(3), spot),
        ),
        (
            "[[output.section]]\nname = \"p\"\nset = \"rock\"\nat = [20, 30, -40]\nnormal = [0, 0, 2]\nalong = [1, 0, 0]\nhalf_extent = 60",
            plan().cut(
                "rock",
                CrossSection {
                    name: "p".into(),
                    point: spot,
                    normal: Vec3::new(0.0, 0.0, 2.0),
                    along: Vec3::x(),
                    within: Some((spot - Vec3::repeat(60.0), spot + Vec3::repeat(60.0))),
                },
            ),
        ),
        (
            "[[output.section]]\nname = \"p\"\nset = \"rock\"\nat = [20, 30, -40]\nnormal = [0, 0, 1]\nalong = [1, 0, 0]\nreinforcement = { concrete_strength = 1.5e7, bars = [0, 2e-3], cover = 0.05, yield_stress = 4.35e8 }",
            {
                let mut plan = plan();
                let cut = CrossSection {
                    name: "p".into(),
                    point: spot,
                    normal: Vec3::z(),
                    along: Vec3::x(),
                    within: None,
                };
                let reinforcement = SectionReinforcement {
                    concrete_strength: 1.5e7,
                    bars: [0.0, 2.0e-3],
                    cover: 0.05,
                    yield_stress: 4.35e8,
                };
                plan.cuts
                    .push(SectionRequest::new("rock", cut).with_reinforcement(reinforcement));
                plan
            },
        ),
        (
            "[output.envelope]\nquantities = [\"stress\", \"velocity\"]\nsets = [\"rock\"]\nevery = 0.02",
            plan().with_envelope(
                EnvelopeRequest::new(0.02)
                    .with_motion(velocity)
                    .with_stress(true)
                    .with_sets(vec!["rock".into()]),
            ),
        ),
        (
            "[output.envelope]",
            plan().with_envelope(EnvelopeRequest::new(0.01)),
        ),
        (
            "[output.snapshots]\nevery = 0.1\nquantities = [\"stress\"]",
            plan().with_snapshots(SnapshotRequest::new(0.1).with_fields(SnapshotFields {
                motion: stress,
                stress: true,
            })),
        ),
    ] {
        let scene = variants.read(HISTORY, keys);
        let scene = scene.unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert_eq!(scene.output(), &expected, "{keys}");
        scene
            .prepare()
            .unwrap_or_else(|error| panic!("{keys}: {error}"));
    }
    let scene = variants.read("every = 0.01", "energies = 0.05").unwrap();
    let plan = scene.output();
    assert_eq!((plan.every, plan.energies), (0.005, Some(0.05)));
}

/// The results folder is given in the file, or has the name of the file.
#[test]
fn directories() {
    let variants = Variants::new("directories");
    let scene = variants.read(HISTORY, HISTORY).unwrap();
    assert_eq!(scene.result_folder(), std::path::Path::new("results/cube"));
    let scene = variants.read("every = 0.01", "directory = \"elsewhere/x\"");
    assert_eq!(
        scene.unwrap().result_folder(),
        std::path::Path::new("elsewhere/x")
    );
}
