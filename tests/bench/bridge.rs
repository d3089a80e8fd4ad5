//! The board's UART on a pseudo-terminal, which a program opens as a serial port.

use std::io::Read as _;
use std::os::fd::AsRawFd as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use serial2::SerialPort;

use super::Run;

/// The path of a terminal.
///
/// # Panics
/// Where `/proc` is not mounted.
pub fn terminal(slave: &SerialPort) -> PathBuf {
    let path = format!("/proc/self/fd/{}", slave.as_raw_fd());
    std::fs::read_link(path).expect("a link of the system")
}

/// A thread that carries bytes both ways, until it is dropped.
pub struct Bridge {
    run: Arc<Mutex<Run>>,
    port: PathBuf,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
    // A terminal that nobody has open loses what is written to it.
    _slave: SerialPort,
}

impl Bridge {
    /// Begins to carry, with what the board has written so far.
    pub fn start(run: Run) -> anyhow::Result<Self> {
        let (mut line, slave) = SerialPort::pair()?;
        line.set_read_timeout(Duration::from_millis(2))?;
        line.set_write_timeout(Duration::from_millis(20))?;
        let mut labels = std::fs::File::open(run.lines_file())?;
        let run = Arc::new(Mutex::new(run));
        let stop = Arc::new(AtomicBool::new(false));
        let thread = {
            let (run, stop) = (Arc::clone(&run), Arc::clone(&stop));
            std::thread::spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let mut bytes = Vec::new();
                    labels.read_to_end(&mut bytes)?;
                    // Nobody may be there to read.
                    let _ = line.write_all(&bytes);
                    let mut buffer = [0; 256];
                    if let Ok(length) = line.read(&mut buffer) {
                        lock(&run).send(&buffer[..length])?;
                    }
                }
                Ok(())
            })
        };
        Ok(Self {
            run,
            port: terminal(&slave),
            stop,
            thread: Some(thread),
            _slave: slave,
        })
    }

    pub fn port(&self) -> &Path {
        &self.port
    }

    /// The run; nothing is carried to the board while somebody has it.
    pub fn run(&self) -> MutexGuard<'_, Run> {
        lock(&self.run)
    }
}

fn lock(run: &Mutex<Run>) -> MutexGuard<'_, Run> {
    run.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Bridge {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
