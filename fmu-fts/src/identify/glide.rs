//! From one tone to the next: both amplitude and frequency glide along a power law, on which torque and acceleration stay
//! between those of the tones.

use crate::identify::tone::Tone;

/// Part of a glide of `length` samples that is over after `tick` of them; it begins and ends level.
pub fn progress(tick: u32, length: u32) -> f64 {
    let time = (f64::from(tick + 1) / f64::from(length)).min(1.0);
    time * time * (3.0 - 2.0 * time)
}

/// Amplitude (rad) and frequency (periods in a sample) at this part of the way between two tones; from or to rest where
/// there is none.
pub fn glide(progress: f64, from: Option<&Tone>, to: Option<&Tone>) -> (f64, f64) {
    let between = |from: f64, to: f64| from * (to / from).powf(progress);
    match (from, to) {
        (_, Some(now)) if progress >= 1.0 => (now.amplitude, now.frequency()),
        (Some(old), Some(new)) => (between(old.amplitude, new.amplitude), between(old.frequency(), new.frequency())),
        (None, Some(first)) => (progress * first.amplitude, first.frequency()),
        (Some(last), None) => ((1.0 - progress) * last.amplitude, last.frequency()),
        (None, None) => (0.0, 0.0),
    }
}
