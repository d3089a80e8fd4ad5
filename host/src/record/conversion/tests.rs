use shared::intent::Intent;
use shared::myo::Imu;
use shared::units::{Millis, Sample, SampleIndex};

use super::*;
use crate::record::journal::Journal;
use crate::record::{PersonQuality, quality_by_person};
use recordings::labels::motion::Motion;
use recordings::synthetic::Follower;
use recordings::{DataSet, MovementKind};
use web::record::journal::{Entry, FORMAT, Header, Writer};
use web::record::protocol::Protocol;
use web::record::session::{Action, Input, Output, Session};

const SHORT: &str = "rounds = 2\npause = 1\nsequence = [\"relax\", \"open\", \"relax\", \"close\", \"relax\"]\n\
    [seconds]\nrelax = 2\nopen = 2\nclose = 2\n";

/// Records a short session with a simulated person. Returns the samples from the session's first one on.
fn record(path: &Path, seconds: u32) -> Vec<Sample> {
    record_by(SHORT, path, seconds, |_| ())
}

/// Header of a session of `anna`.
fn header(protocol: &Protocol) -> Header {
    Header {
        format: FORMAT,
        person: "anna".into(),
        protocol: protocol.name.clone(),
        classes: protocol.names().into_iter().map(str::to_owned).collect(),
        free: protocol.is_free(),
        ..Header::default()
    }
}

/// Movement whose turn is a 16th of the index of the sample that is due.
fn movement(due: SampleIndex) -> Imu {
    Imu([16_384, 0, 0, 0, 0, 0, 2048, due.0 as i16, 0, 0])
}

/// Records a session by the text of a protocol; `also` changes its header. An armband that moves sends movement beside every second
/// pair, and is in the name of the file.
fn record_by(
    protocol: &str,
    path: &Path,
    seconds: u32,
    also: impl FnOnce(&mut Header),
) -> Vec<Sample> {
    let protocol = Protocol::parse("short.toml", protocol).unwrap();
    let mut header = header(&protocol);
    also(&mut header);
    let mut writer = Writer::default();
    writer.entry(&Entry::Begin(header));
    let moves = path.to_string_lossy().contains("moves");
    let mut session = Session::new(protocol);
    // Each file has another person: equal recordings count once.
    let mut person = Follower::new(path.file_stem().unwrap().to_str().unwrap());
    let mut sent = Vec::new();
    let mut cued = Motion::RELAX;
    session.handle(
        Millis(0),
        Input::Samples {
            first: SampleIndex(8),
            count: 2,
        },
    );
    session.handle(Millis(0), Input::Action(Action::Begin));
    for pair in 0..100 * seconds {
        let first = SampleIndex(10 + 2 * pair);
        let now = Millis(10 * pair);
        let samples = [(); 2].map(|()| person.sample(cued));
        session.handle(now, Input::Samples { first, count: 2 });
        while let Some(output) = session.poll() {
            if let Output::Cue { cue, .. } = output {
                cued = cue.unwrap_or(Motion::RELAX);
            }
            writer.entry(&Entry::of(output));
        }
        writer.samples(first, &samples);
        if moves && pair % 2 == 0 {
            let due = first.plus(2);
            writer.imu(due, movement(due));
        }
        sent.extend(samples);
        if session.is_over() {
            break;
        }
    }
    writer.close();
    let journal = Journal::create(path, &writer.take()).unwrap();
    journal.close().unwrap();
    sent
}

