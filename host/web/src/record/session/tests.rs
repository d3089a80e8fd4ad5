use shared::intent::Intent;

use super::*;

/// Two rounds of two trials and a rest: relax 2 s, open 1.5 s, close 1 s; 3 s of pause.
const SHORT: &str = "rounds = 2\npause = 3\nsequence = [\"relax\", \"open\", \"close\", \"relax\", \"close\", \"relax\"]\n\
    [seconds]\nrelax = 2\nopen = 1.5\nclose = 1\n";
const FREE: &str = "pause = 1\ngestures = [\"relax\", \"open\", \"close\"]\n";

/// Session, stream and outputs: `R1@0 -@0 open1@5` is a round, no cue, and a cue with its trial, each with its sample.
struct Driver {
    session: Session,
    now: u32,
    next: u32,
    outputs: Vec<String>,
}

impl Driver {
    fn new(text: &str) -> Self {
        let session = Session::new(Protocol::parse("mine.toml", text).unwrap());
        Self {
            session,
            now: 0,
            next: 1000,
            outputs: Vec::new(),
        }
    }

    fn begun(text: &str) -> Self {
        let mut driver = Self::new(text);
        driver.samples(2);
        driver.act(Action::Begin);
        driver
    }

    fn handle(&mut self, input: Input) {
        self.session.handle(Millis(self.now), input);
        while let Some(output) = self.session.poll() {
            self.outputs.push(match output {
                Output::Round { number, at } => format!("R{number}@{}", at.0),
                Output::Cue { at, cue, trial } => {
                    let name = cue.map_or("-", Motion::name);
                    format!("{name}{trial}@{}", at.0)
                }
                Output::Rejected { trial, why } => format!("bad{trial}:{why:?}"),
                Output::Pause => "pause".to_owned(),
                Output::Over => "over".to_owned(),
            });
        }
    }

    fn act(&mut self, action: Action) {
        self.handle(Input::Action(action));
    }

    /// Feeds this many samples, two at a time as an armband sends them.
    fn samples(&mut self, count: u32) {
        for _ in 0..count / 2 {
            self.now += 10;
            let first = SampleIndex(self.next);
            self.handle(Input::Samples { first, count: 2 });
            self.next = self.next.wrapping_add(2);
        }
    }

    fn lose(&mut self, count: u32) {
        self.next += count;
    }

    fn outputs(&mut self) -> String {
        std::mem::take(&mut self.outputs).join(" ")
    }
}

#[test]
fn cues_begin_and_end_at_their_samples() {
    let mut driver = Driver::begun(SHORT);
    assert_eq!(driver.outputs(), "R1@1002 -0@1002");
    driver.samples(600);
    assert_eq!(driver.outputs(), "relax1@1602");
    driver.samples(1900);
    assert_eq!(
        driver.outputs(),
        "open1@2002 close1@2302 relax2@2502 close2@2902 relax3@3102 R2@3502 -0@3502"
    );
    driver.samples(2500);
    let outputs = driver.outputs();
    assert!(outputs.starts_with("relax4@4102 open4@4502"), "{outputs}");
    assert!(outputs.ends_with("relax6@5602 over"), "{outputs}");
    assert!(driver.session.is_over() && !driver.session.is_running());
    driver.samples(100);
    driver.act(Action::Repeat);
    assert_eq!(driver.outputs(), "");
}

#[test]
fn a_batch_that_goes_beyond_several_cues_begins_each_at_its_sample() {
    let mut driver = Driver::begun(SHORT);
    driver.outputs();
    let first = SampleIndex(driver.next);
    driver.handle(Input::Samples { first, count: 1101 });
    assert_eq!(driver.outputs(), "relax1@1602 open1@2002");
}

#[test]
fn a_gesture_that_went_wrong_is_repeated_from_its_rest_on() {
    let mut driver = Driver::begun(SHORT);
    driver.samples(600 + 500);
    driver.outputs();
    driver.act(Action::Repeat);
    assert_eq!(driver.outputs(), "bad1:Person relax2@2102");
    driver.samples(900);
    assert_eq!(driver.outputs(), "open2@2502 close2@2802 relax3@3002");
    // A repeat in the rest after a gesture rejects that gesture.
    driver.samples(100);
    driver.act(Action::Repeat);
    assert_eq!(driver.outputs(), "bad2:Person relax4@3102");
    driver.samples(900);
    assert_eq!(driver.outputs(), "open4@3502 close4@3802 relax5@4002");
    // A second repeat rejects no earlier gesture.
    driver.act(Action::Repeat);
    driver.outputs();
    driver.act(Action::Repeat);
    assert_eq!(driver.outputs(), "bad6:Person relax7@4002");
}

