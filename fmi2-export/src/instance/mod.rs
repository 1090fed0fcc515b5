//! One instance of a model: phases, values, steps and states; safe, and the same for every model.

mod access;
mod calls;
mod clock;
mod communication;
mod derivatives;
mod events;
pub mod slave;
mod slope;
mod snapshot;
pub mod states;
mod values;

use crate::exported::Exported;
use crate::host::phase::{FmuType, Function, Phase, Status};
use crate::instance::access::{Refusal, Scalar, Value, not_finite, unknown};
use crate::instance::clock::Clock;
use crate::instance::communication::{check_step, is_too_long, too_long};
use crate::instance::slave::Slave;
use crate::instance::snapshot::{Running, Snapshot};
use crate::instance::states::TakenState;
use crate::model::{Env, Experiment, Host, Interface, Model};
use crate::table::index::Entry;
use crate::table::place::Run;
use crate::table::variable::{Kind, Variable};
use std::ffi::CString;
use std::ops::Range;

type SnapshotOf<M> = Snapshot<<M as Model>::Vars, M>;

/// An instance of the model `M`.
pub struct Instance<M: Exported> {
    host: Host,
    now: SnapshotOf<M>,
    /// Texts handed out by the last fmi2GetString.
    strings: Vec<CString>,
    /// Whether a step that is too long was reported; not part of the state, so that a master that rolls back gets it once.
    reported_long_step: bool,
}

impl<M: Exported> Instance<M> {
    pub fn new(host: Host, fmu_type: FmuType) -> Self {
        Self { host, now: fresh::<M>(fmu_type), strings: Vec::new(), reported_long_step: false }
    }

    /// The only way through every call: phase check, message, error phase.
    #[inline]
    fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<(), Refusal>) -> Status {
        let Snapshot { fmu_type, phase, .. } = self.now;
        let is_foreign = function.fmu_type().is_some_and(|other| other != fmu_type);
        let is_allowed = function.is_allowed(phase) && !is_foreign;
        let result = if is_allowed { body(self) } else { Err(illegal(phase, is_foreign.then_some(fmu_type))) };
        match result {
            Ok(()) if self.host.logger.take_warned() => Status::Warning,
            Ok(()) => Status::Ok,
            Err(refusal) => self.tell(function, refusal),
        }
    }

    #[cold]
    fn tell(&mut self, function: Function, refusal: Refusal) -> Status {
        self.refuse(function, refusal.status(), refusal.text())
    }

    /// fmi2DoStep
    #[inline]
    pub fn do_step(&mut self, time: f64, step: f64) -> Status {
        self.call(Function::DoStep, |this| this.step(time, step))
    }

    /// Row and element of a value reference.
    #[inline]
    fn entry(&self, reference: u32) -> Result<(&'static Variable<M::Vars>, usize), Refusal> {
        let entries = M::INDEX.entries;
        entries.get(reference as usize).map(Entry::position).ok_or_else(|| unknown(reference, entries.len()))
    }

    fn start(&mut self) -> Result<(), Refusal> {
        let experiment = self.now.experiment.ok_or_else(|| Refusal::error("fmi2SetupExperiment was not called"))?;
        let period = sample_period::<M>(&self.now.vars);
        if !(period.is_finite() && period > 0.0) {
            return Err(Refusal::error(format!("the sample period {period} s is not positive")));
        }
        let mut env = Env { time: experiment.start, experiment, host: &self.host };
        let model = M::initialise(&mut self.now.vars, &mut env).map_err(|error| Refusal::error(error.to_string()))?;
        self.now.running = Some(Running { model, clock: Clock::new(period), time: experiment.start });
        self.now.phase = match self.now.fmu_type {
            FmuType::CoSimulation => Phase::StepComplete,
            FmuType::ModelExchange => Phase::EventMode,
        };
        self.check_computed()
    }

    #[inline]
    fn step(&mut self, time: f64, step: f64) -> Result<(), Refusal> {
        let (Some(running), Some(experiment)) = (&self.now.running, self.now.experiment) else {
            return Err(not_initialized());
        };
        check_step(&running.clock, &experiment, time, step)?;
        if is_too_long(&running.clock, step, M::INFO.longest_step) {
            if !self.reported_long_step {
                let env = Env { time, experiment, host: &self.host };
                env.warn(too_long(&running.clock, step, M::INFO.longest_step));
                self.reported_long_step = true;
            }
            if let Some(running) = &mut self.now.running {
                running.model.begin_long_step();
            }
        }
        let Some(running) = &mut self.now.running else { return Err(not_initialized()) };
        let here = running.clock;
        let ticks = running.clock.advance(step);
        if self.now.derivatives.is_empty() {
            self.run(experiment, ticks, |_, _, _| Ok(()))?;
        } else {
            self.run_with_derivatives(experiment, here, ticks)?;
        }
        if let Some(running) = &mut self.now.running {
            running.time = time + step;
        }
        self.check_computed()
    }

    /// Runs samples; `prepare` gets the time of each of them and its number.
    #[inline]
    fn run(
        &mut self,
        experiment: Experiment,
        ticks: Range<u64>,
        prepare: impl Fn(&mut M::Vars, f64, u64) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let Some(running) = &mut self.now.running else { return Ok(()) };
        for tick in ticks {
            let time = experiment.start + running.clock.time_of(tick);
            prepare(&mut self.now.vars, time, tick)?;
            let mut env = Env { time, experiment, host: &self.host };
            let before = self.now.vars.status();
            let done = running.model.sample(&mut self.now.vars, &mut env);
            done.map_err(|error| Refusal::error(error.to_string()))?;
            let vars = &self.now.vars;
            env.report(before, vars.status(), || M::numbers(vars));
        }
        Ok(())
    }

    /// No NaN leaves an FMU: names the first value that is not finite.
    #[inline]
    fn check_computed(&self) -> Result<(), Refusal> {
        // all of them at once: one after the other would be a sixth of a sample
        let finite = |run: &Run<M::Vars>| run.get(&self.now.vars).iter().fold(true, |all, x| all & x.is_finite());
        if M::INDEX.runs.iter().fold(true, |all, run| all & finite(run)) { Ok(()) } else { self.first_not_finite() }
    }

    #[cold]
    fn first_not_finite(&self) -> Result<(), Refusal> {
        let computed = M::INDEX.computed.iter().filter_map(|entry| Some((entry, entry.real?.get(&self.now.vars))));
        let mut wrong = computed.filter(|(_, value)| !value.is_finite());
        wrong.next().map_or(Ok(()), |(entry, value)| Err(not_finite(entry, value)))
    }

    /// Puts start values where a failed step left numbers that are not finite.
    fn make_finite(&mut self) {
        let start = fresh::<M>(self.now.fmu_type).vars;
        for place in M::INDEX.computed.iter().filter_map(|entry| entry.real) {
            if !place.get(&self.now.vars).is_finite() {
                place.set(&mut self.now.vars, place.get(&start));
            }
        }
    }

    fn taken<'a>(&self, state: &'a TakenState) -> Result<&'a SnapshotOf<M>, Refusal> {
        let state = state.downcast_ref().ok_or_else(|| Refusal::error("the state is not of this FMU"))?;
        self.check_type(state)?;
        Ok(state)
    }

    /// A state leads to phases that only instances of its own type have.
    fn check_type(&self, state: &SnapshotOf<M>) -> Result<(), Refusal> {
        let (theirs, own) = (state.fmu_type, self.now.fmu_type);
        if theirs == own {
            return Ok(());
        }
        let (theirs, own) = (theirs.name(), own.name());
        Err(Refusal::error(format!("the state is of an instance for {theirs}, this one is for {own}")))
    }

    /// Restored bytes may hold any numbers: takes only such as the instance could have reached.
    fn check_restored(&self, restored: &SnapshotOf<M>) -> Result<(), Refusal> {
        for (row, element) in M::INDEX.entries.iter().map(Entry::position) {
            if let Some(value) = <f64 as Scalar<M::Vars>>::read(row, &restored.vars, element) {
                value.verify(row, element)?;
            }
            if let Some(value) = <i32 as Scalar<M::Vars>>::read(row, &restored.vars, element) {
                value.verify(row, element)?;
            }
        }
        restored.derivatives.iter().try_for_each(|derivative| self.check_derivative(derivative))?;
        let (stepping, by_events) =
            (restored.phase == Phase::StepComplete, restored.fmu_type == FmuType::ModelExchange);
        if restored.phase.is_running() && stepping == by_events {
            return Err(Refusal::error("the state bytes hold a phase of another FMU type"));
        }
        if restored.is_set.len() != M::INDEX.entries.len() {
            return Err(Refusal::error("the state bytes hold other parameters"));
        }
        let sane = restored.running.as_ref().is_none_or(|running| running.clock.is_sane() && running.time.is_finite());
        if sane { Ok(()) } else { Err(Refusal::error("the state bytes hold an impossible clock")) }
    }
}

