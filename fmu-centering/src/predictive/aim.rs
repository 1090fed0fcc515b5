//! Start of a stroke so that it meets the ring in the right direction, and its end.

use std::f64::consts::TAU;

use control_blocks::Trajectory;
use nalgebra::Rotation2;

use crate::interface::Parameters;
use crate::predictive::contact::{Contact, FirstContact};
use crate::predictive::learned::LearnedParameters;
use crate::predictive::press::{Ending, Press};
use crate::predictive::ring_model::RingModel;
use crate::predictive::stroke::{Finish, SlideLimits, Stroke};

/// Passes of the fixed point of angle and stroke: the line changes by micrometers over a stroke.
const PASSES: usize = 3;
/// Margin before the expected contact: in standard deviations of the contact, and the minimum, m.
const STANDOFF: f64 = 3.0;
const STANDOFF_MIN: f64 = 2e-6;
/// Longest time for the standoff, s.
const CREEP_TIME: f64 = 0.15;
/// Largest delay of a launch, rad: that fraction of the push is lost, which is cheaper than a revolution.
const LATE: f64 = 0.1;
/// Deceleration that ends a stroke immediately, m/s2.
const BLOW: f64 = 1e9;

/// Inputs of the plan of a launch.
#[derive(Clone, Copy, Debug)]
pub struct AimInput<'a> {
    /// The ring.
    pub ring: &'a RingModel,
    /// Learned values.
    pub learned: &'a LearnedParameters,
    /// Spindle angle now, rad.
    pub angle: f64,
    /// Spindle speed, rad/s.
    pub speed: f64,
    /// Setpoint of the slide now.
    pub setpoint: Trajectory,
    /// Bandwidth of the servo, rad/s.
    pub bandwidth: f64,
    /// Time until the next plan, s.
    pub horizon: f64,
}

/// A stroke that starts now.
#[derive(Clone, Debug)]
pub struct PlannedStroke {
    /// The stroke.
    pub press: Press,
    /// Travel of the slide, m.
    pub distance: f64,
    /// Velocity at contact, m/s.
    pub velocity: f64,
    /// Rotation of the spindle from the start to the end, rad.
    pub lead: f64,
    /// Spindle angle at the end, rad.
    pub angle: f64,
}

/// Type of motion of the ring.
struct PlannedApproach {
    meeting: FirstContact,
    finish: Finish,
    ending: Ending,
}

/// The stroke, if it must start before the next plan.
pub fn aim(p: &Parameters, input: &AimInput, tap: Option<f64>) -> Option<PlannedStroke> {
    let approach = tap.map_or_else(|| push(p, input), |speed| blow(p, input, speed));
    let (mut angle, mut wait) = (input.angle, 0.0);
    let mut stroke = Stroke::default();
    for _ in 0..PASSES {
        stroke = plan(p, input, &approach, angle);
        wait = wait_for(p, input, &approach, &stroke);
        angle = input.angle + input.speed * (wait + stroke.duration());
    }
    if wait >= input.horizon {
        return None;
    }
    let press = Press::new(stroke.clone(), approach.ending, approach.meeting.time, wait, input.bandwidth);
    Some(PlannedStroke {
        distance: stroke.end() - input.setpoint.position,
        velocity: approach.finish.velocity,
        lead: input.speed.abs() * (wait + stroke.duration()),
        angle,
        press,
    })
}

fn contact(p: &Parameters, input: &AimInput) -> Contact {
    Contact { radius: p.ring.radius, speed: input.speed, lateral: input.learned.lateral.mean }
}

/// Margin before the expected contact, m.
fn standoff(input: &AimInput) -> f64 {
    STANDOFF * input.learned.contact.sigma + STANDOFF_MIN
}

/// A push that ends at rest.
fn push(p: &Parameters, input: &AimInput) -> PlannedApproach {
    let eccentricity = input.ring.eccentricity();
    let duration = p.stroke.duration.max((2.0 * eccentricity / p.stroke.deceleration).sqrt());
    let finish = Finish::braked(eccentricity, duration, p.stroke.velocity_max)
        .at_least(standoff(input) / CREEP_TIME, eccentricity);
    let mut meeting = contact(p, input).meeting(eccentricity, &finish);
    if !p.stroke.phase_plan {
        meeting.center = nalgebra::Vector2::new(eccentricity, 0.0);
    }
    PlannedApproach { meeting, finish, ending: Ending::Rest }
}

