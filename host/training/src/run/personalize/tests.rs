//! Division of recordings, refusals, and contents of a tuned file.

use rayon::ThreadPoolBuilder;
use shared::intent::{Intent, Vocabulary};
use shared::model::dimensions::Dimensions;
use shared::model::file::random::{SMALL, random_model};
use shared::model::file::{Model, ModelParts};
use shared::units::WINDOW;

use super::*;
use recordings::synthetic::{self, SynthOptions};
use recordings::{DataSet, Movement, MovementKind, Recording};

const R: Option<Intent> = Some(Intent::Relax);
const O: Option<Intent> = Some(Intent::Open);
const C: Option<Intent> = Some(Intent::Close);

/// Smallest model, quick to tune.
fn parts(vocabulary: Vocabulary) -> ModelParts {
    let dimensions = Dimensions {
        span: 8,
        vocabulary,
        ..SMALL
    };
    let mut parts = random_model(dimensions, 5);
    parts.provenance.subjects_seen = vec!["roshambo/01".to_owned()];
    parts.provenance.subjects_left_out = vec!["wang-myo/p".to_owned(), "roshambo/02".to_owned()];
    parts.provenance.data_sets = vec!["roshambo".to_owned()];
    parts
}

fn file() -> Vec<u8> {
    parts(Vocabulary::Three).to_bytes().unwrap()
}

/// Recording of runs of labels; its set has no lag.
fn recording(runs: &[(Option<Intent>, usize)]) -> Recording {
    let labels: Vec<_> = runs
        .iter()
        .flat_map(|&(label, samples)| std::iter::repeat_n(label, samples))
        .collect();
    let sample = |(at, label): (usize, &Option<Intent>)| {
        let gain = label.map_or(9, |intent| 4 + 20 * intent as i8);
        [if at % 2 == 0 { gain } else { -gain }; 8]
    };
    let samples = labels.iter().enumerate().map(sample).collect();
    Recording::new(DataSet::named("wang-myo"), "wang-myo/p", samples, labels)
}

fn library(recordings: impl IntoIterator<Item = Recording>) -> Library {
    Library {
        recordings: recordings.into_iter().collect(),
        ..Library::default()
    }
}

fn person(library: &Library, subject: Option<&str>) -> Result<PersonRecordings, PersonalizeError> {
    let file = file();
    PersonRecordings::new(library, subject, &Model::parse(&file).unwrap().header)
}

/// Recording that repeats rest, open, rest, close.
fn turns(times: usize) -> Recording {
    recording(&[(R, 400), (O, 400), (R, 400), (C, 400)].repeat(times))
}

/// Bounds of the labelled samples of each recording in a part: the first, and one past the last.
fn labelled(part: &PersonPart<'_>) -> Vec<(usize, usize)> {
    let span = |recording: &evaluation::EvaluatedRecording| {
        let labels = &recording.lag_compensated;
        let first = labels.iter().position(Option::is_some).unwrap();
        let last = labels.iter().rposition(Option::is_some).unwrap();
        (first, last + 1)
    };
    part.evaluated_recordings().iter().map(span).collect()
}

#[test]
fn whole_recordings_are_held_back_and_they_are_the_last_ones() {
    let library = library([turns(2), turns(2), turns(2), turns(3), turns(2)]);
    let person = person(&library, None).unwrap();
    let (tuned, judged) = person.whole().divided().unwrap();
    let (short, long) = (2 * 1600, 3 * 1600);
    assert_eq!(labelled(&tuned), [(0, short); 3]);
    assert_eq!(labelled(&judged), [(0, long), (0, short)]);
    assert_eq!(tuned.seconds(), 3.0 * short as f64 / 200.0);
}

#[test]
fn a_single_recording_is_cut_with_a_window_between_the_parts() {
    let library = library([turns(9)]);
    let person = person(&library, None).unwrap();
    let (tuned, judged) = person.whole().divided().unwrap();
    let [(0, cut)] = labelled(&tuned)[..] else {
        panic!("{:?}", labelled(&tuned));
    };
    assert_eq!(cut, 9 * 1600 * 2 / 3);
    assert_eq!(labelled(&judged), [(cut + WINDOW, 9 * 1600)]);
    assert_eq!(person.whole().divisions().unwrap().len(), 1);
}

