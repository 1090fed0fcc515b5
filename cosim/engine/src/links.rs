//! The wiring table of a closed loop: wires, signals and injections, tied to addresses.

use crate::failure::Failure;
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

/// One injection: the value is written in the steps `begin <= k < end`.
#[derive(Clone, Copy, Debug)]
pub struct Injection {
    /// first step
    pub begin: u64,
    /// step after the last
    pub end: u64,
    /// what arrives instead
    pub value: f64,
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
        inject(&self.input_faults, k)
    }

    /// Carries outputs of the controller through their wires, then injections, into the commands of the plant.
    pub(super) fn carry_outputs(&mut self, k: usize) -> Result<(), Failure> {
        for (wire, link) in self.outputs.iter_mut().enumerate() {
            link.carry(k, |value| Failure::Output { wire, value })?;
        }
        inject(&self.command_faults, k)
    }
}

impl Link {
    fn carry(&mut self, k: usize, refused: impl Fn(f64) -> Failure) -> Result<(), Failure> {
        let noise = self.noise.map(|series| series.at(k));
        let value = self.shape.apply(self.source.read(), noise).map_err(refused)?;
        self.target.write(self.delay.pass(value, k)).map_err(Failure::Integer)
    }
}

fn inject(faults: &[Injection], k: usize) -> Result<(), Failure> {
    for fault in faults.iter().filter(|fault| (fault.begin..fault.end).contains(&(k as u64))) {
        fault.target.write(fault.value).map_err(Failure::Integer)?;
    }
    Ok(())
}
