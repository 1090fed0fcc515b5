//! The slide during a push: follows its stroke, compensates friction, and stops when the surface is at its target.

use control_blocks::{SentCommands, Trajectory};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::predictive::stroke::Stroke;
use crate::sensing::{LAG, Measurement};

/// Gap below which there is contact, m.
const CONTACT_GAP: f64 = 5e-7;
/// Extension of the probe at the end of the stroke above which the ring has left the pusher, m.
const APART: f64 = 1e-5;
/// Largest error of the surface that is fed back, m.
const ERROR_MAX: f64 = 5e-5;
/// Limits of the feedback on the setpoint, m.
const CORRECTION: [f64; 2] = [-5e-5, 2e-3];
/// Error of the surface at which a push has arrived, m.
const ARRIVED: f64 = 1e-7;
/// Time after contact in which the expected deflection is fed forward, s.
const PRELOAD_TIME: f64 = 0.02;
/// Time constant with which the deflection is measured, s.
const SMOOTHING: f64 = 0.01;

/// End of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ending {
    /// At rest, with the surface at its target.
    Rest,
    /// With an impact; the slide rebounds.
    Blow,
}

/// Target of the surface for the angle of this sample, and the expected values before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Tip position, m.
    pub line: f64,
    /// Probe position at contact, m.
    pub contact: f64,
    /// Deflection of the servo, m.
    pub deflection: f64,
}

/// The active stroke.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Press {
    stroke: Stroke,
    ending: Ending,
    /// contact before the end, s
    contact: f64,
    /// of the servo, rad/s
    bandwidth: f64,
    /// time of this sample from the start of the stroke, s
    time: f64,
    correction: f64,
    /// preload and correction of the last setpoint, m
    ahead: f64,
    /// setpoints in transit, minus the feed-forward of acceleration, m; the newest first
    sent: SentCommands,
    deflection: f64,
    /// largest deflection and probe position since contact, m
    maximum: [f64; 2],
    first: Option<f64>,
    last: Measurement,
    arrived: bool,
}

impl Press {
    /// A stroke that starts in `wait` s and touches the ring `contact` s before its end, of a slide whose servo has the
    /// `bandwidth` rad/s.
    pub fn new(stroke: Stroke, ending: Ending, contact: f64, wait: f64, bandwidth: f64) -> Self {
        let start = stroke.at(-wait).position;
        Self {
            stroke,
            ending,
            contact,
            bandwidth,
            time: -wait,
            correction: 0.0,
            ahead: 0.0,
            sent: SentCommands::resting(start),
            deflection: 0.0,
            maximum: [0.0; 2],
            first: None,
            last: Measurement::default(),
            arrived: false,
        }
    }

    /// Setpoint of this sample, from the despiked surface; the slide as it is now (m).
    pub fn step(&mut self, p: &Parameters, goal: &Goal, seen: &Measurement, slide: f64) -> Trajectory {
        let (dt, delay) = (p.sample_period, p.io_delay as usize);
        self.last = *seen;
        let touching = self.time > self.stroke.duration() - self.contact;
        if self.ending == Ending::Rest && touching {
            self.first.get_or_insert(seen.tip);
            self.feed_back(p, goal, seen);
            self.measure(dt, slide, delay, seen);
        }
        let setpoint = self.setpoint(goal, self.time + delay as f64 * dt);
        self.time += dt;
        setpoint
    }

    /// Whether the stroke is over.
    pub fn over(&self, p: &Parameters) -> bool {
        let late = self.time - self.stroke.duration();
        let longest = if self.ending == Ending::Rest { p.stroke.hold } else { LAG * p.sample_period };
        late >= longest || (late >= 0.0 && self.arrived)
    }

    /// Distance of the setpoint beyond the stroke, to compensate the force of the ring, m.
    pub fn ahead(&self) -> f64 {
        self.ahead
    }

    /// The sample with which it ended.
    pub fn last(&self) -> Measurement {
        self.last
    }

    /// Deflection (m) while the ring was pushed, and the probe position (m) if it is still at the pusher; nothing if the
    /// ring has moved by less than `distance` m.
    pub fn sensed(&self, distance: f64) -> Option<(f64, Option<f64>)> {
        let ([deflection, deepest], probe) = (self.maximum, self.last.probe());
        let pushed = self.first.is_some_and(|first| self.last.tip - first >= distance);
        pushed.then_some((deflection, (deepest - probe < APART).then_some(probe)))
    }

