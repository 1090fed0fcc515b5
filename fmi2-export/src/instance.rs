//! One instance of a model: phases, values, steps and states; safe, and the same for every model.

use crate::access::{Refusal, Scalar, Value};
use crate::clock::{Clock, MAX_TICKS};
use crate::export::{Export, Factory, Index, c_string};
use crate::logger::{Category, Logger};
use crate::model::{Env, Model, Start};
use crate::phase::{Function, Phase, Status};
use crate::slave::{Slave, TakenState};
use crate::slope::Slope;
use crate::snapshot::{self, Experiment, Running, Snapshot};
use crate::variable::{Kind, Role, Variable};
use std::ffi::{CStr, CString};
use std::fmt::Display;
use std::path::PathBuf;

type SnapshotOf<M> = Snapshot<<M as Model>::Vars, <M as Model>::State>;

/// An instance of the model `M`.
pub struct Instance<M: Model> {
    export: &'static Export<M>,
    index: Index<M::Vars>,
    resources: Option<PathBuf>,
    logger: Logger,
    now: SnapshotOf<M>,
    /// Texts handed out by the last fmi2GetString.
    strings: Vec<CString>,
}

impl<M: Model> Instance<M> {
    pub fn new(export: &'static Export<M>, resources: Option<PathBuf>, logger: Logger) -> Self {
        Self { export, index: Index::new(M::VARIABLES), resources, logger, now: fresh::<M>(), strings: Vec::new() }
    }

