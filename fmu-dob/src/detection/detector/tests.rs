use super::*;

/// Sample of a slope, at a known position.
fn slope(slope: f64) -> Sample {
    Sample { position: Some(0.0), slope, ..Sample::default() }
}

/// Samples to a detection: a signal that is small noise while learning, then `level`.
fn ticks_to_detect(p: &Parameters, level: f64) -> Option<usize> {
    let mut detector = Detector::new(p);
    for k in 0..1000 {
        detector.update(&slope((f64::from(k) * 1.3).sin()));
        detector.learn();
    }
    detector.arm(p);
    (1..100).find(|_| {
        detector.update(&slope(level));
        detector.test()
    })
}

#[test]
fn three_consecutive_samples_above_the_threshold() {
    let p = Parameters::PAPER;
    assert_eq!(ticks_to_detect(&p, 10.0), Some(3));
    assert_eq!(ticks_to_detect(&p, 1.0), None);
}

#[test]
fn automatic_alpha_follows_the_interval() {
    let p = Parameters { detector: DetectorKind::Slope, ..Parameters::START };
    let mut detector = Detector::new(&p);
    for k in 0..1000 {
        detector.update(&slope((f64::from(k) * 1.3).sin()));
        detector.learn();
    }
    detector.arm(&p);
    let ThresholdOutput { crossing_rate, alpha_used, .. } = detector.learned();
    assert!((alpha_used - (2.0 * (crossing_rate * 36_000.0).ln()).sqrt()).abs() < 1e-12, "{alpha_used}");
}

#[test]
fn earlier_evidence_is_discarded() {
    let p = Parameters { detector: DetectorKind::Slope, ..Parameters::START };
    let learn = |detector: &mut Detector| {
        for k in 0..1300 {
            detector.update(&slope((f64::from(k) * 1.3).sin()));
            if k >= 300 {
                detector.learn();
            }
        }
        detector.arm(&p);
    };
    let contact = |detector: &mut Detector| {
        (1..100).find(|k| {
            detector.update(&slope(1e3 * f64::from(*k)));
            detector.test()
        })
    };
    let mut fresh = Detector::new(&p);
    learn(&mut fresh);
    let mut old = fresh.clone();
    let samples = contact(&mut fresh.clone());
    assert!(samples.is_some_and(|k| k < 5), "{samples:?}");
    assert_eq!(contact(&mut old), samples);
    // learned again, or cleared
    old.reset(0.0);
    assert_eq!(old.learned(), ThresholdOutput::START);
    learn(&mut old);
    assert_eq!(old.learned(), fresh.learned());
    assert_eq!(contact(&mut old), samples);
    old.clear();
    let rows = (1..5).map(|_| old.test()).collect::<Vec<_>>();
    assert_eq!(rows, [false, false, true, true]);
}

#[test]
fn windows_and_memories_are_those_of_the_times() {
    let with = |detector| Parameters { detector, ..Parameters::START };
    let slope = with(DetectorKind::Slope);
    // 5 ms of the window, 100 ms of the mean, 9.55 ms of the observer
    assert_eq!([Detector::window(&slope), Detector::settling(&slope)], [50, 1050]);
    assert_eq!(Detector::memory(&slope), 146);
    let glr = with(DetectorKind::Glr);
    assert_eq!([Detector::window(&glr), Detector::settling(&glr)], [300, 2300]);
    assert_eq!(samples(1e-4, 1e-4), 3);
}

#[test]
fn a_detector_with_other_values_predicts_as_a_new_one() {
    let p = Parameters { detector: DetectorKind::Glr, ..Parameters::START };
    let mut other = p.clone();
    other.stage.force_constant *= 1.3;
    let sigma = |mut detector: Detector| {
        for k in 0..3000 {
            let acted = 0.1 * (f64::from(k) * 0.05).sin();
            detector.update(&Sample { position: Some(0.0), acted, ..Sample::default() });
            detector.learn();
        }
        match detector.method {
            Method::Glr(inner) => inner.0.sigma(),
            Method::Slope => unreachable!(),
        }
    };
    let (old, new) = (Detector::new(&p), Detector::new(&other));
    let mut renewed = old.clone();
    renewed.renew(&other);
    assert!(sigma(old) < 0.9 * sigma(new.clone()));
    assert_eq!(sigma(renewed), sigma(new));
}

#[test]
fn each_detector_names_itself() {
    for &detector in DetectorKind::ALL {
        let source = Detector::new(&Parameters { detector, ..Parameters::START }).source();
        assert_eq!(format!("{source:?}"), format!("{detector:?}"));
    }
}

#[test]
fn the_innovation_shows_a_push_and_neither_noise_nor_one_bad_sample() {
    {
        let kind = DetectorKind::Glr;
        let p = Parameters { detector: kind, ..Parameters::START };
        let mut detector = Detector::new(&p);
        detector.reset(0.0);
        let noise = |k: u32| 1e-9 * (f64::from(k) * 12.9898).sin();
        let sample = |z: f64| Sample { position: Some(z), ..Sample::default() };
        let settling = Detector::settling(&p) as u32;
        for k in 0..settling {
            assert!(k + 1 == settling || !detector.ready(), "{kind:?} {k}");
            detector.update(&sample(noise(k)));
        }
        assert!(detector.ready(), "{kind:?}");
        for k in settling..settling + 3000 {
            detector.update(&sample(noise(k)));
            detector.learn();
        }
        detector.arm(&p);
        let found = |push: &dyn Fn(u32) -> f64| {
            let mut detector = detector.clone();
            (0..300).find(|k| {
                detector.update(&sample(noise(settling + 3000 + k) + push(*k)));
                detector.test()
            })
        };
        assert_eq!(found(&|_| 0.0), None, "{kind:?}");
        assert_eq!(found(&|k| if k == 100 { -8e-9 } else { 0.0 }), None, "{kind:?}");
        // 1 N on 10 kg, away from the workpiece
        let pushed = found(&|k| -0.05 * (f64::from(k) * p.sample_period).powi(2));
        assert!(pushed.is_some_and(|k| (3..60).contains(&k)), "{kind:?} {pushed:?}");
    }
}
