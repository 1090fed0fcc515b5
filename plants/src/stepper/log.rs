//! The trace of a run: a table with one row per recorded step.

use std::ptr::NonNull;

use super::{Condition, Slot};
use crate::Place;

/// Table and what goes into a row: the time first, then, from column `start` on, the slots and the truths.
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
    pub slots: Vec<Slot>,
    /// steps between two rows
    pub every: usize,
    /// ends the run with the row for which it holds
    pub stop: Option<Condition>,
}

impl Log {
    /// Fills the row of step `k`, if it has one.
    ///
    /// # Safety
    /// The table can be written, slots and truths can be read.
    pub(super) unsafe fn record(&self, k: usize, time: f64, truths: &[Place]) {
        if !k.is_multiple_of(self.every) {
            return;
        }
        let row = k / self.every;
        assert!(row < self.rows, "row {row} of {}", self.rows);
        assert!(self.start + self.slots.len() + truths.len() <= self.columns, "a row is too short");
        // SAFETY: inside the table, by the asserts above.
        unsafe {
            let row = self.table.add(row * self.columns);
            row.write(time);
            let mut column = row.add(self.start);
            let slots = self.slots.iter().map(|slot| slot.read());
            for value in slots.chain(truths.iter().map(|place| place.sample(0))) {
                column.write(value);
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
