//! Travel, torque and duration of a commissioning run, and the loop that holds the arm.
//!
//! The arm is held by the lead-lag of the position loop with so low a crossover w_c that it is stable with g = 1/2 to 2
//! times the acceleration per torque, a flexure of 0.7 to 1.43 times the frequency and half the damping, and two
//! samples more of delay. A rigid arm with the lead of 4 has the open loop g |L|, |L| = 1 at w_c; it crosses at w_c
//! times 0.6 to 1.7, with atan(4 x) - atan(x / 4) - atan(1 / 10 x), 50 degrees and more, less the delays: w_c = 0.3 /
//! (1.7 tau) leaves them 17 degrees. Beyond its crossover |L| is at most 4 (w_c / w)^2, and at its pole w_p the flexure
//! makes m / (2 z sqrt(1 - m)) of it: the w_c at which the whole is 1/2 with g = 2 leaves a factor 2 of gain whatever
//! the phase is.
//!
//! Each tone is so large that travel, torque and following error keep their bounds on every machine of that class: with the
//! largest |T|, |K (1 - T)| and |1 - T| of them. About the flexure the torque is what bends it at its resonance half as
//! far as full torque does at rest, twice as far with g = 2 and half the damping. It may be less than
//! `limits.disturbance`, because the thrust of a cut is absent. Slow tones alternate in amplitude, which separates dry
//! and viscous friction.

use std::f64::consts::TAU;

use control_blocks::{DELAY_SPREAD, RATIO_MAX, commission_time, configured_or};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::identify::experiment::Identification;
use crate::identify::tone::{Expected, Tone};
use crate::interface::{Parameters, Tip};
use crate::servo::lead_lag::LeadLag;
use crate::servo::loop_model::LoopModel;
use crate::servo::nominal::Nominal;

/// Largest ratio of the flexure frequency to the nominal one, or of its reciprocal.
pub const FLEXURE_MAX: f64 = 1.43;
/// Smallest damping of a flexure over the nominal one, and smallest of all.
const DAMPING: (f64, f64) = (0.5, 1e-3);
/// Lead of the compensator; its lag is that of the position loop.
const LEAD: f64 = 4.0;
/// Largest crossing of a machine over the nominal one, and the phase (rad) that delays may take there.
const CROSSING: f64 = 1.7;
const PHASE: f64 = 0.3;
/// Largest open loop beyond the crossing.
const PEAK: f64 = 0.5;
/// Slow tones over the crossover, and the part of the full size of each.
const SLOW: [(f64, f64); 8] =
    [(0.15, 1.0), (0.2, 0.5), (0.3, 1.0), (0.42, 0.5), (0.6, 1.0), (1.0, 1.0), (1.7, 1.0), (3.0, 1.0)];
/// Quick tones over the frequency of the flexure.
const QUICK: [f64; 16] = [0.25, 0.32, 0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.88, 0.96, 1.04, 1.12, 1.2, 1.28, 1.36, 1.43];
/// From this ratio on the tool may oscillate at its resonance.
const BENDS_FROM: f64 = 0.44;
/// Frequency that stands for the flexure of a rigid arm, rad/s; the highest tone, as a part of the sampling rate.
const RIGID: f64 = TAU * 1200.0;
const HIGHEST: f64 = 0.2;
/// Time at a tone before it is measured, s: the integral of the slow loop.
const SETTLE: f64 = 0.15;
/// Default torque over `servo.torque_max`.
const TORQUE_RATIO: f64 = 0.2;
/// Divisor of the amplitudes, because a machine between those of `machines` may move more than all of these.
const BETWEEN: f64 = 1.1;
/// Part of `limits.following_error` that a tone may have.
const ERROR_RATIO: f64 = 0.7;

/// Loop and tones of a commissioning run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// The nominal machine.
    pub nominal: Nominal,
    /// The loop, for the nominal arm.
    pub model: LoopModel,
    /// The tones.
    pub tones: Vec<Tone>,
    /// Standard deviation of an arm angle, rad: angles at rest spread over six of them, `limits.arm_spread`.
    noise: f64,
}