    /// The only way through every call: phase check, message, error phase.
    #[inline]
    fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<(), Refusal>) -> Status {
        let result = if function.is_allowed(self.now.phase) { body(self) } else { Err(illegal(self.now.phase)) };
        match result {
            Ok(()) => Status::Ok,
            Err(refusal) => self.refuse(function, refusal.status(), refusal.text()),
        }
    }

    /// Row and element of a value reference.
    #[inline]
    fn entry(&self, reference: u32) -> Result<(&'static Variable<M::Vars>, usize), Refusal> {
        let entries = &self.index.entries;
        entries.get(reference as usize).copied().ok_or_else(|| unknown(reference, entries.len()))
    }

    fn get<T: Scalar<M::Vars>>(&self, reference: u32) -> Result<T, Refusal> {
        let (row, element) = self.entry(reference)?;
        T::read(row, &self.now.vars, element).ok_or_else(|| wrong_type(row, T::KIND))
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
        let mut parameters = false;
        for (&reference, value) in references.iter().zip(values) {
            let (row, element) = self.entry(reference)?;
            value.write(row, &mut self.now.vars, element);
            parameters |= row.role().is_parameter();
        }
        if parameters {
            M::calculate(&mut self.now.vars);
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
        let period = M::period(&self.now.vars);
        if !(period.is_finite() && period > 0.0) {
            return Err(Refusal::error(format!("the sample period {period} s is not positive")));
        }
        let mut env = Env { time: experiment.start, resources: self.resources.as_deref(), logger: &self.logger };
        let state = M::initialise(&mut self.now.vars, &mut env).map_err(|error| Refusal::error(error.to_string()))?;
        self.now.running = Some(Running { state, clock: Clock::new(period), time: experiment.start });
        self.now.phase = Phase::StepComplete;
        self.check_computed()
    }

    fn step(&mut self, time: f64, step: f64) -> Result<(), Refusal> {
        let (Some(running), Some(experiment)) = (&mut self.now.running, self.now.experiment) else {
            return Err(Refusal::error("the instance is not initialized"));
        };
        check_step(running, experiment.stop, time, step)?;
        let vars = &mut self.now.vars;
        let bases: Vec<_> = self.now.slopes.drain(..).map(|slope| Slope::new(&self.index, vars, slope)).collect();
        let here = running.clock;
        for tick in running.clock.advance(step) {
            bases.iter().for_each(|slope| slope.apply(vars, here.until(tick)));
            let time = experiment.start + here.time_of(tick);
            let mut env = Env { time, resources: self.resources.as_deref(), logger: &self.logger };
            M::tick(vars, &mut running.state, &mut env).map_err(|error| Refusal::error(error.to_string()))?;
        }
        bases.iter().for_each(|slope| slope.apply(vars, 0.0));
        running.time = time + step;
        self.check_computed()
    }

    /// No NaN leaves an FMU: names the first value that is not finite.
    fn check_computed(&self) -> Result<(), Refusal> {
        for &(row, element) in &self.index.computed {
            let value = <f64 as Scalar<M::Vars>>::read(row, &self.now.vars, element).unwrap_or_default();
            if !value.is_finite() {
                return Err(Refusal::error(format!("the model computed `{}` = {value}", row.element_name(element))));
            }
        }
        Ok(())
    }

    /// Puts start values where a failed step left numbers that are not finite.
    fn make_finite(&mut self) {
        let start = fresh::<M>().vars;
        for &(row, element) in &self.index.computed {
            if let Kind::Real { get, set, .. } = row.kind
                && !get(&self.now.vars, element).is_finite()
            {
                set(&mut self.now.vars, element, get(&start, element));
            }
        }
    }

    fn set_slopes(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Refusal> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            let (row, _) = self.entry(reference)?;
            if row.role() != Role::Input || !matches!(row.kind, Kind::Real { .. }) {
                return Err(Refusal::error(format!("`{}` is no Real input", row.name)));
            }
            if order != 1 {
                return Err(Refusal::error(format!("`{}`: order {order} is not supported, only order 1", row.name)));
            }
            if !value.is_finite() {
                return Err(Refusal::error(format!("`{}`: the derivative {value} is not finite", row.name)));
            }
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.now.slopes.retain(|(known, _)| *known != reference);
            self.now.slopes.push((reference, value));
        }
        Ok(())
    }

    fn taken<'a>(&self, state: &'a TakenState) -> Result<&'a SnapshotOf<M>, Refusal> {
        state.downcast_ref().ok_or_else(|| Refusal::error("the state is not of this FMU"))
    }

    /// Restored bytes may hold any numbers: takes only such as the instance could have reached.
    fn check_restored(&self, restored: &SnapshotOf<M>) -> Result<(), Refusal> {
        for &(row, element) in &self.index.entries {
            if let Some(value) = <f64 as Scalar<M::Vars>>::read(row, &restored.vars, element) {
                value.verify(row, element)?;
            }
        }
        let sane = restored.running.as_ref().is_none_or(|running| running.clock.is_sane() && running.time.is_finite());
        if sane { Ok(()) } else { Err(Refusal::error("the state bytes hold an impossible clock")) }
    }
}

fn check_step<S>(running: &Running<S>, stop: Option<f64>, time: f64, step: f64) -> Result<(), Refusal> {
    if !(step > 0.0 && step.is_finite()) {
        return Err(Refusal::error(format!("the communication step {step} s is not positive")));
    }
    if step > MAX_TICKS * running.clock.period {
        let text = format!("the communication step {step} s is longer than {MAX_TICKS} sample periods");
        return Err(Refusal::error(text));
    }
    // importers accumulate time with rounding: the point is checked, never counted with
    let tolerance = 0.01 * step + 1e-9 * time.abs();
    let expected = running.time;
    if !(time.is_finite() && (time - expected).abs() <= tolerance) {
        let text = format!("the communication point {time} s is not the end of the last step, {expected} s");
        return Err(Refusal::error(text));
    }
    match stop {
        Some(stop) if time + step > stop + 1e-6 * step + 1e-9 * stop.abs() => {
            Err(Refusal::error(format!("the step from {time} s by {step} s passes the stop time {stop} s")))
        }
        _ => Ok(()),
    }
}

