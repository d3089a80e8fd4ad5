mod damage;

use std::cell::Cell;
use std::io::{self, Write};
use std::path::Path;
use std::rc::Rc;

use shared::intent::Intent;
use shared::myo::Imu;
use shared::units::{CHANNELS, Millis, Sample, SampleIndex};

use super::file::write_pending;
use super::*;
use crate::record::RecordError;
use web::record::journal::{Contents, Entry, FORMAT, Header, Writer, read};
use web::record::session::{Output, RejectReason};

fn header() -> Header {
    Header {
        format: FORMAT,
        version: "0.1.0".into(),
        began: "2026-11-22T11:03:23Z".into(),
        person: "anna".into(),
        protocol: "quick".into(),
        classes: vec!["relax".into(), "open".into()],
        free: false,
        source: "demo".into(),
        synthetic: true,
    }
}

/// Creates a journal, and a writer that has written its header.
fn create(path: &Path) -> Result<(Journal, Writer), RecordError> {
    let mut writer = Writer::default();
    writer.entry(&Entry::Begin(header()));
    Ok((Journal::create(path, &writer.take())?, writer))
}

/// Writes samples, the last ones too.
fn put((journal, writer): &mut (Journal, Writer), first: u32, samples: &[Sample]) {
    writer.samples(SampleIndex(first), samples);
    writer.close();
    journal.append(&writer.take());
}

fn sample(at: u32) -> Sample {
    std::array::from_fn(|channel| (at as usize * CHANNELS + channel) as u8 as i8)
}

/// Writes samples two at a time, with cues between.
fn fill(writer: &mut Writer, count: u32) {
    for at in (0..count).step_by(2) {
        if at % 50 == 0 {
            let cue = Some(Intent::ALL[at as usize / 50 % 6].into());
            let output = Output::Cue {
                at: SampleIndex(at),
                cue,
                trial: at / 50 + 1,
            };
            writer.entry(&Entry::of(output));
        }
        writer.samples(SampleIndex(at), &[sample(at), sample(at + 1)]);
        writer.imu(SampleIndex(at), Imu([-1; _]));
    }
    let (trial, why) = (2, RejectReason::Person);
    writer.entry(&Entry::of(Output::Rejected { trial, why }));
    writer.entry(&Entry::Over);
}

fn journal(count: u32) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.entry(&Entry::Begin(header()));
    fill(&mut writer, count);
    writer.take().into_bytes()
}

/// Collects all samples with their index.
fn samples(contents: &Contents) -> Vec<(u32, Sample)> {
    let mut samples = Vec::new();
    for entry in &contents.entries {
        if let Entry::Samples { first, emg } = entry {
            samples.extend((*first..).zip(Entry::decoded(emg).unwrap()));
        }
    }
    samples
}

#[test]
fn what_was_written_is_read_to_the_sample() {
    let contents = read(&journal(130));
    let expected: Vec<_> = (0..130).map(|at| (at, sample(at))).collect();
    assert_eq!(samples(&contents), expected);
    assert_eq!(contents.entries.first(), Some(&Entry::Begin(header())));
    assert_eq!(contents.entries.last(), Some(&Entry::Over));
    assert_eq!((contents.left_off, contents.is_damaged()), (0, false));
}

#[test]
fn cut_at_any_byte_all_lines_before_the_cut_are_whole() {
    let whole = journal(130);
    let all = read(&whole).entries;
    for cut in 0..=whole.len() {
        let contents = read(&whole[..cut]);
        let lines = whole[..cut].iter().filter(|&&byte| byte == b'\n').count();
        assert_eq!(contents.entries, all[..lines], "{cut}");
        let end = whole[..cut].iter().rposition(|&byte| byte == b'\n');
        assert_eq!(contents.left_off, cut - end.map_or(0, |at| at + 1), "{cut}");
        assert!(!contents.is_damaged(), "{cut}");
    }
}

