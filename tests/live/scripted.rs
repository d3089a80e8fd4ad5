//! Board that answers each command as a test says.

use std::path::Path;
use std::sync::atomic::Ordering;

use shared::myo::Following;
use shared::uart_line::answer::{Answer, Binding, Identity};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;
use super::worker::Worker;

/// Board that runs until it is dropped.
pub struct Scripted {
    _worker: Worker,
}

impl Scripted {
    /// Starts a board whose terminal is at the path `link`; `lines` gives what it writes for a command.
    pub fn start(link: &Path, mut lines: impl FnMut(Command) -> String + Send + 'static) -> Self {
        let terminal = Terminal::new(link);
        let worker = Worker::start(move |stop| {
            let mut reader = CommandReader::default();
            let mut buffer = [0; 256];
            while !stop.load(Ordering::Relaxed) {
                let length = terminal.master.read(&mut buffer).unwrap_or(0);
                for &byte in &buffer[..length] {
                    if let Some(Ok(command)) = reader.push(byte) {
                        let _ = terminal.master.write_all(lines(command).as_bytes());
                    }
                }
            }
        });
        Self { _worker: worker }
    }
}

/// Answer to `IDENTIFY` of a board with this model.
pub fn identity(model: u32) -> Answer<'static> {
    Answer::Identity(Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "test",
        model: Some(model),
        armband: None,
        firmware: None,
        battery: None,
    })
}

/// Answer that names the armband a board follows.
pub fn binding(following: Following) -> Answer<'static> {
    Answer::Binding(Binding {
        following,
        is_kept: true,
    })
}
