//! Interface of a control law: its observations in a sample and its results.

use control_blocks::Trajectory;

use crate::center::Estimate;
use crate::interface::{Fault, Parameters, State};
use crate::motion::Motion;
use crate::sensing::{Due, Sample};

/// Observations of a control law in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
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
    /// Bandwidth of the slide servo, configured or measured, rad/s.
    pub bandwidth: f64,
    /// Whether the probe was found to be delayed relative to the slide.
    pub late: bool,
}

/// A push that starts.
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

/// Conclusion from the model of the ring for the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// The ring is centered.
    Centered,
    /// A push is needed.
    Push,
    /// More data are needed.
    Measure,
    /// More data would not help.
    Unresolved,
}

/// The estimate of the ring, if there is one, and the next step.
pub type Conclusion = (Option<Estimate>, Decision);

/// A control law measures the ring and plans pushes.
pub trait CenteringLaw {
    /// Resets everything, in place.
    fn restart(&mut self, p: &Parameters);

    /// Takes a sample.
    fn observe(&mut self, p: &Parameters, now: &Observation);

    /// Whether the data suffice for a model.
    fn collected(&self) -> bool;

    /// Estimate and verdict, in the samples in which they are computed.
    ///
    /// # Errors
    /// The fault that prevents a model.
    fn conclude(&mut self, p: &Parameters, now: &Observation) -> Option<Result<Conclusion, Fault>>;

    /// The push, in the sample of its launch.
    fn launch(&mut self, p: &Parameters, now: &Observation) -> Option<Launch>;

    /// Actions at the start of `state`.
    fn enter(&mut self, p: &Parameters, state: State, now: &Observation);

    /// Setpoint of a push that is not left to the motion.
    fn press(&mut self, p: &Parameters, now: &Observation) -> Option<Trajectory>;

    /// Whether the surface differs too much from the model while the slide approaches for a push.
    fn diverged(&self, p: &Parameters) -> bool;

    /// Intended excess of the setpoint over the stroke of a push, m.
    fn ahead(&self) -> f64;

    /// Whether the stroke of the push is over.
    fn stroke_over(&self, p: &Parameters, motion: &Motion) -> bool;

    /// Learned offset, m.
    fn offset(&self) -> f64;
}
