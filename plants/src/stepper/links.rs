//! The wiring table of a closed loop: wires, signals and injections, tied to addresses.

use std::ptr::NonNull;

use super::failure::Failure;
use super::slot::Slot;
use super::wire::{Delay, Shape};

/// Numbers of a whole run, one per step.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    /// the first
    pub first: NonNull<f64>,
    /// how many
    pub count: usize,
}

impl Series {
    /// # Safety
    /// The memory of `count` numbers can be read.
    unsafe fn at(self, k: usize) -> f64 {
        assert!(k < self.count, "step {k} of {}", self.count);
        // SAFETY: inside the series.
        unsafe { self.first.add(k).read() }
    }
}

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
    ///
    /// # Safety
    /// All memory can be read and written.
    pub(super) unsafe fn carry_readings(&mut self, k: usize) -> Result<(), Failure> {
        // SAFETY: by the contract of this function.
        unsafe {
            for (wire, link) in self.readings.iter_mut().enumerate() {
                link.carry(k, |value| Failure::Reading { wire, value })?;
            }
            for drive in &self.drives {
                drive.target.write(drive.course.at(k)).map_err(Failure::Integer)?;
            }
            inject(&self.input_faults, k)
        }
    }

    /// Carries outputs of the controller through their wires, then injections, into the commands of the plant.
    ///
    /// # Safety
    /// All memory can be read and written.
    pub(super) unsafe fn carry_outputs(&mut self, k: usize) -> Result<(), Failure> {
        // SAFETY: by the contract of this function.
        unsafe {
            for (wire, link) in self.outputs.iter_mut().enumerate() {
                link.carry(k, |value| Failure::Output { wire, value })?;
            }
            inject(&self.command_faults, k)
        }
    }
}

impl Link {
    unsafe fn carry(&mut self, k: usize, refused: impl Fn(f64) -> Failure) -> Result<(), Failure> {
        // SAFETY: by the contract of the caller.
        unsafe {
            let noise = self.noise.map(|series| series.at(k));
            let value = self.shape.apply(self.source.read(), noise).map_err(refused)?;
            self.target.write(self.delay.pass(value, k)).map_err(Failure::Integer)
        }
    }
}

unsafe fn inject(faults: &[Injection], k: usize) -> Result<(), Failure> {
    for fault in faults.iter().filter(|fault| (fault.begin..fault.end).contains(&(k as u64))) {
        // SAFETY: by the contract of the caller.
        unsafe { fault.target.write(fault.value) }.map_err(Failure::Integer)?;
    }
    Ok(())
}
