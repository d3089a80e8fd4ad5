//! A folder as the drive of a boot loader.

use super::*;

/// Puts the information of a boot loader into a folder.
fn boot_loader(folder: &Path, id: &str) {
    let info = format!(
        "UF2 Bootloader 0.6.1 lib/nrfx (v2.0.0)\r\nModel: a board\r\nBoard-ID: {id}\r\nDate: Nov 30 2021\r\n"
    );
    fs::write(folder.join(INFO), info).unwrap();
}

const IDS: [(&str, Option<&str>); 7] = [
    ("nRF52840-SeeedXiao-v1", Some("xiao")),
    ("nRF52840-SeeedXiaoSense-v1", Some("xiao")),
    ("Seeed_XIAO_nRF52840_Sense", Some("xiao")),
    ("nRF52840-Feather-revE", Some("feather")),
    ("nRF52840-Feather-Sense", Some("feather")),
    ("nRF52840-nicenano", Some("nice-nano")),
    ("nRF52840-CircuitPlayground-revD", None),
];

#[test]
fn a_drive_tells_its_board() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(Drive::at(folder.path()), None);
    for (id, image) in IDS {
        boot_loader(folder.path(), id);
        let drive = Drive::at(folder.path()).unwrap();
        assert_eq!(drive.board.map(|board| board.image), image, "{id}");
        assert_eq!(drive.id, id);
    }
    fs::write(folder.path().join(INFO), "no board").unwrap();
    assert_eq!(Drive::at(folder.path()), None);
}

#[test]
fn of_two_drives_the_one_of_the_board_is_taken_and_none_of_two_alike() {
    let [one, other, empty] = [(); 3].map(|()| tempfile::tempdir().unwrap());
    boot_loader(one.path(), "nRF52840-SeeedXiao-v1");
    boot_loader(other.path(), "nRF52840-nicenano");
    let folders = || [&one, &other, &empty].map(|folder| folder.path().to_owned());
    let chosen = |board| Drive::among(folders(), board);
    let refused = chosen(None).unwrap_err().to_string();
    assert!(refused.starts_with("several drives"), "{refused}");
    let named =
        [&one, &other, &empty].map(|folder| refused.contains(&*folder.path().to_string_lossy()));
    assert_eq!(named, [true, true, false], "{refused}");
    let nano = chosen(UsbBoard::with_image("nice-nano")).unwrap();
    assert_eq!(nano.unwrap().path, other.path());
    boot_loader(other.path(), "nRF52840-SeeedXiaoSense-v1");
    let refused = chosen(UsbBoard::with_image("xiao"))
        .unwrap_err()
        .to_string();
    assert!(refused.starts_with("several drives"), "{refused}");
    assert_eq!(Drive::among([empty.path().to_owned()], None).unwrap(), None);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_drive_and_one_that_cannot_be_written_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    boot_loader(folder.path(), "nRF52840-nicenano");
    let drive = Drive::at(folder.path()).unwrap();
    drive.write(&[1; 512]).unwrap();
    assert_eq!(fs::read(folder.path().join(WRITTEN)).unwrap(), [1; 512]);
    fs::remove_file(folder.path().join(WRITTEN)).unwrap();
    let full = File::create("/dev/full").and_then(|out| copy(out, &[1; 512]));
    let full = FlashError::unwritten(drive.path.clone(), full.unwrap_err());
    assert!(matches!(full, FlashError::Full { .. }), "{full}");
    fs::create_dir(folder.path().join(WRITTEN)).unwrap();
    let refused = drive.write(&[1; 512]).unwrap_err();
    let is_unwritable = matches!(refused, FlashError::Unwritable { .. });
    assert!(is_unwritable, "{refused}");
}

#[test]
fn only_fat_is_looked_at() {
    let mounts = "/dev/sda1 / ext4 rw 0 0\nserver:/home /home nfs rw 0 0\n\
        /dev/sdb /media/me/XIAO\\040BOOT vfat rw,nosuid 0 0\nbroken\n";
    assert_eq!(fat(mounts), [PathBuf::from("/media/me/XIAO BOOT")]);
}

#[cfg(unix)]
#[test]
fn only_a_file_is_written_and_nothing_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    boot_loader(folder.path(), "nRF52840-nicenano");
    let drive = Drive::at(folder.path()).unwrap();
    let (path, mine) = (folder.path().join(WRITTEN), folder.path().join("mine"));
    fs::write(&mine, "precious").unwrap();
    let link = |to: &Path| std::os::unix::fs::symlink(to, &path);
    let pipe = || {
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.unwrap().success());
    };
    let refused = |what: &str| {
        let error = drive.write(&[1; 512]).unwrap_err();
        let error = format!("{:#}", anyhow::Error::new(error));
        assert!(error.contains(what), "{error}");
        assert_eq!(fs::read_to_string(&mine).unwrap(), "precious");
        fs::remove_file(&path).unwrap();
    };
    link(&mine).unwrap();
    refused("found a link");
    link(&folder.path().join("nothing")).unwrap();
    refused("found a link");
    assert!(!folder.path().join("nothing").exists());
    pipe();
    refused("found a device, pipe or socket");
    // A file is replaced, not written through: another name of it keeps what it has.
    fs::hard_link(&mine, &path).unwrap();
    drive.write(&[1; 512]).unwrap();
    assert_eq!(fs::read(&path).unwrap(), [1; 512]);
    assert_eq!(fs::read_to_string(&mine).unwrap(), "precious");
}
