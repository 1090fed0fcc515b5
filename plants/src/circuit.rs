//! Elements in the order in which they act, tied to places in memory.

use crate::element::Element;
use crate::place::Place;

/// What any stepper calls once per plant step.
#[derive(Default)]
pub struct Circuit {
    elements: Vec<Wired>,
    /// plant steps since the reset
    k: usize,
}

/// An element with its places and room for its numbers.
struct Wired {
    name: String,
    /// at time zero
    fresh: Box<dyn Element>,
    element: Box<dyn Element>,
    inputs: Vec<Place>,
    outputs: Vec<Place>,
    read: Vec<f64>,
    written: Vec<f64>,
}

/// Why a circuit could not make a step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepError {
    /// A signal has no sample for this step.
    Exhausted {
        /// name of the element
        element: String,
        /// name of its input
        input: &'static str,
        /// samples that there are
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
    /// The element says that the plant cannot go on.
    Stopped {
        /// name of the element
        element: String,
        /// its words
        cause: String,
    },
}

impl Circuit {
    /// Appends an element with one place for each of its ports.
    pub fn bind(&mut self, name: String, element: Box<dyn Element>, inputs: Vec<Place>, outputs: Vec<Place>) {
        let (read, written) = (vec![0.0; inputs.len()], vec![0.0; outputs.len()]);
        self.elements.push(Wired { name, fresh: element.clone(), element, inputs, outputs, read, written });
    }

    /// Back to time zero.
    pub fn reset(&mut self) {
        self.k = 0;
        for bound in &mut self.elements {
            bound.element = bound.fresh.clone();
        }
    }

    /// One plant step of `h` seconds: every element in order; places that are added to start at zero.
    ///
    /// # Errors
    /// When an input is not finite or has ended, or when an element cannot go on.
    pub fn step(&mut self, h: f64) -> Result<(), StepError> {
        let outputs = self.elements.iter().flat_map(|bound| &bound.outputs);
        outputs.filter(|place| place.adds()).for_each(Place::clear);
        for bound in &mut self.elements {
            bound.step(self.k, h)?;
        }
        self.k += 1;
        Ok(())
    }
}

impl Wired {
    fn step(&mut self, k: usize, h: f64) -> Result<(), StepError> {
        for (port, place) in self.inputs.iter().enumerate() {
            let input = || (self.name.clone(), self.element.ports().inputs[port]);
            if k >= place.steps() {
                let (element, input) = input();
                return Err(StepError::Exhausted { element, input, steps: place.steps() });
            }
            let value = place.sample(k);
            if !value.is_finite() {
                let (element, input) = input();
                return Err(StepError::NotFinite { element, input, value });
            }
            self.read[port] = value;
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
}
