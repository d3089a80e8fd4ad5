use shared::intent::Intent;

use super::*;

/// Reason why a protocol is refused, without the name of its file.
fn refusal(text: &str) -> String {
    let error = Protocol::parse("mine.toml", text).unwrap_err().to_string();
    error.strip_prefix("mine.toml: ").unwrap().to_owned()
}

const SHORT: &str = "rounds = 2\npause = 3\nsequence = [\"relax\", \"open\", \"close\", \"relax\", \"close\", \"relax\"]\n\
    [seconds]\nrelax = 2\nopen = 1.5\nclose = 1\n";

#[test]
fn a_sequence_is_divided_into_cue_blocks_at_each_rest() {
    let protocol = Protocol::parse("some/mine.toml", SHORT).unwrap();
    let step = |motion, samples| MotionStep { motion, samples };
    let [open, close] = [Intent::Open, Intent::Close].map(Motion::Intent);
    let rest = step(Motion::RELAX, 400);
    let block = |steps: &[MotionStep]| CueBlock {
        steps: steps.to_vec(),
    };
    let blocks = vec![
        block(&[rest, step(open, 300), step(close, 200)]),
        block(&[rest, step(close, 200)]),
        block(&[rest]),
    ];
    assert_eq!(
        protocol,
        Protocol {
            name: "mine".to_owned(),
            pause: 600,
            course: Course::Guided { rounds: 2, blocks },
        }
    );
    assert_eq!(protocol.samples(), Some(2 * (600 + 1900)));
    assert_eq!(protocol.motions(), [Motion::RELAX, open, close]);
}

#[test]
fn every_built_in_protocol_has_each_gesture_as_often_as_personalize_needs() {
    for (name, _) in BUILT_IN {
        let protocol = Protocol::find(name).unwrap();
        let Course::Guided { rounds, blocks } = &protocol.course else {
            assert_eq!((name, protocol.samples()), ("free", None));
            continue;
        };
        for motion in protocol.motions() {
            let steps = blocks.iter().flat_map(|block| &block.steps);
            let once = steps.filter(|step| step.motion == motion).count();
            // Twice in the last round, which is held back, and twice before it; of other movement each kind once.
            let least = if motion.label().is_some() { 2 } else { 1 };
            assert!(*rounds >= 2 && once >= least, "{name}: {motion:?}");
        }
    }
}

/// Steps of a round of a built-in protocol, and the number of rounds.
fn steps_of(name: &str) -> (Vec<MotionStep>, u32) {
    let Course::Guided { rounds, blocks } = Protocol::find(name).unwrap().course else {
        panic!("{name} is guided");
    };
    let steps = blocks.into_iter().flat_map(|block| block.steps);
    (steps.collect(), rounds)
}

#[test]
fn built_in_protocols_are_as_long_as_said_and_the_paper_s_sequence_is_the_paper_s() {
    let seconds = |name: &str, is_counted: fn(Motion) -> bool| {
        let (steps, rounds) = steps_of(name);
        let counted = steps.iter().filter(|step| is_counted(step.motion));
        f64::from(rounds) * counted.map(|step| f64::from(step.samples)).sum::<f64>() / 200.0
    };
    for (name, least, most) in [
        ("quick", 170.0, 190.0),
        ("daily", 240.0, 280.0),
        ("quick-five", 120.0, 190.0),
        ("quick-six", 120.0, 230.0),
    ] {
        let samples = Protocol::find(name).unwrap().samples().unwrap();
        assert!((least..=most).contains(&(samples as f64 / 200.0)), "{name}");
    }
    let is_named = |motion| matches!(motion, Motion::Other(_)) && motion != Motion::OTHER;
    assert!(seconds("quick", is_named) >= 30.0);
    assert!(seconds("daily", |motion| motion == Motion::OTHER) >= 120.0);
    let letters = steps_of("paper").0.into_iter();
    let letters: String = letters
        .map(|step| step.motion.name()[..1].to_uppercase())
        .collect();
    assert_eq!(letters, "ROCORORCR");
}

#[test]
fn what_cannot_be_done_is_refused_with_its_reason() {
    let edit = |from: &str, to: &str| {
        let text = SHORT.replace(from, to);
        assert_ne!(text, SHORT);
        text
    };
    let number = |text: &str| {
        let refusal = refusal(text);
        let (what, bounds) = refusal.split_once(": ").unwrap();
        assert!(bounds.starts_with("expected "), "{refusal}");
        what.to_owned()
    };
    assert_eq!(number(&edit("rounds = 2", "rounds = 0")), "rounds");
    assert_eq!(number(&edit("pause = 3", "pause = 0")), "pause");
    assert_eq!(number(&edit("open = 1.5", "open = 0.5")), "seconds of open");
    assert_eq!(number(&edit("open = 1.5", "open = nan")), "seconds of open");
    assert_eq!(number(&edit("open = 1.5", "open = 1e9")), "seconds of open");
    let turns = "\"open\", \"relax\", ".repeat(200);
    let long = format!(
        "rounds = 5\npause = 3\nsequence = [\"relax\", {turns}]\n[seconds]\nrelax = 60\nopen = 60\n"
    );
    assert_eq!(number(&long), "hours of a session");
    let both = format!("gestures = [\"relax\", \"open\"]\n{SHORT}");
    let ends = "the sequence must begin and end with relax";
    let course = "expected either `sequence` (guided) or `gestures` (free), found";
    for (text, expected) in [
        (
            edit("open = 1.5\n", ""),
            "[seconds] has no open, which the sequence asks for",
        ),
        (
            edit("\"open\", \"close\"", "\"fist\""),
            "\"fist\" is no gesture: expected relax, open, close, wave-in, wave-out, pinch, radial-deviation, ulnar-deviation, \
             pronation, supination, point, two-fingers, three-fingers, four-fingers, fingers-together, thumb-up, other",
        ),
        (
            edit("\"open\", \"close\"", "\"open\", \"open\""),
            "open follows itself: ask for it once, for longer",
        ),
        (edit("[\"relax\", ", "["), ends),
        (edit(", \"relax\"]", "]"), ends),
        (both, &format!("{course} both")),
        ("pause = 3\n".to_owned(), &format!("{course} neither")),
        (
            "pause = 3\nrounds = 2\ngestures = [\"relax\", \"open\"]\n".to_owned(),
            "`rounds` means nothing in a free protocol",
        ),
    ] {
        assert_eq!(refusal(&text), expected);
    }
    for gestures in [
        "[]",
        "[\"relax\"]",
        "[\"open\", \"close\"]",
        "[\"relax\", \"open\", \"open\"]",
    ] {
        let text = format!("pause = 3\ngestures = {gestures}\n");
        assert_eq!(
            refusal(&text),
            "expected relax and at least one gesture, each once in `gestures`",
            "{gestures}"
        );
    }
}

#[test]
fn a_misspelt_key_is_named_with_its_line() {
    let text = SHORT.replace("rounds", "round");
    let error = Protocol::parse("mine.toml", &text).unwrap_err().to_string();
    assert!(
        error.contains("mine.toml") && error.contains("line 1"),
        "{error}"
    );
    assert!(error.contains("unknown field `round`"), "{error}");
    let error = Protocol::find("quik").unwrap_err().to_string();
    assert!(
        error.contains("quick-five") && error.contains("myointent protocols"),
        "{error}"
    );
}
