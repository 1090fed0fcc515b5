//! One number for each age in samples, the youngest first, that grow older without being moved.
//!
//! They are a window that slides down a buffer of twice its length: it is copied once in as many samples as there are
//! ages.

use serde::{Deserialize, Serialize};

/// Numbers by age; 0 at first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ages {
    buffer: Vec<f64>,
    /// place of the youngest
    first: usize,
}

impl Ages {
    /// Of `count` ages, at least one.
    pub fn new(count: usize) -> Self {
        Self { buffer: vec![0.0; 2 * count], first: count }
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.buffer.len() / 2
    }

    /// All of them, the youngest first.
    pub fn values(&self) -> &[f64] {
        &self.buffer[self.first..][..self.count()]
    }

    /// One sample later: the oldest is gone, and the youngest is 0.
    pub fn grow_older(&mut self) -> &mut [f64] {
        let count = self.count();
        if self.first == 0 {
            self.buffer.copy_within(..count, count);
            self.first = count;
        }
        self.first -= 1;
        let values = &mut self.buffer[self.first..][..count];
        values[0] = 0.0;
        values
    }

    /// All are 0 again.
    pub fn clear(&mut self) {
        let count = self.count();
        self.buffer[self.first..][..count].fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_its_age_until_it_is_too_old() {
        for count in [1, 2, 5] {
            let mut ages = Ages::new(count);
            for k in 1..40u32 {
                ages.grow_older()[0] = f64::from(k);
                let expected: Vec<f64> = (0..count as u32).map(|age| f64::from(k.saturating_sub(age))).collect();
                assert_eq!(ages.values(), expected);
            }
            ages.clear();
            assert_eq!(ages.values(), vec![0.0; count]);
            assert!(ages.grow_older().iter().all(|value| *value == 0.0));
        }
    }
}
