//! One Intel hex of all that a chip is flashed with: `cargo xtask merge`.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use anyhow::{Context as _, Result, bail, ensure};
use ihex::{Reader, Record};
use object::Endianness;
use object::read::elf::{ElfFile32, ProgramHeader as _};

use crate::firmware::{self, Compiling, Image};
use crate::toolchain::TARGET;
use crate::{address, cross_target, read, toolchain, write};

/// Address of UICR.APPROTECT, and its value HwDisabled: with it a debugger may access the chip. Without it, a chip of the
/// current revision locks itself at its first reset (nRF52840 product specification 1.7, 4.8.2 "Access port protection").
const APPROTECT: u32 = 0x1000_1208;
const HW_DISABLED: u32 = 0x5a;
const PAGE: usize = 4096;
/// Bytes of a line of data.
const LINE: usize = 32;
/// Bytes that an address of 16 bits reaches.
const SEGMENT: usize = 0x1_0000;

/// Options of the merge.
#[derive(clap::Args)]
pub struct Arguments {
    /// Image to build, and the name of the file.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(CHIPS.map(Image::name)))]
    pub image: String,
    /// Nordic's hex file of the SoftDevice, for an image that runs under one. Without it, the file has none.
    #[arg(long)]
    pub softdevice: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) files: Files,
}

/// Options of a file that is flashed: what goes into it, and where it is written.
#[derive(clap::Args)]
pub struct Files {
    /// Model file to flash.
    #[arg(long, default_value = "models/three-class.intent")]
    pub model: PathBuf,
    /// File to write. By default the image's name in target/cross.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// How its image is compiled.
    #[command(flatten)]
    pub compiling: Compiling,
}

impl Files {
    /// Builds an image, and reads it and the model file.
    pub fn read(&self, image: Image) -> Result<(Vec<u8>, Vec<u8>)> {
        let toolchain = toolchain::find(TARGET, self.compiling.install)?;
        let elf = firmware::build_image(&toolchain, image, self.compiling)?;
        Ok((read(&elf)?, read(&self.model)?))
    }

    /// Writes the file; returns its path, by default with this extension.
    pub fn write(&self, image: Image, extension: &str, bytes: impl AsRef<[u8]>) -> Result<PathBuf> {
        let default = || cross_target().join(image.name()).with_extension(extension);
        let out = self.out.clone().unwrap_or_else(default);
        write(&out, bytes)?;
        Ok(out)
    }
}

/// The images of chips.
pub const CHIPS: [Image; 3] = [Image::Nrf52840S140, Image::Nrf52840Sdc, Image::Nrf52832S132];

/// Builds an image and writes it with all that belongs to it into one file.
pub fn run(arguments: &Arguments) -> Result<()> {
    let image = Image::from_name(&arguments.image).context("no image of a chip")?;
    let (elf, model) = arguments.files.read(image)?;
    let mut parts = vec![
        FlashPart::program(&elf)?,
        FlashPart::model(&model, &elf)?,
        FlashPart::access(),
    ];
    if let Some(path) = &arguments.softdevice {
        let hex = String::from_utf8(read(path)?);
        let hex = hex.with_context(|| format!("{} is no Intel hex", path.display()))?;
        parts.push(FlashPart::hex("SoftDevice", &hex)?);
    }
    let out = arguments.files.write(image, "hex", merged(&parts)?)?;
    for part in &parts {
        println!("{part}");
    }
    println!("{}", out.display());
    Ok(())
}

/// Part of what is flashed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FlashPart {
    /// Name for people.
    pub name: &'static str,
    /// Addresses and bytes.
    pub segments: Vec<(u32, Vec<u8>)>,
}

impl FlashPart {
    /// The program of an image.
    pub fn program(elf: &[u8]) -> Result<Self> {
        let file = ElfFile32::<Endianness>::parse(elf).context("the image is no ELF file")?;
        let loaded = file.elf_program_headers().iter().filter_map(|segment| {
            let bytes = segment.data(file.endian(), elf).unwrap_or_default();
            let is_loaded = segment.p_type(file.endian()) == object::elf::PT_LOAD;
            // Where it is stored, not where it is copied to at the start.
            (is_loaded && !bytes.is_empty())
                .then(|| (segment.p_paddr(file.endian()), bytes.to_vec()))
        });
        let segments: Vec<_> = loaded.collect();
        ensure!(!segments.is_empty(), "the image has nothing to flash");
        Ok(Self {
            name: "program",
            segments,
        })
    }

    /// A model file, in the region that the image reads it from.
    pub fn model(file: &[u8], elf: &[u8]) -> Result<Self> {
        let (start, end) = (address(elf, "_model_start")?, address(elf, "_model_end")?);
        let room = (end - start) as usize;
        ensure!(
            file.len() <= room,
            "the model file has {} bytes, its region {room}",
            file.len()
        );
        Ok(Self {
            name: "model",
            segments: vec![(start, file.to_vec())],
        })
    }