/// Disk with limited room, which takes a few bytes at a time.
struct Disk {
    room: Rc<Cell<usize>>,
    bytes: Vec<u8>,
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(self.room.get() - self.bytes.len()).min(7);
        if taken == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes.extend_from_slice(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn what_a_full_disk_took_can_be_read_and_what_it_did_not_take_is_written_when_it_has_room() {
    let whole = journal(130);
    for full in 0..whole.len() {
        let room = Rc::new(Cell::new(full));
        let mut disk = Disk {
            room: room.clone(),
            bytes: Vec::new(),
        };
        let mut pending = whole.clone();
        let error = write_pending(&mut disk, &mut pending).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert_eq!(disk.bytes, whole[..full]);
        // The room grows by a few bytes, so that every line is cut somewhere.
        room.set(full + 10);
        let _ = write_pending(&mut disk, &mut pending);
        room.set(usize::MAX);
        write_pending(&mut disk, &mut pending).unwrap();
        assert_eq!(disk.bytes, whole, "{full}");
    }
}

#[test]
fn a_journal_is_new_and_one_session_s_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.journal");
    let mut written = create(&path).unwrap();
    put(&mut written, 5, &[sample(5); 30]);
    written.0.flush(Millis(0)).unwrap();
    assert!(matches!(create(&path), Err(RecordError::Io { .. })));
    assert!(matches!(open(&path), Err(RecordError::Busy { .. })));
    written.0.close().unwrap();
    let (_lock, found, contents) = open(&path).unwrap();
    assert_eq!(
        (found.person.as_str(), samples(&contents).len()),
        ("anna", 30)
    );
}

/// Writes 40 samples, calls `trouble` with the journal in the folder `anna`, and writes 40 more. Returns the number of
/// samples in the folder's longest journal.
#[cfg(unix)]
fn written_around(trouble: impl FnOnce(&Path)) -> usize {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("anna");
    std::fs::create_dir(&folder).unwrap();
    let path = folder.join("anna_1.journal");
    let mut written = create(&path).unwrap();
    let write = |written: &mut (Journal, Writer), from: u32| {
        let samples: Vec<_> = (from..from + 40).map(sample).collect();
        put(written, from, &samples);
        // A loss of the name is checked later.
        let _ = written.0.flush(Millis(50 * from));
    };
    write(&mut written, 0);
    trouble(&path);
    write(&mut written, 40);
    let _ = written.0.close();
    let files = std::fs::read_dir(&folder).map(|files| files.flatten().collect());
    let files: Vec<std::fs::DirEntry> = files.unwrap_or_default();
    let journals = files.iter().filter_map(|file| open(&file.path()).ok());
    let found = journals.map(|(_, found, contents)| {
        assert_eq!(found.person, "anna");
        let expected = (0..80).map(|at| (at, sample(at)));
        assert!(
            expected
                .take(samples(&contents).len())
                .eq(samples(&contents))
        );
        samples(&contents).len()
    });
    found.max().unwrap_or(0)
}

#[cfg(unix)]
#[test]
fn whatever_happens_to_the_file_or_its_folder_the_folder_has_all_samples_at_the_end() {
    use std::fs;
    let folder = |path: &Path| path.parent().unwrap().to_owned();
    assert_eq!(written_around(|_| ()), 80);
    assert_eq!(written_around(|path| fs::remove_file(path).unwrap()), 80);
    let deleted = |path: &Path| fs::remove_dir_all(folder(path)).unwrap();
    assert_eq!(written_around(deleted), 80);
    let renamed = |path: &Path| fs::rename(folder(path), path.with_file_name("../anna-old"));
    assert_eq!(written_around(|path| renamed(path).unwrap()), 80);
    let moved = |path: &Path| fs::rename(path, path.with_file_name("elsewhere")).unwrap();
    assert_eq!(written_around(moved), 80);
    let replaced = |path: &Path| {
        fs::remove_file(path).unwrap();
        fs::write(path, "somebody's").unwrap();
    };
    assert_eq!(written_around(replaced), 80);
    // A program that synchronizes folders replaces the file by a copy.
    let synced = |path: &Path| {
        let copy = path.with_extension("copy");
        fs::copy(path, &copy).unwrap();
        fs::rename(copy, path).unwrap();
    };
    assert_eq!(written_around(synced), 80);
    let read_only = |path: &Path| {
        let mut permissions = fs::metadata(folder(path)).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(folder(path), permissions).unwrap();
    };
    assert_eq!(written_around(read_only), 80);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_tried_again_and_at_the_end_the_journal_is_elsewhere() {
    use std::fs;
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("anna");
    let begin = |name: &str| {
        fs::create_dir(&folder).unwrap();
        let mut written = create(&folder.join(name)).unwrap();
        put(&mut written, 0, &[sample(0); 20]);
        assert_eq!(written.0.flush(Millis(0)).unwrap(), FlushOutcome::InPlace);
        fs::remove_dir_all(&folder).unwrap();
        fs::write(&folder, "somebody's").unwrap();
        let refused = written.0.flush(Millis(20)).unwrap_err();
        assert!(matches!(refused, RecordError::Gone { .. }), "{refused}");
        put(&mut written, 20, &[sample(20); 20]);
        written.0
    };
    let mut journal = begin("a.journal");
    fs::remove_file(&folder).unwrap();
    // The next attempt comes a second after the last one.
    journal.flush(Millis(40)).unwrap_err();
    let gone = folder.join("a.journal");
    let anew = journal.flush(Millis(1040)).unwrap();
    assert_eq!(anew, FlushOutcome::Rewritten { gone: gone.clone() });
    assert_eq!(journal.flush(Millis(1060)).unwrap(), FlushOutcome::InPlace);
    assert_eq!(journal.close().unwrap(), gone);
    assert_eq!(samples(&open(&gone).unwrap().2).len(), 40);
    fs::remove_dir_all(&folder).unwrap();

    let name = format!("elsewhere-{}.journal", std::process::id());
    let ended = begin(&name).close().unwrap_err();
    let RecordError::Elsewhere { found, .. } = &ended else {
        panic!("{ended}");
    };
    assert!(ended.to_string().contains(found.to_str().unwrap()));
    assert_eq!(samples(&open(found).unwrap().2).len(), 40);
    fs::remove_file(found).unwrap();
    assert_eq!(fs::read(&folder).unwrap(), b"somebody's");
}

#[test]
fn a_journal_beyond_what_is_read_is_refused_and_not_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.journal");
    std::fs::write(&path, journal(60)).unwrap();
    let file = std::fs::File::options().append(true).open(&path).unwrap();
    file.set_len((256 << 20) + 335).unwrap();
    let error = match open(&path) {
        Ok((_, _, contents)) => panic!("{} bytes left off", contents.left_off),
        Err(error) => error.to_string(),
    };
    assert!(error.contains("256 MiB"), "{error}");
}

proptest::proptest! {
    /// Reads arbitrary bytes up to the last whole line.
    #[test]
    fn arbitrary_bytes_never_panic(bytes: Vec<u8>, cut in 0_usize..4000, extra: Vec<u8>) {
        let _ = read(&bytes);
        let whole = journal(60);
        let mut mixed = whole[..cut.min(whole.len())].to_vec();
        mixed.extend(extra);
        let _ = read(&mixed);
    }
}
