//! Results of the runs as one table: claim, paper, measured, limit, pass.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use comfy_table::Table;
use serde::Deserialize;
use serde_json::Value;

use crate::table;

/// What `cosim run --json` writes, as far as the table needs it.
#[derive(Deserialize)]
pub struct Outcome {
    scenario: String,
    criteria: Vec<Criterion>,
    /// Whether every criterion holds; nothing where there are none.
    pub passed: Option<bool>,
    simulated_s: f64,
    wall_s: f64,
}

#[derive(Deserialize)]
struct Criterion {
    claim: String,
    paper: String,
    value: Value,
    limit: String,
    unit: Option<String>,
    passed: bool,
}

impl Outcome {
    /// The run in one line.
    pub fn line(&self) -> String {
        let held = self.criteria.iter().filter(|criterion| criterion.passed).count();
        let (scenario, count) = (&self.scenario, self.criteria.len());
        format!("{scenario}: {held} of {count} criteria hold, {:.2} s in {:.2} s", self.simulated_s, self.wall_s)
    }
}

/// Reads one result.
///
/// # Errors
/// When the file is missing or is no result.
pub fn read(file: &Path) -> Result<Outcome> {
    let text = fs::read_to_string(file).with_context(|| format!("cannot read `{}`", file.display()))?;
    serde_json::from_str(&text).with_context(|| format!("`{}` is no result of `cosim run`", file.display()))
}

/// The acceptance table, with a closing line that counts.
pub fn table(outcomes: &[Outcome]) -> String {
    let mut shown = table::new(&["scenario", "claim", "paper", "measured", "limit", "pass"]);
    let (mut held, mut count) = (0, 0);
    for outcome in outcomes {
        for (index, criterion) in outcome.criteria.iter().enumerate() {
            let scenario = if index == 0 { outcome.scenario.as_str() } else { "" };
            add(&mut shown, scenario, criterion);
            held += usize::from(criterion.passed);
            count += 1;
        }
    }
    format!("{shown}\n{held} of {count} criteria hold")
}

fn add(shown: &mut Table, scenario: &str, criterion: &Criterion) {
    let unit = criterion.unit.as_deref().unwrap_or_default();
    shown.add_row([
        scenario,
        &criterion.claim,
        &criterion.paper,
        &text(&criterion.value, unit),
        &limit(&criterion.limit, unit),
        if criterion.passed { "yes" } else { "NO" },
    ]);
}

// `<= 4.5e-07` in m is `<= 450 nm`
fn limit(text: &str, unit: &str) -> String {
    let part = |part: &str| {
        let (relation, number) = part.split_once(' ')?;
        let shown = match number.parse() {
            Ok(holds) => yes_or_no(holds).to_owned(),
            Err(_) => table::quantity(number.parse().ok()?, unit),
        };
        Some(format!("{relation} {shown}"))
    };
    text.split(" and ").map(|words| part(words).unwrap_or_else(|| words.to_owned())).collect::<Vec<_>>().join(", ")
}

fn text(value: &Value, unit: &str) -> String {
    match value {
        Value::Number(number) => table::quantity(number.as_f64().unwrap_or(f64::NAN), unit),
        // what JSON has no number for: NaN, Infinity
        Value::String(text) => text.clone(),
        Value::Bool(holds) => yes_or_no(*holds).to_owned(),
        other => other.to_string(),
    }
}

fn yes_or_no(holds: bool) -> &'static str {
    if holds { "yes" } else { "no" }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESULT: &str = r#"{"loop": "dob", "scenario": "dob/paper", "seed": 7, "engine": "reference", "metrics": {},
        "criteria": [
            {"id": "a", "claim": "stops early enough", "paper": "< 1 um", "value": 2.3e-7, "limit": "<= 4.5e-07",
             "unit": "m", "passed": true},
            {"id": "b", "claim": "retracts", "paper": "", "value": "NaN", "limit": ">= 1.0 and <= 2.0",
             "unit": "1", "passed": false}],
        "passed": false, "simulated_s": 1.5, "wall_s": 0.25}"#;

    fn outcome() -> Outcome {
        serde_json::from_str(RESULT).unwrap()
    }

    #[test]
    fn the_table_shows_claim_paper_measured_limit_and_pass() {
        let text = table(&[outcome()]);
        for part in ["dob/paper", "stops early enough", "< 1 um", "230 nm", "<= 450 nm", "yes", "NaN", "NO"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(text.ends_with("1 of 2 criteria hold"));
    }

    #[test]
    fn limits_take_the_unit_of_the_criterion() {
        assert_eq!(limit("<= 4.5e-07", "m"), "<= 450 nm");
        assert_eq!(limit(">= 1.0 and <= 2.0", "1"), ">= 1, <= 2");
        assert_eq!(limit("= 7.0", ""), "= 7");
        assert_eq!(limit("= false", ""), "= no");
    }

    #[test]
    fn a_run_is_told_in_one_line() {
        assert_eq!(outcome().line(), "dob/paper: 1 of 2 criteria hold, 1.50 s in 0.25 s");
    }
}