#[test]
fn a_session_becomes_a_recording_a_round_that_readers_take_sample_for_sample() {
    let folder = tempfile::tempdir().unwrap();
    let person = folder.path().join("anna");
    fs::create_dir(&person).unwrap();
    let journal = person.join("anna_20261122T110323Z_short.journal");
    let sent = record(&journal, 60);
    let conversion = convert(&journal).unwrap();
    assert!(!journal.exists());
    let names: Vec<_> = conversion
        .files
        .iter()
        .map(|path| path.file_name().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "anna_20261122T110323Z_short_1.csv",
            "anna_20261122T110323Z_short_2.csv"
        ]
    );
    let library = load(&person, &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["own/anna"]);
    let read: Vec<Sample> = library
        .recordings
        .iter()
        .flat_map(|recording| recording.samples.clone())
        .collect();
    assert_eq!(read, sent);
    for recording in &library.recordings {
        for intent in [Intent::Relax, Intent::Open, Intent::Close] {
            assert!(recording.labels.contains(&Some(intent)), "{intent:?}");
        }
    }
    assert_eq!(conversion.quality.counts["open"], 2);
}

#[test]
fn movement_is_a_file_beside_its_recording_and_changes_nothing_there() {
    let folder = tempfile::tempdir().unwrap();
    let [still, moved] = ["rests", "moves"].map(|name| {
        let person = folder.path().join(name).join("anna");
        fs::create_dir_all(&person).unwrap();
        let journal = person.join("anna_20261122T110323Z_short.journal");
        record(&journal, 60);
        convert(&journal).unwrap().files
    });
    assert_eq!((still.len(), moved.len()), (2, 2));
    for (still, moved) in still.iter().zip(&moved) {
        assert_eq!(fs::read(still).unwrap(), fs::read(moved).unwrap());
        assert_eq!(imu::read(still).unwrap(), None);
        let text = fs::read_to_string(moved).unwrap();
        let due = text.lines().skip(1).map(|line| line.split(',').nth(9));
        let due: Vec<f64> = due.map(|field| field.unwrap().parse().unwrap()).collect();
        let rows = imu::read(moved).unwrap().unwrap();
        assert!(rows.len() >= due.len() / 4 - 2, "{} rows", rows.len());
        for row in rows {
            assert_eq!(row[1..4], [1.0, 0.0, 0.0]);
            assert_eq!(row[8], due[row[0] as usize] / 16.0);
        }
    }
    let library = load(moved[0].parent().unwrap(), &LoadOptions::default()).unwrap();
    assert_eq!((library.recordings.len(), library.skipped.len()), (2, 0));
}

#[test]
fn other_movement_keeps_its_name_and_is_no_gesture() {
    let protocol = "pause = 1\nsequence = [\"relax\", \"open\", \"relax\", \"point\", \"relax\", \"other\", \"relax\"]\n\
        [seconds]\nrelax = 3\nopen = 3\npoint = 3\nother = 10\n";
    let folder = tempfile::tempdir().unwrap();
    let person = folder.path().join("anna");
    fs::create_dir(&person).unwrap();
    let journal = person.join("anna_1_short.journal");
    record_by(protocol, &journal, 60, |_| ());
    let conversion = convert(&journal).unwrap();
    let library = load(&person, &LoadOptions::default()).unwrap();
    let [recording] = &library.recordings[..] else {
        panic!("{:?}", library.skipped);
    };
    let seconds = |kind| {
        let movements = recording.other_movement.iter();
        let own = movements.filter(|movement| movement.kind == kind);
        own.map(|movement| movement.samples.len()).sum::<usize>() as f64 / 200.0
    };
    let (point, other) = (seconds(MovementKind::Point), seconds(MovementKind::Other));
    assert!((2.0..4.0).contains(&point), "{point}");
    // Whatever a simulated person does, activity by activity.
    assert!((5.0..=11.0).contains(&other), "{other}");
    let text = fs::read_to_string(&conversion.files[0]).unwrap();
    let row = |cue: &str| text.lines().filter(|row| row.contains(cue)).count();
    assert!(row(",-2,2,1,0,point,0,0") > 500, "{}", &text[..400]);
    let counts = &conversion.quality.counts;
    assert_eq!((counts["open"], counts["point"]), (1, 1), "{counts:?}");
    assert_eq!(quality_by_person(&library)[0].quality, conversion.quality);
    let findings = &conversion.quality.findings;
    let is_of_other = |finding: &Finding| {
        matches!(
            finding,
            Finding::Seldom {
                class: "point" | "other",
                ..
            }
        )
    };
    assert!(!findings.iter().any(is_of_other), "{findings:?}");
}

