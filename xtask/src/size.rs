//! Flash and RAM of an image, from its ELF sections.

use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionKind, SymbolKind};

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
    /// Bytes of text and rodata that belong to Nordic's controller library; in other images this code
    /// is part of the SoftDevice.
    pub controller: u64,
}

impl Size {
    /// Bytes of flash.
    pub const fn flash(self) -> u64 {
        self.text + self.rodata + self.data
    }

    /// Bytes of flash without the controller library.
    pub const fn own_flash(self) -> u64 {
        self.flash() - self.controller
    }

    /// Bytes of static RAM; the rest is left for the stack.
    pub const fn ram(self) -> u64 {
        self.data + self.bss
    }

    fn add(&mut self, kind: SectionKind, bytes: u64) {
        match kind {
            SectionKind::Text => self.text += bytes,
            SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => self.rodata += bytes,
            SectionKind::Data => self.data += bytes,
            SectionKind::UninitializedData => self.bss += bytes,
            // Symbol names, debug information, log strings: not loaded.
            _ => {}
        }
    }
}

/// The library's internal symbols are renamed to `sym_` and a code.
fn is_of_the_controller(symbol: &str) -> bool {
    ["sym_", "sdc_", "mpsl_", "MPSL_"]
        .iter()
        .any(|start| symbol.starts_with(start))
}

/// Sums the sections of an ELF image.
pub fn measure(elf: &[u8]) -> Result<Size> {
    let file = object::File::parse(elf).context("not an ELF image")?;
    let mut size = Size::default();
    for section in file.sections() {
        size.add(section.kind(), section.size());
    }
    size.controller = file
        .symbols()
        .filter(|symbol| symbol.name().is_ok_and(is_of_the_controller))
        .filter(|symbol| symbol.kind() == SymbolKind::Text)
        .map(|symbol| symbol.size())
        .sum();
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_count_for_flash_or_ram_by_their_kind() {
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
                bss: 4,
                controller: 0,
            }
        );
        assert_eq!(size.flash(), 1230);
        assert_eq!(size.ram(), 34);
    }

    #[test]
    fn only_nordics_names_are_the_controllers() {
        assert!(is_of_the_controller("sym_ABC123"));
        assert!(is_of_the_controller("sdc_hci_get"));
        assert!(!is_of_the_controller("_RNvsym_"));
    }
}
