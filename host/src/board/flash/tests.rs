//! Files and boards that are flashed, or refused.

mod fake;

use std::fs;
use std::os::fd::AsRawFd as _;
use std::time::Duration;

use serial2::SerialPort;

pub(crate) use self::fake::{ARMBAND, Fake, Kept, NEW};
use super::*;

/// The first line of a XIAO's firmware, in a program.
pub(crate) const PROGRAM_TEXT: &[u8] =
    b"\x01\x02# myointent \0# myointent 0.1.0 0123456789ab, image xiao, model \xffrest";
const XIAO: &str = "Board-ID: nRF52840-SeeedXiao-v1\r\n";

fn model() -> Vec<u8> {
    fs::read("../models/three-class.intent").unwrap()
}

/// A file of a release.
pub(crate) fn image(text: &[u8]) -> Vec<u8> {
    let mut file = program(text);
    file.put_model(&model()).unwrap();
    file.file()
}

/// Firmware without a model.
fn program(text: &[u8]) -> Uf2 {
    let mut file = Uf2::default();
    file.put(0x1000, &[0; 300]);
    file.put(0x2000, text);
    file
}

fn content(image: &[u8], model: Option<&[u8]>) -> Result<Content, FlashError> {
    Content::new(Some((Path::new("xiao.uf2"), image)), model)
}

/// Message of an error with its causes.
fn said<T>(result: Result<T, FlashError>) -> String {
    format!("{:#}", anyhow::Error::new(result.map(drop).unwrap_err()))
}

#[test]
fn a_board_that_runs_something_else_afterwards_is_not_taken_for_done() {
    let fake = Fake::start("feather");
    let mut search = fake.search();
    let content = content(&image(PROGRAM_TEXT), None).unwrap();
    let drive = search.drive(|_| ()).unwrap();
    search.patience = Duration::ZERO;
    let silent = search.started(&content, BOARDS[0]).unwrap_err();
    assert!(matches!(silent, FlashError::Silent), "{silent}");
    drive.write(&content.file()).unwrap();
    search.patience = Duration::from_secs(2);
    let other = search.started(&content, BOARDS[0]).unwrap_err().to_string();
    let checksum = content.model.unwrap();
    assert!(
        other.contains(&format!("runs image feather with model {checksum:08x}")),
        "{other}"
    );
}

