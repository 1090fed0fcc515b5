//! The six detectors behind one type: each learns its noise before contact and then tests every sample.

use control_blocks::{RunningLine, ticks};
use serde::{Deserialize, Serialize};

use crate::detection::cusum::CumulativeSum;
use crate::detection::glr::OnsetBank;
use crate::detection::innovation::Innovation;
use crate::detection::kalman;
use crate::detection::monitor::Monitor;
use crate::force::observer::forgetting;
use crate::interface::{ContactSource, DetectorKind, Parameters, ThresholdOutput};

/// Windows of the multi-slope detector, s.
const WINDOWS: [f64; 4] = [2e-3, 5e-3, 10e-3, 20e-3];
/// Samples of the shortest window.
const LEAST: u32 = 3;

/// Samples of a window of `time` s.
pub fn samples(time: f64, sample_period: f64) -> usize {
    ticks(time, sample_period).max(LEAST) as usize
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

/// Slope over one more window.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Scale {
    line: RunningLine,
    monitor: Monitor,
}

impl Scale {
    fn new(window: usize) -> Self {
        Self { line: RunningLine::zeroed(window), monitor: Monitor::new() }
    }
}

/// What is particular to one detector; the enum names the state, not the parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Method {
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
    method: Method,
}

impl Detector {
    /// The detector that `p.detector` names.
    pub fn new(p: &Parameters) -> Self {
        let method = match p.detector {
            DetectorKind::Raw => Method::Raw(Monitor::new()),
            DetectorKind::Deviation => Method::Deviation(Monitor::new()),
            DetectorKind::Slope => Method::Slope,
            DetectorKind::MultiSlope => {
                Method::MultiSlope(WINDOWS.map(|time| Scale::new(samples(time, p.sample_period))).into())
            }
            DetectorKind::Cusum => Method::Cusum(Box::new((Innovation::new(p), CumulativeSum::default()))),
            DetectorKind::Glr => Method::Glr(Box::new((Innovation::new(p), OnsetBank::new(p)))),
        };
        Self { slope: Monitor::new(), method }
    }

    /// Longest window of a slope or a correlation, samples.
    pub fn window(p: &Parameters) -> usize {
        let longest = match p.detector {
            DetectorKind::MultiSlope => p.slope_window.max(WINDOWS[3]),
            DetectorKind::Glr => p.slope_window.max(f64::from(p.glr.onsets) * p.sample_period),
            _ => p.slope_window,
        };
        samples(longest, p.sample_period)
    }

    /// Samples until observer and detector have forgotten a bad one.
    pub fn memory(p: &Parameters) -> u32 {
        ticks(forgetting(p), p.sample_period) + Self::window(p) as u32
    }

    /// Samples at constant speed that the detector needs before it may learn.
    pub fn settling(p: &Parameters) -> usize {
        let filters = samples(p.deviation_window, p.sample_period) + Self::window(p);
        match p.detector {
            DetectorKind::Cusum => filters.max(kalman::ITERATIONS as usize),
            DetectorKind::Glr => filters.max(kalman::ITERATIONS as usize + p.glr.onsets as usize),
            _ => filters,
        }
    }

