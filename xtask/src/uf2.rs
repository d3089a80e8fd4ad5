//! One UF2 file of program and model, to be dragged onto a boot loader's drive: `cargo xtask uf2`.
//!
//! Blocks of 512 bytes, each with an address and 256 bytes for flash. Source: github.com/microsoft/uf2, README. Adafruit's boot
//! loader for the nRF52840 takes no other length, asks for the family, and writes from 0x1000 to 0xEA000. It erases what it
//! writes, by pages of 4 KiB, and keeps the rest of a page.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};

use crate::firmware::Image;
use crate::merge::{Files, Part};

/// Bytes of a block of the file.
const BLOCK: usize = 512;
/// Bytes of flash in a block.
const PAYLOAD: u32 = 256;
/// Family of the nRF52840 with Adafruit's boot loader.
const FAMILY: u32 = 0xADA5_2840;
/// Flag: the block has a family.
const HAS_FAMILY: u32 = 0x2000;
const BEGINS: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const ENDS: u32 = 0x0AB1_6F30;

/// Options of the file.
#[derive(clap::Args)]
pub struct Arguments {
    /// Board: its image is built, and the file has its name.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Image::UF2.map(Image::name)))]
    board: String,
    /// Leaves out the program.
    #[arg(long)]
    model_only: bool,
    #[command(flatten)]
    files: Files,
}

/// Builds a board's image and writes it with a model into one file.
///
/// # Errors
/// When the image does not build, a file cannot be read or written, or the model does not fit.
pub fn run(arguments: &Arguments) -> Result<()> {
    let image = Image::UF2
        .into_iter()
        .find(|one| one.name() == arguments.board);
    let image = image.context("no board with a boot loader for UF2 files")?;
    let (elf, model) = arguments.files.read(image)?;
    let written = file(&elf, &model, !arguments.model_only)?;
    let out = arguments.files.write(image, "uf2", written)?;
    println!("{}", out.display());
    Ok(())
}

/// The file of a model, and of an image's program.
///
/// # Errors
/// When the image is no ELF file, or the model does not fit into its region.
pub fn file(elf: &[u8], model: &[u8], has_program: bool) -> Result<Vec<u8>> {
    let mut parts = vec![Part::erased_journal(elf)?, Part::model(model, elf)?];
    if has_program {
        parts.push(Part::program(elf)?);
    }
    let segments = parts.iter().flat_map(|part| &part.segments);
    let segments = segments.map(|(start, bytes)| (*start, &bytes[..]));
    Ok(blocks(segments).concat())
}

/// Blocks of a file with these segments of flash: addresses and bytes. Between them and behind them flash stays as it is, but for
/// the rest of 256 bytes.
fn blocks<'s>(segments: impl IntoIterator<Item = (u32, &'s [u8])>) -> Vec<[u8; BLOCK]> {
    let mut payloads = BTreeMap::new();
    for (start, bytes) in segments {
        for (address, byte) in (start..).zip(bytes) {
            let payload = payloads
                .entry(address / PAYLOAD)
                .or_insert([0xff; PAYLOAD as usize]);
            payload[(address % PAYLOAD) as usize] = *byte;
        }
    }
    let count = payloads.len() as u32;
    let block = |(number, (place, payload)): (u32, (u32, [u8; PAYLOAD as usize]))| {
        let header = [
            BEGINS[0],
            BEGINS[1],
            HAS_FAMILY,
            place * PAYLOAD,
            PAYLOAD,
            number,
            count,
            FAMILY,
        ]
        .map(u32::to_le_bytes);
        let header = header.as_flattened();
        let mut block = [0; BLOCK];
        block[..header.len()].copy_from_slice(header);
        block[header.len()..][..payload.len()].copy_from_slice(&payload);
        block[BLOCK - 4..].copy_from_slice(&ENDS.to_le_bytes());
        block
    };
    (0..).zip(payloads).map(block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_share_256_bytes_are_one_block_and_gaps_have_none() {
        let segments: [(u32, &[u8]); 3] = [(0x1000, &[1; 250]), (0x10fc, &[2; 8]), (0x2010, &[3])];
        let all = blocks(segments);
        let address =
            |block: &[u8; 512]| u32::from_le_bytes([block[12], block[13], block[14], block[15]]);
        let addresses: Vec<_> = all.iter().map(address).collect();
        assert_eq!(addresses, [0x1000, 0x1100, 0x2000]);
        let data = |number: usize| &all[number][32..288];
        assert_eq!(data(0)[248..], [1, 1, 0xff, 0xff, 2, 2, 2, 2]);
        assert_eq!(data(1)[..5], [2, 2, 2, 2, 0xff]);
        assert_eq!(data(2)[15..18], [0xff, 3, 0xff]);
        assert!(
            all.iter()
                .all(|block| block[288..508].iter().all(|byte| *byte == 0))
        );
    }

    #[test]
    fn nothing_has_no_block() {
        assert_eq!(blocks([]).len(), 0);
        assert_eq!(blocks([(0x1000, &[][..])]).len(), 0);
    }
}
