//! Replaces an implausible measurement by the last good one.

use serde::{Deserialize, Serialize};

/// Stores the last good value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LastGood<T>(T);

impl<T: Clone> LastGood<T> {
    /// With the value before the first good one.
    pub const fn new(value: T) -> Self {
        Self(value)
    }

    /// The last good value.
    pub fn get(&self) -> &T {
        &self.0
    }

    /// The value to use in this sample, `now` if it is good; and whether it is.
    pub fn update(&mut self, now: T, good: bool) -> (T, bool) {
        if good {
            self.0 = now;
        }
        (self.0.clone(), good)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_value_is_never_used() {
        let mut value = LastGood::new(1.0);
        assert_eq!(value.update(f64::NAN, false), (1.0, false));
        assert_eq!(value.update(2.0, true), (2.0, true));
        assert_eq!((value.update(3.0, false), *value.get()), ((2.0, false), 2.0));
    }
}
