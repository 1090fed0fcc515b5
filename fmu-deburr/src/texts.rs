//! Texts among the parameters, and what is read from them.

use control_blocks::{ParameterError, require};
use serde::{Deserialize, Serialize};

use crate::parameters::Speeds;

/// Start value of `learn.speeds`.
pub const SPEEDS: &str = "1.0 0.8 0.6 0.4 0.2";

/// Texts among the variables.
#[derive(Clone, Serialize, Deserialize)]
pub struct Texts {
    /// Of the path.
    pub path: TextPath,
    /// Of the learning.
    pub learn: TextLearn,
    /// Of the bank.
    pub bank: TextBank,
}

/// Texts of the path.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextPath {
    /// JSON file, in the folder `resources` of the FMU or with its whole path.
    pub file: String,
}

/// Texts of the learning.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextLearn {
    /// Multiples of the taught speed.
    pub speeds: String,
}

/// Texts of the bank.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextBank {
    /// File that is read at initialisation; empty for none.
    pub import: String,
    /// File that is written after learning and on request; empty for none.
    pub export: String,
    /// What became of the last reading or writing.
    pub message: String,
}

impl Texts {
    /// All empty; the start values are in the variable table of the FMU.
    pub const EMPTY: Self = Self {
        path: TextPath { file: String::new() },
        learn: TextLearn { speeds: String::new() },
        bank: TextBank { import: String::new(), export: String::new(), message: String::new() },
    };

    /// The speeds that `learn.speeds` lists.
    ///
    /// # Errors
    /// Names the value and what it must be.
    pub fn speeds(&self) -> Result<Speeds, ParameterError> {
        let text = &self.learn.speeds;
        let wrong = || ParameterError {
            name: "learn.speeds",
            value: text.clone(),
            limit: "1 to 9 numbers from `0.01` to `1`, descending by `0.01` or more".to_owned(),
            hint: "write 1.0 0.8 0.6 0.4 0.2",
        };
        let parts = text.split([' ', ',', ';']).filter(|part| !part.is_empty());
        let list: Vec<f64> = parts.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        let ranged = list.iter().all(|factor| (0.01..=1.0).contains(factor));
        require(ranged && list.windows(2).all(|pair| pair[0] - pair[1] > 0.0099), wrong)?;
        Speeds::new(&list).ok_or_else(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speeds(text: &str) -> Result<Speeds, ParameterError> {
        Texts { learn: TextLearn { speeds: text.to_owned() }, ..Texts::EMPTY }.speeds()
    }

    #[test]
    fn lists_with_blanks_commas_and_semicolons() {
        assert_eq!(speeds(SPEEDS), Ok(Speeds::PAPER));
        assert_eq!(speeds("1, 0.5;  0.25").unwrap().list(), [1.0, 0.5, 0.25]);
    }

    #[test]
    fn everything_else_is_refused() {
        for text in ["", "1 2", "0.5 0.5", "0.2 0.4", "one", "nan", "inf", "0", "-1", "1 .9 .8 .7 .6 .5 .4 .3 .2 .1"] {
            let message = speeds(text).unwrap_err().to_string();
            assert!(message.starts_with(&format!("parameter `learn.speeds` is `{text}`")), "{message}");
        }
    }
}
