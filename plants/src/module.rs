//! Python module `plants._native`: one constructor per element, and the circuit that steps them.

use pyo3::prelude::*;

/// Native elements of the MuJoCo plants.
#[pymodule]
mod _native {
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    use crate::{
        Bristle, Burr, ColouredNoise, CurrentLoop, Deburring, Edge, Flute, Foot, Harmonics, InductionSpindle,
        Integrator, Latch, Limit, Lookup, Milling, MotionBoard, Outline, Peak, Plate, Product, Reaction, Rotation,
        Shapes, Slew, Stribeck, Sum, Thrust, Tip, TurnedPart, Turntable, Wrench,
    };

    #[pymodule_export]
    use crate::binding::{Cell, Circuit, Unbound};

    /// Elasto-plastic friction of a part on a table (N, friction law, m, N/m, N.s/m, break-away share).
    ///
    /// vx, vy, yaw_rate -> fx, fy, torque, all in the frame of the table. The law is static coefficient, kinetic
    /// coefficient and Stribeck speed in m/s.
    #[pyfunction]
    fn bristle(load: f64, law: (f64, f64, f64), radius: f64, stiffness: f64, damping: f64, break_away: f64) -> Unbound {
        Unbound::new(Bristle::new(load, stribeck(law), radius, stiffness, damping, break_away))
    }

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

    /// End mill on a burr of bins from a distance m on: heights and thicknesses m.
    ///
    /// The mill is teeth, radius m, Pa per chip cross-section, N/m of engaged edge, largest chip m. The reaction is
    /// the shares of the tangential force against the travel and outward, and the reach of the tool m.
    /// distance, normal, across, tx, ty, tz, nx, ny, nz, spindle_speed, part -> torque, force, fx, fy, fz, feed,
    /// engagement, finish_low, finish_high, removed, left.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Heights and thicknesses differ in number, or the pitch is not positive.
    #[pyfunction]
    fn deburring(
        bins: (f64, f64),
        heights: Vec<f64>,
        thicknesses: Vec<f64>,
        mill: (f64, f64, f64, f64, f64),
        reaction: (f64, f64, f64),
    ) -> PyResult<Unbound> {
        let (from, pitch) = bins;
        let refused = || PyValueError::new_err("a burr needs as many heights as thicknesses, and a positive pitch");
        let burr = Burr::new(from, pitch, heights, thicknesses).ok_or_else(refused)?;
        let (teeth, radius, pressure, edge_force, chip_most) = mill;
        let mill = Milling { teeth, radius, pressure, edge_force, chip_most };
        let (along, outward, reach) = reaction;
        Ok(Unbound::new(Deburring::new(burr, mill, Reaction { along, outward, reach })))
    }

    /// Edge of line, arc, line over a corner of `radius` m: x, y, z -> distance, normal, across, tx, ty, tz, nx, ny, nz.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The lines are too short for the radius.
    #[pyfunction]
    fn edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<Unbound> {
        Ok(Unbound::new(corner_edge(start, corner, end, radius)?))
    }