/// A tap.
fn blow(p: &Parameters, input: &AimInput, speed: f64) -> PlannedApproach {
    let mut meeting = contact(p, input).blow(input.ring.eccentricity());
    if !p.stroke.phase_plan {
        meeting.center = nalgebra::Vector2::new(input.ring.eccentricity(), 0.0);
    }
    PlannedApproach { meeting, finish: Finish { velocity: speed, deceleration: BLOW }, ending: Ending::Blow }
}

/// The stroke that ends at the spindle angle `angle` rad.
fn plan(p: &Parameters, input: &AimInput, approach: &PlannedApproach, angle: f64) -> Stroke {
    let limits = SlideLimits { velocity: p.slide.velocity_max, acceleration: p.slide.acceleration_max };
    let zero = p.probe.at_pusher + input.learned.contact.mean;
    let (line, slow) = match approach.ending {
        Ending::Rest => {
            (input.ring.centered_line(angle) + input.learned.recoil.mean, input.ring.eccentricity() + standoff(input))
        }
        Ending::Blow => (input.ring.line(angle), 0.0),
    };
    Stroke::plan(&input.setpoint, line + zero, slow, &approach.finish, &limits)
}

/// Time until the stroke must start, s; it ends in a sample, so that all strokes are sampled alike.
fn wait_for(p: &Parameters, input: &AimInput, approach: &PlannedApproach, stroke: &Stroke) -> f64 {
    let center = Rotation2::new(input.angle) * input.ring.center();
    let rotation = input.speed.signum() * (approach.meeting.direction() - center.y.atan2(center.x));
    let ahead = stroke.duration() - approach.meeting.time;
    let left = rotation - input.speed.abs() * ahead;
    let wait = ((left + LATE).rem_euclid(TAU) - LATE) / input.speed.abs();
    // one that is late begins now: within a stroke the setpoint would jump
    let samples = ((wait.max(0.0) + stroke.duration()) / p.sample_period).round();
    samples * p.sample_period - stroke.duration()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predictive::assumptions::Assumptions;
    use crate::predictive::press::Goal;
    use crate::sensing::Measurement;
    use control_blocks::wrap;
    use nalgebra::Vector2;

    const P: Parameters = Parameters::START;
    const HORIZON: f64 = 0.015;

    fn ring(center: Vector2<f64>) -> RingModel {
        let assumed = Assumptions { radius: 0.05, noise: 2e-7, center: 5e-3, form: 0.0, gate: 6.0, rejections_max: 5 };
        let mut ring = RingModel::new(assumed);
        ring.displaced(center, 1e-6);
        ring
    }

    /// Angles and plans of all launches of a spindle that turns by `speed` rad/s for a revolution, without their effect.
    fn launches(p: &Parameters, center: Vector2<f64>, speed: f64, tap: Option<f64>) -> Vec<(f64, PlannedStroke)> {
        let (ring, learned) = (ring(center), LearnedParameters::new());
        let setpoint = Trajectory { position: p.park.probe, ..Trajectory::default() };
        let beats = (TAU / (speed.abs() * HORIZON)) as i32;
        let at = |k: i32| 0.4 + speed * HORIZON * f64::from(k);
        let plan = |angle: f64| {
            let input = AimInput {
                ring: &ring,
                learned: &learned,
                angle,
                speed,
                setpoint,
                bandwidth: P.slide.bandwidth,
                horizon: HORIZON,
            };
            aim(p, &input, tap).map(|planned| (angle, planned))
        };
        (0..beats).filter_map(|k| plan(at(k))).collect()
    }

    #[test]
    fn the_ring_is_met_in_the_direction_from_which_the_push_ends_at_the_center() {
        let center = Vector2::new(2e-4, -3e-4);
        for speed in [2.094, -2.094, 4.712] {
            // the first launch of a revolution is on time; a later one of the same chance is late by up to 0.1 rad
            let found = launches(&P, center, speed, None);
            let (angle, planned) = &found[0];
            let e = center.norm();
            let finish = Finish::braked(e, 0.08, 0.04);
            let meeting = Contact { radius: 0.05, speed, lateral: 0.05 }.meeting(e, &finish);
            let touch = planned.angle - speed * meeting.time + center.y.atan2(center.x);
            // a sample, and the change of the line during the motion
            assert!(wrap(touch - meeting.direction()).abs() < 1e-3 * speed.abs(), "{speed}: {touch}");
            assert!((planned.angle - angle - speed.signum() * planned.lead).abs() < 1e-9);
            assert!((planned.velocity - 2.0 * e / 0.08).abs() < 1e-12, "{} m/s", planned.velocity);
            // from the parked probe to the pusher on the line of the centered ring, which is 0
            assert!((planned.distance - (P.probe.at_pusher - P.park.probe)).abs() < 1e-12, "{}", planned.distance);
        }
    }

    #[test]
    fn the_shortest_push_is_through_its_standoff_in_the_time_of_a_creep() {
        let standoff = STANDOFF * LearnedParameters::new().contact.sigma + STANDOFF_MIN;
        let found = launches(&P, Vector2::new(2e-6, 0.0), 2.094, None);
        assert!((found[0].1.velocity - standoff / CREEP_TIME).abs() < 1e-12, "{} m/s", found[0].1.velocity);
    }

    #[test]
    fn a_late_launch_begins_now_and_ends_later() {
        for speed in [2.094, -4.712] {
            let mut found = launches(&P, Vector2::new(2e-4, -3e-4), speed, None);
            let (angle, planned) = found.pop().unwrap();
            assert!(!found.is_empty(), "only one launch");
            assert!((planned.angle - angle - speed.signum() * planned.lead).abs() < 1e-9);
            // no jump but the feed-forward of 2.56 m/s2 to 40 Hz
            let goal = Goal { line: 0.0, contact: P.probe.at_pusher, deflection: 0.0 };
            let mut press = planned.press;
            let first = press.step(&P, &goal, &Measurement::default(), P.park.probe).position - P.park.probe;
            assert!((0.0..6e-5).contains(&first), "{speed}: {first} m");
        }
    }

    #[test]
    fn a_large_push_takes_longer_and_brakes_less_than_friction() {
        let (_, planned) = launches(&P, Vector2::new(4e-3, 0.0), 2.094, None).swap_remove(0);
        // sqrt(2 e / 0.2 m/s2) = 0.2 s, with 40 mm/s at contact
        assert!((planned.velocity - 0.04).abs() < 1e-12, "{}", planned.velocity);
    }

    #[test]
    fn a_tiny_push_is_not_slower_than_the_standoff_allows() {
        let (_, planned) = launches(&P, Vector2::new(3e-6, 0.0), 2.094, None).swap_remove(0);
        // 3 x 30 um and 2 um in 0.15 s
        assert!((planned.velocity - 92e-6 / 0.15).abs() < 1e-12, "{}", planned.velocity);
    }

    #[test]
    fn without_the_plan_of_the_phase_it_is_met_at_its_nearest() {
        let mut p = P;
        p.stroke.phase_plan = false;
        let (_, planned) = launches(&p, Vector2::new(0.0, 1e-4), 2.094, None).swap_remove(0);
        // the contact is 0.08 s before the end
        assert!(wrap(planned.angle + TAU / 4.0 - 2.094 * 0.08).abs() < 4e-3, "{}", planned.angle);
    }

    #[test]
    fn a_tap_goes_with_its_speed_to_where_the_ring_is() {
        let e = 5e-5;
        let (_, planned) = launches(&P, Vector2::new(e, 0.0), 2.094, Some(0.06)).swap_remove(0);
        assert_eq!(planned.velocity, 0.06);
        let direction = 0.05_f64.atan();
        assert!(wrap(planned.angle - direction).abs() < 3e-3, "{}", planned.angle);
        let distance = P.probe.at_pusher - P.park.probe - e * planned.angle.cos();
        assert!((planned.distance - distance).abs() < 1e-9, "{} of {distance}", planned.distance);
    }

    #[test]
    fn a_push_goes_deeper_by_what_was_learned_and_a_tap_by_the_contact() {
        let e = 1e-4;
        let (ring, mut learned) = (ring(Vector2::new(e, 0.0)), LearnedParameters::new());
        (learned.contact.mean, learned.recoil.mean) = (5e-6, 3e-6);
        let setpoint = Trajectory { position: P.park.probe, ..Trajectory::default() };
        let planned = |tap: Option<f64>| {
            let at = |k: i32| {
                let angle = 0.4 + 2.094 * HORIZON * f64::from(k);
                let input = AimInput {
                    ring: &ring,
                    learned: &learned,
                    angle,
                    speed: 2.094,
                    setpoint,
                    bandwidth: P.slide.bandwidth,
                    horizon: HORIZON,
                };
                aim(&P, &input, tap)
            };
            (0..200).find_map(at).unwrap()
        };
        let distance = P.probe.at_pusher - P.park.probe;
        assert!((planned(None).distance - distance - 8e-6).abs() < 1e-12);
        let tap = planned(Some(0.06));
        assert!((tap.distance - distance - 5e-6 + e * tap.angle.cos()).abs() < 1e-9);
    }
}
