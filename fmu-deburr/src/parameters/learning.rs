//! Parameters of the control patterns: how they are learned, stored and used.

use serde::{Deserialize, Serialize};

/// Most patterns of a bank.
pub const PATTERNS_MAX: usize = 9;

/// How a pattern is renewed after a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// c + e, the paper's.
    Plain = 1,
    /// Zero-phase low-pass of c + e shifted by the lead.
    LeadFilter = 2,
    /// c + (T'T + lambda)^-1 T' e with the nominal closed loop T.
    NormOptimal = 3,
}

/// Multiples of the taught speed at which patterns are learned, descending.
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

    /// The list.
    pub fn list(&self) -> &[f64] {
        &self.factors[..self.count]
    }
}

/// Learning of the control patterns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learn {
    /// How a pattern is renewed; default `LeadFilter` (derived), paper: `Plain`.
    pub law: Law,
    /// Multiples of the taught speed, 0.01 to 1, descending, up to 9; default 1.0 0.8 0.6 0.4 0.2 (paper).
    pub speeds: Speeds,
    /// Renewals of each pattern; 0 to 100, default 19 (paper).
    pub repetitions: i32,
    /// Keep the pattern with the smallest error instead of the last; default true (paper, 5.1: "abort the renewal").
    pub stop_at_best: bool,
    /// Start from the patterns of the bank, not from zero; default false (our choice: adapts a bank to another machine).
    pub from_bank: bool,
    /// Samples that the error is read ahead, beyond `servo.io_delay`; -6 to 8, default 2 (derived), paper: 0.
    pub lead: i32,
    /// Cut-off of the zero-phase filter, Hz; 0.1 to 400, default 20 (derived).
    pub cutoff: f64,
    /// Weight lambda of the change of the pattern, 1; 1e-6 to 1e3, default 0.01 (derived).
    pub weight: f64,
    /// Samples of a pattern before the start of the path; 8 to 100, default 10 (our choice: at least lead and preview).
    pub lead_in: i32,
    /// Samples of a pattern after the end of the path; 8 to 500, default 60 (our choice: 8 time constants 1/Kp).
    pub lead_out: i32,
    /// Largest pattern value, pulses; 1 to 1e9, default 32767 (paper: 16 bits).
    pub pulses_max: f64,
}

impl Learn {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        law: Law::LeadFilter,
        speeds: Speeds::PAPER,
        repetitions: 19,
        stop_at_best: true,
        from_bank: false,
        lead: 2,
        cutoff: 20.0,
        weight: 0.01,
        lead_in: 10,
        lead_out: 60,
        pulses_max: 32_767.0,
    };
}

/// Nominal velocity loop, eq. 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Natural frequency, rad/s; 10 to 1e5, default 280 (paper).
    pub natural_frequency: f64,
    /// Damping ratio, 1; 0.05 to 5, default 0.52 (paper).
    pub damping: f64,
}

impl Model {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { natural_frequency: 280.0, damping: 0.52 };
}

/// Use of the control patterns, eq. 2 to 4.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lookup {
    /// Compensate with the patterns in Playback and Deburr; default true.
    pub enable: bool,
    /// Compare with the speed that was recorded at the distance, not with the nominal one; default true (derived).
    pub recorded_speed: bool,
    /// Time by which the feed is known before the reference follows it, beyond `servo.io_delay`, s; -0.3 to 0.4, default
    /// 0.0037 (derived: the lag 2 zeta / wn of the velocity loop); the paper has none, 0 without delay.
    pub preview: f64,
}

impl Lookup {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { enable: true, recorded_speed: true, preview: 0.0037 };
}

/// What a bank is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// All digits and a checksum.
    Full = 1,
    /// The paper's 18 bytes for each sample, whole pulses.
    Records = 2,
}

/// Files of the control patterns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bank {
    /// What `bank.export` is written as; default `Full`.
    pub format: Format,
}

impl Bank {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { format: Format::Full };
}
