//! Where a value is read or written, with the conversion between numbers and the types of FMI.

use std::ptr::NonNull;

/// Address of one value.
#[derive(Clone, Copy, Debug)]
pub enum Slot {
    /// a number
    Real(NonNull<f64>),
    /// an integer or an enumeration
    Integer(NonNull<i32>),
    /// 0 or 1
    Boolean(NonNull<i32>),
}

impl Slot {
    /// The value as a number.
    ///
    /// # Safety
    /// The memory can be read.
    pub unsafe fn read(self) -> f64 {
        // SAFETY: by the contract of this function.
        unsafe {
            match self {
                Self::Real(place) => place.read(),
                Self::Integer(place) | Self::Boolean(place) => f64::from(place.read()),
            }
        }
    }

    /// Writes a number: rounded half to even for integers, anything but 0 is true.
    ///
    /// # Errors
    /// The value, when it does not fit into an integer of 32 bits.
    ///
    /// # Safety
    /// The memory can be written.
    pub unsafe fn write(self, value: f64) -> Result<(), f64> {
        // SAFETY: by the contract of this function.
        unsafe {
            match self {
                Self::Real(place) => place.write(value),
                Self::Integer(place) => place.write(whole(value).ok_or(value)?),
                Self::Boolean(place) => place.write(i32::from(value != 0.0)),
            }
        }
        Ok(())
    }
}

/// Integer of a number, if it takes no more than 32 bits.
fn whole(value: f64) -> Option<i32> {
    let rounded = value.round_ties_even();
    // NaN, too, is no integer
    #[allow(clippy::cast_possible_truncation)]
    (rounded.abs() < 2_147_483_648.0).then_some(rounded as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_round_half_to_even_and_refuse_what_does_not_fit() {
        let mut memory = 7;
        let slot = Slot::Integer(NonNull::from(&mut memory));
        // SAFETY: `memory` outlives the slot.
        unsafe {
            for (value, stored) in [(0.5, 0.0), (1.5, 2.0), (-2.5, -2.0), (-2_147_483_647.0, -2_147_483_647.0)] {
                assert_eq!(slot.write(value), Ok(()));
                assert_eq!(slot.read(), stored);
            }
            for value in [2_147_483_648.0, 2_147_483_647.5, f64::INFINITY] {
                assert_eq!(slot.write(value), Err(value));
            }
            assert!(slot.write(f64::NAN).is_err_and(f64::is_nan));
        }
    }

    #[test]
    fn everything_but_zero_is_true() {
        let mut memory = 7;
        let slot = Slot::Boolean(NonNull::from(&mut memory));
        for (value, stored) in [(0.0, 0.0), (-0.0, 0.0), (0.1, 1.0), (f64::NAN, 1.0)] {
            // SAFETY: `memory` outlives the slot.
            unsafe {
                assert_eq!(slot.write(value), Ok(()));
                assert_eq!(slot.read(), stored);
            }
        }
    }
}
