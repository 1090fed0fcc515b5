//! Everything that follows the path: table, approach, feedforward and what it learns, cancellation, statistics.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::ERROR_HARMONICS;
use crate::interface::Parameters;
use crate::path::correction::Correction;
use crate::path::path_table::{PathTable, Row};
use crate::servo::flexure::Flexure;
use crate::servo::loop_model::LoopModel;
use crate::servo::loop_response::LoopResponse;
use crate::servo::response::FrequencyResponse;
use crate::tracking::adaptive::{AdaptiveFeedforward, PathHarmonic};
use crate::tracking::chooser::Chooser;
use crate::tracking::feedforward::HarmonicFeedforward;
use crate::tracking::phasors::Phasors;
use crate::tracking::resonators::{Resonators, gain_in_use};
use crate::tracking::spindle::Spindle;
use crate::tracking::statistics::{ErrorStatistics, RevolutionStatistics};
use crate::tracking::transition::Transition;
use control_blocks::Trajectory;

/// Which layers of the control work in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Pre-shift the path.
    pub feedforward: bool,
    /// Put out what was learned.
    pub cancellation: bool,
    /// Learn.
    pub learning: bool,
}

/// Reference of the arm in a sample, and the set-point that makes it follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Reference motion of the hub.
    pub motion: Trajectory,
    /// Depth of the tool, m.
    pub depth: f64,
    /// Set-point of the position loop, rad.
    pub set_point: f64,
}

/// The path and what keeps the arm on it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tracker {
    path: PathTable,
    response: LoopResponse,
    flexure: Flexure,
    feedforward: HarmonicFeedforward,
    adaptive: AdaptiveFeedforward,
    resonators: Resonators,
    transition: Transition,
    statistics: ErrorStatistics,
    chooser: Chooser,
    /// the path at the present slide position and spindle angle
    row: Row,
    motion: Trajectory,
    /// the harmonic that was tuned last, and the highest
    tuned: usize,
    highest: usize,
}

impl Tracker {
    /// On no path yet.
    pub fn new(p: &Parameters, path: PathTable, response: LoopResponse) -> Self {
        let row = path.row();
        let feedforward = row.angle_harmonics().len();
        let highest = path.harmonics().max(feedforward).max(p.afc.cancelled.highest()).max(ERROR_HARMONICS);
        Self {
            response,
            flexure: Flexure::nominal(p),
            feedforward: HarmonicFeedforward::new(feedforward),
            adaptive: AdaptiveFeedforward::new(p, if p.feedforward_adaptive { feedforward } else { 0 }),
            resonators: Resonators::new(p),
            transition: Transition::default(),
            statistics: ErrorStatistics::default(),
            chooser: Chooser::default(),
            row,
            motion: Trajectory::default(),
            tuned: 0,
            highest,
            path,
        }
    }

    /// Takes the slide position (m) and the spindle of this sample; gives e^(j n theta).
    pub fn locate(&mut self, p: &Parameters, slide_position: f64, spindle: &Spindle) -> Phasors {
        let phasors = Phasors::new(spindle.raw(p), self.highest);
        self.path.interpolate(slide_position, &mut self.row);
        let (depth, speed, arm) = (self.row.depth(phasors.from_zero()), spindle.speed, self.path.arm());
        let angle = arm.angle(depth.value);
        let lever = arm.lever(angle);
        let velocity = speed * depth.first / lever;
        // z'' = R_a cos(phi) b'' - R_a sin(phi) b'^2
        let acceleration = (speed * speed * depth.second + depth.value * velocity * velocity) / lever;
        self.motion = Trajectory { position: angle, velocity, acceleration };
        self.tune(p, spindle.speed);
        phasors
    }

    /// Tunes one harmonic to the present speed, the next one in the next sample.
    fn tune(&mut self, p: &Parameters, speed: f64) {
        self.tuned = self.tuned % self.highest + 1;
        let (n, omega) = (self.tuned, self.tuned as f64 * speed);
        let response = self.response.at(omega);
        let hub_over_tool = if p.tip.compensation { self.flexure.hub_over_tool(omega) } else { Complex::ONE };
        self.feedforward.tune(n, response, hub_over_tool);
        let gain = gain_in_use(p, response, omega, self.cancels(p, n));
        let Some(path) = self.row.angle_harmonics().get(n - 1).copied() else {
            self.resonators.tune(n, gain);
            return;
        };
        let weight = self.adaptive.tune(p, n, &PathHarmonic { omega, path, response, hub_over_tool }, gain);
        self.resonators.tune(n, gain.map(|gain| gain * (1.0 - weight)));
        if !p.feedforward_adaptive {
            self.resonators.carry(n, path);
        }
    }

