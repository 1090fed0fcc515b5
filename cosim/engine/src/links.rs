//! The wiring table of a closed loop: wires, signals and injections, tied to addresses.

use crate::failure::Failure;
use crate::fault::FaultEffect;
use crate::ffi::{Series, Slot};
use crate::wire::{Delay, Shape};

/// One wire.
#[derive(Clone, Debug)]
pub struct Link {
    /// where its value comes from
    pub source: Slot,
    /// where it goes to
    pub target: Slot,
    /// what happens in between
    pub shape: Shape,
    /// noise of every step
    pub noise: Option<Series>,
    /// what makes it late
    pub delay: Delay,
}

/// One signal: sample k is written in step k.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// the samples
    pub course: Series,
    /// where they go to
    pub target: Slot,
}

/// One injection: for so many steps from the one on that stands in `begin`, what arrives is changed.
#[derive(Clone, Debug)]
pub struct Injection {
    /// holds the first step, infinite before it is known
    pub begin: Slot,
    /// steps
    pub length: f64,
    /// what happens to the value
    pub change: FaultEffect,
    /// a number of it for every step
    pub series: Option<Series>,
    /// where
    pub target: Slot,
}

/// All connections of a run.
#[derive(Clone, Debug, Default)]
pub struct Links {
    /// takes the ideal readings of a step
    pub sensed: Vec<Slot>,
    /// wires from readings to inputs
    pub readings: Vec<Link>,
    /// signals
    pub drives: Vec<Drive>,
    /// injections at inputs
    pub input_faults: Vec<Injection>,
    /// wires from outputs to commands
    pub outputs: Vec<Link>,
    /// injections at commands
    pub command_faults: Vec<Injection>,
    /// holds the commands of a step
    pub commands: Vec<Slot>,
}

impl Links {
    /// Carries readings through their wires, then signals, then injections, into the inputs of the controller.
    pub(super) fn carry_readings(&mut self, k: usize) -> Result<(), Failure> {
        for (wire, link) in self.readings.iter_mut().enumerate() {
            link.carry(k, |value| Failure::Reading { wire, value })?;
        }
        for drive in &self.drives {
            drive.target.write(drive.course.at(k)).map_err(Failure::Integer)?;
        }
        inject(&mut self.input_faults, k)
    }

    /// Carries outputs of the controller through their wires, then injections, into the commands of the plant.
    pub(super) fn carry_outputs(&mut self, k: usize) -> Result<(), Failure> {
        for (wire, link) in self.outputs.iter_mut().enumerate() {
            link.carry(k, |value| Failure::Output { wire, value })?;
        }
        inject(&mut self.command_faults, k)
    }
}

impl Link {
    fn carry(&mut self, k: usize, refused: impl Fn(f64) -> Failure) -> Result<(), Failure> {
        let noise = self.noise.map(|series| series.at(k));
        let value = self.shape.apply(self.source.read(), noise).map_err(refused)?;
        self.target.write(self.delay.pass(value, k)).map_err(Failure::Integer)
    }
}

/// Applies the injections that are active; the others only see the values.
fn inject(faults: &mut [Injection], k: usize) -> Result<(), Failure> {
    for fault in faults {
        #[allow(clippy::cast_precision_loss)]
        let since = k as f64 - fault.begin.read();
        let value = fault.change.apply(fault.target.read(), k, since, fault.series.map_or(0.0, |series| series.at(k)));
        if (0.0..fault.length).contains(&since) {
            fault.target.write(value).map_err(Failure::Integer)?;
        }
    }
    Ok(())
}