    /// Integrates the error of the surface; before contact only forwards.
    fn feed_back(&mut self, p: &Parameters, goal: &Goal, seen: &Measurement) {
        let lag = LAG * p.sample_period;
        let left = self.stroke.end() - self.stroke.at(self.time - lag).position;
        let error = goal.line - left - seen.tip;
        self.arrived = error < ARRIVED;
        let apart = goal.contact - seen.probe() > CONTACT_GAP;
        let error = error.clamp(if apart { 0.0 } else { -ERROR_MAX }, ERROR_MAX);
        let [low, high] = CORRECTION;
        self.correction = (self.correction + p.stroke.feedback * error * p.sample_period).clamp(low, high);
    }

    /// Updates deflection and probe.
    fn measure(&mut self, dt: f64, slide: f64, delay: usize, seen: &Measurement) {
        let deflection = self.sent.before(delay) - slide;
        self.deflection += dt / SMOOTHING * (deflection - self.deflection);
        self.maximum = [self.maximum[0].max(self.deflection), self.maximum[1].max(seen.probe())];
    }

    fn setpoint(&mut self, goal: &Goal, time: f64) -> Trajectory {
        let reference = self.stroke.at(time);
        let since = time - (self.stroke.duration() - self.contact);
        let preload = match self.ending {
            Ending::Rest => goal.deflection * (since / PRELOAD_TIME).clamp(0.0, 1.0),
            Ending::Blow => 0.0,
        };
        self.ahead = preload + self.correction;
        let position = reference.position + preload + self.correction;
        self.sent.send(position);
        Trajectory { position: position + feed_forward(self.bandwidth, reference.acceleration), ..reference }
    }
}

