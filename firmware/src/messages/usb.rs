//! Lines on their way to a USB host, beside the UART. Nothing waits for the host: what it does not take in time is dropped
//! and counted.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};

/// Bytes that wait for the host: 180 ms of the fullest UART.
const BYTES: usize = 2048;
/// Baud rate at which a port that is closed asks for the boot loader, by Arduino's convention.
const TOUCH: u32 = 1200;

/// States of the host's port.
mod host {
    /// It was not opened yet. The first lines of a start wait for it; some programs never say that they open it.
    pub const UNKNOWN: u8 = 0;
    pub const OPEN: u8 = 1;
    pub const CLOSED: u8 = 2;
}

#[cfg(feature = "uf2")]
pub static LINES: Lines = Lines::new();

/// Bytes of whole lines, in order.
pub struct Lines {
    bytes: Pipe<CriticalSectionRawMutex, BYTES>,
    host: AtomicU8,
    dropped: AtomicU32,
}

impl Lines {
    const fn new() -> Self {
        Self {
            bytes: Pipe::new(),
            host: AtomicU8::new(host::UNKNOWN),
            dropped: AtomicU32::new(0),
        }
    }

    /// Adds a line, unless the port is closed. One without room is dropped whole, and counted if the port is open.
    pub fn push(&self, line: &[u8]) {
        let host = self.host.load(Ordering::Relaxed);
        if host == host::CLOSED {
            return;
        }
        if self.bytes.free_capacity() < line.len() {
            let lost = u32::from(host == host::OPEN);
            self.dropped.fetch_add(lost, Ordering::Relaxed);
            return;
        }
        let mut rest = line;
        // Once more where the ring ends.
        while let Ok(count) = self.bytes.try_write(rest) {
            rest = rest.get(count..).unwrap_or_default();
            if rest.is_empty() {
                break;
            }
        }
    }

    /// Waits for bytes and takes some; returns their number.
    pub async fn take(&self, packet: &mut [u8]) -> usize {
        self.bytes.read(packet).await
    }

    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Lines that an open port did not take in time, since the start; wraps.
    pub fn dropped(&self) -> u32 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Takes over whether there is a host. Without one no line waits: a driver that is switched off must not be given any.
    pub fn set_plugged(&self, is_plugged: bool) {
        if is_plugged {
            self.host.store(host::UNKNOWN, Ordering::Relaxed);
        } else {
            self.close();
        }
    }

    /// Takes over what the host says of its port: its DTR and its baud rate. Returns true if it asks for the boot loader.
    pub fn set_port(&self, is_open: bool, baud: u32) -> bool {
        if is_open {
            self.host.store(host::OPEN, Ordering::Relaxed);
            return false;
        }
        // A host says that it is closed before it was open, too, when it finds the board.
        let closes = self.host.load(Ordering::Relaxed) == host::OPEN;
        if closes {
            self.close();
        }
        closes && baud == TOUCH
    }

    /// Closes the port. A program that opens it next would take waiting lines for new ones.
    fn close(&self) {
        self.host.store(host::CLOSED, Ordering::Relaxed);
        self.bytes.clear();
    }
}

#[cfg(test)]
mod tests {
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};

    use super::*;

    const LINE: &[u8] = b"$LABEL,2,609,660,close,1,-,0,0,0*0D\r\n";

    /// All that waits.
    fn taken(lines: &Lines) -> Vec<u8> {
        let mut all = Vec::new();
        let mut packet = [0; 64];
        while !lines.is_empty() {
            let taken = pin!(lines.take(&mut packet)).poll(&mut Context::from_waker(Waker::noop()));
            let Poll::Ready(count) = taken else {
                panic!("there are bytes");
            };
            all.extend_from_slice(&packet[..count]);
        }
        all
    }

    #[test]
    fn a_host_that_takes_nothing_costs_whole_lines_and_nothing_else() {
        let lines = Lines::new();
        lines.set_port(true, 115_200);
        for _ in 0..100 {
            lines.push(LINE);
        }
        let fit = BYTES / LINE.len();
        assert_eq!(lines.dropped() as usize, 100 - fit);
        assert_eq!(taken(&lines), LINE.repeat(fit));
        // Over the end of the ring too.
        for _ in 0..100 {
            lines.push(LINE);
            assert_eq!(taken(&lines), LINE);
        }
    }

    #[test]
    fn the_first_lines_of_a_start_wait_for_a_host_and_the_others_are_nobodys() {
        let lines = Lines::new();
        lines.push(b"# myointent\r\n");
        // Found, and not opened yet.
        assert!(!lines.set_port(false, 1200));
        for _ in 0..100 {
            lines.push(LINE);
        }
        assert_eq!(lines.dropped(), 0);
        assert!(!lines.set_port(true, 115_200));
        assert!(taken(&lines).starts_with(b"# myointent\r\n"));
    }

    #[test]
    fn a_port_that_is_opened_again_begins_with_new_lines() {
        let lines = Lines::new();
        lines.set_port(true, 115_200);
        lines.push(b"# old\r\n");
        lines.set_port(false, 115_200);
        lines.push(b"# unheard\r\n");
        lines.set_port(true, 115_200);
        lines.push(b"# new\r\n");
        assert_eq!(taken(&lines), b"# new\r\n");
        assert_eq!(lines.dropped(), 0);
    }

    #[test]
    fn nothing_waits_for_a_host_that_is_unplugged_and_the_next_one_hears_new_lines() {
        let lines = Lines::new();
        // Neither of a PC that opened its port, nor of one that never did.
        for is_open in [true, false] {
            lines.set_plugged(true);
            if is_open {
                lines.set_port(true, 115_200);
            }
            lines.push(b"# old\r\n");
            lines.set_plugged(false);
            lines.push(b"# unheard\r\n");
            assert!(lines.is_empty());
            lines.set_plugged(true);
            lines.push(b"# new\r\n");
            assert_eq!(taken(&lines), b"# new\r\n");
        }
    }

    #[test]
    fn a_port_that_is_closed_at_1200_baud_asks_for_the_boot_loader() {
        let lines = Lines::new();
        assert!(!lines.set_port(true, 1200));
        assert!(lines.set_port(false, 1200));
        // Once.
        assert!(!lines.set_port(false, 1200));
        assert!(!lines.set_port(true, 9600));
        assert!(!lines.set_port(false, 9600));
    }
}
