//! Compilation of kernels by NVRTC, the compiler that comes with CUDA.
#![expect(unsafe_code, reason = "the compiler has an interface in C")]

use std::collections::HashMap;
use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, LazyLock, Mutex};

use cudarc::nvrtc::{result, sys};
use powerhouse_model::DeviceError;

/// Machine code by source and capability of the card: cases of a sweep have the same kernels.
type Known = HashMap<(String, [i32; 2]), Arc<Vec<u8>>>;
static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);

/// Whether a library is on the machine; looking for it may panic.
pub(crate) fn is_found(is_present: unsafe fn() -> bool) -> bool {
    // SAFETY: the function opens a library of the system and closes it.
    let found = catch_unwind(AssertUnwindSafe(|| unsafe { is_present() }));
    found.unwrap_or(false)
}

/// Whether the compiler NVRTC (libnvrtc) is where the system looks for libraries; it needs no card.
pub fn nvrtc_is_present() -> bool {
    is_found(sys::is_culib_present)
}

/// Compiles a source in CUDA C to machine code for cards of a capability, such as `[9, 0]`, with exact arithmetic: products and sums that are
/// written apart are rounded apart, as on the host.
///
/// It is machine code in place of PTX, since drivers refuse PTX of a compiler that is newer than they are.
///
/// # Errors
/// [`DeviceError::Failed`] with the messages of the compiler, or if it does not know cards of this capability.
pub fn compile_for_card(
    source: &str,
    [major, minor]: [i32; 2],
) -> Result<Arc<Vec<u8>>, DeviceError> {
    let key = (source.to_owned(), [major, minor]);
    let lock = || {
        KNOWN
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    };
    if let Some(code) = lock().get(&key) {
        return Ok(code.clone());
    }
    let card = format!("sm_{major}{minor}");
    let operation = format!("the compilation of the kernels for {card}");
    let failed = |reason: String| DeviceError::failed(operation.clone(), reason);
    let text = CString::new(source).map_err(|error| failed(error.to_string()))?;
    let program =
        result::create_program(&text, None).map_err(|error| failed(format!("{error:?}")))?;
    let options = [
        "--fmad=false".to_owned(),
        "--ftz=false".to_owned(),
        "--prec-div=true".to_owned(),
        "--prec-sqrt=true".to_owned(),
        format!("--gpu-architecture={card}"),
    ];
    let compiled = machine_code(program, &options);
    // SAFETY: the program was created above and is used no more.
    let destroyed = unsafe { result::destroy_program(program) };
    let code = compiled.map_err(failed)?;
    destroyed.map_err(|error| failed(format!("{error:?}")))?;
    let code = Arc::new(code);
    lock().insert(key, code.clone());
    Ok(code)
}

/// Machine code of a program; messages of the compiler if it has none.
fn machine_code(program: sys::nvrtcProgram, options: &[String]) -> Result<Vec<u8>, String> {
    // SAFETY: the caller has created the program and destroys it afterwards.
    if let Err(error) = unsafe { result::compile_program(program, options) } {
        // SAFETY: as above; the log ends with a zero.
        let log = unsafe { result::get_program_log(program) };
        let log = log.map(|log| {
            // SAFETY: the log is a string that ends with a zero.
            let text = unsafe { CStr::from_ptr(log.as_ptr()) };
            text.to_string_lossy().into_owned()
        });
        return Err(format!("{error:?}: {}", log.unwrap_or_default().trim()));
    }
    let mut size = 0;
    // SAFETY: the program was compiled, and the size is written to a number of ours.
    let sized = unsafe { sys::nvrtcGetCUBINSize(program, &mut size) };
    sized.result().map_err(|error| format!("{error:?}"))?;
    let mut code = vec![0_u8; size];
    // SAFETY: the buffer has the size that the compiler asks for.
    let written = unsafe { sys::nvrtcGetCUBIN(program, code.as_mut_ptr().cast()) };
    written.result().map_err(|error| format!("{error:?}"))?;
    Ok(code)
}
