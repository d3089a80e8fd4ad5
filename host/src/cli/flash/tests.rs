//! The command on simulated boards, and on folders that stand for drives.

use std::fs;
use std::path::Path;

use crate::board::ModelFile;
use crate::board::flash::tests::{ARMBAND, Fake, Kept, NEW, PROGRAM_TEXT, image};
use crate::cli::board::{Bind, run_bind};
use crate::cli::flash::{Answer, Arguments, Board, Command, Following, following, run};

#[test]
fn a_new_board_gets_firmware_and_an_armband_and_later_another_model_and_keeps_the_armband() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("xiao.uf2");
    fs::write(&file, image(PROGRAM_TEXT)).unwrap();
    let fake = Fake::start("xiao");
    let search = fake.search();
    let mut arguments = Arguments {
        firmware: Some(file),
        model: None,
        drive: search.drive,
        port: search.port.clone(),
        ..of_a_model()
    };
    let port = search.port.unwrap();
    let mut before = None;
    for own in ["../models/three-class.intent", "../models/six-class.intent"] {
        run(&arguments).unwrap();
        let mut board = Board::open(&port).unwrap();
        let following = following(&mut board).unwrap();
        assert!(matches!(following, Following::Bound(_)), "{following:?}");
        assert!(
            before
                .replace(following)
                .is_none_or(|before| before == following)
        );
        let running = board.ask(Command::Identify, |answer| match answer {
            Answer::Identity(identity) => identity.model,
            _ => None,
        });
        let expected = ModelFile::new(&fs::read(own).unwrap()).unwrap().checksum();
        assert_eq!(running.unwrap(), expected);
        arguments.firmware = None;
        arguments.model = Some("../models/six-class.intent".into());
    }
    // Without a file: the drive is found, and its file is named.
    (arguments.model, arguments.board) = (None, Some("xiao".to_owned()));
    let error = run(&arguments).unwrap_err().to_string();
    assert!(error.contains("xiao.uf2"), "{error}");
}

const MODEL: &str = "../models/three-class.intent";
const INFO: &str = "INFO_UF2.TXT";

/// Arguments for a model alone.
fn of_a_model() -> Arguments {
    Arguments {
        firmware: None,
        model: Some(MODEL.into()),
        board: None,
        pins_of: None,
        drive: None,
        port: None,
        out: None,
    }
}

/// Refusal of a folder as the drive, in which nothing was written.
fn refusal(folder: &Path, change: impl FnOnce(&mut Arguments)) -> String {
    let mut arguments = of_a_model();
    arguments.drive = Some(folder.to_owned());
    change(&mut arguments);
    let files = || fs::read_dir(folder).unwrap().count();
    let before = files();
    let error = format!("{:#}", run(&arguments).unwrap_err());
    assert_eq!(files(), before, "{error}");
    error
}

#[test]
fn a_boot_loader_that_is_too_old_is_said_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (first, version) in [
        ("UF2 Bootloader 0.3.2 lib/nrfx (v2.0.0)", "0.3.2"),
        (
            "UF2 Bootloader v0.3.2-7-g1f2e3d lib/nrfx (v2.0.0)",
            "0.3.2-7-g1f2e3d",
        ),
        ("UF2 Bootloader 0.2.13", "0.2.13"),
        ("UF2 Bootloader 0.3", "0.3"),
        ("uf2 bootloader v0.2.9", "0.2.9"),
        ("UF2 BOOTLOADER 0.0.1", "0.0.1"),
    ] {
        for end in ["\r\n", "\n", "\r"] {
            for (name, id) in [
                (INFO, "Board-ID: Seeed_XIAO_nRF52840"),
                ("info_uf2.txt", "board-id:nrf52840-nicenano"),
            ] {
                let text = [first, "Model: a board", id, "SoftDevice: S140 7.3.0", ""].join(end);
                fs::write(folder.path().join(name), text).unwrap();
                let said = refusal(folder.path(), |_| ());
                let expected = format!(
                    "expected a boot loader of version 0.4 or later, found {version}: nothing was written"
                );
                assert!(said.contains(&expected), "{first}: {said}");
                fs::remove_file(folder.path().join(name)).unwrap();
            }
        }
    }
}

#[test]
fn a_folder_that_is_no_drive_of_a_board_is_said_so_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let info = folder.path().join(INFO);
    let said = refusal(folder.path(), |_| ());
    assert!(
        said.contains("expected the drive of a boot loader"),
        "{said}"
    );
    for (text, word) in [
        ("UF2 Bootloader 0.6.1\r\nModel: a board\r\n", "Board-ID"),
        ("", "Board-ID"),
        (
            "Board-ID: nRF52840-Unknown-v7\r\n",
            "found Board-ID nRF52840-Unknown-v7: nothing was written",
        ),
        (
            "UF2 Bootloader 0.9.2\nBoard-ID: nRF52840-FeatherSenseTFT-revA\n",
            "--as nice-nano",
        ),
    ] {
        fs::write(&info, text).unwrap();
        let said = refusal(folder.path(), |_| ());
        assert!(said.contains(word), "{text}: {said}");
    }
    // A known board is not taken for another kind, whatever is said.
    fs::write(&info, "Board-ID: nRF52840-SeeedXiao-v1").unwrap();
    let said = refusal(folder.path(), |arguments| {
        arguments.pins_of = Some("nice-nano".to_owned())
    });
    assert!(
        said.contains("expected the drive of nice!nano 2, found Board-ID nRF52840-SeeedXiao-v1"),
        "{said}"
    );
    assert!(!said.contains("--as"), "{said}");
}

/// Flashes a model onto a board that shows its drive already, with this `Board-ID`.
fn flash_model(fake: &Fake, id: &str, pins_of: Option<&str>) -> anyhow::Result<()> {
    let search = fake.search();
    let drive = search.drive.unwrap();
    fs::write(drive.join(INFO), format!("Board-ID: {id}")).unwrap();
    run(&Arguments {
        pins_of: pins_of.map(str::to_owned),
        drive: Some(drive),
        port: search.port,
        ..of_a_model()
    })
}

#[test]
fn a_clone_is_flashed_as_the_board_whose_pins_it_has() {
    let fake = Fake::start("nice-nano");
    flash_model(&fake, "nRF52840-ProMicro-v0", Some("nice-nano")).unwrap();
}

#[test]
fn a_pairing_that_binds_nobody_is_no_success() {
    let fake = Fake::with("xiao", Kept { hears: None, ..NEW });
    let error = flash_model(&fake, "nRF52840-SeeedXiao-v1", None).unwrap_err();
    let error = format!("{error:#}");
    for words in "runs what was copied|no armband was heard|none is bound|bind begin".split('|') {
        assert!(error.contains(words), "{words}: {error}");
    }
    // The bound armband stays, and that is no success either.
    for (hears, succeeds) in [(None, false), (Some(ARMBAND), true)] {
        let following = Following::Bound(ARMBAND);
        let kept = Kept {
            hears,
            following,
            ..NEW
        };
        let fake = Fake::with("xiao", kept);
        let mut board = Board::open(&fake.search().port.unwrap()).unwrap();
        let bound = run_bind(&mut board, &Bind::Begin);
        assert_eq!(bound.is_ok(), succeeds, "{bound:?}");
    }
}
