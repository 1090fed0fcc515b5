//! One instance of a model: phases, values, steps and states; safe, and the same for every model.

mod access;
mod clock;
mod communication;
pub mod slave;
mod slope;
mod snapshot;
pub mod states;

use crate::exported::Exported;
use crate::host::logger::Category;
use crate::host::phase::{Function, Phase, Status};
use crate::host::text::c_string;
use crate::instance::access::{Refusal, Scalar, Value, forbidden, not_finite, unknown, wrong_type};
use crate::instance::clock::Clock;
use crate::instance::communication::check_step;
use crate::instance::slave::Slave;
use crate::instance::slope::{Derivative, Slope};
use crate::instance::snapshot::{Running, Snapshot};
use crate::instance::states::TakenState;
use crate::model::{Env, Experiment, Host, Interface, Model};
use crate::table::index::Entry;
use crate::table::variable::{Kind, Role, Variable};
use std::ffi::{CStr, CString};
use std::sync::Arc;

type SnapshotOf<M> = Snapshot<<M as Model>::Vars, <M as Model>::State>;

/// An instance of the model `M`.
pub struct Instance<M: Exported> {
    host: Host,
    now: SnapshotOf<M>,
    /// Texts handed out by the last fmi2GetString.
    strings: Vec<CString>,
}

impl<M: Exported> Instance<M> {
    pub fn new(host: Host) -> Self {
        Self { host, now: fresh::<M>(), strings: Vec::new() }
    }

    /// fmi2SetReal of inputs, when nothing is wrong with it; otherwise `false`, and nothing has changed.
    #[inline]
    pub fn set_inputs(&mut self, references: &[u32], values: &[f64]) -> bool {
        let inputs = || references.iter().map(|&reference| M::INDEX.entries.get(reference as usize)?.input);
        if !Function::SetReal.is_allowed(self.now.phase)
            || !inputs().zip(values).all(|(input, value)| input.is_some() && value.is_finite())
        {
            return false;
        }
        for (input, &value) in inputs().zip(values) {
            if let Some(place) = input {
                place.set(&mut self.now.vars, value);
            }
        }
        true
    }

    /// fmi2GetReal, when nothing is wrong with it; otherwise `false`, and nothing was written.
    #[inline]
    pub fn get_reals(&self, references: &[u32], values: &mut [f64]) -> bool {
        let places = || references.iter().map(|&reference| M::INDEX.entries.get(reference as usize)?.real);
        if !Function::GetReal.is_allowed(self.now.phase) || !places().all(|place| place.is_some()) {
            return false;
        }
        for (place, value) in places().zip(values) {
            if let Some(place) = place {
                *value = place.get(&self.now.vars);
            }
        }
        true
    }

