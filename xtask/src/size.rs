//! What an image takes of flash and RAM, read from its ELF sections.

use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _, SectionKind};

/// Bytes by kind of section.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Size {
    /// Instructions.
    pub text: u64,
    /// Constants and the vector table.
    pub rodata: u64,
    /// Variables with initial values: in RAM, and in flash to be copied from.
    pub data: u64,
    /// Variables that start as zero or uninitialised: RAM only.
    pub bss: u64,
}

impl Size {
    /// Bytes of flash.
    pub const fn flash(self) -> u64 {
        self.text + self.rodata + self.data
    }

    /// Bytes of static RAM; the stack takes what is left.
    pub const fn ram(self) -> u64 {
        self.data + self.bss
    }

    fn add(&mut self, kind: SectionKind, bytes: u64) {
        match kind {
            SectionKind::Text => self.text += bytes,
            SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => self.rodata += bytes,
            SectionKind::Data => self.data += bytes,
            SectionKind::UninitializedData => self.bss += bytes,
            // Names, debug lines, log strings that stay on the PC.
            _ => {}
        }
    }
}

/// Sums the sections of an ELF image.
pub fn measure(elf: &[u8]) -> Result<Size> {
    let file = object::File::parse(elf).context("not an ELF image")?;
    let mut size = Size::default();
    for section in file.sections() {
        size.add(section.kind(), section.size());
    }
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_counted_where_they_will_lie() {
        let mut size = Size::default();
        size.add(SectionKind::Text, 1000);
        size.add(SectionKind::ReadOnlyData, 200);
        size.add(SectionKind::Data, 30);
        size.add(SectionKind::UninitializedData, 4);
        size.add(SectionKind::Debug, 50_000);
        assert_eq!(
            size,
            Size {
                text: 1000,
                rodata: 200,
                data: 30,
                bss: 4
            }
        );
        assert_eq!(size.flash(), 1230);
        assert_eq!(size.ram(), 34);
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(measure(b"").is_err());
        assert!(measure(b"\x7fELF and then nothing of use").is_err());
    }
}
