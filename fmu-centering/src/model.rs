//! Model of the ring: from samples of the surface to the place of its centre.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::centre::{Centre, Estimate};
use crate::kalman::ScalarKalman;
use crate::parameters::Parameters;
use crate::sine_fit::SineSums;

/// How the eccentricity is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelMethod {
    /// Kalman filter and sine fit over one revolution.
    SineFit = 1,
}

/// What one tick shows of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Smoothed unwrapped spindle angle, rad.
    pub angle: f64,
    /// Position of the measuring tip, m.
    pub tip: f64,
    /// The collection loop runs in this tick and the state is `Collect`.
    pub collect: bool,
}

/// The model that the parameters choose.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum RingModel {
    /// Kalman filter and sine fit over one revolution.
    SineFit(SineModel),
}

impl RingModel {
    /// Model without data.
    pub fn new(p: &Parameters) -> Self {
        match p.model.method {
            ModelMethod::SineFit => Self::SineFit(SineModel::default()),
        }
    }

    /// Begins a new collection.
    pub fn begin(&mut self) {
        match self {
            Self::SineFit(model) => *model = SineModel::default(),
        }
    }

    /// Takes the observation of one tick.
    pub fn update(&mut self, p: &Parameters, seen: &Observation) {
        match self {
            Self::SineFit(model) if seen.collect => model.update(p, seen.angle, seen.tip),
            Self::SineFit(_) => {}
        }
    }

    /// Whether the collection is complete.
    pub fn complete(&self) -> bool {
        match self {
            Self::SineFit(model) => model.complete(),
        }
    }

    /// The model of what was collected; none if that does not determine it.
    pub fn estimate(&self) -> Option<Estimate> {
        match self {
            Self::SineFit(model) => model.estimate(),
        }
    }
}

/// The paper's model: Kalman filter, then a sine over one revolution, turned in either direction.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SineModel {
    filter: ScalarKalman,
    sums: SineSums,
    /// smallest and largest angle so far, rad
    range: Option<[f64; 2]>,
}

impl SineModel {
    fn update(&mut self, p: &Parameters, angle: f64, tip: f64) {
        let filtered = self.filter.update(&p.kalman, tip);
        self.sums.add(angle, filtered);
        let [low, high] = self.range.unwrap_or([angle; 2]);
        self.range = Some([low.min(angle), high.max(angle)]);
    }

    fn complete(&self) -> bool {
        self.range.is_some_and(|[low, high]| high - low >= TAU)
    }

    fn estimate(&self) -> Option<Estimate> {
        let sine = self.sums.fit()?;
        Some(Estimate { centre: Centre::from_sine(&sine), mean: sine.mean, sigma: sine.sigma })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spindle::change;

    /// Collects a sine of 0.1 mm nearest at 1 rad at 66 Hz and `speed` rad/s; samples until complete.
    fn collected(speed: f64) -> (RingModel, u32) {
        let p = Parameters::PAPER;
        let mut model = RingModel::new(&p);
        let mut count = 0;
        while !model.complete() && count < 10_000 {
            let angle = 100.0 + speed * f64::from(count) / p.rates.collect;
            model.update(&p, &Observation { angle, tip: 0.03 - 1e-4 * (angle - 1.0).cos(), collect: true });
            count += 1;
        }
        (model, count)
    }

    #[test]
    fn one_revolution_is_collected_in_either_direction() {
        for speed in [2.0944, -2.0944] {
            let (model, count) = collected(speed);
            // 198 samples a turn at 20 rpm, and the one that closes it
            assert_eq!(count, 199);
            let estimate = model.estimate().unwrap();
            assert!((estimate.mean - 0.03).abs() < 1e-6);
            assert!((estimate.centre.eccentricity() - 1e-4).abs() < 1e-6, "{estimate:?}");
        }
    }

    #[test]
    fn the_filter_lags_behind_the_turning_as_its_gain_says() {
        // 1.56 samples: 2.84 deg at 20 rpm, with the direction of rotation
        for speed in [2.0944, -2.0944] {
            let centre = collected(speed).0.estimate().unwrap().centre;
            let lag = change(1.0, centre.nearest()).to_degrees() * speed.signum();
            assert!((lag - 2.84).abs() < 0.15, "{lag} deg");
        }
    }

    #[test]
    fn a_spindle_that_turns_back_completes_nothing() {
        let p = Parameters::PAPER;
        let mut model = RingModel::new(&p);
        for k in 0..10_000 {
            let angle = 3.0 * (0.01 * f64::from(k)).sin();
            model.update(&p, &Observation { angle, tip: 0.03, collect: true });
        }
        assert!(!model.complete());
    }

    #[test]
    fn between_two_beats_nothing_is_taken() {
        let p = Parameters::PAPER;
        let mut model = RingModel::new(&p);
        for k in 0..1000 {
            model.update(&p, &Observation { angle: 0.1 * f64::from(k), tip: 0.03, collect: false });
        }
        assert!(!model.complete() && model.estimate().is_none());
    }
}
