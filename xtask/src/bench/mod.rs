//! `cargo xtask bench`: what FMI, every controller and every closed loop cost, taken in one run.

pub mod description;
pub mod native_loop;
pub mod pass_through;
pub mod reference_loop;
pub mod slave;
pub mod statistics;
pub mod sweep;
pub mod tick;

use std::fs;

use anyhow::{Context, Result};
use serde::Serialize;

use crate::demo;
use crate::fmu;
use crate::process;
use crate::setup;
use crate::table;
use crate::workspace::Workspace;

/// One line of the result.
#[derive(Serialize)]
struct Row {
    quantity: String,
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
    for scenario in demo::loops(workspace)? {
        rows.extend(loop_rows(&scenario, &reference_loop::measure(workspace, &scenario)?)?);
        rows.extend(native_rows(&scenario, &native_loop::measure(workspace, &scenario)?));
    }
    rows.extend(sweep_rows(&sweep::measure(workspace)?));

    let file = folder.join("bench.json");
    fs::write(&file, serde_json::to_string_pretty(&rows)? + "\n").context("cannot write `target/bench/bench.json`")?;
    println!("{}", show(&rows));
    process::header("results are in `target/bench/bench.json`");
    Ok(())
}

fn pass_through_rows(costs: &pass_through::PassThroughCosts) -> Vec<Row> {
    let ratio = |quantity: &str, base: &statistics::Samples, goal| Row {
        quantity: quantity.to_owned(),
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

fn loop_rows(scenario: &str, costs: &reference_loop::ReferenceLoopCosts) -> Result<Vec<Row>> {
    let (state, tick) = tick::measure(&costs.recording)?;
    Ok(vec![
        row(
            &format!("{scenario}: one sample of the FMU in its busiest state, {state}"),
            "ns",
            &tick,
            Some(sample_goal(scenario)),
        ),
        row(&format!("{scenario}: simulated time / wall time"), "1", &costs.real_time_factor, None),
        row(&format!("{scenario}: one step of the reference loop"), "us", &costs.step, None),
        row("  of which the FMU, called through FMPy", "us", &costs.fmu, None),
        row("  of which the plant", "us", &costs.plant, None),
        row("  of which wiring, noise, trace", "us", &costs.rest(), None),
    ])
}

fn sweep_rows(costs: &sweep::SweepCosts) -> Vec<Row> {
    let row = |quantity: &str, unit, value, goal| Row {
        quantity: quantity.to_owned(),
        unit,
        minimum: value,
        median: value,
        goal,
    };
    vec![
        row("sweep on 2 workers: runs", "1/s", costs.rate, None),
        row("2 x rate of one core alone / rate of the sweep", "1", 1.0 / costs.throughput, Some(1.25)),
        row("processor time of the sweep / of its runs alone", "1", costs.processor, None),
        row("memory of all its processes", "MB", costs.memory, None),
        row("  over that of a fifth of the runs", "1", costs.growth, Some(1.1)),
    ]
}

fn native_rows(scenario: &str, costs: &native_loop::NativeLoopCosts) -> Vec<Row> {
    let ratio = costs.ratio();
    vec![
        row(&format!("{scenario}: simulated time / wall time, native engine"), "1", &costs.real_time_factor, None),
        row(&format!("{scenario}: one step of the native engine"), "us", &costs.native, None),
        row(&format!("{scenario}: one step of the plant alone, same commands"), "us", &costs.plant, None),
        row(&format!("{scenario}: native engine / plant alone"), "1", &ratio, Some(NATIVE_GOAL)),
    ]
}

/// What a closed loop may cost against its plant alone.
const NATIVE_GOAL: f64 = 1.15;

/// What one sample may cost, ns: the fast tool servo turns 24 harmonics.
fn sample_goal(scenario: &str) -> f64 {
    if scenario == "fts" { 2000.0 } else { 1000.0 }
}

fn row(quantity: &str, unit: &'static str, samples: &statistics::Samples, goal: Option<f64>) -> Row {
    Row { quantity: quantity.to_owned(), unit, minimum: samples.minimum(), median: samples.median(), goal }
}

fn show(rows: &[Row]) -> String {
    let mut shown = table::new(&["quantity", "unit", "minimum", "median", "goal"]);
    for row in rows {
        let goal = row.goal.map(|goal| format!("<= {goal}")).unwrap_or_default();
        shown.add_row([
            row.quantity.clone(),
            row.unit.to_owned(),
            format!("{:.2}", row.minimum),
            format!("{:.2}", row.median),
            goal,
        ]);
    }
    shown.to_string()
}