    /// Length of such an edge, m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The lines are too short for the radius.
    #[pyfunction]
    fn edge_length(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<f64> {
        Ok(corner_edge(start, corner, end, radius)?.length())
    }

    /// Cutting edge on a tilted tool (m, m, rad): angle -> retreat behind the longest point.
    #[pyfunction]
    fn flute(shortfall: f64, tilt: f64, offset: f64) -> Unbound {
        Unbound::new(Flute::new(shortfall, tilt, offset))
    }

    /// Foot at `place` m on a part that slides, with a friction law: yaw, vx, vy, yaw_rate -> mu_1, mu_2.
    ///
    /// The law is static coefficient, kinetic coefficient and Stribeck speed in m/s.
    #[pyfunction]
    fn foot(place: (f64, f64), law: (f64, f64, f64)) -> Unbound {
        Unbound::new(Foot::new(place, stribeck(law)))
    }

    /// Harmonics 1, 2, ... as (amplitude, phase in rad): angle -> value.
    #[pyfunction]
    fn harmonics(orders: Vec<(f64, f64)>) -> Unbound {
        Unbound::new(Harmonics::new(orders))
    }

    /// Spindle with an induction motor: load -> speed, measured speed, torque of the motor, N.m and rad/s.
    ///
    /// The plate is synchronous and rated speed rad/s, rated power W, breakdown over rated torque, time constant s.
    #[pyfunction]
    fn induction_spindle(plate: (f64, f64, f64, f64, f64), friction: f64, lag: f64) -> Unbound {
        let (synchronous, rated_speed, rated_power, overload, time) = plate;
        let plate = Plate { synchronous, rated_speed, rated_power, overload, time };
        Unbound::new(InductionSpindle::new(plate, friction, lag))
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

    /// Range in which the plant means something: value -> nothing; the step fails outside.
    #[pyfunction]
    fn limit(quantity: String, unit: String, low: f64, high: f64, hint: String) -> Unbound {
        Unbound::new(Limit::new(quantity, unit, low, high, hint))
    }

    /// Periodic table of one turn, linear between its samples: angle -> value.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no sample.
    #[pyfunction]
    fn lookup(samples: Vec<f64>) -> PyResult<Unbound> {
        Ok(Unbound::new(table(samples)?))
    }

    /// Servo of one axis (N/m, N.s/m, N, s): position_setpoint, velocity_setpoint, position, velocity -> force.
    #[pyfunction]
    fn motion_board(stiffness: f64, damping: f64, force_limit: f64, period: f64) -> Unbound {
        Unbound::new(MotionBoard::new(stiffness, damping, force_limit, period))
    }

    /// Round part with a table of its radius over one turn, m, met by the line y = 0.
    ///
    /// cx, cy, vcx, vcy, orientation, turn_rate -> surface, normal_x, normal_y, vx, vy, phase.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no sample.
    #[pyfunction]
    fn outline(radius: Vec<f64>) -> PyResult<Unbound> {
        Ok(Unbound::new(Outline::new(table(radius)?)))
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

    /// One-sided spring with friction (N, m, N/m, N.s/m, 1) that presses on a surface along the line y = 0.
    ///
    /// tip, tip_speed, surface, normal_x, normal_y, vx, vy -> collapse, force, fx, fy.
    #[pyfunction]
    fn tip(preload: f64, ramp: f64, stiffness: f64, damping: f64, friction: f64) -> Unbound {
        Unbound::new(Tip { preload, ramp, stiffness, damping, friction })
    }

    /// Part that a tool turns and a probe reads, all m:
    /// angle, lateral, depth, cutting, normal, probing, probe -> reading.
    #[pyfunction]
    fn turned_part(tool_radius: f64, probe_radius: f64, part_radius: f64, face: f64, roughness: f64) -> Unbound {
        Unbound::new(TurnedPart::new(Shapes { tool_radius, probe_radius, part_radius, face, roughness }))
    }

    /// Part on a turning table, seen from the room.
    ///
    /// angle, rate, x, y, yaw, vx, vy, yaw_rate, error_x, error_y -> cx, cy, vcx, vcy, orientation, turn_rate,
    /// eccentricity, slip_speed.
    #[pyfunction]
    fn turntable() -> Unbound {
        Unbound::new(Turntable)
    }

    /// Force on a part on a turning table: fx, fy, place, cx, cy, angle -> table, x, y, torque.
    #[pyfunction]
    fn wrench() -> Unbound {
        Unbound::new(Wrench)
    }

    fn corner_edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<Edge> {
        let refused = || {
            let hint = "hint: start, corner and end of the edge are too near for it";
            PyValueError::new_err(format!("radius of the corner: `{radius}` m\n{hint}"))
        };
        Edge::new(start, corner, end, radius).ok_or_else(refused)
    }

    fn stribeck((at_rest, kinetic, speed): (f64, f64, f64)) -> Stribeck {
        Stribeck { at_rest, kinetic, speed }
    }

    fn table(samples: Vec<f64>) -> PyResult<Lookup> {
        Lookup::new(samples).ok_or_else(|| PyValueError::new_err("a table needs at least one sample"))
    }
}
