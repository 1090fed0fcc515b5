//! Depth of the tool if the touch is detected immediately.

use control_blocks::stopping_distance;

use crate::interface::Parameters;

/// Minimum travel (m) between touch and standstill: v (1.5 + io_delay) T_s + v^2 / (2 a_stop).
///
/// Half a sample of waiting, one of hold and the delay of the current, then braking; noise adds to it.
pub fn depth_limit(p: &Parameters) -> f64 {
    let delay = (1.5 + f64::from(p.io_delay)) * p.sample_period;
    let v = p.approach.velocity;
    v * delay + stopping_distance(v, p.retract.deceleration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_limit_of_the_defaults() {
        // 100 um/s: 25 nm of delay and 2.5 nm of braking
        assert!((depth_limit(&Parameters::START) - 27.5e-9).abs() < 1e-15);
    }
}
