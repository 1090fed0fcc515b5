//! The parameters that a commissioning run derives.

use control_blocks::{DELAY_MAX, DELAY_SPREAD, RATIO_MAX, is_certain, significant_or, whole_delay, within_factor};
use serde::{Deserialize, Serialize};

use crate::commission::plan::FLEXURE_MAX;
use crate::interface::{Measured, Parameters, Servo, Tip};
use crate::servo::nominal::Nominal;

/// All parameters that a commissioning run derives.
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
            ("expert.servo.viscous_friction", servo.viscous_friction),
            ("expert.servo.dry_friction", servo.dry_friction),
            ("io_delay", f64::from(*io_delay)),
            ("tip.frequency", tip.frequency),
            ("expert.tip.inertia", tip.inertia),
            ("expert.tip.damping", tip.damping),
        ]
    }

    /// Those with the arm that was measured; friction that is not significant stays as it is.
    pub fn derived(self, m: &Measured) -> Self {
        let Nominal { servo, .. } = self.nominal;
        let servo = Servo {
            inertia: m.inertia,
            viscous_friction: significant_or(m.viscous_friction, m.viscous_friction_std, servo.viscous_friction),
            dry_friction: significant_or(m.dry_friction, m.dry_friction_std, servo.dry_friction),
            ..servo
        };
        let tip = Tip {
            frequency: m.tip_frequency,
            inertia: m.tip_inertia.clamp(0.0, 0.95),
            damping: m.tip_damping.clamp(0.0, 0.5),
            ..self.nominal.tip
        };
        Self { nominal: Nominal { servo, tip, io_delay: whole_delay(m.io_delay), ..self.nominal } }
    }
}

/// Longest delay (samples) that a commissioning run tolerates for the nominal machine `nominal`.
pub fn longest_delay(nominal: &Nominal) -> i32 {
    (nominal.io_delay + DELAY_SPREAD).min(DELAY_MAX as i32 - nominal.arm_delay)
}

/// Whether the result is certain enough and within the class of machines; `nominal` is the nominal machine that it
/// for it.
pub fn acceptable(p: &Parameters, nominal: &Nominal, m: &Measured) -> bool {
    let std_max = p.commission.std_max;
    within_factor(m.inertia, nominal.servo.inertia, RATIO_MAX)
        && is_certain(m.inertia, m.inertia_std, std_max)
        && within_factor(m.tip_frequency, nominal.tip.frequency, FLEXURE_MAX)
        && is_certain(m.tip_frequency, m.tip_frequency_std, std_max)
        && (0..=longest_delay(nominal)).contains(&whole_delay(m.io_delay))
        && m.io_delay_std <= p.commission.delay_std_max
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A good measurement of an arm a fifth heavier than nominal.
    const GOOD: Measured = Measured {
        valid: true,
        inertia: 9.6e-4,
        inertia_std: 1e-6,
        viscous_friction: 3e-3,
        viscous_friction_std: 2e-3,
        dry_friction: 0.012,
        dry_friction_std: 1e-3,
        io_delay: 1.7,
        io_delay_std: 0.02,
        tip_frequency: 7000.0,
        tip_frequency_std: 10.0,
        tip_inertia: 0.4,
        tip_inertia_std: 0.01,
        tip_damping: -1e-3,
        tip_damping_std: 2e-3,
    };

    #[test]
    fn what_is_put_is_what_was_taken() {
        let mut p = Parameters::START;
        let nominal = Values::of(&p);
        nominal.put(&mut p);
        assert_eq!(p, Parameters::START);
        let values = nominal.derived(&GOOD);
        values.put(&mut p);
        assert_eq!(Values::of(&p), values);
        // the viscous friction is not significant, and no damping is negative
        assert_eq!((p.servo.viscous_friction, p.servo.dry_friction, p.servo.inertia), (2e-3, 0.012, 9.6e-4));
        assert_eq!((p.io_delay, p.tip.frequency, p.tip.inertia, p.tip.damping), (2, 7000.0, 0.4, 0.0));
        assert_eq!((p.servo.bandwidth, p.servo.torque_max), (Parameters::START.servo.bandwidth, 7.0));
        let entries = values.entries();
        assert!(entries.contains(&("servo.inertia", 9.6e-4)) && entries.contains(&("io_delay", 2.0)));
        // nothing acts before it is sent
        assert_eq!(nominal.derived(&Measured { io_delay: -0.4, ..GOOD }).nominal.io_delay, 0);
    }

    #[test]
    fn each_limit_is_the_last_value_that_is_accepted() {
        let (p, nominal) = (Parameters::START, Nominal::from(&Parameters::START));
        type Set = fn(&mut Measured, f64);
        let with = |set: Set, x: f64| {
            let mut m = GOOD;
            set(&mut m, x);
            acceptable(&p, &nominal, &m)
        };
        let limits: [(Set, f64, f64); 9] = [
            (|m, x| m.inertia_std = x, 1.92e-5, 1.93e-5),
            (|m, x| m.inertia = x, 1.599e-3, 1.601e-3),
            (|m, x| m.inertia = x, 4.001e-4, 3.999e-4),
            (|m, x| m.tip_frequency_std = x, 140.0, 141.0),
            (|m, x| m.tip_frequency = x, 10_781.0, 10_783.0),
            (|m, x| m.tip_frequency = x, 5273.0, 5272.0),
            (|m, x| m.io_delay = x, 3.49, 3.5),
            (|m, x| m.io_delay = x, -0.49, -0.5),
            (|m, x| m.io_delay_std = x, 0.25, 0.251),
        ];
        for (i, (set, last, first)) in limits.into_iter().enumerate() {
            assert_eq!((with(set, last), with(set, first)), (true, false), "{i}");
        }
        assert!(!acceptable(&p, &nominal, &Measured::START));
    }
}
