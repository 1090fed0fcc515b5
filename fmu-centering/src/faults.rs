//! Faults of the ring, the probe and the job are found here, of readings and drive in `sensing` and `monitoring`; how each
//! of them ends, and the numbers that are told with it.

use std::f64::consts::TAU;

use control_blocks::{Consecutive, DELAY_MAX, SafeEnd};
use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::commission::plan;
use crate::commission::response::braked_late;
use crate::interface::{Fault, Input, Parameters, State, Vars};
use crate::limits::{GRAVITY, held_surface_velocity, job_time, servo_damping, slowest_servo, speed_limit};
use crate::monitoring::{Numbers, SHARE_ERROR, believable_share};
use crate::motion::TOLERANCE;
use crate::sensing::ProbeDelay;

/// A probe that has no contact for longer has lost the ring, s.
const LOST_TIME: f64 = 0.1;
/// A pusher that touches for longer while following is a crash, s.
const PRESSED_TIME: f64 = 0.005;
/// A surface that is too fast for longer is no jump of the probe, s.
const FLYING_TIME: f64 = 0.03;
/// A spindle that is slow for longer stands still, s.
const STILL_TIME: f64 = 0.5;
/// A probe that takes longer than the way to its place, the time of settling and this does not settle, s.
const UNSETTLED_TIME: f64 = 3.0;
/// Turning (in revolutions) in which every collection and every wait ends.
const TURNS_MAX: f64 = 1.1;
/// Turning (in revolutions) from push to push, with three models of the ring and the wait (our choice).
const CYCLE_TURNS_MAX: f64 = 4.4;
/// What the line of a centred ring may move in a centring, m (our choice: warmth moves it by less).
const LINE_MOVED: f64 = 1e-4;
/// Standard deviations, of both models, and share of the arc's height for a radius that is told wrong.
const LINE_SIGMAS: f64 = 6.0;
const LINE_BEND: f64 = 0.25;
/// Least share of its turning that a spindle which does not reverse goes forward.
const FORWARD: f64 = 0.9;

impl Fault {
    /// How a centring ends that this fault has stopped: by going back, where the place of the slide is known.
    pub fn safe_end(self) -> SafeEnd {
        match self {
            Self::LostReading
            | Self::ReadingJump
            | Self::FrozenReading
            | Self::FollowingError
            | Self::DriveSign
            | Self::WeakDrive
            | Self::LongStep => SafeEnd::DriveOff,
            Self::None
            | Self::NoPart
            | Self::RingTooSmall
            | Self::ProbeRange
            | Self::Centrifugal
            | Self::PushBudget
            | Self::LostProbe
            | Self::ProbeJump
            | Self::FrozenProbe
            | Self::LostSpindle
            | Self::SpindleJump
            | Self::FrozenSpindle
            | Self::Spindle
            | Self::Divergence
            | Self::Unresolved
            | Self::SlowServo
            | Self::SpindleSpeed
            | Self::NoProgress
            | Self::CommissionRejected
            | Self::LateProbe
            | Self::LateReading
            | Self::EarlyContact => SafeEnd::Retract,
        }
    }
}

/// The first of the gravest faults.
pub fn graver(found: &[Option<Fault>]) -> Option<Fault> {
    let worse = |a: Fault, b: Fault| if b.safe_end() > a.safe_end() { b } else { a };
    found.iter().copied().flatten().reduce(worse)
}

/// The cause of a fault with a probe that is `late` s later than the slide, or earlier: whatever makes no sense of the ring then
/// follows from that.
pub fn cause(fault: Fault, late: Option<f64>) -> Fault {
    use Fault::{
        Centrifugal, Divergence, EarlyContact, FrozenProbe, LateProbe, LateReading, NoProgress, ProbeJump, ProbeRange,
        PushBudget, Unresolved,
    };
    match (fault, late) {
        (
            ProbeRange | Centrifugal | PushBudget | ProbeJump | FrozenProbe | Divergence | Unresolved | NoProgress
            | EarlyContact,
            Some(late),
        ) => {
            if late > 0.0 {
                LateProbe
            } else {
                LateReading
            }
        }
        _ => fault,
    }
}

/// What is watched in one tick.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a> {
    /// State of the tick before.
    pub state: State,
    /// Probe collapse, m.
    pub probe: f64,
    /// Turning since the tick before, rad.
    pub turned: f64,
    /// Spindle speed, rad/s.
    pub speed: f64,
    /// Velocity of the surface along the probe, m/s.
    pub surface: f64,
    /// The slide is about to leave its travel.
    pub beyond_travel: bool,
    /// The last model.
    pub estimate: Option<&'a Estimate>,
}