#[test]
fn without_a_board_it_says_what_to_buy_and_a_drive_that_does_not_come_is_not_waited_for_forever() {
    let folder = tempfile::tempdir().unwrap();
    let (_master, slave) = SerialPort::pair().unwrap();
    let port = fs::read_link(format!("/proc/self/fd/{}", slave.as_raw_fd())).unwrap();
    let search = Search {
        drive: Some(folder.path().to_owned()),
        port: Some(port),
        board: None,
        patience: Duration::ZERO,
    };
    let late = said(search.drive(|_| ()));
    assert!(late.contains("no drive came"), "{late}");
    let gone = Search {
        port: Some("/dev/no-such-board".into()),
        ..search
    };
    let gone = said(gone.drive(|_| ()));
    assert!(gone.contains("cannot be opened"), "{gone}");
    let said = FlashError::NoBoard.to_string();
    for word in ["buy", "XIAO", "Myo"] {
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn a_file_is_known_by_its_first_line_and_takes_another_model() {
    let release = image(PROGRAM_TEXT);
    let as_it_is = content(&release, None).unwrap();
    let firmware = as_it_is.firmware.clone().unwrap();
    assert_eq!(
        (&firmware.version[..], firmware.board.image),
        ("0.1.0 0123456789ab", "xiao")
    );
    assert_eq!(as_it_is.file(), release);
    let mine = fs::read("../models/six-class.intent").unwrap();
    let tuned = content(&release, Some(&mine)).unwrap();
    assert_eq!(tuned.model, Some(ModelFile::new(&mine).unwrap().checksum()));
    assert_ne!(tuned.model, as_it_is.model);
    let alone = Content::new(None, Some(&mine)).unwrap();
    assert_eq!((alone.model, &alone.firmware), (tuned.model, &None));
    let alone = Uf2::parse(&alone.file()).unwrap();
    assert!(alone.bytes(PROGRAM_REGION).is_empty());
}

#[test]
fn a_wrong_file_or_a_wrong_board_is_refused() {
    let release = image(PROGRAM_TEXT);
    let other = image(b"# myointent 0.1.0, image nrf52840-s140, model ");
    for (image, model, words) in [
        (
            &release[..1000],
            None,
            "blocks of 512 bytes, found 1: copy or download",
        ),
        (b"<!DOCTYPE html>", None, "xiao.uf2: "),
        (&other, None, "expected firmware of this project"),
        (
            &release,
            Some(&b"no model"[..]),
            "no board can run this file",
        ),
    ] {
        let refused = said(content(image, model));
        assert!(refused.contains(words), "{refused}");
    }

    let drive = |id: &str| Drive {
        path: "D:".into(),
        board: UsbBoard::with_id(id),
        id: id.to_owned(),
        version: "0.6.1".to_owned(),
    };
    let image = content(&release, None).unwrap();
    let alone = Content::new(None, Some(&model())).unwrap();
    let (xiao, nano, unknown) = (
        "nRF52840-SeeedXiao-v1",
        "nRF52840-nicenano",
        "SAMD51-something",
    );
    for content in [&image, &alone] {
        assert_eq!(content.fits(&drive(xiao), None).unwrap(), BOARDS[0]);
    }
    let feather = Some(BOARDS[1]);
    for (content, id, asked, expected) in [
        (&image, nano, None, "XIAO nRF52840"),
        (&image, unknown, None, "XIAO nRF52840"),
        (&image, xiao, feather, "XIAO nRF52840"),
        (&alone, nano, feather, "Feather nRF52840"),
        (&alone, unknown, None, "nice!nano 2"),
    ] {
        let refused = said(content.fits(&drive(id), asked));
        let (expected_board, _) = refused.split_once(", found Board-ID ").unwrap();
        assert!(expected_board.contains(expected), "{refused}");
    }
}

#[test]
fn a_model_that_no_board_can_run_is_not_in_a_file_that_is_taken() {
    let whole = model();
    let mut flipped = whole.clone();
    flipped[5000] ^= 1;
    let mut other_format = whole.clone();
    other_format[4] ^= 3;
    let mut files = Vec::new();
    for (damage, bytes) in [
        ("cut", &whole[..whole.len() / 2]),
        ("a piece short", &whole[..whole.len() - 256]),
        ("flipped", &flipped),
        ("of another format", &other_format),
        ("none", b"no model"),
    ] {
        let mut file = program(PROGRAM_TEXT);
        file.put(MODEL_REGION.start, bytes);
        files.push((damage, file));
    }
    let mut moved = program(PROGRAM_TEXT);
    moved.put(MODEL_REGION.start + 256, &whole);
    files.push(("moved", moved));
    for (damage, file) in files {
        // Beside firmware, and alone.
        let mut alone = Uf2::default();
        alone.put(MODEL_REGION.start, &file.bytes(MODEL_REGION));
        for file in [&file, &alone] {
            let refused = said(content(&file.file(), None));
            assert!(refused.starts_with("xiao.uf2: "), "{damage}: {refused}");
            assert!(refused.contains("model"), "{damage}: {refused}");
            // Another one takes its place.
            let mended = content(&file.file(), Some(&whole)).unwrap();
            assert_eq!(
                mended.model,
                Some(ModelFile::new(&whole).unwrap().checksum())
            );
        }
    }
}

#[test]
fn a_file_that_this_program_has_written_is_read_back() {
    let mine = fs::read("../models/six-class.intent").unwrap();
    let alone = Content::new(None, Some(&mine)).unwrap();
    let again = content(&alone.file(), None).unwrap();
    assert_eq!((again.model, &again.firmware), (alone.model, &None));
    assert_eq!(again.file(), alone.file());
    // A file of neither is not.
    let mut binding = Uf2::default();
    binding.put(0x5_7000, &[1; 256]);
    for file in [binding, program(b"another program")] {
        let foreign = content(&file.file(), None).unwrap_err();
        assert!(matches!(foreign, FlashError::Foreign { .. }), "{foreign}");
    }
}

/// Result of copying firmware without a model onto a board.
fn without_a_model(kept: Kept) -> Result<(), FlashError> {
    let fake = Fake::with("xiao", kept);
    let mut search = fake.search();
    let content = content(&program(PROGRAM_TEXT).file(), None).unwrap();
    assert_eq!(content.model, None);
    search.drive(|_| ())?.write(&content.file())?;
    search.patience = Duration::from_secs(2);
    search.started(&content, BOARDS[0]).map(drop)
}

#[test]
fn firmware_without_a_model_needs_one_on_the_board() {
    let model = Some(0x5f3a_0c11);
    without_a_model(Kept { model, ..NEW }).unwrap();
    let refused = said(without_a_model(NEW));
    assert!(
        refused.contains("no model that it can run: give one with --model"),
        "{refused}"
    );
}

/// Port that no user may open: the system checks who writes there.
const CLOSED: &str = "/proc/sys/kernel/ostype";

#[test]
fn a_port_that_this_user_may_not_open_is_said_before_anything_is_written_and_after() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("INFO_UF2.TXT"), XIAO).unwrap();
    let search = Search {
        drive: Some(folder.path().to_owned()),
        port: Some(CLOSED.into()),
        board: None,
        patience: Duration::ZERO,
    };
    let content = content(&image(PROGRAM_TEXT), None).unwrap();
    for refused in [
        said(search.drive(|_| ())),
        said(search.started(&content, BOARDS[0])),
    ] {
        assert!(refused.contains("cannot be opened"), "{refused}");
    }
}