    /// Whether harmonic `n` is to be canceled.
    fn cancels(&self, p: &Parameters, n: usize) -> bool {
        p.afc.cancelled.contains(n) && (!p.afc.automatic || self.chooser.chosen().contains(n))
    }

    /// On no path: at rest.
    pub fn rest(&mut self) {
        self.transition = Transition::default();
    }

    /// Begins to move onto the path.
    pub fn approach(&mut self, p: &Parameters) {
        self.transition.approach(p);
        self.statistics = ErrorStatistics::default();
    }

    /// Begins to move off the path, within `duration` (s).
    pub fn leave(&mut self, p: &Parameters, duration: f64) {
        self.transition.leave(p, duration);
    }

    /// Advances the transition by one sample, learns from the error at `arm_angle` (rad), and returns the target. The
    /// transition is between the path and `held`, the motion off the path.
    pub fn follow(
        &mut self,
        p: &Parameters,
        held: Trajectory,
        arm_angle: f64,
        layers: Layers,
        phasors: &Phasors,
    ) -> Target {
        let blend = self.transition.step(p);
        let mut motion = blend.motion(held, self.motion);
        let depth = self.path.arm().depth(motion.position);
        let shift = self.feedforward.shift(self.row.angle_harmonics(), phasors.from_one());
        let straight = motion.position;
        motion.position += blend.weight * shift.target;
        if layers.learning {
            let error = motion.position - arm_angle;
            self.resonators.learn(error, phasors.from_one());
            self.adaptive.learn(error, phasors.from_one());
        }
        let mut added = if layers.feedforward { shift.set_point } else { shift.target };
        if layers.cancellation {
            added += self.resonators.output(phasors.from_one());
            added += self.adaptive.output(self.row.angle_harmonics(), phasors.from_one());
        }
        let set_point = straight + blend.weight * added;
        Target { motion, depth, set_point }
    }

    /// Adds the error (m) of this sample to the statistics.
    pub fn evaluate(&mut self, error: f64, spindle: &Spindle, phasors: &Phasors) {
        if let Some(harmonics) = self.statistics.add(error, spindle.angle, phasors.from_one()) {
            self.chooser.add(&harmonics);
        }
    }

    /// Discards what cancellation and feedforward have learned.
    pub fn forget(&mut self) {
        self.resonators.clear();
        self.adaptive.clear();
        self.chooser = Chooser::default();
    }

