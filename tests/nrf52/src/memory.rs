//! Flash and RAM, as DMA, the SoftDevice and a test see them. The core reaches them by its address space.

use std::ops::Range;
use std::sync::Arc;

use rsemu::core::space::RamStore;

use crate::refusal::{What, needs, wrong};

pub const RAM: u32 = 0x2000_0000;
pub const ERASED: u8 = 0xff;

#[derive(Clone, Debug)]
pub struct Memory {
    /// Flash, from address 0 on.
    pub flash: Arc<RamStore>,
    /// RAM, from [`RAM`] on.
    pub ram: Arc<RamStore>,
}

impl Memory {
    /// Erased flash, and RAM that holds anything.
    pub fn new(flash_bytes: u32, ram_bytes: u32, garbage: u64) -> Self {
        let memory = Self {
            flash: Arc::new(RamStore::new(flash_bytes.into())),
            ram: Arc::new(RamStore::new(ram_bytes.into())),
        };
        memory.erase(0, flash_bytes as usize);
        memory.lose_power(garbage);
        memory
    }

    /// Fills RAM with anything: a program that reads what it has not written shows itself.
    pub fn lose_power(&self, garbage: u64) {
        // The chips have 256 KiB at most.
        self.scramble(RAM..RAM + self.ram.len() as u32, garbage);
    }

    /// Fills a part of RAM with anything, by xorshift.
    pub fn scramble(&self, part: Range<u32>, garbage: u64) {
        let mut state = garbage | 1;
        let bytes = part.clone().map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 32) as u8
        });
        let bytes: Vec<u8> = bytes.collect();
        // A part outside stays as it is.
        let _ = self.write(part.start, &bytes);
    }

    pub fn is_ram(&self, address: u32, length: u32) -> bool {
        let end = u64::from(address) + u64::from(length);
        address >= RAM && end <= u64::from(RAM) + self.ram.len()
    }

    /// Bytes of flash or RAM; none where there is neither.
    pub fn read(&self, address: u32, length: u32) -> Option<Vec<u8>> {
        let mut bytes = vec![0; length as usize];
        let read = if self.is_ram(address, length) {
            self.ram.read_at((address - RAM).into(), &mut bytes)
        } else {
            self.flash.read_at(address.into(), &mut bytes)
        };
        read.is_ok().then_some(bytes)
    }

    /// A word of flash or RAM; none where there is neither.
    pub fn word(&self, address: u32) -> Option<u32> {
        let bytes = self.read(address, 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    /// A half word of flash or RAM; none where there is neither.
    pub fn half(&self, address: u32) -> Option<u16> {
        let bytes = self.read(address, 2)?;
        Some(u16::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Writes to RAM; whether it is RAM.
    pub fn write(&self, address: u32, bytes: &[u8]) -> bool {
        let is_ram = u32::try_from(bytes.len()).is_ok_and(|length| self.is_ram(address, length));
        is_ram && self.ram.write_at((address - RAM).into(), bytes).is_ok()
    }

    /// Puts an image or a file into flash, as a programmer does.
    ///
    /// # Panics
    /// If flash ends before.
    pub fn program(&self, address: u32, bytes: &[u8]) {
        let written = self.flash.write_at(address.into(), bytes);
        assert!(
            written.is_ok(),
            "flash ends before {address:#x} + {}",
            bytes.len()
        );
    }

    /// Writes to flash as the chip does: bits become 0, never 1.
    pub fn clear_bits(&self, address: u32, bytes: &[u8]) {
        let mut old = vec![0; bytes.len()];
        if self.flash.read_at(address.into(), &mut old).is_ok() {
            for (old, new) in old.iter_mut().zip(bytes) {
                *old &= new;
            }
            let _ = self.flash.write_at(address.into(), &old);
        }
    }

    /// Erases bytes of flash from an address on.
    pub fn erase(&self, address: u32, bytes: usize) {
        let erased = vec![ERASED; bytes];
        let _ = self.flash.write_at(address.into(), &erased);
    }
}

/// Writes what a call gives.
pub fn give(memory: &Memory, address: u32, bytes: &[u8]) -> Result<(), What> {
    let otherwise = format!("that is to write to {address:#010x}, which is no RAM");
    needs(memory.write(address, bytes), &otherwise)
}

/// Reads what a call is given.
pub fn take(memory: &Memory, address: u32, length: u32) -> Result<Vec<u8>, What> {
    let bytes = memory.read(address, length);
    bytes.ok_or_else(|| wrong(&format!("with {address:#010x}, which is no memory")))
}

/// Half words of what a call is given, from a place on.
pub fn halves<const N: usize>(bytes: &[u8], from: usize) -> [u16; N] {
    let half = |number: usize| {
        let at = from + 2 * number;
        let both = bytes.get(at..at + 2).and_then(|two| two.try_into().ok());
        both.map_or(0, u16::from_le_bytes)
    };
    std::array::from_fn(half)
}
