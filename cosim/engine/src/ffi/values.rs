//! Values in memory: a single one, one per step, several adjacent ones, a table; with the conversion between numbers and
//! the types of FMI.

use std::ptr::NonNull;
use std::slice;

/// One value.
#[derive(Clone, Copy, Debug)]
pub struct Slot(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Real(NonNull<f64>),
    Integer(NonNull<i32>),
    Boolean(NonNull<i32>),
}

// SAFETY: who makes a slot vouches for its memory and for one thread at a time.
unsafe impl Send for Slot {}
// SAFETY: as above.
unsafe impl Sync for Slot {}

impl Slot {
    /// A number.
    ///
    /// # Safety
    /// The memory can be read and written, by one thread at a time, as long as any copy of the slot is in use.
    pub unsafe fn real(place: NonNull<f64>) -> Self {
        Self(Kind::Real(place))
    }

    /// An integer or an enumeration.
    ///
    /// # Safety
    /// As for [`Slot::real`].
    pub unsafe fn integer(place: NonNull<i32>) -> Self {
        Self(Kind::Integer(place))
    }

    /// A Boolean, 0 or 1.
    ///
    /// # Safety
    /// As for [`Slot::real`].
    pub unsafe fn boolean(place: NonNull<i32>) -> Self {
        Self(Kind::Boolean(place))
    }

    /// The value as a number.
    pub fn read(self) -> f64 {
        // SAFETY: by the contract of the constructors.
        unsafe {
            match self.0 {
                Kind::Real(place) => place.read(),
                Kind::Integer(place) | Kind::Boolean(place) => f64::from(place.read()),
            }
        }
    }

    /// Writes a number: rounded half to even for integers, nonzero is true.
    ///
    /// # Errors
    /// The value, when it does not fit into an integer of 32 bits.
    pub fn write(self, value: f64) -> Result<(), f64> {
        // SAFETY: by the contract of the constructors.
        unsafe {
            match self.0 {
                Kind::Real(place) => place.write(value),
                Kind::Integer(place) => place.write(whole(value).ok_or(value)?),
                Kind::Boolean(place) => place.write(i32::from(value != 0.0)),
            }
        }
        Ok(())
    }
}

/// Integer of a number, if it fits into 32 bits.
fn whole(value: f64) -> Option<i32> {
    let rounded = value.round_ties_even();
    // NaN, too, is no integer
    #[allow(clippy::cast_possible_truncation)]
    (-2_147_483_648.0..2_147_483_648.0).contains(&rounded).then_some(rounded as i32)
}

/// Numbers of a whole run, one per step.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    first: NonNull<f64>,
    count: usize,
}

// SAFETY: as for `Slot`.
unsafe impl Send for Series {}
// SAFETY: as for `Slot`.
unsafe impl Sync for Series {}

impl Series {
    /// `count` numbers from `first` on.
    ///
    /// # Safety
    /// They can be read as long as any copy of the series is in use.
    pub unsafe fn new(first: NonNull<f64>, count: usize) -> Self {
        Self { first, count }
    }

    /// Number of step `k`.
    ///
    /// # Panics
    /// When there is none.
    pub fn at(self, k: usize) -> f64 {
        assert!(k < self.count, "step {k} of {}", self.count);
        // SAFETY: inside the series.
        unsafe { self.first.add(k).read() }
    }
}

/// Values of the controller that are adjacent.
#[derive(Clone, Copy, Debug)]
pub struct Bank(Block);

#[derive(Clone, Copy, Debug)]
enum Block {
    Reals(NonNull<f64>, usize),
    Integers(NonNull<i32>, usize),
}

// SAFETY: as for `Slot`.
unsafe impl Send for Bank {}
// SAFETY: as for `Slot`.
unsafe impl Sync for Bank {}

impl Bank {
    /// `count` numbers from `first` on.
    ///
    /// # Safety
    /// They can be read, by one thread at a time, as long as any copy of the bank is in use.
    pub unsafe fn reals(first: NonNull<f64>, count: usize) -> Self {
        Self(Block::Reals(first, count))
    }

    /// The same for integers, enumerations or Booleans.
    ///
    /// # Safety
    /// As for [`Bank::reals`].
    pub unsafe fn integers(first: NonNull<i32>, count: usize) -> Self {
        Self(Block::Integers(first, count))
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        match self.0 {
            Block::Reals(_, count) | Block::Integers(_, count) => count,
        }
    }

    /// Copies the values as numbers.
    ///
    /// # Panics
    /// When the numbers of values differ.
    pub fn copy_to(&self, numbers: &mut [f64]) {
        // SAFETY: by the contract of the constructors; no other code writes meanwhile.
        unsafe {
            match self.0 {
                Block::Reals(first, count) => numbers.copy_from_slice(slice::from_raw_parts(first.as_ptr(), count)),
                Block::Integers(first, count) => {
                    let values = slice::from_raw_parts(first.as_ptr(), count);
                    assert_eq!(values.len(), numbers.len(), "a bank of another size");
                    numbers.iter_mut().zip(values).for_each(|(number, value)| *number = f64::from(*value));
                }
            }
        }
    }
}

/// Consecutive rows of numbers.
#[derive(Debug)]
pub struct Table {
    first: NonNull<f64>,
    rows: usize,
    columns: usize,
}

// SAFETY: as for `Slot`.
unsafe impl Send for Table {}
// SAFETY: as for `Slot`.
unsafe impl Sync for Table {}

impl Table {
    /// A table whose first number is `first`.
    ///
    /// # Safety
    /// `rows * columns` numbers can be read and written exclusively as long as the table is in use.
    pub unsafe fn new(first: NonNull<f64>, rows: usize, columns: usize) -> Self {
        Self { first, rows, columns }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Numbers per row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// One row.
    ///
    /// # Panics
    /// When there is none of this number.
    pub fn row(&mut self, row: usize) -> &mut [f64] {
        assert!(row < self.rows, "row {row} of {}", self.rows);
        // SAFETY: inside the table; it is borrowed as long as the row.
        unsafe { slice::from_raw_parts_mut(self.first.add(row * self.columns).as_ptr(), self.columns) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_round_half_to_even_and_refuse_what_does_not_fit() {
        let mut memory = 7;
        // SAFETY: `memory` outlives the slot.
        let slot = unsafe { Slot::integer(NonNull::from(&mut memory)) };
        for (value, stored) in [(0.5, 0.0), (1.5, 2.0), (-2.5, -2.0), (-2_147_483_648.0, -2_147_483_648.0)] {
            assert_eq!(slot.write(value), Ok(()));
            assert_eq!(slot.read(), stored);
        }
        for value in [2_147_483_648.0, 2_147_483_647.5, -2_147_483_649.0, f64::INFINITY] {
            assert_eq!(slot.write(value), Err(value));
        }
        assert!(slot.write(f64::NAN).is_err_and(f64::is_nan));
    }

    #[test]
    fn everything_but_zero_is_true() {
        let mut memory = 7;
        // SAFETY: `memory` outlives the slot.
        let slot = unsafe { Slot::boolean(NonNull::from(&mut memory)) };
        for (value, stored) in [(0.0, 0.0), (-0.0, 0.0), (0.1, 1.0), (f64::NAN, 1.0)] {
            assert_eq!(slot.write(value), Ok(()));
            assert_eq!(slot.read(), stored);
        }
    }
}
