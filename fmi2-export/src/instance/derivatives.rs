//! Steps with inputs that are extrapolated by their derivatives.

use crate::exported::Exported;
use crate::instance::Instance;
use crate::instance::access::Refusal;
use crate::instance::clock::Clock;
use crate::instance::slope::{Derivative, Slope};
use crate::model::Experiment;
use crate::table::index::Entry;
use crate::table::variable::{Kind, Role};
use std::ops::Range;

impl<M: Exported> Instance<M> {
    #[cold]
    pub(super) fn run_with_derivatives(
        &mut self,
        experiment: Experiment,
        here: Clock,
        ticks: Range<u64>,
    ) -> Result<(), Refusal> {
        let slopes = self.take_slopes();
        let done = self.run(experiment, ticks, |vars, time, tick| {
            let apply = |slope: &Slope<M::Vars>| {
                slope
                    .apply(vars, here.until(tick))
                    .map_err(|value| endless(&M::INDEX.entries[slope.reference() as usize], slope, value, time))
            };
            slopes.iter().try_for_each(apply)
        });
        slopes.iter().for_each(|slope| slope.restore(&mut self.now.vars));
        done
    }

    /// The inputs that have derivatives, each with all of its own; they count for one step.
    fn take_slopes(&mut self) -> Vec<Slope<M::Vars>> {
        let mut derivatives = std::mem::take(&mut self.now.derivatives);
        derivatives.sort_by_key(|derivative| (derivative.reference, derivative.order));
        let slope = |derivatives: &[Derivative]| {
            let place = M::INDEX.entries[derivatives[0].reference as usize].input?;
            Slope::new(place, &self.now.vars, derivatives.to_vec())
        };
        derivatives.chunk_by(|a, b| a.reference == b.reference).filter_map(slope).collect()
    }

    /// All or nothing, as values; the last one of an order counts.
    pub(super) fn set_derivatives(&mut self, derivatives: &[Derivative]) -> Result<(), Refusal> {
        derivatives.iter().try_for_each(|derivative| self.check_derivative(derivative))?;
        for new in derivatives {
            let other = |old: &Derivative| (old.reference, old.order) != (new.reference, new.order);
            self.now.derivatives.retain(other);
            self.now.derivatives.push(*new);
        }
        Ok(())
    }

    pub(super) fn check_derivative(&self, derivative: &Derivative) -> Result<(), Refusal> {
        let Derivative { reference, order, value } = *derivative;
        let (row, element) = self.entry(reference)?;
        let name = row.element_name(element);
        if row.role() != Role::Input || !matches!(row.kind, Kind::Real { .. }) {
            return Err(Refusal::error(format!("`{name}` is no Real input")));
        }
        if order < 1 {
            return Err(Refusal::error(format!("`{name}`: order {order} is none, the lowest is 1")));
        }
        if !value.is_finite() {
            return Err(Refusal::error(format!("`{name}`: the derivative {value} is not finite")));
        }
        Ok(())
    }
}

#[cold]
fn endless<V>(entry: &Entry<V>, slope: &Slope<V>, value: f64, time: f64) -> Refusal {
    let (row, element) = entry.position();
    let (name, source) = (row.element_name(element), slope.to_text());
    Refusal::error(format!(
        "`{name}` = {value} at t = {time} s: extrapolated from {source}\nhint: Set smaller derivatives, or use a shorter step."
    ))
}
