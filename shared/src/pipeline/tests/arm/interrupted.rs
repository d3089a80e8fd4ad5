//! Decisions that something ends before the model has decided.

use AlignmentState::{Cancelled, Disconnected, PoorMargin, Set, Waiting};

use super::super::alignment::SmallEncoder;
use super::*;

/// Event during a pipeline's decision.
type Event = fn(&mut Pipeline<'static, SmallEncoder>, Millis);

/// Events that end a decision: what the line then says.
#[rustfmt::skip]
const ENDS: [(&str, AlignmentState, Event); 10] = [
    ("a gap", PoorMargin, |own, now| _ = own.gap(now, 6)),
    ("silence", PoorMargin, |own, now| _ = own.tick(now.plus(600))),
    ("a stall", PoorMargin, |own, now| _ = own.stalled(now)),
    ("disconnection", Disconnected, |own, now| _ = own.disconnected(now)),
    ("installation", Cancelled, |own, now| _ = own.suspend(now)),
    ("a refused model", Cancelled, |own, now| _ = own.refuse_model(now)),
    ("a command", Cancelled, |own, _| own.cancel_alignment()),
    ("another beginning", Waiting, |own, _| own.begin_alignment(Arm::Unknown)),
    ("none that is set", Set, |own, _| own.set_alignment(Alignment::NONE)),
    ("one that is set", Set, |own, _| own.set_alignment(Alignment::new(6, true))),
];

/// Samples after the beginning of a decision: in its first patch, in the first placement, between both, in the second, in
/// the last patch.
const WHEN: [usize; 5] = [1, 20, 53, 80, 105];

#[test]
fn what_ends_a_decision_does_what_it_does_without_one() {
    let start = begins(undecided());
    let samples = stream(Alignment::new(3, true), 3000);
    for (name, state, event) in ENDS {
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
            assert_eq!(news.quality.is_some(), state == PoorMargin);
            assert_eq!(news.alignment, plain.alignment(), "{name}");
            assert_eq!(deciding.alignment(), plain.alignment(), "{name}");
            let phases = [&deciding, &plain].map(|pipeline| pipeline.alignment_phase());
            assert_eq!(phases[0], phases[1], "{name}");
            for pipeline in [&mut deciding, &mut plain] {
                pipeline.cancel_alignment();
                if !pipeline.has_model() {
                    let (encoder, smoother, input) = model_of(4);
                    let input = ModelInput {
                        template: Some(symmetrical()),
                        ..input
                    };
                    pipeline.resume(at(end as u32 - 1), encoder, smoother, input);
                }
            }
            // Once the encoder has taken the window again.
            let [found, expected] = [deciding, plain].map(|mut pipeline| {
                let (reports, _) = run(&mut pipeline, &samples, end..2400);
                labels(reports, end as u32 + 31)
            });
            assert!(!found.is_empty(), "{name}");
            assert_eq!(found, expected, "{name} {later}");
        }
    }
}
