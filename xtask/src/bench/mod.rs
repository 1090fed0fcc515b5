//! `cargo xtask bench`: what FMI, every controller and every closed loop cost, taken in one run.

pub mod description;
pub mod effort;
pub mod isolation;
pub mod library;
pub mod life;
pub mod loops;
pub mod pass_through;
pub mod planning;
pub mod recording;
pub mod report;
pub mod slave;
pub mod start_up;
pub mod statistics;
pub mod sweep;
pub mod tick;
pub mod yardstick;

use std::fs;

use anyhow::{Context, Result};

use crate::fmu;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;
use effort::Effort;
use library::Fmu;
use report::Row;
use statistics::Summary;

// The goals are shown next to the measured values; a missed goal is not an error.
/// Maximum time of the calls of a Rust pass-through, over that of a C FMU with the same checks.
const CALL_GOAL: f64 = 1.5;
/// Maximum time of one sample, ns.
const SAMPLE_GOAL: f64 = 1000.0;
/// Maximum time of the exit of the initialization mode, us.
const EXIT_GOAL: f64 = 10_000.0;
/// Maximum processor time of `cosim --help` and `cosim list`, over that of a Python that does nothing.
const HELP_GOAL: f64 = 10.0;
const LIST_GOAL: f64 = 20.0;
/// The same in processor time, s.
const START_UP_GOALS: (f64, f64) = (0.2, 0.4);
/// Maximum time of a step of the native engine, over that of its plant alone, and over that of MuJoCo's bare steps.
const NATIVE_GOAL: f64 = 1.08;
const BARE_GOAL: f64 = 1.25;
/// Maximum ratio of twice the rate of one core that does only the runs to the rate of a sweep on two workers.
const SWEEP_GOAL: f64 = 1.0 / 0.9;
/// Maximum wall time that the isolation in a separate process adds to a run, s.
const ISOLATION_GOAL: f64 = 0.05;
/// Maximum time (s) and memory (MB) for planning a study of 100,000 runs.
const PLANNING_GOALS: (f64, f64) = (10.0, 200.0);

/// Measures everything, or only what belongs to some scenarios, and prints the table.
///
/// They are written to `target/bench/bench.json`, but not those of the short form.
///
/// # Errors
/// When something that is measured does not build or run, or a number cannot be one.
pub fn run(workspace: &Workspace, effort: &Effort, scenarios: &[String]) -> Result<()> {
    setup::run(workspace)?;
    fmu::pack_all(workspace, &fmu::controllers(workspace))?;
    let folder = workspace.path("target/bench");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make `{}`", folder.display()))?;

    let checked = yardstick::checked(workspace, &folder)?;
    let mut rows = Vec::new();
    if scenarios.is_empty() {
        rows.extend(pass_through_rows(&pass_through::measure(workspace, &folder, &checked, effort)?));
        for scenario in workspace.loops()? {
            rows.extend(loop_rows(workspace, &scenario, &checked, effort)?);
            let paper = format!("{scenario}/paper");
            if effort.full && workspace.path(format!("scenarios/{paper}.toml")).is_file() {
                rows.extend(controller_rows(workspace, &paper, &checked, effort)?);
            }
        }
        rows.extend(sweep_rows(&sweep::measure(workspace, effort)?));
        rows.extend(planning_rows(&planning::measure(workspace, effort)?));
        rows.extend(start_up_rows(&start_up::measure(workspace, effort)?));
        rows.extend(isolation_rows(&isolation::measure(workspace, effort)?));
    }
    for scenario in scenarios {
        rows.extend(loop_rows(workspace, scenario, &checked, effort)?);
    }
    println!("{}", report::show(&rows));
    report::check(&rows)?;
    if effort.full { write(workspace, &rows) } else { Ok(()) }
}

fn write(workspace: &Workspace, rows: &[Row]) -> Result<()> {
    let file = "target/bench/bench.json";
    fs::write(workspace.path(file), serde_json::to_string_pretty(rows)? + "\n")
        .with_context(|| format!("cannot write `{file}`"))?;
    process::header(&format!("results are in `{file}`"));
    Ok(())
}

fn pass_through_rows(costs: &pass_through::PassThroughCosts) -> Vec<Row> {
    vec![
        Row::new("set + doStep + get: Rust pass-through", "ns", costs.rust),
        Row::new("set + doStep + get: C FMU with the checks of FMI 2.0", "ns", costs.checked_c),
        Row::new("set + doStep + get: C FMU without any check", "ns", costs.bare_c),
        Row::ratio("Rust pass-through / C FMU with checks", costs.rust.over(costs.checked_c)).goal(CALL_GOAL),
        Row::ratio("Rust pass-through / C FMU without any check", costs.rust.over(costs.bare_c)),
    ]
}

/// Everything about one closed loop.
fn loop_rows(workspace: &Workspace, scenario: &str, checked: &Fmu, effort: &Effort) -> Result<Vec<Row>> {
    let mut rows = controller_rows(workspace, scenario, checked, effort)?;
    rows.extend(reference_rows(scenario, &loops::reference(workspace, scenario, effort)?));
    rows.extend(native_rows(scenario, &loops::native(workspace, scenario, effort)?));
    Ok(rows)
}