/// Counts how long things have been wrong; by default they are not.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Supervisor {
    lost: Consecutive,
    pressed: Consecutive,
    flying: Consecutive,
    still: Consecutive,
    unsettled: Consecutive,
    turned: f64,
    /// the same with its sign
    forward: f64,
    /// turning since the last push
    cycle: f64,
    /// revolutions of one of them that are too many, and how many there may be
    endless: Option<[f64; 2]>,
}

impl Supervisor {
    /// The state has changed to `state`.
    pub fn enter(&mut self, state: State) {
        (self.turned, self.forward) = (0.0, 0.0);
        (self.unsettled, self.still) = (Consecutive::NONE, Consecutive::NONE);
        if matches!(state, State::Approach | State::Settle) {
            self.cycle = 0.0;
        }
    }

    /// Revolutions without result where there were too many, and how many there may be.
    pub fn endless(&self) -> Option<[f64; 2]> {
        self.endless
    }

    /// Share of its turning that the spindle has gone forward in the present state; 1 before it turned.
    pub fn forward(&self) -> f64 {
        if self.turned > 0.0 { self.forward.abs() / self.turned } else { 1.0 }
    }

    /// The gravest thing that is wrong in this tick.
    pub fn check(&mut self, p: &Parameters, view: &Watched) -> Option<Fault> {
        self.count(p, view);
        if !view.state.active() {
            return None;
        }
        let over = |count: Consecutive, time: f64| count.count() > p.ticks(time);
        let too_far = view.probe >= p.probe.stroke || over(self.pressed, PRESSED_TIME);
        let unsettled = over(self.unsettled, UNSETTLED_TIME + p.null() / p.follow.velocity_max + p.settling().1);
        let turnings = [(self.turned, TURNS_MAX), (self.cycle, CYCLE_TURNS_MAX)];
        let endless = turnings.into_iter().find(|(turned, most)| *turned > most * TAU);
        self.endless = endless.map(|(turned, most)| [turned / TAU, most]);
        let reversing = self.turned > TURNS_MAX * TAU && self.forward.abs() < FORWARD * self.turned;
        let flying = over(self.flying, FLYING_TIME) || view.estimate.is_some_and(|ring| too_fast(p, view.speed, ring));
        (too_far || unsettled)
            .then_some(Fault::ProbeRange)
            .or((view.beyond_travel || over(self.lost, LOST_TIME)).then_some(Fault::NoPart))
            .or(flying.then_some(Fault::Centrifugal))
            .or(over(self.still, STILL_TIME).then_some(Fault::FrozenSpindle))
            .or(reversing.then_some(Fault::Spindle))
            .or(endless.map(|_| Fault::NoProgress))
    }

    fn count(&mut self, p: &Parameters, view: &Watched) {
        let settling = matches!(view.state, State::Follow | State::Settle);
        self.lost.update(view.state.touches() && view.probe < 0.5 * p.probe.contact);
        self.pressed.update(view.state.follows() && view.probe > p.probe.at_pusher);
        self.flying.update(shows_too_fast(p, view));
        self.still.update(view.state.needs_rotation() && view.speed.abs() < p.limits.spindle_speed_min);
        self.unsettled.update(settling);
        if view.state.needs_rotation() {
            self.turned += view.turned.abs();
            self.forward += view.turned;
            self.cycle += view.turned.abs();
        }
    }
}

/// Whether the centrifugal force of the ring exceeds the friction that is assumed, eq. 2.
pub fn too_fast(p: &Parameters, speed: f64, ring: &Estimate) -> bool {
    speed.abs() >= speed_limit(p.limits.friction, ring.centre.eccentricity())
}

/// Whether the surface moves faster than that of any ring that friction holds: an answer before the first model.
fn shows_too_fast(p: &Parameters, view: &Watched) -> bool {
    // the fastest place of any surface has at least e w: a cheap question first
    let fastest = view.surface.abs();
    view.state.follows()
        && fastest * view.speed.abs() > p.limits.friction * GRAVITY
        && fastest > held_surface_velocity(p.limits.friction, p.ring.radius, view.speed)
}

