//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{ParameterError, check_all, require};

use crate::interface::{ERROR_HARMONICS, Parameters, SurfaceKind};

/// Checks all combinations; the first that fails is the error.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(p, &[tip_frequency, radii, roll_off, path_harmonics, automatic, frequencies])
}

fn tip_frequency(p: &Parameters) -> Result<(), ParameterError> {
    let (frequency, least) = (p.tip.frequency, 1.5 * p.servo.bandwidth);
    require(frequency == 0.0 || frequency >= least, || ParameterError {
        name: "tip.frequency",
        value: format!("{frequency} rad/s"),
        limit: format!("`0` (rigid) or at least `{least} rad/s`, 1.5 times `servo.bandwidth`"),
        hint: "use a stiffer arm or less `servo.bandwidth`",
    })
}

fn radii(p: &Parameters) -> Result<(), ParameterError> {
    let (inner, least) = (p.surface.inner_radius, p.surface.inner_radius + p.path.grid);
    require(p.surface.outer_radius >= least, || ParameterError {
        name: "surface.outer_radius",
        value: format!("{} m", p.surface.outer_radius),
        limit: format!("at least `{least} m`, one `path.grid` beyond `surface.inner_radius` = `{inner} m`"),
        hint: "the cut goes from the outer to the inner radius",
    })
}

fn roll_off(p: &Parameters) -> Result<(), ParameterError> {
    let least = 2.0 * p.servo.bandwidth;
    require(p.servo.roll_off >= least, || ParameterError {
        name: "servo.roll_off",
        value: format!("{} rad/s", p.servo.roll_off),
        limit: format!("at least `{least} rad/s`, twice `servo.bandwidth`"),
        hint: "the roll-off is for noise far above the bandwidth",
    })
}

fn path_harmonics(p: &Parameters) -> Result<(), ParameterError> {
    let least = p.surface.wave_harmonic;
    require(p.surface.kind != SurfaceKind::Wave || p.path.harmonics >= least, || ParameterError {
        name: "path.harmonics",
        value: p.path.harmonics.to_string(),
        limit: format!("at least `surface.wave_harmonic` = `{least}`"),
        hint: "the wave is a harmonic of the path, too",
    })
}

fn automatic(p: &Parameters) -> Result<(), ParameterError> {
    let highest = p.afc.cancelled.highest();
    require(!p.afc.automatic || highest <= ERROR_HARMONICS, || ParameterError {
        name: "afc.harmonics",
        value: format!("up to {highest}"),
        limit: format!("up to `{ERROR_HARMONICS}` with `afc.automatic`"),
        hint: "the choice is made from the reported harmonics of the error",
    })
}

fn frequencies(p: &Parameters) -> Result<(), ParameterError> {
    // five samples a period
    let (highest, most) = (p.identify.grid.highest(), 0.2 / p.sample_period);
    require(highest <= most, || ParameterError {
        name: "identify.frequencies",
        value: format!("{highest} Hz"),
        limit: format!("at most `{most} Hz`, a fifth of the sampling rate"),
        hint: "leave out the highest frequencies",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::refusal;

    fn error(change: impl FnOnce(&mut Parameters)) -> String {
        refusal(Parameters::START, change, check)
    }

    #[test]
    fn defaults_and_paper_mode_fit() {
        check(&Parameters::START).unwrap();
        check(&Parameters::PAPER).unwrap();
    }

    #[test]
    fn each_error_names_parameter_value_and_limit() {
        let cases = [
            (error(|p| p.tip.frequency = 1000.0), "tip.frequency", "`1000 rad/s`", "at least `2167"),
            (error(|p| p.surface.outer_radius = 0.0), "surface.outer_radius", "`0 m`", "`0.0005 m`"),
            (
                error(|p| p.identify.grid = "10, 2500".parse().unwrap()),
                "identify.frequencies",
                "`2500 Hz`",
                "`2000 Hz`",
            ),
            (error(|p| p.servo.roll_off = 2000.0), "servo.roll_off", "`2000 rad/s`", "`2890"),
            (error(|p| p.surface.kind = SurfaceKind::Wave), "path.harmonics", "`12`", "`surface.wave_harmonic` = `50`"),
            (
                error(|p| (p.afc.automatic, p.afc.cancelled) = (true, p.afc.cancelled.with(50))),
                "afc.harmonics",
                "`up to 50`",
                "up to `24`",
            ),
        ];
        for (message, name, value, limit) in cases {
            assert!(message.starts_with(&format!("parameter `{name}` is {value}")), "{message}");
            assert!(message.contains(limit) && message.contains("hint:"), "{message}");
        }
    }
}