#[test]
fn recordings_of_one_gesture_are_divided_gesture_by_gesture() {
    let of = |label| recording(&[(R, 400), (label, 400)].repeat(8));
    let library = library([of(O), of(O), of(O), of(C)]);
    let person = person(&library, None).unwrap();
    let (tuned, judged) = person.whole().divided().unwrap();
    let cut = 6400 - 6400 / 3;
    assert_eq!(labelled(&tuned), [(0, 6400), (0, 6400), (0, cut)]);
    assert_eq!(labelled(&judged), [(0, 6400), (cut + WINDOW, 6400)]);
    // Both gestures get the same time, as far as there is.
    assert_eq!(labelled(&tuned.first(20.0)), [(0, 2000), (0, 2000)]);
    let most = tuned.first((cut + 6400 + 600) as f64 / 200.0);
    assert_eq!(labelled(&most), [(0, 6400), (0, 600), (0, cut)]);
}

#[test]
fn what_is_too_short_for_a_third_is_divided_into_quarters_each_held_back_once() {
    let library = library([turns(5)]);
    let person = person(&library, None).unwrap();
    let folds = person.whole().divisions().unwrap();
    let judged = folds.iter().flat_map(|(_, judged)| labelled(judged));
    // Cuts are in the middle of rests, and nothing is left out.
    let quarters = [(0, 1800), (1800, 4200), (4200, 5800), (5800, 8000)];
    assert_eq!(judged.collect::<Vec<_>>(), quarters);
    let tuned: f64 = folds.iter().map(|(tuned, _)| tuned.seconds()).sum();
    assert_eq!(tuned, (3.0 * 8000.0 - 6.0 * WINDOW as f64) / 200.0);
}

#[test]
fn what_cannot_teach_is_refused_by_name() {
    let refused = |recordings: Vec<Recording>, subject: Option<&str>| {
        let library = library(recordings);
        let person = match person(&library, subject) {
            Ok(person) => person,
            Err(error) => return error,
        };
        person.whole().divided().err().unwrap()
    };
    let other = Recording {
        subject: "wang-myo/q".to_owned(),
        ..turns(9)
    };
    let several = refused(vec![turns(9), other.clone()], None);
    assert!(matches!(several, PersonalizeError::SeveralPeople { found } if found.len() == 2));
    let unknown = refused(vec![turns(9), other], Some("x"));
    assert!(matches!(unknown, PersonalizeError::UnknownPerson { .. }));
    let unlabelled = refused(vec![recording(&[(None, 900)])], None);
    assert!(matches!(unlabelled, PersonalizeError::NoLabels { .. }));
    let rest_and_open = recording(&[(R, 400), (O, 400)].repeat(9));
    let PersonalizeError::MissingClass { missing, .. } = refused(vec![rest_and_open], None) else {
        panic!("expected a missing class");
    };
    assert_eq!(missing, "close");
    let waves = recording(&[(R, 400), (Some(Intent::WaveIn), 400)].repeat(9));
    let vocabulary = refused(vec![waves], None);
    assert!(matches!(vocabulary, PersonalizeError::Vocabulary { .. }));
    // The part held back has only one opening.
    let short = refused(vec![turns(3)], None);
    let PersonalizeError::TooShort { part, found, .. } = short else {
        panic!("{short}");
    };
    assert_eq!((part, found), ("held back", 1));
}

#[test]
fn a_person_is_named_with_or_without_the_data_set() {
    let other = Recording {
        subject: "wang-myo/q".to_owned(),
        ..turns(9)
    };
    let library = library([turns(9), other]);
    for name in ["q", "wang-myo/q"] {
        let found = person(&library, Some(name)).unwrap();
        assert_eq!(found.subject(), "wang-myo/q");
    }
}

