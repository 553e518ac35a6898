//! The coarse cavern with its lining on a joint.

use std::path::Path;

use powerhouse::{FileScene, Results, RunHooks, TimeStep};

/// A scene of the data for two seconds, at a step that is stable for both meshes.
fn run(file: &str) -> Results {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../data/scenes")
        .join(file);
    let scene = FileScene::from_file(path).unwrap().into_scene();
    let scene = scene
        .with_duration(2.0)
        .with_step(TimeStep::Seconds(4.5e-4));
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// A bonded joint has no effect beyond rounding until it cracks; then the motion of the lining differs. The
/// energies of friction, bond failure and impact are terms of their own, and the balance closes to 1e-6 of the
/// input.
#[test]
fn a_bond_changes_nothing_until_it_cracks() {
    let (joint, whole) = (run("cavern_joint.toml"), run("cavern_small.toml"));
    let outcome = &joint.joint_outcomes[0];
    assert_eq!((outcome.name.as_str(), outcome.pairs), ("rock-lining", 262));
    let (cracked, _) = outcome.first_crack.unwrap();
    let (slid, _) = outcome.first_slip.unwrap();
    assert!(cracked > 1.0 && cracked < 2.0, "{cracked}");
    for name in ["crown.ux", "crown.uz", "crown-to-floor.apart"] {
        let times = &joint.histories().times;
        assert_eq!(times, &whole.histories().times);
        let [a, b] =
            [&joint, &whole].map(|results| &results.histories().column(name).unwrap().values);
        let size = b.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let apart = |within: &dyn Fn(f64) -> bool| {
            let rows = times
                .iter()
                .zip(a.iter().zip(b))
                .filter(|(t, _)| within(**t));
            rows.map(|(_, (a, b))| (a - b).abs()).fold(0.0, f64::max) / size
        };
        let first = cracked.min(slid);
        let before = apart(&|t| t < first);
        assert!(before < 1e-10, "{name}: {before:e}");
        assert!(apart(&|t| t > first) > 1e-3, "{name}");
    }
    let terms = joint.energy_terms();
    for name in ["friction", "bond", "impact"] {
        let energy = terms.iter().find(|(term, _)| *term == name).unwrap().1;
        assert!(energy > 1e3, "{name}: {energy}");
    }
    let residual = joint.energy_residual().unwrap();
    assert!(residual.share_of_input.unwrap() < 1e-6 && residual.largest < 1e-6);
}
