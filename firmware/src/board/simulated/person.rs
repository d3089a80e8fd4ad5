//! The person beside the board: presses its button, sends bytes to its UART.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use shared::installation::{Block, InstallationProgress, Transfer};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;
use virtual_armband::{Act, Acts, framed};

/// Microseconds from the end of an answer to the next command: a PC's USB.
const TURNAROUND_US: u64 = 1000;
/// Microseconds without an answer after which the PC begins anew.
const PATIENCE_US: u64 = 2_000_000;
/// Microseconds for which the line is pulled.
const PULLED_US: u64 = 1_000_000;
/// Bytes of a block's line after which it is pulled.
const PULLED_BYTE: usize = 40;

/// Answers of the board to an installation.
static HEARD: Mutex<VecDeque<Result<InstallationProgress, Refusal>>> = Mutex::new(VecDeque::new());

/// The board has sent a line.
pub fn hear(line: &[u8]) {
    let answer = match Answer::parse(line) {
        Ok(Answer::Install(progress)) => Ok(progress),
        Ok(Answer::Refused(refusal)) => Err(refusal),
        _ => return,
    };
    HEARD.lock().expect("nobody panics here").push_back(answer);
}

/// Microseconds of a byte at 115200 baud, ten bits.
pub const BYTE_US: u64 = 87;

/// Received bytes: as many as the receiver of a chip buffers.
pub static RECEIVED: Pipe<CriticalSectionRawMutex, 128> = Pipe::new();
/// Bytes came while it was full.
pub static OVERRUN: AtomicBool = AtomicBool::new(false);
/// Whether the button is down.
pub static IS_DOWN: AtomicBool = AtomicBool::new(false);

/// Carries out what the scenario asks for.
pub struct ScenarioPerson {
    acts: Acts,
    sending: VecDeque<u8>,
    next_byte_us: u64,
    released_us: u64,
    file: Vec<u8>,
    sender: Option<Sender>,
}

struct Sender {
    /// Time at which the next command is sent, or the last one is given up.
    due_us: u64,
    /// Next command; none while an answer is awaited.
    next: Option<Command>,
    /// Number of blocks after which the line is pulled.
    pulled_after: Option<u32>,
    /// Time until which nothing from the board is heard.
    pulled_until_us: u64,
}

impl ScenarioPerson {
    /// A person whose acts before notification `next` are done already.
    pub fn new(acts: &[Act], next: usize, file: Vec<u8>) -> Self {
        // An installation is gone on with after a loss of power.
        let goes_on = |act: &Act| matches!(act, Act::Install { .. });
        let left = acts
            .iter()
            .filter(|act| next == 0 || act.at() > next || goes_on(act));
        Self {
            acts: left.cloned().collect(),
            sending: VecDeque::new(),
            next_byte_us: 0,
            released_us: 0,
            file,
            sender: None,
        }
    }

    /// Sends bytes to the UART behind those that are on their way.
    pub fn send(&mut self, bytes: impl Iterator<Item = u8>) {
        self.sending.extend(bytes);
    }

    /// Does what is due.
    pub fn act(&mut self, now_us: u64, next: usize) {
        while let Some(act) = self.acts.next_due(now_us, next) {
            match act {
                Act::Press { for_ms, .. } => {
                    IS_DOWN.store(true, Ordering::Relaxed);
                    self.released_us = now_us + for_ms * 1000;
                }
                Act::Send { command, .. } => self.sending.extend(framed(&command).bytes()),
                Act::SendBytes { text, times, .. } => {
                    for _ in 0..times {
                        self.sending.extend(text.chars().map(|byte| byte as u8));
                    }
                }
                Act::Install { pulled_after, .. } => {
                    HEARD.lock().expect("nobody panics here").clear();
                    self.sender = Some(Sender {
                        due_us: now_us,
                        next: Some(Command::Install(Transfer::of(&self.file))),
                        pulled_after,
                        pulled_until_us: 0,
                    });
                }
            }
        }
        self.install(now_us);
        if now_us >= self.released_us {
            IS_DOWN.store(false, Ordering::Relaxed);
        }
        while self.next_byte_us <= now_us
            && let Some(byte) = self.sending.pop_front()
        {
            self.next_byte_us = self.next_byte_us.max(now_us.saturating_sub(BYTE_US)) + BYTE_US;
            if RECEIVED.try_write(&[byte]).is_err() {
                OVERRUN.store(true, Ordering::Relaxed);
            }
        }
    }

    /// Installs as a PC does: one command at a time, the block that is missing, and again where there is no answer.
    fn install(&mut self, now_us: u64) {
        let transfer = Transfer::of(&self.file);
        let begin = Command::Install(transfer);
        let Some(sender) = &mut self.sender else {
            return;
        };
        let heard = HEARD.lock().expect("nobody panics here").pop_front();
        match heard.filter(|_| now_us >= sender.pulled_until_us) {
            Some(Ok(InstallationProgress::Next(number))) => {
                let block = Command::Block(number, Block::of(&self.file, number));
                let blocks = transfer.before(number);
                let is_pulled = sender.pulled_after.take_if(|after| *after == blocks);
                sender.next = Some(if is_pulled.is_some() { begin } else { block });
                sender.due_us = now_us + TURNAROUND_US;
                if is_pulled.is_some() {
                    // What was on its way is cut.
                    let cut = block.to_string();
                    self.sending.extend(cut.bytes().take(PULLED_BYTE));
                    sender.due_us = now_us + PULLED_US;
                    sender.pulled_until_us = sender.due_us;
                }
            }
            Some(Ok(InstallationProgress::Installed)) => self.sender = None,
            Some(Err(_)) => {
                sender.next = Some(begin);
                sender.due_us = now_us + TURNAROUND_US;
            }
            None if sender.due_us > now_us => {}
            None => {
                let command = sender.next.take().unwrap_or(begin);
                sender.due_us = now_us + PATIENCE_US;
                self.sending.extend(command.to_string().bytes());
            }
        }
    }
}
