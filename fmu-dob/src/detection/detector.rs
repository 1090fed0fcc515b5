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
            Method::Glr(inner) => inner.1.arm(inner.0.sigma()),
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
                bank.update(innovation.limited()) > p.glr.threshold
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
mod tests {
    use super::*;

    /// Signal that is quiet noise while learning, then `level`.
    fn ticks_to_detect(p: &Parameters, level: f64) -> Option<usize> {
        let mut detector = Detector::new(p);
        let sample = |slope| Sample { position: Some(0.0), slope, ..Sample::default() };
        for k in 0..1000 {
            detector.update(p, &sample((f64::from(k) * 1.3).sin()));
            detector.learn();
        }
        detector.arm(p);
        (1..100).find(|_| {
            detector.update(p, &sample(level));
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
    fn four_windows_share_the_wished_interval() {
        let p = Parameters { detector: DetectorKind::MultiSlope, ..Parameters::START };
        let mut detector = Detector::new(&p);
        for k in 0..1000 {
            detector
                .update(&p, &Sample { position: Some(0.0), slope: (f64::from(k) * 1.3).sin(), ..Sample::default() });
            detector.learn();
        }
        detector.arm(&p);
        let ThresholdOutput { crossing_rate, alpha_used, .. } = detector.learned();
        assert!((alpha_used - (2.0 * (crossing_rate * 36_000.0 * 4.0).ln()).sqrt()).abs() < 1e-12, "{alpha_used}");
    }

    #[test]
    fn what_looked_like_a_contact_before_is_forgotten() {
        for &detector in &[DetectorKind::Raw, DetectorKind::Deviation, DetectorKind::Slope, DetectorKind::MultiSlope] {
            let p = Parameters { detector, ..Parameters::START };
            let sample =
                |x: f64| Sample { position: Some(0.0), notched: x, deviation: x, slope: x, ..Sample::default() };
            let learn = |detector: &mut Detector| {
                for k in 0..1300 {
                    detector.update(&p, &sample((f64::from(k) * 1.3).sin()));
                    if k >= 300 {
                        detector.learn();
                    }
                }
                detector.arm(&p);
            };
            let contact = |detector: &mut Detector| {
                (1..100).find(|k| {
                    detector.update(&p, &sample(1e3 * f64::from(*k)));
                    detector.test(&p)
                })
            };
            let mut fresh = Detector::new(&p);
            learn(&mut fresh);
            let mut old = fresh.clone();
            let samples = contact(&mut fresh.clone());
            assert!(samples.is_some_and(|k| k < 5), "{detector:?}: {samples:?}");
            assert_eq!(contact(&mut old), samples);
            // learned again, or doubted
            old.reset(0.0);
            assert_eq!(old.learned(), ThresholdOutput::START);
            learn(&mut old);
            assert_eq!(old.learned(), fresh.learned());
            assert_eq!(contact(&mut old), samples);
            old.clear();
            let rows = (1..5).map(|_| old.test(&p)).collect::<Vec<_>>();
            assert_eq!(rows, [false, false, true, true], "{detector:?}");
        }
    }

    #[test]
    fn windows_and_memories_are_those_of_the_times() {
        let with = |detector| Parameters { detector, ..Parameters::START };
        let multi = with(DetectorKind::MultiSlope);
        // 20 ms of the longest window, 100 ms of the mean, 9.55 ms of the observer
        assert_eq!([Detector::window(&multi), Detector::settling(&multi)], [200, 1200]);
        assert_eq!(Detector::memory(&multi), 296);
        let slope = with(DetectorKind::Slope);
        assert_eq!([Detector::window(&slope), Detector::settling(&slope)], [50, 1050]);
        assert_eq!(Detector::settling(&with(DetectorKind::Cusum)), 2000);
        let glr = with(DetectorKind::Glr);
        assert_eq!([Detector::window(&glr), Detector::settling(&glr)], [300, 2300]);
        assert_eq!(samples(1e-4, 1e-4), 3);
    }

    #[test]
    fn a_detector_with_other_values_predicts_as_a_new_one() {
        for kind in [DetectorKind::Cusum, DetectorKind::Glr] {
            let p = Parameters { detector: kind, ..Parameters::START };
            let mut other = p.clone();
            other.stage.force_constant *= 1.3;
            let sigma = |mut detector: Detector| {
                for k in 0..3000 {
                    let acted = 0.1 * (f64::from(k) * 0.05).sin();
                    detector.update(&other, &Sample { position: Some(0.0), acted, ..Sample::default() });
                    detector.learn();
                }
                match detector.method {
                    Method::Cusum(inner) => inner.0.sigma(),
                    Method::Glr(inner) => inner.0.sigma(),
                    _ => unreachable!("{kind:?}"),
                }
            };
            let (old, new) = (Detector::new(&p), Detector::new(&other));
            let mut renewed = old.clone();
            renewed.renew(&other);
            assert!(sigma(old) < 0.9 * sigma(new.clone()), "{kind:?}");
            assert_eq!(sigma(renewed), sigma(new), "{kind:?}");
        }
    }

    #[test]
    fn each_detector_names_itself() {
        for &detector in DetectorKind::ALL {
            let source = Detector::new(&Parameters { detector, ..Parameters::START }).source();
            assert_eq!(format!("{source:?}"), format!("{detector:?}"));
        }
    }

    #[test]
    fn an_innovation_tells_a_push_and_neither_noise_nor_one_bad_sample() {
        for kind in [DetectorKind::Cusum, DetectorKind::Glr] {
            let p = Parameters { detector: kind, ..Parameters::START };
            let mut detector = Detector::new(&p);
            detector.reset(0.0);
            let noise = |k: u32| 1e-9 * (f64::from(k) * 12.9898).sin();
            let sample = |z: f64| Sample { position: Some(z), ..Sample::default() };
            let settling = Detector::settling(&p) as u32;
            for k in 0..settling {
                assert!(k + 1 == settling || !detector.ready(), "{kind:?} {k}");
                detector.update(&p, &sample(noise(k)));
            }
            assert!(detector.ready(), "{kind:?}");
            for k in settling..settling + 3000 {
                detector.update(&p, &sample(noise(k)));
                detector.learn();
            }
            detector.arm(&p);
            let told = |push: &dyn Fn(u32) -> f64| {
                let mut detector = detector.clone();
                (0..300).find(|k| {
                    detector.update(&p, &sample(noise(settling + 3000 + k) + push(*k)));
                    detector.test(&p)
                })
            };
            assert_eq!(told(&|_| 0.0), None, "{kind:?}");
            assert_eq!(told(&|k| if k == 100 { -8e-9 } else { 0.0 }), None, "{kind:?}");
            // 1 N on 10 kg, away from the work
            let pushed = told(&|k| -0.05 * (f64::from(k) * p.sample_period).powi(2));
            assert!(pushed.is_some_and(|k| (3..60).contains(&k)), "{kind:?} {pushed:?}");
        }
    }
}
