//! The six detectors behind one type: each learns its noise before contact and then tests every sample.

use serde::{Deserialize, Serialize};

use crate::cusum::CumulativeSum;
use crate::glr::OnsetBank;
use crate::kalman::{self, KalmanFilter};
use crate::machine::ContactSource;
use crate::parameters::Parameters;
use crate::slope::RunningSlope;
use crate::threshold::{Statistics, Threshold, Welford};

/// Windows of the multi-slope detector, samples.
pub const WINDOWS: [usize; 4] = [20, 50, 100, 200];

/// Which detector decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DetectorKind {
    /// The notched force itself.
    Raw = 1,
    /// The deviation from the moving average, eq. 2.
    Deviation = 2,
    /// The slope of the deviation, eq. 3: the paper's.
    Slope = 3,
    /// The slope over four windows side by side: the default.
    MultiSlope = 4,
    /// Cumulative sum of the Kalman innovation.
    Cusum = 5,
    /// Generalised likelihood ratio of the Kalman innovation.
    Glr = 6,
}

/// One sample of all that detectors look at, in the frame where a contact pushes against the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Encoder position, m; none if it is lost.
    pub position: Option<f64>,
    /// Current that acted since the last sample, A.
    pub acted: f64,
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
    /// Notched force, N.
    pub notched: f64,
    /// Deviation from the moving average, N.
    pub deviation: f64,
    /// Slope over the paper's window, N/s.
    pub slope: f64,
}

/// A signal, its statistics before contact, its threshold and how often in a row it was above.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Monitor {
    signal: f64,
    statistics: Statistics,
    threshold: Threshold,
    row: i32,
}

impl Monitor {
    fn learn(&mut self) {
        self.statistics.push(self.signal);
    }

    fn arm(&mut self, p: &Parameters, tests: usize) {
        self.threshold = self.statistics.threshold(p, tests);
        self.row = 0;
    }

    fn test(&mut self, p: &Parameters) -> bool {
        let above = self.signal > self.threshold.value;
        self.row = if above { self.row + 1 } else { 0 };
        self.row >= p.threshold.row
    }

    fn forget(&mut self) {
        (self.statistics, self.threshold) = Default::default();
    }
}

/// Slope over one more window.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Scale {
    slope: RunningSlope,
    monitor: Monitor,
}

/// Kalman innovation, normalised by its learned standard deviation.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Innovation {
    filter: KalmanFilter,
    noise: Welford,
    value: f64,
}

impl Innovation {
    fn new(p: &Parameters) -> Self {
        Self { filter: KalmanFilter::new(p), noise: Welford::default(), value: 0.0 }
    }

    fn update(&mut self, sample: &Sample) {
        self.value = self.filter.update(sample.position, sample.acted, sample.spindle_speed);
    }

    fn reset(&mut self, position: f64) {
        self.filter.reset(position);
        self.noise = Welford::default();
    }
}

/// What is particular to one method; the enum names the state, not the parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Core {
    Raw(Monitor),
    Deviation(Monitor),
    Slope,
    MultiSlope(Vec<Scale>),
    Cusum(Box<(Innovation, CumulativeSum)>),
    Glr(Box<(Innovation, OnsetBank)>),
}

/// A detector with the paper's slope, whose statistics are always learned.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Detector {
    slope: Monitor,
    core: Core,
}

impl Detector {
    /// The detector that `p.detector` names.
    pub fn new(p: &Parameters) -> Self {
        let core = match p.detector {
            DetectorKind::Raw => Core::Raw(Monitor::default()),
            DetectorKind::Deviation => Core::Deviation(Monitor::default()),
            DetectorKind::Slope => Core::Slope,
            DetectorKind::MultiSlope => Core::MultiSlope(
                WINDOWS
                    .map(|window| Scale {
                        slope: RunningSlope::new(window, p.sample_period),
                        monitor: Monitor::default(),
                    })
                    .into(),
            ),
            DetectorKind::Cusum => Core::Cusum(Box::new((Innovation::new(p), CumulativeSum::default()))),
            DetectorKind::Glr => Core::Glr(Box::new((Innovation::new(p), OnsetBank::new(p)))),
        };
        Self { slope: Monitor::default(), core }
    }

    /// Longest slope window, samples.
    pub fn window(p: &Parameters) -> i32 {
        match p.detector {
            DetectorKind::MultiSlope => p.slope.window.max(WINDOWS[3] as i32),
            _ => p.slope.window,
        }
    }

    /// Samples at constant speed that the detector needs before it may learn.
    pub fn settling(p: &Parameters) -> i32 {
        let filters = p.deviation.window + Self::window(p);
        match p.detector {
            DetectorKind::Cusum => filters.max(kalman::ITERATIONS as i32),
            DetectorKind::Glr => filters.max(kalman::ITERATIONS as i32 + p.glr.onsets),
            _ => filters,
        }
    }

