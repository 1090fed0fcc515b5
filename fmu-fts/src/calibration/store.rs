//! Storage for samples with a fixed capacity.

use serde::{Deserialize, Serialize};

/// Up to a fixed number of samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Store<T> {
    room: Vec<T>,
    count: usize,
}

impl<T: Copy> Store<T> {
    /// An empty store for `size` samples; `blank` fills the memory.
    pub fn new(size: usize, blank: T) -> Self {
        Self { room: vec![blank; size], count: 0 }
    }

    /// Stores one more sample; false when the store is full.
    pub fn push(&mut self, sample: T) -> bool {
        let slot = self.room.get_mut(self.count);
        let fits = slot.is_some();
        if let Some(slot) = slot {
            *slot = sample;
            self.count += 1;
        }
        fits
    }

    /// The newest sample.
    pub fn last_mut(&mut self) -> Option<&mut T> {
        self.room[..self.count].last_mut()
    }

    /// The samples, in the order in which they came.
    pub fn samples(&self) -> &[T] {
        &self.room[..self.count]
    }

    /// Removes all samples.
    pub fn clear(&mut self) {
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_what_fits_and_discards() {
        let mut store = Store::new(2, 0);
        assert_eq!([store.push(7), store.push(8), store.push(9)], [true, true, false]);
        assert_eq!(store.samples(), [7, 8]);
        store.last_mut().into_iter().for_each(|last| *last += 1);
        assert_eq!(store.samples(), [7, 9]);
        store.clear();
        assert_eq!(store.samples(), [0; 0]);
        assert!(store.last_mut().is_none());
        assert!(store.push(5));
        assert_eq!(store.samples(), [5]);
    }
}
