//! The control law that the parameters select.

use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use crate::interface::{Law, Parameters};
use crate::law::centering::CenteringLaw;
use crate::paper::PaperLaw;
use crate::predictive::PredictiveLaw;

/// One of the two control laws; calls are forwarded to it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum ActiveLaw {
    /// Published.
    Paper(Box<PaperLaw>),
    /// The default.
    Predictive(Box<PredictiveLaw>),
}

impl ActiveLaw {
    /// State before the first sample.
    pub fn new(p: &Parameters) -> Self {
        match p.law {
            Law::Paper => Self::Paper(Box::default()),
            Law::Default => Self::Predictive(Box::new(PredictiveLaw::new(p))),
        }
    }
}

impl Deref for ActiveLaw {
    type Target = dyn CenteringLaw;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Paper(law) => &**law,
            Self::Predictive(law) => &**law,
        }
    }
}

impl DerefMut for ActiveLaw {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Paper(law) => &mut **law,
            Self::Predictive(law) => &mut **law,
        }
    }
}
