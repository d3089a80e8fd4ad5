//! Events by hand.

use super::latency::Latency;
use super::summary::SubjectEvents;
use super::*;
use crate::fixture::{C, O, R, labels};
use crate::{Measure, Score};

type Label = Option<Intent>;

const N: Label = None;

fn events(truth: &[(Label, usize)], emitted: &[(Label, usize)]) -> RecordingEvents {
    let (truth, emitted) = (labels(truth), labels(emitted));
    RecordingEvents::new(&truth, &emitted, &[]).unwrap()
}

/// A close of 2 s between rests of 2 s.
const TRUTH: [(Label, usize); 3] = [(R, 400), (C, 400), (R, 400)];

fn verdict(emitted: &[(Label, usize)]) -> (Verdict, Option<i32>) {
    let events = events(&TRUTH, emitted);
    (events.gestures[0].verdict, events.gestures[0].latency)
}

#[test]
fn a_gesture_is_recognised_when_its_label_begins_and_is_held() {
    let recognised = |latency| (Verdict::Recognised, Some(latency));
    // Late, and early.
    assert_eq!(verdict(&[(R, 460), (C, 390), (R, 350)]), recognised(60));
    assert_eq!(verdict(&[(R, 350), (C, 450), (R, 400)]), recognised(-50));
    let dropped_after_half = [(R, 450), (C, 200), (R, 30), (C, 120), (R, 400)];
    assert_eq!(verdict(&dropped_after_half), recognised(50));
    let blip_then_held = [(R, 450), (C, 50), (R, 30), (C, 270), (R, 400)];
    assert_eq!(verdict(&blip_then_held), recognised(130));
    let half_of_it_with_the_tolerance = [(R, 650), (C, 200), (R, 350)];
    assert_eq!(verdict(&half_of_it_with_the_tolerance), recognised(250));
}

const INTERRUPTED: [(Label, usize); 5] = [(R, 440), (C, 190), (R, 20), (C, 190), (R, 360)];
const OTHER_FIRST: [(Label, usize); 4] = [(R, 440), (O, 20), (C, 360), (R, 380)];
const OTHER_AT_RELEASE: [(Label, usize); 4] = [(R, 440), (C, 380), (O, 20), (R, 360)];

/// Name, emitted labels with their samples, and what becomes of the gesture.
type Case = (&'static str, &'static [(Label, usize)], Verdict);

#[test]
fn each_missed_gesture_has_its_reason() {
    use Verdict::{NoLabel, NotHeld, OtherLabel};
    let cases: [Case; 10] = [
        ("none", &[(R, 1200)], NoLabel),
        // The label that was there before tells the user nothing.
        ("there before", &[(C, 1200)], NoLabel),
        ("too early", &[(R, 349), (C, 451), (R, 400)], NoLabel),
        ("too late", &[(R, 850), (C, 350)], NoLabel),
        ("less than half", &[(R, 500), (C, 199), (R, 501)], NotHeld),
        (
            "early, less than half",
            &[(R, 350), (C, 249), (R, 601)],
            NotHeld,
        ),
        ("less than half left", &[(R, 651), (C, 549)], NotHeld),
        ("interrupted", &INTERRUPTED, NotHeld),
        ("other first", &OTHER_FIRST, OtherLabel),
        ("other at release", &OTHER_AT_RELEASE, OtherLabel),
    ];
    for (name, emitted, reason) in cases {
        assert_eq!(verdict(emitted), (reason, None), "{name}");
    }
}

#[test]
fn the_one_decision_is_the_active_label_of_most_samples_that_the_gesture_owns() {
    let decision = |emitted: &[(Label, usize)]| events(&TRUTH, emitted).gestures[0].decision;
    assert_eq!(decision(&[(R, 849), (C, 1), (R, 350)]), C);
    assert_eq!(decision(&[(R, 850), (C, 350)]), N);
    assert_eq!(decision(&[(C, 350), (R, 850)]), N);
    assert_eq!(decision(&[(N, 1200)]), N);
    // What was there before counts, and what is not held; an earlier label does not weigh more.
    assert_eq!(decision(&[(C, 351), (R, 849)]), C);
    let in_pieces = [(R, 440), (C, 30), (O, 50), (C, 30), (R, 650)];
    assert_eq!(decision(&in_pieces), C);
    let both = |open, close| decision(&[(R, 440), (C, close), (O, open), (R, 760 - open - close)]);
    assert_eq!([both(101, 100), both(100, 101), both(100, 100)], [O, C, O]);
}