    /// The only way through every call: phase check, message, error phase.
    #[inline]
    fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<(), Refusal>) -> Status {
        let result = if function.is_allowed(self.now.phase) { body(self) } else { Err(illegal(self.now.phase)) };
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

    /// All or nothing: every reference is checked before the first value is given.
    fn get<T: Scalar<M::Vars>>(&self, references: &[u32], mut give: impl FnMut(usize, T)) -> Result<(), Refusal> {
        let read = |reference: &u32| {
            let (row, element) = self.entry(*reference)?;
            T::read(row, &self.now.vars, element).ok_or_else(|| wrong_type(row, T::KIND))
        };
        references.iter().try_for_each(|reference| read(reference).map(|_| ()))?;
        references.iter().enumerate().try_for_each(|(i, reference)| read(reference).map(|value| give(i, value)))
    }

    /// All or nothing: every value is checked before the first is written.
    fn set<T: Value<M::Vars>>(&mut self, references: &[u32], values: &[T]) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            let (row, element) = self.entry(reference)?;
            if !T::fits(row) {
                return Err(wrong_type(row, T::KIND));
            }
            self.may_set(row, || value.equals(row, &self.now.vars, element))
                .map_err(|reason| forbidden(row, element, value, reason))?;
            value.verify(row, element)?;
        }
        let (mut parameters, running) = (false, self.now.phase == Phase::StepComplete);
        for (&reference, value) in references.iter().zip(values) {
            let (row, element) = self.entry(reference)?;
            value.write(row, &mut self.now.vars, element);
            parameters |= row.role().is_parameter();
            // a fixed parameter that is written again while running changes nothing
            self.now.is_set[reference as usize] |=
                row.role().is_parameter() && (!running || row.role() == Role::Tunable);
        }
        if parameters {
            parameters_set::<M>(&mut self.now);
            if running {
                self.check_computed()?;
            }
        }
        Ok(())
    }

    /// Whether a variable may be set in this phase, or why not.
    fn may_set(&self, row: &Variable<M::Vars>, unchanged: impl FnOnce() -> bool) -> Result<(), &'static str> {
        let running = self.now.phase == Phase::StepComplete;
        match row.role() {
            Role::Input | Role::Tunable => Ok(()),
            // some importers write fixed parameters again after initialization
            Role::Parameter if !running || unchanged() => Ok(()),
            Role::Parameter => Err("it is fixed after initialization"),
            Role::Calculated => Err("it is calculated from other parameters"),
            Role::Output | Role::Local if !running => Ok(()),
            Role::Output | Role::Local => Err("it is written by the FMU"),
        }
    }

    fn start(&mut self) -> Result<(), Refusal> {
        let experiment = self.now.experiment.ok_or_else(|| Refusal::error("fmi2SetupExperiment was not called"))?;
        let period = sample_period::<M>(&self.now.vars);
        if !(period.is_finite() && period > 0.0) {
            return Err(Refusal::error(format!("the sample period {period} s is not positive")));
        }
        let mut env = Env { time: experiment.start, experiment, host: &self.host };
        let state = M::initialise(&mut self.now.vars, &mut env).map_err(|error| Refusal::error(error.to_string()))?;
        self.now.running = Some(Running { state, clock: Clock::new(period), time: experiment.start });
        self.now.phase = Phase::StepComplete;
        self.check_computed()
    }

    #[inline]
    fn step(&mut self, time: f64, step: f64) -> Result<(), Refusal> {
        let (Some(running), Some(experiment)) = (&self.now.running, self.now.experiment) else {
            return Err(Refusal::error("the instance is not initialized"));
        };
        check_step(&running.clock, &experiment, time, step)?;
        if self.now.derivatives.is_empty() {
            self.run(experiment, step, |_, _, _| Ok(()))?;
        } else {
            self.run_with_derivatives(experiment, step)?;
        }
        if let Some(running) = &mut self.now.running {
            running.time = time + step;
        }
        self.check_computed()
    }

    /// Runs the samples in a communication step; `prepare` gets the time of each of them and the seconds from the start of
    /// the step to it.
    #[inline]
    fn run(
        &mut self,
        experiment: Experiment,
        step: f64,
        prepare: impl Fn(&mut M::Vars, f64, f64) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let Some(running) = &mut self.now.running else { return Ok(()) };
        let here = running.clock;
        for tick in running.clock.advance(step) {
            let time = experiment.start + here.time_of(tick);
            prepare(&mut self.now.vars, time, here.until(tick))?;
            let mut env = Env { time, experiment, host: &self.host };
            let before = self.now.vars.status();
            let done = M::tick(&mut self.now.vars, &mut running.state, &mut env);
            done.map_err(|error| Refusal::error(error.to_string()))?;
            let vars = &self.now.vars;
            env.report(before, vars.status(), || (M::NUMBERS)(vars));
        }
        Ok(())
    }

    #[cold]
    fn run_with_derivatives(&mut self, experiment: Experiment, step: f64) -> Result<(), Refusal> {
        let slopes = self.take_slopes();
        let done = self.run(experiment, step, |vars, time, after| {
            let apply = |slope: &Slope<M::Vars>| {
                slope
                    .apply(vars, after)
                    .map_err(|value| endless(&M::INDEX.entries[slope.reference() as usize], slope, value, time))
            };
            slopes.iter().try_for_each(apply)
        });
        slopes.iter().for_each(|slope| slope.restore(&mut self.now.vars));
        done
    }

    /// The inputs that have derivatives, each with all of its own; they count for one step.
    fn take_slopes(&mut self) -> Vec<Slope<M::Vars>> {
        let mut derivatives = std::mem::take(&mut self.now.derivatives);
        derivatives.sort_by_key(|derivative| (derivative.reference, derivative.order));
        let slope = |derivatives: &[Derivative]| {
            let place = M::INDEX.entries[derivatives[0].reference as usize].input?;
            Slope::new(place, &self.now.vars, derivatives.to_vec())
        };
        derivatives.chunk_by(|a, b| a.reference == b.reference).filter_map(slope).collect()
    }

    /// No NaN leaves an FMU: names the first value that is not finite.
    #[inline]
    fn check_computed(&self) -> Result<(), Refusal> {
        for entry in M::INDEX.computed {
            if let Some(place) = entry.real
                && !place.get(&self.now.vars).is_finite()
            {
                return Err(not_finite(entry, place.get(&self.now.vars)));
            }
        }
        Ok(())
    }

    /// Puts start values where a failed step left numbers that are not finite.
    fn make_finite(&mut self) {
        let start = fresh::<M>().vars;
        for place in M::INDEX.computed.iter().filter_map(|entry| entry.real) {
            if !place.get(&self.now.vars).is_finite() {
                place.set(&mut self.now.vars, place.get(&start));
            }
        }
    }

    /// All or nothing, as values; the last one of an order counts.
    fn set_derivatives(&mut self, derivatives: &[Derivative]) -> Result<(), Refusal> {
        derivatives.iter().try_for_each(|derivative| self.check_derivative(derivative))?;
        for new in derivatives {
            let other = |old: &Derivative| (old.reference, old.order) != (new.reference, new.order);
            self.now.derivatives.retain(other);
            self.now.derivatives.push(*new);
        }
        Ok(())
    }

    fn check_derivative(&self, derivative: &Derivative) -> Result<(), Refusal> {
        let Derivative { reference, order, value } = *derivative;
        let (row, element) = self.entry(reference)?;
        let name = row.element_name(element);
        if row.role() != Role::Input || !matches!(row.kind, Kind::Real { .. }) {
            return Err(Refusal::error(format!("`{name}` is no Real input")));
        }
        if order < 1 {
            return Err(Refusal::error(format!("`{name}`: order {order} is none, the lowest is 1")));
        }
        if !value.is_finite() {
            return Err(Refusal::error(format!("`{name}`: the derivative {value} is not finite")));
        }
        Ok(())
    }

    fn taken<'a>(&self, state: &'a TakenState) -> Result<&'a SnapshotOf<M>, Refusal> {
        state.downcast_ref().ok_or_else(|| Refusal::error("the state is not of this FMU"))
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
        if restored.is_set.len() != M::INDEX.entries.len() {
            return Err(Refusal::error("the state bytes hold other parameters"));
        }
        let sane = restored.running.as_ref().is_none_or(|running| running.clock.is_sane() && running.time.is_finite());
        if sane { Ok(()) } else { Err(Refusal::error("the state bytes hold an impossible clock")) }
    }
}

