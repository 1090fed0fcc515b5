//! Fig. 2: a pattern between two learned ones is the one that would have been learned.

use std::f64::consts::PI;

use fmu_deburr::interface::Parameters;
use fmu_deburr::learning::learner::Learner;
use fmu_deburr::learning::lookup::PatternLookup;
use fmu_deburr::learning::pattern::{Pattern, Sample};
use fmu_deburr::path::AXES;
use fmu_deburr::path::Point;

use crate::robot::{Build, Robot, STEP};

/// Way of half a cycle, m.
const DISTANCE: f64 = 0.2 / PI;
/// Pulse of axis 3, m.
const PULSE: f64 = 5e-6;

/// Samples of a half cycle of a sine in speed, `factor` times 100 mm/s.
fn half_cycle(p: &Parameters, factor: f64) -> Pattern {
    let (speed, rate) = (0.1 * factor, PI * factor);
    let distance = |k: usize| (speed / rate * (1.0 - (rate * STEP * k as f64).cos())).clamp(0.0, DISTANCE);
    let run = (1.0 / (factor * STEP)).round() as usize;
    let rest = |distance: f64| Sample { point: Point { distance, speed: 0.0 }, compensation: [0.0; AXES] };
    let mut samples = vec![rest(0.0); p.learn.lead_in as usize];
    samples.extend((0..run).map(|k| {
        let point = Point { distance: distance(k), speed: (distance(k + 1) - distance(k)) / STEP };
        Sample { point, compensation: [0.0; AXES] }
    }));
    samples.resize(samples.len() + p.learn.lead_out as usize, rest(DISTANCE));
    Pattern { factor, samples, lead_in: p.learn.lead_in as usize, run, cyclic: false }
}

/// The pattern after all repetitions on axis 3.
fn learned(p: &Parameters, factor: f64) -> Pattern {
    let mut pattern = half_cycle(p, factor);
    let mut learner = Learner::new(p, pattern.len());
    for _ in 0..=p.learn.repetitions {
        let mut robot = Robot::new(&Build { delay: p.io_delay as usize, ..Build::NOMINAL }, &[0.0; AXES]);
        for (k, sample) in pattern.samples.iter().enumerate() {
            let mut error = [0.0; AXES];
            error[2] = (sample.point.distance / PULSE).round() - (robot.read()[2] / PULSE).round();
            learner.record(k, &error, &p.pulses(), &[0.0; AXES]);
            let mut command = [0.0; AXES];
            command[2] = 13.0 * PULSE * (error[2] + sample.compensation[2].round());
            robot.advance(&command);
        }
        learner.finish(p, &mut pattern);
    }
    pattern
}

/// Largest difference between the interpolated and the learned pattern, pulses: in 10 to 90 % of the way, and anywhere.
fn differences(delay: i32) -> [f64; 2] {
    let mut p = Parameters::START;
    p.io_delay = delay;
    let stored = [learned(&p, 1.0), learned(&p, 0.5)];
    let formed = learned(&p, 0.75);
    let preview = delay as usize;
    let mut worst: [f64; 2] = [0.0; 2];
    for k in formed.lead_in..formed.lead_in + formed.run - preview {
        // the feed is known this number of samples ahead
        let lookup = PatternLookup {
            point: formed.samples[k + preview].point,
            back: preview as f64,
            length: DISTANCE,
            nominal: None,
        };
        let difference = (lookup.compensation(&stored)[2] - formed.samples[k].compensation[2]).abs();
        let middle = (0.1 * DISTANCE..0.9 * DISTANCE).contains(&formed.samples[k].point.distance);
        worst[0] = worst[0].max(if middle { difference } else { 0.0 });
        worst[1] = worst[1].max(difference);
    }
    worst
}

#[test]
fn the_interpolated_pattern_is_within_four_pulses() {
    for delay in [0, 1] {
        let [middle, anywhere] = differences(delay);
        assert!(middle <= 4.0 && anywhere <= 10.0, "delay {delay}: {middle} {anywhere}");
    }
}
