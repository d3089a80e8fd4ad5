//! An image: what of its ELF file is flashed, and the names in it.

use std::ops::Range;

use crate::controller::Library;
use object::read::elf::ProgramHeader as _;
use object::{Object as _, ObjectSymbol as _, SymbolKind};

#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    #[error("the image is no ELF file: build it with `cargo xtask images`")]
    NotElf(#[from] object::Error),
    #[error("the image has nothing to flash: expected a segment below 0x100000")]
    Empty,
}

#[derive(Clone, Debug)]
pub struct Image {
    /// Segments that are flashed: addresses and bytes.
    pub segments: Vec<(u32, Vec<u8>)>,
    /// Functions by address: start, size, name.
    functions: Vec<(u32, u32, String)>,
}

impl Image {
    pub fn parse(elf: &[u8]) -> Result<Self, ImageError> {
        let file = object::read::elf::ElfFile32::<object::Endianness>::parse(elf)?;
        let mut segments = Vec::new();
        for segment in file.elf_program_headers() {
            let endian = file.endian();
            let bytes = segment.data(endian, elf).unwrap_or_default();
            if segment.p_type(endian) == object::elf::PT_LOAD && !bytes.is_empty() {
                // Where it is stored, not where it is copied to at the start.
                segments.push((segment.p_paddr(endian), bytes.to_vec()));
            }
        }
        if segments.is_empty() {
            return Err(ImageError::Empty);
        }
        let mut functions = Vec::new();
        for symbol in file.symbols() {
            let (Ok(name), address) = (symbol.name(), symbol.address() as u32) else {
                continue;
            };
            if symbol.kind() == SymbolKind::Text {
                functions.push((address & !1, symbol.size() as u32, name.to_owned()));
            }
        }
        functions.sort();
        Ok(Self {
            segments,
            functions,
        })
    }

    /// Returns the addresses of each function whose name has all of these parts.
    pub fn functions(&self, parts: &[&str]) -> Vec<Range<u32>> {
        let all = self.functions.iter();
        let named = all.filter(|(_, _, name)| parts.iter().all(|part| name.contains(part)));
        named.map(|(start, size, _)| *start..start + size).collect()
    }

    /// Nordic's controller library in it, if it has one.
    ///
    /// # Panics
    /// If another function lies amid it.
    pub fn library(&self) -> Option<Library> {
        Library::find(&self.functions)
    }

    /// Bytes at an address, without names.
    pub fn raw(address: u32, bytes: Vec<u8>) -> Self {
        Self {
            segments: vec![(address, bytes)],
            functions: Vec::new(),
        }
    }

    /// Returns the address at which it begins, 0 if it is empty.
    pub fn start(&self) -> u32 {
        let addresses = self.segments.iter().map(|(address, _)| *address);
        addresses.min().unwrap_or_default()
    }

    /// The function at an address, and how far into it.
    pub fn place(&self, address: u32) -> String {
        let after = self
            .functions
            .partition_point(|(start, ..)| *start <= address);
        let function = after
            .checked_sub(1)
            .and_then(|before| self.functions.get(before));
        match function {
            Some((start, size, name)) if address < start + (*size).max(2) => {
                format!("{name}+{:#x} ({address:#010x})", address - start)
            }
            _ => format!("{address:#010x}"),
        }
    }
}