impl Plan {
    /// The plan for these bounds.
    pub fn new(p: &Parameters) -> Self {
        let nominal = Nominal::from(p);
        let compensator = compensator(&nominal);
        let machines = machines(&nominal, compensator);
        let tones = tones(&nominal, crossover(&nominal)).map(|(omega, part)| tone(p, omega, part, &machines)).collect();
        let noise = p.limits.arm_spread / 6.0;
        Self { nominal, model: LoopModel::new(nominal, compensator), tones, noise }
    }

    /// Amplitude (rad) of the set-point at the tone of this frequency (rad/s), and standard deviation of each part of
    /// what is measured.
    pub fn oscillation(&self, omega: f64) -> [f64; 2] {
        let cycles = omega * self.nominal.sample_period / TAU;
        let near = |tone: &&Tone| (tone.frequency() / cycles - 1.0).abs() < 1e-9;
        let of = |tone: &Tone| [tone.amplitude, self.noise * (2.0 / f64::from(tone.samples)).sqrt()];
        self.tones.iter().find(near).map_or([0.0; 2], of)
    }

    /// The experiment, before its first sample.
    pub fn experiment(&self, p: &Parameters) -> Identification {
        Identification::of(p, self.tones.clone(), SETTLE)
    }
}

/// A machine that the plan is for: the loop on it, and its flexure.
type Tolerances = (LoopModel, Tip);

/// The compensator that holds all of them.
fn compensator(nominal: &Nominal) -> LeadLag {
    let mut slow = *nominal;
    slow.servo.lead = LEAD;
    LeadLag::new(slow, crossover(nominal))
}

/// Crossover w_c of the compensator on the nominal arm, rad/s.
fn crossover(nominal: &Nominal) -> f64 {
    let Nominal { sample_period, servo, tip, .. } = nominal;
    let late = (f64::from(nominal.loop_delay() + DELAY_SPREAD) + 0.5) * sample_period
        + servo.current_bandwidth.recip()
        + servo.roll_off.recip();
    let by_delay = PHASE / (CROSSING * late);
    // the bandwidth is twice the crossover
    let by_wish = 0.25 * servo.bandwidth;
    let whole = (1.0 - tip.inertia).sqrt();
    let pole = tip.frequency / FLEXURE_MAX / whole;
    let peak = RATIO_MAX * LEAD * tip.inertia / (2.0 * damping(nominal) * whole);
    let by_flexure = if tip.frequency * tip.inertia > 0.0 { pole * (PEAK / peak).sqrt() } else { f64::INFINITY };
    by_delay.min(by_wish).min(by_flexure)
}

/// Smallest damping of the flexure.
fn damping(nominal: &Nominal) -> f64 {
    (DAMPING.0 * nominal.tip.damping).max(DAMPING.1)
}

/// Frequencies of the tones (rad/s) and the part of its full size that each has.
fn tones(nominal: &Nominal, crossover: f64) -> impl Iterator<Item = (f64, f64)> {
    let flexure = if nominal.tip.frequency > 0.0 { nominal.tip.frequency } else { RIGID };
    let slow = SLOW.map(|(ratio, part)| (ratio * crossover, part));
    let quick = QUICK.map(|ratio| (ratio * flexure, 1.0));
    let highest = HIGHEST * TAU / nominal.sample_period;
    let above = slow[SLOW.len() - 1].0;
    slow.into_iter().chain(quick.into_iter().filter(move |(omega, _)| *omega > 1.05 * above && *omega <= highest))
}

/// The loop on machines at the edges of the class and between.
fn machines(nominal: &Nominal, compensator: LeadLag) -> Vec<Tolerances> {
    let mut all = Vec::new();
    for ratio in [RATIO_MAX.recip(), 1.0, RATIO_MAX] {
        for io_delay in [0, nominal.io_delay, nominal.io_delay + DELAY_SPREAD] {
            for step in -6..=6 {
                let mut machine = Nominal { io_delay, ..*nominal };
                machine.servo.inertia /= ratio;
                machine.servo.viscous_friction = 0.0;
                machine.tip.frequency *= FLEXURE_MAX.powf(f64::from(step) / 6.0);
                machine.tip.damping = damping(nominal);
                all.push((LoopModel::new(machine, compensator), machine.tip));
            }
        }
    }
    all
}

