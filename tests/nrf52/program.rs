//! Small programs for the emulated chip, in Thumb instructions.

use nrf52::chip::ChipModel;
use nrf52::softdevice::{SoftDevice, SoftDeviceKind};
use nrf52::{Image, Machine};

/// A program that is being written.
#[derive(Default)]
pub struct Program {
    code: Vec<u16>,
}

/// Offset of the program's own words from its start, in bytes. Its instructions end before.
const WORDS: u32 = 0x400;
/// A clock configuration for a SoftDevice: the crystal, 20 ppm.
const CLOCK: u32 = 0x0700_0001;

impl Program {
    /// Loads a constant: `movw`, `movt`.
    pub fn load(mut self, register: u16, value: u32) -> Self {
        for (half, base) in [(value as u16, 0xf240), ((value >> 16) as u16, 0xf2c0)] {
            let (imm4, i) = (half >> 12, half >> 11 & 1);
            let (imm3, imm8) = (half >> 8 & 7, half & 0xff);
            self.code.push(base | i << 10 | imm4);
            self.code.push(imm3 << 12 | register << 8 | imm8);
        }
        self
    }

    /// Writes a word to an address.
    pub fn store(self, address: u32, value: u32) -> Self {
        self.load(0, address).load(1, value).then(&[0x6001])
    }

    /// Writes a byte to an address.
    pub fn store_byte(self, address: u32, value: u32) -> Self {
        self.load(0, address).load(1, value).then(&[0x7001])
    }

    /// Reads a word from an address.
    pub fn read(self, address: u32) -> Self {
        self.load(0, address).then(&[0x6802])
    }

    /// Calls the SoftDevice.
    pub fn call(self, number: u16, arguments: [u32; 3]) -> Self {
        let [a, b, c] = arguments;
        self.load(0, a)
            .load(1, b)
            .load(2, c)
            .then(&[0xdf00 | number])
    }

    /// Enables the SoftDevice.
    pub fn enable(self, kind: SoftDeviceKind) -> Self {
        self.call(16, [kind.program() + WORDS, 0x1, 0])
    }

    /// Other instructions.
    pub fn then(mut self, code: &[u16]) -> Self {
        self.code.extend(code);
        self
    }

    /// The chip that runs it: it ends in a loop, and so does every exception.
    pub fn machine(self, model: ChipModel, kind: Option<SoftDeviceKind>) -> Machine {
        let start = kind.map_or(0, SoftDeviceKind::program);
        let mut image = Vec::new();
        let mut word = |value: u32| image.extend(value.to_le_bytes());
        word(0x2000_8000);
        word(start + 0x101);
        // An exception that is not meant ends in the loop at 0x200.
        (2..64).for_each(|_| word(start + 0x201));
        // b to itself.
        let code = self.code.into_iter().chain([0xe7fe]);
        image.extend(code.flat_map(u16::to_le_bytes));
        assert!(image.len() <= 0x200, "the program is too long");
        image.resize(0x200, 0);
        image.extend(0xe7fe_u16.to_le_bytes());
        image.resize(WORDS as usize, 0xff);
        image.extend(CLOCK.to_le_bytes());
        let image = Image::raw(start, image);
        let softdevice = kind.map(SoftDevice::new);
        Machine::new(model, image, softdevice, 1)
    }
}
