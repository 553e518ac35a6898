//! Emulation of a device by the host's own processor.
#![expect(
    unsafe_code,
    reason = "kernels are functions of a library that is compiled and opened at run time"
)]

use std::collections::HashMap;
use std::ffi::c_void;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};

use libloading::Library;
use powerhouse_model::{DeviceError, StepDevice, StepDevices};

use crate::device::{Argument, Device, Memory};
use crate::steps::DeviceSteps;

/// Kernel as a function: pointers to its arguments, and the number of threads.
type Kernel = unsafe extern "C" fn(*mut *mut c_void, usize);

/// Emulation of a device: kernels are compiled by the C++ compiler of the machine (`c++`, or that which the environment
/// variable `CXX` names) and run on one thread of the host.
///
/// It has the bits of a card with exact arithmetic and none of its speed: a test of kernels where there is no card.
#[derive(Default)]
pub struct EmulatedDevice {
    compiler: PathBuf,
    memory: Vec<Vec<u64>>,
    library: Option<Library>,
    kernels: HashMap<String, Kernel>,
}

impl EmulatedDevice {
    /// The emulation, if there is a compiler.
    ///
    /// # Errors
    /// [`DeviceError::Missing`] without a C++ compiler.
    pub fn new() -> Result<Self, DeviceError> {
        let compiler = std::env::var_os("CXX").unwrap_or_else(|| "c++".into());
        let ran = Command::new(&compiler).arg("--version").output();
        match ran {
            Ok(output) if output.status.success() => Ok(Self {
                compiler: compiler.into(),
                ..Self::default()
            }),
            Ok(output) => Err(missing(output.status)),
            Err(error) => Err(missing(error)),
        }
    }
}

fn missing(reason: impl ToString) -> DeviceError {
    let what = "a C++ compiler (`c++`, or that which CXX names)";
    DeviceError::missing(what, reason.to_string())
}

fn failed(operation: &str, reason: impl ToString) -> DeviceError {
    DeviceError::failed(operation, reason.to_string())
}

/// A folder of its own below that for temporary files, removed when it is dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> std::io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("powerhouse-device-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path)?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What cannot be removed stays among the temporary files.
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl Device for EmulatedDevice {
    fn name(&self) -> &str {
        "emulated device"
    }
    fn compile(&mut self, source: &str, kernels: &[String]) -> Result<(), DeviceError> {
        let folder = Folder::new().map_err(|error| failed("writing the kernels", error))?;
        let (text, binary) = (folder.0.join("kernels.cpp"), folder.0.join("kernels.so"));
        fs::write(&text, source).map_err(|error| failed("writing the kernels", error))?;
        let compiled = Command::new(&self.compiler)
            .args(["-O1", "-ffp-contract=off", "-shared", "-fPIC", "-o"])
            .args([&binary, &text])
            .output()
            .map_err(|error| failed("the C++ compiler", error))?;
        if !compiled.status.success() {
            let messages = String::from_utf8_lossy(&compiled.stderr);
            return Err(failed("the compilation of the kernels", messages));
        }
        self.kernels.clear();
        // SAFETY: the library is the one just compiled from our source, which has no initialisers.
        let library = unsafe { Library::new(&binary) };
        let library = library.map_err(|error| failed("opening the kernels", error))?;
        for name in kernels {
            // SAFETY: the source defines every kernel with this signature.
            let kernel = unsafe { library.get::<Kernel>(name.as_bytes()) };
            let kernel = kernel.map_err(|error| failed("finding a kernel", error))?;
            self.kernels.insert(name.clone(), *kernel);
        }
        self.library = Some(library);
        Ok(())
    }
    fn allocate(&mut self, bytes: usize) -> Result<Memory, DeviceError> {
        self.memory.push(vec![0; bytes.div_ceil(8)]);
        Ok(Memory(self.memory.len() - 1))
    }
    fn free_all(&mut self) {
        self.memory.clear();
    }
    fn write(&mut self, to: Memory, bytes: &[u8]) -> Result<(), DeviceError> {
        let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut self.memory[to.0]);
        let place = memory.get_mut(..bytes.len());
        place
            .ok_or_else(|| failed("a copy to the device", "it is longer than the memory"))?
            .copy_from_slice(bytes);
        Ok(())
    }
    fn read(&mut self, from: Memory, bytes: &mut [u8]) -> Result<(), DeviceError> {
        let memory: &[u8] = bytemuck::cast_slice(&self.memory[from.0]);
        let place = memory.get(..bytes.len());
        let place = place
            .ok_or_else(|| failed("a copy from the device", "it is longer than the memory"))?;
        bytes.copy_from_slice(place);
        Ok(())
    }
    fn launch(
        &mut self,
        kernel: &str,
        threads: usize,
        arguments: &[Argument],
    ) -> Result<(), DeviceError> {
        let function = self.kernels.get(kernel).copied();
        let function = function.ok_or_else(|| failed("a launch", format!("no kernel {kernel}")))?;
        // Every argument in eight bytes, and pointers to them.
        let mut values: Vec<u64> = Vec::with_capacity(arguments.len());
        for argument in arguments {
            values.push(match *argument {
                Argument::Memory(memory) => self.memory[memory.0].as_mut_ptr() as u64,
                Argument::Count(count) => count,
                Argument::Number(number) => number.to_bits(),
            });
        }
        let mut pointers: Vec<*mut c_void> = values
            .iter_mut()
            .map(|value| core::ptr::from_mut(value).cast())
            .collect();
        // SAFETY: the kernel reads as many arguments of these types as its source has, which `source` and `steps` keep equal, and
        // accesses memory of the lengths that were allocated for these numbers of nodes and elements.
        unsafe { function(pointers.as_mut_ptr(), threads) };
        Ok(())
    }
}

/// Source of emulated devices.
#[derive(Clone, Copy, Debug, Default)]
pub struct EmulatedDevices;

impl StepDevices for EmulatedDevices {
    fn name(&self) -> &str {
        "emulated device"
    }
    fn device(&self) -> Result<Box<dyn StepDevice>, DeviceError> {
        Ok(Box::new(DeviceSteps::new(Box::new(EmulatedDevice::new()?))))
    }
}