    /// Whether the path is reached.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.transition.arrived(p)
    }

    /// Whether nothing of the path is left in the motion.
    pub fn gone(&self, p: &Parameters) -> bool {
        self.transition.gone(p)
    }

    /// A depth (m) that the path at the present slide position never goes below.
    pub fn lowest(&self) -> f64 {
        self.row.lowest()
    }

    /// The path.
    pub fn path(&self) -> &PathTable {
        &self.path
    }

    /// Corrects the path.
    pub fn correct(&mut self, correction: Option<Correction>) {
        self.path.correct(correction);
    }

    /// Takes a measured response of the position loop, and the flexure that it identifies.
    pub fn take(&mut self, p: &Parameters, measured: &FrequencyResponse) {
        self.response.correct(measured);
        self.flexure = Flexure::found(p, self.response.model(), measured).unwrap_or(self.flexure);
    }

    /// The loop is another: nothing of what was measured and learned of the one before counts.
    pub fn renew(&mut self, p: &Parameters, model: LoopModel) {
        self.response = LoopResponse::nominal(model);
        self.flexure = Flexure::nominal(p);
        self.forget();
    }

    /// The response of the position loop that is inverted.
    pub fn response(&self) -> &LoopResponse {
        &self.response
    }

    /// The flexure that is compensated.
    pub fn flexure(&self) -> Flexure {
        self.flexure
    }

    /// Torque that the path takes over that which the response in use says.
    pub fn torque_ratio(&self) -> f64 {
        self.adaptive.torque_ratio()
    }

    /// The error over the last full turn.
    pub fn last_revolution(&self) -> &RevolutionStatistics {
        self.statistics.last()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::depth_table::DepthTable;
    use crate::path::kinematics::Arm;
    use crate::servo::design::design;

    /// A tracker of a lens with `harmonics`.
    fn tracker(harmonics: i32) -> (Parameters, Tracker) {
        let mut p = Parameters::START;
        (p.path.harmonics, p.path.grid) = (harmonics, 2e-3);
        (p.surface.base_curvature, p.surface.tilt_x) = (3.0, 0.05);
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 0);
        let response = LoopResponse::nominal(LoopModel::new(&p, design(&p).unwrap()));
        let tracker = Tracker::new(&p, path, response);
        (p, tracker)
    }

    /// Locates 25 mm from the axis, with the spindle at `angle` (rad) and 100 rad/s.
    fn locate(p: &Parameters, tracker: &mut Tracker, angle: f64) -> Phasors {
        let mut spindle = Spindle::default();
        spindle.update(p, angle - 100.0 * p.sample_period, false);
        spindle.update(p, angle, false);
        tracker.locate(p, 0.025, &spindle)
    }

    #[test]
    fn velocity_and_acceleration_are_the_derivatives_of_the_angle() {
        let (step, (p, mut tracker)) = (1e-4, tracker(24));
        for k in 0..12 {
            let angle = 0.55 * f64::from(k);
            let [before, here, after] = [angle - step, angle, angle + step].map(|angle| {
                locate(&p, &mut tracker, angle);
                tracker.motion
            });
            let time = 2.0 * step / 100.0;
            let velocity = (after.position - before.position) / time;
            let acceleration = (after.velocity - before.velocity) / time;
            assert!((here.velocity - velocity).abs() < 1e-4, "{here:?} {velocity}");
            assert!((here.acceleration - acceleration).abs() < 1e-2, "{here:?} {acceleration}");
        }
    }

    #[test]
    fn only_harmonics_of_the_list_are_cancelled_and_of_these_only_the_chosen_where_it_chooses() {
        let (mut p, tracker) = tracker(24);
        let cancelled = |p: &Parameters| (1..40).filter(|n| tracker.cancels(p, *n)).collect::<Vec<_>>();
        p.afc.automatic = false;
        let listed: Vec<usize> = p.afc.cancelled.iter().collect();
        assert!(!listed.is_empty() && listed.len() < 39);
        assert_eq!(cancelled(&p), listed);
        // nothing has been chosen yet
        p.afc.automatic = true;
        assert!(cancelled(&p).is_empty());
    }

    #[test]
    fn all_harmonics_of_the_path_are_followed() {
        let (p, mut tracker) = tracker(40);
        let phasors = locate(&p, &mut tracker, 0.7);
        assert!(phasors.from_one().len() >= 40);
        assert_eq!(tracker.row.depth(phasors.from_zero()), tracker.row.depth(Phasors::new(0.7, 60).from_zero()));
    }

    #[test]
    fn each_harmonic_learns_what_its_own_path_leaves_to_it() {
        let (mut p, tracker) = tracker(24);
        p.afc.automatic = false;
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        let mut tracker = Tracker::new(&p, path, tracker.response);
        (0..2 * tracker.highest).for_each(|_| {
            locate(&p, &mut tracker, 0.7);
        });
        let phasor = Phasors::new(0.7, 24).from_one()[1];
        let only = [Complex::ZERO, phasor];
        let omega = 2.0 * 100.0;
        let [response, hub_over_tool] = [tracker.response.at(omega), tracker.flexure.hub_over_tool(omega)];
        let gain = gain_in_use(&p, response, omega, true);
        let learned = |path: Complex<f64>| {
            let harmonic = PathHarmonic { omega, path, response, hub_over_tool };
            let weight = AdaptiveFeedforward::new(&p, 24).tune(&p, 2, &harmonic, gain);
            let mut alone = Resonators::new(&p);
            alone.tune(2, gain.map(|gain| gain * (1.0 - weight)));
            alone.learn(1e-6, &only);
            alone.output(&only)
        };
        let path = tracker.row.angle_harmonics();
        let [own, other] = [path[1], path[2]].map(learned);
        tracker.resonators.learn(1e-6, &only);
        let found = tracker.resonators.output(&only);
        assert!((found / own - 1.0).abs() < 1e-6 && (other / own - 1.0).abs() > 0.05, "{found} {own} {other}");
    }
}
