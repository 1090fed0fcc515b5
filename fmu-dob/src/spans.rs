//! Times in whole samples that every sample asks for; nothing that they are made of changes while a controller runs.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::detection::detector::Detector;
use crate::force::observer::forgetting;
use crate::interface::Parameters;

/// The observer knows the velocity of a stage that has just been found after this many times its 1 / g_v.
const FOUND: f64 = 10.0;

/// Numbers of samples.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Spans {
    /// Until the velocity of a stage that has just been found is known.
    pub tracked: u32,
    /// Until an acceleration has no effect on the observer.
    pub forgotten: u32,
    /// Until a bad position has no effect on observer and detector.
    pub memory: u32,
}

impl Spans {
    /// Those of these parameters.
    pub fn new(p: &Parameters) -> Self {
        Self {
            tracked: ticks(FOUND / p.observer.velocity_bandwidth, p.sample_period),
            forgotten: ticks(forgetting(p), p.sample_period),
            memory: Detector::memory(p),
        }
    }
}
