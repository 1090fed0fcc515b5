//! Processing of a value between the plant and the controller.

/// Scale, offset, quantum and limits of a wire; quantum and limits act on the plant's side.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// true for a measurement, false for a command
    pub from_plant: bool,
    /// `to = scale * from + offset`
    pub scale: f64,
    /// see `scale`
    pub offset: f64,
    /// resolution, 0 for none
    pub quantum: f64,
    /// lower limit
    pub minimum: f64,
    /// upper limit
    pub maximum: f64,
}

impl Shape {
    /// Output value of the wire, from the input value and the noise of this step.
    ///
    /// # Errors
    /// The value on the plant's side, when it is not finite.
    pub fn apply(&self, value: f64, noise: Option<f64>) -> Result<f64, f64> {
        if self.from_plant {
            Ok(self.scale * self.disturb(value, noise)? + self.offset)
        } else {
            self.disturb(self.scale * value + self.offset, noise)
        }
    }

    fn disturb(&self, value: f64, noise: Option<f64>) -> Result<f64, f64> {
        let mut value = noise.map_or(value, |noise| value + noise);
        // before the clamp, which would hide a value that is not finite
        if !value.is_finite() {
            return Err(value);
        }
        let quanta = value / self.quantum;
        // more quanta than there are numbers: finer than the value itself
        if self.quantum > 0.0 && quanta.is_finite() {
            value = quanta.round_ties_even() * self.quantum;
        }
        // the value itself where it equals a limit: a zero keeps its sign
        let value = if self.minimum > value { self.minimum } else { value };
        Ok(if self.maximum < value { self.maximum } else { value })
    }
}

/// Ring buffer that returns the value of some steps before; at first the first value.
#[derive(Clone, Debug)]
pub struct Delay {
    ring: Vec<f64>,
    primed: bool,
}

impl Delay {
    /// A delay of `steps` steps; `ring` holds that many values, or none if the first value fills it.
    pub fn new(steps: usize, mut ring: Vec<f64>) -> Self {
        let primed = !ring.is_empty();
        ring.resize(steps, 0.0);
        Self { ring, primed }
    }

    /// Stores the value of step `k` and returns the one of `steps` steps before.
    pub fn pass(&mut self, value: f64, k: usize) -> f64 {
        if self.ring.is_empty() {
            return value;
        }
        if !self.primed {
            self.ring.fill(value);
            self.primed = true;
        }
        let slot = k % self.ring.len();
        std::mem::replace(&mut self.ring[slot], value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Shape = Shape {
        from_plant: true,
        scale: 1.0,
        offset: 0.0,
        quantum: 0.0,
        minimum: f64::NEG_INFINITY,
        maximum: f64::INFINITY,
    };

    #[test]
    fn quantum_and_limits_act_on_the_side_of_the_plant() {
        let shape = Shape { scale: 10.0, offset: 1.0, quantum: 0.5, minimum: -1.0, maximum: 1.0, ..PLAIN };
        assert_eq!(shape.apply(0.6, None), Ok(6.0));
        assert_eq!(shape.apply(0.6, Some(7.0)), Ok(11.0));
        let command = Shape { from_plant: false, ..shape };
        assert_eq!(command.apply(0.0, None), Ok(1.0));
        assert_eq!(command.apply(-0.04, None), Ok(0.5));
    }

    #[test]
    fn quanta_round_half_to_even() {
        let shape = Shape { quantum: 1.0, ..PLAIN };
        assert_eq!([0.5, 1.5, 2.5, -0.5].map(|value| shape.apply(value, None)), [Ok(0.0), Ok(2.0), Ok(2.0), Ok(-0.0)]);
    }

    #[test]
    fn a_quantum_finer_than_any_value_changes_none() {
        let shape = Shape { quantum: f64::MIN_POSITIVE, ..PLAIN };
        assert_eq!([0.5, -1e300, 0.0].map(|value| shape.apply(value, None)), [Ok(0.5), Ok(-1e300), Ok(0.0)]);
    }

    #[test]
    fn limits_do_not_hide_what_is_not_finite() {
        let shape = Shape { minimum: 0.0, maximum: 1.0, ..PLAIN };
        assert_eq!(shape.apply(f64::INFINITY, None), Err(f64::INFINITY));
        assert!(shape.apply(1.0, Some(f64::NAN)).is_err_and(f64::is_nan));
    }

    #[test]
    fn a_zero_keeps_its_sign_at_a_limit() {
        let shape = Shape { offset: -0.0, minimum: 0.0, maximum: 0.0, ..PLAIN };
        assert!(shape.apply(-0.0, None).is_ok_and(f64::is_sign_negative));
    }

    #[test]
    fn a_delay_starts_with_its_ring_or_with_the_first_value() {
        let pass = |mut delay: Delay| [1.0, 2.0, 3.0, 4.0].iter().enumerate().map(|(k, x)| delay.pass(*x, k)).collect();
        let values: [Vec<f64>; 3] =
            [pass(Delay::new(0, vec![])), pass(Delay::new(2, vec![])), pass(Delay::new(2, vec![9.0, 9.0]))];
        assert_eq!(values, [vec![1.0, 2.0, 3.0, 4.0], vec![1.0, 1.0, 1.0, 2.0], vec![9.0, 9.0, 1.0, 2.0]]);
    }
}
