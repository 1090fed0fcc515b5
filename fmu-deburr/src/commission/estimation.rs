//! Gain, lag and delay of a drive from its strokes, by the estimator of `Learn`.
//!
//! Slow motions show only the total delay of a drive. The phases of delay and lag grow alike with the frequency, w d T
//! and 2 zeta w/wn. They differ by their third powers, some hundredths of a radian at the 2 Hz of a stroke, which
//! friction bends as well. The delay is therefore the remainder after the lag of the nominal drive, rounded to samples
//! as `io_delay` is. With wn and zeta within 30 % a lag of 3.7 ms is one of 2.0 to 6.9 ms, which is -0.17 to +0.32
//! samples of 10 ms. The rounding error belongs to the lag.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::commission::friction::held_back;
use crate::commission::strokes::Strokes;
use crate::interface::{FRICTION_MAX, Parameters};
use crate::learning::drive::{Drive, LAG_MIN, NominalDrive};
use crate::learning::identification::Identification;

/// Smallest standard deviation: ratio of the gain, samples, and samples^2 of 1/(wn T)^2. Pulses that are rounded in the loop
/// are no white noise, and a drive that computes in steps of its own is no lag of second order.
const STD_MIN: [f64; 3] = [4e-5, 2.5e-3, 0.015];
/// Deviation of the lag 2 zeta/wn from the nominal one, root of the mean square of their ratio less 1, with wn and zeta
/// each evenly within s = 0.3: ((1 + s^2/3)/(1 - s^2) - ln((1 + s)/(1 - s))/s + 1)^(1/2).
const LAG_SPREAD: f64 = 0.262;
/// Most samples of delay that are looked for, as `WrongDelay` does.
const DELAY_MAX: f64 = 6.0;
/// How often a drive is evaluated: around the one that was configured, then around the one that was found before.
const PASSES: u32 = 5;
/// Gain and natural frequency over what was configured, or its reciprocal, that are looked for at most.
const RATIO_MAX: f64 = 2.0;
/// Smallest lateness that is looked for, samples.
const LAG_LIMIT: f64 = 0.05;
/// Steps of the derivatives, as parts of their numbers.
const STEP: f64 = 1e-4;

/// Values of a drive from its strokes, with their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Velocity over commanded velocity.
    pub gain: [f64; 2],
    /// How late the drive is as a whole, s.
    pub late: [f64; 2],
    /// Natural frequency, rad/s; zeros where it is not observable.
    pub frequency: [f64; 2],
    /// Displacement by which friction holds it back, rad or m; 0 with the largest uncertainty where it is not observable.
    pub friction: [f64; 2],
}

/// Unknowns of a drive: gain, how late it is as a whole (samples), and mu = 1/(wn T)^2.
type Unknowns = Vector3<f64>;

/// Displacement of a friction that is not observable: it may have any value.
const UNKNOWN: [f64; 2] = [0.0, FRICTION_MAX];

impl Response {
    /// Of a drive of which nothing is reported: gain and frequency that none has.
    pub const NONE: Self = Self { gain: [0.0; 2], late: [0.0; 2], frequency: [0.0; 2], friction: UNKNOWN };

    /// From the strokes of the axis `axis` (from 0), in `room` for twice all their samples; `NONE` where they show nothing.
    ///
    /// Three weights are short of a drive. So what is found is the drive whose own loop would show the same weights, by
    /// Newton's method, and with its derivatives the covariance of the weights is that of the unknowns.
    pub fn of(p: &Parameters, axis: usize, strokes: &Strokes, room: &mut [f64]) -> Self {
        let nominal = NominalDrive::new(p, axis);
        let (modelled, room) = room.split_at_mut(room.len() / 2);
        let rough = Drive::of(&nominal, &Identification::new(&nominal, strokes, modelled).weights_of_noise());
        let late = rough.lag[0] / nominal.period + nominal.delay as f64;
        let mut x = Unknowns::new(rough.gain[0], late, unknowns(&nominal)[2]);
        let (mut deviation, mut friction) = (Unknowns::zeros(), UNKNOWN);
        for _ in 0..PASSES {
            let start = limited(&nominal, x);
            // one that leaves it a lag
            let delay = (start[1] - p.nominal_lag() / nominal.period).round().min((start[1] - LAG_LIMIT).floor());
            let delay = delay.clamp(0.0, DELAY_MAX) as usize;
            let nominal = NominalDrive { delay, ..nominal };
            let identification = Identification::new(&drive(&nominal, &start), strokes, modelled);
            let mut weights = |x: &Unknowns| Vector3::from(identification.weights_of(&drive(&nominal, x), room));
            let (found, here) = (identification.weights_of_noise(), weights(&start));
            let slopes: [Unknowns; 3] = std::array::from_fn(|i| {
                let mut near = start;
                near[i] *= 1.0 + STEP;
                (weights(&near) - here) / (STEP * start[i])
            });
            let Some(inverse) = Matrix3::from_columns(&slopes).try_inverse() else { return Self::NONE };
            x = start + inverse * (Vector3::from(found.weights) - here);
            let covariance = inverse * Matrix3::from(found.covariance) * inverse.transpose();
            deviation = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
            let travel = held_back(&identification);
            friction = travel.map_or(UNKNOWN, |travel| travel.map(|counts| counts * p.axis[axis].pulse));
        }
        let finite = x.iter().chain(deviation.iter()).all(|value| value.is_finite());
        if finite { Self { friction, ..Self::nominal(&nominal, &x, &deviation) } } else { Self::NONE }
    }

