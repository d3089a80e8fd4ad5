//! Fault injection, after some labels: there is one to clear then. One fault is there from the start.

use std::future;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use virtual_armband::BoardFault as Fault;

use super::clock;
use super::hardware;

/// Labels sent before the fault: enough that both outputs and UART have shown one.
const LABELS_BEFORE: u32 = 3;
const LABEL: &[u8] = b"$LABEL";

/// Microseconds of the inference's pause: longer than the dead-man timer waits, shorter than the watchdog.
const PAUSE_US: u64 = 400_000;

static INFERENCE_PAUSES: AtomicBool = AtomicBool::new(false);
static RADIO_HAS_STOPPED: AtomicBool = AtomicBool::new(false);

/// Injects a fault, after some labels. To be called with every line sent.
pub async fn inject(fault: Option<Fault>, line: &[u8]) {
    static LABELS: AtomicU32 = AtomicU32::new(0);
    let Some(fault) = fault else {
        return;
    };
    if !line.starts_with(LABEL) || LABELS.fetch_add(1, Ordering::Relaxed) + 1 != LABELS_BEFORE {
        return;
    }
    if fault == Fault::InferencePauses {
        return INFERENCE_PAUSES.store(true, Ordering::Relaxed);
    }
    hardware::report_fault();
    match fault {
        Fault::TaskStops => future::pending().await,
        // Holds the core up until the watchdog resets it.
        Fault::ExecutorStops => loop {
            clock::spend(1000);
        },
        Fault::RadioStops => RADIO_HAS_STOPPED.store(true, Ordering::Relaxed),
        Fault::Panic => panic!("injected panic"),
        Fault::InferencePauses | Fault::RadioNeverAnswers => {}
    }
}

/// Injects the fault that is there from the start. To be called before the radio runs.
pub fn inject_at_start(fault: Option<Fault>) {
    if fault == Some(Fault::RadioNeverAnswers) {
        RADIO_HAS_STOPPED.store(true, Ordering::Relaxed);
    }
}

/// Injects the fault of the inference itself. To be called by the inference task.
pub fn inject_into_inference() {
    if INFERENCE_PAUSES.swap(false, Ordering::Relaxed) {
        hardware::report_fault();
        clock::spend(PAUSE_US);
    }
}

/// Whether nothing more comes from the Bluetooth stack.
pub fn radio_has_stopped() -> bool {
    RADIO_HAS_STOPPED.load(Ordering::Relaxed)
}

pub async fn radio_works() {
    if radio_has_stopped() {
        future::pending().await
    }
}
