//! A board on a pseudo-terminal, with a folder for its drive.

use std::fs;
use std::os::fd::AsRawFd as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use serial2::SerialPort;
use shared::myo::{Address, AddressKind, Following};
use shared::uart_line::answer::{Answer, Binding, Identity, Refusal};
use shared::uart_line::command::{BindCommand, Command, CommandReader, NOBODY_HEARD};
use shared::uf2::{MODEL_REGION, Uf2};
use tempfile::TempDir;

use super::XIAO;
use crate::board::ModelFile;
use crate::board::flash::Search;
use crate::board::flash::search::AGAIN;
use crate::board::port::TOUCH_BAUD;

pub(crate) const ARMBAND: Address = Address {
    kind: AddressKind::Public,
    bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
};

/// State of a board, and the armband that it hears.
#[derive(Clone, Copy)]
pub(crate) struct Kept {
    /// CRC-32 of the model in its flash before a file comes.
    pub(crate) model: Option<u32>,
    pub(crate) following: Following,
    /// Whom its pairing hears.
    pub(crate) hears: Option<Address>,
}

/// A new board beside an armband.
pub(crate) const NEW: Kept = Kept {
    model: None,
    following: Following::Nobody,
    hears: Some(ARMBAND),
};

/// A board with a boot loader: shows its drive when its port was opened at 1200 baud, and runs the file that comes.
pub(crate) struct Fake {
    folder: TempDir,
    /// End of the terminal that the board has, kept open.
    slave: Arc<SerialPort>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Fake {
    /// Starts a new board that says `runs` of its firmware once a file has come.
    pub(crate) fn start(runs: &'static str) -> Self {
        Self::with(runs, NEW)
    }

    /// Starts a board that has firmware already.
    pub(crate) fn with(runs: &'static str, kept: Kept) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (mut master, slave) = SerialPort::pair().unwrap();
        master.set_read_timeout(AGAIN / 10).unwrap();
        let (slave, stop) = (Arc::new(slave), Arc::new(AtomicBool::new(false)));
        let (drive, line, stopped) = (folder.path().to_owned(), slave.clone(), stop.clone());
        let thread = std::thread::spawn(move || {
            let mut reader = CommandReader::default();
            let mut bytes = [0; 64];
            let (mut is_running, mut was_touched) = (false, false);
            let Kept {
                mut model,
                mut following,
                hears,
            } = kept;
            while !stopped.load(Ordering::Relaxed) {
                let baud = line.get_configuration().unwrap().get_baud_rate().unwrap();
                let touched = baud == TOUCH_BAUD;
                if touched && !was_touched {
                    fs::write(drive.join("INFO_UF2.TXT"), XIAO).unwrap();
                }
                was_touched = touched;
                let file = fs::read(drive.join("FIRMWARE.UF2")).unwrap_or_default();
                if let Ok(file) = Uf2::parse(&file) {
                    let held = file.bytes(MODEL_REGION);
                    if !held.is_empty() {
                        model = Some(ModelFile::new(&held).unwrap().checksum());
                    }
                    is_running = true;
                    fs::remove_file(drive.join("INFO_UF2.TXT")).unwrap();
                    fs::remove_file(drive.join("FIRMWARE.UF2")).unwrap();
                }
                let length = master.read(&mut bytes).unwrap_or(0);
                for command in bytes[..length].iter().filter_map(|&byte| reader.push(byte)) {
                    let answer = match command {
                        Ok(Command::Identify) if is_running => Answer::Identity(Identity {
                            version: "0.1.0",
                            revision: "0123456789ab",
                            image: runs,
                            model,
                            armband: None,
                            firmware: None,
                            battery: None,
                        }),
                        Ok(Command::Bind(asked)) => {
                            let mut answered = following;
                            if asked == BindCommand::Begin {
                                answered = Following::Pairing;
                                following = hears.map_or(following, Following::Bound);
                                if hears.is_none() {
                                    master.write_all(NOBODY_HEARD.as_bytes()).unwrap();
                                }
                            }
                            Answer::Binding(Binding {
                                following: answered,
                                is_kept: true,
                            })
                        }
                        _ => Answer::Refused(Refusal::Unknown),
                    };
                    master.write_all(answer.to_string().as_bytes()).unwrap();
                }
            }
        });
        Self {
            folder,
            slave,
            stop,
            thread: Some(thread),
        }
    }

    pub(crate) fn search(&self) -> Search {
        let port = fs::read_link(format!("/proc/self/fd/{}", self.slave.as_raw_fd())).unwrap();
        Search {
            drive: Some(self.folder.path().to_owned()),
            port: Some(port),
            board: None,
            patience: Duration::from_secs(5),
        }
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}
