//! A cube of elastic bricks on a device and on the host: wall time of a step and the bits of the motion.
//!
//! `cargo run --release -p powerhouse-device --features cuda --example cube -- 51 1000` takes 51 bricks along each edge and
//! 1000 steps, in double, mixed and single precision, on the first card of the machine; without the feature `cuda`, or with `emulated` as
//! third argument, on the emulated device, whose time says nothing of a card.

use std::sync::Arc;
use std::time::Instant;

use powerhouse_device::EmulatedDevices;
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{Explicit, ExplicitOnDevice, Leapfrog};
use powerhouse_material_damage::{LinearElastic, media};
use powerhouse_model::{
    BlockOptions, DeviceError, Engine, Mesh, ModelSpec, Precision, RunOptions, StepChoice,
    StepDevices, Support, Vec3,
};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn devices(emulated: bool) -> Result<Arc<dyn StepDevices>, DeviceError> {
    #[cfg(feature = "cuda")]
    if !emulated {
        powerhouse_device::CudaDevice::new()?;
        return Ok(Arc::new(powerhouse_device::CudaDevices));
    }
    let _ = emulated;
    Ok(Arc::new(EmulatedDevices))
}

/// Motion after a number of steps, and wall time of all but the first (s).
fn run(
    engine: &dyn Engine,
    mesh: &Mesh,
    precision: Precision,
    steps: u64,
) -> Outcome<(Vec<u64>, f64, String)> {
    let mut options = BlockOptions::default();
    options.precision = precision;
    let law = LinearElastic::new(media::ROCK);
    let bottom = mesh.nodes_of_facets(mesh.facet_set("bottom")?);
    let factory = SolidKernel::ONE_POINT.factory("rock", law, options);
    let spec = ModelSpec::new(mesh)
        .elements("rock", factory)
        .support(Support::fixed(bottom));
    let mut model = engine.build(spec)?;
    let positions = mesh.positions();
    let velocity: Vec<Vec3> = positions
        .iter()
        .map(|x| Vec3::new((0.2 * x.z).sin(), (0.3 * x.x).cos(), (0.1 * x.y).sin()) * 1e-2)
        .collect();
    model.set_initial(&vec![Vec3::zeros(); velocity.len()], &velocity)?;
    let options = RunOptions::steps(steps).with_step(StepChoice::Fixed(1e-4));
    let mut started = Instant::now();
    let ran = model.run(&Leapfrog, &options, &mut [], &mut |progress| {
        if progress.done == 1 {
            started = Instant::now();
        }
    });
    let report = ran.map_err(|failure| failure.error)?;
    let wall = started.elapsed().as_secs_f64();
    let nodes = 0..mesh.node_count() as u32;
    let motion = nodes.flat_map(|n| [model.displacement(n), model.velocity(n)]);
    let bits = motion.flat_map(|v| [v.x, v.y, v.z].map(f64::to_bits));
    let device = report.device.map_or(String::new(), |device| device.name);
    Ok((bits.collect(), wall, device))
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |index: usize, default: u64| -> Outcome<u64> {
        Ok(match arguments.get(index) {
            Some(text) => text.parse()?,
            None => default,
        })
    };
    let (edge, steps) = (number(1, 51)? as usize, number(2, 1000)?);
    let emulated = arguments.get(3).is_some_and(|text| text == "emulated");
    let high = Vec3::repeat(edge as f64);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [edge; 3], "rock")?;
    // Not one brick is like another, so that the geometry is read from memory.
    let mesh = mesh
        .map_positions(|x| x + 0.1 * Vec3::new((3.0 * x.y).sin(), (2.0 * x.z).cos(), x.x.sin()))?;
    let engine = ExplicitOnDevice::new(devices(emulated)?);
    println!("{} bricks, {steps} steps", mesh.element_count());
    for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
        let (of_host, host, _) = run(&Explicit, &mesh, precision, steps)?;
        let (of_device, device, name) = run(&engine, &mesh, precision, steps)?;
        let per_brick = |wall: f64| 1e9 * wall / ((steps - 1) as f64 * mesh.element_count() as f64);
        let different = of_host.iter().zip(&of_device).filter(|(a, b)| a != b);
        println!(
            "{precision:?}: host {:.2} ns, {name} {:.3} ns per brick and step with all transfers; {} of {} numbers differ",
            per_brick(host),
            per_brick(device),
            different.count(),
            of_host.len()
        );
    }
    Ok(())
}
