//! Frequency response on the machine: the position loop is excited with one sine after the other, and set-point and arm
//! angle are correlated with it over whole periods.
//!
//! Friction biases small motions: its torque does not shrink with them. So every frequency is measured with
//! the amplitude of the cut, as far as torque, acceleration and following error allow. A frequency at which the torque
//! reaches its limit is left out.

use std::f64::consts::TAU;

use control_blocks::ticks;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::identify::glide::{glide, progress};
use crate::identify::tone::{Expected, Tone};
use crate::interface::Parameters;
use crate::servo::response::FrequencyResponse;

/// Time from one frequency to the next, s: long against the closed loop, so that the transition excites little.
const GLIDE_TIME: f64 = 0.05;
/// Time at a frequency before it is measured, s: five times the slowest pole of the closed loop.
const SETTLE_TIME: f64 = 0.1;

/// The experiment: glide to each frequency, settle, average, and glide to rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Identification {
    period: f64,
    tones: Vec<Tone>,
    glide: u32,
    settle: u32,
    /// Present tone; after the last one the arm comes to rest.
    tone: usize,
    /// Samples of this tone so far.
    tick: u32,
    /// Samples of the experiment so far.
    elapsed: u32,
    /// Phase of the sine, turns.
    phase: f64,
    set_point: Complex<f64>,
    angle: Complex<f64>,
    /// The torque has reached its limit in this tone.
    saturated: bool,
    /// Aborted: amplitude (rad) and frequency (periods per sample) from which the oscillation fades.
    fading: Option<(f64, f64)>,
    response: FrequencyResponse,
}

impl Identification {
    /// The experiment before its first sample; `expected` gives the approximate response at a frequency (rad/s).
    pub fn new(p: &Parameters, expected: impl Fn(f64) -> Expected) -> Self {
        let tones = p.identify.grid.iter().map(|omega| Tone::new(p, omega, &expected(omega))).collect();
        Self::of(p, tones, SETTLE_TIME)
    }

    /// The experiment of these tones, each measured after the time `settle` (s).
    pub fn of(p: &Parameters, tones: Vec<Tone>, settle: f64) -> Self {
        Self {
            period: p.sample_period,
            tones,
            glide: ticks(GLIDE_TIME, p.sample_period).max(1),
            settle: ticks(settle, p.sample_period),
            tone: 0,
            tick: 0,
            elapsed: 0,
            phase: 0.0,
            set_point: Complex::ZERO,
            angle: Complex::ZERO,
            saturated: false,
            fading: None,
            response: FrequencyResponse::EMPTY,
        }
    }

    /// The same frequencies, with what is now expected at each (rad/s).
    pub fn expect(&mut self, p: &Parameters, expected: impl Fn(f64) -> Expected) {
        for (tone, omega) in self.tones.iter_mut().zip(p.identify.grid.iter()) {
            *tone = Tone::new(p, omega, &expected(omega));
        }
    }

    /// Begins again.
    pub fn restart(&mut self) {
        (self.tone, self.tick, self.elapsed, self.phase) = (0, 0, 0, 0.0);
        (self.set_point, self.angle, self.saturated) = (Complex::ZERO, Complex::ZERO, false);
        (self.response, self.fading) = (FrequencyResponse::EMPTY, None);
    }

    /// Aborts: the oscillation fades within `GLIDE_TIME`.
    pub fn stop(&mut self) {
        if self.oscillating() && self.fading.is_none() {
            self.fading = Some(self.excitation());
            (self.tone, self.tick) = (self.tones.len(), 0);
        }
    }

    /// Whether the set-point oscillates.
    pub fn oscillating(&self) -> bool {
        self.elapsed > 0 && !self.over()
    }

    /// One sample: takes the arm angle (rad) and gives the set-point (rad), both from the center of the oscillation;
    /// `saturated` says that the last torque was at its limit.
    pub fn step(&mut self, angle: f64, saturated: bool) -> f64 {
        self.saturated |= saturated;
        let (amplitude, frequency) = self.excitation();
        self.phase = (self.phase + frequency).fract();
        let set_point = amplitude * (TAU * self.phase).sin();
        self.average(set_point, angle);
        self.advance();
        set_point
    }

