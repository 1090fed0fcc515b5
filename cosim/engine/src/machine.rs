//! A plant after its reset: MuJoCo, and the locations of its channels.

use plants::{Circuit, Place};

use crate::failure::Failure;
use crate::ffi::{Physics, Slot};

/// A plant that was reset.
#[derive(Clone, Debug)]
pub struct Machine {
    /// MuJoCo's part
    pub physics: Physics,
    /// one plant step, s
    pub timestep: f64,
    /// plant steps in one communication step
    pub substeps: usize,
    /// locations of the measurements
    pub readings: Vec<Place>,
    /// locations of the commands
    pub commands: Vec<Place>,
    /// locations of the ground truth
    pub truths: Vec<Place>,
}

// no frame of these methods holds a value with a destructor while MuJoCo runs, see `Physics`
impl Machine {
    /// Reads ideal measurements.
    pub(super) fn sense(&self, sensing: &mut Circuit, sensed: &[Slot]) -> Result<(), Failure> {
        self.physics.first_half();
        if self.physics.warned() {
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

    /// Sets the commands; they are held until the next call.
    pub(super) fn command(&self, commands: &[Slot]) -> Result<(), Failure> {
        if !commands.iter().all(|slot| slot.read().is_finite()) {
            return Err(Failure::Command);
        }
        for (place, slot) in self.commands.iter().zip(commands) {
            place.put(slot.read());
        }
        Ok(())
    }

    /// Advances by one communication step.
    pub(super) fn advance(&self, circuit: &mut Circuit) -> Result<(), Failure> {
        for substep in 0..self.substeps {
            if substep > 0 {
                self.physics.first_half();
            }
            circuit.step(self.timestep)?;
            self.physics.second_half();
        }
        Ok(())
    }
}
