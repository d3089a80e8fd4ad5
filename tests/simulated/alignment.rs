//! Alignment of a turned armband on the simulated board: a press of the button, and two openings of the hand.

use std::iter::repeat_n;

use myointent_tests::model_file;
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::simulation::{self, Inputs};
use recordings::synthetic::Follower;
use shared::intent::Intent;
use shared::stream::alignment::{Alignment, Arm};
use shared::units::Sample;

use super::page;

#[test]
fn after_a_press_and_two_openings_lines_equal_the_pipelines_and_the_led_says_what_happens() {
    let cues = [
        (Intent::Relax, 1200),
        (Intent::Open, 300),
        (Intent::Relax, 300),
        (Intent::Open, 300),
        (Intent::Relax, 1000),
    ];
    let cues = cues.into_iter().flat_map(|(cue, long)| repeat_n(cue, long));
    let worn = Alignment::new(3, false).inverse();
    let mut person = Follower::new("s2");
    let samples: Vec<Sample> = cues.map(|cue| worn.apply(person.sample(cue))).collect();
    let model = model_file("three-class");
    let ran = simulation::run(&Inputs {
        scenario: "run_seconds = 20\nend = \"disconnect\"\n\
                   person = [{ do = \"press\", at = 400, for_ms = 200 }]\n",
        model: &model,
        samples: &samples,
        page: &page(),
        calibration: &[],
        install: None,
    });
    let ran = ran.unwrap();
    ran.check(false).unwrap();
    let news = ran.alignments().unwrap();
    let states: Vec<_> = news.iter().map(|news| news.state.name()).collect();
    let expected = ["waiting", "waiting", "aligned", "disconnected"];
    assert_eq!(states, expected, "{}", ran.tails());
    // The alignment begins at the same sample as on the board.
    let (before, after) = samples.split_at(news[0].emitted.0 as usize + 1);
    let inputs = [
        Input::Samples(before),
        Input::Align(Arm::Unknown),
        Input::Samples(after),
        Input::Disconnected,
    ];
    let expected = expected_lines(&model, &inputs).unwrap();
    assert_eq!(ran.lines(), expected, "{}", ran.tails());
    // The LED is dark, blinks while gestures are waited for, and is lit until the armband has gone.
    let pins = ran.pins();
    let mut led: Vec<_> = pins.iter().map(|pins| pins.alignment_led).collect();
    led.dedup();
    assert!(led.len() >= 5 && !led[0] && led.len() % 2 == 1, "{led:?}");
    let valid = pins.into_iter().rfind(|pins| pins.valid);
    assert!(valid.is_some_and(|pins| pins.alignment_led));
}
