//! The person beside the board: presses its button, sends bytes to its UART.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

use super::scenario::Act;

/// Microseconds of a byte at 115200 baud, ten bits.
pub const BYTE_US: u64 = 87;

/// As many bytes as the receiver of a chip buffers.
pub static RECEIVED: Pipe<CriticalSectionRawMutex, 128> = Pipe::new();
/// Bytes came while it was full.
pub static OVERRUN: AtomicBool = AtomicBool::new(false);
/// Whether the button is down.
pub static IS_DOWN: AtomicBool = AtomicBool::new(false);

/// Carries out what the scenario asks for.
pub struct Person {
    acts: VecDeque<Act>,
    sending: VecDeque<u8>,
    next_byte_us: u64,
    released_us: u64,
}

impl Person {
    /// What is due before the notification `next` is done already.
    pub fn new(acts: &[Act], next: usize) -> Self {
        let left = acts.iter().filter(|act| next == 0 || act.at() > next);
        Self {
            acts: left.cloned().collect(),
            sending: VecDeque::new(),
            next_byte_us: 0,
            released_us: 0,
        }
    }

    /// Does what is due.
    pub fn act(&mut self, now_us: u64, next: usize) {
        while let Some(act) = self.acts.pop_front_if(|act| act.at() <= next) {
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
            }
        }
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
}

/// A line with the right checksum.
fn framed(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}
