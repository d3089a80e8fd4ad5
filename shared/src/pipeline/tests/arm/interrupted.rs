//! Decisions that something ends before the model has decided.

use AlignmentState::{Cancelled, Disconnected, PoorMargin, Waiting};

use super::super::alignment::SmallEncoder;
use super::*;

/// Event during a pipeline's decision.
type Event = fn(&mut Pipeline<'static, SmallEncoder>, Millis);

/// Events that end a decision with nothing changed; the state that the line then says.
const ENDS: [(&str, Event, AlignmentState); 8] = [
    ("a gap", |own, now| _ = own.gap(now, 6), PoorMargin),
    (
        "silence",
        |own, now| _ = own.tick(now.plus(600)),
        PoorMargin,
    ),
    ("a stall", |own, now| _ = own.stalled(now), PoorMargin),
    (
        "disconnection",
        |own, now| _ = own.disconnected(now),
        Disconnected,
    ),
    ("installation", |own, now| _ = own.suspend(now), Cancelled),
    (
        "a refused model",
        |own, now| _ = own.refuse_model(now),
        Cancelled,
    ),
    ("a command", |own, _| own.cancel_alignment(), Cancelled),
    (
        "another beginning",
        |own, _| own.begin_alignment(Arm::Unknown),
        Waiting,
    ),
];

/// Samples after the beginning of a decision: in its first patch, in the first placement, between both, in the second, in
/// the last patch.
const WHEN: [usize; 5] = [1, 20, 53, 80, 105];

/// Labels of a stream from a sample on, once the encoder has taken the window again.
fn labels_after(
    mut pipeline: Pipeline<'static, SmallEncoder>,
    samples: &[Sample],
    end: usize,
) -> Vec<(u32, Status)> {
    let (reports, _) = run(&mut pipeline, samples, end..2400);
    labels(reports, end as u32 + 31)
}

#[test]
fn what_ends_a_decision_changes_nothing() {
    let start = begins(undecided());
    let samples = stream(Alignment::new(3, true), 3000);
    for (name, event, state) in ENDS {
        for later in WHEN {
            let end = start + later;
            let [mut deciding, mut plain] = [(); 2].map(|()| undecided());
            deciding.begin_alignment(Arm::Unknown);
            let _ = deciding.take_alignment_report();
            run(&mut deciding, &samples, 0..end);
            run(&mut plain, &samples, 0..end);
            assert!(deciding.arm_decision().is_some(), "{name} {later}");
            assert_eq!(deciding.alignment_phase(), AlignmentPhase::Waiting);
            for pipeline in [&mut deciding, &mut plain] {
                event(pipeline, at(end as u32 - 1));
            }
            assert!(deciding.arm_decision().is_none(), "{name} {later}");
            let news = deciding.take_alignment_report().unwrap();
            assert_eq!(news.state, state, "{name} {later}");
            assert_eq!(news.alignment, Alignment::NONE, "{name}");
            assert_eq!(news.quality.is_some(), state == PoorMargin);
            let waits = state == Waiting;
            let phase = [AlignmentPhase::None, AlignmentPhase::Waiting][usize::from(waits)];
            assert_eq!(deciding.alignment_phase(), phase, "{name}");
            assert_eq!(deciding.alignment(), Alignment::NONE);
            deciding.cancel_alignment();
            plain.cancel_alignment();
            if !plain.has_model() {
                for pipeline in [&mut deciding, &mut plain] {
                    let (encoder, smoother, input) = model_of(4);
                    let input = ModelInput {
                        template: Some(symmetrical()),
                        ..input
                    };
                    pipeline.resume(at(end as u32 - 1), encoder, smoother, input);
                }
            }
            // As if there had been no alignment, once the encoder has taken the window again.
            let [found, expected] =
                [deciding, plain].map(|pipeline| labels_after(pipeline, &samples, end));
            assert!(!found.is_empty(), "{name}");
            assert_eq!(found, expected, "{name} {later}");
        }
    }
}

#[test]
fn an_alignment_that_is_set_stands_in_place_of_a_decision() {
    let start = begins(undecided());
    let samples = stream(Alignment::new(3, true), 3000);
    for given in [Alignment::NONE, Alignment::new(6, true)] {
        for later in WHEN {
            let end = start + later;
            let mut deciding = undecided();
            deciding.begin_alignment(Arm::Unknown);
            run(&mut deciding, &samples, 0..end);
            assert!(deciding.arm_decision().is_some());
            deciding.set_alignment(given);
            let news = deciding.take_alignment_report().unwrap();
            assert_eq!((news.state, news.alignment), (AlignmentState::Set, given));
            assert_eq!(deciding.alignment_phase(), AlignmentPhase::Aligned);
            let mut always = undecided();
            always.set_alignment(given);
            run(&mut always, &samples, 0..end);
            let [found, expected] =
                [deciding, always].map(|pipeline| labels_after(pipeline, &samples, end));
            assert_eq!(found, expected, "{later}");
        }
    }
}
