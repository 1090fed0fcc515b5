//! Delay of the axes in samples: the one that explains their accelerations, compared with `io_delay`.
//!
//! For each delay d the changes of the commanded motion m_d, late by d samples and by the lag 2 zeta/wn of the drive,
//! are compared with the changes of the measured motion a, both smoothed alike. The noise of the measurement, whose
//! second differences are fast, almost vanishes; a motion that arrives a sample later remains. The residual of the best
//! factor is J_d = sum a^2 - (sum a m_d)^2 / sum m_d^2, so that the gain of the drive has no effect. Noise of the
//! measurement is in every J_d, and a little more in those of long delays, because the servo responds to it: a tenth at
//! Kp T = 0.13. A delay is therefore accepted only if its residual is below 0.8 of that of `io_delay`. Between the
//! samples J_d is a parabola. Its vertex is the delay plus the difference of the lag from the nominal one, which is no
//! delay of a sample: it must be farther from `io_delay` than 0.75.

use control_blocks::SentCommands;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::learning::drive::NominalDrive;
use crate::monitoring::finding::{Finding, Numbers};
use crate::path::kinematics::{AXES, Joints};

/// Delays that are compared: 0 to 6 samples, as far back as commands are kept.
const DELAYS: usize = 7;
/// Ratio to the residual of `io_delay` below which the residual of another delay shows that it is the right one.
const CLEAR: f64 = 0.8;
/// Largest residual of the delay of a single axis, over the sum of its squared changes; an axis at rest moves only by
/// the response of its servo to noise.
const MOVED: f64 = 0.25;
/// Largest factor of measured over commanded motion: no drive has a higher one. The servo responds to a measurement
/// that flickers by the ratio Kp T, so that such a measurement would be 1/(Kp T) times the commanded motion.
const FACTOR_MAX: f64 = 2.5;
/// Weight of the previous value in the exponential smoothing of the changes, per sample.
const SMOOTHED: f64 = 0.85;
/// Smallest difference of the vertex from `io_delay` that is another delay, samples.
const ANOTHER: f64 = 0.75;

/// Sums over one run, of one axis or of all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Sums {
    answer: f64,
    product: [f64; DELAYS],
    square: [f64; DELAYS],
}

/// Changes of one axis in a sample: measured, and commanded with each delay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Changes {
    answer: f64,
    modelled: [f64; DELAYS],
}

/// Watches the axes, each alone and all together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DelayMonitor {
    /// lag of each drive, in samples, at most one
    lag: Joints,
    axis: [Sums; AXES],
    smoothed: [Changes; AXES],
    before: Option<Joints>,
    motion: Option<Joints>,
}

impl DelayMonitor {
    /// Before a run.
    pub fn new(p: &Parameters) -> Self {
        let lag = |axis: usize| {
            let NominalDrive { damping, frequency, period, .. } = NominalDrive::new(p, axis);
            (2.0 * damping / (frequency * period)).min(1.0)
        };
        Self {
            lag: std::array::from_fn(lag),
            axis: [Sums::default(); AXES],
            smoothed: [Changes::default(); AXES],
            before: None,
            motion: None,
        }
    }

    /// Takes the positions (rad or m) of a sample, and what was sent before it.
    pub fn update(&mut self, p: &Parameters, positions: &Joints, sent: &[SentCommands; AXES]) {
        let motion = self.before.map(|before| std::array::from_fn(|i| positions[i] - before[i]));
        if let (Some(now), Some(last)) = (motion, self.motion) {
            (0..AXES).for_each(|i| self.compare(p, i, now[i] - last[i], &sent[i]));
        }
        (self.before, self.motion) = (Some(*positions), motion);
    }

    fn compare(&mut self, p: &Parameters, axis: usize, change: f64, sent: &SentCommands) {
        // all axes in what they move the tip by
        let scale = p.limits.axis[axis].error_max.recip();
        let lag = self.lag[axis];
        let change_sent = |late: usize| (sent.before(late) - sent.before(late + 1)) * (p.sample_period * scale);
        let commanded: [f64; DELAYS + 1] = std::array::from_fn(change_sent);
        let modelled = std::array::from_fn(|d| (1.0 - lag) * commanded[d] + lag * commanded[d + 1]);
        let smoothed = &mut self.smoothed[axis];
        smoothed.follow(&Changes { answer: change * scale, modelled });
        self.axis[axis].take(smoothed);
    }

    /// `WrongDelay` if another delay than `io_delay` explains the motion of the run or lap so far: its samples, and the
    /// number of the axis or 0 for all. None otherwise, and for an `io_delay` above 6.
    pub fn found(&self, p: &Parameters) -> Finding {
        let configured = p.io_delay as usize;
        if configured >= DELAYS {
            return Finding::NONE;
        }
        let alone = |i: usize| {
            self.axis[i].another(configured).filter(|delay| self.axis[i].left(*delay) < MOVED * self.axis[i].answer)
        };
        let one = || (0..AXES).find_map(|i| alone(i).map(|delay| (i + 1, delay)));
        let all = self.axis.iter().fold(Sums::default(), Sums::with);
        match all.another(configured).map(|delay| (0, delay)).or_else(one) {
            None => Finding::NONE,
            Some((axis, delay)) => {
                let numbers = Numbers { axis: axis as i32, value: delay as f64, limit: configured as f64, ratio: None };
                Finding { fault: Fault::WrongDelay, numbers }
            }
        }
    }
}

