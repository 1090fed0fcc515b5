//! Model exchange: there are no continuous states, and each sample is a time event.

use crate::exported::Exported;
use crate::instance::access::Refusal;
use crate::instance::clock::{Clock, MAX_TICKS, SNAP};
use crate::instance::{Instance, not_initialized};
use crate::model::Env;

impl<M: Exported> Instance<M> {
    pub(super) fn move_to(&mut self, time: f64) -> Result<(), Refusal> {
        let (Some(running), Some(experiment)) = (&mut self.now.running, self.now.experiment) else {
            return Err(not_initialized());
        };
        if !time.is_finite() {
            return Err(Refusal::error(format!("the time {time} s is not finite")));
        }
        // past the stop time integrators look ahead, and an event is refused
        if time < experiment.start - tolerance(time, &running.clock) {
            return Err(Refusal::error(format!("the time {time} s is before the start time {} s", experiment.start)));
        }
        running.time = time;
        Ok(())
    }

    /// Runs the sample that is due, if the importer stopped at its time, and returns the time of the next.
    pub(super) fn update(&mut self) -> Result<f64, Refusal> {
        let (Some(running), Some(experiment)) = (&mut self.now.running, self.now.experiment) else {
            return Err(not_initialized());
        };
        let (time, due) = (running.time, running.clock.next_time(experiment.start));
        if time > experiment.stop + tolerance(time, &running.clock) {
            return Err(Refusal::error(format!("the event at {time} s passes the stop time {} s", experiment.stop)));
        }
        if time - due > MAX_TICKS * running.clock.period {
            let text = format!("the time {time} s is more than {MAX_TICKS} sample periods after the event at {due} s");
            return Err(Refusal::error(text));
        }
        let ticks = running.clock.come_to(experiment.start, time);
        let next = running.clock.next_time(experiment.start);
        if ticks.end - ticks.start > 1 && !self.reported_long_step {
            let env = Env { time, experiment, host: &self.host };
            env.warn(format_args!(
                "the importer passed the time event at `{due} s`: {} samples run together, with the present inputs\n\
                 hint: Stop the integration at each `nextEventTime`.",
                ticks.end - ticks.start
            ));
            self.reported_long_step = true;
        }
        if (ticks.end - ticks.start) as f64 > M::INFO.longest_step {
            running.model.begin_long_step();
        }
        self.run(experiment, ticks, |_, _, _| Ok(()))?;
        self.check_computed()?;
        Ok(next)
    }
}

/// By how much rounding may move a time, s.
fn tolerance(time: f64, clock: &Clock) -> f64 {
    SNAP * clock.period + 1e-9 * time.abs()
}