#[test]
fn sessions_are_judged_again_from_their_files_all_together() {
    let folder = tempfile::tempdir().unwrap();
    let person = folder.path().join("anna");
    fs::create_dir(&person).unwrap();
    let session = |name: &str| {
        let journal = person.join(format!("anna_{name}_short.journal"));
        record(&journal, 60);
        convert(&journal).unwrap().quality
    };
    let judged = || {
        let library = load(folder.path(), &LoadOptions::default()).unwrap();
        let [judged] = <[PersonQuality; 1]>::try_from(quality_by_person(&library)).unwrap();
        judged
    };
    let at_its_end = session("1");
    let once = judged();
    assert_eq!((once.person.as_str(), once.files), ("own/anna", 2));
    assert_eq!(once.quality, at_its_end);
    assert!(!once.quality.is_good_enough());
    // A session has two openings, and six of each gesture are needed.
    for (name, good) in [("2", false), ("3", true)] {
        session(name);
        assert_eq!(judged().quality.is_good_enough(), good, "{name}");
    }
    assert_eq!(judged().quality.counts["open"], 6);
    // A session ended before the first gesture.
    let ended = folder.path().join("eva");
    fs::create_dir(&ended).unwrap();
    let journal = ended.join("eva_1_short.journal");
    record(&journal, 2);
    convert(&journal).unwrap();
    let library = load(&ended, &LoadOptions::default()).unwrap();
    assert!(!quality_by_person(&library)[0].quality.is_good_enough());
    fs::remove_dir_all(&ended).unwrap();
    // A file that is not a guided recording is not judged.
    fs::write(
        person.join("anna_4.csv"),
        "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n0,1,1,1,1,1,1,1,1\n",
    )
    .unwrap();
    assert_eq!(judged().files, 6);
}

#[test]
fn samples_of_nobody_are_read_as_synthetic() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("anna_1.journal");
    record_by(SHORT, &journal, 20, |header| header.synthetic = true);
    let conversion = convert(&journal).unwrap();
    let library = load(&conversion.files[0], &LoadOptions::default()).unwrap();
    assert_eq!(library.recordings[0].data_set, DataSet::SYNTHETIC);
}

#[test]
fn a_recording_that_is_there_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("anna_1.journal");
    record(&journal, 20);
    let other = folder.path().join("anna_1_1.csv");
    fs::write(&other, "somebody's").unwrap();
    let error = convert(&journal).unwrap_err();
    assert!(matches!(error, RecordError::Exists { .. }), "{error}");
    assert_eq!(fs::read_to_string(&other).unwrap(), "somebody's");
    assert!(journal.exists());
    fs::remove_file(&other).unwrap();
    let conversion = convert(&journal).unwrap();
    assert_eq!(conversion.files[0], other);
}

#[test]
fn a_program_that_was_killed_between_files_goes_on_with_them() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("anna_1.journal");
    record(&journal, 60);
    let copy = fs::read(&journal).unwrap();
    let first = convert(&journal).unwrap();
    // Killed after the first file: the second is missing, and the journal is still there.
    fs::write(&journal, copy).unwrap();
    fs::remove_file(&first.files[1]).unwrap();
    let found = recover(folder.path()).unwrap();
    assert!(
        matches!(&found[..], [(_, Ok(own))] if *own == first),
        "{found:?}"
    );
    // One that was killed before the first line was written has recorded nothing.
    fs::write(&journal, b"5f3a0c11 0 {\"is\":\"beg").unwrap();
    assert!(recover(folder.path()).unwrap().is_empty() && !journal.exists());
}

