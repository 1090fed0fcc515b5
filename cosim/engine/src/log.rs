//! The trace of a run: a table with one row per recorded step.

use plants::Place;

use crate::condition::Condition;
use crate::failure::Failure;
use crate::ffi::{Bank, Slot, Table};

/// Starts an injection some steps after the first row for which a condition holds.
#[derive(Debug)]
pub struct Trigger {
    /// the condition
    pub condition: Condition,
    /// steps from that row on
    pub delay: f64,
    /// receives the first step of the injection; infinite until then
    pub begin: Slot,
}

/// Table and the contents of a row: the time first, then, from column `start` on, the banks and the ground truth.
#[derive(Debug)]
pub struct Log {
    /// the rows
    pub table: Table,
    /// column of the first value
    pub start: usize,
    /// values of the controller
    pub banks: Vec<Bank>,
    /// steps between two rows
    pub every: usize,
    /// ends the run with the row for which it is true
    pub stop: Option<Condition>,
    /// triggers of injections
    pub triggers: Vec<Trigger>,
}

impl Log {
    /// Fills the row of step `k`, if it has one, and checks which injections start.
    pub(super) fn record(&mut self, k: usize, time: f64, truths: &[Place]) -> Result<(), Failure> {
        let Some(row) = self.row(k) else { return Ok(()) };
        let row = self.table.row(row);
        row[0] = time;
        let mut rest = &mut row[self.start..];
        for bank in &self.banks {
            let (values, after) = rest.split_at_mut(bank.count());
            bank.copy_to(values);
            rest = after;
        }
        rest[..truths.len()].iter_mut().zip(truths).for_each(|(number, place)| *number = place.sample(0));
        for Trigger { condition, delay, begin } in &mut self.triggers {
            if begin.read().is_infinite() && condition.holds(row) {
                #[allow(clippy::cast_precision_loss)]
                begin.write(k as f64 + *delay).map_err(Failure::Integer)?;
            }
        }
        Ok(())
    }

    /// Number of the row of step `k`, if it has one; a full table starts again.
    fn row(&self, k: usize) -> Option<usize> {
        k.is_multiple_of(self.every).then(|| k / self.every % self.table.rows())
    }

    /// Whether the row of step `k`, if it has one, is the last.
    pub(super) fn ends(&mut self, k: usize) -> bool {
        if self.stop.is_none() {
            return false;
        }
        let row = self.row(k);
        row.zip(self.stop.as_mut()).is_some_and(|(row, stop)| stop.holds(self.table.row(row)))
    }
}
