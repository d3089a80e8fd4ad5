use shared::intent::Intent;
use shared::stream::alignment::{Alignment, Profile};

use super::fixture::{library, people, preset, resolve};
use super::*;
use recordings::DataSet;

#[test]
fn a_misspelt_name_is_refused_with_the_nearest_known_one() {
    let error = resolve(&["own/p55"], &[]).unwrap_err().to_string();
    assert!(error.contains("\"own/p55\""), "{error}");
    assert!(error.contains("own/p5"), "{error}");
    let error = resolve(&[], &["owm/p1"]).unwrap_err().to_string();
    assert!(error.contains("own/p1"), "{error}");
}

#[test]
fn a_whole_data_set_may_be_held_out() {
    let everybody = ["p1", "p2", "p3", "p4"].map(|name| format!("synthetic/{name}"));
    let config = resolve(&everybody.each_ref().map(String::as_str), &[]).unwrap();
    let by_name = resolve(&["synthetic"], &[]).unwrap();
    assert_eq!(by_name.split, config.split);
    let mut validation = config.split.validation.iter();
    assert!(validation.all(|name| name.starts_with("own/")));
}

#[test]
fn a_set_that_is_not_trained_on_by_default_is_used_where_it_is_named() {
    let library = Library {
        recordings: [
            people(DataSet::OWN, 5),
            people(DataSet::named("uci-gestures"), 4),
        ]
        .concat(),
        ..Library::default()
    };
    let resolved = |preset: Preset| {
        let config = ResolvedConfig::new(preset, &library, None, false, None).unwrap();
        let of_set = |people: &Vec<String>| {
            let own = people
                .iter()
                .filter(|name| name.starts_with("uci-gestures/"));
            own.count()
        };
        [&config.split.training, &config.split.held_out].map(of_set)
    };
    assert_eq!(resolved(preset(&[], &[])), [0, 0]);
    assert_eq!(resolved(preset(&["uci-gestures"], &[])), [0, 4]);
    let mut named = preset(&[], &[]);
    named.data.data_sets = vec![DataSet::OWN, DataSet::named("uci-gestures")];
    assert!(resolved(named)[0] > 0);
}

/// A library as [`library`], with opens between rest.
fn openers() -> Library {
    let mut library = library();
    for (number, recording) in library.recordings.iter_mut().enumerate() {
        let own = number as i8;
        let open = [70, 50 + own, 35, 25, 18 - own, 12, 8, 6];
        for label in [Intent::Open, Intent::Relax, Intent::Open] {
            let sample = if label == Intent::Open { open } else { [2; 8] };
            recording.samples.extend([sample; 100]);
            recording.labels.extend([Some(label); 100]);
        }
    }
    library
}

#[test]
fn people_who_open_the_hand_make_a_template_and_others_none() {
    let preset = preset(&["synthetic/p1", "own/p4"], &["synthetic/p2", "own/p5"]);
    let config = ResolvedConfig::new(preset, &openers(), None, false, None).unwrap();
    let template = config.alignment_template().unwrap();
    let open = [70, 54, 35, 25, 14, 12, 8, 6].map(|mean| 64 * mean);
    assert_eq!(
        template.fit(Profile::new(open)).nearest.alignment,
        Alignment::NONE
    );
    // No person of the plain library opens the hand.
    let without = resolve(&["synthetic/p1"], &["synthetic/p2"]).unwrap();
    assert_eq!(without.alignment_template(), None);
}
