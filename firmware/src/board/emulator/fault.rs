//! Fault injection: faults that never occur by themselves, so that tests can see how they end.
//!
//! A fault is injected right after a label was sent, so that there is a label to clear. A chip's image
//! has no such code, and the tasks do not know of it.

use core::{
    fmt::Write as _,
    future,
    hint::black_box,
    sync::atomic::{AtomicBool, AtomicU32, Ordering},
};

use cortex_m::peripheral::NVIC;
use embassy_time::{Duration, Instant};

use super::irq::Irq;
use super::straps::{self, Fault};
use super::uart::Uart;

/// Labels sent before the fault: enough that both pins and UART have shown one.
const LABELS_BEFORE: u32 = 3;
const LABEL: &[u8] = b"$LABEL";

/// The inference's pause: longer than the dead-man timer waits, and no more packets than the queues have room for.
const PAUSE: Duration = Duration::from_millis(300);

/// Set when it is time for the inference to loop.
static INFERENCE_LOOPS: AtomicBool = AtomicBool::new(false);
/// Set when it is time for the inference to pause.
static INFERENCE_PAUSES: AtomicBool = AtomicBool::new(false);

/// Injects the fault that the straps ask for, after some labels. To be called with every line sent.
pub async fn inject(line: &[u8]) {
    static LABELS: AtomicU32 = AtomicU32::new(0);
    let Some(fault) = straps::fault() else {
        return;
    };
    if !line.starts_with(LABEL) {
        return;
    }
    let labels = LABELS.fetch_add(1, Ordering::Relaxed) + 1;
    if labels < LABELS_BEFORE {
        return;
    }
    match fault {
        Fault::InferenceLoops => return INFERENCE_LOOPS.store(true, Ordering::Relaxed),
        // Once, for the board goes on.
        Fault::InferencePauses => {
            return INFERENCE_PAUSES.store(labels == LABELS_BEFORE, Ordering::Relaxed);
        }
        _ => {}
    }
    report();
    match fault {
        Fault::TaskStops => future::pending().await,
        Fault::ExecutorStops => loop_forever(),
        Fault::InterruptStorm => NVIC::pend(Irq::Storm),
        Fault::InferenceLoops | Fault::InferencePauses => {}
        Fault::Recursion => drop(recurse(0)),
        Fault::ClockStops => NVIC::mask(Irq::Alarm),
        Fault::RadioStops => NVIC::mask(Irq::HciReceive),
        Fault::Panic => panic!("injected panic"),
        Fault::UndefinedInstruction => cortex_m::asm::udf(),
    }
}

/// Injects the faults of the inference itself. To be called by the inference task.
pub fn inject_into_inference() {
    if INFERENCE_LOOPS.load(Ordering::Relaxed) {
        report();
        loop_forever();
    }
    if INFERENCE_PAUSES.load(Ordering::Relaxed) {
        INFERENCE_PAUSES.store(false, Ordering::Relaxed);
        report();
        let end = Instant::now() + PAUSE;
        while Instant::now() < end {
            cortex_m::asm::nop();
        }
    }
}

/// Writes the time of the fault, in microseconds, beside the pins.
fn report() {
    let mut pins = Uart::PINS;
    critical_section::with(|_| {
        let _ = writeln!(pins, "FAULT {}", Instant::now().as_micros());
    });
}

fn loop_forever() -> ! {
    loop {
        cortex_m::asm::nop();
    }
}

/// Calls itself without end, each time with a little more on the stack.
#[expect(unconditional_recursion, reason = "it overflows the stack")]
#[inline(never)]
fn recurse(depth: u32) -> u32 {
    let frame = black_box([depth; 8]);
    let deeper = recurse(depth.wrapping_add(1));
    deeper ^ black_box(frame)[0]
}

/// The interrupt handler of the storm: it is pending again before it returns.
pub fn on_storm() {
    NVIC::pend(Irq::Storm);
}
