//! The trait of all elements.

use dyn_clone::DynClone;

/// Names of the inputs and outputs of an element, in the order of the slices of [`Element::step`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ports {
    /// input names
    pub inputs: &'static [&'static str],
    /// output names
    pub outputs: &'static [&'static str],
}

/// One block of a plant: it reads its inputs and writes its outputs once per plant step.
///
/// The call at time `t` reads the inputs of `t`; its outputs act during `[t, t + h)`.
///
/// A copy of an element before its first step is its state at time zero.
pub trait Element: DynClone + Send + Sync {
    /// Names of the inputs and outputs.
    fn ports(&self) -> Ports;

    /// One plant step of `h` seconds; `h = 0` writes the outputs of time zero.
    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64);

    /// Reason why the plant cannot continue after the last step, with value, limit and hint; the step then ends here.
    fn stop(&self) -> Option<String> {
        None
    }
}

dyn_clone::clone_trait_object!(Element);
