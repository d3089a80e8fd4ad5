//! The safe state as tables: events with their times, and the expected change of state.

use super::*;
use SafetyEvent::{Disconnected, Installed, NoLabel, NoModel, Sample, Tick};

/// Time, event and expected change of state.
type Trace<'a> = &'a [(u32, SafetyEvent, Option<Status>)];

fn run(start: Cause, trace: Trace) -> SafeState {
    let mut state = SafeState::new(start);
    for (row, (now, event, expected)) in trace.iter().enumerate() {
        let change = state.handle(Millis(*now), *event);
        assert_eq!(change, *expected, "row {row}: {event:?} at {now} ms");
    }
    state
}

/// A label that says that the hand opens.
const LABEL: SafetyEvent = SafetyEvent::Label(Intent::Open);
const OPEN: Option<Status> = Some(Status::Valid(Intent::Open));
const fn safe(cause: Cause) -> Option<Status> {
    Some(Status::Safe(cause))
}

#[test]
fn after_a_reset_the_state_is_safe_with_its_cause() {
    let status = SafeState::new(Cause::Watchdog).status();
    assert_eq!(status.cause(), Some(Cause::Watchdog));
    assert_eq!((status.valid(), status.label()), (false, Intent::Relax));
}

#[test]
fn only_a_label_of_a_running_stream_leaves_the_safe_state() {
    let state = run(
        Cause::Boot,
        &[
            (0, LABEL, None),
            (5, Sample, None),
            (7, LABEL, OPEN),
            (8, SafetyEvent::Label(Intent::Close), None),
        ],
    );
    assert_eq!(state.status(), Status::Valid(Intent::Close));
}

#[test]
fn silence_of_200_ms_is_safe_and_of_199_is_not() {
    run(
        Cause::Watchdog,
        &[
            (1000, Sample, None),
            (1000, LABEL, OPEN),
            (1199, Tick, None),
            (1200, Tick, safe(Cause::Silence)),
            (1300, LABEL, None),
            (1301, Sample, None),
            (1302, LABEL, OPEN),
            // The silence is reported even if the sample that ends it arrives before a tick.
            (1600, Sample, safe(Cause::Silence)),
        ],
    );
}

#[test]
fn a_gap_and_a_disconnection_have_causes_of_their_own() {
    let state = run(
        Cause::Boot,
        &[
            (0, Sample, None),
            (0, LABEL, OPEN),
            (5, NoLabel(Cause::Gap), safe(Cause::Gap)),
            (6, LABEL, OPEN),
            (7, NoLabel(Cause::Losses), safe(Cause::Losses)),
            (8, LABEL, OPEN),
            (8, NoLabel(Cause::Stalled), safe(Cause::Stalled)),
            (8, LABEL, OPEN),
            (9, Disconnected, safe(Cause::Disconnected)),
            (10, Disconnected, None),
            (11, LABEL, None),
            // After a disconnection there is no silence.
            (5000, Tick, None),
        ],
    );
    assert_eq!(state.deadline(), None);
}

#[test]
fn a_refused_model_stays_refused() {
    run(
        Cause::Boot,
        &[
            (0, NoModel(Cause::ModelRefused), safe(Cause::ModelRefused)),
            (1, Sample, None),
            (2, LABEL, None),
            (3, NoLabel(Cause::Gap), None),
            (4, Disconnected, None),
        ],
    );
}

#[test]
fn nothing_leaves_an_installation_but_its_end_and_a_label() {
    let state = run(
        Cause::Boot,
        &[
            (0, Sample, None),
            (1, LABEL, OPEN),
            (2, NoModel(Cause::Installation), safe(Cause::Installation)),
            (3, Sample, None),
            (4, LABEL, None),
            (5, NoLabel(Cause::Gap), None),
            (6, NoLabel(Cause::Stalled), None),
            (7, Disconnected, None),
            (8, Sample, None),
            (9, Installed, None),
            (10, LABEL, OPEN),
            (11, NoModel(Cause::Installation), safe(Cause::Installation)),
            (12, NoModel(Cause::ModelRefused), safe(Cause::ModelRefused)),
            (13, LABEL, None),
            (14, Installed, None),
            (15, NoLabel(Cause::Gap), safe(Cause::Gap)),
        ],
    );
    assert_eq!(state.status(), Status::Safe(Cause::Gap));
}

#[test]
fn silence_is_measured_across_the_clock_wrap() {
    let mut state = SafeState::new(Cause::Boot);
    state.handle(Millis(u32::MAX - 99), Sample);
    assert_eq!(state.deadline(), Some(Millis(100)));
    assert!(!state.silent(Millis(99)));
    assert!(state.silent(Millis(100)));
}

#[test]
fn names_of_causes_are_unique() {
    for cause in Cause::ALL {
        assert_eq!(Cause::from_name(cause.name()), Some(cause));
    }
    assert_eq!(Cause::from_name("valid"), None);
}
