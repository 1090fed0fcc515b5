//! How much is measured.

/// Numbers of repeats and lengths.
pub struct Effort {
    /// Repeats of what takes microseconds.
    pub repeats: usize,
    /// Calls of a pass-through that are timed together.
    pub calls: u32,
    /// Runs of every closed loop.
    pub runs: u32,
    /// Most steps of a run whose controller is looked at.
    pub recorded: u32,
    /// Most steps of a run that is timed; more would not change the cost of a step.
    pub steps: u32,
    /// Runs of the sweep.
    pub sweep: u32,
    /// Runs of the study that is planned only.
    pub planned: u32,
    /// Whether the published control laws are measured, too, and the results stored.
    pub full: bool,
}

impl Effort {
    /// Numbers that mean something, in minutes.
    pub const FULL: Self = Self {
        repeats: 300,
        calls: 20_000,
        runs: 9,
        recorded: 60_000,
        steps: 10_000,
        sweep: 1000,
        planned: 100_000,
        full: true,
    };
    /// Everything runs, and numbers come out.
    pub const SHORT: Self =
        Self { repeats: 3, calls: 1000, runs: 1, recorded: 200, steps: 200, sweep: 10, planned: 1000, full: false };
}
