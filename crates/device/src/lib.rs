//! Time steps of a model on a graphics processor, from the programs of its elements.
//!
//! [`DeviceSteps`] is the [`StepDevice`](powerhouse_model::StepDevice) that an engine hands its unobserved steps. It writes kernels in CUDA C around the
//! [programs](powerhouse_model::ProgrammedBlock::program) of the elements, and runs them on a [`Device`]: a card of NVIDIA
//! (`CudaDevice`, feature `cuda`), or the host's own processor through a C++ compiler ([`EmulatedDevice`]), to test every
//! kernel where there is no card.
//!
//! # Why so
//! *Every sum has the order of the host.* Elements write their forces to places of their own; each node adds them element by element, block by block.
//! That moves more bytes than atomic additions, but the motion has the host's bits, so that a test compares bits and a
//! run may change between both.
//!
//! *What does not differ between elements is a number in the source*: on a mesh of equal bricks the geometry takes no memory.
//!
//! *Libraries of the card are opened when a device is asked for*: a program with this feature starts on machines without them.

mod device;
mod emulated;
mod layout;
mod source;
mod steps;

#[cfg(feature = "cuda")]
mod cuda;
#[cfg(feature = "cuda")]
mod nvrtc;

#[cfg(feature = "cuda")]
pub use cuda::{CudaDevice, CudaDevices};
pub use device::{Argument, Device, Memory};
pub use emulated::{EmulatedDevice, EmulatedDevices};
#[cfg(feature = "cuda")]
pub use nvrtc::{compile_for_card, nvrtc_is_present};
pub use steps::DeviceSteps;
