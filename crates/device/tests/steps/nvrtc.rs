//! Sources of kernels compile for cards.

use std::sync::Arc;

use powerhouse_device::{
    Argument, Device, DeviceSteps, Memory, compile_for_card, nvrtc_is_present,
};
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::ExplicitOnDevice;
use powerhouse_material_damage::{LinearElastic, media, presets};
use powerhouse_model::{DeviceError, RunOptions, StepDevice, StepDevices};

use super::{ALL, Case, go, mesh, soft_rock};

/// Compiles for cards and launches nothing.
struct Compiler;
impl Device for Compiler {
    fn name(&self) -> &str {
        "compiler"
    }
    fn compile(&mut self, source: &str, _kernels: &[String]) -> Result<(), DeviceError> {
        for capability in [[8, 0], [9, 0]] {
            let code = compile_for_card(source, capability)?;
            assert!(code.len() > 10_000, "{}", code.len());
        }
        Ok(())
    }
    fn allocate(&mut self, _bytes: usize) -> Result<Memory, DeviceError> {
        Ok(Memory(0))
    }
    fn free_all(&mut self) {}
    fn write(&mut self, _to: Memory, _bytes: &[u8]) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read(&mut self, _from: Memory, _bytes: &mut [u8]) -> Result<(), DeviceError> {
        Ok(())
    }
    fn launch(&mut self, _: &str, _: usize, _: &[Argument]) -> Result<(), DeviceError> {
        Ok(())
    }
}
struct Compilers;
impl StepDevices for Compilers {
    fn name(&self) -> &str {
        "compiler"
    }
    fn device(&self) -> Result<Box<dyn StepDevice>, DeviceError> {
        Ok(Box::new(DeviceSteps::new(Box::new(Compiler))))
    }
}
/// The kernels of every element and law are a source that NVRTC compiles for cards of NVIDIA.
#[test]
#[ignore = "needs NVRTC (libnvrtc.so.12)"]
fn kernels_compile_with_nvrtc() {
    assert!(nvrtc_is_present(), "libnvrtc was not found");
    let engine = ExplicitOnDevice::new(Arc::new(Compilers));
    let compile = |case: Case| {
        let mesh = mesh(case.kernel.kind());
        let model = case.build(&engine, &mesh).unwrap();
        // The first and the last step are the host's.
        go(model, &RunOptions::steps(2), [1, 1]).unwrap();
    };
    for precision in ALL {
        for kernel in SolidKernel::ALL {
            compile(
                Case::new(kernel, LinearElastic::new(media::ROCK), precision).damped(1.0, 1e-5),
            );
        }
        compile(Case::new(SolidKernel::Hex8Natural, soft_rock(), precision).damped(1.0, 1e-5));
        compile(Case::new(
            SolidKernel::Hex8Eas,
            presets::paper_concrete().unwrap(),
            precision,
        ));
    }
}
