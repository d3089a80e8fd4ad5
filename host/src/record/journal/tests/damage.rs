//! Journals that were damaged in place: every line that is whole is read.

use super::*;

/// Entries with `lines` lost lines in place of the lines from `from` on.
fn without(entries: &[Entry], from: usize, lines: usize) -> Vec<Entry> {
    let damage = Entry::Damage {
        lines: lines as u32,
    };
    let rest = entries[from + lines..].iter().cloned();
    let before = entries[..from].iter().cloned();
    before.chain([damage]).chain(rest).collect()
}

#[test]
fn any_changed_byte_loses_its_own_line_and_one_that_ends_a_line_also_the_next() {
    let whole = journal(60);
    let all = read(&whole).entries;
    for at in 0..whole.len() - 1 {
        let line = whole[..at].iter().filter(|&&byte| byte == b'\n').count();
        let lost = if whole[at] == b'\n' { 2 } else { 1 };
        for changed in [whole[at] ^ 1, whole[at] ^ 0x80, 0] {
            let mut bytes = whole.clone();
            bytes[at] = changed;
            let contents = read(&bytes);
            assert_eq!(
                contents.entries,
                without(&all, line, lost),
                "{at}: {changed}"
            );
            assert_eq!(contents.left_off, 0, "{at}: {changed}");
        }
    }
}

#[test]
fn every_line_that_is_whole_is_read_whatever_happened_to_the_others() {
    let whole = journal(130);
    let all = read(&whole).entries;
    let lines: Vec<&[u8]> = whole.split_inclusive(|&byte| byte == b'\n').collect();
    let (count, middle) = (lines.len(), lines.len() / 2);
    let length = |lines: &[&[u8]]| lines.concat().len();
    let zeros = |from: usize, to: usize| {
        let mut bytes = whole.clone();
        bytes[from..to].fill(0);
        bytes
    };
    let (from, to) = (length(&lines[..middle]), length(&lines[..middle + 3]));
    let (unfinished, last) = (whole.len() - 5, length(&lines[..count - 1]));
    let mut run_into = whole[..unfinished].to_vec();
    run_into[last - 1] = b'\r';
    let behind = Entry::Damage { lines: 1 };
    for (what, bytes, expected) in [
        (
            "a damaged end of a line before an unfinished one",
            run_into,
            without(&all, count - 2, 2),
        ),
        (
            "zeros behind an unfinished line",
            zeros(unfinished, whole.len()),
            without(&all, count - 1, 1),
        ),
        (
            "ends of lines of Windows",
            String::from_utf8_lossy(&whole).replace('\n', "\r\n").into(),
            all.clone(),
        ),
        (
            "a byte order mark",
            [&b"\xef\xbb\xbf"[..], &whole].concat(),
            all.clone(),
        ),
        ("empty lines", lines.join(&b"\n"[..]), all.clone()),
        (
            "lines twice",
            [lines[..middle + 3].concat(), lines[middle - 3..].concat()].concat(),
            all.clone(),
        ),
        (
            "lines deleted",
            [lines[..middle].concat(), lines[middle + 2..].concat()].concat(),
            without(&all, middle, 2),
        ),
        (
            "the first line deleted",
            lines[1..].concat(),
            without(&all, 0, 1),
        ),
        // With the line that they run into.
        ("zeros", zeros(from, to), without(&all, middle, 4)),
        (
            "zeros at the end",
            zeros(last, whole.len()),
            without(&all, count - 1, 1),
        ),
        (
            "zeros behind",
            [&whole[..], &[0; 4096]].concat(),
            all.iter().cloned().chain([behind]).collect(),
        ),
    ] {
        let contents = read(&bytes);
        assert_eq!(contents.entries, expected, "{what}");
        assert_eq!(contents.left_off, 0, "{what}");
    }
}

#[test]
fn a_damaged_first_line_leaves_the_session_whose_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.journal");
    let mut written = create(&path).unwrap();
    let (turn, mirrored) = (3, true);
    written.1.entry(&Entry::Placement { turn, mirrored });
    written.1.entry(&Entry::Round { number: 1, at: 0 });
    put(&mut written, 0, &[sample(0); 20]);
    written.0.close().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[12] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    let (lock, found, contents) = open(&path).unwrap();
    drop(lock);
    assert_eq!(
        (found.person.as_str(), samples(&contents).len()),
        ("anna", 20)
    );
    assert_eq!(contents.entries[0], Entry::Damage { lines: 1 });
    let placements = contents.entries.iter();
    let placements = placements.filter(|own| matches!(own, Entry::Placement { .. }));
    assert_eq!(placements.count(), 2);
    // A file without one whole line belongs to no session, and stays.
    for bytes in [&b"\0\0\0\0"[..], b"{}\n{}\n", b"no journal"] {
        std::fs::write(&path, bytes).unwrap();
        let error = open(&path).unwrap_err();
        assert!(matches!(error, RecordError::Headless { .. }), "{error}");
    }
}

#[test]
fn a_journal_of_a_format_that_is_not_read_is_refused_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.journal");
    for (format, is_read) in [(1, false), (2, true), (FORMAT, true), (FORMAT + 1, false)] {
        let begin = Entry::Begin(Header { format, ..header() });
        std::fs::write(&path, begin.line(0)).unwrap();
        let refused = open(&path).err().map(|error| error.to_string());
        assert_eq!(refused.is_none(), is_read, "{refused:?}");
        let says = |text: String| text.contains("this program reads 2 to 3: use the program");
        assert!(refused.is_none_or(says), "{format}");
    }
}
