//! Faults of the ring, the probe and the cycle are detected here, faults of measurements and drive in `sensing` and
//! `monitoring`. The values that are logged with each fault are here, too.

use std::f64::consts::TAU;

use control_blocks::{Consecutive, DELAY_MAX};
use serde::{Deserialize, Serialize};

use crate::center::Estimate;
use crate::commission::response::braked_late;
use crate::commission::{DELAY_STD_MAX, STD_MAX, plan};
use crate::interface::{Fault, Input, Parameters, State, Vars};
use crate::limits::{GRAVITY, cycle_time, held_surface_velocity, servo_damping, slowest_servo, speed_limit};
use crate::monitoring::{Numbers, RATIO_ERROR, plausible_ratio};
use crate::motion::TOLERANCE;
use crate::sensing::ProbeDelay;

/// Time without contact after which the probe has lost the ring, s.
const LOST_TIME: f64 = 0.1;
/// Time of contact of the pusher while following after which it is a crash, s.
const PRESSED_TIME: f64 = 0.005;
/// Time after which a surface that is too fast is no jump of the probe, s.
const FLYING_TIME: f64 = 0.03;
/// Time after which a slow spindle is at rest, s.
const STILL_TIME: f64 = 0.5;
/// Time to settle, in addition to the travel of the probe to its position and the time of settling, s.
const UNSETTLED_TIME: f64 = 3.0;
/// Rotation (revolutions) within which every collection and every wait must end.
const REVOLUTIONS_MAX: f64 = 1.1;
/// Rotation (revolutions) from push to push: three models of the ring and the wait, with a tenth to spare.
const CYCLE_REVOLUTIONS_MAX: f64 = 4.4;
/// Allowed motion of the line of a centered ring in a cycle, m (default; thermal drift is less).
const LINE_MOVED: f64 = 1e-4;
/// Standard deviations, of both models, and ratio of the height of the arc for a radius that is configured wrong.
const LINE_SIGMAS: f64 = 6.0;
const LINE_BEND: f64 = 0.25;
/// Minimum ratio of forward rotation to all rotation of a spindle that does not reverse.
const FORWARD: f64 = 0.9;

/// The first of the faults with the highest severity.
pub fn most_severe(found: &[Option<Fault>]) -> Option<Fault> {
    let worse = |a: Fault, b: Fault| if b.reaction() > a.reaction() { b } else { a };
    found.iter().copied().flatten().reduce(worse)
}

/// The cause of a fault with a probe that is delayed by `late` s relative to the slide (negative: the slide is
/// delayed). Such a delay explains every implausible measurement of the ring.
pub fn cause(fault: Fault, late: Option<f64>) -> Fault {
    use Fault::{
        Centrifugal, Divergence, EarlyContact, NoProgress, PositionDelayed, ProbeDelayed, ProbeFrozen, ProbeJump,
        ProbeRange, PushBudget, Unresolved,
    };
    match (fault, late) {
        (
            ProbeRange | Centrifugal | PushBudget | ProbeJump | ProbeFrozen | Divergence | Unresolved | NoProgress
            | EarlyContact,
            Some(late),
        ) => {
            if late > 0.0 {
                ProbeDelayed
            } else {
                PositionDelayed
            }
        }
        _ => fault,
    }
}

/// Quantities that are monitored in one control step.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a> {
    /// State of the step before.
    pub state: State,
    /// Probe deflection, m.
    pub probe: f64,
    /// Rotation since the step before, rad.
    pub rotation: f64,
    /// Spindle speed, rad/s.
    pub speed: f64,
    /// Velocity of the surface along the probe, m/s.
    pub surface: f64,
    /// The slide is about to leave its travel.
    pub beyond_travel: bool,
    /// The last model.
    pub estimate: Option<&'a Estimate>,
}