    fn nominal(nominal: &NominalDrive, x: &Unknowns, deviation: &Unknowns) -> Self {
        let [gain, late, mu] = [0, 1, 2].map(|i| deviation[i].hypot(STD_MIN[i] * if i == 0 { x[0] } else { 1.0 }));
        let wn = if x[2] > 0.0 { x[2].sqrt().recip() / nominal.period } else { 0.0 };
        Self {
            gain: [x[0], gain],
            late: [x[1] * nominal.period, late * nominal.period],
            // d(wn)/d(mu) = -wn/(2 mu)
            frequency: [wn, if wn > 0.0 { 0.5 * wn * mu / x[2] } else { 0.0 }],
            friction: UNKNOWN,
        }
    }

    /// Samples by which the drive is later than the nominal lag.
    pub fn delay(&self, p: &Parameters) -> f64 {
        (self.late[0] - p.nominal_lag()) / p.sample_period
    }

    /// Standard deviation (samples) of the delay of drives whose lag is the nominal one within 30 %.
    pub fn delay_spread(p: &Parameters) -> f64 {
        LAG_SPREAD * p.nominal_lag() / p.sample_period
    }
}

fn unknowns(drive: &NominalDrive) -> Unknowns {
    let late = drive.lag() / drive.period + drive.delay as f64;
    Unknowns::new(drive.gain, late, (drive.frequency * drive.period).powi(-2))
}

/// The nearest ones that are looked for.
fn limited(nominal: &NominalDrive, x: Unknowns) -> Unknowns {
    let nominal = unknowns(nominal);
    let near = |i: usize, ratio: f64| x[i].clamp(nominal[i] / ratio, nominal[i] * ratio);
    Unknowns::new(near(0, RATIO_MAX), x[1].clamp(LAG_LIMIT, DELAY_MAX + 1.0), near(2, RATIO_MAX * RATIO_MAX))
}

