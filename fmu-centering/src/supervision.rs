//! Watches for what must not happen, and gives it its name.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::limits::{GRAVITY, held_surface_velocity, speed_limit};
use crate::machine::{Fault, State};
use crate::parameters::Parameters;

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

/// What is watched in one tick.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
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
    lost: u32,
    pressed: u32,
    flying: u32,
    still: u32,
    unsettled: u32,
    turned: f64,
}

impl Supervisor {
    /// The state has changed.
    pub fn enter(&mut self) {
        (self.turned, self.unsettled, self.still) = (0.0, 0, 0);
    }

    /// The gravest thing that is wrong in this tick.
    pub fn check(&mut self, p: &Parameters, view: &View) -> Option<Fault> {
        self.count(p, view);
        if !view.state.active() {
            return None;
        }
        let over = |count: u32, time: f64| count > p.ticks(time);
        let too_far = view.probe >= p.probe.stroke || over(self.pressed, PRESSED_TIME);
        let unsettled = over(self.unsettled, UNSETTLED_TIME + p.settling().1);
        let standing = over(self.still, STILL_TIME) || self.turned > TURNS_MAX * TAU;
        let flying = over(self.flying, FLYING_TIME) || view.estimate.is_some_and(|ring| too_fast(p, view.speed, ring));
        (too_far || unsettled)
            .then_some(Fault::ProbeRange)
            .or((view.beyond_travel || over(self.lost, LOST_TIME)).then_some(Fault::NoPart))
            .or(flying.then_some(Fault::Centrifugal))
            .or(standing.then_some(Fault::Spindle))
    }

    fn count(&mut self, p: &Parameters, view: &View) {
        let settling = matches!(view.state, State::Follow | State::Settle);
        let contact = view.state.follows() || matches!(view.state, State::Push | State::Settle);
        step(&mut self.lost, contact && view.probe < 0.5 * p.probe.contact);
        step(&mut self.pressed, view.state.follows() && view.probe > p.probe.at_pusher);
        step(&mut self.flying, shows_too_fast(p, view));
        step(&mut self.still, view.state.needs_rotation() && view.speed.abs() < p.spindle.speed_min);
        step(&mut self.unsettled, settling);
        if view.state.needs_rotation() {
            self.turned += view.turned.abs();
        }
    }
}

/// Whether the centrifugal force of the ring exceeds the friction that is assumed, eq. 2.
pub fn too_fast(p: &Parameters, speed: f64, ring: &Estimate) -> bool {
    speed.abs() >= speed_limit(p.friction.mu_limit, ring.centre.eccentricity())
}

/// Whether the surface moves faster than that of any ring that friction holds: an answer before the first model.
fn shows_too_fast(p: &Parameters, view: &View) -> bool {
    // the fastest place of any surface has at least e w: a cheap question first
    let fastest = view.surface.abs();
    view.state.follows()
        && fastest * view.speed.abs() > p.friction.mu_limit * GRAVITY
        && fastest > held_surface_velocity(p.friction.mu_limit, p.ring.radius, view.speed)
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
        // pushes that are much slower than the surface shove the ring aside
        Some(Fault::Diverged)
    } else {
        (eccentricity > p.tolerance && pushes >= p.push.max_count).then_some(Fault::PushBudget)
    }
}

