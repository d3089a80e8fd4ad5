//! A reader of the labels that can stop reading, as a terminal program that hangs.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::machine;
use crate::output::LINES;

/// Name of the file to which the reader writes what it has read.
pub const COPY: &str = "uart0.copy";

/// A thread between the machine and a file. It ends with the test program.
pub struct Reader {
    is_paused: Arc<AtomicBool>,
}

impl Reader {
    /// Puts a named pipe in the place of the labels' file, and copies what comes out of it.
    pub(super) fn start(folder: &Path) -> anyhow::Result<Self> {
        let mut pipe = machine::named_pipe(&folder.join(LINES))?;
        let mut copy = File::create(folder.join(COPY))?;
        let is_paused = Arc::new(AtomicBool::new(false));
        let paused = Arc::clone(&is_paused);
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            loop {
                while paused.load(Ordering::Relaxed) {
                    thread::sleep(Duration::from_millis(5));
                }
                let Ok(count) = pipe.read(&mut bytes) else {
                    return;
                };
                if copy.write_all(&bytes[..count]).is_err() {
                    return;
                }
            }
        });
        Ok(Self { is_paused })
    }

    /// Stops reading, or continues. The pipe holds 64 KiB before the machine notices.
    pub fn pause(&self, is_paused: bool) {
        self.is_paused.store(is_paused, Ordering::Relaxed);
    }
}