/// Library of one synthetic person.
fn synthetic() -> Library {
    let options = SynthOptions {
        subjects: 1,
        recordings: 3,
        seconds: 40,
        ..SynthOptions::default()
    };
    library(synthetic::generate(&options))
}

const SETTINGS: fn() -> TuningSettings = || TuningSettings {
    steps: 6,
    steps_with_other: 6,
    batch: 4,
    ..TuningSettings::default()
};

/// Personalizes a model file on the only person of a library.
fn personalized(
    (file, library): (&[u8], &Library),
    settings: &TuningSettings,
    interrupt: &Interrupt,
    report: impl FnMut(usize, usize),
) -> Result<Personalized, PersonalizeError> {
    let device = Device::default().autodiff();
    personalize(file, library, None, settings, &device, interrupt, report)
}

fn tuned(settings: &TuningSettings) -> Personalized {
    let mut taken = Vec::new();
    let report = |step, of| taken.push((step, of));
    let own = (&file()[..], &synthetic());
    let done = personalized(own, settings, &Interrupt::default(), report);
    assert!(taken.into_iter().eq((1..=6).map(|step| (step, 6))));
    done.unwrap()
}

#[test]
fn a_tuned_file_keeps_all_but_the_weights_and_says_whom_it_saw() {
    let done = tuned(&SETTINGS());
    let (old, new) = (file(), &done.bytes);
    let [old, new] = [&old, new].map(|bytes| Model::parse(bytes).unwrap().to_parts());
    assert_ne!(new.head, old.head);
    assert_eq!(new.smoother, old.smoother);
    assert_eq!(new.template, old.template);
    assert!(new.template.is_some());
    assert_eq!(new.dimensions, old.dimensions);
    assert_eq!(new.preprocessing, old.preprocessing);
    let provenance = &new.provenance;
    assert_eq!(provenance.subjects_seen, ["roshambo/01", "synthetic/s1"]);
    assert_eq!(provenance.data_sets, ["roshambo", "synthetic"]);
    assert_eq!(provenance.subjects_left_out, ["wang-myo/p", "roshambo/02"]);
    assert!(!done.seen_before);
}

#[test]
fn the_same_seed_gives_the_same_file_with_any_number_of_threads() {
    let with = |threads, seed| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let settings = TuningSettings { seed, ..SETTINGS() };
        pool.install(|| tuned(&settings).bytes)
    };
    let one = with(1, 42);
    assert!(one == with(3, 42));
    assert!(one != with(1, 43));
}

#[test]
fn an_interrupt_stops_the_tuning() {
    let never = |steps, of| panic!("{steps} of {of} steps");
    let own = (&file()[..], &synthetic());
    let stopped = personalized(own, &SETTINGS(), &Interrupt::at_once(), never);
    assert!(stopped.unwrap_err().is_interrupt());
}

/// File of a model that knows other movement.
fn file_with_other() -> Vec<u8> {
    let parts = parts(Vocabulary::Three);
    let dimensions = Dimensions {
        other: true,
        ..parts.dimensions
    };
    let mut parts = ModelParts {
        provenance: parts.provenance,
        ..random_model(dimensions, 5)
    };
    parts.smoother.margins.other = Some(0.25);
    parts.to_bytes().unwrap()
}

#[test]
fn where_other_movement_is_shown_there_are_more_steps_and_a_lower_margin() {
    let file = file_with_other();
    let settings = TuningSettings {
        steps: 1,
        steps_with_other: 2,
        ..SETTINGS()
    };
    let tuned = |own: Recording| {
        let header = Model::parse(&file).unwrap().header;
        let person = PersonRecordings::new(&library([own]), None, &header).unwrap();
        let mut taken = Vec::new();
        let (device, interrupt) = (Device::default().autodiff(), Interrupt::default());
        let report = |step, of| taken.push((step, of));
        let whole = person.whole();
        let bytes = tune(&file, &whole, &settings, &device, &interrupt, report).unwrap();
        let margin = Model::parse(&bytes).unwrap().header.smoother.margins.other;
        (taken, margin)
    };
    assert_eq!(tuned(turns(5)), (vec![(1, 1)], Some(0.25)));
    let wave = Some(Intent::WaveIn);
    let shown = [R, O, R, C, R, wave].map(|label| (label, 400)).repeat(5);
    let expected = (vec![(1, 2), (2, 2)], Some(-1.0));
    assert_eq!(tuned(recording(&shown)), expected);
}