/// Counts the ticks in a row in which `wrong` holds.
fn step(count: &mut u32, wrong: bool) {
    *count = if wrong { count.saturating_add(1) } else { 0 };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centre::Centre;
    use crate::limits::surface_velocity;

    const P: Parameters = Parameters::PAPER;
    const GOOD: View = View {
        state: State::Collect,
        probe: 0.0195,
        turned: 2.0944e-3,
        speed: 2.0944,
        surface: 1e-3,
        beyond_travel: false,
        estimate: None,
    };

    /// The first fault within `ticks`, and its tick.
    fn fault(view: View, ticks: u32) -> Option<(u32, Fault)> {
        let mut supervisor = Supervisor::default();
        (0..ticks).find_map(|k| Some((k, supervisor.check(&P, &view)?)))
    }

    fn ring(eccentricity: f64) -> Estimate {
        Estimate { centre: Centre { x: eccentricity, y: 0.0 }, mean: 0.08, sigma: 0.0 }
    }

    #[test]
    fn a_revolution_has_no_fault_and_more_than_that_has() {
        assert_eq!(fault(GOOD, 3299), None);
        assert_eq!(fault(GOOD, 3400), Some((3299, Fault::Spindle)));
        assert_eq!(fault(View { state: State::Centred, ..GOOD }, 100_000), None);
    }

    #[test]
    fn a_standing_spindle_has_a_name_when_rotation_is_needed() {
        let still = View { speed: 0.0, turned: 0.0, ..GOOD };
        assert_eq!(fault(still, 1000), Some((500, Fault::Spindle)));
        assert_eq!(fault(View { state: State::Centred, ..still }, 10_000), None);
    }

    #[test]
    fn a_probe_without_contact_has_lost_the_part() {
        for state in
            [State::Follow, State::Collect, State::Model, State::Wait, State::Push, State::Settle, State::Centred]
        {
            assert_eq!(fault(View { state, probe: 0.0, ..GOOD }, 1000), Some((100, Fault::NoPart)));
        }
        assert_eq!(fault(View { state: State::Approach, probe: 0.0, ..GOOD }, 1000), None);
    }

    #[test]
    fn the_pusher_may_touch_in_a_push_only() {
        let pressed = View { probe: 0.0201, ..GOOD };
        assert_eq!(fault(pressed, 100), Some((5, Fault::ProbeRange)));
        assert_eq!(fault(View { state: State::Push, ..pressed }, 100), None);
        let beyond = View { state: State::Push, probe: 0.0251, ..GOOD };
        assert_eq!(fault(beyond, 100), Some((0, Fault::ProbeRange)));
    }

    #[test]
    fn a_probe_that_does_not_settle_has_a_name() {
        assert_eq!(fault(View { state: State::Follow, ..GOOD }, 4000), Some((3100, Fault::ProbeRange)));
    }

    #[test]
    fn the_end_of_the_travel_is_no_part() {
        let view = View { state: State::Approach, probe: 0.0, beyond_travel: true, ..GOOD };
        assert_eq!(fault(view, 10), Some((0, Fault::NoPart)));
    }

    #[test]
    fn nothing_is_wrong_while_idle() {
        for state in [State::Idle, State::Fault] {
            assert_eq!(fault(View { state, probe: 1.0, speed: 0.0, beyond_travel: true, ..GOOD }, 10_000), None);
        }
    }

    #[test]
    fn the_centrifugal_limit_is_that_of_the_paper() {
        // 25 mm: 42.3 rpm
        let (slow, fast) = (42.0 * TAU / 60.0, 42.5 * TAU / 60.0);
        assert!(!too_fast(&P, slow, &ring(0.025)) && too_fast(&P, fast, &ring(0.025)));
        let view = View { speed: -fast, estimate: Some(&ring(0.025)), state: State::Centred, ..GOOD };
        assert_eq!(fault(view, 1), Some((0, Fault::Centrifugal)));
    }

    #[test]
    fn a_fast_surface_is_centrifugal_before_there_is_a_model() {
        // 45 rpm: 25 mm are too much for mu 0.05, 22 mm are not
        let speed = 45.0 * TAU / 60.0;
        let shown = |e: f64| View { state: State::Follow, speed, surface: -surface_velocity(e, 0.05, speed), ..GOOD };
        assert_eq!(fault(shown(0.025), 100), Some((30, Fault::Centrifugal)));
        assert_eq!(fault(shown(0.022), 100), None);
        assert_eq!(fault(View { speed: 0.0, ..shown(0.025) }, 100), None);
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
}
