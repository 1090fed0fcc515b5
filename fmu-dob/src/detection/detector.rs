//! Both detectors in one type: each learns its noise before contact and then tests every sample.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::detection::glr::OnsetBank;
use crate::detection::innovation::Innovation;
use crate::detection::kalman;
use crate::detection::monitor::Monitor;
use crate::force::observer::forgetting;
use crate::interface::{ContactSource, DetectorKind, Parameters, ThresholdOutput};

/// Samples of the shortest window.
const SAMPLES_MIN: u32 = 3;

/// Samples of a window of `time` s.
pub fn samples(time: f64, sample_period: f64) -> usize {
    ticks(time, sample_period).max(SAMPLES_MIN) as usize
}

/// Signals of one sample that the detectors use, in the frame where a contact pushes against the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Encoder position, m; none if it is lost.
    pub position: Option<f64>,
    /// Current that acted since the last sample, A.
    pub acted: f64,
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
    /// Slope of the force over one window, N/s.
    pub slope: f64,
}

/// State of the detector that decides; the slope detector has none of its own.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Method {
    Slope,
    Glr(Box<(Innovation, OnsetBank)>),
}

/// A detector with the slope of the paper, whose statistics are always learned.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Detector {
    slope: Monitor,
    method: Method,
}

impl Detector {
    /// The detector that `p.detector` names.
    pub fn new(p: &Parameters) -> Self {
        let method = match p.detector {
            DetectorKind::Slope => Method::Slope,
            DetectorKind::Glr => Method::Glr(Box::new((Innovation::new(p), OnsetBank::new(p)))),
        };
        Self { slope: Monitor::new(), method }
    }

    /// Longest window of a slope or a correlation, samples.
    pub fn window(p: &Parameters) -> usize {
        let longest = match p.detector {
            DetectorKind::Glr => p.slope_window.max(f64::from(p.glr.onsets) * p.sample_period),
            DetectorKind::Slope => p.slope_window,
        };
        samples(longest, p.sample_period)
    }

    /// Samples until a bad one has no effect on observer and detector.
    pub fn memory(p: &Parameters) -> u32 {
        ticks(forgetting(p), p.sample_period) + Self::window(p) as u32
    }

    /// Samples at constant speed that the detector needs before it may learn.
    pub fn settling(p: &Parameters) -> usize {
        let filters = samples(p.deviation_window, p.sample_period) + Self::window(p);
        match p.detector {
            DetectorKind::Glr => filters.max(kalman::ITERATIONS as usize + p.glr.onsets as usize),
            DetectorKind::Slope => filters,
        }
    }

    /// Discards what was learned; the stage is at rest at `position` m.
    pub fn reset(&mut self, position: f64) {
        self.slope.forget();
        if let Method::Glr(inner) = &mut self.method {
            inner.0.reset(position);
            inner.1.reset();
        }
    }

    /// Takes other values of the noise, of the stage and of the delay.
    pub fn renew(&mut self, p: &Parameters) {
        if let Method::Glr(inner) = &mut self.method {
            inner.0 = Innovation::new(p);
        }
    }

    /// Takes one sample; the slope of a sample without position is not used by the slope detector.
    pub fn update(&mut self, sample: &Sample) {
        match &mut self.method {
            Method::Glr(inner) => {
                inner.0.update(sample.position, sample.acted, sample.spindle_speed);
                inner.1.build(inner.0.filter());
            }
            Method::Slope if sample.position.is_none() => return,
            Method::Slope => {}
        }
        self.slope.take(sample.slope);
    }

    /// Learns from the newest sample.
    pub fn learn(&mut self) {
        self.slope.learn();
        if let Method::Glr(inner) = &mut self.method {
            let (innovation, bank) = &mut **inner;
            innovation.learn();
            bank.learn(innovation.limited());
        }
    }

    /// Whether all filters are in their steady state, so that learning may end.
    pub fn ready(&self) -> bool {
        match &self.method {
            Method::Glr(inner) => inner.1.ready(),
            Method::Slope => true,
        }
    }

    /// Sets the thresholds from what was learned.
    pub fn arm(&mut self, p: &Parameters) {
        self.slope.arm(p);
        if let Method::Glr(inner) = &mut self.method {
            inner.1.arm(inner.0.sigma(), p.glr.threshold);
        }
        self.clear();
    }

    /// Discards the evidence for a contact, not the learned noise.
    pub fn clear(&mut self) {
        self.slope.clear();
        if let Method::Glr(inner) = &mut self.method {
            inner.1.clear();
        }
    }

    /// Learned statistics and threshold of the slope; all zero before they are learned.
    pub fn learned(&self) -> ThresholdOutput {
        self.slope.threshold()
    }

    /// Tests the newest sample; true on contact.
    pub fn test(&mut self) -> bool {
        match &mut self.method {
            Method::Slope => self.slope.test(),
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
            Method::Slope => ContactSource::Slope,
            Method::Glr(_) => ContactSource::Glr,
        }
    }
}

#[cfg(test)]
mod tests;
