//! Travel, force and time of a commissioning run, from its bounds.
//!
//! In the air every axis follows pulses only. A drive with position and velocity loop and a feedforward of at most 1
//! has a maximum gain below 2, for loops from half to twice as fast as configured. The excitation happens half of the
//! travel above the start, and its reference reaches at most a quarter of the travel. So the axes move at most half of
//! the travel, and not below the start. Two axes together are at most 0.71 of the travel to the side.
//!
//! The tool presses by eq. 4 without integral, on a contact of up to twice the nominal stiffness k. The open loop is an
//! integrator of the gain g = 2 k K_f / B_d with lags of the sum tau: M_d / B_d, the sensor, two and a half samples in
//! addition to the delay, and the axis, (1 - K_ff) / K_pp + K_ff / w_ff, twice that for loops half as fast. No lag of
//! the time constant t rotates the phase at w by more than w t. So where the gain is 1, at no more than g, the margin
//! is at least pi / 2 - g tau. The damping is increased until g tau = 0.6 rad, 56 degrees of margin. A softer contact
//! crosses earlier and has more.

use control_blocks::{
    Excitation, ExcitationTimes, Multisine, RATIO_MAX, commission_time, configured_or, quintic_duration, ticks,
    tolerated_delays,
};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Phase (rad) that all lags of the force loop may take at its crossing.
const PHASE: f64 = 0.6;
/// Period of the excitation (s), and how many are measured.
const PERIOD: f64 = 0.25;
const PERIODS: u32 = 12;
/// Fraction of the largest velocity that the excitation of an axis may take.
const VELOCITY_RATIO: f64 = 0.5;
/// Times (s) in which the excitation grows and fades, settles, and rests.
const TIMES: ExcitationTimes = ExcitationTimes { ramp: 0.5, settle: 0.25, rest: 0.2 };
/// Measured ramps of the force, up and down; the time of each, and the dwell time after it, s.
pub const PRESSES: u32 = 6;
const PRESS: f64 = 0.6;
const REST_TIME: f64 = 0.2;
/// Force between the presses over the largest.
const LOW: f64 = 0.2;
/// Periods of reciprocating rubbing, along the path and across it; the first gives only the mean force.
pub const RUBS: u32 = 7;
/// Maximum rubbing distance to each side, over the travel and over `expert.limits.start_offset`.
const RUB_RATIOS: [f64; 2] = [0.25, 0.5];

/// The motions of a commissioning run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Excitation of every axis.
    pub excitation: Excitation,
    /// Way up before it, m.
    pub rise: f64,
    /// Time of that way, s.
    pub rise_time: f64,
    /// Damping of the force control, N s/m.
    pub damping: f64,
    /// Largest force, and that between the presses, N.
    pub force: [f64; 2],
    /// Change of the target force, N/s.
    pub force_rate: f64,
    /// Samples of a press, and of them those with a ramp.
    pub press: [u32; 2],
    /// Samples of a quarter of a rubbing motion.
    pub quarter: u32,
    /// Its speed, m/s.
    pub speed: f64,
}

impl Plan {
    /// The plan for these bounds.
    pub fn new(p: &Parameters) -> Self {
        let (dt, travel, force) = (p.sample_period, travel(p), force(p));
        let unit = Multisine { amplitude: 1.0, ..fastest(p) };
        let amplitude = fastest(p).amplitude.min(0.5 * travel / (RATIO_MAX * unit.reach()));
        let (low, ramp) = (LOW * force, ticks(PRESS, dt).max(1));
        let side = (RUB_RATIOS[0] * travel).min(RUB_RATIOS[1] * p.limits.start_offset);
        let quarter = ticks(side / p.approach.velocity, dt).max(1);
        Self {
            excitation: Excitation::new(Multisine { amplitude, ..unit }, PERIODS, &TIMES),
            rise: 0.5 * travel,
            rise_time: quintic_duration(0.5 * travel, p.retract.velocity).max(dt),
            damping: damping(p),
            force: [force, low],
            force_rate: (force - low) / PRESS,
            press: [ramp + ticks(REST_TIME, dt), ramp],
            quarter,
            speed: side / (f64::from(quarter) * dt),
        }
    }

    /// Longest time of all motions, s.
    fn duration(&self, p: &Parameters) -> f64 {
        let down = (self.rise + p.approach.travel_max) / p.approach.velocity;
        let samples = self.excitation.samples() + (PRESSES + 3) * self.press[0] + 8 * RUBS * self.quarter;
        let out = p.settle.time_max + p.retract.distance / p.retract.velocity;
        p.tare_time + self.rise_time + down + f64::from(samples) * p.sample_period + out
    }
}

/// Damping (N s/m) with which the force is stable on every machine within the bounds of the run.
fn damping(p: &Parameters) -> f64 {
    let (stiffness, drive) = (RATIO_MAX * p.impedance.gain * p.stiffness_nominal, &p.drive);
    let samples = f64::from(*tolerated_delays(p.io_delay).end()) + 0.5;
    let axis = (1.0 - drive.feedforward) / drive.position_gain + drive.feedforward / drive.feedforward_bandwidth;
    let filter = if p.force.filter_bandwidth > 0.0 { p.force.filter_bandwidth.recip() } else { 0.0 };
    let lags = samples * p.sample_period + p.sensor_bandwidth.recip() + filter + RATIO_MAX * axis;
    // k / B (lags + M / B) = PHASE is a quadratic in B
    let half = 0.5 * stiffness * lags / PHASE;
    p.impedance.damping.max(half + (half * half + stiffness * p.impedance.mass / PHASE).sqrt())
}

