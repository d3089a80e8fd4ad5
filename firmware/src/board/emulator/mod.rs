//! QEMU's `mps2-an386`: a Cortex-M4F with UARTs and without a radio.
//!
//! UART0 carries the labels out and the commands in, UART1 HCI, UART2 the pin levels: those of the outputs out, that of the
//! button in. Everything above this module is the program of the board, unchanged.

mod clock;
mod command_port;
mod dead_man;
mod executor;
mod flash;
mod hci;
mod irq;
mod registers;
mod stack;
mod straps;
mod uart;
mod vectors;
mod watchdog;

use core::fmt::{self, Write as _};

use bt_hci::controller::ExternalController;
use bt_hci_serial::SerialTransport;
use embassy_executor::Spawner;
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_time::Instant;

use super::{Board, levels::Levels};
use crate::installation;
use crate::messages::pin_state::PinState;
use crate::radio::{driver::SessionDriver, trouble};
use crate::reset_reason::{End, ResetReason, keep_end, previous_end};
use crate::settings::{DEAD_MAN_MS, WATCHDOG_MS};
pub use command_port::CommandPort;
pub use dead_man::DeadMan;
pub use executor::Executor;
use uart::{RX_ENABLE, Uart};
pub use watchdog::Watchdog;

/// A constant: the emulator has no factory-programmed address as a chip has.
const OWN_ADDRESS: [u8; 6] = [0x01, 0x02, 0x03, 0x04, 0x05, 0xc6];

/// HCI to a controller outside the emulator.
pub struct RadioParts {
    from: hci::FromController,
    to: hci::ToController,
}

/// Takes the peripherals; the pin levels are safe from here on.
pub fn start() -> Board {
    clock::start();
    let button = Button::start();
    let reset_reason = match previous_end() {
        End::Running => ResetReason::Watchdog,
        End::Panic => ResetReason::Software,
        End::StackOverflow => ResetReason::StackOverflow,
        End::Unknown => ResetReason::Power,
    };
    irq::start();
    let commands = CommandPort::start();
    let (from, to) = hci::start();
    Board {
        labels: LabelPort(()),
        commands,
        pins: Pins(()),
        button,
        radio: RadioParts { from, to },
        watchdog: Watchdog::start(WATCHDOG_MS),
        dead_man: DeadMan::start(DEAD_MAN_MS),
        reset_reason,
    }
}

/// Runs the Myo session forever.
pub async fn run_radio(_: Spawner, mut parts: RadioParts, driver: &SessionDriver<'_>) {
    installation::beside(flash::Memory, async |flash| {
        hci::synchronize(&mut parts.from, &mut parts.to).await;
        let transport = SerialTransport::<NoopRawMutex, _, _>::new(parts.from, parts.to);
        let controller: ExternalController<_, 10> = ExternalController::new(transport);
        trouble::run(controller, OWN_ADDRESS, driver, flash).await;
    })
    .await;
}

/// UART0.
pub struct LabelPort(());

impl LabelPort {
    /// Sends a line. Other tasks run while the reader outside takes none.
    pub async fn send(&mut self, line: &[u8]) {
        for &byte in line {
            while Uart::LABELS.is_full() {
                yield_now().await;
            }
            Uart::LABELS.send(&[byte]);
        }
        stack::report(Uart::PINS);
    }
}

/// UART2: a line whenever a level changes.
pub struct Pins(());

impl Pins {
    /// Writes the levels.
    pub fn set(&mut self, state: PinState) {
        // The dead-man timer interrupts everything but this.
        critical_section::with(|_| {
            let expired = dead_man::has_expired() && state.status.valid();
            let safe = PinState {
                status: PinState::SAFE.status,
                ..state
            };
            let levels = Levels {
                now_us: Instant::now().as_micros(),
                last_received_us: hci::last_byte().into(),
                state: if expired { safe } else { state },
            };
            let mut uart = Uart::PINS;
            // Writing to it never fails.
            let _ = write!(uart, "{levels}");
        });
    }
}

/// The level while the button is down, as of a pin that the button connects to ground.
const LOW: u8 = b'0';

/// The button: the emulated board has none that the outside could press, so UART2 receives the level of its pin.
pub struct Button {
    is_down: bool,
}

impl Button {
    /// Enables UART2. The button is up.
    pub fn start() -> Self {
        Uart::PINS.start(RX_ENABLE);
        Self { is_down: false }
    }

    /// Whether the button is down at this moment.
    pub fn is_down(&mut self) -> bool {
        if let Some(level) = Uart::PINS.receive() {
            self.is_down = level == LOW;
        }
        self.is_down
    }
}

/// Sets every output to its safe level and writes a message. Called with interrupts off.
pub fn enter_safe_state(message: &dyn fmt::Display, end: End) {
    Pins(()).set(PinState::SAFE);
    keep_end(end, message);
    let _ = write!(Comment(Uart::LABELS), "# {message}");
    Uart::LABELS.send(b"\r\n");
    // The panic handler runs on top of the stack of what panicked. After an overflow all of it was used.
    if end == End::Panic {
        stack::report(Uart::PINS);
    }
}

/// Replaces line ends by spaces: a comment is one line, and a panic's message has several.
struct Comment(Uart);

impl fmt::Write for Comment {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0.send(&[if byte == b'\n' { b' ' } else { byte }]);
        }
        Ok(())
    }
}