/// By how much a new model sees the line of a centred ring elsewhere than the surest one so far, and the limit (m), where
/// that is too far: no ring and no spindle moves that, so a reading has.
pub fn line_moved(p: &Parameters, surest: &Estimate, ring: &Estimate) -> Option<[f64; 2]> {
    let most = surest.centre.eccentricity().max(ring.centre.eccentricity());
    let bend = LINE_BEND * most.powi(2) / (4.0 * p.ring.radius);
    let way = (ring.mean - surest.mean).abs();
    let limit = LINE_MOVED + LINE_SIGMAS * (surest.sigma + ring.sigma) + bend;
    (way > limit).then_some([way, limit])
}

/// What is wrong with a new model after `pushes` pushes; the first model had the eccentricity `first` m.
pub fn judge(p: &Parameters, speed: f64, pushes: i32, first: f64, ring: &Estimate) -> Option<Fault> {
    let eccentricity = ring.centre.eccentricity();
    if eccentricity >= p.ring.radius {
        // eq. 32
        Some(Fault::RingTooSmall)
    } else if too_fast(p, speed, ring) {
        Some(Fault::Centrifugal)
    } else if eccentricity > first + p.push.critical_distance {
        // pushes that are much slower than the surface move the ring aside
        Some(Fault::Divergence)
    } else {
        (eccentricity > p.tolerance && pushes >= p.limits.pushes).then_some(Fault::PushBudget)
    }
}

/// The numbers behind a state or a fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let e = 1e6 * vars.output.eccentricity;
    match (vars.output.state, vars.output.fault) {
        (State::Wait | State::Centred, _) => format!("; eccentricity `{e:.2} um`"),
        (State::Fault, fault) => of_fault(vars, fault, e),
        _ => String::new(),
    }
}