impl Changes {
    /// Smooths what comes.
    fn follow(&mut self, now: &Self) {
        let smooth = |old: &mut f64, new: f64| *old += (1.0 - SMOOTHED) * (new - *old);
        smooth(&mut self.answer, now.answer);
        self.modelled.iter_mut().zip(now.modelled).for_each(|(old, new)| smooth(old, new));
    }
}

impl Sums {
    /// Takes a sample.
    fn take(&mut self, changes: &Changes) {
        self.answer += changes.answer * changes.answer;
        for (d, modelled) in changes.modelled.iter().enumerate() {
            self.product[d] += changes.answer * modelled;
            self.square[d] += modelled * modelled;
        }
    }

    /// Of both.
    fn with(self, other: &Self) -> Self {
        let add = |a: &[f64; DELAYS], b: &[f64; DELAYS]| std::array::from_fn(|d| a[d] + b[d]);
        Self {
            answer: self.answer + other.answer,
            product: add(&self.product, &other.product),
            square: add(&self.square, &other.square),
        }
    }

    /// Residual J_d: the part of the squared measured changes that the delay does not explain with its best factor.
    fn left(&self, delay: usize) -> f64 {
        let (product, square) = (self.product[delay], self.square[delay]);
        let factor = (product / square.max(f64::MIN_POSITIVE)).clamp(0.0, FACTOR_MAX);
        self.answer - factor * (2.0 * product - factor * square)
    }

    /// The delay, between two samples, that leaves the smallest; `best` is the whole one.
    fn vertex(&self, best: usize) -> f64 {
        let middle = best.clamp(1, DELAYS - 2);
        let [before, here, after] = [middle - 1, middle, middle + 1].map(|delay| self.left(delay));
        let bend = before - 2.0 * here + after;
        if bend > 0.0 { middle as f64 + 0.5 * (before - after) / bend } else { best as f64 }
    }

