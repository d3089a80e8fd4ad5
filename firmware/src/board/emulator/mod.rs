//! QEMU's `mps2-an386`: a Cortex-M4F with UARTs to the outside and nothing of a radio.
//!
//! UART0 carries the labels, UART1 HCI, UART2 what the pins show. All else is the program of the
//! board, unchanged.

mod clock;
mod fault;
mod hci;
mod interrupts;
mod registers;
mod stack;
mod straps;
mod uart;
mod watchdog;

use core::{
    fmt::{self, Write as _},
    sync::atomic::{AtomicU32, Ordering},
};

use bt_hci::controller::ExternalController;
use bt_hci_serial::SerialTransport;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_time::Instant;
use shared::intent::Intent;

use super::{Board, Restart, Shown};
use crate::radio::{self, follow::Follower};
use crate::settings::WATCHDOG_MS;
use uart::Uart;
pub use watchdog::Watchdog;

/// What a restart leaves in memory that is not cleared.
#[expect(unsafe_code, reason = "only the linker can keep memory over a restart")]
#[unsafe(link_section = ".uninit.RESTART")]
static RESTART: AtomicU32 = AtomicU32::new(0);
/// Set while the program runs: whoever finds it was not told why it stopped.
const RUNNING: u32 = 0x5255_4e21;
/// Set by a panic.
const PANICKED: u32 = 0x5041_4e21;

/// The emulator has no number of its own to take one from.
const OWN_ADDRESS: [u8; 6] = [0x01, 0x02, 0x03, 0x04, 0x05, 0xc6];

/// HCI to a controller outside.
pub struct RadioParts {
    from: hci::FromController,
    to: hci::ToController,
}

/// Takes the peripherals with all outputs safe.
pub fn start() -> Board {
    clock::start();
    for uart in [Uart::LABELS, Uart::PINS] {
        uart.start(0);
    }
    let restart = match RESTART.swap(RUNNING, Ordering::Relaxed) {
        RUNNING => Restart::Watchdog,
        PANICKED => Restart::Software,
        _ => Restart::Power,
    };
    let (from, to) = hci::start();
    Board {
        labels: LabelPort(()),
        pins: Pins(()),
        radio: RadioParts { from, to },
        watchdog: Watchdog::start(WATCHDOG_MS),
        restart,
    }
}

/// Follows the armband for ever.
pub async fn run_radio(_: Spawner, mut parts: RadioParts, follower: &Follower<'_>) {
    hci::synchronize(&mut parts.from, &mut parts.to).await;
    let transport = SerialTransport::<NoopRawMutex, _, _>::new(parts.from, parts.to);
    let controller: ExternalController<_, 10> = ExternalController::new(transport);
    radio::trouble::run(controller, OWN_ADDRESS, follower).await;
}

/// UART0.
pub struct LabelPort(());

impl LabelPort {
    /// Sends a line.
    pub async fn send(&mut self, line: &[u8]) {
        Uart::LABELS.send(line);
        stack::report(Uart::PINS);
        fault::strike(line).await;
    }
}

/// UART2: a line whenever a level changes.
///
/// `PINS`, microseconds now, microseconds at the newest byte of HCI, then every level.
pub struct Pins(());

impl Pins {
    /// Shows it.
    pub fn show(&mut self, shown: Shown) {
        // Nobody reads of a failure, and the UART knows none.
        let _ = self.write(shown);
    }

    fn write(&self, shown: Shown) -> fmt::Result {
        let mut uart = Uart::PINS;
        let (now, heard) = (Instant::now().as_micros(), hci::last_byte());
        let valid = u8::from(shown.status.valid());
        write!(uart, "PINS {now} {heard} valid={valid}")?;
        for intent in Intent::ALL {
            let level = u8::from(intent == shown.status.label());
            write!(uart, " {}={level}", intent.name())?;
        }
        writeln!(uart, " armband={}", u8::from(shown.armband))
    }
}

/// Takes every output back and tells of a panic. Called with interrupts off.
pub fn last_words(message: &dyn fmt::Display) {
    Pins(()).show(Shown::SAFE);
    RESTART.store(PANICKED, Ordering::Relaxed);
    let _ = write!(Comment(Uart::LABELS), "# {message}");
    Uart::LABELS.send(b"\r\n");
    // A panic comes on top of whatever the stack held.
    stack::report(Uart::PINS);
}

/// A comment is one line, and a panic's message is several.
struct Comment(Uart);

impl fmt::Write for Comment {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0.send(&[if byte == b'\n' { b' ' } else { byte }]);
        }
        Ok(())
    }
}