/// The same for a fault, with the eccentricity B = `e` um of the last model.
fn of_fault(vars: &Vars, fault: Fault, e: f64) -> String {
    let Vars { input, output, in_force: p, .. } = vars;
    let Input { spindle_angle, slide_position, probe_position, .. } = input;
    let Numbers { following_limit, forward, endless, line, first, probe_delay, met } = output.numbers;
    let (pushes, speed) = (output.push.count, output.spindle_speed);
    let row = format!("for more than `limits.lost_samples` = `{}` samples", p.limits.lost_samples);
    let error = format!(
        "following error `{:.3} mm` of `{:.3} mm`, share of the setpoint `{:.2}`",
        1e3 * output.monitor.following_error,
        1e3 * following_limit,
        output.monitor.drive_share
    );
    match fault {
        Fault::None => String::new(),
        Fault::NoPart => format!(
            ": probe at `{probe_position:.6} m`, on a ring from `probe.contact` = `{} m` on; slide at \
             `{slide_position:.6} m`, `approach.travel_max` = `{} m`",
            p.probe.contact, p.approach.travel_max
        ),
        Fault::RingTooSmall => format!(": r = `{} m`, B = `{e:.2} um`", p.ring.radius),
        Fault::ProbeRange => format!(
            ": probe at `{probe_position:.6} m`, its place is `{:.6} m`, `probe.at_pusher` = `{} m`, `probe.stroke` = `{} m`",
            p.null(),
            p.probe.at_pusher,
            p.probe.stroke
        ),
        Fault::Centrifugal if e > 0.0 => {
            let most = speed_limit(p.limits.friction, output.eccentricity);
            format!(": `{speed:.3} rad/s`, at most `{most:.3} rad/s` for the B of the last model, `{e:.2} um`")
        }
        Fault::Centrifugal => format!(": `{speed:.3} rad/s`, before the first model"),
        Fault::PushBudget => format!(
            ": `{pushes}` pushes, `limits.pushes` = `{}`, B = `{e:.2} um`, `tolerance` = `{:.2} um`",
            p.limits.pushes,
            1e6 * p.tolerance
        ),
        Fault::Divergence => format!(
            ": `{pushes}` pushes, B from `{:.2} um` to `{e:.2} um`, `push.critical_distance` = `{:.2} um` more at most",
            1e6 * first,
            1e6 * p.push.critical_distance
        ),
        Fault::LostProbe => format!(": probe at `{probe_position} m` {row}"),
        Fault::ProbeJump => match line {
            Some([way, limit]) => {
                format!(
                    ": the centred surface is `{:.3} mm` from where it was, limit `{:.3} mm`",
                    1e3 * way,
                    1e3 * limit
                )
            }
            None => format!(": probe at `{probe_position} m` {row}"),
        },
        Fault::FrozenProbe => {
            let share = output.monitor.probe_share;
            let tested = if believable_share(share) {
                String::new()
            } else {
                format!(", it answered `{share:.2}` of its test, within `{SHARE_ERROR}` of 1 is right")
            };
            format!(": probe at `{probe_position} m`{tested}")
        }
        Fault::LateProbe | Fault::LateReading => {
            let first = if fault == Fault::LateProbe { "slide" } else { "probe" };
            let least = if ProbeDelay::longest(p, probe_delay) { "at least " } else { "" };
            format!(
                ": {least}`{:.2} ms` after the {first}, `sample_period` = `{:.2} ms`",
                1e3 * probe_delay.abs(),
                1e3 * p.sample_period
            )
        }
        Fault::EarlyContact => format!(
            ": met with the probe at `{met:.6} m`, `probe.at_pusher` = `{} m`; it is at `{probe_position:.6} m` now",
            p.probe.at_pusher
        ),
        Fault::LostSpindle | Fault::SpindleJump => format!(": spindle at `{spindle_angle} rad` {row}"),
        Fault::FrozenSpindle => {
            format!(
                ": `{speed:.3} rad/s`, at least `limits.spindle_speed_min` = `{} rad/s`",
                p.limits.spindle_speed_min
            )
        }
        Fault::Spindle => format!(
            ": `{speed:.3} rad/s`, `{forward:.2}` of its turning forwards, at least `{FORWARD}`; `rates.collect` = `{} Hz`",
            p.rates.collect
        ),
        Fault::SpindleSpeed => {
            format!(": `{speed:.3} rad/s`, `spindle.speed` = `{} rad/s`, within `{TOLERANCE}` of it", p.spindle_speed)
        }
        Fault::LostReading | Fault::ReadingJump => format!(": slide at `{slide_position} m` {row}"),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::FrozenReading => format!(": slide at `{slide_position} m`, {error}"),
        Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive => format!(": {error}"),
        Fault::SlowServo => format!(
            ": `{:.1} Hz`, standard deviation `{:.1} Hz`, at least `{:.1} Hz`",
            output.measured.slide_bandwidth / TAU,
            output.measured.slide_bandwidth_deviation / TAU,
            slowest_servo(p) / TAU
        ),
        Fault::NoProgress => {
            let lasted = match endless {
                Some([turns, most]) => format!("`{turns:.2}` of `{most}` revolutions without result"),
                None => {
                    let (limit, commission) = (job_time(p, speed), plan::time(p));
                    let lasted = output.monitor.job_time;
                    format!("`{lasted:.1} s`, limit of a centring `{limit:.1} s`, of a commission `{commission:.1} s`")
                }
            };
            format!(": {lasted}, B = `{e:.2} um`")
        }
        Fault::CommissionRejected => of_commission(vars),
        Fault::Unresolved => format!(
            ": B = `{e:.3} um`, standard deviation `{:.3} um`, `tolerance` = `{:.3} um`",
            1e6 * output.eccentricity_sigma,
            1e6 * p.tolerance
        ),
    }
}

/// The same for a commission that was rejected, after which what was told is in force.
fn of_commission(vars: &Vars) -> String {
    let (p, m) = (&vars.in_force, &vars.output.measured);
    let damping = servo_damping(p, m.slide_bandwidth);
    format!(
        ": bandwidth `{:.1} Hz`, deviation `{:.2} Hz`, limits half and twice `slide.bandwidth` = `{:.1} Hz` as told, `{:.1} Hz` or more for \
         `limits.following_error`, and `commission.deviation_max` = `{}` of it beside `{:.4}` of the steps of a servo; damping `{:.2}`, limits `{:.2}` to `{:.2}` for \
         `limits.following_error` and `stroke.feedback`; delay `{:.2}` samples, deviation `{:.3}`, limits `0` to `{DELAY_MAX}` and \
         `commission.delay_deviation_max` = `{}`; probe at `{} m`, free up to `probe.contact` = `{} m`",
        m.slide_bandwidth / TAU,
        m.slide_bandwidth_deviation / TAU,
        p.slide.bandwidth / TAU,
        slowest_servo(p) / TAU,
        p.commission.deviation_max,
        braked_late(p, m),
        m.slide_damping,
        damping.start(),
        damping.end(),
        m.io_delay,
        m.io_delay_deviation,
        p.commission.delay_deviation_max,
        vars.input.probe_position,
        p.probe.contact
    )
}

#[cfg(test)]
mod tests;
