//! The nRF52840 development kit: UART to the on-board debugger, labels on the free header pins.

use core::fmt;

use defmt_rtt as _;
use embassy_nrf::{
    bind_interrupts,
    gpio::{Level, Output, OutputDrive},
    peripherals::UARTE0,
    uarte::{self, Baudrate, Parity, UarteTx},
};
use shared::intent::MAX_CLASSES;

bind_interrupts!(struct Interrupts {
    UARTE0 => uarte::InterruptHandler<UARTE0>;
});

/// Everything that the program drives. Pins stay driven as long as it lives.
pub struct Board {
    /// The line to whoever acts on labels: 115200 8N1 on P0.06.
    pub uart: UartLine,
    /// One pin per intent in class order, P1.01 to P1.06, then `valid` on P1.07.
    _intents: [Output<'static>; MAX_CLASSES],
    _valid: Output<'static>,
}

impl Board {
    /// Takes the peripherals with every label pin low and `valid` low.
    pub fn start() -> Self {
        let p = embassy_nrf::init(embassy_nrf::config::Config::default());
        let drive = OutputDrive::Standard;
        let valid = Output::new(p.P1_07, Level::Low, drive);
        let intents = [
            Output::new(p.P1_01, Level::Low, drive),
            Output::new(p.P1_02, Level::Low, drive),
            Output::new(p.P1_03, Level::Low, drive),
            Output::new(p.P1_04, Level::Low, drive),
            Output::new(p.P1_05, Level::Low, drive),
            Output::new(p.P1_06, Level::Low, drive),
        ];
        let mut config = uarte::Config::default();
        config.baudrate = Baudrate::Baud115200;
        config.parity = Parity::Excluded;
        let uart = UartLine(UarteTx::new(p.UARTE0, Interrupts, p.P0_06, config));
        Self {
            uart,
            _intents: intents,
            _valid: valid,
        }
    }
}

/// The UART as a sink for formatted text.
pub struct UartLine(UarteTx<'static>);

impl fmt::Write for UartLine {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // Blocking: 115200 baud sends a line in under 5 ms, and nothing else runs yet.
        // It copies through RAM, for the peripheral's DMA does not reach constants in flash.
        self.0
            .blocking_write(text.as_bytes())
            .map_err(|_| fmt::Error)
    }
}
