//! The parameters that a commission derives, and how.

use control_blocks::DELAY_MAX;
use serde::{Deserialize, Serialize};

use crate::commission::plan::{DELAY_SPREAD, FLEXURE_MAX, RATIO_MAX};
use crate::interface::{Measured, Parameters, Servo, Tip};
use crate::servo::nominal::Nominal;

/// A friction counts when it is this many of its standard deviations.
const SIGNIFICANT: f64 = 3.0;

/// All parameters that a commission derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// The machine of the loop with them.
    pub nominal: Nominal,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self { nominal: p.into() }
    }

    /// Puts them into the parameters.
    pub fn put(&self, p: &mut Parameters) {
        (p.servo, p.tip, p.io_delay) = (self.nominal.servo, self.nominal.tip, self.nominal.io_delay);
    }

    /// Their names and values.
    pub fn entries(&self) -> [(&'static str, f64); 8] {
        let Nominal { servo, tip, io_delay, .. } = &self.nominal;
        [
            ("servo.bandwidth", servo.bandwidth),
            ("servo.inertia", servo.inertia),
            ("servo.viscous_friction", servo.viscous_friction),
            ("servo.dry_friction", servo.dry_friction),
            ("io_delay", f64::from(*io_delay)),
            ("tip.frequency", tip.frequency),
            ("tip.inertia", tip.inertia),
            ("tip.damping", tip.damping),
        ]
    }

    /// Those with the arm that was measured; friction that is not significant stays as it is.
    pub fn with_arm(self, m: &Measured) -> Self {
        let known = |value: f64, deviation: f64, old: f64| if value > SIGNIFICANT * deviation { value } else { old };
        let Nominal { servo, sample_period, .. } = self.nominal;
        let servo = Servo {
            inertia: m.inertia,
            viscous_friction: known(m.viscous_friction, m.viscous_friction_deviation, servo.viscous_friction),
            dry_friction: known(m.dry_friction, m.dry_friction_deviation, servo.dry_friction),
            ..servo
        };
        let tip = Tip {
            frequency: m.tip_frequency,
            inertia: m.tip_inertia.clamp(0.0, 0.95),
            damping: m.tip_damping.clamp(0.0, 0.5),
            ..self.nominal.tip
        };
        Self { nominal: Nominal { servo, tip, io_delay: m.io_delay.round().max(0.0) as i32, sample_period } }
    }
}

/// Whether an arm was measured surely enough, and is one of those that the commission is for; `told` is the machine that it took
/// for it.
pub fn acceptable(p: &Parameters, told: &Nominal, m: &Measured) -> bool {
    let within = |value: f64, told: f64, factor: f64| value * factor >= told && value <= factor * told;
    let sure = |value: f64, deviation: f64| deviation <= p.commission.deviation_max * value.abs();
    let longest = f64::from((told.io_delay + DELAY_SPREAD).min(DELAY_MAX as i32));
    within(m.inertia, told.servo.inertia, RATIO_MAX)
        && sure(m.inertia, m.inertia_deviation)
        && within(m.tip_frequency, told.tip.frequency, FLEXURE_MAX)
        && sure(m.tip_frequency, m.tip_frequency_deviation)
        && (-0.5..longest + 0.5).contains(&m.io_delay)
        && m.io_delay_deviation <= p.commission.delay_deviation_max
}
