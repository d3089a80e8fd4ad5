//! The safe state as tables: events with their times, and the expected change of state.

use super::*;

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
            (5, SafetyEvent::Sample, None),
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
            (1000, SafetyEvent::Sample, None),
            (1000, LABEL, OPEN),
            (1199, SafetyEvent::Tick, None),
            (1200, SafetyEvent::Tick, safe(Cause::Silence)),
            (1300, LABEL, None),
            (1301, SafetyEvent::Sample, None),
            (1302, LABEL, OPEN),
            // The silence is reported even if the sample that ends it arrives before a tick.
            (1600, SafetyEvent::Sample, safe(Cause::Silence)),
        ],
    );
}

#[test]
fn a_gap_and_a_disconnection_have_causes_of_their_own() {
    let state = run(
        Cause::Boot,
        &[
            (0, SafetyEvent::Sample, None),
            (0, LABEL, OPEN),
            (5, SafetyEvent::NoLabel(Cause::Gap), safe(Cause::Gap)),
            (6, LABEL, OPEN),
            (7, SafetyEvent::NoLabel(Cause::Losses), safe(Cause::Losses)),
            (8, LABEL, OPEN),
            (
                8,
                SafetyEvent::NoLabel(Cause::Stalled),
                safe(Cause::Stalled),
            ),
            (8, LABEL, OPEN),
            (9, SafetyEvent::Disconnected, safe(Cause::Disconnected)),
            (10, SafetyEvent::Disconnected, None),
            (11, LABEL, None),
            // After a disconnection there is no silence.
            (5000, SafetyEvent::Tick, None),
        ],
    );
    assert_eq!(state.deadline(), None);
}

#[test]
fn a_refused_model_stays_refused() {
    run(
        Cause::Boot,
        &[
            (
                0,
                SafetyEvent::NoModel(Cause::ModelRefused),
                safe(Cause::ModelRefused),
            ),
            (1, SafetyEvent::Sample, None),
            (2, LABEL, None),
            (3, SafetyEvent::NoLabel(Cause::Gap), None),
            (4, SafetyEvent::Disconnected, None),
        ],
    );
}

#[test]
fn nothing_leaves_an_installation_but_its_end_and_a_label() {
    let state = run(
        Cause::Boot,
        &[
            (0, SafetyEvent::Sample, None),
            (1, LABEL, OPEN),
            (
                2,
                SafetyEvent::NoModel(Cause::Installation),
                safe(Cause::Installation),
            ),
            (3, SafetyEvent::Sample, None),
            (4, LABEL, None),
            (5, SafetyEvent::NoLabel(Cause::Gap), None),
            (6, SafetyEvent::NoLabel(Cause::Stalled), None),
            (7, SafetyEvent::Disconnected, None),
            (8, SafetyEvent::Sample, None),
            (9, SafetyEvent::Installed, None),
            (10, LABEL, OPEN),
            (
                11,
                SafetyEvent::NoModel(Cause::Installation),
                safe(Cause::Installation),
            ),
            (
                12,
                SafetyEvent::NoModel(Cause::ModelRefused),
                safe(Cause::ModelRefused),
            ),
            (13, LABEL, None),
            (14, SafetyEvent::Installed, None),
            (15, SafetyEvent::NoLabel(Cause::Gap), safe(Cause::Gap)),
        ],
    );
    assert_eq!(state.status(), Status::Safe(Cause::Gap));
}

#[test]
fn silence_is_measured_across_the_clock_wrap() {
    let mut state = SafeState::new(Cause::Boot);
    state.handle(Millis(u32::MAX - 99), SafetyEvent::Sample);
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
