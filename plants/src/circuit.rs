//! Elements in the order in which they act, connected to memory locations.

use crate::element::Element;
use crate::place::Place;

/// The function that a stepper calls once per plant step.
#[derive(Default)]
pub struct Circuit {
    elements: Vec<Wired>,
    /// sums of outputs, zero at the start of a step
    sums: Vec<Place>,
    /// plant steps since the reset
    k: usize,
}

/// An element with its locations and buffers.
struct Wired {
    name: String,
    /// at time zero
    fresh: Box<dyn Element>,
    element: Box<dyn Element>,
    inputs: Vec<Place>,
    outputs: Vec<Place>,
    /// plant steps for which all inputs have a sample
    steps: usize,
    read: Vec<f64>,
    written: Vec<f64>,
}

/// Reason why a circuit could not make a step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepError {
    /// A signal has no sample for this step.
    Exhausted {
        /// name of the element
        element: String,
        /// name of its input
        input: &'static str,
        /// number of samples
        steps: usize,
    },
    /// An input is NaN or infinite.
    NotFinite {
        /// name of the element
        element: String,
        /// name of its input
        input: &'static str,
        /// the value
        value: f64,
    },
    /// The element reports that the plant cannot continue.
    Stopped {
        /// name of the element
        element: String,
        /// its message
        cause: String,
    },
}

impl Circuit {
    /// Appends an element with one location for each of its ports.
    pub fn bind(&mut self, name: String, element: Box<dyn Element>, inputs: Vec<Place>, outputs: Vec<Place>) {
        self.sums.extend(outputs.iter().copied().filter(Place::adds));
        let steps = inputs.iter().map(Place::steps).min().unwrap_or(usize::MAX);
        let (read, written) = (vec![0.0; inputs.len()], vec![0.0; outputs.len()]);
        self.elements.push(Wired { name, fresh: element.clone(), element, inputs, outputs, steps, read, written });
    }

    /// Back to time zero.
    pub fn reset(&mut self) {
        self.k = 0;
        for bound in &mut self.elements {
            bound.element = bound.fresh.clone();
        }
    }

    /// One plant step of `h` seconds: every element in order; locations with sums start at zero.
    ///
    /// # Errors
    /// When an input is not finite or has ended, or when an element cannot continue.
    pub fn step(&mut self, h: f64) -> Result<(), StepError> {
        self.sums.iter().for_each(Place::clear);
        for bound in &mut self.elements {
            bound.step(self.k, h)?;
        }
        self.k += 1;
        Ok(())
    }
}

impl Wired {
    fn step(&mut self, k: usize, h: f64) -> Result<(), StepError> {
        if !self.take(k)
            && let Some(error) = self.refused(k)
        {
            return Err(error);
        }
        self.element.step(&self.read, &mut self.written, h);
        for (place, value) in self.outputs.iter().zip(&self.written) {
            place.put(*value);
        }
        match self.element.stop() {
            Some(cause) => Err(StepError::Stopped { element: self.name.clone(), cause }),
            None => Ok(()),
        }
    }

    /// Reads the inputs of plant step `k`; returns whether all exist and are finite.
    fn take(&mut self, k: usize) -> bool {
        if k >= self.steps {
            return false;
        }
        let mut finite = true;
        for (number, place) in self.read.iter_mut().zip(&self.inputs) {
            *number = place.sample(k);
            finite &= number.is_finite();
        }
        finite
    }

    /// The first input of plant step `k` that has ended or is not finite.
    #[cold]
    fn refused(&self, k: usize) -> Option<StepError> {
        self.inputs.iter().zip(self.element.ports().inputs).find_map(|(place, &input)| {
            let (element, steps) = (self.name.clone(), place.steps());
            if k >= steps {
                return Some(StepError::Exhausted { element, input, steps });
            }
            let value = place.sample(k);
            (!value.is_finite()).then_some(StepError::NotFinite { element, input, value })
        })
    }
}