/// Sample period before anything is set, s.
pub fn start_period<M: Exported>() -> f64 {
    sample_period::<M>(&fresh::<M>(FmuType::CoSimulation).vars)
}

/// Sample period of a model, s.
fn sample_period<M: Model>(vars: &M::Vars) -> f64 {
    vars.sample_period().unwrap_or(M::INFO.sample_period)
}

fn fresh<M: Exported>(fmu_type: FmuType) -> SnapshotOf<M> {
    let mut vars = M::Vars::START;
    for entry in M::INDEX.entries {
        if let Kind::Text { set, start, .. } = entry.row.kind {
            set(&mut vars, start);
        }
    }
    let is_set = vec![false; M::INDEX.entries.len()];
    let (phase, derivatives) = (Phase::Instantiated, Vec::new());
    let mut fresh = Snapshot { fmu_type, phase, vars, is_set, running: None, experiment: None, derivatives };
    parameters_set::<M>(&mut fresh);
    fresh
}

/// Updates the parameters in force and the calculated ones after some parameters were set.
fn parameters_set<M: Model>(now: &mut SnapshotOf<M>) {
    now.vars.bring_into_force(|reference| now.is_set[reference]);
    M::calculate(&mut now.vars);
}

#[cold]
fn not_initialized() -> Refusal {
    Refusal::error("the instance is not initialized")
}

/// Error for a call that is not allowed in `phase`; `other` is the type of this instance if it never allows the call.
#[cold]
fn illegal(phase: Phase, other: Option<FmuType>) -> Refusal {
    let made_for = other.map_or(String::new(), |other| format!(": this instance is for {}", other.name()));
    Refusal::error(format!("may not be called {}{made_for}", phase.name()))
}
