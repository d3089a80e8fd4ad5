//! Opening of a board's serial port, so that the board counts it as open.
//!
//! A board with USB takes a port without DTR for closed: it sends nothing there, and no request for its boot loader counts.
//! Linux and macOS raise DTR as a port is opened; Windows lowers it with the settings, which are made with each change of the
//! baud rate. So DTR is raised behind the settings, and these are made once.

use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::Duration;

use serial2::SerialPort;

const BAUD: u32 = 115_200;
/// Baud rate at which a port that is closed starts the board's boot loader, by Arduino's convention.
pub(super) const TOUCH_BAUD: u32 = 1200;
/// Time in which the board sees that its port was opened, before it is closed.
const SEEN: Duration = Duration::from_millis(100);

/// Part of a serial port that the system is asked for; a recorder in tests.
trait Modem: Sized {
    /// Opens a port and makes its settings: raw, at a baud rate.
    fn open(path: &Path, baud: u32) -> io::Result<Self>;

    fn set_dtr(&self, is_raised: bool) -> io::Result<()>;
}

impl Modem for SerialPort {
    fn open(path: &Path, baud: u32) -> io::Result<Self> {
        Self::open(path, baud)
    }

    fn set_dtr(&self, is_raised: bool) -> io::Result<()> {
        self.set_dtr(is_raised)
    }
}

/// Opens a serial port without the bytes that arrived before, which are out of date.
pub(crate) fn open(path: &Path, read: Duration, write: Duration) -> io::Result<SerialPort> {
    let mut port: SerialPort = raised(path, BAUD)?;
    port.set_read_timeout(read)?;
    port.set_write_timeout(write)?;
    port.discard_input_buffer()?;
    Ok(port)
}

/// Starts the boot loader of the board on a port.
pub(super) fn touch(path: &Path) -> io::Result<()> {
    touched::<SerialPort>(path, SEEN)
}

fn raised<P: Modem>(path: &Path, baud: u32) -> io::Result<P> {
    let port = P::open(path, baud)?;
    // Pseudo-terminals and some adapters have no DTR, and need none.
    let _ = port.set_dtr(true);
    Ok(port)
}

fn touched<P: Modem>(path: &Path, seen: Duration) -> io::Result<()> {
    let port: P = raised(path, TOUCH_BAUD)?;
    std::thread::sleep(seen);
    // Where there is no DTR, closing the port does the same.
    let _ = port.set_dtr(false);
    Ok(())
}

/// Whether an error of a read only means that no byte came in time.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    enum Call {
        Open,
        Settings(u32),
        Dtr(bool),
        Close,
    }

    thread_local! {
        static CALLS: RefCell<Vec<Call>> = const { RefCell::new(Vec::new()) };
    }

    fn record(call: Call) {
        CALLS.with_borrow_mut(|calls| calls.push(call));
    }

    /// Port of Windows that records what it is asked for.
    struct Recorder;

    impl Modem for Recorder {
        fn open(_: &Path, baud: u32) -> io::Result<Self> {
            record(Call::Open);
            record(Call::Settings(baud));
            Ok(Self)
        }

        fn set_dtr(&self, is_raised: bool) -> io::Result<()> {
            record(Call::Dtr(is_raised));
            Ok(())
        }
    }

    impl Drop for Recorder {
        fn drop(&mut self) {
            record(Call::Close);
        }
    }

    #[test]
    fn dtr_is_raised_behind_the_settings_and_lowered_to_start_the_boot_loader() {
        let path = Path::new("COM3");
        let port: Recorder = raised(path, BAUD).unwrap();
        let opened = [Call::Open, Call::Settings(BAUD), Call::Dtr(true)];
        assert_eq!(CALLS.take(), opened);
        drop(port);
        CALLS.take();
        touched::<Recorder>(path, Duration::ZERO).unwrap();
        let touched = [Call::Dtr(true), Call::Dtr(false), Call::Close];
        assert_eq!(
            CALLS.take()[1..],
            [&[Call::Settings(TOUCH_BAUD)][..], &touched].concat()
        );
    }
}