#[test]
fn every_trial_of_a_round_is_done_however_many_are_repeated() {
    let mut driver = Driver::begun(SHORT);
    for _ in 0..40 {
        driver.samples(370);
        if driver.session.view().phase == "cued" && driver.session.view().bad < 7 {
            driver.act(Action::Repeat);
        }
    }
    assert!(driver.session.is_over());
    let outputs = driver.outputs();
    let bad: Vec<&str> = outputs
        .split(' ')
        .filter_map(|one| one.strip_prefix("bad")?.split(':').next())
        .collect();
    let good = |name: &str| {
        let cues = outputs.split(' ').filter(|one| one.starts_with(name));
        let trials = cues.map(|one| one[name.len()..].split('@').next().unwrap());
        trials.filter(|trial| !bad.contains(trial)).count()
    };
    assert_eq!(
        (bad.len(), good("open"), good("close")),
        (7, 2, 4),
        "{outputs}"
    );
}

#[test]
fn six_lost_samples_fail_a_trial_and_five_do_not() {
    let mut driver = Driver::begun(SHORT);
    driver.samples(1100);
    driver.outputs();
    driver.lose(5);
    driver.samples(2);
    assert_eq!(driver.outputs(), "");
    driver.lose(6);
    driver.samples(2);
    assert_eq!(driver.outputs(), "bad1:Lost relax2@2115");
}

#[test]
fn losses_in_trial_after_trial_hold_the_session() {
    let mut driver = Driver::begun(SHORT);
    driver.samples(700);
    for _ in 0..3 {
        driver.lose(20);
        driver.samples(100);
    }
    let view = driver.session.view();
    assert_eq!(
        (view.phase, view.why, view.bad),
        ("held", Some(HoldReason::Losses), 3)
    );
    assert!(driver.outputs().ends_with("bad3:Lost pause"));
    // Samples continue, and no cue comes until the person continues.
    driver.samples(1000);
    assert_eq!(driver.outputs(), "");
    driver.act(Action::Begin);
    driver.samples(1100);
    let outputs = driver.outputs();
    assert!(
        outputs.starts_with("-0@") && outputs.contains(" relax4@") && outputs.contains("open4@"),
        "{outputs}"
    );
}

#[test]
fn a_stream_that_stands_or_goes_holds_the_session_and_the_trial_is_asked_for_again() {
    for (input, why) in [
        (Input::Tick, HoldReason::Silent),
        (Input::Hold(HoldReason::SourceLost), HoldReason::SourceLost),
        (Input::Hold(HoldReason::LeaderLeft), HoldReason::LeaderLeft),
        (Input::Hold(HoldReason::Disk), HoldReason::Disk),
        (Input::Hold(HoldReason::Gone), HoldReason::Gone),
        (Input::Action(Action::Hold), HoldReason::Person),
    ] {
        let mut driver = Driver::begun(SHORT);
        driver.samples(1100);
        driver.outputs();
        driver.now += 1999;
        driver.handle(Input::Tick);
        assert_eq!(driver.outputs(), "");
        driver.now += 1;
        driver.handle(input);
        let outputs = driver.outputs();
        assert!(
            outputs.starts_with("bad1:") && outputs.ends_with(" pause"),
            "{why:?}: {outputs}"
        );
        assert_eq!(driver.session.view().why, Some(why));
        driver.next += 5000;
        driver.samples(2);
        driver.act(Action::Begin);
        driver.samples(600);
        let outputs = driver.outputs();
        let at = driver.next - 602 + 2;
        assert_eq!(outputs, format!("-0@{at} relax2@{}", at + 600), "{why:?}");
    }
}

#[test]
fn a_count_that_goes_back_is_another_stream() {
    let mut driver = Driver::begun(SHORT);
    driver.samples(1100);
    driver.outputs();
    driver.next = 0;
    driver.samples(2);
    assert_eq!(driver.outputs(), "bad1:Lost pause");
    assert_eq!(driver.session.view().why, Some(HoldReason::SourceLost));
}