#[test]
fn decisions_are_balanced_over_the_labels_of_a_person() {
    let closes = events(&TRUTH, &[(R, 440), (C, 390), (R, 370)]);
    let opens = [(R, 400), (O, 400), (R, 400)];
    let open = events(&opens, &[(R, 440), (C, 390), (R, 370)]);
    let own = SubjectEvents::new("a", [&closes, &closes, &closes, &open]);
    let of = |label: &str| (own.decisions[label].counted, own.decisions[label].all);
    let found = ["close", "open", "relax"].map(of);
    assert_eq!(found, [(3, 3), (0, 1), (8, 8)]);
    assert_eq!((own.decided(), own.rest_kept()), (Some(0.5), Some(1.0)));
    // A wrong label for a moment does not decide, but the gesture is not recognised.
    let other_first = events(&TRUTH, &OTHER_FIRST);
    let other = SubjectEvents::new("b", [&other_first]);
    assert_eq!((other.decided(), other.recognition), (Some(1.0), Some(0.0)));
    let nothing = SubjectEvents::new("c", []);
    assert_eq!((nothing.decided(), nothing.rest_kept()), (None, None));
    let everybody = Score::of_people(Vec::new(), vec![own, other, nothing]);
    let of_all = [Measure::Decided, Measure::RestKept];
    let [decided, rest] = of_all.map(|measure| measure.mean(&everybody).unwrap());
    assert_eq!((decided.mean, decided.n, rest.n), (0.75, 2, 2));
}

#[test]
fn a_rest_span_is_kept_if_no_label_begins_in_it_or_outlasts_it() {
    let rests = |emitted: &[(Label, usize)]| {
        let rests = events(&TRUTH, emitted).rests;
        (rests.counted, rests.all)
    };
    assert_eq!(rests(&[(R, 1200)]), (2, 2));
    assert_eq!(rests(&[(R, 100), (O, 20), (R, 1080)]), (1, 2));
    // Within the tolerance around the gesture; let go late; never let go; there from the start.
    let near = [(R, 350), (C, 20), (R, 479), (O, 1), (R, 350)];
    assert_eq!(rests(&near), (2, 2));
    assert_eq!(rests(&[(R, 440), (C, 759), (R, 1)]), (2, 2));
    assert_eq!(rests(&[(R, 440), (C, 760)]), (1, 2));
    assert_eq!(rests(&[(C, 1200)]), (0, 2));
    let short = events(&[(R, 249), (C, 400), (R, 250)], &[(C, 899)]).rests;
    assert_eq!((short.counted, short.all), (0, 1));
}

#[test]
fn a_gesture_is_released_when_its_label_changes_after_the_muscle() {
    let release = |truth: &[(Label, usize)], emitted: &[(Label, usize)]| {
        let found = events(truth, emitted).gestures;
        found.iter().map(|own| own.release).collect::<Vec<_>>()
    };
    let held_to = |end: usize| release(&TRUTH, &[(R, 440), (C, end - 440), (R, 1200 - end)]);
    for (end, expected) in [
        (849, Some(49)),
        (950, Some(150)),
        (750, Some(-50)),
        // The label falls before the muscle does: no release.
        (749, None),
        // Never let go: at least as late as the labels last.
        (1200, Some(400)),
    ] {
        assert_eq!(held_to(end), [expected], "{end}");
    }
    // What comes back before the tolerance is over is let go once more; a gesture that is missed is not let go.
    let back = [(R, 440), (C, 370), (R, 20), (C, 60), (R, 310)];
    assert_eq!(release(&TRUTH, &back), [Some(90)]);
    assert_eq!(release(&TRUTH, &[(R, 1200)]), [None]);
    assert_eq!(release(&TRUTH, &OTHER_AT_RELEASE), [None]);
    // The end is not known, or what follows it is too short for a slow release.
    let to_the_end = [(R, 440), (C, 760)];
    assert_eq!(release(&[(R, 400), (C, 800)], &to_the_end), [None]);
    let emitted = [(R, 440), (C, 390), (R, 169)];
    assert_eq!(release(&[(R, 400), (C, 400), (R, 199)], &emitted), [None]);
    let cut = [(R, 400), (C, 400), (R, 199), (N, 300)];
    assert_eq!(release(&cut, &[(R, 440), (C, 390), (R, 469)]), [None]);
    // A gesture that follows at once, or soon, is enough.
    let direct = [(R, 300), (O, 300), (C, 300), (R, 300)];
    let followed = [(R, 360), (O, 310), (C, 280), (R, 250)];
    assert_eq!(release(&direct, &followed), [Some(70), Some(50)]);
    let twice = [(R, 400), (C, 400), (R, 100), (C, 400), (R, 400)];
    let held_over_both = [(R, 440), (C, 900), (R, 360)];
    assert_eq!(release(&twice, &held_over_both), [Some(540), None]);
}

#[test]
fn only_gestures_with_their_onset_in_the_recording_are_counted() {
    let held = [(C, 500), (R, 300), (N, 100), (O, 300), (R, 200), (O, 199)];
    assert!(events(&held, &[(R, 1599)]).gestures.is_empty());
    let cut_late = [(C, 500), (R, 300), (N, 100), (O, 300), (R, 200), (O, 200)];
    assert_eq!(events(&cut_late, &[(R, 1600)]).gestures.len(), 1);
}

#[test]
fn direct_changes_divide_what_the_gestures_own() {
    let truth = [(R, 300), (O, 300), (C, 300), (R, 300)];
    let followed = [(R, 360), (O, 310), (C, 280), (R, 250)];
    let found = events(&truth, &followed).gestures;
    let found = found.iter().map(|own| (own.span.clone(), own.latency));
    let expected = [(300..600, Some(60)), (600..900, Some(70))];
    assert_eq!(found.collect::<Vec<_>>(), expected);
}