/// The fastest excitation within the velocity fraction.
fn fastest(p: &Parameters) -> Multisine {
    let dt = p.sample_period;
    let unit = Multisine { amplitude: 1.0, period: ticks(PERIOD, dt).max(1), sample_period: dt };
    Multisine { amplitude: VELOCITY_RATIO * p.velocity_max / unit.velocity_max(), ..unit }
}

/// Maximum lateral travel and lift (m): `commission.travel`, or that of the fastest excitation.
pub fn travel(p: &Parameters) -> f64 {
    configured_or(p.commission.travel, || 2.0 * RATIO_MAX * fastest(p).reach())
}

/// Pressing force (N): `expert.commission.force`, or that of the cycle.
pub fn force(p: &Parameters) -> f64 {
    configured_or(p.commission.force, || p.force.target)
}

/// Maximum time of the run (s): that of its motions with a reserve.
pub fn time(p: &Parameters) -> f64 {
    commission_time(0.0, || shortest_time(p))
}

/// Time (s) that the motions of a commissioning run take at most.
pub fn shortest_time(p: &Parameters) -> f64 {
    Plan::new(p).duration(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::impedance::Coefficients;
    use crate::force::margin::phase_margin;
    use crate::force::response::axis;
    use control_blocks::{DELAY_SPREAD, HARMONICS};

    const RATIOS: [f64; 4] = [0.5, 0.7, 1.3, 2.0];

    #[test]
    fn the_force_is_stable_on_every_machine_that_it_is_for() {
        for io_delay in 0..=4 {
            let nominal = Parameters { io_delay, ..Parameters::START };
            let law = Coefficients { integral: 0.0, ..Coefficients::new(&nominal, Plan::new(&nominal).damping) };
            for (ratio, late) in RATIOS.into_iter().flat_map(|ratio| [(ratio, 0), (ratio, DELAY_SPREAD)]) {
                let mut p = nominal.clone();
                p.io_delay += late;
                p.drive = p.drive.faster(ratio, p.drive.feedforward);
                let margin = phase_margin(&p, &law, RATIO_MAX * p.stiffness_nominal).to_degrees();
                assert!(margin > 90.0 - PHASE.to_degrees(), "{io_delay} + {late}, {ratio}: {margin}");
                assert!(phase_margin(&p, &law, p.stiffness_nominal / RATIO_MAX).to_degrees() > margin);
            }
        }
    }

    #[test]
    fn all_lags_of_the_loop_together_take_the_phase_that_they_may() {
        let mut p = Parameters { io_delay: 3, ..Parameters::START };
        (p.impedance.damping, p.force.filter_bandwidth) = (10.0, 200.0);
        let damping = Plan::new(&p).damping;
        let axis = 0.2 / 80.0 + 0.8 / 628.3;
        let lags = 5.5e-3 + 1.0 / 1256.6 + 1.0 / 200.0 + 2.0 * axis + p.impedance.mass / damping;
        assert!((2.0 * 178e3 / damping * lags / PHASE - 1.0).abs() < 1e-9, "{damping}");
        p.impedance.damping = 2.0 * damping;
        assert_eq!(Plan::new(&p).damping, 2.0 * damping);
    }

    #[test]
    fn no_axis_goes_farther_than_half_of_the_travel() {
        for (travel, ratio, feedforward) in
            RATIOS.into_iter().flat_map(|ratio| [(0.0, ratio, 0.3), (2e-4, ratio, 0.8), (0.0, ratio, 1.0)])
        {
            let mut p = Parameters::START;
            p.commission.travel = travel;
            let plan = Plan::new(&p);
            let drive = p.drive.faster(ratio, feedforward);
            let tones = plan.excitation.sines.frequencies().into_iter().zip(HARMONICS);
            let peak: f64 = tones.map(|(omega, h)| axis(&drive, omega).norm() / f64::from(h).sqrt()).sum();
            assert!(plan.excitation.sines.amplitude * peak <= plan.rise, "{travel} {ratio} {feedforward}: {peak}");
            assert_eq!(plan.rise, 0.5 * super::travel(&p));
        }
    }

    #[test]
    fn bounds_of_the_defaults_and_configured_bounds() {
        let mut p = Parameters::START;
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-6, "{value} {expected}");
        near(travel(&p), 4.0 * Plan::new(&p).excitation.sines.reach());
        near(Plan::new(&p).excitation.sines.velocity_max(), 0.5 * p.velocity_max);
        near(force(&p), 5.0);
        let plan = Plan::new(&p);
        near(f64::from(plan.quarter) * 1e-3 * plan.speed, 0.5 * p.limits.start_offset);
        // tare, up, down, 4.45 s of excitation, nine presses, 14 periods of 0.4 s, unloading and out
        let rise = 1.875 * plan.rise / p.retract.velocity;
        let down = (plan.rise + p.approach.travel_max) / p.approach.velocity;
        near(shortest_time(&p), 0.1 + rise + down + 4.45 + 9.0 * 0.8 + 14.0 * 0.4 + 2.1);
        near(time(&p), 1.25 * shortest_time(&p) + 1.0);
        (p.commission.travel, p.commission.force) = (1e-4, 3.0);
        near(travel(&p), 1e-4);
        near(Plan::new(&p).excitation.sines.reach(), 0.25e-4);
        near(force(&p), 3.0);
        let plan = Plan::new(&p);
        near(f64::from(plan.quarter) * 1e-3 * plan.speed, 0.25e-4);
        near(plan.force[1], 0.6);
    }
}
