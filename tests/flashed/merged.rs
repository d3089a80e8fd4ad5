//! One file of all that a chip is flashed with, read back by a reader of this file's own.

use std::collections::BTreeMap;

use anyhow::{Context as _, ensure};
use nrf52::chip::APPROTECT;
use xtask::firmware::Image;
use xtask::merge::{FlashPart, merged};

use myointent_tests::chip::{self, MODEL};

const UICR: u32 = 0x1000_1000;
/// Bytes of a SoftDevice that ends where the program begins.
const SOFTDEVICE: u32 = 0x2_6000;

/// Reads an Intel hex: each byte by its address. Every line's checksum has to be right, and the last line says that it is
/// the last.
pub fn read(hex: &str) -> anyhow::Result<BTreeMap<u32, u8>> {
    let mut found = BTreeMap::new();
    let mut upper = 0;
    let mut is_over = false;
    for line in hex.lines() {
        ensure!(!is_over, "a line after the last one");
        let digits = line.strip_prefix(':').context("a line without a colon")?;
        let bytes = (0..digits.len()).step_by(2).map(|at| {
            let two = digits.get(at..at + 2).context("half a byte")?;
            Ok(u8::from_str_radix(two, 16)?)
        });
        let bytes = bytes.collect::<anyhow::Result<Vec<_>>>()?;
        let sum = bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        ensure!(sum == 0, "the checksum of {line}");
        let [length, high, low, kind, ref data @ .., _] = bytes[..] else {
            anyhow::bail!("a short line: {line}");
        };
        ensure!(usize::from(length) == data.len(), "the length of {line}");
        match kind {
            0 => {
                for (place, byte) in (0..).zip(data) {
                    let address = upper + u32::from(u16::from_be_bytes([high, low])) + place;
                    ensure!(found.insert(address, *byte).is_none(), "{address:#x} twice");
                }
            }
            1 => is_over = true,
            4 => upper = u32::from(u16::from_be_bytes([data[0], data[1]])) << 16,
            _ => anyhow::bail!("a line of kind {kind}"),
        }
    }
    ensure!(is_over, "no last line");
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
    let (Some(elf), Some(image)) = (
        chip::elf(Image::Nrf52840S140),
        chip::image(Image::Nrf52840S140),
    ) else {
        return Ok(());
    };
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
    let mut found = read(&merged(&parts)?)?;
    for (start, bytes) in stand_in.segments.iter().chain(&image.segments) {
        assert_eq!(&take(&mut found, *start, bytes.len())?, bytes, "{start:#x}");
    }
    assert_eq!(take(&mut found, MODEL, model.len())?, model);
    let access = take(&mut found, UICR + APPROTECT, 4)?;
    assert_eq!(access, [0x5a, 0, 0, 0]);
    assert!(found.is_empty(), "{} bytes more", found.len());
    Ok(())
}
