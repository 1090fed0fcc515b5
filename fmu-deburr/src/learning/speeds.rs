//! The speeds at which patterns are learned, from the list that a text parameter holds.

use control_blocks::{ParameterError, real_numbers, require};
use serde::{Deserialize, Serialize};

/// Most patterns of a bank.
const PATTERNS_MAX: usize = 9;

/// Multiples of the programmed speed at which patterns are learned, descending.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speeds {
    factors: [f64; PATTERNS_MAX],
    count: usize,
}

impl Speeds {
    /// The paper's five speeds.
    pub const PAPER: Self = Self { factors: [1.0, 0.8, 0.6, 0.4, 0.2, 0.0, 0.0, 0.0, 0.0], count: 5 };

    /// From a list; none when it is empty or too long.
    pub fn new(list: &[f64]) -> Option<Self> {
        let mut factors = [0.0; PATTERNS_MAX];
        factors.get_mut(..list.len())?.copy_from_slice(list);
        (!list.is_empty()).then_some(Self { factors, count: list.len() })
    }

    /// From the text of `learn.speeds`.
    ///
    /// # Errors
    /// Names the value and what it must be.
    pub fn read(text: &str) -> Result<Self, ParameterError> {
        let wrong = || ParameterError {
            name: "learn.speeds",
            value: text.to_owned(),
            limit: "1 to 9 numbers from `0.01` to `1`, descending by `0.01` or more".to_owned(),
            hint: "write 1.0 0.8 0.6 0.4 0.2",
        };
        let list: Option<Vec<f64>> = real_numbers(text).map(|(_, number)| number).collect();
        let list = list.ok_or_else(wrong)?;
        let ranged = list.iter().all(|factor| (0.01..=1.0).contains(factor));
        require(ranged && list.windows(2).all(|pair| pair[0] - pair[1] > 0.0099), wrong)?;
        Self::new(&list).ok_or_else(wrong)
    }

    /// The list.
    pub fn list(&self) -> &[f64] {
        &self.factors[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_with_blanks_commas_and_semicolons() {
        assert_eq!(Speeds::read("1.0 0.8 0.6 0.4 0.2"), Ok(Speeds::PAPER));
        assert_eq!(Speeds::read("1, 0.5;  0.25").unwrap().list(), [1.0, 0.5, 0.25]);
    }

    #[test]
    fn everything_else_is_rejected() {
        for text in ["", "1 2", "0.5 0.5", "0.2 0.4", "one", "nan", "inf", "0", "-1", "1 .9 .8 .7 .6 .5 .4 .3 .2 .1"] {
            let message = Speeds::read(text).unwrap_err().to_string();
            assert!(message.starts_with(&format!("parameter `learn.speeds` is `{text}`")), "{message}");
        }
    }

    #[test]
    fn nine_speeds_from_a_hundredth_to_one_that_descend_by_a_hundredth() {
        for text in ["1 .9 .8 .7 .6 .5 .4 .3 .2", "1", "0.01", "0.02 0.01", "1.0 0.99"] {
            assert!(Speeds::read(text).is_ok(), "{text}");
        }
        for text in ["1.001", "0.009", "0.5 0.491", "1 0.5 0.6"] {
            assert!(Speeds::read(text).is_err(), "{text}");
        }
        assert_eq!(Speeds::new(&[]), None);
        assert_eq!(Speeds::new(&[0.5; 10]), None);
        assert_eq!(Speeds::new(&[0.5; 9]).unwrap().list(), [0.5; 9]);
    }
}
