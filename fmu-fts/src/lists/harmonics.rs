//! A set of harmonics of the spindle, written as text like `2, 4, 6` or `1-24`.

use std::ops::RangeInclusive;
use std::str::FromStr;

use control_blocks::{ParameterError, whole_numbers};
use serde::{Deserialize, Serialize};

/// The highest harmonic of the controller.
pub const HIGHEST: usize = 64;

/// Harmonics between 1 and [`HIGHEST`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Harmonics(u64);

impl Harmonics {
    /// None at all.
    pub const NONE: Self = Self(0);
    /// 1 to 24.
    pub const DEFAULT: Self = Self((1 << 24) - 1);
    /// The same as text.
    pub const DEFAULT_TEXT: &'static str = "1-24";
    /// The first five even ones.
    pub const PAPER: Self = Self(0b10_1010_1010);
    /// The same as text.
    pub const PAPER_TEXT: &'static str = "2, 4, 6, 8, 10";

    /// The same set with harmonic `n`.
    #[must_use]
    pub fn with(self, n: usize) -> Self {
        assert!((1..=HIGHEST).contains(&n), "harmonic {n}");
        Self(self.0 | 1 << (n - 1))
    }

    /// Whether harmonic `n` belongs to the set.
    pub fn contains(self, n: usize) -> bool {
        (1..=HIGHEST).contains(&n) && self.0 >> (n - 1) & 1 == 1
    }

    /// The members, ascending.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (1..=HIGHEST).filter(move |&n| self.contains(n))
    }

    /// The highest member, 0 if there is none.
    pub fn highest(self) -> usize {
        HIGHEST - self.0.leading_zeros() as usize
    }
}

impl FromStr for Harmonics {
    type Err = ParameterError;

    /// Numbers and ranges with a minus sign, separated by commas, semicolons or blanks; an empty text is the empty set.
    fn from_str(text: &str) -> Result<Self, ParameterError> {
        let mut set = Self::NONE;
        for (part, range) in whole_numbers(text) {
            let known = |range: &RangeInclusive<usize>| *range.start() >= 1 && *range.end() <= HIGHEST;
            let range = range.filter(known).ok_or_else(|| unreadable(text, part))?;
            set = range.fold(set, Self::with);
        }
        Ok(set)
    }
}

fn unreadable(text: &str, part: &str) -> ParameterError {
    ParameterError {
        name: "afc.harmonics",
        value: text.to_owned(),
        limit: format!("numbers or ranges from `1` to `{HIGHEST}`, not `{part}`"),
        hint: "write for instance `2, 4, 6, 8, 10` or `1-24`",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(text: &str) -> Vec<usize> {
        text.parse::<Harmonics>().unwrap().iter().collect()
    }

    #[test]
    fn numbers_and_ranges_are_read() {
        assert_eq!(members("2,4,6,8,10"), [2, 4, 6, 8, 10]);
        assert_eq!(members(" 50, 1 - 3 ,2"), [1, 2, 3, 50]);
        assert_eq!(members("64"), [64]);
        assert_eq!(members(""), [0; 0]);
        assert_eq!(Harmonics::DEFAULT_TEXT.parse(), Ok(Harmonics::DEFAULT));
        assert_eq!(Harmonics::PAPER_TEXT.parse(), Ok(Harmonics::PAPER));
    }

    #[test]
    fn the_highest_member_is_known() {
        assert_eq!(Harmonics::NONE.highest(), 0);
        assert_eq!(Harmonics::PAPER.highest(), 10);
        assert_eq!(Harmonics::NONE.with(64).highest(), 64);
    }

    #[test]
    fn nonsense_is_named() {
        for (text, part) in [("2,0", "`0`"), ("65", "`65`"), ("5-3", "`5-3`"), ("two", "`two`"), ("1--3", "`1--3`")] {
            let message = text.parse::<Harmonics>().unwrap_err().to_string();
            assert!(message.starts_with(&format!("parameter `afc.harmonics` is `{text}`")), "{message}");
            assert!(message.contains(part) && message.contains("hint:"), "{message}");
        }
    }
}