    /// The page that says how far an installation of a model is, erased: the model is whole.
    pub fn erased_journal(elf: &[u8]) -> Result<Self> {
        Ok(Self {
            name: "journal",
            segments: vec![(address(elf, "_journal_start")?, vec![0xff; PAGE])],
        })
    }

    /// The word of UICR that lets a debugger access the chip.
    pub fn access() -> Self {
        Self {
            name: "UICR.APPROTECT",
            segments: vec![(APPROTECT, HW_DISABLED.to_le_bytes().to_vec())],
        }
    }

    /// Content of an Intel hex.
    pub fn hex(name: &'static str, text: &str) -> Result<Self> {
        let mut segments: Vec<(u32, Vec<u8>)> = Vec::new();
        let mut base = 0;
        for record in Reader::new(text) {
            match record.with_context(|| format!("{name}: no Intel hex"))? {
                Record::Data { offset, value } => {
                    let address = base + u32::from(offset);
                    match segments.last_mut() {
                        Some((start, bytes)) if *start + bytes.len() as u32 == address => {
                            bytes.extend(value);
                        }
                        _ => segments.push((address, value)),
                    }
                }
                Record::ExtendedLinearAddress(upper) => base = u32::from(upper) << 16,
                Record::ExtendedSegmentAddress(upper) => base = u32::from(upper) << 4,
                // Where a debugger would start it: a chip starts at its vector table.
                Record::StartLinearAddress(_) | Record::StartSegmentAddress { .. } => {}
                Record::EndOfFile => break,
            }
        }
        ensure!(!segments.is_empty(), "{name}: the file is empty");
        Ok(Self { name, segments })
    }

    fn ranges(&self) -> impl Iterator<Item = Range<u64>> + '_ {
        self.segments.iter().map(|(start, bytes)| {
            let start = u64::from(*start);
            start..start + bytes.len() as u64
        })
    }
}

impl fmt::Display for FlashPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:14}", self.name)?;
        for Range { start, end } in self.ranges() {
            write!(f, " {start:#010x}..{end:#010x}")?;
        }
        Ok(())
    }
}

/// The Intel hex of all parts.
pub fn merged(parts: &[FlashPart]) -> Result<String> {
    let mut ranges: Vec<_> = parts
        .iter()
        .flat_map(|part| part.ranges().map(|range| (range, part.name)))
        .collect();
    ranges.sort_by_key(|(range, _)| range.start);
    for two in ranges.windows(2) {
        if let [(before, one), (after, other)] = two
            && before.end > after.start
        {
            bail!(
                "{one} at {:#010x}..{:#010x} and {other} at {:#010x}..{:#010x} overlap: a SoftDevice belongs to an image \
                 that runs under it, and to no other",
                before.start,
                before.end,
                after.start,
                after.end
            );
        }
    }
    let mut segments: Vec<_> = parts.iter().flat_map(|part| &part.segments).collect();
    segments.sort();
    let mut records = Vec::new();
    let mut upper = None;
    for (start, bytes) in segments {
        let mut address = *start;
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let half = (address >> 16) as u16;
            if upper.replace(half) != Some(half) {
                records.push(Record::ExtendedLinearAddress(half));
            }
            let offset = (address & 0xffff) as u16;
            // No line crosses the end of what its address reaches.
            let length = rest.len().min(LINE).min(SEGMENT - usize::from(offset));
            let (line, after) = rest.split_at(length);
            records.push(Record::Data {
                offset,
                value: line.to_vec(),
            });
            address += length as u32;
            rest = after;
        }
    }
    records.push(Record::EndOfFile);
    Ok(ihex::create_object_file_representation(&records)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: &'static str, start: u32, bytes: usize) -> FlashPart {
        let bytes = (0..bytes).map(|place| (place % 251) as u8);
        FlashPart {
            name,
            segments: vec![(start, bytes.collect())],
        }
    }

    #[test]
    fn parts_that_overlap_by_a_byte_are_refused_with_both_names() {
        let program = part("program", 0x2_7000, 0x100);
        for start in [0x2_6ff1, 0x2_70ff] {
            let refused = merged(&[program.clone(), part("SoftDevice", start, 16)]);
            let words = refused.expect_err("they overlap").to_string();
            assert!(
                words.contains("program at 0x00027000..0x00027100"),
                "{words}"
            );
            assert!(words.contains("SoftDevice at "), "{words}");
        }
        let beside = [part("SoftDevice", 0x2_6ff0, 16), program];
        assert!(merged(&beside).is_ok());
    }

    #[test]
    fn what_is_no_hex_is_refused() {
        for text in ["", "no hex", ":0400000001020304F3"] {
            assert!(FlashPart::hex("SoftDevice", text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(FlashPart::model(&[0; 4], b"no image").is_err());
        assert!(FlashPart::program(b"\x7fELF and then nothing").is_err());
    }
}