#[test]
fn a_stream_whose_count_wraps_is_the_same_stream() {
    let mut driver = Driver::new(SHORT);
    driver.next = u32::MAX - 801;
    driver.samples(2);
    driver.act(Action::Begin);
    driver.outputs();
    driver.samples(1100);
    assert_eq!(driver.outputs(), "relax1@4294967096 open1@200");
}

#[test]
fn without_a_stream_nothing_begins_and_it_can_be_ended() {
    let mut driver = Driver::new(SHORT);
    driver.act(Action::Begin);
    assert_eq!(
        (driver.outputs().as_str(), driver.session.view().phase),
        ("", "waiting")
    );
    driver.act(Action::Finish);
    assert_eq!(driver.outputs(), "pause");
    assert!(driver.session.is_over());
}

#[test]
fn who_ends_a_session_in_a_gesture_loses_that_gesture_alone() {
    let mut driver = Driver::begun(SHORT);
    driver.samples(600 + 1300);
    driver.outputs();
    driver.act(Action::Finish);
    assert_eq!(driver.outputs(), "bad2:Interrupted pause");
    let mut driver = Driver::begun(SHORT);
    driver.samples(600 + 1000);
    driver.outputs();
    driver.act(Action::Finish);
    assert_eq!(driver.outputs(), "pause");
}

#[test]
fn in_a_free_session_the_person_says_what_is_done() {
    let mut driver = Driver::begun(FREE);
    driver.samples(200);
    assert_eq!(driver.outputs(), "R1@1002 -0@1002 relax1@1202");
    driver.samples(100);
    driver.act(Action::Mark(Intent::Open.into()));
    driver.act(Action::Mark(Intent::Open.into()));
    // A gesture that is not in the protocol is ignored.
    driver.act(Action::Mark(Intent::Pinch.into()));
    driver.samples(300);
    driver.act(Action::Mark(Intent::Close.into()));
    driver.samples(300);
    driver.act(Action::Mark(Motion::RELAX));
    assert_eq!(driver.outputs(), "open1@1302 close1@1602 relax2@1902");
    driver.act(Action::Repeat);
    assert_eq!(driver.outputs(), "bad1:Person relax3@1902");
    assert_eq!(driver.session.view().left, None);
    driver.act(Action::Finish);
    assert_eq!(driver.outputs(), "over");
}

#[test]
fn the_time_that_is_left_is_what_it_takes() {
    let mut driver = Driver::new(SHORT);
    assert_eq!(driver.session.view().left, Some(5000));
    driver.samples(2);
    driver.act(Action::Begin);
    let begin = driver.next;
    while !driver.session.is_over() {
        let view = driver.session.view();
        let passed = driver.next - begin;
        let own = view.from.unwrap() - begin;
        assert_eq!(view.left, Some(u64::from(5000 - own)), "{passed} {view:?}");
        driver.samples(2);
    }
    assert_eq!(driver.session.view().left, Some(0));
}

proptest::proptest! {
    /// Any inputs in any order: no panic, and the outputs are consistent.
    #[test]
    fn any_inputs_make_a_session_that_can_be_written_down(
        inputs in proptest::collection::vec((0_u8..12, 0_u32..700), 0..120),
        free: bool,
    ) {
        let mut driver = Driver::new(if free { FREE } else { SHORT });
        for (kind, value) in inputs {
            match kind {
                0..=3 => driver.samples(value),
                4 => driver.lose(value % 12),
                5 => driver.now += value,
                6 => driver.act(Action::Begin),
                7 => driver.act(Action::Repeat),
                8 => driver.act(if value < 40 { Action::Finish } else { Action::Hold }),
                9 => driver.act(Action::Mark(Intent::ALL[value as usize % 6].into())),
                10 => driver.handle(Input::Tick),
                _ => driver.handle(Input::Hold(HoldReason::SourceLost)),
            }
            let view = driver.session.view();
            proptest::prop_assert_eq!(view.phase == "cued", view.cue.is_some());
            proptest::prop_assert!(view.done <= view.trials);
        }
        let outputs = driver.outputs();
        // No trial is rejected twice, and nothing follows the end.
        let mut bad: Vec<&str> = outputs.split(' ').filter(|one| one.starts_with("bad")).collect();
        let count = bad.len();
        bad.sort_unstable();
        bad.dedup();
        proptest::prop_assert_eq!(bad.len(), count, "{}", outputs);
        proptest::prop_assert!(outputs.find("over").is_none_or(|at| at + 4 == outputs.len()), "{}", outputs);
    }
}