/// Costs of the FMU of a scenario without its plant: sample, initialization, life cycle, saved states.
fn controller_rows(workspace: &Workspace, scenario: &str, checked: &Fmu, effort: &Effort) -> Result<Vec<Row>> {
    let recording = recording::record(workspace, scenario, effort)?;
    let tick =
        tick::measure(&recording, checked, effort).with_context(|| format!("cannot replay the FMU of `{scenario}`"))?;
    let life = life::measure(&recording, checked, effort)?;
    let microseconds = |time: Summary| Summary { minimum: 1e-3 * time.minimum, median: 1e-3 * time.median };
    Ok(vec![
        Row::new(format!("{scenario}: one sample in its busiest state, {}", tick.state), "ns", tick.sample)
            .goal(SAMPLE_GOAL),
        Row::ratio("  / the calls of the C FMU with checks", tick.sample.over(tick.checked_c)),
        Row::new(format!("{scenario}: slowest sample of the run"), "us", microseconds(tick.slowest))
            .goal(1e6 * recording.step),
        Row::new(format!("{scenario}: exit of the initialization"), "us", life.exit).goal(EXIT_GOAL),
        Row::new(format!("{scenario}: life of an instance without a step"), "us", life.life.own),
        Row::ratio("  / that of the C FMU with checks", life.life.own.over(life.life.checked_c)),
        Row::new(format!("{scenario}: save and restore the state"), "us", life.state.own),
        Row::ratio("  / that of the C FMU with checks", life.state.own.over(life.state.checked_c)),
    ])
}

fn reference_rows(scenario: &str, costs: &loops::ReferenceLoopCosts) -> Vec<Row> {
    let (step, plant) = (costs.step.summary(), costs.plant.summary());
    vec![
        Row::ratio(format!("{scenario}: simulated time / wall time"), costs.real_time_factor.summary()),
        Row::new(format!("{scenario}: one step of the reference loop"), "us", step),
        Row::new("  of which the FMU, called through FMPy", "us", costs.fmu.summary()),
        Row::new("  of which the plant", "us", plant),
        Row::new("  of which wiring, noise, trace", "us", costs.rest.summary()),
        Row::ratio(format!("{scenario}: reference loop / its plant"), step.over(plant)),
    ]
}

fn native_rows(scenario: &str, costs: &loops::NativeLoopCosts) -> Vec<Row> {
    let (native, served) = (costs.native.summary(), costs.served.summary());
    let (plant, bare) = (costs.plant.summary(), costs.bare.summary());
    vec![
        Row::ratio(format!("{scenario}: simulated time / wall time, native engine"), costs.real_time_factor.summary()),
        Row::new(format!("{scenario}: one step of the native engine"), "us", native),
        Row::new(format!("{scenario}: one step of the plant alone, same commands"), "us", plant),
        Row::new(format!("{scenario}: MuJoCo's bare steps in it"), "us", bare),
        Row::ratio(format!("{scenario}: native engine / plant alone"), native.over(plant)).goal(NATIVE_GOAL),
        Row::ratio("  of which the calls of the FMU: plant with them / plant alone", served.over(plant)),
        Row::ratio("  of which the engine: native engine / plant with the calls of the FMU", native.over(served)),
        Row::ratio(format!("{scenario}: native engine / MuJoCo's bare steps"), native.over(bare)).goal(BARE_GOAL),
    ]
}

fn sweep_rows(costs: &sweep::SweepCosts) -> Vec<Row> {
    let once = Summary::once;
    vec![
        Row::new("sweep on 2 workers: runs", "1/s", once(costs.rate)),
        Row::ratio("2 x rate of one core alone / rate of the sweep", once(1.0 / costs.throughput)).goal(SWEEP_GOAL),
        Row::ratio("  rate of 2 cores that only run, in parallel / rate of the sweep", once(1.0 / costs.beside)),
        Row::ratio("  processor time of the sweep / of the runs alone, in parallel", once(costs.processor)),
        Row::new("memory of all its processes", "MB", once(costs.memory)),
        Row::ratio("  / that of a fifth of the runs", once(costs.growth)).goal(1.1),
    ]
}

fn planning_rows(costs: &planning::PlanningCosts) -> Vec<Row> {
    let (time, memory) = PLANNING_GOALS;
    vec![
        Row::new("plan of a large study: time", "s", Summary::once(costs.time)).goal(time),
        Row::new("  memory of its process", "MB", Summary::once(costs.memory)).goal(memory),
    ]
}

fn start_up_rows(costs: &start_up::StartUpCosts) -> Vec<Row> {
    let (nothing, help, list) = (costs.nothing.summary(), costs.help.summary(), costs.list.summary());
    vec![
        Row::new("processor time of `python -c pass`", "s", nothing),
        Row::new("processor time of `cosim --help`", "s", help).goal(START_UP_GOALS.0),
        Row::new("processor time of `cosim list`", "s", list).goal(START_UP_GOALS.1),
        Row::ratio("`cosim --help` / `python -c pass`", help.over(nothing)).goal(HELP_GOAL),
        Row::ratio("`cosim list` / `python -c pass`", list.over(nothing)).goal(LIST_GOAL),
    ]
}

fn isolation_rows(costs: &isolation::IsolationCosts) -> Vec<Row> {
    let (isolated, in_process) = (costs.isolated.summary(), costs.in_process.summary());
    vec![
        Row::new("`cosim run --in-process` of next to no simulated time", "s", in_process),
        Row::new("  the same in a process of its own", "s", isolated).goal(in_process.minimum + ISOLATION_GOAL),
    ]
}
