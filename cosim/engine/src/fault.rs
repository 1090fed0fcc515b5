//! Effect of an injection on an arriving value.

use crate::wire::Delay;

/// Effect of an injection on an arriving value.
#[derive(Clone, Debug)]
pub enum FaultEffect {
    /// the value is this number
    Value(f64),
    /// the value of the first step is held
    Frozen(f64),
    /// this is added
    Offset(f64),
    /// the value is multiplied
    Scale(f64),
    /// this is added for each step since the first
    Ramp(f64),
    /// the number of the step is added
    Noise,
    /// if the number of the step is not 0, the sample is lost and the last one is held
    Drop(f64),
    /// if the number of the step is not 0, the Boolean is false
    Lose,
    /// the value is delayed
    Late(Delay),
}

impl FaultEffect {
    /// Changed value in step `k`, `since` steps after the first; `sample` is the number of the step.
    ///
    /// Before the first step `since` is negative: the value is only observed, the return value unused.
    pub(super) fn apply(&mut self, value: f64, k: usize, since: f64, sample: f64) -> f64 {
        let lost = since >= 0.0 && sample != 0.0;
        match self {
            Self::Value(number) => *number,
            Self::Frozen(held) => hold(held, value, since > 0.0),
            Self::Offset(number) => value + *number,
            Self::Scale(number) => value * *number,
            Self::Ramp(number) => value + *number * since,
            Self::Noise => value + sample,
            Self::Drop(held) => hold(held, value, lost),
            Self::Lose => hold(&mut 0.0, value, lost),
            Self::Late(delay) => delay.pass(value, k),
        }
    }
}

/// The held value, which is the new one unless that is lost.
fn hold(held: &mut f64, value: f64, lost: bool) -> f64 {
    if !lost {
        *held = value;
    }
    *held
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_does_what_it_says() {
        // the second step is the first of the injection; samples are lost in it and in the last
        let steps = [(1.0, -1.0, 0.0), (2.0, 0.0, 1.0), (4.0, 1.0, 0.0), (8.0, 2.0, 1.0)];
        for (mut change, expected) in [
            (FaultEffect::Value(0.5), [0.5, 0.5, 0.5]),
            (FaultEffect::Frozen(0.0), [2.0, 2.0, 2.0]),
            (FaultEffect::Offset(0.5), [2.5, 4.5, 8.5]),
            (FaultEffect::Scale(-1.0), [-2.0, -4.0, -8.0]),
            (FaultEffect::Ramp(0.5), [2.0, 4.5, 9.0]),
            (FaultEffect::Noise, [3.0, 4.0, 9.0]),
            (FaultEffect::Drop(0.0), [1.0, 4.0, 4.0]),
            (FaultEffect::Lose, [0.0, 4.0, 0.0]),
            (FaultEffect::Late(Delay::new(1, vec![])), [1.0, 2.0, 4.0]),
        ] {
            let found: Vec<f64> = steps
                .iter()
                .enumerate()
                .map(|(k, (value, since, sample))| change.apply(*value, k, *since, *sample))
                .collect();
            assert_eq!(found[1..], expected, "{change:?}");
        }
    }
}