/// Counts for how long each condition has been violated; by default for no time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Supervisor {
    lost: Consecutive,
    pressed: Consecutive,
    flying: Consecutive,
    still: Consecutive,
    unsettled: Consecutive,
    /// rotation in the present state, rad
    rotation: f64,
    /// the same with its sign, rad
    forward: f64,
    /// rotation since the last push, rad
    cycle: f64,
    /// revolutions without a result and their limit, where they exceed it
    endless: Option<[f64; 2]>,
}

impl Supervisor {
    /// The state has changed to `state`.
    pub fn enter(&mut self, state: State) {
        (self.rotation, self.forward) = (0.0, 0.0);
        (self.unsettled, self.still) = (Consecutive::NONE, Consecutive::NONE);
        if matches!(state, State::Approach | State::Settle) {
            self.cycle = 0.0;
        }
    }

    /// Revolutions without a result and their limit, where they exceed it.
    pub fn endless(&self) -> Option<[f64; 2]> {
        self.endless
    }

    /// Ratio of forward rotation to all rotation in the present state; 1 before the spindle turned.
    pub fn forward(&self) -> f64 {
        if self.rotation > 0.0 { self.forward.abs() / self.rotation } else { 1.0 }
    }

    /// The fault of the highest severity in this step.
    pub fn check(&mut self, p: &Parameters, view: &Watched) -> Option<Fault> {
        self.count(p, view);
        if !view.state.active() {
            return None;
        }
        let over = |count: Consecutive, time: f64| count.count() > p.ticks(time);
        let too_far = view.probe >= p.probe.stroke || over(self.pressed, PRESSED_TIME);
        let unsettled = over(self.unsettled, UNSETTLED_TIME + p.null() / p.follow.velocity_max + p.settling().1);
        let turnings = [(self.rotation, REVOLUTIONS_MAX), (self.cycle, CYCLE_REVOLUTIONS_MAX)];
        let endless = turnings.into_iter().find(|(rotation, maximum)| *rotation > maximum * TAU);
        self.endless = endless.map(|(rotation, maximum)| [rotation / TAU, maximum]);
        let reversing = self.rotation > REVOLUTIONS_MAX * TAU && self.forward.abs() < FORWARD * self.rotation;
        let flying = over(self.flying, FLYING_TIME) || view.estimate.is_some_and(|ring| too_fast(p, view.speed, ring));
        (too_far || unsettled)
            .then_some(Fault::ProbeRange)
            .or((view.beyond_travel || over(self.lost, LOST_TIME)).then_some(Fault::NoPart))
            .or(flying.then_some(Fault::Centrifugal))
            .or(over(self.still, STILL_TIME).then_some(Fault::SpindleFrozen))
            .or(reversing.then_some(Fault::SpindleUneven))
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
            self.rotation += view.rotation.abs();
            self.forward += view.rotation;
            self.cycle += view.rotation.abs();
        }
    }
}

/// Whether the centrifugal force of the ring exceeds the configured friction, eq. 2.
pub fn too_fast(p: &Parameters, speed: f64, ring: &Estimate) -> bool {
    speed.abs() >= speed_limit(p.limits.friction, ring.center.eccentricity())
}

/// Whether the surface moves faster than that of any ring that friction holds. It needs no model of the ring.
fn shows_too_fast(p: &Parameters, view: &Watched) -> bool {
    // the fastest point of any surface has at least the velocity e w: evaluate the cheap condition first
    let fastest = view.surface.abs();
    view.state.follows()
        && fastest * view.speed.abs() > p.limits.friction * GRAVITY
        && fastest > held_surface_velocity(p.limits.friction, p.ring.radius, view.speed)
}

/// Distance (m) between the lines of a centered ring in a new model and in the most certain one so far, and its limit (m),
/// where it exceeds the limit. Neither ring nor spindle can move that line, so a measurement has jumped.
pub fn line_moved(p: &Parameters, most_certain: &Estimate, ring: &Estimate) -> Option<[f64; 2]> {
    let maximum = most_certain.center.eccentricity().max(ring.center.eccentricity());
    let bend = LINE_BEND * maximum.powi(2) / (4.0 * p.ring.radius);
    let distance = (ring.mean - most_certain.mean).abs();
    let limit = LINE_MOVED + LINE_SIGMAS * (most_certain.sigma + ring.sigma) + bend;
    (distance > limit).then_some([distance, limit])
}

