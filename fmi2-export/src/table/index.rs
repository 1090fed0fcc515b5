//! Variables by value reference: constant tables, made from the variable table when the library is compiled.

use crate::table::place::{Place, Run};
use crate::table::variable::{Kind, Role, Variable};

/// Element of a row of the variable table that a value reference identifies.
#[derive(Debug)]
pub struct Entry<V: 'static> {
    pub(crate) row: &'static Variable<V>,
    pub(crate) element: u32,
    /// Location of the value; none if it is not a Real.
    pub(crate) real: Option<Place<V, f64>>,
    /// Location of a Real input, which accepts any finite number at any time without an effect on other variables.
    pub(crate) input: Option<Place<V, f64>>,
}

/// The value references of a model.
#[derive(Debug)]
pub struct Index<V: 'static> {
    pub(crate) entries: &'static [Entry<V>],
    /// Those of the Reals that the model writes.
    pub(crate) computed: &'static [Entry<V>],
    /// The same by where they lie.
    pub(crate) runs: &'static [Run<V>],
}

impl<V> Clone for Entry<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Entry<V> {}

impl<V> Entry<V> {
    const fn new(row: &'static Variable<V>, element: usize) -> Self {
        let real = match row.kind {
            Kind::Real { place, .. } => Some(place.element(element)),
            _ => None,
        };
        let input = if matches!(row.role(), Role::Input) { real } else { None };
        Self { row, element: element as u32, real, input }
    }

    /// Row and element.
    pub(crate) fn position(&self) -> (&'static Variable<V>, usize) {
        (self.row, self.element as usize)
    }
}

impl<V> Index<V> {
    /// Joins the tables that [`entries`], [`computed`] and [`runs`] give.
    pub const fn new(entries: &'static [Entry<V>], computed: &'static [Entry<V>], runs: &'static [Run<V>]) -> Self {
        Self { entries, computed, runs }
    }
}

/// Number of value references of a table, and of those among them that are Reals the model writes.
pub const fn count<V>(table: &[Variable<V>]) -> (usize, usize) {
    let (mut all, mut computed, mut i) = (0, 0, 0);
    while i < table.len() {
        all += table[i].len();
        computed += if is_computed(&table[i]) { table[i].len() } else { 0 };
        i += 1;
    }
    (all, computed)
}

/// Value reference of the first element of a row.
pub const fn reference<V>(table: &[Variable<V>], row: usize) -> usize {
    let (mut reference, mut i) = (0, 0);
    while i < row {
        reference += table[i].len();
        i += 1;
    }
    reference
}

/// The `N` rows of a table without the texts that only the files need.
pub const fn without_texts<V, const N: usize>(table: &[Variable<V>]) -> [Variable<V>; N] {
    let mut rows = [table[0]; N];
    let mut i = 0;
    while i < N {
        rows[i] = table[i].without_texts();
        i += 1;
    }
    rows
}

/// The `N` value references of a table.
pub const fn entries<V, const N: usize>(table: &'static [Variable<V>]) -> [Entry<V>; N] {
    let mut entries = [Entry::new(&table[0], 0); N];
    let (mut reference, mut row) = (0, 0);
    while row < table.len() {
        let mut element = 0;
        while element < table[row].len() {
            entries[reference] = Entry::new(&table[row], element);
            reference += 1;
            element += 1;
        }
        row += 1;
    }
    entries
}

/// The `N` Reals that the model writes.
pub const fn computed<V, const N: usize>(entries: &[Entry<V>]) -> [Entry<V>; N] {
    let mut computed = [entries[0]; N];
    let (mut next, mut i) = (0, 0);
    while i < entries.len() {
        if is_computed(entries[i].row) {
            computed[next] = entries[i];
            next += 1;
        }
        i += 1;
    }
    computed
}

/// Reals by where they lie: a table, and how many runs there are in it.
pub const fn runs<V, const N: usize>(reals: &[Entry<V>; N]) -> ([Run<V>; N], usize) {
    let (mut runs, mut count, mut end) = ([Run::EMPTY; N], 0, 0);
    while let Some(place) = nearest(reals, end) {
        match if count > 0 { runs[count - 1].with(place) } else { None } {
            Some(longer) => runs[count - 1] = longer,
            None => {
                runs[count] = Run::of(place);
                count += 1;
            }
        }
        end = runs[count - 1].end();
    }
    (runs, count)
}

/// The first position of a Real at or after `least` bytes.
const fn nearest<V>(reals: &[Entry<V>], least: usize) -> Option<Place<V, f64>> {
    let (mut nearest, mut i): (Option<Place<V, f64>>, _) = (None, 0);
    while i < reals.len() {
        if let Some(place) = reals[i].real
            && place.offset() >= least
            && (nearest.is_none() || matches!(nearest, Some(other) if place.offset() < other.offset()))
        {
            nearest = Some(place);
        }
        i += 1;
    }
    nearest
}

const fn is_computed<V>(row: &Variable<V>) -> bool {
    matches!(row.kind, Kind::Real { .. }) && matches!(row.role(), Role::Output | Role::Local | Role::Calculated)
}

#[cfg(test)]
#[allow(unsafe_code)]
mod tests {
    use super::*;
    use std::slice::from_ref;

    #[repr(C)]
    struct Vars {
        last: [f64; 2],
        apart: i32,
        first: f64,
        second: f64,
        input: f64,
    }

    const START: &Vars = &Vars { last: [4.0, 5.0], apart: 0, first: 1.0, second: 2.0, input: 3.0 };

    const fn row(name: &'static str, size: Option<usize>, role: Role, start: &'static [f64]) -> Variable<Vars> {
        // SAFETY: a field.
        let mut row = unsafe { Variable::new_real(name, size, START, start) };
        row.role = Some(role);
        row
    }

    const TABLE: &[Variable<Vars>] = &[
        row("second", None, Role::Output, from_ref(&START.second)),
        row("input", None, Role::Input, from_ref(&START.input)),
        row("first", None, Role::Calculated, from_ref(&START.first)),
        row("last", Some(2), Role::Local, &START.last),
    ];
    const ENTRIES: &[Entry<Vars>; 5] = &entries(TABLE);
    const COMPUTED: &[Entry<Vars>; 4] = &computed(ENTRIES);

    #[test]
    fn runs_hold_every_real_that_the_model_writes_once_and_nothing_else() {
        const RUNS: ([Run<Vars>; 4], usize) = runs(COMPUTED);
        assert_eq!(count(TABLE), (5, 4));
        let found: Vec<_> = RUNS.0[..RUNS.1].iter().map(|run| run.get(START)).collect();
        assert_eq!(found, [[4.0, 5.0], [1.0, 2.0]]);
    }
}
