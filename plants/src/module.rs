//! Python module `plants._native`: one constructor per element, and the circuit that steps them.

use pyo3::prelude::*;

/// Native elements of the MuJoCo plants.
#[pymodule]
mod _native {
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    use crate::{
        ColouredNoise, CurrentLoop, Flute, Harmonics, Integrator, Latch, Peak, Product, Rotation, Shapes, Slew, Sum,
        Thrust, TurnedPart,
    };

    #[pymodule_export]
    use crate::binding::{Cell, Circuit, Unbound};

    /// Noise of standard deviation `rms` and correlation time `time` s: normal -> value.
    #[pyfunction]
    fn coloured_noise(rms: f64, time: f64) -> Unbound {
        Unbound::new(ColouredNoise::new(rms, time))
    }

    /// First-order current loop of `bandwidth` rad/s: command, noise -> current, all A.
    #[pyfunction]
    fn current_loop(bandwidth: f64) -> Unbound {
        Unbound::new(CurrentLoop::new(bandwidth))
    }

    /// Cutting edge on a tilted tool (m, m, rad): angle -> retreat behind the longest point.
    #[pyfunction]
    fn flute(shortfall: f64, tilt: f64, offset: f64) -> Unbound {
        Unbound::new(Flute::new(shortfall, tilt, offset))
    }

    /// Harmonics 1, 2, ... as (amplitude, phase in rad): angle -> value.
    #[pyfunction]
    fn harmonics(orders: Vec<(f64, f64)>) -> Unbound {
        Unbound::new(Harmonics::new(orders))
    }

    /// Integral that starts at `start`: value -> integral at the start of the step.
    #[pyfunction]
    fn integrator(start: f64) -> Unbound {
        Unbound::new(Integrator::new(start))
    }

    /// Memory of an event: value -> 1 from the first positive value on, 0 before.
    #[pyfunction]
    fn latch() -> Unbound {
        Unbound::new(Latch::new())
    }

    /// Largest value so far: value -> maximum.
    #[pyfunction]
    fn peak() -> Unbound {
        Unbound::new(Peak::new())
    }

    /// Product of two values: a, b -> a b.
    #[pyfunction]
    fn product() -> Unbound {
        Unbound::new(Product::new())
    }

    /// Shaft that starts at `start` rad: speed -> angle at the start of the step, angle at its end.
    #[pyfunction]
    fn rotation(start: f64) -> Unbound {
        Unbound::new(Rotation::new(start))
    }

    /// Set-point that starts at `start` and changes by `rate` per second at most: target -> value.
    #[pyfunction]
    fn slew(start: f64, rate: f64) -> Unbound {
        Unbound::new(Slew::new(start, rate))
    }

    /// Sum of `terms` inputs: a, b, ... -> sum.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     More terms than a sum can have.
    #[pyfunction]
    fn summing_junction(terms: usize) -> PyResult<Unbound> {
        let limit = Sum::TERMS_MAX;
        let refused = || PyValueError::new_err(format!("`terms` of a sum: `{terms}`, limit `{limit}`"));
        Ok(Unbound::new(Sum::new(terms).ok_or_else(refused)?))
    }

    /// Linear motor (N/A, relative ripple, ripple period m, phase rad): current, position -> force.
    #[pyfunction]
    fn thrust(force_constant: f64, ripple: f64, pitch: f64, phase: f64) -> Unbound {
        Unbound::new(Thrust::new(force_constant, ripple, pitch, phase))
    }
    /// Part that a tool turns and a probe reads, all m:
    /// angle, lateral, depth, cutting, normal, probing, probe -> reading.
    #[pyfunction]
    fn turned_part(tool_radius: f64, probe_radius: f64, part_radius: f64, face: f64, roughness: f64) -> Unbound {
        Unbound::new(TurnedPart::new(Shapes { tool_radius, probe_radius, part_radius, face, roughness }))
    }
}