    /// Forgets what was learned; the stage is at rest at `position` m.
    pub fn reset(&mut self, position: f64) {
        self.slope.forget();
        match &mut self.method {
            Method::Raw(monitor) | Method::Deviation(monitor) => monitor.forget(),
            Method::Slope => {}
            Method::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.forget()),
            Method::Cusum(inner) => inner.0.reset(position),
            Method::Glr(inner) => {
                inner.0.reset(position);
                inner.1.reset();
            }
        }
    }

    /// Takes other values of the noise, of the stage and of the delay.
    pub fn renew(&mut self, p: &Parameters) {
        match &mut self.method {
            Method::Cusum(inner) => inner.0 = Innovation::new(p),
            Method::Glr(inner) => inner.0 = Innovation::new(p),
            Method::Raw(_) | Method::Deviation(_) | Method::Slope | Method::MultiSlope(_) => {}
        }
    }

    /// Takes one sample; the force signals of a sample without position are not used.
    pub fn update(&mut self, p: &Parameters, sample: &Sample) {
        match &mut self.method {
            Method::Cusum(inner) => inner.0.update(sample.position, sample.acted, sample.spindle_speed),
            Method::Glr(inner) => {
                inner.0.update(sample.position, sample.acted, sample.spindle_speed);
                inner.1.build(inner.0.filter());
            }
            _ if sample.position.is_none() => return,
            Method::Raw(monitor) => monitor.take(sample.notched),
            Method::Deviation(monitor) => monitor.take(sample.deviation),
            Method::Slope => {}
            Method::MultiSlope(scales) => {
                for Scale { line, monitor } in scales {
                    line.update(sample.deviation);
                    monitor.take(line.slope(p.sample_period));
                }
            }
        }
        self.slope.take(sample.slope);
    }

    /// Learns from the newest sample.
    pub fn learn(&mut self) {
        self.slope.learn();
        match &mut self.method {
            Method::Raw(monitor) | Method::Deviation(monitor) => monitor.learn(),
            Method::Slope => {}
            Method::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.learn()),
            Method::Cusum(inner) => inner.0.learn(),
            Method::Glr(inner) => {
                let (innovation, bank) = &mut **inner;
                innovation.learn();
                bank.learn(innovation.limited());
            }
        }
    }

    /// Whether all filters are in their steady state, so that learning may end.
    pub fn ready(&self) -> bool {
        match &self.method {
            Method::Cusum(inner) => inner.0.filter().settled(),
            Method::Glr(inner) => inner.1.ready(),
            _ => true,
        }
    }

    /// Sets the thresholds from what was learned.
    pub fn arm(&mut self, p: &Parameters) {
        let tests = if let Method::MultiSlope(scales) = &self.method { scales.len() } else { 1 };
        self.slope.arm(p, tests);
        match &mut self.method {
            Method::Raw(monitor) | Method::Deviation(monitor) => monitor.arm(p, tests),
            Method::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.arm(p, tests)),
            Method::Glr(inner) => inner.1.arm(inner.0.sigma(), p.glr.threshold),
            Method::Slope | Method::Cusum(_) => {}
        }
        self.clear();
    }

    /// Forgets what looked like a contact, not what was learned.
    pub fn clear(&mut self) {
        self.slope.clear();
        match &mut self.method {
            Method::Raw(monitor) | Method::Deviation(monitor) => monitor.clear(),
            Method::Slope => {}
            Method::MultiSlope(scales) => scales.iter_mut().for_each(|s| s.monitor.clear()),
            Method::Cusum(inner) => inner.1 = CumulativeSum::default(),
            Method::Glr(inner) => inner.1.clear(),
        }
    }

    /// Learned statistics and threshold of the paper's slope; all zero before they are learned.
    pub fn learned(&self) -> ThresholdOutput {
        self.slope.threshold()
    }

    /// Tests the newest sample; true on contact.
    pub fn test(&mut self, p: &Parameters) -> bool {
        match &mut self.method {
            Method::Raw(monitor) | Method::Deviation(monitor) => monitor.test(p),
            Method::Slope => self.slope.test(p),
            Method::MultiSlope(scales) => scales.iter_mut().any(|s| s.monitor.test(p)),
            // a contact makes the stage lag behind its prediction
            Method::Cusum(inner) => {
                let (innovation, sum) = &mut **inner;
                sum.test(&p.cusum, -innovation.limited() / innovation.sigma())
            }
            Method::Glr(inner) => {
                let (innovation, bank) = &mut **inner;
                bank.update(innovation.limited())
            }
        }
    }

    /// Log-likelihood ratio of a contact in the newest sample that was tested, for the detector that has one.
    pub fn ratio(&self) -> Option<f64> {
        if let Method::Glr(inner) = &self.method { Some(inner.1.ratio()) } else { None }
    }

    /// The name of the detector as source of a contact.
    pub fn source(&self) -> ContactSource {
        match self.method {
            Method::Raw(_) => ContactSource::Raw,
            Method::Deviation(_) => ContactSource::Deviation,
            Method::Slope => ContactSource::Slope,
            Method::MultiSlope(_) => ContactSource::MultiSlope,
            Method::Cusum(_) => ContactSource::Cusum,
            Method::Glr(_) => ContactSource::Glr,
        }
    }
}

#[cfg(test)]
mod tests;
