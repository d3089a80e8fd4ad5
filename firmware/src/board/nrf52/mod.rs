//! The nRF52840 and the nRF52832, on Nordic's development kits.

#[cfg(feature = "radio-trouble")]
mod controller;
#[cfg(feature = "radio-softdevice")]
mod softdevice;
mod wiring;

use core::{cell::RefCell, fmt};

use critical_section::Mutex;
use defmt_rtt as _;
use embassy_nrf::{
    bind_interrupts,
    gpio::{Level, Output},
    interrupt::{self, InterruptExt as _, Priority},
    pac,
    peripherals::{self, UARTE0},
    uarte::{self, Baudrate, Parity, UarteTx},
    wdt,
};
use shared::intent::{Intent, MAX_CLASSES};

use super::{Board, Restart, Shown};
use crate::settings::WATCHDOG_MS;
#[cfg(feature = "radio-trouble")]
pub use controller::{RadioParts, run_radio};
#[cfg(feature = "radio-softdevice")]
pub use softdevice::{RadioParts, run_radio};

bind_interrupts!(struct Interrupts {
    UARTE0 => uarte::InterruptHandler<UARTE0>;
});

/// Bits of RESETREAS (nRF52840 product specification, section 5.3.7.9).
const RESET_BY_WATCHDOG: u32 = 1 << 1;
const RESET_BY_SOFTWARE: u32 = 1 << 2;

/// Takes the peripherals with all outputs safe.
pub fn start() -> Board {
    let mut config = embassy_nrf::config::Config::default();
    // The SoftDevices keep the priorities 0, 1 and 4 to themselves, and refuse to start where an
    // interrupt of the program has one of them.
    config.gpiote_interrupt_priority = Priority::P2;
    config.time_interrupt_priority = Priority::P2;
    interrupt::UARTE0.set_priority(Priority::P3);
    let peripherals = embassy_nrf::init(config);
    let wiring = wiring::wire(peripherals);
    let lines = Lines {
        intents: wiring.intents,
        valid: wiring.valid,
        valid_led: wiring.valid_led,
        armband_led: wiring.armband_led,
    };
    critical_section::with(|section| LINES.borrow(section).replace(Some(lines)));

    let mut config = uarte::Config::default();
    config.baudrate = Baudrate::Baud115200;
    config.parity = Parity::Excluded;
    let labels = LabelPort(UarteTx::new(
        wiring.uart,
        Interrupts,
        wiring.uart_tx,
        config,
    ));
    Board {
        labels,
        pins: Pins(()),
        radio: wiring.radio,
        watchdog: Watchdog::start(wiring.watchdog),
        restart: restart(),
    }
}

/// Must be read before a SoftDevice runs: the register is its own from then on.
fn restart() -> Restart {
    let reasons = pac::POWER.resetreas().read();
    // Bits stay set over restarts until a one is written to them.
    pac::POWER.resetreas().write_value(reasons);
    match reasons.0 {
        bits if bits & RESET_BY_WATCHDOG != 0 => Restart::Watchdog,
        bits if bits & RESET_BY_SOFTWARE != 0 => Restart::Software,
        _ => Restart::Power,
    }
}

/// The UART.
pub struct LabelPort(UarteTx<'static>);

impl LabelPort {
    /// Sends a line; 115200 baud take 9 ms for the longest.
    pub async fn send(&mut self, line: &[u8]) {
        if self.0.write(line).await.is_err() {
            defmt::error!("the UART refused a line");
        }
    }
}

/// Every output. Kept where a panic finds it.
static LINES: Mutex<RefCell<Option<Lines>>> = Mutex::new(RefCell::new(None));

struct Lines {
    intents: [Output<'static>; MAX_CLASSES],
    valid: Output<'static>,
    valid_led: Output<'static>,
    armband_led: Output<'static>,
}

/// Label pins and LEDs.
pub struct Pins(());

impl Pins {
    /// Shows it, all levels within a few microseconds. What is not valid is taken back first, what
    /// is valid is shown last.
    pub fn show(&mut self, shown: Shown) {
        show(shown);
    }
}

fn show(shown: Shown) {
    critical_section::with(|section| {
        let Ok(mut lines) = LINES.borrow(section).try_borrow_mut() else {
            return;
        };
        let Some(lines) = lines.as_mut() else {
            return;
        };
        let valid = shown.status.valid();
        if !valid {
            lines.valid.set_low();
        }
        for (intent, line) in Intent::ALL.into_iter().zip(&mut lines.intents) {
            line.set_level(Level::from(intent == shown.status.label()));
        }
        if valid {
            lines.valid.set_high();
        }
        lines.valid_led.set_level(led(valid));
        lines.armband_led.set_level(led(shown.armband));
    });
}

fn led(on: bool) -> Level {
    if on { wiring::LED_ON } else { wiring::LED_OFF }
}

/// The watchdog. It goes on through restarts of the program until power is lost.
pub struct Watchdog(Option<wdt::WatchdogHandle>);

impl Watchdog {
    fn start(peripheral: embassy_nrf::Peri<'static, peripherals::WDT>) -> Self {
        // One that runs already, a boot loader's say, cannot be changed: take it over.
        let config = wdt::Config::try_new(&peripheral).unwrap_or_else(|| {
            let mut config = wdt::Config::default();
            config.timeout_ticks = WATCHDOG_MS * 32_768 / 1000;
            // A debugger that halts the core must not lose what it looks at.
            config.action_during_debug_halt = wdt::HaltConfig::Pause;
            config
        });
        let handle = wdt::Watchdog::try_new(peripheral, config);
        let handle = handle.ok().map(|(_, [handle])| handle);
        if handle.is_none() {
            defmt::warn!("the watchdog runs with more handles than one and is not fed");
        }
        Self(handle)
    }

    /// Begins the period anew.
    pub fn feed(&mut self) {
        if let Some(handle) = &mut self.0 {
            handle.pet();
        }
    }
}

/// Takes every output back and tells of a panic. Called with interrupts off.
pub fn last_words(message: &dyn fmt::Display) {
    show(Shown::SAFE);
    defmt::error!("{}", defmt::Display2Format(message));
    // Time for a debug probe to read the message before memory starts anew.
    cortex_m::asm::delay(3_200_000);
}
