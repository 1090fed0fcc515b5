//! The trace of a run: a table with one row per recorded step.

use plants::Place;

use crate::condition::Condition;
use crate::ffi::{Bank, Table};

/// Table and what goes into a row: the time first, then, from column `start` on, the banks and the truths.
#[derive(Debug)]
pub struct Log {
    /// where the rows stand
    pub table: Table,
    /// column of the first value
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
    pub(super) fn record(&mut self, k: usize, time: f64, truths: &[Place]) {
        if !k.is_multiple_of(self.every) {
            return;
        }
        let row = self.table.row(k / self.every);
        row[0] = time;
        let mut rest = &mut row[self.start..];
        for bank in &self.banks {
            let (values, after) = rest.split_at_mut(bank.count());
            bank.copy_to(values);
            rest = after;
        }
        rest[..truths.len()].iter_mut().zip(truths).for_each(|(number, place)| *number = place.sample(0));
    }

    /// Whether the row of step `k`, if it has one, is the last.
    pub(super) fn ends(&mut self, k: usize) -> bool {
        let Some(stop) = self.stop.as_mut().filter(|_| k.is_multiple_of(self.every)) else { return false };
        stop.holds(self.table.row(k / self.every))
    }
}
