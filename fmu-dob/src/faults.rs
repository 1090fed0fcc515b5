//! Every fault is found here, the gravest first; and the numbers that are told with it.

use crate::interface::{Fault, Parameters, ThresholdOutput, Vars};
use crate::reading::Reading;

/// What faults are found in.
pub struct Symptoms<'a> {
    /// The inputs of this sample.
    pub reading: &'a Reading,
    /// Samples in a row with the current at its limit.
    pub limited: u32,
    /// The approach, stopped now, would end beyond its longest travel.
    pub travelled: bool,
    /// What has just been learned.
    pub learned: Option<ThresholdOutput>,
}

/// The gravest fault of this sample.
pub fn find(p: &Parameters, symptoms: &Symptoms) -> Option<Fault> {
    let Symptoms { reading, limited, travelled, learned } = symptoms;
    let faults = [
        (Fault::InvalidInput, reading.invalid),
        (Fault::LostSync, reading.lost > p.limits.lost_samples.unsigned_abs()),
        (Fault::Saturation, *limited > p.limits.saturated_samples.unsigned_abs()),
        (Fault::TravelLimit, *travelled),
        (Fault::LearnRejected, learned.is_some_and(|learned| !learned.plausible(p.limits.slope_sigma_max))),
    ];
    faults.into_iter().find_map(|(fault, found)| found.then_some(fault))
}

/// The numbers behind the fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let (p, output) = (&vars.in_force, &vars.output);
    match output.fault {
        Fault::None => String::new(),
        Fault::TravelLimit => format!(": `{} m`", p.approach.travel_max),
        Fault::LostSync => format!(": more than `limits.lost_samples` = `{}`", p.limits.lost_samples),
        Fault::Saturation => format!(": more than `limits.saturated_samples` = `{}`", p.limits.saturated_samples),
        Fault::LearnRejected => format!(
            ": mean `{} N/s`, sigma `{} N/s`, limit `limits.slope_sigma_max` = `{} N/s`",
            output.threshold.mean, output.threshold.sigma, p.limits.slope_sigma_max
        ),
        Fault::InvalidInput => format!(": `{} m`, `{} rad/s`", vars.input.position, vars.input.spindle_speed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Reading = Reading {
        position: Some(0.0),
        spindle_speed: 0.0,
        enabled: true,
        begin: false,
        reset: false,
        found: false,
        invalid: false,
        lost: 0,
    };
    const NOISE: ThresholdOutput = ThresholdOutput { sigma: 1.0, ..ThresholdOutput::START };

    fn symptoms(reading: &Reading) -> Symptoms<'_> {
        Symptoms { reading, limited: 0, travelled: false, learned: Some(NOISE) }
    }

    #[test]
    fn each_limit_is_the_last_value_without_a_fault() {
        let mut p = Parameters::START;
        (p.limits.lost_samples, p.limits.saturated_samples, p.limits.slope_sigma_max) = (7, 9, 1.0);
        let lost = |lost| find(&p, &symptoms(&Reading { position: None, lost, ..GOOD }));
        assert_eq!([lost(7), lost(8)], [None, Some(Fault::LostSync)]);
        let limited = |limited| find(&p, &Symptoms { limited, ..symptoms(&GOOD) });
        assert_eq!([limited(9), limited(10)], [None, Some(Fault::Saturation)]);
        let learned = |sigma| {
            let learned = Some(ThresholdOutput { sigma, ..NOISE });
            find(&p, &Symptoms { learned, ..symptoms(&GOOD) })
        };
        assert_eq!([learned(1.0), learned(1.1)], [None, Some(Fault::LearnRejected)]);
    }

    #[test]
    fn the_gravest_fault_is_named() {
        let p = Parameters::START;
        let reading = Reading { position: None, invalid: true, lost: 100, ..GOOD };
        let all = Symptoms { reading: &reading, limited: 100, travelled: true, learned: Some(ThresholdOutput::START) };
        assert_eq!(find(&p, &all), Some(Fault::InvalidInput));
        assert_eq!(find(&p, &Symptoms { reading: &GOOD, ..all }), Some(Fault::Saturation));
        assert_eq!(find(&p, &Symptoms { reading: &GOOD, limited: 0, ..all }), Some(Fault::TravelLimit));
    }

    #[test]
    fn every_fault_tells_its_numbers() {
        for &fault in Fault::ALL {
            let mut vars = <Vars as fmi2_export::Interface>::START;
            vars.output.fault = fault;
            assert_eq!(numbers(&vars).is_empty(), fault == Fault::None, "{fault:?}");
        }
    }
}
