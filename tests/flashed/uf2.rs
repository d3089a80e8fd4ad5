//! Files for the drive of a boot loader, read back by a reader of this file's own.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, ensure};
use myointent::board::flash::Content;
use nrf52::Image as Flashed;
use xtask::firmware::Image;

use super::merged::take;
use myointent_tests::chip::{self, BINDING, MODEL};
use myointent_tests::{found, model_file};

/// Address of the journal, as in `memory.x`.
const JOURNAL: u32 = 0x5_6000;
/// Addresses that the boot loader writes.
const WINDOW: std::ops::Range<u32> = 0x1000..0xe_a000;

/// Reads a UF2 file as Adafruit's boot loader does (`is_uf2_block` and `write_block` in its ghostfat.c): each byte by its
/// address.
pub fn read(file: &[u8]) -> anyhow::Result<BTreeMap<u32, u8>> {
    let mut found = BTreeMap::new();
    let (blocks, rest) = file.as_chunks::<512>();
    ensure!(rest.is_empty(), "{} bytes more", rest.len());
    for (number, block) in blocks.iter().enumerate() {
        let word = |at: usize| {
            u32::from_le_bytes([block[at], block[at + 1], block[at + 2], block[at + 3]])
        };
        ensure!(block.starts_with(b"UF2\n") && word(4) == 0x9e5d_5157 && word(508) == 0x0ab1_6f30);
        ensure!(word(8) == 0x2000, "flags {:#x}", word(8));
        let (address, length) = (word(12), word(16));
        ensure!(
            length == 256 && address.is_multiple_of(256),
            "{length} at {address:#x}"
        );
        ensure!(word(20) as usize == number && word(24) as usize == blocks.len());
        ensure!(word(28) == 0xada5_2840, "family {:#x}", word(28));
        ensure!(WINDOW.contains(&address), "{address:#x} is not written");
        for (address, byte) in (address..).zip(&block[32..288]) {
            ensure!(found.insert(address, *byte).is_none(), "{address:#x} twice");
        }
    }
    Ok(found)
}

#[test]
fn a_file_for_a_boards_drive_holds_program_model_and_an_erased_journal() -> anyhow::Result<()> {
    for built in Image::UF2 {
        let elf = found!(chip::elf(built));
        let model = chip::model();
        let mut found = read(&xtask::uf2::file(&elf, &model)?)?;
        for (start, bytes) in Flashed::parse(&elf)?.segments {
            assert_eq!(take(&mut found, start, bytes.len())?, bytes, "{start:#x}");
        }
        take_model(&mut found, &model)?;
        // The rest of 256 bytes, at the end of the model and of each part of the program.
        assert!(found.values().all(|byte| *byte == 0xff) && found.len() < 3 * 256);
    }
    Ok(())
}

/// Takes a model and an erased journal out of a file's bytes.
fn take_model(found: &mut BTreeMap<u32, u8>, model: &[u8]) -> anyhow::Result<()> {
    ensure!(take(found, MODEL, model.len())? == model);
    ensure!(take(found, JOURNAL, 4096)? == [0xff; 4096]);
    ensure!(!found.keys().any(|at| (BINDING..MODEL).contains(at)));
    Ok(())
}

#[test]
fn the_program_writes_a_model_alone_or_into_the_file_of_an_image() -> anyhow::Result<()> {
    let mine = model_file("six-class");
    let alone = Content::new(None, Some(&mine))?;
    let mut found = read(&alone.file())?;
    take_model(&mut found, &mine)?;
    assert!(found.values().all(|byte| *byte == 0xff) && found.len() < 256);
    for built in Image::UF2 {
        let elf = found!(chip::elf(built));
        let release = xtask::uf2::file(&elf, &chip::model())?;
        let image = Some((Path::new("image.uf2"), &release[..]));
        let content = Content::new(image, Some(&mine))?;
        let firmware = content.firmware.as_ref().context("no firmware")?;
        assert_eq!(firmware.board.image, built.name());
        assert_eq!(content.model, alone.model);
        // As if it had been built with this model.
        assert!(content.file() == xtask::uf2::file(&elf, &mine)?, "{built}");
    }
    Ok(())
}

#[test]
fn a_model_that_is_too_long_makes_no_file() -> anyhow::Result<()> {
    let elf = found!(chip::elf(Image::Xiao));
    assert!(xtask::uf2::file(&elf, &vec![0; 160 * 1024]).is_ok());
    assert!(xtask::uf2::file(&elf, &vec![0; 160 * 1024 + 1]).is_err());
    Ok(())
}
