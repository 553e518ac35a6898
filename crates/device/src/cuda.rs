//! Cards of NVIDIA, by their driver and the compiler NVRTC.
#![expect(
    unsafe_code,
    reason = "libraries are opened and kernels launched through interfaces in C"
)]

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use cudarc::driver::{
    CudaContext, CudaFunction, CudaSlice, CudaStream, LaunchConfig, PushKernelArg,
};
use cudarc::nvrtc::Ptx;
use powerhouse_model::{DeviceError, StepDevice, StepDevices};

use crate::device::{Argument, Device, Memory};
use crate::nvrtc::{compile_for_card, is_found};
use crate::steps::DeviceSteps;

/// Threads of a block of a launch.
const BLOCK: u32 = 128;

/// Card of NVIDIA: the first one of the machine.
pub struct CudaDevice {
    name: String,
    context: Arc<CudaContext>,
    stream: Arc<CudaStream>,
    memory: Vec<CudaSlice<u8>>,
    kernels: HashMap<String, CudaFunction>,
}

fn failed(operation: &str, reason: impl core::fmt::Display) -> DeviceError {
    DeviceError::failed(operation, reason.to_string())
}

/// Refuses a library that is not on the machine.
fn check_library(what: &str, is_present: unsafe fn() -> bool) -> Result<(), DeviceError> {
    let reason = "its library was not found where the system looks for libraries (LD_LIBRARY_PATH)";
    if is_found(is_present) {
        Ok(())
    } else {
        Err(DeviceError::missing(what, reason))
    }
}

/// The context of the first card, one for all models: to make it takes some tenths of a second.
fn context() -> Result<Arc<CudaContext>, DeviceError> {
    static CONTEXT: Mutex<Option<Arc<CudaContext>>> = Mutex::new(None);
    let mut known = CONTEXT
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some(context) = &*known {
        return Ok(context.clone());
    }
    let no_card = |error| DeviceError::missing("a card of NVIDIA", format!("{error}"));
    let context = CudaContext::new(0).map_err(no_card)?;
    // SAFETY: the memory of a device is used on its own stream alone, in order; nothing has to wait for another stream.
    unsafe { context.disable_event_tracking() };
    Ok(known.insert(context).clone())
}

impl CudaDevice {
    /// The first card of the machine.
    ///
    /// # Errors
    /// [`DeviceError::Missing`] without a driver, without the compiler NVRTC, or without a card.
    pub fn new() -> Result<Self, DeviceError> {
        check_library(
            "the driver of a card (libcuda)",
            cudarc::driver::sys::is_culib_present,
        )?;
        check_library(
            "the compiler NVRTC of CUDA 12 (libnvrtc)",
            cudarc::nvrtc::sys::is_culib_present,
        )?;
        let context = context()?;
        let name = context.name().map_err(|error| failed("its name", error))?;
        // One for each model, so that cases of a sweep share the card.
        let stream = context.new_stream();
        Ok(Self {
            name,
            stream: stream.map_err(|error| failed("a stream", error))?,
            context,
            memory: Vec::new(),
            kernels: HashMap::new(),
        })
    }
}

impl Drop for CudaDevice {
    fn drop(&mut self) {
        self.free_all();
    }
}

impl Device for CudaDevice {
    fn name(&self) -> &str {
        &self.name
    }
    fn compile(&mut self, source: &str, kernels: &[String]) -> Result<(), DeviceError> {
        let capability = self.context.compute_capability();
        let (major, minor) = capability.map_err(|error| failed("its capability", error))?;
        let code = compile_for_card(source, [major, minor])?;
        let module = self.context.load_module(Ptx::from_binary(code.to_vec()));
        let module = module.map_err(|error| failed("loading the kernels", error))?;
        self.kernels.clear();
        for name in kernels {
            let kernel = module.load_function(name);
            let kernel = kernel.map_err(|error| failed("finding a kernel", error))?;
            self.kernels.insert(name.clone(), kernel);
        }
        Ok(())
    }
    fn allocate(&mut self, bytes: usize) -> Result<Memory, DeviceError> {
        let memory = self.stream.alloc_zeros::<u8>(bytes.max(8));
        let memory = memory.map_err(|error| {
            let operation = format!("an allocation of {:.1} MB", bytes as f64 / 1e6);
            failed(&operation, error)
        })?;
        self.memory.push(memory);
        Ok(Memory(self.memory.len() - 1))
    }
    fn free_all(&mut self) {
        // Memory is freed by the context of the thread, which this may be the first to use; a failure leaves it to the end of the process.
        let _ = self.context.bind_to_thread();
        self.memory.clear();
    }
    fn write(&mut self, to: Memory, bytes: &[u8]) -> Result<(), DeviceError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let copied = self.stream.memcpy_htod(bytes, &mut self.memory[to.0]);
        copied.map_err(|error| failed("a copy to the device", error))?;
        // The bytes may be freed as soon as this returns.
        let ended = self.stream.synchronize();
        ended.map_err(|error| failed("a copy to the device", error))
    }
    fn read(&mut self, from: Memory, bytes: &mut [u8]) -> Result<(), DeviceError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let view = self.memory[from.0].slice(..bytes.len());
        let copied = self.stream.memcpy_dtoh(&view, bytes);
        copied.map_err(|error| failed("a copy from the device", error))?;
        let ended = self.stream.synchronize();
        ended.map_err(|error| failed("the kernels", error))
    }
    fn launch(
        &mut self,
        kernel: &str,
        threads: usize,
        arguments: &[Argument],
    ) -> Result<(), DeviceError> {
        if threads == 0 {
            return Ok(());
        }
        let function = self.kernels.get(kernel);
        let function = function.ok_or_else(|| failed("a launch", format!("no kernel {kernel}")))?;
        let blocks = u32::try_from(threads.div_ceil(BLOCK as usize));
        let blocks = blocks.map_err(|_| failed("a launch", format!("{threads} threads")))?;
        let count = threads as u64;
        let mut launch = self.stream.launch_builder(function);
        for argument in arguments {
            match argument {
                Argument::Memory(memory) => launch.arg(&self.memory[memory.0]),
                Argument::Count(count) => launch.arg(count),
                Argument::Number(number) => launch.arg(number),
            };
        }
        launch.arg(&count);
        let shape = LaunchConfig {
            grid_dim: (blocks, 1, 1),
            block_dim: (BLOCK, 1, 1),
            shared_mem_bytes: 0,
        };
        // SAFETY: the kernel has as many arguments of these types as its source, which `source` and `steps` keep equal, and
        // accesses memory of the lengths that were allocated for these numbers of nodes and elements.
        let launched = unsafe { launch.launch(shape) };
        launched
            .map(|_| ())
            .map_err(|error| failed("a launch", error))
    }
}

/// Source of devices that are the first card of the machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct CudaDevices;

impl StepDevices for CudaDevices {
    fn name(&self) -> &str {
        "gpu"
    }
    fn device(&self) -> Result<Box<dyn StepDevice>, DeviceError> {
        Ok(Box::new(DeviceSteps::new(Box::new(CudaDevice::new()?))))
    }
}
