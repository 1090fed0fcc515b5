//! The wiring table of a closed loop: wires, signals and injections, connected to addresses.

use crate::failure::Failure;
use crate::fault::FaultEffect;
use crate::ffi::{Series, Slot};
use crate::wire::{Delay, Shape};

/// One wire.
#[derive(Clone, Debug)]
pub struct Link {
    /// source of its value
    pub source: Slot,
    /// target
    pub target: Slot,
    /// processing of the value
    pub shape: Shape,
    /// noise of every step
    pub noise: Option<Series>,
    /// delay
    pub delay: Delay,
}

/// One signal: sample k is written in step k.
#[derive(Clone, Copy, Debug)]
pub struct Stimulus {
    /// the samples
    pub samples: Series,
    /// target
    pub target: Slot,
}

/// One injection: changes the arriving value for a number of steps, starting with the step in `begin`.
#[derive(Clone, Debug)]
pub struct Injection {
    /// holds the first step; infinite while unknown
    pub begin: Slot,
    /// steps
    pub length: f64,
    /// effect on the value
    pub change: FaultEffect,
    /// a number of it for every step
    pub series: Option<Series>,
    /// target
    pub target: Slot,
}

/// All connections of a run.
#[derive(Clone, Debug, Default)]
pub struct Links {
    /// receives the ideal measurements of a step
    pub sensed: Vec<Slot>,
    /// wires from measurements to inputs
    pub readings: Vec<Link>,
    /// signals
    pub stimuli: Vec<Stimulus>,
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
    /// Applies wires, then signals, then injections to the inputs of the controller.
    pub(super) fn carry_readings(&mut self, k: usize) -> Result<(), Failure> {
        for (wire, link) in self.readings.iter_mut().enumerate() {
            link.carry(k, |value| Failure::Reading { wire, value })?;
        }
        for stimulus in &self.stimuli {
            stimulus.target.write(stimulus.samples.at(k)).map_err(Failure::Integer)?;
        }
        inject(&mut self.input_faults, k)
    }

    /// Applies wires, then injections to the commands of the plant.
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

/// Applies the active injections; the others only observe the values.
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
