//! A multisine from rest to rest: it grows, settles, is measured over whole periods, fades, and rests.
//!
//! With the envelope e of the multisine m the motion is x = e m, v = e' m + e m', a = e'' m + 2 e' m' + e m''; e grows
//! and fades with minimum jerk, so that x starts and ends at rest.

use serde::{Deserialize, Serialize};

use super::multisine::Multisine;
use crate::motion::quintic::{minimum_jerk, minimum_jerk_rates};
use crate::motion::trajectory::Trajectory;
use crate::sampling::ticks::ticks;

/// Times of an excitation, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExcitationTimes {
    /// In which it grows, and in which it fades.
    pub ramp: f64,
    /// Until the transient of the growing has decayed.
    pub settle: f64,
    /// After it has faded.
    pub rest: f64,
}

/// An excitation in whole samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    /// Whole periods that are measured.
    pub sines: Multisine,
    ramp: u32,
    settle: u32,
    measured: u32,
    rest: u32,
}

impl Excitation {
    /// Measured over this number of periods.
    pub fn new(sines: Multisine, periods: u32, times: &ExcitationTimes) -> Self {
        let dt = sines.sample_period;
        Self {
            sines,
            ramp: ticks(times.ramp, dt).max(1),
            settle: ticks(times.settle, dt),
            measured: periods * sines.period,
            rest: ticks(times.rest, dt),
        }
    }

    /// Samples from rest to rest.
    pub fn samples(&self) -> u32 {
        self.fades() + self.ramp + self.rest
    }

    /// Samples that are measured.
    pub fn measured(&self) -> u32 {
        self.measured
    }

    /// Whether the sample `tick` is measured.
    pub fn measures(&self, tick: u32) -> bool {
        (self.ramp + self.settle..self.fades()).contains(&tick)
    }

    /// The motion `tick` samples after its start.
    pub fn at(&self, tick: u32) -> Trajectory {
        let rate = (f64::from(self.ramp) * self.sines.sample_period).recip();
        let (progress, rate) = match tick.checked_sub(self.fades()) {
            None => ((f64::from(tick) / f64::from(self.ramp)).min(1.0), rate),
            Some(fading) => ((1.0 - f64::from(fading) / f64::from(self.ramp)).max(0.0), -rate),
        };
        let (e, [e1, e2]) = (minimum_jerk(progress), minimum_jerk_rates(progress, rate));
        let m = self.sines.at(u64::from(tick));
        Trajectory {
            position: e * m.position,
            velocity: e1 * m.position + e * m.velocity,
            acceleration: e2 * m.position + 2.0 * e1 * m.velocity + e * m.acceleration,
        }
    }

    /// The sample from which on it fades.
    fn fades(&self) -> u32 {
        self.ramp + self.settle + self.measured
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: ExcitationTimes = ExcitationTimes { ramp: 0.5, settle: 0.25, rest: 0.1 };

    fn excitation() -> Excitation {
        Excitation::new(Multisine { amplitude: 1e-3, period: 500, sample_period: 1e-3 }, 3, &TIMES)
    }

    #[test]
    fn whole_periods_are_measured_between_growing_and_fading() {
        let one = excitation();
        assert_eq!((one.samples(), one.measured()), (500 + 250 + 1500 + 500 + 100, 1500));
        let measured = (0..one.samples()).filter(|tick| one.measures(*tick));
        assert_eq!((measured.clone().count(), measured.clone().min(), measured.max()), (1500, Some(750), Some(2249)));
        for tick in [500, 750, 2250] {
            assert_eq!(one.at(tick), one.sines.at(u64::from(tick)), "{tick}");
        }
        // half of it in the middle of a ramp
        for tick in [250, 2500] {
            assert_eq!(one.at(tick).position, 0.5 * one.sines.at(u64::from(tick)).position, "{tick}");
        }
    }

    #[test]
    fn it_starts_and_ends_at_rest_and_moves_as_it_says() {
        let one = excitation();
        for tick in [0, 2750, one.samples()] {
            let Trajectory { position, velocity, acceleration } = one.at(tick);
            assert!([position, velocity, acceleration].iter().all(|x| x.abs() < 1e-15), "{tick}");
        }
        let dt = one.sines.sample_period;
        for tick in 1..one.samples() {
            let [before, now, after] = [tick - 1, tick, tick + 1].map(|tick| one.at(tick));
            // 50 Hz in steps of 1 ms: (omega dt)^2 / 6
            let slope = (after.position - before.position) / (2.0 * dt) - now.velocity;
            assert!(slope.abs() < 0.02 * one.sines.velocity_max(), "{tick}: {slope}");
            let slope = (after.velocity - before.velocity) / (2.0 * dt) - now.acceleration;
            assert!(slope.abs() < 0.02 * one.sines.acceleration_max(), "{tick}: {slope}");
        }
    }
}
