//! Trap for errors of MuJoCo, which end the process if they are not caught.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::{self, NonNull};

/// A function that `mjb_apply` calls with model, data, number of the simulation and argument.
pub type Body = unsafe extern "C-unwind" fn(*const c_void, *mut c_void, c_int, *mut c_void);

/// `mjBatchConfig`
#[repr(C)]
struct Config {
    threads: c_int,
    persistent: u8,
}

/// `mjb_makeBatch`
pub type MakeBatch = unsafe extern "C" fn(*const c_void, c_int, *const c_void, *mut c_char, c_int) -> *mut c_void;
/// `mjb_deleteBatch`
pub type DeleteBatch = unsafe extern "C" fn(*mut c_void);
/// `mjb_apply`
pub type Apply = unsafe extern "C-unwind" fn(*mut c_void, *const c_int, c_int, Body, *mut c_void, c_int) -> c_int;
/// `mjb_error`
pub type ErrorText = unsafe extern "C" fn(*const c_void, c_int) -> *const c_char;

/// Functions of `mjbatch.h`.
#[derive(Clone, Copy, Debug)]
pub struct Functions {
    /// makes a batch
    pub make: MakeBatch,
    /// deletes it
    pub delete: DeleteBatch,
    /// runs a function in it
    pub apply: Apply,
    /// returns the error of a simulation
    pub error: ErrorText,
}

/// A batch of one simulation, whose own state is not used.
pub struct Trap {
    functions: Functions,
    batch: NonNull<c_void>,
}

// SAFETY: a batch may be used from any thread, one at a time.
unsafe impl Send for Trap {}
// SAFETY: it is used by `&mut` only.
unsafe impl Sync for Trap {}

impl Trap {
    /// A trap around a batch of `model`, preferably an empty one.
    ///
    /// # Errors
    /// The message of MuJoCo.
    ///
    /// # Safety
    /// `functions` are those of MuJoCo 4 and `model` is an `mjModel`.
    pub unsafe fn new(functions: Functions, model: *const c_void) -> Result<Self, String> {
        let config = Config { threads: 1, persistent: 0 };
        let mut words = [0; 500];
        // SAFETY: by the contract of this function; 500 fits.
        let batch = unsafe {
            let length = c_int::try_from(words.len()).unwrap_or(0);
            (functions.make)(model, 1, (&raw const config).cast(), words.as_mut_ptr(), length)
        };
        match NonNull::new(batch) {
            Some(batch) => Ok(Self { functions, batch }),
            // SAFETY: MuJoCo ends its text with a zero.
            None => Err(unsafe { text(words.as_ptr()) }),
        }
    }

    /// Calls `work` on this thread.
    ///
    /// # Errors
    /// Message of a MuJoCo error in it. `work` is then left early: it must hold no value with a destructor while
    /// it calls MuJoCo.
    pub fn run<F: FnMut()>(&mut self, mut work: F) -> Result<(), String> {
        let (batch, argument) = (self.batch.as_ptr(), (&raw mut work).cast());
        // SAFETY: `work` outlives the call, and `call` takes it for what it is.
        unsafe {
            if (self.functions.apply)(batch, ptr::null(), 0, call::<F>, argument, 0) == 0 {
                return Ok(());
            }
            Err(text((self.functions.error)(batch, 0)))
        }
    }
}

impl Drop for Trap {
    fn drop(&mut self) {
        // SAFETY: made by `new` and never deleted before.
        unsafe { (self.functions.delete)(self.batch.as_ptr()) }
    }
}

unsafe extern "C-unwind" fn call<F: FnMut()>(_: *const c_void, _: *mut c_void, _: c_int, work: *mut c_void) {
    // SAFETY: `Trap::run` passes the address of an `F`.
    unsafe { (*work.cast::<F>())() }
}

unsafe fn text(words: *const c_char) -> String {
    // SAFETY: by the contract of the caller.
    unsafe { CStr::from_ptr(words) }.to_string_lossy().trim().to_owned()
}