    /// Whether the arm is at rest again and the response complete.
    pub fn done(&self) -> bool {
        self.over() && self.fading.is_none()
    }

    /// Time of the whole experiment, s.
    pub fn duration(&self) -> f64 {
        f64::from(self.ticks()) * self.period
    }

    /// Whether it was aborted and has faded.
    pub fn aborted(&self) -> bool {
        self.over() && self.fading.is_some()
    }

    fn over(&self) -> bool {
        self.tone == self.tones.len() && self.tick >= self.glide
    }

    /// Part of the experiment that is over, 0 to 1.
    pub fn progress(&self) -> f64 {
        (f64::from(self.elapsed) / f64::from(self.ticks())).min(1.0)
    }

    /// The response measured so far.
    pub fn response(&self) -> &FrequencyResponse {
        &self.response
    }

    /// Samples of the whole experiment.
    fn ticks(&self) -> u32 {
        self.tones.iter().map(|tone| self.glide + self.settle + tone.samples).sum::<u32>() + self.glide
    }

    /// Amplitude (rad) and frequency (periods in a sample) now.
    fn excitation(&self) -> (f64, f64) {
        let progress = progress(self.tick, self.glide);
        if let Some((amplitude, frequency)) = self.fading {
            return ((1.0 - progress) * amplitude, frequency);
        }
        glide(progress, self.tone.checked_sub(1).map(|i| &self.tones[i]), self.tones.get(self.tone))
    }

    /// Adds one sample to the sums of the tone, and the tone to the response when its periods are whole.
    fn average(&mut self, set_point: f64, angle: f64) {
        let Some(tone) = self.tones.get(self.tone) else { return };
        let Some(k) = self.tick.checked_sub(self.glide + self.settle) else { return };
        let rotation = tone.rotation(k);
        self.set_point += rotation * set_point;
        self.angle += rotation * angle;
        if k + 1 == tone.samples {
            let omega = TAU * tone.frequency() / self.period;
            if !self.saturated {
                self.response.push(omega, self.angle / self.set_point);
            }
            (self.set_point, self.angle, self.saturated) = (Complex::ZERO, Complex::ZERO, false);
        }
    }

    fn advance(&mut self) {
        self.elapsed = self.elapsed.saturating_add(1);
        self.tick = self.tick.saturating_add(1);
        if self.tones.get(self.tone).is_some_and(|tone| self.tick == self.glide + self.settle + tone.samples) {
            (self.tone, self.tick) = (self.tone + 1, 0);
        }
    }
}

