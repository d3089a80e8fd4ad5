//! Recordings of a journal that was damaged in place.

use recordings::Recording;

use super::*;

#[test]
fn a_damaged_journal_is_kept_beside_all_that_could_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("anna_1.journal");
    let sent = record(&journal, 60);
    let whole = fs::read(&journal).unwrap();
    // A line of samples in the first round.
    let text = String::from_utf8(whole.clone()).unwrap();
    let (line, _) = text.match_indices('\n').nth(20).unwrap();
    let line = line + 1;
    let middle = line + 40;
    assert!(
        text[line..middle].contains("samples"),
        "{}",
        &text[line..middle]
    );
    let flipped = {
        let mut bytes = whole.clone();
        bytes[middle] ^= 1;
        bytes
    };
    let deleted = {
        let end = line
            + whole[line..]
                .iter()
                .position(|&byte| byte == b'\n')
                .unwrap();
        [&whole[..line], &whole[end + 1..]].concat()
    };
    for bytes in [flipped, deleted] {
        fs::write(&journal, &bytes).unwrap();
        let found = recover(folder.path()).unwrap();
        let [(_, Ok(conversion))] = &found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(
            conversion.damage().unwrap(),
            "the journal is damaged: lines lost: 1, seconds of samples in them: 0.1"
        );
        let damaged = folder.path().join("anna_1.journal.damaged");
        assert_eq!(fs::read(&damaged).unwrap(), bytes);
        fs::remove_file(damaged).unwrap();
        let files = conversion.files.iter();
        let read = files.flat_map(|file| load(file, &LoadOptions::default()).unwrap().recordings);
        let read: Vec<Recording> = read.collect();
        let samples: usize = read.iter().map(|own| own.samples.len()).sum();
        let lost = sent.len() - samples;
        assert!((1..=40).contains(&lost), "{lost} of {}", sent.len());
        let open = |own: &Recording| own.labels.contains(&Some(Intent::Open));
        assert!(read.iter().any(open));
        for file in &conversion.files {
            fs::remove_file(file).unwrap();
        }
    }
    assert!(!journal.exists());
}