fn fresh<M: Model>() -> SnapshotOf<M> {
    let mut vars = M::Vars::START;
    for row in M::VARIABLES {
        if let Kind::Text { set, start, .. } = row.kind {
            set(&mut vars, start);
        }
    }
    M::calculate(&mut vars);
    Snapshot { phase: Phase::Instantiated, vars, running: None, experiment: None, slopes: Vec::new() }
}

// what a good call never builds is kept out of its way

#[cold]
fn illegal(phase: Phase) -> Refusal {
    Refusal::error(format!("may not be called {}", phase.name()))
}

#[cold]
fn unknown(reference: u32, count: usize) -> Refusal {
    Refusal::error(format!("there is no variable with the value reference {reference} (0 .. {})", count - 1))
}

#[cold]
fn forbidden<V>(row: &Variable<V>, element: usize, value: impl Display, reason: &str) -> Refusal {
    Refusal::error(format!("`{}` = {value}: {reason}", row.element_name(element)))
}

#[cold]
fn wrong_type<V>(row: &Variable<V>, kind: &str) -> Refusal {
    let own = row.kind.type_name();
    let hint = match own {
        "Enumeration" => "Integer",
        own => own,
    };
    Refusal::error(format!("`{}` is of type {own}, not {kind}; hint: fmi2Get{hint}, fmi2Set{hint}", row.name))
}

impl<M: Model> Slave for Instance<M> {
    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Status {
        self.call(Function::SetDebugLogging, |this| this.logger.configure(on, categories).map_err(Refusal::error))
    }

    fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Status {
        self.call(Function::SetupExperiment, |this| {
            if !start.is_finite() {
                return Err(Refusal::error(format!("the start time {start} s is not finite")));
            }
            if let Some(stop) = stop
                && (stop.is_nan() || stop < start)
            {
                return Err(Refusal::error(format!("the stop time {stop} s is before the start time {start} s")));
            }
            this.now.experiment = Some(Experiment { start, stop });
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
            Ok(())
        })
    }

    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Status {
        self.call(Function::GetReal, |this| {
            references.iter().zip(values).try_for_each(|(&reference, value)| this.get(reference).map(|x| *value = x))
        })
    }

    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Status {
        self.call(Function::GetInteger, |this| {
            references.iter().zip(values).try_for_each(|(&reference, value)| this.get(reference).map(|x| *value = x))
        })
    }

    fn get_boolean(&mut self, references: &[u32], give: &mut dyn FnMut(usize, bool)) -> Status {
        self.call(Function::GetBoolean, |this| {
            references.iter().enumerate().try_for_each(|(i, &reference)| this.get(reference).map(|x| give(i, x)))
        })
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
        self.call(Function::SetRealInputDerivatives, |this| this.set_slopes(references, orders, values))
    }

    fn do_step(&mut self, time: f64, step: f64) -> Status {
        self.call(Function::DoStep, |this| this.step(time, step))
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
            *slot = Some(Box::new(this.now.clone()));
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
            *bytes = snapshot::to_bytes(this.export.guid(), this.taken(state)?).map_err(Refusal::error)?;
            Ok(())
        })
    }

    fn deserialize(&mut self, bytes: &[u8], slot: &mut Option<TakenState>) -> Status {
        self.call(Function::DeSerializeFMUstate, |this| {
            let restored: SnapshotOf<M> = snapshot::from_bytes(this.export.guid(), bytes).map_err(Refusal::error)?;
            this.check_restored(&restored)?;
            *slot = Some(Box::new(restored));
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
        self.logger.send(category, format_args!("{}: {text}", function.name()));
        if category == Category::Error {
            self.now.phase = Phase::Error;
            self.make_finite();
        }
        status
    }

    fn poison(&mut self, function: Function, text: &str) {
        self.logger.send(Category::Error, format_args!("{}: {text}", function.name()));
        self.now.phase = Phase::Error;
        self.make_finite();
    }
}
