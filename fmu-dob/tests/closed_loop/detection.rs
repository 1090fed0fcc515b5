//! Detection depth and contact position over seeded approaches, for every detector.

use fmu_dob::interface::{ContactSource, DetectorKind, Fault, Parameters, State, ThresholdMode};

use crate::run::Loop;
use crate::slide::STEP;

/// Depth, accuracy and contact time of one approach to a workpiece.
struct Outcome {
    /// Largest travel past the first possible touch, um.
    depth: f64,
    /// Whether the stop came before the touch.
    early: bool,
    source: ContactSource,
    /// Detected position minus surface, um.
    late: f64,
    /// Contact force gone after the detection, ms.
    release: f64,
}

/// One approach from `seed` to a surface that the stage meets 0.15 to 0.35 s after the detector is armed.
fn approach(p: &Parameters, seed: u64) -> Outcome {
    let armed = p.learn.settle_time + p.learn.time;
    let waiting = 0.15 + 0.2 * ((seed * 7919) % 1000) as f64 / 1000.0;
    let surface = p.approach.velocity * (armed + waiting);
    let mut run = Loop::new(p, seed, surface);
    assert!(run.run_to(State::Contact, 5.0), "seed {seed}: {:?}", run.output);
    assert!((run.output.contact_time - (run.time() - STEP)).abs() < 1e-9, "{:?}", run.output);
    let (early, source) = (run.slide.touch.is_none(), run.output.contact_source);
    let mut released = run.time();
    // one that the guard found ends in `LateContact`
    while !matches!(run.output.state, State::Done | State::Fault) {
        assert!(run.time() < 5.0, "seed {seed}: {:?}", run.output);
        run.step();
        if run.slide.contact_force > 0.0 {
            released = run.time();
        }
    }
    let missed = source == ContactSource::ForceGuard;
    let end = if missed { (State::Fault, Fault::LateContact) } else { (State::Done, Fault::None) };
    assert_eq!((run.output.state, run.output.fault), end, "seed {seed}: {:?}", run.output);
    Outcome {
        depth: 1e6 * run.slide.depth,
        early,
        source,
        late: 1e6 * (run.output.contact_position - surface),
        release: 1e3 * (released - run.output.contact_time),
    }
}

fn approaches(p: &Parameters, first_seed: u64, count: u64) -> Vec<Outcome> {
    (first_seed..first_seed + count).map(|seed| approach(p, seed)).collect()
}

fn with(detector: DetectorKind, mode: ThresholdMode, speed: f64) -> Parameters {
    let mut p = Parameters { detector, ..Parameters::START };
    p.threshold.mode = mode;
    p.approach.velocity = 1e-6 * speed;
    p
}

fn quantile(values: impl IntoIterator<Item = f64>, q: f64) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    sorted[(q * (sorted.len() - 1) as f64).round() as usize]
}

fn depth(outcomes: &[Outcome], q: f64) -> f64 {
    quantile(outcomes.iter().filter(|o| !o.early).map(|o| o.depth), q)
}

/// Speeds in um/s with the largest allowed depth p99 in um, none early and none missed.
fn default_mode(first_seed: u64, count: u64) {
    for (speed, limit) in [(10.0, 0.30), (30.0, 0.26), (100.0, 0.42), (300.0, 0.82)] {
        let p = with(DetectorKind::Glr, ThresholdMode::Automatic, speed);
        let outcomes = approaches(&p, first_seed, count);
        let p99 = depth(&outcomes, 0.99);
        println!("{speed} um/s: median {:.3} p99 {p99:.3} um", depth(&outcomes, 0.5));
        assert!(outcomes.iter().all(|o| !o.early), "early stop at {speed} um/s");
        assert!(outcomes.iter().all(|o| o.source == ContactSource::Glr));
        assert!(p99 <= limit, "{speed} um/s: depth p99 {p99} um, limit {limit} um");
    }
}