/// Fault of a new model after `pushes` pushes; the first model had the eccentricity `first` m.
pub fn evaluate(p: &Parameters, speed: f64, pushes: i32, first: f64, ring: &Estimate) -> Option<Fault> {
    let eccentricity = ring.center.eccentricity();
    if eccentricity >= p.ring.radius {
        // eq. 32
        Some(Fault::RingTooSmall)
    } else if too_fast(p, speed, ring) {
        Some(Fault::Centrifugal)
    } else if eccentricity > first + p.push.critical_distance {
        // pushes that are much slower than the surface move the ring sideways
        Some(Fault::Divergence)
    } else {
        (eccentricity > p.tolerance && pushes >= p.limits.pushes).then_some(Fault::PushBudget)
    }
}

/// Values that belong to a state or a fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let e = 1e6 * vars.output.eccentricity;
    match (vars.output.state, vars.output.fault) {
        (State::Wait | State::Centered, _) => format!("; eccentricity `{e:.2} um`"),
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
        "following error `{:.3} mm`, limit `{:.3} mm`, gain ratio `{:.2}`",
        1e3 * output.monitor.following_error,
        1e3 * following_limit,
        output.monitor.drive_gain_ratio
    );
    match fault {
        Fault::None => String::new(),
        Fault::NoPart => format!(
            ": probe at `{probe_position:.6} m`, contact from `probe.contact` = `{} m`; slide at \
             `{slide_position:.6} m`, `approach.travel_max` = `{} m`",
            p.probe.contact, p.approach.travel_max
        ),
        Fault::RingTooSmall => format!(": r = `{} m`, B = `{e:.2} um`", p.ring.radius),
        Fault::ProbeRange => format!(
            ": probe at `{probe_position:.6} m`, target `{:.6} m`, `probe.at_pusher` = `{} m`, `probe.stroke` = `{} m`",
            p.null(),
            p.probe.at_pusher,
            p.probe.stroke
        ),
        Fault::Centrifugal if e > 0.0 => {
            let maximum = speed_limit(p.limits.friction, output.eccentricity);
            format!(": `{speed:.3} rad/s`, limit `{maximum:.3} rad/s` at B = `{e:.2} um` of the last model")
        }
        Fault::Centrifugal => format!(": `{speed:.3} rad/s`, before the first model"),
        Fault::PushBudget => format!(
            ": `{pushes}` pushes, `limits.pushes` = `{}`, B = `{e:.2} um`, `tolerance` = `{:.2} um`",
            p.limits.pushes,
            1e6 * p.tolerance
        ),
        Fault::Divergence => format!(
            ": `{pushes}` pushes, B from `{:.2} um` to `{e:.2} um`, increase limit `expert.push.critical_distance` = `{:.2} um`",
            1e6 * first,
            1e6 * p.push.critical_distance
        ),
        Fault::ProbeLost => format!(": probe at `{probe_position} m` {row}"),
        Fault::ProbeJump => match line {
            Some([distance, limit]) => {
                format!(
                    ": the line of the centered ring moved by `{:.3} mm`, limit `{:.3} mm`",
                    1e3 * distance,
                    1e3 * limit
                )
            }
            None => format!(": probe at `{probe_position} m` {row}"),
        },
        Fault::ProbeFrozen => {
            let ratio = output.monitor.probe_gain_ratio;
            let tested = if plausible_ratio(ratio) {
                String::new()
            } else {
                format!(", gain ratio in the probe test `{ratio:.2}`, limits 1 +- `{RATIO_ERROR}`")
            };
            format!(": probe at `{probe_position} m`{tested}")
        }
        Fault::ProbeDelayed | Fault::PositionDelayed => {
            let first = if fault == Fault::ProbeDelayed { "slide" } else { "probe" };
            let bound = if ProbeDelay::longest(p, probe_delay) { "at least " } else { "" };
            format!(
                ": {bound}`{:.2} ms` after the {first}, `sample_period` = `{:.2} ms`",
                1e3 * probe_delay.abs(),
                1e3 * p.sample_period
            )
        }
        Fault::EarlyContact => format!(
            ": contact with the probe at `{met:.6} m`, `probe.at_pusher` = `{} m`; probe now at `{probe_position:.6} m`",
            p.probe.at_pusher
        ),
        Fault::SpindleLost | Fault::SpindleJump => format!(": spindle at `{spindle_angle} rad` {row}"),
        Fault::SpindleFrozen => {
            format!(": `{speed:.3} rad/s`, minimum `limits.spindle_speed_min` = `{} rad/s`", p.limits.spindle_speed_min)
        }
        Fault::SpindleUneven => format!(
            ": `{speed:.3} rad/s`, ratio of forward rotation `{forward:.2}`, minimum `{FORWARD}`; `expert.rates.collect` = `{} Hz`",
            p.rates.collect
        ),
        Fault::SpindleSpeed => {
            format!(
                ": `{speed:.3} rad/s`, `spindle.speed` = `{} rad/s`, relative tolerance `{TOLERANCE}`",
                p.spindle_speed
            )
        }
        Fault::PositionLost | Fault::PositionJump => format!(": slide at `{slide_position} m` {row}"),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::PositionFrozen => format!(": slide at `{slide_position} m`, {error}"),
        Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive => format!(": {error}"),
        Fault::SlowServo => format!(
            ": `{:.1} Hz`, standard deviation `{:.1} Hz`, minimum `{:.1} Hz`",
            output.measured.slide_bandwidth / TAU,
            output.measured.slide_bandwidth_std / TAU,
            slowest_servo(p) / TAU
        ),
        Fault::NoProgress => {
            let lasted = match endless {
                Some([revolutions, maximum]) => {
                    format!("`{revolutions:.2}` revolutions without a result, limit `{maximum}`")
                }
                None => {
                    let (limit, commission) = (cycle_time(p, speed), plan::time(p));
                    let lasted = output.monitor.cycle_time;
                    format!(
                        "`{lasted:.1} s`, limit of a cycle `{limit:.1} s`, of a commissioning run `{commission:.1} s`"
                    )
                }
            };
            format!(": {lasted}, B = `{e:.2} um`")
        }
        Fault::CommissionRejected => of_commission(vars),
        Fault::Unresolved => format!(
            ": B = `{e:.3} um`, standard deviation `{:.3} um`, `tolerance` = `{:.3} um`",
            1e6 * output.eccentricity_std,
            1e6 * p.tolerance
        ),
    }
}