/// Time (s) that the experiment of these parameters takes.
pub fn duration(p: &Parameters) -> f64 {
    let any = Expected { response: Complex::ONE, stiffness: 1.0, hub_over_tool: 1.0 };
    Identification::new(p, |_| any).duration()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// b_k = 1.4 b_(k-1) - 0.53 b_(k-2) + 0.13 r_(k-3): a loop of some 200 Hz with a delay.
    #[derive(Default)]
    struct Loop {
        set_points: [f64; 4],
        angles: [f64; 2],
    }

    impl Loop {
        fn angle(&self) -> f64 {
            1.4 * self.angles[0] - 0.53 * self.angles[1] + 0.13 * self.set_points[2]
        }

        fn step(&mut self, set_point: f64) {
            self.angles = [self.angle(), self.angles[0]];
            self.set_points.rotate_right(1);
            self.set_points[0] = set_point;
        }

        fn response(omega: f64) -> Complex<f64> {
            let back = Complex::from_polar(1.0, -omega * 1e-4);
            0.13 * back.powi(3) / (1.0 - 1.4 * back + 0.53 * back.powi(2))
        }
    }

    /// An experiment that knows what to expect of the loop, with a rigid arm.
    fn experiment(p: &Parameters) -> Identification {
        let stiffness = |omega: f64| p.servo.inertia * omega * omega;
        Identification::new(p, |omega| Expected {
            response: Loop::response(omega),
            stiffness: stiffness(omega),
            hub_over_tool: 1.0,
        })
    }

    fn run(p: &Parameters, disturb: impl Fn(u32, f64) -> f64) -> (Identification, Vec<f64>) {
        let mut identification = experiment(p);
        let (mut plant, mut angles) = (Loop::default(), Vec::new());
        while !identification.done() {
            let angle = disturb(identification.elapsed, plant.angle());
            angles.push(plant.angle());
            let set_point = identification.step(angle, false);
            plant.step(set_point);
        }
        (identification, angles)
    }

    fn largest_error(identification: &Identification) -> f64 {
        let points = identification.response().points().iter();
        points.map(|point| (point.value() / Loop::response(point.frequency) - 1.0).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn a_linear_loop_is_measured_exactly() {
        let p = Parameters::START;
        let (identification, _) = run(&p, |_, angle| angle);
        assert_eq!(identification.response().points().len(), p.identify.grid.iter().count());
        assert!(largest_error(&identification) < 1e-6, "{:e}", largest_error(&identification));
        for (point, omega) in identification.response().points().iter().zip(p.identify.grid.iter()) {
            assert!((point.frequency / omega - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn an_offset_a_harmonic_and_the_quantum_of_the_encoder_do_not_matter() {
        let quantum = TAU / f64::from(1 << 23);
        let (identification, _) = run(&Parameters::START, |_, angle| {
            // friction makes odd harmonics
            let bent = angle - 3e-3 * angle.powi(3);
            ((bent + 0.4) / quantum).round() * quantum
        });
        for (point, tone) in identification.response().points().iter().zip(&identification.tones) {
            let t = Loop::response(point.frequency);
            // few samples a period have the same errors again and again: half a quantum is not averaged
            let maximum = f64::max(1e-3, 0.5 * quantum / (tone.amplitude * t.norm()));
            let error = (point.value() / t - 1.0).norm();
            assert!(error < maximum, "{} Hz: {error:e}, {maximum:e}", point.frequency / TAU);
        }
    }

    #[test]
    fn it_takes_its_calculated_duration_and_ends_at_rest() {
        let p = Parameters::START;
        let (identification, angles) = run(&p, |_, angle| angle);
        assert!((angles.len() as f64 * p.sample_period - duration(&p)).abs() < 1e-9);
        assert_eq!(identification.progress(), 1.0);
        // stages of 0.05 + 0.1 + 0.2 s, and the glide to rest
        assert!((duration(&p) - 32.0 * 0.35 - 0.05).abs() < 1e-9, "{}", duration(&p));
        assert!(angles.last().unwrap().abs() < 1e-3 * p.identify.amplitude / 0.08);
    }

    #[test]
    fn another_loop_has_other_amplitudes_at_the_same_frequencies() {
        let p = Parameters::START;
        let (mut identification, before) = (experiment(&p), experiment(&p));
        identification.expect(&p, |_| Expected {
            response: Complex::new(2.0, 0.0),
            stiffness: 1e3,
            hub_over_tool: 1.0,
        });
        for ((now, before), omega) in identification.tones.iter().zip(&before.tones).zip(p.identify.grid.iter()) {
            assert_eq!((now.periods, now.samples), (before.periods, before.samples));
            let expected = Expected { response: Complex::new(2.0, 0.0), stiffness: 1e3, hub_over_tool: 1.0 };
            assert_eq!(now.amplitude, Tone::new(&p, omega, &expected).amplitude);
        }
    }

    #[test]
    fn amplitude_torque_and_acceleration_keep_their_limits() {
        let mut p = Parameters::START;
        p.limits.following_error = 0.1;
        let (_, angles) = run(&p, |_, angle| angle);
        let largest = angles.iter().fold(0.0, |largest: f64, angle| largest.max(angle.abs()));
        assert!((largest * 0.08 / p.identify.amplitude - 1.0).abs() < 0.02, "{largest}");
        let acceleration = angles.windows(3).map(|b| (b[0] - 2.0 * b[1] + b[2]) / 1e-8);
        let torque = acceleration.fold(0.0, |largest: f64, a| largest.max(a.abs())) * p.servo.inertia;
        let limit = p.identify.torque_ratio * p.servo.torque_max;
        assert!(torque > 0.95 * limit && torque < 1.05 * limit, "{torque}");
    }

    #[test]
    fn the_following_error_stays_below_its_fault() {
        let mut p = Parameters::START;
        p.limits.following_error = 0.4e-3;
        let mut identification = experiment(&p);
        let (mut plant, mut largest) = (Loop::default(), 0.0);
        while !identification.done() {
            let angle = plant.angle();
            let set_point = identification.step(angle, false);
            largest = f64::max(largest, 0.08 * (set_point - angle).abs());
            plant.step(set_point);
        }
        assert!(largest < 0.75 * p.limits.following_error && largest > 0.65 * p.limits.following_error, "{largest}");
    }

    #[test]
    fn frequencies_that_do_not_fit_the_samples_move_a_little() {
        let mut p = Parameters::START;
        p.identify.grid = "17.3, 333.3".parse().unwrap();
        let (identification, _) = run(&p, |_, angle| angle);
        assert!(largest_error(&identification) < 1e-6);
        for (point, omega) in identification.response().points().iter().zip(p.identify.grid.iter()) {
            assert!((point.frequency / omega - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_frequency_with_saturated_torque_is_left_out() {
        let mut p = Parameters::START;
        p.identify.grid = "20, 40, 80".parse().unwrap();
        let (mut identification, mut plant) = (experiment(&p), Loop::default());
        while !identification.done() {
            // once at the second frequency
            let saturated = identification.elapsed == 6000;
            let set_point = identification.step(plant.angle(), saturated);
            plant.step(set_point);
        }
        let measured: Vec<f64> = identification.response().points().iter().map(|point| point.frequency / TAU).collect();
        assert!(measured.len() == 2 && (measured[0] - 20.0).abs() < 1e-9 && (measured[1] - 80.0).abs() < 1e-9);
    }

    #[test]
    fn an_aborted_experiment_fades_within_the_glide_time_and_measures_nothing_more() {
        let p = Parameters::START;
        for after in [1, 100, 700, 3400, 3600, 9000] {
            let (mut identification, mut plant) = (experiment(&p), Loop::default());
            assert!(!identification.oscillating() && !identification.aborted());
            let mut excite = |identification: &mut Identification| {
                let set_point = identification.step(plant.angle(), false);
                plant.step(set_point);
                set_point
            };
            (0..after).for_each(|_| assert!(excite(&mut identification).is_finite()));
            let (measured, maximum) = (identification.response().points().len(), identification.excitation().0);
            identification.stop();
            identification.stop();
            let glide = ticks(GLIDE_TIME, p.sample_period);
            for k in 0..glide {
                assert!(
                    identification.oscillating() && !identification.aborted() && !identification.done(),
                    "{after} {k}"
                );
                // level at its begin, a half in the middle, level at its end
                let progress = f64::from(k + 1) / f64::from(glide);
                let left = maximum * (1.0 - progress * progress * (3.0 - 2.0 * progress));
                assert!(
                    (identification.excitation().0 - left).abs() < 1e-12 && excite(&mut identification).abs() <= left
                );
            }
            assert!(identification.aborted() && !identification.oscillating() && !identification.done());
            assert_eq!((excite(&mut identification), identification.response().points().len()), (0.0, measured));
        }
    }

    #[test]
    fn a_restart_measures_the_same_again() {
        let (mut identification, _) = run(&Parameters::START, |_, angle| angle);
        let first = *identification.response();
        identification.restart();
        assert_eq!(identification.progress(), 0.0);
        let mut plant = Loop::default();
        while !identification.done() {
            let set_point = identification.step(plant.angle(), false);
            plant.step(set_point);
        }
        assert_eq!(identification.response(), &first);
    }
}
