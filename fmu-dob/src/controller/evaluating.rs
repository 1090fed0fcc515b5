//! Evaluation of a sample: expected position, faults and contact.

use control_blocks::ticks;

use crate::commission::plan;
use crate::controller::Controller;
use crate::detection::touch;
use crate::faults::{self, Symptoms};
use crate::interface::{ContactSource, Fault, Parameters, State};
use crate::limits::{bend_limit, disturbance_limit, following_limit};
use crate::monitoring::numbers::Unseen;
use crate::monitoring::rest_force::RestForce;
use crate::motion::travel::{calibration_travel, lasted, learn_limit};
use crate::reading::{Expected, Reading};

/// Above this fraction of `guard.force` something holds the stage.
const HELD: f64 = 0.25;
/// Reversals of the inertial force in a stable loop that comes to rest.
const OVERSHOOTS: u32 = 2;

impl Controller {
    /// Whether all positions in the memory of the detector were used in full.
    fn trusted(&self, reading: &Reading) -> bool {
        reading.whole > self.spans.memory
    }

    /// The next position as predicted by observer and reference.
    pub(super) fn expect(&self, p: &Parameters) -> Expected {
        let commanded = self.observer.acceleration(self.amplifier.acted(p));
        let steady = matches!(self.state, State::Learn | State::Detect);
        let planned = match self.state {
            State::Approach => self.motion.approach.acceleration,
            _ if steady => 0.0,
            _ => p.retract.deceleration,
        };
        // a push of the force of the guard, the planned acceleration, and a drive that does anything from the contrary of
        // its command to twice of it; any motion while the velocity is unknown
        let known = self.tracked() && !self.off();
        let push = p.guard_force / p.stage.mass;
        let unforeseen = push + planned + 2.0 * commanded.abs();
        Expected {
            motion: self.observer.motion(commanded),
            bridged: self.observer.nominal_motion(commanded),
            unforeseen: if known { unforeseen * self.observer.leverage() } else { f64::INFINITY },
            reference: self.motion.reference.position,
            requested: self.motion.requested,
            lag: if steady { self.held(p) } else { self.motion.late(p) + self.unanswered() },
            diverged: self.diverged(),
            may_wait: self.state == State::Commission && self.motion.reference.acceleration == 0.0,
            steady_spindle: self.steady_spindle(),
        }
    }

    /// Motion (m) that a stage may leave unanswered at an approach speed so low that a push of the guard's force stops
    /// it on less than `limits.frozen`, M v^2 < 2 F `limits.frozen`: it stands for a quarter turn of the spindle.
    fn held(&self, p: &Parameters) -> f64 {
        let velocity = self.motion.reference.velocity;
        let slow = p.stage.mass * velocity * velocity < 2.0 * p.guard_force * p.limits.frozen;
        if slow { velocity.abs() * self.reader.standstill() } else { 0.0 }
    }

    /// Tolerated motion (m) without a change of the position at the reversals of a commissioning run, for an
    /// off-nominal stage.
    fn unanswered(&self) -> f64 {
        let acceleration = self.motion.reference.acceleration;
        if self.state == State::Commission { self.identification.experiment.unanswered(acceleration) } else { 0.0 }
    }

    /// How far (m) its excitation lets that stage be from the reference.
    fn diverged(&self) -> f64 {
        let experiment = &self.identification.experiment;
        if self.state == State::Commission && experiment.exciting() { experiment.plan.diverged() } else { 0.0 }
    }

    /// Whether the spindle must be steady now.
    fn steady_spindle(&self) -> bool {
        self.state.approaching() || self.state == State::Commission
    }

    /// Whether the disturbance exceeds its limit, or in a commissioning run its force plus that of the guard, relative
    /// to the holding force.
    fn overloaded(&self, p: &Parameters) -> bool {
        let disturbance = self.force.disturbance;
        let excess = (disturbance - self.identification.held()).abs();
        disturbance.abs() > disturbance_limit(p)
            || self.state == State::Commission && excess > plan::force(p) + p.guard_force
    }