/// At most 5 % early stops; depth p99 within the limit.
fn paper_mode(first_seed: u64, count: u64) {
    for (speed, limit) in [(10.0, 0.45), (30.0, 0.45), (100.0, 0.45), (300.0, 0.9)] {
        let p = with(DetectorKind::Slope, ThresholdMode::Fixed, speed);
        let outcomes = approaches(&p, first_seed, count);
        let early = outcomes.iter().filter(|o| o.early).count();
        let p99 = depth(&outcomes, 0.99);
        println!("{speed} um/s: median {:.3} p99 {p99:.3} um, {early} early", depth(&outcomes, 0.5));
        assert!(20 * early <= outcomes.len(), "{early} early stops of {count} at {speed} um/s");
        assert!(outcomes.iter().all(|o| o.source == ContactSource::Slope));
        assert!(p99 <= limit, "{speed} um/s: depth p99 {p99} um, limit {limit} um");
    }
}

#[test]
fn default_mode_stops_within_a_micrometre() {
    default_mode(80_000, 20);
}

#[test]
fn paper_mode_stops_within_a_micrometre() {
    paper_mode(81_000, 20);
}

#[test]
fn likelihood_ratio_is_faster() {
    for (speed, limit) in [(100.0, 0.33), (300.0, 0.62)] {
        let p = with(DetectorKind::Glr, ThresholdMode::Automatic, speed);
        let median = depth(&approaches(&p, 82_000, 20), 0.5);
        assert!(median <= limit, "{speed} um/s: median {median} um");
    }
    let p = with(DetectorKind::Glr, ThresholdMode::Automatic, 1000.0);
    let p99 = depth(&approaches(&p, 82_100, 20), 0.99);
    assert!(p99 <= 1.8, "1000 um/s: p99 {p99} um");
}

#[test]
fn one_calibration_touch_gives_the_contact_position() {
    let p = with(DetectorKind::Glr, ThresholdMode::Automatic, 100.0);
    let late: Vec<f64> = approaches(&p, 84_000, 41).into_iter().map(|o| o.late).collect();
    // every touch once as the calibration of all others
    let errors = late.iter().flat_map(|calibration| late.iter().map(move |late| (late - calibration).abs()));
    let p90 = quantile(errors, 0.9);
    println!("estimate after one calibration touch: p90 {p90:.3} um");
    assert!(p90 <= 0.060, "p90 {p90} um");
}

#[test]
fn contact_is_lost_within_three_milliseconds() {
    let p = with(DetectorKind::Glr, ThresholdMode::Automatic, 100.0);
    let slowest = approaches(&p, 85_000, 20).iter().map(|o| o.release).fold(0.0, f64::max);
    println!("contact lost after at most {slowest:.1} ms");
    assert!(slowest < 3.0, "{slowest} ms");
}

/// `cargo test --release -p fmu-dob --test closed_loop table -- --ignored --nocapture`
#[test]
#[ignore = "200 approaches per speed and detector; prints the table of `docs/results/dob.md`"]
fn table_of_depths() {
    use DetectorKind::{Glr, Slope};
    use ThresholdMode::{Automatic, Fixed};
    let detectors = [("printed", Slope, Fixed, 4.0), ("slope", Slope, Automatic, 4.0), ("glr", Glr, Automatic, 4.0)];
    for speed in [10.0, 30.0, 100.0, 300.0, 1000.0] {
        let mut line = format!("measured: dob-detectors | {speed} | approaches=200");
        for (name, detector, mode, alpha) in detectors {
            let mut p = with(detector, mode, speed);
            p.threshold.alpha = alpha;
            let outcomes = approaches(&p, 90_000, 200);
            let early = outcomes.iter().filter(|o| o.early).count();
            let guard = outcomes.iter().filter(|o| o.source == ContactSource::ForceGuard).count();
            let (median, p99) = (depth(&outcomes, 0.5), depth(&outcomes, 0.99));
            line += &format!(" {name}={median} {name}_high={p99} {name}_early={early} {name}_guard={guard}");
        }
        println!("{line}");
    }
    default_mode(91_000, 200);
    paper_mode(92_000, 200);
}
