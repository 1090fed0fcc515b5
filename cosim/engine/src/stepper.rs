//! The steps of a run: sense, compute, act, record, advance.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

use plants::Circuit;

use crate::failure::Failure;
use crate::ffi::{Controller, Trap};
use crate::links::Links;
use crate::log::Log;
use crate::machine::Machine;

/// Reason for the regular end of a run before its last step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// the condition of the log is true
    Stopped,
    /// the controller ended it
    Terminated,
}

/// A closed loop that is simulated step by step; without a controller the plant runs alone.
pub struct Stepper {
    machine: Machine,
    controller: Option<Controller>,
    links: Links,
    log: Option<Log>,
    /// communication step, s
    step: f64,
    /// completed steps; written through, because an error of MuJoCo leaves by `longjmp`
    k: AtomicUsize,
    trap: Trap,
}

impl Stepper {
    /// A loop at step zero with a communication step of `step` seconds.
    ///
    /// `links.sensed` holds the measurements at time zero: the controller was initialized with them.
    pub fn new(
        machine: Machine,
        controller: Option<Controller>,
        links: Links,
        log: Option<Log>,
        step: f64,
        trap: Trap,
    ) -> Self {
        Self { machine, controller, links, log, step, k: AtomicUsize::new(0), trap }
    }

    /// Completed steps; the number of a failed step.
    pub fn steps(&self) -> usize {
        self.k.load(Ordering::Relaxed)
    }

    /// The first call of the controller that returned a warning: its number and its time.
    pub fn warned(&self) -> Option<(usize, f64)> {
        self.controller.as_ref().and_then(|controller| controller.warned)
    }

    /// Runs until `until` steps are done or the run ended; both circuits belong to the plant.
    ///
    /// # Errors
    /// The first failure; the loop cannot continue after it.
    pub fn run(&mut self, sensing: &mut Circuit, circuit: &mut Circuit, until: usize) -> Result<Option<End>, Failure> {
        let Self { machine, controller, links, log, step, k, trap } = self;
        let mut outcome = None;
        let trapped = trap.run(|| {
            let body = || {
                while k.load(Ordering::Relaxed) < until {
                    let now = k.load(Ordering::Relaxed);
                    let circuits = (&mut *sensing, &mut *circuit);
                    let ended = one_step(machine, controller.as_mut(), links, log.as_mut(), *step, circuits, now)?;
                    k.store(now + 1, Ordering::Relaxed);
                    if ended.is_some() {
                        return Ok(ended);
                    }
                }
                Ok(None)
            };
            outcome = Some(catch_unwind(AssertUnwindSafe(body)));
        });
        match (trapped, outcome) {
            (Err(words), _) => Err(Failure::MuJoCo(words)),
            (Ok(()), Some(Err(panic))) => resume_unwind(panic),
            (Ok(()), Some(Ok(outcome))) => outcome,
            (Ok(()), None) => Err(Failure::MuJoCo("the step was not made".into())),
        }
    }
}

/// Sense, compute, act, record, and move the plant to the next communication point.
fn one_step(
    machine: &Machine,
    controller: Option<&mut Controller>,
    links: &mut Links,
    mut log: Option<&mut Log>,
    step: f64,
    (sensing, circuit): (&mut Circuit, &mut Circuit),
    k: usize,
) -> Result<Option<End>, Failure> {
    #[allow(clippy::cast_precision_loss)]
    let time = k as f64 * step;
    if k > 0 {
        machine.sense(sensing, &links.sensed)?;
    }
    links.carry_readings(k)?;
    let terminated = controller.map(|controller| controller.compute(time, step)).transpose()? == Some(true);
    links.carry_outputs(k)?;
    machine.command(&links.commands)?;
    if let Some(log) = &mut log {
        log.record(k, time, &machine.truths)?;
    }
    machine.advance(circuit)?;
    let stopped = log.is_some_and(|log| log.ends(k));
    Ok(if terminated { Some(End::Terminated) } else { stopped.then_some(End::Stopped) })
}
