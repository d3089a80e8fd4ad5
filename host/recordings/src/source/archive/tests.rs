use std::io::{Cursor, Write as _};

use flate2::Compression;
use flate2::write::GzEncoder;
use zip::write::SimpleFileOptions;

use super::*;

fn zip(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        let options = SimpleFileOptions::default();
        writer.start_file(*name, options).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A tar whose names are written unchecked, which the library itself refuses to do.
fn tar(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut builder = tar::Builder::new(Vec::new());
    for (name, content) in entries {
        let mut header = tar::Header::new_ustar();
        header.as_mut_bytes()[..name.len()].copy_from_slice(name.as_bytes());
        header.set_size(content.len() as u64);
        header.set_mode(0o644);
        header.set_cksum();
        builder.append(&header, *content).unwrap();
    }
    builder.into_inner().unwrap()
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Unpacks bytes into `inside` of a new folder, which is returned with the result.
fn unpacked(bytes: &[u8], bounds: Bounds) -> (tempfile::TempDir, Result<Unpacked, FetchError>) {
    let folder = tempfile::tempdir().unwrap();
    let archive = folder.path().join("archive");
    fs::write(&archive, bytes).unwrap();
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    let result = unpack(&archive, &inside, bounds);
    (folder, result)
}

/// Asserts that an archive is refused in these words.
fn refused(result: Result<Unpacked, FetchError>, words: &str) {
    let told = result.unwrap_err().to_string();
    assert!(told.contains(words), "{words}: {told}");
}

fn bounds() -> Bounds {
    Bounds::of(1 << 20)
}

#[test]
fn each_kind_is_told_by_its_content_and_unpacked_as_it_is() {
    let entries: [(&str, &[u8]); 3] = [("a/b/1.csv", b"one"), ("a/2.csv", b""), ("./3", b"three")];
    for bytes in [zip(&entries), tar(&entries), gz(&tar(&entries))] {
        let (folder, result) = unpacked(&bytes, bounds());
        let expected = Unpacked {
            files: 3,
            bytes: 8,
            left_out: 0,
        };
        assert_eq!(result.unwrap(), expected);
        for (name, content) in entries {
            let path = folder.path().join("inside").join(name);
            assert_eq!(fs::read(path).unwrap(), content);
        }
    }
}

#[test]
fn a_name_that_leads_out_refuses_the_archive_and_writes_nothing_outside() {
    let absolute = "/tmp/myointent-escaped";
    for name in [
        "../out",
        "a/../../out",
        absolute,
        "..\\out",
        "C:\\out",
        "a/..",
    ] {
        for bytes in [tar(&[(name, b"x")]), zip(&[(name, b"x")])] {
            let (folder, result) = unpacked(&bytes, bounds());
            refused(result, "leads out of its folder");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "{name}");
            assert!(!Path::new(absolute).exists());
        }
    }
}

#[test]
fn a_link_is_left_out_so_that_nothing_follows_it() {
    let mut builder = tar::Builder::new(Vec::new());
    let mut header = tar::Header::new_ustar();
    header.set_entry_type(tar::EntryType::Symlink);
    header.set_size(0);
    builder
        .append_link(&mut header, "link", "/tmp/myointent-linked")
        .unwrap();
    let mut header = tar::Header::new_ustar();
    header.set_size(1);
    header.set_cksum();
    builder
        .append_data(&mut header, "link/file", &b"x"[..])
        .unwrap();
    let (folder, result) = unpacked(&builder.into_inner().unwrap(), bounds());
    let done = result.unwrap();
    assert_eq!((done.files, done.left_out), (1, 1));
    let link = folder.path().join("inside/link");
    assert!(link.is_dir() && !link.is_symlink());
    assert!(!Path::new("/tmp/myointent-linked").exists());
}

#[test]
fn what_is_too_large_twice_there_cut_or_no_archive_is_refused() {
    // Bytes are counted as they come, whatever number the archive states.
    let bomb = vec![0; 1 << 20];
    let bombs = [zip(&[("zeros", &bomb)]), gz(&tar(&[("zeros", &bomb)]))];
    assert!(bombs.iter().all(|bytes| bytes.len() < 10_000));
    let numbers = (0..20_000_u32).flat_map(|at| (at * at).to_le_bytes());
    let content: Vec<u8> = numbers.collect();
    let whole = [gz(&tar(&[("a", &content)])), zip(&[("a", &content)])];
    let (mut few, mut one) = (bounds(), bounds());
    (few.bytes, one.entries) = (1000, 1);
    let two: [(&str, &[u8]); 2] = [("a", b"1"), ("./a", b"2")];
    for (bytes, bounds, words) in [
        (&bombs[0][..], few, "more than 1000 bytes"),
        (&bombs[1], few, "more than 1000 bytes"),
        (&zip(&two), one, "more than 1 files"),
        (&tar(&two), bounds(), "twice"),
        (&whole[0][..whole[0].len() / 2], bounds(), "/archive: "),
        (&whole[1][..whole[1].len() - 10], bounds(), "/archive: "),
        (b"gt,emg_0\n", bounds(), "a zip, tar or tar.gz archive"),
    ] {
        let (_folder, result) = unpacked(bytes, bounds);
        refused(result, words);
    }
}
