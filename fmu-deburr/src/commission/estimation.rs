//! Gain, lag and delay of a drive from its strokes, by the estimator that `Learn` has.
//!
//! Slow motions tell how late a drive is as a whole, by delay and lag: their phases grow alike with the frequency, w d T and
//! 2 zeta w/wn, and differ by their third powers alone, some hundredths of a radian at the 2 Hz of a stroke, which is what
//! friction bends as well. So the delay is what is left of the whole beyond the lag of the nominal drive, and it is rounded to samples
//! as `io_delay` counts them: with wn and zeta within 30 % a lag of 3.7 ms is one of 2.0 to 6.9 ms, -0.17 to +0.32 samples of 10 ms beside.
//! What the rounding takes away belongs to the lag.

use serde::{Deserialize, Serialize};

use crate::commission::strokes::Strokes;
use crate::interface::Parameters;
use crate::learning::drive::{Drive, ToldDrive};
use crate::learning::identification::Identification;

/// Nothing counts as known better than this: what three weights leave out of a drive. Share of the gain, samples, and samples^2
/// of 1/(wn T)^2.
const LEAST_DEVIATION: [f64; 3] = [1e-4, 1e-3, 0.03];
/// Most samples of delay that are looked for, as `WrongDelay` does.
const DELAY_MAX: f64 = 6.0;

/// What the strokes have told of a drive: values with their standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Velocity over commanded velocity.
    pub gain: [f64; 2],
    /// How late the drive is as a whole, s.
    pub late: [f64; 2],
    /// Natural frequency, rad/s; zeros where nothing tells it.
    pub frequency: [f64; 2],
}

impl Response {
    /// From the strokes of the axis `axis` (from 0), in `room` for all their samples; zeros where they tell nothing.
    pub fn of(p: &Parameters, axis: usize, strokes: &Strokes, room: &mut [f64]) -> Self {
        let told = ToldDrive::new(p, axis);
        let mut identify = |told: &ToldDrive| {
            let mut drive = Drive::of(told, &Identification::new(told, strokes, room).weights_of_noise());
            drive.gain[1] = drive.gain[1].hypot(LEAST_DEVIATION[0] * drive.gain[0]);
            drive.lag[1] = drive.lag[1].hypot(LEAST_DEVIATION[1] * told.period);
            // d(wn)/d(mu) = -wn/(2 mu)
            let wn = drive.frequency[0];
            drive.frequency[1] = drive.frequency[1].hypot(0.5 * LEAST_DEVIATION[2] * wn * (wn * told.period).powi(2));
            let late = [drive.lag[0] + told.delay as f64 * told.period, drive.lag[1]];
            Self { gain: drive.gain, late, frequency: drive.frequency }
        };
        // the weights lie around the delay that was told, then around the one that was found
        let rough = identify(&told);
        let delay = rough.delay(p).round().clamp(0.0, DELAY_MAX) as usize;
        let found = identify(&ToldDrive { delay, ..told });
        let finite = found.gain.iter().chain(&found.late).chain(&found.frequency).all(|value| value.is_finite());
        if finite { found } else { Self::default() }
    }

    /// Samples by which the drive is later than the nominal lag.
    pub fn delay(&self, p: &Parameters) -> f64 {
        (self.late[0] - p.nominal_lag()) / p.sample_period
    }
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

    /// What is found of a drive from its strokes, with noise of `noise` counts.
    fn found(machine: &ToldDrive, noise: f64, seed: u64) -> Response {
        let p = Parameters::START;
        let plan = Plan::new(&p, 0.1, &[0.0, 0.0, 0.7, 0.0, 0.0, 0.0]);
        let samples = plan.samples[AXIS];
        let mut strokes = Strokes::new((STROKES * samples) as usize);
        let (nominal, mut state) = (Nominal::of(machine), LoopState::default());
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        for k in 0..STROKES * samples {
            let goal = if (k / samples).is_multiple_of(2) { plan.way[AXIS] } else { 0.0 };
            let way = Quintic::new(Trajectory::resting(plan.way[AXIS] - goal), goal, plan.time[AXIS]);
            let reference = way.at(f64::from(k % samples + 1) * p.sample_period).position / p.axis[AXIS].pulse;
            let normal: f64 = StandardNormal.sample(&mut random);
            // noise is read by the servo, too
            let read = (state.position() + noise * normal).round();
            let command = reference.round() - read + state.position();
            nominal.step(&mut state, command);
            strokes.take(reference, reference.round() - read);
        }
        let mut room = vec![0.0; (STROKES * samples) as usize];
        Response::of(&p, AXIS, &strokes, &mut room)
    }

    fn machine(gain: f64, frequency: f64, damping: f64, delay: usize) -> ToldDrive {
        let nominal = ToldDrive::new(&Parameters::START, AXIS);
        ToldDrive { gain, frequency: 280.0 * frequency, damping: 0.52 * damping, delay, ..nominal }
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
                let told = all.iter().map(|one| pick(one)[1]).sum::<f64>() / all.len() as f64;
                println!("noise {noise}: mean {mean}, scatter {}, told {told}", scatter.sqrt());
                let ratio = scatter.sqrt() / told;
                assert!((0.6..1.4).contains(&ratio), "{noise}: {ratio}");
            }
        }
    }

    #[test]
    fn strokes_that_are_not_answered_tell_nothing() {
        let p = Parameters::START;
        let mut strokes = Strokes::new(300);
        (0..300).for_each(|k| strokes.take(0.0, f64::from(k % 2)));
        let response = Response::of(&p, AXIS, &strokes, &mut [0.0; 300]);
        assert!(response.gain[1] > 0.1, "{response:?}");
    }
}
