//! What one sample of the contact detection costs while it watches for the contact.
//!
//! A small stage model brings the controller into its state Detect and records what it reads there; the recording is
//! then replayed from a saved state, so that every repeat does the same arithmetic and nothing but the FMU is timed.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use super::description::Description;
use super::slave::Slave;
use super::statistics::Samples;
use crate::fmu::{binary, build, controllers};
use crate::process;
use crate::workspace::Workspace;

const STEP: f64 = 1e-4;
const STEPS: u32 = 2_000;
const REPEATS: usize = 300;
const LONGEST_LEARNING: f64 = 3.0;
const SPINDLE_SPEED: f64 = 2094.4;

/// Cost of one set + doStep + get in the state Detect, in ns.
///
/// # Errors
/// When the build fails or the controller does not reach and keep the state Detect.
pub fn measure(workspace: &Workspace) -> Result<Samples> {
    let packages = controllers(workspace);
    let package = packages.into_iter().find(|package| *package.name == "fmu-dob").context("no package `fmu-dob`")?;
    let library = build::library(workspace, package)?.library;
    process::header("measure the contact detection");
    replay(&library)
}

fn replay(library: &Path) -> Result<Samples> {
    let (_, xml) =
        binary::files(library)?.into_iter().find(|(path, _)| path == "modelDescription.xml").context("no XML")?;
    let mut bench = Bench::new(library, &Description::parse(&xml)?)?;
    let first = bench.learn()?;
    let snapshot = bench.slave.snapshot()?;
    let recorded: Vec<f64> =
        (first..first + STEPS).map(|step| bench.stage.next(&bench.slave, &bench.wiring, step)).collect();
    bench.expect_detect()?;

    let mut samples = Vec::new();
    for _ in 0..REPEATS {
        snapshot.restore()?;
        let (mut current, mut faults) = ([0.0], 0);
        let start = Instant::now();
        for (step, position) in (first..).zip(&recorded) {
            let inputs = [*position, SPINDLE_SPEED];
            faults += bench.wiring.step(&bench.slave, &inputs, step, &mut current);
        }
        samples.push(start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS));
        ensure!(faults == 0, "a call of the FMU failed");
        bench.expect_detect()?;
    }
    Ok(Samples(samples))
}

struct Wiring {
    inputs: [u32; 2],
    current: u32,
}

impl Wiring {
    fn step(&self, slave: &Slave, inputs: &[f64; 2], step: u32, current: &mut [f64; 1]) -> i32 {
        slave.step((&self.inputs, inputs), f64::from(step) * STEP, STEP, (&[self.current], current))
    }
}

struct Bench {
    slave: Slave,
    wiring: Wiring,
    stage: Stage,
    state: u32,
    detect: i32,
}

impl Bench {
    fn new(library: &Path, description: &Description) -> Result<Self> {
        let slave = Slave::start(library, &description.guid)?;
        slave.set_boolean(description.reference("start")?, true)?;
        Ok(Self {
            slave,
            wiring: Wiring {
                inputs: [description.reference("position")?, description.reference("spindle_speed")?],
                current: description.reference("current")?,
            },
            stage: Stage::default(),
            state: description.reference("state")?,
            detect: description.item("State", "Detect")?,
        })
    }

    /// Steps until the controller has learned its threshold; the number of the next step.
    fn learn(&mut self) -> Result<u32> {
        let mut step = 0;
        while self.slave.integer(self.state)? != self.detect {
            ensure!(
                f64::from(step) * STEP < LONGEST_LEARNING,
                "the controller does not reach `Detect` in {LONGEST_LEARNING} s"
            );
            self.stage.next(&self.slave, &self.wiring, step);
            step += 1;
        }
        Ok(step)
    }

    fn expect_detect(&self) -> Result<()> {
        let state = self.slave.integer(self.state)?;
        ensure!(state == self.detect, "the controller left `Detect` for item {state}");
        Ok(())
    }
}

/// A 10 kg stage on a 20 N/A motor with an encoder of 1 nm and 0.5 nm of noise.
#[derive(Default)]
struct Stage {
    position: f64,
    velocity: f64,
    current: f64,
    noise: u64,
}

impl Stage {
    /// One sample: read, let the controller answer, move. The position it read, in m.
    fn next(&mut self, slave: &Slave, wiring: &Wiring, step: u32) -> f64 {
        let reading = ((self.position + 0.5e-9 * self.gaussian()) * 1e9).round() * 1e-9;
        let mut current = [0.0];
        wiring.step(slave, &[reading, SPINDLE_SPEED], step, &mut current);
        // the command acts one sample later
        self.velocity += STEP * 20.0 * self.current / 10.0;
        self.position += STEP * self.velocity;
        self.current = current[0];
        reading
    }

    // the sum of twelve uniform numbers has variance 1
    fn gaussian(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    // splitmix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014)
    fn uniform(&mut self) -> f64 {
        self.noise = self.noise.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.noise;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_has_mean_0_and_variance_1() {
        let mut stage = Stage::default();
        let values: Vec<f64> = (0..20_000).map(|_| stage.gaussian()).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
    }
}