    /// Monitors of the drive, of a stage at rest and of the cycle; a lost position gives no new information.
    pub(super) fn watch(&mut self, p: &Parameters, reading: &Reading) {
        let watching = !self.off();
        let following = following_limit(p) + self.motion.late(p) + self.diverged();
        let overloaded = self.overloaded(p);
        let at_rest = watching && self.motion.at_rest();
        let monitors = &mut self.monitors;
        let quiet = matches!(self.state, State::Learn | State::Detect) || at_rest && monitors.rest.settled(p);
        monitors.life.update(p, reading.position.filter(|_| quiet));
        if let Some(position) = reading.position {
            let error = self.motion.reference.position - position;
            monitors.diverged.update(watching && error.abs() > following);
            monitors.overloaded.update(watching && overloaded);
            if at_rest {
                monitors.frozen_at_rest = monitors.rest.update(p, position, monitors.life.anywhere);
            } else {
                monitors.rest.clear();
                monitors.frozen_at_rest = false;
            }
            let steady = self.motion.at_rest() || self.state.approaching() && self.motion.cruising();
            if watching && steady && self.state != State::Commission {
                if monitors.oscillation.update(p, monitors.drive.inertia()) && monitors.oscillation.count() > OVERSHOOTS
                {
                    // an oscillating stage has no force at rest
                    monitors.relief = RestForce::default();
                }
            } else {
                monitors.oscillation.clear();
            }
            if self.state == State::Retract && self.motion.retreated(p) {
                monitors.relief.update(p, self.force.notched);
            }
        }
        if self.state.at_work() || self.state == State::Commission {
            monitors.cycle.count();
        }
    }

    /// The fault of highest severity in this sample.
    pub(super) fn find_fault(&self, p: &Parameters, elapsed: bool, settled: bool, reading: &Reading) -> Option<Fault> {
        let (state, monitors) = (self.state, &self.monitors);
        let learning = state == State::Learn;
        let retracted = state == State::Retract && settled;
        let symptoms = Symptoms {
            reading,
            long_step: self.long_step,
            frozen_at_rest: monitors.frozen_at_rest,
            steady_spindle: self.steady_spindle(),
            limited: self.amplifier.limited(),
            reversals: self.amplifier.reversals(),
            oscillations: monitors.oscillation.count(),
            diverged: monitors.diverged.count(),
            overloaded: monitors.overloaded.count(),
            bent: !self.tracked() && self.reader.recent.bend() > bend_limit(p),
            gain_ratio: monitors.drive.ratio(),
            evaluated: retracted || self.has_started(p),
            travelled: state.approaching() && self.motion.beyond_travel(p),
            learned: (learning && elapsed).then(|| self.detector.learned()),
            learning: learning && self.ticks > ticks(learn_limit(p), p.sample_period),
            residual_force: (retracted && self.contact.is_some()).then(|| self.residual_force()),
            guarded: retracted && self.contact.is_some_and(|contact| contact.source == ContactSource::ForceGuard),
            rejected: state == State::Commission && self.identification.rejected,
            calibration_rejected: state == State::Calibrate && (self.calibration.rejected || self.too_short(p)),
            late: (state.at_work() || state == State::Commission) && self.lasted(p) > self.time_limit(p),
        };
        faults::find(p, &symptoms)
    }

    /// Time of the cycle or the commissioning run so far, s.
    pub(super) fn lasted(&self, p: &Parameters) -> f64 {
        lasted(p, self.monitors.cycle.samples())
    }

    /// How long it may, s.
    pub(super) fn time_limit(&self, p: &Parameters) -> f64 {
        if self.state == State::Commission { plan::time(p) } else { self.motion.cycle_limit }
    }

    /// Whether the next touch of a calibration would end at the maximum travel, before the workpiece.
    fn too_short(&self, p: &Parameters) -> bool {
        !self.calibration.over() && p.approach.travel_max < calibration_travel(p)
    }

    /// Change of the force from before the contact to after the retract, N.
    pub(super) fn residual_force(&self) -> f64 {
        self.monitors.relief.mean() - self.guard.before()
    }

