//! Another model in place of the one in use.

use super::*;

#[test]
fn labels_after_another_model_are_those_of_a_pipeline_that_always_had_it() {
    let samples = stream(Alignment::new(3, false), 3000);
    let mut changed = real();
    changed.set_alignment(Alignment::new(3, false));
    let first = run(&mut changed, &samples, 0..1500).0;
    assert!(labels(first, 0).len() > 40);
    let reports: Vec<Report> = changed.suspend(Millis(7500)).into_iter().collect();
    assert_eq!(reports[0].status, Status::Safe(Cause::Installation));
    let without = run(&mut changed, &samples, 1500..1700).0;
    assert_eq!(without, [], "a label without a model");
    let (encoder, smoother, input) = model_of(4);
    changed.resume(Millis(8500), encoder, smoother, input);
    assert!(!changed.status().valid());
    // The template is the same.
    assert_eq!(changed.alignment(), Alignment::new(3, false));
    let after = run(&mut changed, &samples, 1700..3000).0;

    let mut always = real();
    let _ = always.suspend(Millis(0));
    let (encoder, smoother, input) = model_of(4);
    always.resume(Millis(0), encoder, smoother, input);
    always.set_alignment(Alignment::new(3, false));
    let expected = labels(run(&mut always, &samples, 0..3000).0, 0);
    // Half a second after the change; both hold labels from different patches on, so only some are of the same instant.
    assert!(after[0].emitted.0 <= 1770, "{:?}", after[0]);
    let mut found = labels(after, 0);
    found.retain(|(instant, _)| expected.iter().any(|(own, _)| own == instant));
    assert!(found.len() > 50, "{}", found.len());
    assert!(found.iter().all(|label| expected.contains(label)));
}

#[test]
fn another_template_drops_the_alignment_and_another_normalization_the_window() {
    let samples = stream(Alignment::NONE, 1500);
    let mut pipeline = real();
    pipeline.set_alignment(Alignment::new(2, true));
    run(&mut pipeline, &samples, 0..1500);
    let _ = pipeline.suspend(Millis(7500));
    let (encoder, smoother, input) = model_of(4);
    let other = ModelInput {
        template: None,
        ..input
    };
    pipeline.resume(Millis(7500), encoder, smoother, other);
    assert_eq!(pipeline.alignment(), Alignment::NONE);
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::None);
    let news = pipeline.take_alignment_report().unwrap();
    assert_eq!(news.state, AlignmentState::Set);
    assert_eq!(news.alignment, Alignment::NONE);
    assert!(pipeline.window.ring.is_full());

    let (encoder, smoother, input) = model_of(4);
    let _ = pipeline.suspend(Millis(7500));
    let mut other = input;
    other.preprocessing.normalized = true;
    pipeline.resume(Millis(7500), encoder, smoother, other);
    // The samples were not normalized.
    assert!(!pipeline.window.ring.is_full());
    assert_eq!(pipeline.state_report().counters.resets, 1);

    for index in 1500..2200 {
        let _ = pipeline.sample(Millis(index * 5), [20; 8]);
    }
    assert!(pipeline.window.ring.is_full());
    let (encoder, smoother, _) = model_of(4);
    other.preprocessing.median = Median::Off;
    pipeline.resume(Millis(11_000), encoder, smoother, other);
    assert!(!pipeline.window.ring.is_full(), "samples after a median");
}

#[test]
fn the_alignment_of_a_learnt_head_is_in_force_with_it_and_in_each_connection() {
    let [learnt, found] = [Alignment::new(3, true), Alignment::new(1, false)];
    let mut pipeline = real();
    let use_head = |pipeline: &mut SmallPipeline, alignment| {
        let _ = pipeline.suspend(Millis(0));
        let (encoder, smoother, input) = model_of(3);
        let input = ModelInput { alignment, ..input };
        pipeline.resume(Millis(0), encoder, smoother, input);
        (pipeline.alignment(), pipeline.alignment_phase())
    };
    let aligned = AlignmentPhase::Aligned;
    assert_eq!(use_head(&mut pipeline, learnt), (learnt, aligned));
    pipeline.set_alignment(found);
    // What was found since stays with the same head, until the connection ends.
    assert_eq!(use_head(&mut pipeline, learnt), (found, aligned));
    let _ = pipeline.disconnected(Millis(0));
    assert_eq!(pipeline.alignment(), learnt);
    assert_eq!(pipeline.alignment_phase(), aligned);
    assert_eq!(use_head(&mut pipeline, Alignment::NONE).0, Alignment::NONE);
    let _ = pipeline.disconnected(Millis(0));
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::None);
}
