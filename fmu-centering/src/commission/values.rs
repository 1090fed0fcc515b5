//! The parameters that a commission derives, and whether what it has measured can be used.

use control_blocks::DELAY_MAX;
use serde::{Deserialize, Serialize};

use crate::interface::{Measured, Parameters};
use crate::limits::slowest_servo;

/// Ratio of the bandwidth over that of what was told, that is still the machine that was meant; or its reciprocal (our choice).
const RATIO_MAX: f64 = 2.0;

/// All parameters that a commission derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    bandwidth: f64,
    io_delay: i32,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self { bandwidth: p.slide.bandwidth, io_delay: p.io_delay }
    }

    /// Puts them into the parameters.
    pub fn put(&self, p: &mut Parameters) {
        (p.slide.bandwidth, p.io_delay) = (self.bandwidth, self.io_delay);
    }

    /// Their names and values.
    pub fn entries(&self) -> [(&'static str, f64); 2] {
        [("slide.bandwidth", self.bandwidth), ("io_delay", f64::from(self.io_delay))]
    }

    /// Those with what was measured; who told no bandwidth, for no feed-forward, gets none.
    pub fn with(self, measured: &Measured) -> Self {
        let bandwidth = if self.bandwidth > 0.0 { measured.slide_bandwidth } else { 0.0 };
        Self { bandwidth, io_delay: measured.io_delay.round() as i32 }
    }

    /// Whether a measurement is sure enough, and of a servo that this controller can work with; `shift` (samples) is what its
    /// last round has found of the delay that the round before had not.
    pub fn accept(&self, p: &Parameters, m: &Measured, shift: f64) -> bool {
        let ratio = m.slide_bandwidth / self.bandwidth;
        m.slide_bandwidth_deviation <= p.commission.deviation_max * m.slide_bandwidth
            && m.io_delay_deviation.max(shift.abs()) <= p.commission.delay_deviation_max
            && m.slide_bandwidth >= slowest_servo(p)
            && (self.bandwidth == 0.0 || (RATIO_MAX.recip()..=RATIO_MAX).contains(&ratio))
            && (-0.5..DELAY_MAX as f64 + 0.5).contains(&m.io_delay)
    }
}
