//! The law that the parameters choose.

use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use crate::interface::{Law, Parameters};
use crate::law::centering::CenteringLaw;
use crate::paper::PaperLaw;
use crate::predictive::PredictiveLaw;

/// One of the two; it stands for the law that it holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum ActiveLaw {
    /// The paper's.
    Paper(Box<PaperLaw>),
    /// The default.
    Predictive(Box<PredictiveLaw>),
}

impl ActiveLaw {
    /// The law before its first sample.
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
