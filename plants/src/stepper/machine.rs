//! A plant by addresses: MuJoCo's two halves of a step, elements, and the places of its channels.

use std::ffi::{c_int, c_void};

use super::failure::Failure;
use super::slot::Slot;
use crate::circuit::Circuit;
use crate::place::Place;

/// `mj_step1` or `mj_step2` with model and data. Errors leave it by `longjmp`.
pub type Half = unsafe extern "C-unwind" fn(*const c_void, *mut c_void);

/// A plant that was reset.
#[derive(Clone, Debug)]
pub struct Machine {
    /// `mj_step1`
    pub first_half: Half,
    /// `mj_step2`
    pub second_half: Half,
    /// the `mjModel`
    pub model: *const c_void,
    /// the `mjData`
    pub data: *mut c_void,
    /// one plant step, s
    pub timestep: f64,
    /// plant steps in one communication step
    pub substeps: usize,
    /// counters of MuJoCo's warnings
    pub warnings: Vec<*const c_int>,
    /// places of the readings
    pub readings: Vec<Place>,
    /// places of the commands
    pub commands: Vec<Place>,
    /// places of the truths
    pub truths: Vec<Place>,
}

impl Machine {
    /// Takes ideal readings.
    ///
    /// No value with a destructor lives in this frame while MuJoCo runs.
    ///
    /// # Safety
    /// All addresses are those of one live plant.
    pub(super) unsafe fn sense(&self, sensing: &mut Circuit, sensed: &[Slot]) -> Result<(), Failure> {
        // SAFETY: by the contract of this function.
        unsafe {
            (self.first_half)(self.model, self.data);
            if self.warnings.iter().any(|counter| counter.read() != 0) {
                return Err(Failure::Warning);
            }
            sensing.step(0.0)?;
            let mut finite = true;
            for (place, slot) in self.readings.iter().zip(sensed) {
                let value = place.sample(0);
                finite &= value.is_finite();
                slot.write(value).map_err(Failure::Integer)?;
            }
            if finite { Ok(()) } else { Err(Failure::Sensed) }
        }
    }

    /// Sets the commands; they hold until the next call.
    ///
    /// # Safety
    /// As for `sense`.
    pub(super) unsafe fn command(&self, commands: &[Slot]) -> Result<(), Failure> {
        // SAFETY: by the contract of this function.
        unsafe {
            if !commands.iter().all(|slot| slot.read().is_finite()) {
                return Err(Failure::Command);
            }
            for (place, slot) in self.commands.iter().zip(commands) {
                place.put(slot.read());
            }
        }
        Ok(())
    }

    /// Goes on by one communication step.
    ///
    /// No value with a destructor lives in this frame while MuJoCo runs.
    ///
    /// # Safety
    /// As for `sense`.
    pub(super) unsafe fn advance(&self, circuit: &mut Circuit) -> Result<(), Failure> {
        for substep in 0..self.substeps {
            // SAFETY: by the contract of this function.
            unsafe {
                if substep > 0 {
                    (self.first_half)(self.model, self.data);
                }
                circuit.step(self.timestep)?;
                (self.second_half)(self.model, self.data);
            }
        }
        Ok(())
    }
}
