//! Independence of a scene's results from a device that takes the steps between two outputs.

use std::path::Path;
use std::sync::Arc;

use powerhouse::engine::{Engine, Explicit, ExplicitOnDevice, WaterMass};
use powerhouse::{FileScene, OutputPlan, ResidualLimit, Results, RunHooks, WaterBeside};
use powerhouse_device::{EmulatedDevice, EmulatedDevices};
use powerhouse_model::Precision;

/// A lined cavern of the data with water beside its lining on an engine, without the balance of energies, which devices do not compute.
fn run(engine: Arc<dyn Engine>, precision: Precision) -> Results {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes/cavern_small.toml");
    let scene = FileScene::from_file(file).unwrap().into_scene();
    let mut plan: OutputPlan = scene.output().clone();
    plan.energies = None;
    let water = WaterMass::Table {
        level: 0.0,
        depths: vec![0.0, 200.0],
        masses: vec![20.0, 90.0],
    };
    let scene = scene
        .water_beside(WaterBeside::new("intrados", water))
        .with_output(plan)
        .with_energy_residual(ResidualLimit::Unchecked)
        .with_duration(0.5)
        .with_precision(precision)
        .with_engine(engine);
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// A lined cavern with water, under an oblique wave through absorbing faces, has the same histories, section forces and envelopes on an emulated device,
/// which takes most of the steps.
#[test]
fn a_cavern_on_a_device_has_the_bits_of_the_host() {
    if let Err(error) = EmulatedDevice::new() {
        eprintln!("skipped: {error}");
        return;
    }
    for precision in [Precision::F64, Precision::Mixed] {
        let device: Arc<dyn Engine> = Arc::new(ExplicitOnDevice::new(Arc::new(EmulatedDevices)));
        let (host, device) = (run(Arc::new(Explicit), precision), run(device, precision));
        let share = device.run.device.as_ref().unwrap();
        assert!(
            2 * share.steps > device.run.steps,
            "{share:?} of {} {precision:?}",
            device.run.steps
        );
        assert!(host.run.device.is_none() && host.run.steps == device.run.steps);
        let bits = |results: &Results| -> Vec<u64> {
            let tables = [results.histories(), results.sections()];
            let columns = tables.into_iter().flat_map(|table| &table.columns);
            let values = columns.flat_map(|column| &column.values);
            values.map(|value| value.to_bits()).collect()
        };
        let (host, device) = (bits(&host), bits(&device));
        assert!(host.iter().filter(|&&bits| bits << 1 != 0).count() > 100);
        assert_eq!(host, device, "{precision:?}");
    }
}
