//! What the value references stand for: constant tables, made from the rows when the library is compiled.

use crate::table::place::Place;
use crate::table::variable::{Kind, Role, Variable};

/// What a value reference stands for: an element of a row.
#[derive(Debug)]
pub struct Entry<V: 'static> {
    pub(crate) row: &'static Variable<V>,
    pub(crate) element: u32,
    /// Of a Real: where it lies.
    pub(crate) real: Option<Place<V, f64>>,
    /// Of a Real input, which takes any finite number at any time, and nothing else follows from it.
    pub(crate) input: Option<Place<V, f64>>,
}

/// The value references of a model.
#[derive(Debug)]
pub struct Index<V: 'static> {
    pub(crate) entries: &'static [Entry<V>],
    /// Those of the Reals that the model writes.
    pub(crate) computed: &'static [Entry<V>],
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
    /// Joins the tables that [`entries`] and [`computed`] give.
    pub const fn new(entries: &'static [Entry<V>], computed: &'static [Entry<V>]) -> Self {
        Self { entries, computed }
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

const fn is_computed<V>(row: &Variable<V>) -> bool {
    matches!(row.kind, Kind::Real { .. }) && matches!(row.role(), Role::Output | Role::Local | Role::Calculated)
}
