//! Every call of the C API on an instance that has no fast path.

use crate::exported::Exported;
use crate::host::logger::Category;
use crate::host::phase::{Function, Phase, Status};
use crate::host::text::c_string;
use crate::instance::access::{Refusal, wrong_type};
use crate::instance::slave::Slave;
use crate::instance::slope::Derivative;
use crate::instance::snapshot;
use crate::instance::states::TakenState;
use crate::instance::{Instance, SnapshotOf, fresh, parameters_set};
use crate::model::Experiment;
use crate::table::variable::Kind;
use std::ffi::CStr;
use std::sync::Arc;

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
        self.enter(Function::Terminate, Phase::Terminated)
    }

    fn enter(&mut self, function: Function, phase: Phase) -> Status {
        self.call(function, |this| {
            this.now.phase = phase;
            Ok(())
        })
    }

    fn set_time(&mut self, time: f64) -> Status {
        self.call(Function::SetTime, |this| this.move_to(time))
    }

    fn new_discrete_states(&mut self, next: &mut f64) -> Status {
        self.call(Function::NewDiscreteStates, |this| {
            *next = this.update()?;
            Ok(())
        })
    }

    fn reset(&mut self) -> Status {
        self.call(Function::Reset, |this| {
            this.now = fresh::<M>(this.now.fmu_type);
            this.host.logger.reset();
            this.reported_long_step = false;
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
        self.call(Function::SetReal, |this| this.set(references, |i| values[i]))
    }

    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Status {
        self.call(Function::SetInteger, |this| this.set(references, |i| values[i]))
    }

    fn set_boolean(&mut self, references: &[u32], value_of: &dyn Fn(usize) -> bool) -> Status {
        self.call(Function::SetBoolean, |this| this.set(references, value_of))
    }

    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Status {
        self.call(Function::SetString, |this| this.set(references, |i| values[i]))
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
            this.check_type(&restored)?;
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