/// The same for a commissioning run that was rejected, after which the configured values are active.
fn of_commission(vars: &Vars) -> String {
    let (p, m) = (&vars.in_force, &vars.output.measured);
    let damping = servo_damping(p, m.slide_bandwidth);
    format!(
        ": bandwidth `{:.1} Hz`, limits half and twice `slide.bandwidth` = `{:.1} Hz`, minimum `{:.1} Hz` for \
         `limits.following_error`; its standard deviation `{:.2} Hz`, limit `{STD_MAX}` and `{:.4}` of the bandwidth; damping \
         `{:.2}`, limits `{:.2}` to `{:.2}`; delay `{:.2}` samples, limits `0` to `{DELAY_MAX}`; its standard deviation \
         `{:.3}`, limit `{DELAY_STD_MAX}`; probe at `{} m`, free up to `probe.contact` = `{} m`",
        m.slide_bandwidth / TAU,
        p.slide.bandwidth / TAU,
        slowest_servo(p) / TAU,
        m.slide_bandwidth_std / TAU,
        braked_late(p, m),
        m.slide_damping,
        damping.start(),
        damping.end(),
        m.io_delay,
        m.io_delay_std,
        vars.input.probe_position,
        p.probe.contact
    )
}

#[cfg(test)]
mod tests;