/// A tone that keeps all bounds on all machines.
fn tone(p: &Parameters, omega: f64, part: f64, machines: &[Tolerances]) -> Tone {
    let length = p.tool.arm_length[p.tool.index()];
    let (mut oscillation, mut push, mut error) = (0.0f64, 0.0f64, 0.0f64);
    for (model, tip) in machines {
        let closed = model.closed(omega);
        oscillation = oscillation.max(closed.norm()).max((closed * tool_over_hub(tip, omega)).norm());
        push = push.max((closed / model.arm(omega)).norm());
        error = error.max((1.0 - closed).norm());
    }
    let torque = if omega < BENDS_FROM * p.tip.frequency || p.tip.inertia == 0.0 {
        torque(p)
    } else {
        torque(p).min(bending(p))
    };
    let maximum = (travel(p) / length / oscillation)
        .min(torque / push)
        .min(ERROR_RATIO * p.limits.following_error / length / error);
    let any = Expected { response: Complex::ONE, stiffness: 1.0, hub_over_tool: 1.0 };
    Tone { amplitude: part * maximum / BETWEEN, ..Tone::new(p, omega, &any) }
}

/// Motion of the tool over that of the hub.
fn tool_over_hub(tip: &Tip, omega: f64) -> Complex<f64> {
    if tip.frequency == 0.0 {
        return Complex::ONE;
    }
    let x = omega / tip.frequency;
    let spring = Complex::new(1.0, 2.0 * tip.damping * x);
    spring / (spring - x * x)
}

/// Torque (N.m) that bends the flexure at its resonance half as far as `servo.torque_max` does at rest.
fn bending(p: &Parameters) -> f64 {
    p.tip.damping.max(DAMPING.1) * p.servo.torque_max / (1.0 - p.tip.inertia).sqrt()
}

/// Farthest way of the tool (m) from where it was: `commission.travel`, or the amplitude of an identification.
pub fn travel(p: &Parameters) -> f64 {
    configured_or(p.commission.travel, || p.identify.amplitude)
}

/// Largest torque (N.m) of a tone: `commission.torque`, or a fifth of the drive's.
pub fn torque(p: &Parameters) -> f64 {
    configured_or(p.commission.torque, || TORQUE_RATIO * p.servo.torque_max)
}

/// Longest commission (s): `expert.commission.time`, or what its motions take and some more.
pub fn time(p: &Parameters) -> f64 {
    commission_time(p.commission.time, || shortest_time(p))
}

/// Time (s) of the motions of a commissioning run.
pub fn shortest_time(p: &Parameters) -> f64 {
    Plan::new(p).experiment(p).duration()
}

