//! Every fault is found here and gets its name; and the numbers that are told with it.

use std::f64::consts::TAU;

use control_blocks::{Consecutive, SafeEnd};
use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::interface::{Fault, Input, Parameters, State, Vars};
use crate::limits::{GRAVITY, held_surface_velocity, job_time, speed_limit};
use crate::monitoring::believable_share;

/// A probe that has no contact for longer has lost the ring, s.
const LOST_TIME: f64 = 0.1;
/// A pusher that touches for longer while following is a crash, s.
const PRESSED_TIME: f64 = 0.005;
/// A surface that is too fast for longer is no jump of the probe, s.
const FLYING_TIME: f64 = 0.03;
/// A spindle that is slow for longer stands still, s.
const STILL_TIME: f64 = 0.5;
/// A probe that takes longer than the time of settling and this does not settle, s.
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
            Self::LostReading | Self::FollowingError | Self::DriveSign | Self::WeakDrive => SafeEnd::DriveOff,
            Self::None
            | Self::NoPart
            | Self::RingTooSmall
            | Self::ProbeRange
            | Self::Centrifugal
            | Self::PushBudget
            | Self::InvalidInput
            | Self::ReadingJump
            | Self::FrozenReading
            | Self::Spindle
            | Self::Diverged
            | Self::Unresolved
            | Self::NoProgress => SafeEnd::Retract,
        }
    }
}

