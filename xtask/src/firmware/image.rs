//! The images: one per supported pair of board and radio.

use std::fmt;

shared::names! {
    /// A program for one board with one radio.
    pub enum Image {
        /// nRF52840 under the SoftDevice S140.
        Nrf52840S140 = "nrf52840-s140",
        /// nRF52840 with the Bluetooth controller linked in.
        Nrf52840Sdc = "nrf52840-sdc",
        /// Seeed's XIAO nRF52840; this and the next two without a SoftDevice, behind a boot loader for UF2 files.
        Xiao = "xiao",
        /// Adafruit's Feather nRF52840 Express.
        Feather = "feather",
        /// nice!nano 2.
        NiceNano = "nice-nano",
        /// nRF52832 under the SoftDevice S132.
        Nrf52832S132 = "nrf52832-s132",
    }
}

impl Image {
    /// Images of boards with USB and a boot loader for UF2 files.
    pub const UF2: [Self; 3] = [Self::Xiao, Self::Feather, Self::NiceNano];

    /// Returns true if the Bluetooth controller is linked into it.
    pub fn has_controller(self) -> bool {
        self == Self::Nrf52840Sdc || Self::UF2.contains(&self)
    }

    /// The features of the firmware that select it.
    pub(super) const fn features(self) -> &'static str {
        match self {
            Self::Nrf52840S140 => "nrf52840,radio-softdevice",
            Self::Nrf52840Sdc => "nrf52840,radio-trouble",
            Self::Xiao => "xiao",
            Self::Feather => "feather",
            Self::NiceNano => "nice-nano",
            Self::Nrf52832S132 => "nrf52832,radio-softdevice",
        }
    }

    /// Interrupts that must have a handler, by number: UART, time, GPIO and the radio's.
    pub(super) const fn interrupts(self) -> &'static [usize] {
        match self {
            // UARTE0, GPIOTE, RTC1, SWI2.
            Self::Nrf52840S140 | Self::Nrf52832S132 => &[2, 6, 17, 22],
            // CLOCK and POWER, RADIO, UARTE0, GPIOTE, TIMER0, RTC0, RTC1, SWI0.
            Self::Nrf52840Sdc => &[0, 1, 2, 6, 8, 11, 17, 20],
            // And SAADC, USBD.
            Self::Xiao | Self::Feather | Self::NiceNano => &[0, 1, 2, 6, 7, 8, 11, 17, 20, 39],
        }
    }

    /// Bytes of stack that a SoftDevice's interrupts take (its specification: 1.5 KiB); in other images the controller's
    /// handlers are functions of the image.
    pub(super) const fn softdevice_stack(self) -> u64 {
        match self {
            Self::Nrf52840S140 | Self::Nrf52832S132 => 1536,
            _ => 0,
        }
    }

    /// Most bytes of flash for code and constants, a linked-in controller included, a SoftDevice and the model excluded.
    pub(super) const fn flash_budget(self) -> u64 {
        match self {
            Self::Nrf52840S140 | Self::Nrf52832S132 => 160 * 1024,
            Self::Nrf52840Sdc => 340 * 1024,
            // From 0x1000.
            Self::Xiao | Self::Feather | Self::NiceNano => 336 * 1024,
        }
    }

    /// Most bytes of static RAM, the SoftDevice's own and the stack excluded.
    pub(super) const fn ram_budget(self) -> u64 {
        match self {
            Self::Nrf52832S132 => 48 * 1024,
            // With memory for a calibration.
            _ => 72 * 1024,
        }
    }

    /// Bytes of RAM that `memory.x` gives it.
    pub(super) const fn ram(self) -> u64 {
        match self {
            Self::Nrf52840S140 => (256 - 16) * 1024,
            Self::Nrf52840Sdc => 256 * 1024,
            Self::Xiao | Self::Feather | Self::NiceNano => 256 * 1024 - 8,
            Self::Nrf52832S132 => (64 - 16) * 1024,
        }
    }
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
