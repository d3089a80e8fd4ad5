//! Samples on their way to the UART, while somebody has asked for them. They wait for everything else there.

use core::sync::atomic::{AtomicBool, Ordering};

use shared::uart_line::emg::EmgReport;

use super::queue::Queue;

/// 60 ms of them: the longest line takes 22 ms.
static SAMPLES: Queue<EmgReport, 6> = Queue::new();
static WANTED: AtomicBool = AtomicBool::new(false);

/// Sets whether samples are written from now on.
pub fn switch(on: bool) {
    WANTED.store(on, Ordering::Relaxed);
}

/// Queues two samples if they are wanted; where the queue is full, the oldest are dropped.
pub fn enqueue(report: EmgReport) {
    if WANTED.load(Ordering::Relaxed) {
        SAMPLES.push(report);
    }
}

pub async fn receive() -> EmgReport {
    SAMPLES.receive().await
}

pub fn is_idle() -> bool {
    SAMPLES.is_empty()
}

/// Lines dropped since the start; wraps.
pub fn dropped() -> u32 {
    SAMPLES.dropped()
}
