//! The two laws behind one face: what they see in a sample and what they answer.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::machine::{Fault, State, Verdict};
use crate::motion::Motion;
use crate::paper::Paper;
use crate::parameters::Parameters;
use crate::predictive::Predictive;
use crate::rates::Due;
use crate::reading::Sample;

/// How a ring is centred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// As in the paper.
    Paper = 1,
    /// Recursive model, pushes planned backwards from the centre.
    Predictive = 2,
}

/// What a law sees in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// State of the controller.
    pub state: State,
    /// Loops that run in this sample.
    pub due: Due,
    /// Smoothed unwrapped spindle angle, rad.
    pub angle: f64,
    /// Spindle speed, rad/s.
    pub speed: f64,
    /// The encoders.
    pub sample: Sample,
    /// Setpoint of the slide.
    pub setpoint: Trajectory,
}

/// A push that begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Launch {
    /// Travel of the slide, m.
    pub distance: f64,
    /// Velocity at contact, m/s.
    pub velocity: f64,
    /// Angle that the spindle turns until the end, rad.
    pub lead: f64,
    /// Slide position at the end, if the move is left to the motion, m.
    pub end: Option<f64>,
}

/// What is known of the ring, if that is something, and what to do.
pub type Conclusion = (Option<Estimate>, Verdict);

/// The law that the parameters choose.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Law {
    /// The paper's.
    Paper(Box<Paper>),
    /// The default.
    Predictive(Box<Predictive>),
}

impl Law {
    /// The law before its first sample.
    pub fn new(p: &Parameters) -> Self {
        match p.method {
            Method::Paper => Self::Paper(Box::default()),
            Method::Predictive => Self::Predictive(Box::new(Predictive::new(p))),
        }
    }

    /// Forgets everything, in place.
    pub fn restart(&mut self, p: &Parameters) {
        match self {
            Self::Paper(law) => **law = Paper::default(),
            Self::Predictive(law) => **law = Predictive::new(p),
        }
    }

    /// Takes a sample.
    pub fn observe(&mut self, p: &Parameters, now: &Moment) {
        match self {
            Self::Paper(law) => law.observe(p, now),
            Self::Predictive(law) => law.observe(p, now),
        }
    }

    /// Whether the data suffice for a model.
    pub fn collected(&self) -> bool {
        match self {
            Self::Paper(law) => law.collected(),
            Self::Predictive(_) => false,
        }
    }

    /// Estimate, if there is one, and verdict, in the beats in which the law makes them.
    ///
    /// # Errors
    /// The fault that prevents a model.
    pub fn conclude(&mut self, p: &Parameters, now: &Moment) -> Option<Result<Conclusion, Fault>> {
        match self {
            Self::Paper(law) => (now.state == State::Model && now.due.model).then(|| law.conclude(p)),
            Self::Predictive(law) => law.conclude(p, now).map(Ok),
        }
    }

    /// The push, in the sample of its launch.
    pub fn launch(&mut self, p: &Parameters, now: &Moment) -> Option<Launch> {
        match self {
            Self::Paper(law) => law.launch(p, now),
            Self::Predictive(law) => law.launch(p, now),
        }
    }

    /// What happens once, when `state` begins.
    pub fn enter(&mut self, p: &Parameters, state: State, now: &Moment) {
        match self {
            Self::Paper(law) => law.enter(p, state, now),
            Self::Predictive(law) => law.enter(p, state),
        }
    }

    /// Setpoint of a push that is not left to the motion.
    pub fn press(&mut self, p: &Parameters, now: &Moment) -> Option<Trajectory> {
        match self {
            Self::Paper(_) => None,
            Self::Predictive(law) => law.press(p, now),
        }
    }

    /// Whether the stroke of the push is over.
    pub fn stroke_over(&self, p: &Parameters, motion: &Motion) -> bool {
        match self {
            Self::Paper(_) => motion.arrived(p, p.push.dwell),
            Self::Predictive(law) => law.stroke_over(p),
        }
    }

    /// Learned offset, m.
    pub fn offset(&self) -> f64 {
        match self {
            Self::Paper(law) => law.offset(),
            Self::Predictive(law) => law.offset(),
        }
    }
}
