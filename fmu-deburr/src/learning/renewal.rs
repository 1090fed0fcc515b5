//! Renewal of a pattern by a learning law, from the pattern and its control errors.

use serde::{Deserialize, Serialize};

use crate::interface::{LearningLaw, Parameters};
use crate::learning::nominal::Nominal;
use crate::learning::norm_optimal::{Work, solve};
use crate::learning::pattern::Pattern;
use crate::learning::zero_phase::{PAD, ZeroPhase};
use crate::path::kinematics::{AXES, Joints};

/// The learning law with its data of the machine, and its memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Renewal {
    filter: ZeroPhase,
    nominal: [Nominal; AXES],
    values: Vec<f64>,
    room: [Vec<f64>; 3],
}

impl Parameters {
    /// By how many samples the learning looks ahead: `expert.learn.lead` beyond `io_delay`.
    pub(crate) fn shift(&self) -> usize {
        (self.learn.lead + self.io_delay).max(0) as usize
    }
}

impl Renewal {
    /// With memory for patterns of up to `samples` samples.
    pub fn new(p: &Parameters, samples: usize) -> Self {
        Self {
            filter: ZeroPhase::new(p.learn.bandwidth, p.sample_period),
            nominal: std::array::from_fn(|axis| Nominal::new(p, axis)),
            values: vec![0.0; samples],
            room: [(); 3].map(|()| vec![0.0; samples + 2 * PAD]),
        }
    }

    /// The drives are those as configured now.
    pub fn configure(&mut self, p: &Parameters) {
        self.nominal = std::array::from_fn(|axis| Nominal::new(p, axis));
    }

    /// Renews a pattern by the control errors (pulses) of the repetition with it.
    pub fn renew(&mut self, p: &Parameters, errors: &[Joints], pattern: &mut Pattern) {
        (0..AXES).for_each(|axis| self.renew_axis(p, axis, errors, pattern));
    }

    fn renew_axis(&mut self, p: &Parameters, axis: usize, errors: &[Joints], pattern: &mut Pattern) {
        let count = pattern.len();
        for k in 0..count {
            let ahead = ahead(k, p.shift(), count, pattern.cyclic);
            let (now, later) = (errors[k][axis], errors[ahead][axis]);
            let compensation = pattern.samples[k].compensation[axis];
            self.values[k] = match p.learn.law {
                LearningLaw::Plain | LearningLaw::LeadFilter => compensation + later,
                LearningLaw::NormOptimal => now,
            };
        }
        self.transform(p, count, axis, pattern.cyclic);
        for (sample, value) in pattern.samples.iter_mut().zip(&self.values) {
            let compensation = &mut sample.compensation[axis];
            *compensation = if p.learn.law == LearningLaw::NormOptimal { *compensation + value } else { *value };
        }
    }

    /// Applies the learning law to `values` of one axis. `LeadFilter` filters the renewed pattern, `NormOptimal`
    /// replaces the errors by the change of the pattern, `Plain` changes nothing.
    fn transform(&mut self, p: &Parameters, count: usize, axis: usize, cyclic: bool) {
        let values = &mut self.values[..count];
        let [a, b, c] = &mut self.room;
        match p.learn.law {
            LearningLaw::Plain => {}
            LearningLaw::LeadFilter => self.filter.filter(values, a, cyclic),
            LearningLaw::NormOptimal => {
                let mut work = Work { residual: &mut a[..count], direction: &mut b[..count], product: &mut c[..count] };
                solve(&self.nominal[axis], p.learn.weight, values, &mut work);
            }
        }
    }
}

/// Number of the sample `shift` later: in the next lap, or the last one.
fn ahead(k: usize, shift: usize, count: usize, cyclic: bool) -> usize {
    if cyclic { (k + shift) % count } else { (k + shift).min(count - 1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;

    /// Parameters with a learning law and its lead.
    fn law(law: LearningLaw, lead: i32) -> Parameters {
        let mut p = Parameters::START;
        (p.learn.law, p.learn.lead, p.io_delay) = (law, lead, 0);
        p
    }

    fn setup(p: &Parameters) -> (Renewal, Pattern) {
        let pattern = Pattern::plan(p, &straight(0.05), 1.0).unwrap();
        (Renewal::new(p, pattern.len()), pattern)
    }

    fn errors(pattern: &Pattern, error: impl Fn(usize) -> f64) -> Vec<Joints> {
        (0..pattern.len()).map(|k| [error(k); AXES]).collect()
    }

    #[test]
    fn plain_is_pattern_plus_error_in_whole_pulses() {
        let p = law(LearningLaw::Plain, 0);
        let (mut renewal, mut pattern) = setup(&p);
        let left = errors(&pattern, |k| k as f64);
        (0..2).for_each(|_| renewal.renew(&p, &left, &mut pattern));
        for (k, sample) in pattern.samples.iter().enumerate() {
            assert_eq!(sample.compensation, [2.0 * k as f64; AXES]);
        }
    }

    #[test]
    fn the_lead_reads_the_error_ahead_and_the_end_stays() {
        let mut p = law(LearningLaw::Plain, 2);
        p.io_delay = 1;
        let (mut renewal, mut pattern) = setup(&p);
        let left = errors(&pattern, |k| k as f64);
        renewal.renew(&p, &left, &mut pattern);
        let last = pattern.len() - 1;
        assert_eq!(pattern.samples[5].compensation[0], 8.0);
        assert_eq!(pattern.samples[last].compensation[0], last as f64);
    }

    #[test]
    fn with_the_filter_the_renewed_pattern_is_smooth_and_with_the_model_it_is_the_solution() {
        let step = |k: usize| if k < 30 { 0.0 } else { 100.0 };
        for kind in [LearningLaw::LeadFilter, LearningLaw::NormOptimal] {
            let p = law(kind, 0);
            let (mut renewal, mut pattern) = setup(&p);
            let count = pattern.len();
            let left = errors(&pattern, step);
            renewal.renew(&p, &left, &mut pattern);
            let mut expected: Vec<f64> = (0..count).map(step).collect();
            let [mut a, mut b, mut c] = [(); 3].map(|()| vec![0.0; count + 2 * PAD]);
            if kind == LearningLaw::LeadFilter {
                ZeroPhase::new(p.learn.bandwidth, p.sample_period).filter(&mut expected, &mut a, false);
            } else {
                let mut work = Work { residual: &mut a[..count], direction: &mut b[..count], product: &mut c[..count] };
                solve(&Nominal::new(&p, 4), p.learn.weight, &mut expected, &mut work);
            }
            for (sample, value) in pattern.samples.iter().zip(&expected) {
                assert!((sample.compensation[4] - value).abs() < 1e-9, "{kind:?}");
            }
            // a second one adds to it
            let left = errors(&pattern, |_| 0.0);
            renewal.renew(&p, &left, &mut pattern);
            if kind == LearningLaw::NormOptimal {
                assert!((pattern.samples[40].compensation[4] - expected[40]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_sample_ahead_is_in_the_next_lap_or_the_last_one() {
        for (k, cyclic, expected) in [(5, true, 8), (8, true, 1), (5, false, 8), (8, false, 9), (0, true, 3)] {
            assert_eq!(ahead(k, 3, 10, cyclic), expected, "{k} {cyclic}");
        }
    }
}