#[test]
fn daily_life_is_neither_rest_nor_other_movement() {
    let emitted = labels(&[(C, 100), (R, 300), (O, 150), (C, 50), (R, 600)]);
    let truth = vec![N; emitted.len()];
    let daily = |kind, samples| Movement::new(MovementKind::Daily(kind), samples);
    let movements = [
        daily(DailyKind::Typing, 50..600),
        daily(DailyKind::Walking, 600..1200),
    ];
    let events = RecordingEvents::new(&truth, &emitted, &movements).unwrap();
    assert_eq!((events.rest, events.other_movement), Default::default());
    assert!(events.raised.is_empty());
    let own = SubjectEvents::new("a", [&events]);
    // The label that was there before is not counted, but it is there.
    let typing = own.daily["typing"];
    assert_eq!((typing.activations.count, typing.active_seconds), (2, 1.25));
    assert_eq!(own.daily["walking"].activations.count, 0);
    let all = own.daily_life().unwrap();
    assert_eq!(all.activations.per_minute(), Some(2.0 * 60.0 / 5.75));
    assert_eq!(all.active_share(), 1.25 / 5.75);
    let everybody = Score::of_people(Vec::new(), vec![own]);
    assert_eq!(Measure::DailyActivations.mean(&everybody).unwrap().n, 1);
}

#[test]
fn false_activations_are_counted_in_rest_and_in_other_movements() {
    let truth = labels(&[(R, 1200), (C, 400), (R, 400), (N, 400)]);
    // Two in rest; one within the tolerance before the gesture; one that goes on in other movements and one there.
    let rests = [(R, 100), (O, 50), (C, 50), (R, 960), (O, 20), (R, 800)];
    let emitted = [&rests[..], &[(O, 40), (R, 100), (C, 280)]].concat();
    let emitted = labels(&emitted);
    let other = [
        Movement::new(MovementKind::Point, 2000..2100),
        Movement::new(MovementKind::ThumbUp, 2100..2200),
        Movement::new(MovementKind::ThumbUp, 2200..2400),
    ];
    let events = RecordingEvents::new(&truth, &emitted, &other).unwrap();
    let rate = |of: Rate| (of.count, of.seconds);
    assert_eq!(rate(events.rest), (3, (1150.0 + 350.0) / 200.0));
    assert_eq!(events.rest.per_minute(), Some(24.0));
    assert_eq!(rate(events.other_movement), (1, 2.0));
    assert_eq!(Rate::default().per_minute(), None);
    // What went on from before is not raised by the movement, nor what goes on into the next one.
    use MovementKind::{Point, ThumbUp};
    let raised = [(Point, false), (ThumbUp, true), (ThumbUp, false)];
    assert_eq!(events.raised, raised);
    let subject = SubjectEvents::new("a", [&events, &events]);
    let of = |kind: MovementKind| subject.raised[kind.name()];
    assert_eq!((of(Point).all, of(Point).counted), (2, 0));
    assert_eq!((of(ThumbUp).all, of(ThumbUp).counted), (4, 2));
    assert_eq!(subject.raised_share(), Some(2.0 / 6.0));
    assert_eq!(SubjectEvents::new("b", []).raised_share(), None);
}

#[test]
fn flicker_is_what_is_left_after_one_change_for_each_true_one() {
    let flicker = |emitted: &[(Label, usize)]| events(&TRUTH, emitted).flicker.count;
    assert_eq!(flicker(&[(N, 59), (R, 401), (C, 400), (R, 340)]), 0);
    let dropped = [(R, 460), (C, 100), (R, 20), (C, 280), (R, 340)];
    assert_eq!(flicker(&dropped), 2);
    // One change too many in rest is not made good by a missed gesture.
    assert_eq!(flicker(&[(R, 100), (C, 1100)]), 1);
    assert_eq!(flicker(&[(R, 1200)]), 0);
    assert_eq!(events(&TRUTH, &[(R, 1200)]).flicker.seconds, 6.0);
}

#[test]
fn subjects_weigh_the_same_and_misses_count_in_the_latency() {
    let good = events(&TRUTH, &[(R, 460), (C, 390), (R, 350)]);
    let missed = events(&TRUTH, &[(R, 1200)]);
    let a = SubjectEvents::new("a", [&good, &good, &good]);
    let b = SubjectEvents::new("b", [&missed]);
    assert_eq!(b.latency.unwrap().median, Latency::Missed);
    let score = Score::of_people(Vec::new(), vec![b, a]);
    assert_eq!(Measure::Recognition.mean(&score).unwrap().mean, 0.5);
    let summary = score.events;
    assert_eq!((summary.recognised, summary.gestures), (3, 4));
    let latency = summary.latency.unwrap();
    assert_eq!(latency.median, Latency::Ms(300.0));
    assert_eq!(latency.p90, Latency::Missed);
}
