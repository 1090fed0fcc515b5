use super::*;

/// Signal that is quiet noise while learning, then `level`.
fn ticks_to_detect(p: &Parameters, level: f64) -> Option<usize> {
    let mut detector = Detector::new(p);
    let sample = |slope| Sample { position: Some(0.0), slope, ..Sample::default() };
    for k in 0..1000 {
        detector.update(p, &sample((f64::from(k) * 1.3).sin()));
        detector.learn();
    }
    detector.arm(p);
    (1..100).find(|_| {
        detector.update(p, &sample(level));
        detector.test(p)
    })
}

#[test]
fn three_in_a_row_above_the_threshold() {
    let p = Parameters::PAPER;
    assert_eq!(ticks_to_detect(&p, 10.0), Some(3));
    assert_eq!(ticks_to_detect(&p, 1.0), None);
}

#[test]
fn four_windows_share_the_wished_interval() {
    let p = Parameters { detector: DetectorKind::MultiSlope, ..Parameters::START };
    let mut detector = Detector::new(&p);
    for k in 0..1000 {
        detector.update(&p, &Sample { position: Some(0.0), slope: (f64::from(k) * 1.3).sin(), ..Sample::default() });
        detector.learn();
    }
    detector.arm(&p);
    let ThresholdOutput { crossing_rate, alpha_used, .. } = detector.learned();
    assert!((alpha_used - (2.0 * (crossing_rate * 36_000.0 * 4.0).ln()).sqrt()).abs() < 1e-12, "{alpha_used}");
}

#[test]
fn what_looked_like_a_contact_before_is_forgotten() {
    for &detector in &[DetectorKind::Raw, DetectorKind::Deviation, DetectorKind::Slope, DetectorKind::MultiSlope] {
        let p = Parameters { detector, ..Parameters::START };
        let sample = |x: f64| Sample { position: Some(0.0), notched: x, deviation: x, slope: x, ..Sample::default() };
        let learn = |detector: &mut Detector| {
            for k in 0..1300 {
                detector.update(&p, &sample((f64::from(k) * 1.3).sin()));
                if k >= 300 {
                    detector.learn();
                }
            }
            detector.arm(&p);
        };
        let contact = |detector: &mut Detector| {
            (1..100).find(|k| {
                detector.update(&p, &sample(1e3 * f64::from(*k)));
                detector.test(&p)
            })
        };
        let mut fresh = Detector::new(&p);
        learn(&mut fresh);
        let mut old = fresh.clone();
        let samples = contact(&mut fresh.clone());
        assert!(samples.is_some_and(|k| k < 5), "{detector:?}: {samples:?}");
        assert_eq!(contact(&mut old), samples);
        // learned again, or doubted
        old.reset(0.0);
        assert_eq!(old.learned(), ThresholdOutput::START);
        learn(&mut old);
        assert_eq!(old.learned(), fresh.learned());
        assert_eq!(contact(&mut old), samples);
        old.clear();
        let rows = (1..5).map(|_| old.test(&p)).collect::<Vec<_>>();
        assert_eq!(rows, [false, false, true, true], "{detector:?}");
    }
}

#[test]
fn windows_and_memories_are_those_of_the_times() {
    let with = |detector| Parameters { detector, ..Parameters::START };
    let multi = with(DetectorKind::MultiSlope);
    // 20 ms of the longest window, 100 ms of the mean, 9.55 ms of the observer
    assert_eq!([Detector::window(&multi), Detector::settling(&multi)], [200, 1200]);
    assert_eq!(Detector::memory(&multi), 296);
    let slope = with(DetectorKind::Slope);
    assert_eq!([Detector::window(&slope), Detector::settling(&slope)], [50, 1050]);
    assert_eq!(Detector::settling(&with(DetectorKind::Cusum)), 2000);
    let glr = with(DetectorKind::Glr);
    assert_eq!([Detector::window(&glr), Detector::settling(&glr)], [300, 2300]);
    assert_eq!(samples(1e-4, 1e-4), 3);
}

#[test]
fn a_detector_with_other_values_predicts_as_a_new_one() {
    for kind in [DetectorKind::Cusum, DetectorKind::Glr] {
        let p = Parameters { detector: kind, ..Parameters::START };
        let mut other = p.clone();
        other.stage.force_constant *= 1.3;
        let sigma = |mut detector: Detector| {
            for k in 0..3000 {
                let acted = 0.1 * (f64::from(k) * 0.05).sin();
                detector.update(&other, &Sample { position: Some(0.0), acted, ..Sample::default() });
                detector.learn();
            }
            match detector.method {
                Method::Cusum(inner) => inner.0.sigma(),
                Method::Glr(inner) => inner.0.sigma(),
                _ => unreachable!("{kind:?}"),
            }
        };
        let (old, new) = (Detector::new(&p), Detector::new(&other));
        let mut renewed = old.clone();
        renewed.renew(&other);
        assert!(sigma(old) < 0.9 * sigma(new.clone()), "{kind:?}");
        assert_eq!(sigma(renewed), sigma(new), "{kind:?}");
    }
}

#[test]
fn each_detector_names_itself() {
    for &detector in DetectorKind::ALL {
        let source = Detector::new(&Parameters { detector, ..Parameters::START }).source();
        assert_eq!(format!("{source:?}"), format!("{detector:?}"));
    }
}

#[test]
fn an_innovation_tells_a_push_and_neither_noise_nor_one_bad_sample() {
    for kind in [DetectorKind::Cusum, DetectorKind::Glr] {
        let p = Parameters { detector: kind, ..Parameters::START };
        let mut detector = Detector::new(&p);
        detector.reset(0.0);
        let noise = |k: u32| 1e-9 * (f64::from(k) * 12.9898).sin();
        let sample = |z: f64| Sample { position: Some(z), ..Sample::default() };
        let settling = Detector::settling(&p) as u32;
        for k in 0..settling {
            assert!(k + 1 == settling || !detector.ready(), "{kind:?} {k}");
            detector.update(&p, &sample(noise(k)));
        }
        assert!(detector.ready(), "{kind:?}");
        for k in settling..settling + 3000 {
            detector.update(&p, &sample(noise(k)));
            detector.learn();
        }
        detector.arm(&p);
        let told = |push: &dyn Fn(u32) -> f64| {
            let mut detector = detector.clone();
            (0..300).find(|k| {
                detector.update(&p, &sample(noise(settling + 3000 + k) + push(*k)));
                detector.test(&p)
            })
        };
        assert_eq!(told(&|_| 0.0), None, "{kind:?}");
        assert_eq!(told(&|k| if k == 100 { -8e-9 } else { 0.0 }), None, "{kind:?}");
        // 1 N on 10 kg, away from the work
        let pushed = told(&|k| -0.05 * (f64::from(k) * p.sample_period).powi(2));
        assert!(pushed.is_some_and(|k| (3..60).contains(&k)), "{kind:?} {pushed:?}");
    }
}