#[cfg(test)]
mod bounds;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::design::LoopMargins;

    /// Machines of the class that the plan was not made with.
    fn others(nominal: &Nominal, mut each: impl FnMut(&Nominal)) {
        for ratio in [0.5, 0.6, 0.85, 1.3, 1.7, 2.0] {
            for io_delay in 0..=nominal.io_delay + DELAY_SPREAD {
                for factor in [0.7, 0.83, 0.97, 1.13, 1.29, 1.43] {
                    for damping in [0.5, 1.0, 2.0] {
                        let mut machine = Nominal { io_delay, ..*nominal };
                        machine.servo.inertia /= ratio;
                        machine.tip.frequency *= factor;
                        machine.tip.damping *= damping;
                        each(&machine);
                    }
                }
            }
        }
    }

    #[test]
    fn the_loop_is_stable_with_margins_on_every_machine_that_it_is_for() {
        for (bandwidth, damping, delay) in [(230.0, 0.02, 1), (300.0, 0.02, 0), (100.0, 0.005, 3), (230.0, 0.1, 2)] {
            let mut p = Parameters::START;
            (p.servo.bandwidth, p.tip.damping, p.io_delay) = (TAU * bandwidth, damping, delay);
            let (nominal, plan) = (Nominal::from(&p), Plan::new(&p));
            others(&nominal, |machine| {
                let margins = LoopMargins::of(machine, &LoopModel::new(*machine, *plan.model.compensator()), 0.0);
                // 30 degrees, and a factor 2 that the peak leaves whatever its phase is
                assert!(
                    margins.phase > 0.52 && margins.gain > 2.0 && margins.sensitivity < 2.1,
                    "{machine:?}: {margins:?}"
                );
            });
        }
    }

    #[test]
    fn no_machine_goes_beyond_travel_torque_or_following_error() {
        for (distance, push) in [(0.0, 0.0), (2e-4, 0.0), (0.0, 0.5)] {
            let mut p = Parameters::START;
            (p.commission.travel, p.commission.torque) = (distance, push);
            let plan = Plan::new(&p);
            let mut maximum = [0.0f64; 3];
            others(&Nominal::from(&p), |machine| {
                let model = LoopModel::new(*machine, *plan.model.compensator());
                for tone in &plan.tones {
                    let omega = TAU * tone.frequency() / p.sample_period;
                    let closed = model.closed(omega);
                    let tool = (closed * tool_over_hub(&machine.tip, omega)).norm().max(closed.norm());
                    let sizes = [0.08 * tool, (closed / model.arm(omega)).norm(), 0.08 * (1.0 - closed).norm()];
                    (0..3).for_each(|i| maximum[i] = maximum[i].max(tone.amplitude * sizes[i]));
                }
            });
            let limits = [travel(&p), torque(&p), ERROR_RATIO * p.limits.following_error];
            (0..3).for_each(|i| assert!(maximum[i] < limits[i], "{distance} {push}, {i}: {maximum:?}"));
        }
    }

    #[test]
    fn the_tones_reach_the_flexure_from_far_below_to_far_above_and_keep_to_the_sampling_rate() {
        let mut p = Parameters::START;
        for (hertz, highest) in [(1200.0, 1.43 * 1200.0), (1900.0, 2000.0), (0.0, 1.43 * 1200.0)] {
            p.tip.frequency = TAU * hertz;
            let tones = Plan::new(&p).tones;
            let frequencies: Vec<f64> = tones.iter().map(|tone| tone.frequency() / p.sample_period).collect();
            assert!(frequencies.is_sorted() && frequencies[0] < 10.0, "{frequencies:?}");
            assert!(frequencies.last().unwrap() / highest < 1.001 && frequencies.last().unwrap() / highest > 0.9);
        }
    }

    #[test]
    fn default_and_configured_bounds() {
        let mut p = Parameters::START;
        assert_eq!(travel(&p), 1.75e-3);
        assert!((torque(&p) - 1.4).abs() < 1e-12);
        // 24 tones of 0.05 + 0.15 s and at least 0.2 s, and the glide to rest
        let minimum = shortest_time(&p);
        assert!(minimum > 24.0 * 0.4 + 0.05 && minimum < 24.0 * 0.42, "{minimum}");
        assert_eq!(time(&p), 1.25 * minimum + 1.0);
        (p.commission.travel, p.commission.torque, p.commission.time) = (2e-4, 3.0, 33.0);
        assert_eq!((travel(&p), torque(&p), time(&p)), (2e-4, 3.0, 33.0));
    }

    #[test]
    fn tones_suit_arms_that_are_softer_and_stiffer_than_nominal() {
        let nominal = Nominal::from(&Parameters::START);
        let all = machines(&nominal, compensator(&nominal));
        for factor in [FLEXURE_MAX.recip(), 1.0, FLEXURE_MAX] {
            let there =
                all.iter().filter(|(_, tip)| (tip.frequency / nominal.tip.frequency / factor - 1.0).abs() < 1e-9);
            // three inertias with three delays
            assert_eq!(there.count(), 9, "{factor}");
        }
    }
}