    /// Why the detector has not found the contact of this sample.
    pub(super) fn unseen(&self, p: &Parameters, reading: &Reading) -> Unseen {
        if !self.armed(p) {
            Unseen::Unarmed
        } else if self.trusted(reading) {
            Unseen::Missed
        } else {
            Unseen::Doubted
        }
    }

    /// Whether the stage has just been accelerated, and nothing holds it: a contact would look like a weak drive.
    fn has_started(&self, p: &Parameters) -> bool {
        let held = (self.force.notched - self.guard.before()).abs() > HELD * p.guard_force;
        self.state == State::Approach && self.ticks == self.spans.forgotten && !held
    }

    /// Contact by the armed detector or by the guard; a frozen position proves nothing.
    pub(super) fn find_contact(&mut self, p: &Parameters, reading: &Reading) -> Option<ContactSource> {
        if !self.state.approaching() || self.waiting || !reading.alive {
            return None;
        }
        // the observer still holds the force of inertia
        let acceleration = match self.state {
            State::Approach if self.ticks <= self.spans.forgotten => self.motion.approach.acceleration,
            State::Confirm if self.ticks <= self.spans.forgotten => p.retract.deceleration,
            _ => 0.0,
        };
        let guarded = self.guard.exceeded(p, acceleration, self.force.notched);
        // a contact pushes, it does not jump: partly used positions are no evidence
        if !self.trusted(reading) {
            self.detector.clear();
        } else if self.armed(p) && (self.detector.test() || self.touched_twice(p, reading)) {
            return Some(self.detector.source());
        }
        guarded.then_some(ContactSource::ForceGuard)
    }

    /// Whether the detector decides.
    fn armed(&self, p: &Parameters) -> bool {
        match self.state {
            State::Confirm => self.ticks > ticks(touch::SETTLE_TIME, p.sample_period),
            state => state == State::Detect,
        }
    }

    /// Whether the second touch has confirmed the first.
    fn touched_twice(&mut self, p: &Parameters, reading: &Reading) -> bool {
        if self.state != State::Confirm {
            return false;
        }
        let velocity = self.motion.approach.velocity;
        let (Some(position), Some(ratio)) = (reading.position, self.detector.ratio()) else { return false };
        self.touch.confirm(p, velocity, position, ratio)
    }

    /// Whether a first touch is to be touched again, and whether a second one has shown nothing.
    pub(super) fn doubt(&mut self, p: &Parameters, reading: &Reading) -> (bool, bool) {
        let Some(position) = reading.position.filter(|_| p.touch.confirm) else { return (false, false) };
        match self.state {
            State::Detect => (self.detector.ratio().is_some_and(|ratio| self.touch.suspect(p, position, ratio)), false),
            State::Confirm => (false, self.armed(p) && self.touch.passed(self.motion.approach.velocity, position)),
            _ => (false, false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Input;

    #[test]
    fn only_a_stage_so_slow_that_the_guard_stops_it_immediately_may_be_at_rest_for_a_quarter_revolution() {
        let p = Parameters::START;
        let mut controller = Controller::new(&p).unwrap();
        let expected = controller.expect(&p);
        // 2 ms per revolution
        let input = Input { spindle_speed: 1000.0 * std::f64::consts::PI, ..Input::START };
        controller.reader.read(&p, &input, &expected);
        let mut lag = |state: State, velocity: f64| {
            controller.state = state;
            controller.motion.reference.velocity = velocity;
            controller.expect(&p).lag
        };
        // 0.4 N stop 10 kg at 24.49 um/s on 7.5 nm
        for (velocity, expected) in [(1e-5, 5e-9), (2.449e-5, 1.2245e-8), (2.45e-5, 0.0), (1e-4, 0.0)] {
            let found = [State::Learn, State::Detect].map(|state| lag(state, velocity));
            assert!(found.iter().all(|lag| (lag - expected).abs() < 1e-20), "{velocity}: {found:?}");
        }
        assert!((lag(State::Retract, 1e-5) - 2e-9).abs() < 1e-20);
    }
}
