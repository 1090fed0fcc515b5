//! `cargo xtask bench`: what the FMUs and the reference loop cost, as ratios taken in one run.

pub mod description;
pub mod dob;
pub mod pass_through;
pub mod reference_loop;
pub mod slave;
pub mod statistics;

use std::fs;

use anyhow::{Context, Result};
use serde::Serialize;

use crate::fmu;
use crate::process;
use crate::setup;
use crate::table;
use crate::workspace::Workspace;

/// One line of the result.
#[derive(Serialize)]
struct Row {
    quantity: &'static str,
    unit: &'static str,
    minimum: f64,
    median: f64,
    goal: Option<f64>,
}

/// Measures everything, prints the table, writes `target/bench/bench.json`.
///
/// # Errors
/// When something that is measured does not build or run.
pub fn run(workspace: &Workspace) -> Result<()> {
    setup::run(workspace)?;
    fmu::pack_all(workspace, &fmu::controllers(workspace))?;
    let folder = workspace.path("target/bench");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make `{}`", folder.display()))?;

    let mut rows = pass_through_rows(&pass_through::measure(workspace, &folder)?);
    let tick = dob::measure(workspace)?;
    rows.push(row("contact detection, one sample in Detect", "ns", &tick, Some(1000.0)));
    rows.extend(reference_rows(&reference_loop::measure(workspace)?));

    let file = folder.join("bench.json");
    fs::write(&file, serde_json::to_string_pretty(&rows)? + "\n").context("cannot write `target/bench/bench.json`")?;
    println!("{}", show(&rows));
    process::header("results are in `target/bench/bench.json`");
    Ok(())
}

fn pass_through_rows(costs: &pass_through::Costs) -> Vec<Row> {
    let ratio = |quantity, base: &statistics::Samples, goal| Row {
        quantity,
        unit: "1",
        minimum: costs.rust.minimum() / base.minimum(),
        median: costs.rust.median() / base.median(),
        goal,
    };
    vec![
        row("set + doStep + get: Rust pass-through", "ns", &costs.rust, None),
        row("set + doStep + get: C FMU with the checks of FMI 2.0", "ns", &costs.checked_c, None),
        row("set + doStep + get: C FMU without any check", "ns", &costs.bare_c, None),
        ratio("Rust pass-through / C FMU with checks", &costs.checked_c, Some(2.0)),
        ratio("Rust pass-through / C FMU without any check", &costs.bare_c, None),
    ]
}

fn reference_rows(costs: &reference_loop::Costs) -> Vec<Row> {
    vec![
        row("reference loop: simulated time / wall time", "1", &costs.real_time_factor, None),
        row("reference loop: one step", "us", &costs.step, None),
        row("  of which the FMU, called through FMPy", "us", &costs.fmu, None),
        row("  of which the plant", "us", &costs.plant, None),
        row("  of which wiring, noise, trace", "us", &costs.rest(), None),
    ]
}

fn row(quantity: &'static str, unit: &'static str, samples: &statistics::Samples, goal: Option<f64>) -> Row {
    Row { quantity, unit, minimum: samples.minimum(), median: samples.median(), goal }
}

fn show(rows: &[Row]) -> String {
    let mut shown = table::new(&["quantity", "unit", "minimum", "median", "goal"]);
    for row in rows {
        let goal = row.goal.map(|goal| format!("<= {goal}")).unwrap_or_default();
        shown.add_row([
            row.quantity.to_owned(),
            row.unit.to_owned(),
            format!("{:.2}", row.minimum),
            format!("{:.2}", row.median),
            goal,
        ]);
    }
    shown.to_string()
}