/// Sample period before anything is set, s.
pub fn start_period<M: Exported>() -> f64 {
    sample_period::<M>(&fresh::<M>().vars)
}

/// Sample period of a model, s.
fn sample_period<M: Model>(vars: &M::Vars) -> f64 {
    vars.sample_period().unwrap_or(M::INFO.sample_period)
}

fn fresh<M: Exported>() -> SnapshotOf<M> {
    let mut vars = M::Vars::START;
    for row in M::Vars::TABLE {
        if let Kind::Text { set, start, .. } = row.kind {
            set(&mut vars, start);
        }
    }
    let is_set = vec![false; M::INDEX.entries.len()];
    let (phase, derivatives) = (Phase::Instantiated, Vec::new());
    let mut fresh = Snapshot { phase, vars, is_set, running: None, experiment: None, derivatives };
    parameters_set::<M>(&mut fresh);
    fresh
}

/// What follows from parameters after some were set.
fn parameters_set<M: Model>(now: &mut SnapshotOf<M>) {
    now.vars.bring_into_force(|reference| now.is_set[reference]);
    M::calculate(&mut now.vars);
}

#[cold]
fn endless<V>(entry: &Entry<V>, slope: &Slope<V>, value: f64, time: f64) -> Refusal {
    let (row, element) = entry.position();
    let (name, told) = (row.element_name(element), slope.told());
    Refusal::error(format!(
        "`{name}` = {value} at t = {time} s: extrapolated from {told}\nhint: give smaller derivatives, or take a shorter step"
    ))
}

#[cold]
fn illegal(phase: Phase) -> Refusal {
    Refusal::error(format!("may not be called {}", phase.name()))
}

impl<M: Exported> Slave for Instance<M> {
    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Status {
        self.call(Function::SetDebugLogging, |this| {
            this.host.logger.configure(on, categories);
            Ok(())
        })
    }

    fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        self.call(Function::SetupExperiment, |this| {
            if !start.is_finite() {
                return Err(Refusal::error(format!("the start time {start} s is not finite")));
            }
            let stop = stop.unwrap_or(f64::INFINITY);
            if stop.is_nan() || stop < start {
                return Err(Refusal::error(format!("the stop time {stop} s is before the start time {start} s")));
            }
            let tolerance = tolerance.filter(|tolerance| *tolerance > 0.0 && tolerance.is_finite());
            this.now.experiment = Some(Experiment { start, tolerance, stop });
            Ok(())
        })
    }

    fn enter_initialization_mode(&mut self) -> Status {
        self.call(Function::EnterInitializationMode, |this| {
            if this.now.experiment.is_none() {
                return Err(Refusal::error("fmi2SetupExperiment was not called"));
            }
            this.now.phase = Phase::Initialization;
            Ok(())
        })
    }

    fn exit_initialization_mode(&mut self) -> Status {
        self.call(Function::ExitInitializationMode, Self::start)
    }

    fn terminate(&mut self) -> Status {
        self.call(Function::Terminate, |this| {
            this.now.phase = Phase::Terminated;
            Ok(())
        })
    }

    fn reset(&mut self) -> Status {
        self.call(Function::Reset, |this| {
            this.now = fresh::<M>();
            this.host.logger.reset();
            Ok(())
        })
    }

    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Status {
        self.call(Function::GetReal, |this| this.get(references, |i, value| values[i] = value))
    }

    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Status {
        self.call(Function::GetInteger, |this| this.get(references, |i, value| values[i] = value))
    }

    fn get_boolean(&mut self, references: &[u32], give: &mut dyn FnMut(usize, bool)) -> Status {
        self.call(Function::GetBoolean, |this| this.get(references, give))
    }

    fn get_string(&mut self, references: &[u32], give: &mut dyn FnMut(usize, &CStr)) -> Status {
        self.call(Function::GetString, |this| {
            let read = |&reference| {
                let (row, _) = this.entry(reference)?;
                match row.kind {
                    Kind::Text { get, .. } => Ok(c_string(get(&this.now.vars))),
                    _ => Err(wrong_type(row, "String")),
                }
            };
            this.strings = references.iter().map(read).collect::<Result<_, _>>()?;
            this.strings.iter().enumerate().for_each(|(i, text)| give(i, text));
            Ok(())
        })
    }

    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Status {
        self.call(Function::SetReal, |this| this.set(references, values))
    }

    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Status {
        self.call(Function::SetInteger, |this| this.set(references, values))
    }

    fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Status {
        self.call(Function::SetBoolean, |this| this.set(references, values))
    }

    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Status {
        self.call(Function::SetString, |this| this.set(references, values))
    }

    fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Status {
        self.call(Function::SetRealInputDerivatives, |this| {
            let all = references.iter().zip(orders).zip(values);
            let derivative = |((&reference, &order), &value)| Derivative { reference, order, value };
            this.set_derivatives(&all.map(derivative).collect::<Vec<_>>())
        })
    }

    fn last_successful_time(&mut self, value: &mut f64) -> Status {
        self.call(Function::GetRealStatus, |this| match &this.now.running {
            Some(running) => {
                *value = running.time;
                Ok(())
            }
            None => Err(Refusal::discard("no step was done yet")),
        })
    }

    fn take_state(&mut self, slot: &mut Option<TakenState>) -> Status {
        self.call(Function::GetFMUstate, |this| {
            *slot = Some(Arc::new(this.now.clone()));
            Ok(())
        })
    }

    fn put_state(&mut self, state: &TakenState) -> Status {
        self.call(Function::SetFMUstate, |this| {
            this.now = this.taken(state)?.clone();
            Ok(())
        })
    }

    fn serialize(&mut self, function: Function, state: &TakenState, bytes: &mut Vec<u8>) -> Status {
        self.call(function, |this| {
            *bytes = snapshot::to_bytes(M::guid(), this.taken(state)?).map_err(Refusal::error)?;
            Ok(())
        })
    }

    fn deserialize(&mut self, bytes: &[u8], slot: &mut Option<TakenState>) -> Status {
        self.call(Function::DeSerializeFMUstate, |this| {
            let mut restored: SnapshotOf<M> = snapshot::from_bytes(M::guid(), bytes).map_err(Refusal::error)?;
            this.check_restored(&restored).map_err(|refusal| {
                Refusal::error(format!("the state bytes hold what no call could set: {}", refusal.text()))
            })?;
            // what follows from parameters is never taken from bytes
            parameters_set::<M>(&mut restored);
            *slot = Some(Arc::new(restored));
            Ok(())
        })
    }

    fn permit(&mut self, function: Function) -> Status {
        self.call(function, |_| Ok(()))
    }

    fn refuse(&mut self, function: Function, status: Status, text: &str) -> Status {
        let category = match status {
            Status::Discard => Category::Discard,
            _ => Category::Error,
        };
        self.host.logger.send(category, format_args!("{}: {text}", function.name()));
        // a warning before belongs to this call, not to the next one
        self.host.logger.take_warned();
        if category == Category::Error {
            self.now.phase = Phase::Error;
            self.make_finite();
        }
        status
    }

    fn poison(&mut self, function: Function, text: &str) {
        self.host.logger.send(Category::Error, format_args!("{}: {text}", function.name()));
        self.host.logger.take_warned();
        self.now.phase = Phase::Error;
        self.make_finite();
    }
}
