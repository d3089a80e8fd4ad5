//! Faults on demand: what never happens by itself would otherwise never be seen to end well.
//!
//! They strike where the output has just told of a label, so that there is something to take back.
//! A chip has no such thing, and the tasks know nothing of it.

use core::{
    future,
    sync::atomic::{AtomicU32, Ordering},
};

use super::straps::{self, Fault};

/// A few, so that pins and line have told of one each.
const LABELS_BEFORE: u32 = 3;
const LABEL: &[u8] = b"$LABEL";

/// Strikes after some labels, if the straps say so; called with every line that was sent.
pub async fn strike(line: &[u8]) {
    static LABELS: AtomicU32 = AtomicU32::new(0);
    let Some(fault) = straps::fault() else {
        return;
    };
    if !line.starts_with(LABEL) || LABELS.fetch_add(1, Ordering::Relaxed) + 1 < LABELS_BEFORE {
        return;
    }
    match fault {
        Fault::TaskStops => future::pending().await,
        Fault::Panic => panic!("a panic on demand"),
        Fault::BadInstruction => cortex_m::asm::udf(),
    }
}
