//! Interface of processors with memory and kernels of their own.

use powerhouse_model::DeviceError;

/// Memory of a device, by a number that the device chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory(pub usize);

/// Argument of a kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Argument {
    /// Address of memory of the device.
    Memory(Memory),
    /// A number of things.
    Count(u64),
    /// A number in double precision.
    Number(f64),
}

/// Processor with memory and kernels of its own. Kernels run one after the other, in the order of their launches.
pub trait Device: Send {
    /// Name of the device in reports.
    fn name(&self) -> &str;
    /// Compiles a source in CUDA C, in place of the one before; its kernels can then be launched by name.
    ///
    /// # Errors
    /// The messages of the compiler.
    fn compile(&mut self, source: &str, kernels: &[String]) -> Result<(), DeviceError>;
    /// Allocates memory of a number of bytes, all zero.
    ///
    /// # Errors
    /// Too little memory.
    fn allocate(&mut self, bytes: usize) -> Result<Memory, DeviceError>;
    /// Frees all memory.
    fn free_all(&mut self);
    /// Writes bytes to the start of memory.
    ///
    /// # Errors
    /// A failure of the copy.
    fn write(&mut self, to: Memory, bytes: &[u8]) -> Result<(), DeviceError>;
    /// Reads bytes from the start of memory, after all kernels launched before.
    ///
    /// # Errors
    /// A failure of the copy, or of a kernel before it.
    fn read(&mut self, from: Memory, bytes: &mut [u8]) -> Result<(), DeviceError>;
    /// Launches a kernel on a number of threads, which it receives as its last argument; it may end later.
    ///
    /// # Errors
    /// A kernel that does not exist or cannot be launched.
    fn launch(
        &mut self,
        kernel: &str,
        threads: usize,
        arguments: &[Argument],
    ) -> Result<(), DeviceError>;
}
