//! Board that answers each command as a test says.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use shared::myo::Following;
use shared::uart_line::answer::{Answer, Binding, Identity};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;

/// Board that runs until it is dropped.
pub struct Scripted {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<usize>>,
}

impl Scripted {
    /// Starts a board whose terminal is at the path `link`; `lines` gives what it writes for a command.
    pub fn start(link: &Path, mut lines: impl FnMut(Command) -> String + Send + 'static) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let terminal = Terminal::new(link);
        let stopped = stop.clone();
        let thread = std::thread::spawn(move || {
            let mut reader = CommandReader::new();
            let mut buffer = [0; 256];
            let mut commands = 0;
            while !stopped.load(Ordering::Relaxed) {
                let length = terminal.master.read(&mut buffer).unwrap_or(0);
                for &byte in &buffer[..length] {
                    if let Some(Ok(command)) = reader.push(byte) {
                        commands += 1;
                        let _ = terminal.master.write_all(lines(command).as_bytes());
                    }
                }
            }
            commands
        });
        let thread = Some(thread);
        Self { stop, thread }
    }

    /// Ends the board; returns the number of commands that it was sent.
    pub fn end(mut self) -> usize {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Scripted {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
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
