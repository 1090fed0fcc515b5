//! The two halves of MuJoCo's step.

use std::ffi::{c_int, c_void};

/// `mj_step1` or `mj_step2` with model and data. Errors exit by `longjmp`.
pub type Half = unsafe extern "C-unwind" fn(*const c_void, *mut c_void);

/// A model with its data.
#[derive(Clone, Debug)]
pub struct Physics {
    first_half: Half,
    second_half: Half,
    model: *const c_void,
    data: *mut c_void,
    /// counters of MuJoCo's warnings
    warnings: Vec<*const c_int>,
}

// SAFETY: who makes it vouches for its addresses and for one thread at a time, see `Physics::new`.
unsafe impl Send for Physics {}
// SAFETY: as above.
unsafe impl Sync for Physics {}

impl Physics {
    /// `mj_step1`, `mj_step2`, an `mjModel`, its `mjData` and the counters of its warnings.
    ///
    /// # Safety
    /// All addresses are those of one live plant that no other code uses. A frame that calls a half holds no
    /// value with a destructor: MuJoCo may exit it by `longjmp`.
    pub unsafe fn new(
        first_half: Half,
        second_half: Half,
        model: *const c_void,
        data: *mut c_void,
        warnings: Vec<*const c_int>,
    ) -> Self {
        Self { first_half, second_half, model, data, warnings }
    }

    /// Positions, velocities and their sensors.
    pub fn first_half(&self) {
        // SAFETY: by the contract of `new`.
        unsafe { (self.first_half)(self.model, self.data) }
    }

    /// Forces, accelerations, integration.
    pub fn second_half(&self) {
        // SAFETY: by the contract of `new`.
        unsafe { (self.second_half)(self.model, self.data) }
    }

    /// Whether MuJoCo counted a warning.
    pub fn warned(&self) -> bool {
        // SAFETY: by the contract of `new`.
        self.warnings.iter().any(|counter| unsafe { counter.read() } != 0)
    }
}