#[test]
fn a_session_of_hours_becomes_recordings_that_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("anna_1.journal");
    let mut writer = Writer::default();
    let free = Protocol::find("free").unwrap();
    writer.entry(&Entry::Begin(header(&free)));
    let (number, at) = (1, SampleIndex(0));
    writer.entry(&Entry::of(Output::Round { number, at }));
    // Four hours of rest with few gestures, with samples as wide in text as possible.
    let (count, together) = (4 * 3600 * 200_u32, 2000);
    for (trial, at) in (0..count).step_by(together).enumerate() {
        let (at, trial) = (SampleIndex(at), trial as u32 + 1);
        let gesture = trial % 8 == 0;
        let intent = if gesture { Intent::Open } else { Intent::Relax };
        let cue = Some(intent.into());
        writer.entry(&Entry::of(Output::Cue { at, cue, trial }));
        let level = if gesture { 117_u64 } else { 100 };
        let sample = |of: usize| -> Sample {
            std::array::from_fn(|channel| {
                let number = (at.0 as u64 + of as u64) * 8 + channel as u64;
                let mixed = number.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
                let size = (level + mixed / 2 % 8) as i8;
                if mixed.is_multiple_of(2) { size } else { -size }
            })
        };
        let samples: Vec<Sample> = (0..together).map(sample).collect();
        writer.entry(&Entry::samples(at, &samples));
    }
    let journal = Journal::create(&path, &writer.take()).unwrap();
    journal.close().unwrap();
    let conversion = convert(&path).unwrap();
    let read = |file: &PathBuf| load(file, &LoadOptions::default()).unwrap();
    let lengths = conversion.files.iter().map(|file| {
        let library = read(file);
        assert_eq!(library.recordings.len(), 1, "{}", file.display());
        library.recordings[0].samples.len()
    });
    assert_eq!(lengths.sum::<usize>(), count as usize);
    assert!(!path.exists());
}

#[test]
fn a_journal_that_is_being_begun_is_not_taken_by_another_start() {
    let folder = tempfile::tempdir().unwrap();
    let person = folder.path().to_owned();
    let recovering = std::sync::atomic::AtomicBool::new(true);
    let first = Entry::Begin(header(&Protocol::find("free").unwrap())).line(0);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while recovering.load(std::sync::atomic::Ordering::Relaxed) {
                // A complete journal is taken; an open journal is not.
                let _ = recover(&person);
            }
        });
        for number in 0..1000 {
            let path = person.join(format!("anna_{number}.journal"));
            let journal = Journal::create(&path, &first);
            let is_there = path.exists();
            recovering.store(
                journal.is_ok() && is_there,
                std::sync::atomic::Ordering::Relaxed,
            );
            let journal = journal.unwrap();
            assert!(is_there, "begun {number} times, and gone");
            drop(journal);
        }
        recovering.store(false, std::sync::atomic::Ordering::Relaxed);
    });
}

#[test]
fn a_damaged_journal_is_kept_beside_all_that_could_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("anna_1.journal");
    let sent = record(&journal, 60);
    // A bit of a line of samples in the first round.
    let mut bytes = fs::read(&journal).unwrap();
    let mut ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let (end, _) = ends.nth(20).unwrap();
    bytes[end + 40] ^= 1;
    fs::write(&journal, &bytes).unwrap();
    let conversion = convert(&journal).unwrap();
    assert_eq!(
        conversion.damage().unwrap(),
        "the journal is damaged: lines lost: 1, seconds of samples in them: 0.1"
    );
    assert!(!journal.exists());
    assert_eq!(fs::read(journal.with_extension(DAMAGED)).unwrap(), bytes);
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    let samples = library.recordings.iter().map(|own| own.samples.len());
    let lost = sent.len() - samples.sum::<usize>();
    assert!((1..=40).contains(&lost), "{lost} of {}", sent.len());
}
