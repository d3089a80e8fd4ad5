//! One file of all that a chip is flashed with, read back.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, ensure};
use nrf52::chip::APPROTECT;
use object::{Object as _, ObjectSection as _, SectionKind};
use xtask::firmware::Image;
use xtask::merge::{FlashPart, merged};

use myointent_tests::chip::{self, MODEL};
use myointent_tests::found;

const UICR: u32 = 0x1000_1000;
/// Bytes of a SoftDevice that ends where the program begins.
const SOFTDEVICE: u32 = 0x2_6000;

/// Each byte of an Intel hex file by its address, which may come once. GNU objcopy reads it: the library that the program writes
/// it with would share its own faults.
pub fn read(hex: &Path) -> anyhow::Result<BTreeMap<u32, u8>> {
    let folder = tempfile::tempdir()?;
    let elf = folder.path().join("elf");
    let mut objcopy = Command::new("objcopy");
    objcopy.args(["-I", "ihex", "-O", "elf32-little"]);
    let done = objcopy.arg(hex).arg(&elf).output();
    let done = done.context("objcopy, of GNU binutils")?;
    ensure!(done.stderr.is_empty(), String::from_utf8(done.stderr)?);
    let bytes = std::fs::read(elf)?;
    let elf = object::File::parse(&*bytes)?;
    let mut found = BTreeMap::new();
    for section in elf.sections().filter(|one| one.kind() == SectionKind::Data) {
        let start = u32::try_from(section.address())?;
        for (address, byte) in (start..).zip(section.data()?) {
            ensure!(found.insert(address, *byte).is_none(), "{address:#x} twice");
        }
    }
    Ok(found)
}

/// Takes a region out of what was read.
pub fn take(found: &mut BTreeMap<u32, u8>, start: u32, length: usize) -> anyhow::Result<Vec<u8>> {
    let bytes = (start..).take(length).map(|address| {
        let byte = found.remove(&address);
        byte.with_context(|| format!("nothing at {address:#x}"))
    });
    bytes.collect()
}

#[test]
fn the_merged_file_holds_every_region_and_nothing_else() -> anyhow::Result<()> {
    let elf = found!(chip::elf(Image::Nrf52840S140));
    let image = found!(chip::image(Image::Nrf52840S140));
    let stand_in = FlashPart {
        name: "SoftDevice",
        segments: vec![
            (0, vec![0x5e; 0xb00]),
            (0x1000, vec![0xa5; SOFTDEVICE as usize]),
        ],
    };
    // As a file, which the library that writes it reads.
    let softdevice = FlashPart::hex("SoftDevice", &merged(std::slice::from_ref(&stand_in))?)?;
    assert_eq!(softdevice, stand_in);
    let model = chip::model();
    let parts = [
        softdevice,
        FlashPart::program(&elf)?,
        FlashPart::model(&model, &elf)?,
        FlashPart::access(),
    ];
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("merged.hex");
    std::fs::write(&file, merged(&parts)?)?;
    let mut found = read(&file)?;
    for (start, bytes) in stand_in.segments.iter().chain(&image.segments) {
        assert_eq!(&take(&mut found, *start, bytes.len())?, bytes, "{start:#x}");
    }
    assert_eq!(take(&mut found, MODEL, model.len())?, model);
    let access = take(&mut found, UICR + APPROTECT, 4)?;
    assert_eq!(access, [0x5a, 0, 0, 0]);
    assert!(found.is_empty(), "{} bytes more", found.len());
    Ok(())
}