/// Feed-forward of a position-velocity servo for an acceleration, m.
fn feed_forward(bandwidth: f64, acceleration: f64) -> f64 {
    if bandwidth > 0.0 { acceleration / bandwidth.powi(2) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predictive::stroke::{Finish, SlideLimits};

    const P: Parameters = Parameters::START;
    const CONTACT: f64 = 0.08;
    const GOAL: Goal = Goal { line: 0.1, contact: 0.02, deflection: 0.0 };
    /// Position of the end of the stroke, m: the line of the target with the probe at the pusher.
    const END: f64 = 0.12;

    fn stroke() -> Stroke {
        let begin = Trajectory { position: 0.104, ..Trajectory::default() };
        let finish = Finish::braked(5e-4, CONTACT, 0.04);
        Stroke::plan(&begin, END, 5e-4, &finish, &SlideLimits { velocity: 0.12, acceleration: 2.56 })
    }

    /// Steps from the contact on with the surface `error` m before its position in the plan and the probe at `probe` m;
    /// setpoint minus stroke and feed-forward after each sample.
    fn added(goal: &Goal, samples: u32, error: f64, probe: f64) -> (Press, Vec<f64>) {
        let stroke = stroke();
        let wait = -(stroke.duration() - CONTACT) - 1e-6;
        let mut press = Press::new(stroke.clone(), Ending::Rest, CONTACT, wait, P.slide.bandwidth);
        let added = (0..samples).map(|_| {
            let time = press.time;
            let left = END - stroke.at(time - LAG * P.sample_period).position;
            let tip = goal.line - left - error;
            let setpoint = press.step(&P, goal, &Measurement { angle: 0.0, slide: tip + probe, tip }, tip + probe);
            let plan = stroke.at(time + P.sample_period);
            setpoint.position - plan.position - feed_forward(P.slide.bandwidth, plan.acceleration)
        });
        let added = added.collect();
        (press, added)
    }

    #[test]
    fn how_far_the_setpoint_is_beyond_the_stroke_is_reported_with_preload_and_correction() {
        let goal = Goal { deflection: 4e-5, ..GOAL };
        let (press, added) = added(&goal, 60, 2e-5, goal.contact);
        let last = added[added.len() - 1];
        // all of the preload, and 60 1/s of 20 um for 60 ms
        assert!((last - 4e-5 - 7.2e-5).abs() < 2e-6 && (press.ahead() - last).abs() < 1e-12, "{last} m");
    }

    #[test]
    fn a_blow_is_the_predicted_stroke() {
        let stroke = stroke();
        let mut press = Press::new(stroke.clone(), Ending::Blow, 0.0, 0.003, P.slide.bandwidth);
        for k in 0..300 {
            let setpoint = press.step(&P, &GOAL, &Measurement::default(), 0.1);
            // a wait of 3 samples, and a delay of one
            let plan = stroke.at(1e-3 * (f64::from(k) - 2.0));
            let ahead = plan.acceleration / P.slide.bandwidth.powi(2);
            assert!((setpoint.position - plan.position - ahead).abs() < 1e-12, "{k}");
            assert!((setpoint.velocity - plan.velocity).abs() < 1e-12);
            let late = 1e-3 * (f64::from(k) - 2.0) - stroke.duration();
            assert_eq!(press.over(&P), late >= 2e-3 - 1e-12, "{k}");
        }
    }

    #[test]
    fn the_error_of_the_surface_is_integrated_within_its_limits() {
        // 60 1/s x 10 um x 1 ms each sample
        let (_, forwards) = added(&GOAL, 20, 1e-5, 0.02);
        for (k, added) in forwards.iter().enumerate() {
            assert!((added - 6e-7 * (k + 1) as f64).abs() < 1e-12, "{k}: {added}");
        }
        let (_, back) = added(&GOAL, 20, -1e-5, 0.02);
        assert!((back[19] + 1.2e-5).abs() < 1e-12, "{}", back[19]);
        // beyond 50 um no faster, and not further back than 50 um
        let (_, fast) = added(&GOAL, 10, 2e-4, 0.02);
        assert!((fast[9] - 3e-5).abs() < 1e-12, "{}", fast[9]);
        let (_, far) = added(&GOAL, 80, -2e-4, 0.02);
        assert!((far[79] + 5e-5).abs() < 1e-12, "{}", far[79]);
    }

    #[test]
    fn before_the_pusher_touches_nothing_is_taken_back() {
        let (_, apart) = added(&GOAL, 20, -1e-5, 0.02 - 1e-6);
        assert!(apart.iter().all(|added| added.abs() < 1e-12));
        let (_, forwards) = added(&GOAL, 20, 1e-5, 0.02 - 1e-6);
        assert!((forwards[19] - 1.2e-5).abs() < 1e-12);
    }

    #[test]
    fn the_deflection_is_given_within_20_ms_and_counts_as_ahead() {
        let goal = Goal { deflection: 1e-4, ..GOAL };
        let (press, added) = added(&goal, 40, 0.0, 0.02);
        // one sample of delay
        assert!((added[9] - 5e-5).abs() < 1e-8 && (added[30] - 1e-4).abs() < 1e-12, "{added:?}");
        assert!((press.ahead() - 1e-4).abs() < 1e-12);
    }

    #[test]
    fn a_push_ends_when_the_surface_arrives_and_not_later_than_its_hold() {
        let ends = |error: f64| {
            let (mut samples, mut over) = (0, false);
            while !over {
                samples += 1;
                over = added(&GOAL, samples, error, 0.02).0.over(&P);
            }
            samples
        };
        assert_eq!((ends(0.0), ends(2e-7)), (80, 120));
    }

    #[test]
    fn a_sensed_push_gives_the_deflection_and_the_probe_position() {
        let (press, _) = added(&GOAL, 70, 0.0, 0.02);
        let (deflection, probe) = press.sensed(1e-4).unwrap();
        // surface and pusher determine the slide position, two samples after the plan; the filter has 10 ms
        assert!(deflection > 0.0 && deflection < 5e-5, "{deflection}");
        assert_eq!(probe, Some(press.last().probe()));
        assert!(press.sensed(6e-4).is_none());
        // a ring that has left the pusher does not determine the contact
        let mut gone = press.clone();
        gone.last = Measurement { tip: gone.last.tip, slide: gone.last.slide - 1.1e-5, ..gone.last };
        assert_eq!(gone.sensed(1e-4).unwrap().1, None);
    }
}
