//! The trace of a run: a table with one row per recorded step.

use std::ptr::NonNull;

use super::condition::Condition;
use crate::place::Place;

/// Values of the controller that lie side by side: the first and how many.
#[derive(Clone, Copy, Debug)]
pub enum Bank {
    /// numbers
    Reals(NonNull<f64>, usize),
    /// integers, enumerations and truth values
    Integers(NonNull<i32>, usize),
}

impl Bank {
    /// How many.
    pub fn count(&self) -> usize {
        match self {
            Self::Reals(_, count) | Self::Integers(_, count) => *count,
        }
    }

    /// # Safety
    /// The values can be read, and as many numbers be written at `target`.
    unsafe fn copy(&self, target: NonNull<f64>) {
        // SAFETY: by the contract of this function.
        unsafe {
            match *self {
                Self::Reals(first, count) => target.copy_from_nonoverlapping(first, count),
                Self::Integers(first, count) => {
                    (0..count).for_each(|i| target.add(i).write(f64::from(first.add(i).read())));
                }
            }
        }
    }
}

/// Table and what goes into a row: the time first, then, from column `start` on, the banks and the truths.
#[derive(Clone, Debug)]
pub struct Log {
    /// the first number of the table
    pub table: NonNull<f64>,
    /// rows
    pub rows: usize,
    /// numbers in a row
    pub columns: usize,
    /// column of the first slot
    pub start: usize,
    /// values of the controller
    pub banks: Vec<Bank>,
    /// steps between two rows
    pub every: usize,
    /// ends the run with the row for which it holds
    pub stop: Option<Condition>,
}

impl Log {
    /// Fills the row of step `k`, if it has one.
    ///
    /// # Safety
    /// The table can be written, banks and truths can be read.
    pub(super) unsafe fn record(&self, k: usize, time: f64, truths: &[Place]) {
        if !k.is_multiple_of(self.every) {
            return;
        }
        let row = k / self.every;
        assert!(row < self.rows, "row {row} of {}", self.rows);
        let values: usize = self.banks.iter().map(Bank::count).sum();
        assert!(self.start + values + truths.len() <= self.columns, "a row is too short");
        // SAFETY: inside the table, by the asserts above.
        unsafe {
            let row = self.table.add(row * self.columns);
            row.write(time);
            let mut column = row.add(self.start);
            for bank in &self.banks {
                bank.copy(column);
                column = column.add(bank.count());
            }
            for place in truths {
                column.write(place.sample(0));
                column = column.add(1);
            }
        }
    }

    /// Whether the row of step `k`, if it has one, is the last.
    ///
    /// # Safety
    /// The row was recorded.
    pub(super) unsafe fn ends(&mut self, k: usize) -> bool {
        let Some(stop) = self.stop.as_mut().filter(|_| k.is_multiple_of(self.every)) else { return false };
        // SAFETY: by the contract of this function.
        let row =
            unsafe { std::slice::from_raw_parts(self.table.add(k / self.every * self.columns).as_ptr(), self.columns) };
        stop.holds(row)
    }
}