/// The first of the gravest faults.
pub fn graver(found: &[Option<Fault>]) -> Option<Fault> {
    let worse = |a: Fault, b: Fault| if b.safe_end() > a.safe_end() { b } else { a };
    found.iter().copied().flatten().reduce(worse)
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

    /// The gravest thing that is wrong in this tick.
    pub fn check(&mut self, p: &Parameters, view: &Watched) -> Option<Fault> {
        self.count(p, view);
        if !view.state.active() {
            return None;
        }
        let over = |count: Consecutive, time: f64| count.count() > p.ticks(time);
        let too_far = view.probe >= p.probe.stroke || over(self.pressed, PRESSED_TIME);
        let unsettled = over(self.unsettled, UNSETTLED_TIME + p.settling().1);
        let endless = self.turned > TURNS_MAX * TAU || self.cycle > CYCLE_TURNS_MAX * TAU;
        let reversing = self.turned > TURNS_MAX * TAU && self.forward.abs() < FORWARD * self.turned;
        let standing = over(self.still, STILL_TIME) || reversing;
        let flying = over(self.flying, FLYING_TIME) || view.estimate.is_some_and(|ring| too_fast(p, view.speed, ring));
        (too_far || unsettled)
            .then_some(Fault::ProbeRange)
            .or((view.beyond_travel || over(self.lost, LOST_TIME)).then_some(Fault::NoPart))
            .or(flying.then_some(Fault::Centrifugal))
            .or(standing.then_some(Fault::Spindle))
            .or(endless.then_some(Fault::NoProgress))
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

/// Whether a new model sees the line of a centred ring elsewhere than the surest one so far: no ring and no spindle moves
/// that, so a reading has.
pub fn line_moved(p: &Parameters, surest: &Estimate, ring: &Estimate) -> bool {
    let most = surest.centre.eccentricity().max(ring.centre.eccentricity());
    let bend = LINE_BEND * most.powi(2) / (4.0 * p.ring.radius);
    (ring.mean - surest.mean).abs() > LINE_MOVED + LINE_SIGMAS * (surest.sigma + ring.sigma) + bend
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
        Some(Fault::Diverged)
    } else {
        (eccentricity > p.tolerance && pushes >= p.limits.pushes).then_some(Fault::PushBudget)
    }
}

/// The numbers behind a state or a fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let Vars { input, output, parameters: p, .. } = vars;
    let Input { spindle_angle, slide_position, probe_position, .. } = input;
    let (e, sigma) = (1e6 * output.eccentricity, 1e6 * output.eccentricity_sigma);
    match (output.state, output.fault) {
        (State::Wait | State::Centred, _) => format!("; eccentricity `{e:.2} um`"),
        (State::Fault, Fault::NoPart) => {
            format!(": probe at `{probe_position:.6} m`, slide at `{slide_position:.6} m`")
        }
        (State::Fault, Fault::RingTooSmall) => format!(": r = `{} m`, B = `{e:.2} um`", p.ring.radius),
        (State::Fault, Fault::ProbeRange) => format!(": probe at `{probe_position:.6} m`"),
        (State::Fault, Fault::Centrifugal) => {
            format!(": `{:.3} rad/s`, B of the last model `{e:.2} um`", output.spindle_speed)
        }
        (State::Fault, Fault::PushBudget | Fault::Diverged) => {
            format!(": `{}` pushes, B = `{e:.2} um`", output.push.count)
        }
        (State::Fault, Fault::InvalidInput | Fault::ReadingJump) => {
            format!(": spindle at `{spindle_angle} rad`, probe at `{probe_position} m`")
        }
        (State::Fault, Fault::FrozenReading) => {
            let share = output.monitor.probe_share;
            let tested =
                if believable_share(share) { String::new() } else { format!(", it answered `{share:.2}` of its test") };
            format!(": probe at `{probe_position} m`{tested}")
        }
        (State::Fault, Fault::LostReading) => {
            format!(": slide at `{slide_position} m`, following error `{:.3} mm`", 1e3 * output.monitor.following_error)
        }
        (State::Fault, Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive) => {
            let (error, limit) = (1e3 * output.monitor.following_error, 1e3 * p.limits.following_error);
            format!(
                ": following error `{error:.3} mm` of `{limit} mm`, share of the setpoint `{:.2}`",
                output.monitor.drive_share
            )
        }
        (State::Fault, Fault::NoProgress) => {
            let limit = job_time(p, output.spindle_speed);
            format!(": `{:.1} s` of `{limit:.1} s`, B = `{e:.2} um`", output.monitor.job_time)
        }
        (State::Fault, Fault::Spindle) => format!(": `{:.3} rad/s`", output.spindle_speed),
        (State::Fault, Fault::Unresolved) => format!(": B = `{e:.3} um`, standard deviation `{sigma:.3} um`"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centre::Centre;
    use crate::limits::surface_velocity;

    const P: Parameters = Parameters::PAPER;
    const GOOD: Watched = Watched {
        state: State::Collect,
        probe: 0.0195,
        turned: 2.0944e-3,
        speed: 2.0944,
        surface: 1e-3,
        beyond_travel: false,
        estimate: None,
    };

    /// The first fault within `ticks`, and its tick.
    fn fault(view: Watched, ticks: u32) -> Option<(u32, Fault)> {
        let mut supervisor = Supervisor::default();
        (0..ticks).find_map(|k| Some((k, supervisor.check(&P, &view)?)))
    }

    fn ring(eccentricity: f64) -> Estimate {
        Estimate { centre: Centre { x: eccentricity, y: 0.0 }, mean: 0.08, sigma: 0.0 }
    }

    #[test]
    fn a_revolution_has_no_fault_and_more_than_that_has() {
        assert_eq!(fault(GOOD, 3299), None);
        assert_eq!(fault(GOOD, 3400), Some((3299, Fault::NoProgress)));
        assert_eq!(fault(Watched { state: State::Centred, ..GOOD }, 100_000), None);
    }

    #[test]
    fn one_that_reverses_is_told_from_one_that_turns() {
        let mut supervisor = Supervisor::default();
        let found = (0..3400).find_map(|k| {
            let turned = if k % 1000 < 500 { GOOD.turned } else { -GOOD.turned };
            supervisor.check(&P, &Watched { turned, ..GOOD })
        });
        assert_eq!(found, Some(Fault::Spindle));
    }

    #[test]
    fn no_change_of_state_gives_back_the_turning_since_the_last_push() {
        let mut supervisor = Supervisor::default();
        let mut flip = |k: u32| {
            let state = if k.is_multiple_of(2) { State::Collect } else { State::Wait };
            supervisor.enter(state);
            supervisor.check(&P, &Watched { state, ..GOOD })
        };
        // 3000 samples for a revolution
        let found = (0..20_000).find_map(|k| Some((k, flip(k)?)));
        assert_eq!(found, Some((13_199, Fault::NoProgress)));
        supervisor.enter(State::Settle);
        assert_eq!(supervisor.check(&P, &GOOD), None);
    }

    #[test]
    fn only_a_slide_that_knows_its_place_goes_back() {
        for &fault in Fault::ALL {
            let own = [Fault::LostReading, Fault::FollowingError, Fault::DriveSign, Fault::WeakDrive];
            let end = if own.contains(&fault) { SafeEnd::DriveOff } else { SafeEnd::Retract };
            assert_eq!(fault.safe_end(), end, "{fault:?}");
        }
        let found = [None, Some(Fault::NoPart), Some(Fault::DriveSign), Some(Fault::LostReading)];
        assert_eq!((graver(&found), graver(&[None])), (Some(Fault::DriveSign), None));
    }

    #[test]
    fn a_standing_spindle_has_a_name_when_rotation_is_needed() {
        let still = Watched { speed: 0.0, turned: 0.0, ..GOOD };
        assert_eq!(fault(still, 1000), Some((500, Fault::Spindle)));
        assert_eq!(fault(Watched { state: State::Centred, ..still }, 10_000), None);
    }

    #[test]
    fn a_probe_without_contact_has_lost_the_part() {
        for state in
            [State::Follow, State::Collect, State::Model, State::Wait, State::Push, State::Settle, State::Centred]
        {
            assert_eq!(fault(Watched { state, probe: 0.0, ..GOOD }, 1000), Some((100, Fault::NoPart)));
        }
        assert_eq!(fault(Watched { state: State::Approach, probe: 0.0, ..GOOD }, 1000), None);
    }

    #[test]
    fn the_pusher_may_touch_in_a_push_only() {
        let pressed = Watched { probe: 0.0201, ..GOOD };
        assert_eq!(fault(pressed, 100), Some((5, Fault::ProbeRange)));
        assert_eq!(fault(Watched { state: State::Push, ..pressed }, 100), None);
        let beyond = Watched { state: State::Push, probe: 0.0251, ..GOOD };
        assert_eq!(fault(beyond, 100), Some((0, Fault::ProbeRange)));
    }

    #[test]
    fn a_probe_that_does_not_settle_has_a_name() {
        assert_eq!(fault(Watched { state: State::Follow, ..GOOD }, 4000), Some((3100, Fault::ProbeRange)));
    }

    #[test]
    fn the_end_of_the_travel_is_no_part() {
        let view = Watched { state: State::Approach, probe: 0.0, beyond_travel: true, ..GOOD };
        assert_eq!(fault(view, 10), Some((0, Fault::NoPart)));
    }

    #[test]
    fn nothing_is_wrong_while_idle() {
        for state in [State::Idle, State::Fault] {
            assert_eq!(fault(Watched { state, probe: 1.0, speed: 0.0, beyond_travel: true, ..GOOD }, 10_000), None);
        }
    }

    #[test]
    fn the_centrifugal_limit_is_that_of_the_paper() {
        // 25 mm: 42.3 rpm
        let (slow, fast) = (42.0 * TAU / 60.0, 42.5 * TAU / 60.0);
        assert!(!too_fast(&P, slow, &ring(0.025)) && too_fast(&P, fast, &ring(0.025)));
        let view = Watched { speed: -fast, estimate: Some(&ring(0.025)), state: State::Centred, ..GOOD };
        assert_eq!(fault(view, 1), Some((0, Fault::Centrifugal)));
    }

    #[test]
    fn a_fast_surface_is_centrifugal_before_there_is_a_model() {
        // 45 rpm: 25 mm are too much for mu 0.05, 22 mm are not
        let speed = 45.0 * TAU / 60.0;
        let shown =
            |e: f64| Watched { state: State::Follow, speed, surface: -surface_velocity(e, 0.05, speed), ..GOOD };
        assert_eq!(fault(shown(0.025), 100), Some((30, Fault::Centrifugal)));
        assert_eq!(fault(shown(0.022), 100), None);
        assert_eq!(fault(Watched { speed: 0.0, ..shown(0.025) }, 100), None);
    }

    #[test]
    fn a_new_model_is_judged() {
        assert_eq!(judge(&P, 1.0, 0, 0.06, &ring(0.06)), Some(Fault::RingTooSmall));
        assert_eq!(judge(&P, 40.0, 0, 0.001, &ring(0.001)), Some(Fault::Centrifugal));
        assert_eq!(judge(&P, 2.0, 25, 1e-4, &ring(1e-5)), Some(Fault::PushBudget));
        assert_eq!(judge(&P, 2.0, 25, 1e-4, &ring(2e-6)), None);
        assert_eq!(judge(&P, 2.0, 24, 1e-4, &ring(1e-5)), None);
        assert_eq!(judge(&P, 2.0, 1, 0.010, &ring(0.0126)), Some(Fault::Diverged));
        assert_eq!(judge(&P, 2.0, 1, 0.010, &ring(0.0124)), None);
    }

    #[test]
    fn a_line_that_moves_is_a_jump_of_a_reading() {
        let seen = |mean: f64, sigma: f64, x: f64| Estimate { centre: Centre { x, y: 0.0 }, mean, sigma };
        let sure = seen(0.08, 1e-6, 1e-5);
        // 0.1 mm and 6 x (1 + 4) um
        for way in [1.29e-4, -1.29e-4] {
            assert!(!line_moved(&P, &sure, &seen(0.08 + way, 4e-6, 0.0)));
            assert!(line_moved(&P, &sure, &seen(0.08 + 1.02 * way, 4e-6, 0.0)));
        }
        // 20 mm off, a radius that is told 25 % wrong moves the line by 0.5 mm
        let far = seen(0.08, 0.0, 0.02);
        assert!(!line_moved(&P, &far, &seen(0.08059, 0.0, 0.0)));
        assert!(line_moved(&P, &far, &seen(0.08061, 0.0, 0.0)));
    }
}