#[test]
fn a_margin_over_other_movement_is_not_judged_on_the_movements_that_chose_it() {
    let wave = Some(Intent::WaveIn);
    let turn = [(R, 400), (O, 400), (R, 400), (C, 400)];
    let moving = [(R, 400), (wave, 400)];
    // Of one recording, the last third is held back: three movements, one, and none.
    let three = [turn.as_slice(), &moving].concat().repeat(12);
    let one = [&turn.repeat(8)[..], &moving, &turn.repeat(2)].concat();
    let none = turn.repeat(9);
    for (recording, all, judged) in [(three, 4, 2), (one, 1, 1), (none, 0, 0)] {
        let library = library([self::recording(&recording)]);
        let with = |other_per_minute| {
            let settings = TuningSettings {
                steps: 1,
                steps_with_other: 1,
                other_per_minute,
                ..SETTINGS()
            };
            let own = (&file_with_other()[..], &library);
            personalized(own, &settings, &Interrupt::default(), |_, _| ())
        };
        let others = |done: &Personalized| {
            let [old, new, constant] = &done.scores;
            let seconds = [old, new, constant].map(|own| {
                let events = &own.events.subjects[0];
                let movements = events.raised.values().map(|of| of.all);
                (movements.sum::<usize>(), events.other_movement.seconds)
            });
            assert!(seconds.iter().all(|own| *own == seconds[0]), "{seconds:?}");
            seconds[0]
        };
        let (found, seconds) = others(&with(None).unwrap());
        assert_eq!(found, all);
        match with(Some(1000.0)) {
            Ok(done) => assert_eq!(others(&done), (judged, seconds / 2.0)),
            Err(error) => assert!(all == 0 && matches!(error, PersonalizeError::NoOthers)),
        }
    }
}

#[test]
fn rest_that_is_recorded_alone_gets_its_time_and_other_movement_alone_none() {
    let of = |label| recording(&[(label, 400)]);
    let mut other = recording(&[(R, 400), (None, 400)]);
    other.other_movement = vec![Movement::new(MovementKind::Point, 400..800)];
    let library = library([of(O), of(O), of(R), other, of(R), of(C), of(C)]);
    let person = person(&library, None).unwrap();
    let first = person.whole().first(4.5);
    assert_eq!(labelled(&first), [(0, 300), (0, 300), (0, 300)]);
}

#[test]
fn of_each_motion_half_of_the_holds_are_held_back_wherever_they_stand() {
    let blocks = [
        [(R, 400), (O, 400)].repeat(4),
        [(R, 400), (C, 400)].repeat(4),
    ];
    let library = library([recording(&blocks.concat()), recording(&[(R, 900)])]);
    let person = person(&library, None).unwrap();
    let (first, second) = person.whole().halves().unwrap();
    // Holds begin with the middle of the rest before them: the third opening at 1800, the third fist at 5000.
    let seconds = |part: &PersonPart<'_>| (part.seconds() * 200.0) as usize;
    assert_eq!(seconds(&first) + seconds(&second), 6400 + 900);
    assert_eq!(labelled(&first), [(0, 5000)]);
    assert_eq!(labelled(&second), [(1800, 6400), (0, 900)]);
    let open = |part: &PersonPart<'_>| {
        let labels = part.evaluated_recordings().swap_remove(0).lag_compensated;
        labels.into_iter().filter(|label| *label == O).count()
    };
    assert_eq!([&first, &second].map(open), [800, 800]);
}