    /// Forgets what was learned; the stage is at rest at `position` m.
    pub fn reset(&mut self, position: f64) {
        self.slope.forget();
        match &mut self.core {
            Core::Raw(monitor) | Core::Deviation(monitor) => monitor.forget(),
            Core::Slope => {}
            Core::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.forget()),
            Core::Cusum(inner) => inner.0.reset(position),
            Core::Glr(inner) => inner.0.reset(position),
        }
    }

    /// Takes one sample; the force signals of a sample without position are not used.
    pub fn update(&mut self, sample: &Sample) {
        match &mut self.core {
            Core::Cusum(inner) => inner.0.update(sample),
            Core::Glr(inner) => {
                inner.0.update(sample);
                inner.1.build(&inner.0.filter);
            }
            _ if sample.position.is_none() => return,
            Core::Raw(monitor) => monitor.signal = sample.notched,
            Core::Deviation(monitor) => monitor.signal = sample.deviation,
            Core::Slope => {}
            Core::MultiSlope(scales) => {
                for Scale { slope, monitor } in scales {
                    monitor.signal = slope.update(sample.deviation);
                }
            }
        }
        self.slope.signal = sample.slope;
    }

    /// Learns from the newest sample.
    pub fn learn(&mut self) {
        self.slope.learn();
        match &mut self.core {
            Core::Raw(monitor) | Core::Deviation(monitor) => monitor.learn(),
            Core::Slope => {}
            Core::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.learn()),
            Core::Cusum(inner) => inner.0.noise.push(inner.0.value),
            Core::Glr(inner) => inner.0.noise.push(inner.0.value),
        }
    }

    /// Whether all filters are in their steady state, so that learning may end.
    pub fn ready(&self) -> bool {
        match &self.core {
            Core::Cusum(inner) => inner.0.filter.settled(),
            Core::Glr(inner) => inner.1.ready(),
            _ => true,
        }
    }

    /// Sets the thresholds from what was learned.
    pub fn arm(&mut self, p: &Parameters) {
        let tests = if let Core::MultiSlope(scales) = &self.core { scales.len() } else { 1 };
        self.slope.arm(p, tests);
        match &mut self.core {
            Core::Raw(monitor) | Core::Deviation(monitor) => monitor.arm(p, tests),
            Core::Slope => {}
            Core::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.arm(p, tests)),
            Core::Cusum(inner) => inner.1 = CumulativeSum::default(),
            Core::Glr(inner) => inner.1.clear(),
        }
    }

    /// Learned statistics and threshold of the paper's slope; all zero before they are learned.
    pub fn learned(&self) -> Threshold {
        self.slope.threshold
    }

    /// Tests the newest sample; true on contact.
    pub fn test(&mut self, p: &Parameters) -> bool {
        match &mut self.core {
            Core::Raw(monitor) | Core::Deviation(monitor) => monitor.test(p),
            Core::Slope => self.slope.test(p),
            Core::MultiSlope(scales) => scales.iter_mut().any(|s| s.monitor.test(p)),
            // a contact makes the stage lag behind its prediction
            Core::Cusum(inner) => {
                let (innovation, sum) = &mut **inner;
                sum.test(&p.cusum, -innovation.value / innovation.noise.sigma())
            }
            Core::Glr(inner) => {
                let (innovation, bank) = &mut **inner;
                bank.update(innovation.value, innovation.noise.sigma()) > p.glr.threshold
            }
        }
    }

    /// The name of the detector as source of a contact.
    pub fn source(&self) -> ContactSource {
        match self.core {
            Core::Raw(_) => ContactSource::Raw,
            Core::Deviation(_) => ContactSource::Deviation,
            Core::Slope => ContactSource::Slope,
            Core::MultiSlope(_) => ContactSource::MultiSlope,
            Core::Cusum(_) => ContactSource::Cusum,
            Core::Glr(_) => ContactSource::Glr,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signal that is quiet noise while learning, then `level`.
    fn ticks_to_detect(p: &Parameters, level: f64) -> Option<usize> {
        let mut detector = Detector::new(p);
        let sample = |slope| Sample { position: Some(0.0), slope, ..Sample::default() };
        for k in 0..1000 {
            detector.update(&sample((f64::from(k) * 1.3).sin()));
            detector.learn();
        }
        detector.arm(p);
        (1..100).find(|_| {
            detector.update(&sample(level));
            detector.test(p)
        })
    }

    #[test]
    fn three_in_a_row_above_the_threshold() {
        let p = Parameters::PAPER;
        assert_eq!(ticks_to_detect(&p, 10.0), Some(3));
        assert_eq!(ticks_to_detect(&p, 1.0), None);
    }

    #[test]
    fn row_starts_again_below_the_threshold() {
        let p = Parameters::PAPER;
        let mut monitor = Monitor::default();
        monitor.threshold.value = 1.0;
        let hits: Vec<bool> = [2.0, 2.0, 0.0, 2.0, 2.0, 2.0]
            .iter()
            .map(|x| {
                monitor.signal = *x;
                monitor.test(&p)
            })
            .collect();
        assert_eq!(hits, [false, false, false, false, false, true]);
    }

    #[test]
    fn each_method_names_itself() {
        let source = |detector| Detector::new(&Parameters { detector, ..Parameters::DEFAULT }).source();
        assert_eq!(source(DetectorKind::Raw), ContactSource::Raw);
        assert_eq!(source(DetectorKind::Deviation), ContactSource::Deviation);
        assert_eq!(source(DetectorKind::Slope), ContactSource::Slope);
        assert_eq!(source(DetectorKind::MultiSlope), ContactSource::MultiSlope);
        assert_eq!(source(DetectorKind::Cusum), ContactSource::Cusum);
        assert_eq!(source(DetectorKind::Glr), ContactSource::Glr);
    }
}