/// The drive with these unknowns and the delay of `nominal`.
fn drive(nominal: &NominalDrive, x: &Unknowns) -> NominalDrive {
    let frequency = x[2].sqrt().recip() / nominal.period;
    let lag = ((x[1] - nominal.delay as f64) * nominal.period).max(LAG_MIN);
    NominalDrive { gain: x[0], frequency, damping: 0.5 * lag * frequency, ..*nominal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commission::plan::{Plan, STROKES};
    use crate::learning::nominal::{LoopState, Nominal};
    use control_blocks::{Quintic, Trajectory};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const AXIS: usize = 2;

    /// Response of the drive `machine`, identified from simulated strokes with white encoder noise of the standard
    /// deviation `noise` (counts).
    fn found(machine: &NominalDrive, noise: f64, seed: u64) -> Response {
        held(machine, noise, seed, 0.0, 0.0)
    }

    /// The same for a drive that friction holds back by `friction` counts, with an offset of its velocity (counts per
    /// sample).
    fn held(machine: &NominalDrive, noise: f64, seed: u64, friction: f64, offset: f64) -> Response {
        let p = Parameters::START;
        let plan = Plan::new(&p, 0.1, &[0.0, 0.0, 0.7, 0.0, 0.0, 0.0]);
        let samples = plan.samples[AXIS];
        let mut strokes = Strokes::new((STROKES * samples) as usize);
        let (nominal, mut state) = (Nominal::of(machine), LoopState::default());
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        for k in 0..STROKES * samples {
            let goal = if (k / samples).is_multiple_of(2) { plan.travel[AXIS] } else { 0.0 };
            let travel = Quintic::new(Trajectory::resting(plan.travel[AXIS] - goal), goal, plan.time[AXIS]);
            let reference = travel.at(f64::from(k % samples + 1) * p.sample_period).position / p.axis[AXIS].pulse;
            let normal: f64 = StandardNormal.sample(&mut random);
            // noise is read by the servo, too
            let read = (state.position() + noise * normal).round();
            // friction takes of its position to which the drive was sent, immediately where a stroke begins
            let direction = if k == 0 {
                -1.0
            } else if k % samples == 0 {
                -2.0 * (goal - 0.5 * plan.travel[AXIS]).signum()
            } else {
                0.0
            };
            let disturbance = (direction * friction + offset) * machine.bare_lag() / machine.gain;
            let command = reference.round() - read + state.position() + disturbance;
            nominal.step(&mut state, command);
            strokes.take(reference, reference.round() - read);
        }
        let mut room = vec![0.0; 2 * (STROKES * samples) as usize];
        Response::of(&p, AXIS, &strokes, &mut room)
    }

    fn machine(gain: f64, frequency: f64, damping: f64, delay: usize) -> NominalDrive {
        let nominal = NominalDrive::new(&Parameters::START, AXIS);
        NominalDrive { gain, frequency: 280.0 * frequency, damping: 0.52 * damping, delay, ..nominal }
    }

    #[test]
    fn drives_that_are_three_tenths_off_are_found_with_any_delay() {
        let p = Parameters::START;
        for (gain, frequency, damping) in
            [(1.0, 1.0, 1.0), (0.7, 0.7, 1.3), (1.3, 0.7, 0.7), (0.7, 1.3, 0.7), (1.3, 1.3, 1.3)]
        {
            for delay in 0..=3 {
                let drive = machine(gain, frequency, damping, delay);
                let response = found(&drive, 0.0, 1);
                let late = drive.lag() + 0.01 * delay as f64;
                println!("{gain} {frequency} {damping} {delay}: {response:?}, late {late}");
                assert!(
                    (response.gain[0] / gain - 1.0).abs() < 5e-4,
                    "{gain} {frequency} {damping} {delay}: {response:?}"
                );
                assert!(
                    (response.late[0] - late).abs() < 1.5e-4,
                    "{gain} {frequency} {damping} {delay}: {response:?} {late}"
                );
                let [wn, deviation] = response.frequency;
                assert!((wn - drive.frequency).abs() < 2.0 * deviation, "{drive:?}: {response:?}");
                assert!(deviation < 0.3 * wn, "{drive:?}: {response:?}");
                assert_eq!(response.delay(&p).round() as usize, delay);
            }
        }
    }

    #[test]
    fn the_deviation_is_the_scatter_of_the_estimates() {
        let drive = machine(1.2, 0.8, 1.1, 2);
        for noise in [3.0, 10.0] {
            let all: Vec<Response> = (0..80).map(|seed| found(&drive, noise, seed)).collect();
            let pick: [fn(&Response) -> [f64; 2]; 2] = [|one| one.gain, |one| one.late];
            for pick in pick {
                let mean = all.iter().map(|one| pick(one)[0]).sum::<f64>() / all.len() as f64;
                let scatter = all.iter().map(|one| (pick(one)[0] - mean).powi(2)).sum::<f64>() / all.len() as f64;
                let reported = all.iter().map(|one| pick(one)[1]).sum::<f64>() / all.len() as f64;
                println!("noise {noise}: mean {mean}, scatter {}, reported {reported}", scatter.sqrt());
                let ratio = scatter.sqrt() / reported;
                assert!((0.6..1.4).contains(&ratio), "{noise}: {ratio}");
            }
        }
    }

    #[test]
    fn friction_is_found_in_addition_to_the_drive_and_an_offset_is_none() {
        let pulse = Parameters::START.axis[AXIS].pulse;
        for delay in 0..=2 {
            for (gain, frequency, damping) in [(1.0, 1.0, 1.0), (0.7, 0.7, 1.3), (1.3, 0.7, 0.7), (1.3, 1.3, 1.3)] {
                let drive = machine(gain, frequency, damping, delay);
                for (friction, offset) in [(0.0, 0.0), (4.0, 0.0), (4.0, 0.5), (-4.0, 0.0), (0.0, -0.5)] {
                    let Response { friction: [travel, deviation], .. } = held(&drive, 0.4, 7, friction, offset);
                    let off = travel / pulse - friction;
                    println!("{drive:?} {friction} {offset}: {:.3} +- {:.3}", travel / pulse, deviation / pulse);
                    assert!(off.abs() < 3.0 * deviation / pulse, "{drive:?} {friction} {offset}: {travel} {deviation}");
                    assert!(deviation < 0.5 * pulse, "{deviation}");
                }
            }
        }
    }

    #[test]
    fn strokes_that_are_not_answered_show_nothing() {
        let p = Parameters::START;
        let mut strokes = Strokes::new(300);
        (0..300).for_each(|k| strokes.take(0.0, f64::from(k % 2)));
        assert_eq!(Response::of(&p, AXIS, &strokes, &mut [0.0; 600]), Response::NONE);
        assert_eq!(Response::NONE.friction, [0.0, FRICTION_MAX]);
    }
}