    /// The delay that explains the motion, if it is another one than was configured.
    fn another(&self, configured: usize) -> Option<usize> {
        let best = (0..DELAYS).fold(configured, |best, d| if self.left(d) < self.left(best) { d } else { best });
        let off = (self.vertex(best) - configured as f64).abs();
        (best != configured && self.left(best) < CLEAR * self.left(configured) && off > ANOTHER).then_some(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Finding for one axis that follows the command of `delay` samples before with a gain, while its measurement
    /// oscillates by `noise` counts; the other axes are at rest.
    fn found(io_delay: i32, delay: usize, gain: f64, noise: f64) -> Finding {
        let mut p = Parameters::START;
        p.io_delay = io_delay;
        let (mut monitor, mut sent) = (DelayMonitor::new(&p), [SentCommands::default(); AXES]);
        let mut position = 0.5;
        for k in 0..400 {
            // back and forth with ramps of 0.5 m/s2
            let speed = (0.005 * f64::from(k % 80) - 0.05).clamp(0.0, 0.1) * if k % 160 < 80 { 1.0 } else { -1.0 };
            position += gain * p.sample_period * (0.63 * sent[2].before(delay) + 0.37 * sent[2].before(delay + 1));
            let measured = position + noise * 5e-6 * (f64::from(k) * 2.3).sin();
            let mut positions = [0.0; AXES];
            positions[2] = (measured / 5e-6).round() * 5e-6;
            monitor.update(&p, &positions, &sent);
            sent[2].send(speed);
        }
        monitor.found(&p)
    }

    #[test]
    fn the_delay_that_was_configured_is_good_whatever_gain_and_noise_are() {
        for delay in 0..5 {
            for (gain, noise) in [(1.0, 0.0), (0.7, 0.0), (1.3, 2.0), (1.0, 20.0), (1.0, 200.0)] {
                assert_eq!(found(delay, delay as usize, gain, noise), Finding::NONE, "{delay} {gain} {noise}");
            }
        }
    }

    #[test]
    fn a_delay_of_one_sample_more_or_less_is_found_under_noise_of_counts() {
        for (configured, true_delay) in [(1, 0), (1, 2), (0, 1), (2, 1), (3, 4)] {
            let found = found(configured, true_delay, 1.0, 12.0);
            assert_eq!(
                (found.fault, found.numbers.value),
                (Fault::WrongDelay, true_delay as f64),
                "{configured} {true_delay}"
            );
        }
    }

    #[test]
    fn a_reading_that_flickers_on_an_axis_at_rest_shows_no_delay() {
        for io_delay in 0..4 {
            for step in 2..9 {
                let mut p = Parameters::START;
                p.io_delay = io_delay;
                let (mut monitor, mut sent) = (DelayMonitor::new(&p), [SentCommands::default(); AXES]);
                for k in 0..400 {
                    // a count more in one sample of some, to which the servo answers
                    let count = if k % step == 0 { 2.5e-6 } else { 0.0 };
                    let mut positions = [0.0; AXES];
                    positions[1] = count;
                    monitor.update(&p, &positions, &sent);
                    sent[1].send(-13.0 * count);
                }
                assert_eq!(monitor.found(&p), Finding::NONE, "{io_delay} {step}");
            }
        }
    }

    /// Finding for one axis that follows its command after `delay` samples, which need not be whole.
    fn found_between(io_delay: i32, delay: f64) -> Finding {
        let mut p = Parameters::START;
        p.io_delay = io_delay;
        let (mut monitor, mut sent) = (DelayMonitor::new(&p), [SentCommands::default(); AXES]);
        let (mut position, mut command, whole) = (0.5, 0.0, delay.floor() as usize);
        let fraction = delay - delay.floor() + 0.37;
        for k in 0..400 {
            let speed = (0.005 * f64::from(k % 80) - 0.05).clamp(0.0, 0.1) * if k % 160 < 80 { 1.0 } else { -1.0 };
            // a drive that is slower than a sample spreads over three
            let (late, later) = if fraction < 1.0 { (fraction, 0.0) } else { (2.0 - fraction, fraction - 1.0) };
            let first = 1.0 - late - later;
            let commands = [0, 1, 2].map(|d| sent[2].before(whole + d));
            position += p.sample_period * (first * commands[0] + late * commands[1] + later * commands[2]);
            let mut positions = [0.0; AXES];
            positions[2] = (position / 5e-6).round() * 5e-6;
            monitor.update(&p, &positions, &sent);
            // as the servo follows a ramp
            command += 0.13 * (speed - command);
            sent[2].send(command);
        }
        monitor.found(&p)
    }

    #[test]
    fn what_the_lag_of_a_drive_differs_is_no_delay() {
        for off in [-0.62, -0.4, 0.0, 0.4, 0.62] {
            assert_eq!(found_between(1, 1.0 + off), Finding::NONE, "{off}");
        }
        for (configured, delay, named) in [(1, 2.0, 2.0), (1, 1.85, 2.0), (1, 2.3, 2.0), (1, 0.0, 0.0), (2, 0.9, 1.0)] {
            assert_eq!(
                found_between(configured, delay),
                Finding::beyond(Fault::WrongDelay, named, f64::from(configured)),
                "{delay}"
            );
        }
    }

    #[test]
    fn an_axis_that_is_late_alone_is_reported_and_one_at_rest_is_not() {
        let (p, mut noise) = (Parameters::START, 0.0);
        let (mut monitor, mut sent) = (DelayMonitor::new(&p), [SentCommands::default(); AXES]);
        let mut actual = [0.0, 0.2, 0.5];
        for k in 0..400 {
            let speed = (0.005 * f64::from(k % 80) - 0.05).clamp(0.0, 0.1) * if k % 160 < 80 { 1.0 } else { -1.0 };
            // the third is late; the first hardly moves, and its servo answers to the noise of its measurement
            for (i, delay) in [(1, 1), (2, 2)] {
                actual[i] += p.sample_period * (0.63 * sent[i].before(delay) + 0.37 * sent[i].before(delay + 1));
            }
            let last = noise;
            noise = 1e-4 * (f64::from(k * k) * 2.3).sin();
            let mut positions = [0.0; AXES];
            (positions[0], positions[1], positions[2]) = (noise, actual[1], actual[2]);
            monitor.update(&p, &positions, &sent);
            for (axis, command) in sent.iter_mut().zip([-4.0 * (noise - 0.1 * last), speed, 0.1 * speed]) {
                axis.send(command);
            }
            (3..AXES).for_each(|i| sent[i].send(0.0));
        }
        let numbers = Numbers { axis: 3, value: 2.0, limit: 1.0, ratio: None };
        assert_eq!(monitor.found(&p), Finding { fault: Fault::WrongDelay, numbers });
    }

    #[test]
    fn an_axis_alone_is_reported_where_its_delay_leaves_less_than_a_quarter_of_it() {
        let found = |explained: f64| {
            let mut monitor = DelayMonitor::new(&Parameters::START);
            // all together have the configured delay, compensated by another axis
            (monitor.axis[1].answer, monitor.axis[1].product[1], monitor.axis[1].square[1]) = (100.0, 100.0, 100.0);
            let axis = &mut monitor.axis[4];
            (axis.answer, axis.square[1], axis.product[3], axis.square[3]) = (1.0, 1.0, explained, explained);
            monitor.found(&Parameters::START).numbers.axis
        };
        assert_eq!([0.75, 0.75 + 1e-9].map(found), [0, 5]);
    }

    #[test]
    fn another_delay_is_reported_with_its_number() {
        for (configured, delay) in [(0, 1), (1, 0), (1, 2), (1, 4), (3, 1)] {
            for gain in [0.8, 1.0, 1.2] {
                let finding = found(configured, delay, gain, 0.3);
                assert_eq!(
                    finding,
                    Finding::beyond(Fault::WrongDelay, delay as f64, f64::from(configured)),
                    "{configured} {delay}"
                );
            }
        }
    }
}
