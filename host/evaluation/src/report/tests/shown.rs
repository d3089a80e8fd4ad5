//! Content of a page: pictures of recordings, people who are drawn, and numbers that are missing.

use recordings::movement::{Movement, MovementKind};

use super::*;
use crate::gestures;

#[test]
fn a_recording_is_drawn_with_each_label_at_the_time_when_it_is_emitted() {
    let evaluated = two_people();
    let entry = evaluated.entry();
    let judged = gestures(
        entry.candidate,
        &evaluated.recordings[..1],
        entry.vocabulary,
        entry.look_ahead,
    );
    let drawn = entry.timeline(0, 0..2000).unwrap();
    let judged = judged.unwrap();
    assert_eq!(judged.len(), 2);
    for own in judged {
        let onset = own.span.start as i32;
        let at = |label: &[Option<Intent>], sample| label[usize::try_from(sample).unwrap()];
        let emitted = onset + own.latency.unwrap();
        assert!(emitted > onset + 50, "after its look-ahead");
        let changes = [emitted - 1, emitted].map(|sample| at(&drawn.emitted, sample));
        assert_eq!(changes, [Some(Intent::Relax), Some(own.label)]);
        assert_eq!(at(drawn.truth, onset), Some(own.label));
    }
    let svg = svg(&drawn).0;
    assert!(svg.contains(">true</text>") && svg.contains(">emitted</text>"));
}

#[test]
fn the_worst_people_are_among_those_with_all_classes_and_are_drawn_while_they_move() {
    let made_up = |who: &str, classes: &[usize]| EvaluatedRecording::made_up(who, classes);
    let mut recordings = vec![
        // Two classes and rest alone: scores of others cannot be compared with theirs.
        made_up("synthetic/rest", &[0]),
        made_up("synthetic/two", &[0, 2]),
        made_up("synthetic/three", &[0, 1, 0, 2, 0]),
    ];
    // Holds, of which the last is rest.
    recordings.extend([1, 2, 0].map(|class| made_up("synthetic/holds", &[class])));
    let evaluated = Evaluated::new(recordings);
    let entry = evaluated.entry();
    let drawn = entry.drawn(9, false).unwrap();
    let mut people: Vec<&str> = drawn.iter().map(|own| own.subject).collect();
    people.sort_unstable();
    assert_eq!(people, ["synthetic/holds", "synthetic/three"]);
    for own in &drawn {
        let moves = |label: &Option<Intent>| label.is_some_and(|own| own != Intent::Relax);
        assert!(own.truth.iter().any(moves), "{}", own.subject);
    }
    // If no person has all classes, the people who have the most.
    let nobody = Evaluated::new(vec![made_up("synthetic/two", &[0, 2])]);
    assert_eq!(nobody.entry().drawn(9, false).unwrap().len(), 1);
}

#[test]
fn a_number_that_is_missing_at_the_top_of_a_page_says_why() {
    let holds = [0, 1, 2].map(|class| EvaluatedRecording::made_up("synthetic/holds", &[class]));
    let mut moved = EvaluatedRecording::made_up("synthetic/a", &[0, 1, 0, 2, 0]);
    let point = Movement::new(MovementKind::Point, 0..200);
    moved.other_movement.push(point);
    let headline = |evaluated: &Evaluated| {
        let html = page(evaluated, &[evaluated.entry()]).html().unwrap();
        let (_, rest) = html.split_once("<ul class=\"headline\">").unwrap();
        rest.split_once("</ul>").unwrap().0.to_owned()
    };
    let holds = headline(&Evaluated::new(holds.to_vec()));
    for why in [
        "no label changes here",
        "no gesture begins here",
        "no gesture is let go here",
    ] {
        assert!(holds.contains(why), "{why}: {holds}");
    }
    // Other movement is told of where a data set marks it.
    assert!(!holds.contains("other movement"));
    let moved = headline(&Evaluated::new(vec![moved]));
    assert!(moved.contains("other movement") && moved.contains("a minute of it"));
    let silent = "<span class=\"value\">-</span> <span class=\"with\"></span>";
    for headline in [holds, moved] {
        assert!(!headline.contains(silent), "{headline}");
    }
}
