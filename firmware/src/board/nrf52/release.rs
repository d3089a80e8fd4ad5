//! Releases what is pressed on the computer without an instruction of the program.
//!
//! ```text
//! dead-man timer --compare--> PPI --> USBD: the endpoint sends what its registers point at, the report of the release
//! ```
//!
//! A core that hangs sends no report, and the computer keeps the last one: the key would stay down until the watchdog's reset,
//! which takes the board off the bus. The connection is on while something is pressed. Nordic documents the task, and that of
//! the nRF5340 with its connection; it was tried on the emulated chip alone.

use core::cell::RefCell;
use core::ptr::NonNull;
use core::sync::atomic::{Ordering, compiler_fence};

use critical_section::Mutex;
use embassy_nrf::{
    Peri, pac,
    ppi::{AnyConfigurableChannel, Event, Ppi, Task},
};
use shared::hid::{REPORT_BYTES, Report};

/// Endpoint of the reports: the serial port has the two before it.
const ENDPOINT: usize = 3;

static RELEASE: Mutex<RefCell<Option<Release>>> = Mutex::new(RefCell::new(None));

struct Release {
    link: Ppi<'static, AnyConfigurableChannel, 1, 1>,
    /// Report that the endpoint sends: it reads RAM alone.
    report: [u8; REPORT_BYTES],
    is_armed: bool,
}

/// Connects the event of the dead-man timer.
pub fn start(link: Peri<'static, AnyConfigurableChannel>, expired: Event<'static>) {
    let register = NonNull::new(pac::USBD.tasks_startepin(ENDPOINT).as_ptr().cast());
    let Some(register) = register else { return };
    #[expect(unsafe_code, reason = "the driver of USB hands out no task")]
    // SAFETY: the register is a task's.
    let task = unsafe { Task::new_unchecked(register) };
    let release = Release {
        link: Ppi::new_one_to_one(link, expired, task),
        report: [0; REPORT_BYTES],
        is_armed: false,
    };
    critical_section::with(|section| RELEASE.borrow(section).replace(Some(release)));
}

fn with<T>(act: impl FnOnce(&mut Release) -> T) -> Option<T> {
    critical_section::with(|section| {
        let mut release = RELEASE.borrow(section).try_borrow_mut().ok()?;
        release.as_mut().map(act)
    })
}

/// Has this report sent if the dead-man timer expires, or nothing. To be called once the last report is in the endpoint.
pub fn arm(report: Option<Report>) {
    with(|release| {
        release.link.disable();
        release.is_armed = report.is_some();
        let Some(report) = report else { return };
        let bytes = report.bytes();
        release.report[..bytes.len()].copy_from_slice(bytes);
        let endpoint = pac::USBD.epin(ENDPOINT);
        endpoint
            .ptr()
            .write_value(release.report.as_ptr().expose_provenance() as u32);
        endpoint
            .maxcnt()
            .write(|count| count.set_maxcnt(bytes.len() as u8));
        pac::USBD.events_endepin(ENDPOINT).write_value(0);
        compiler_fence(Ordering::Release);
        release.link.enable();
    });
}

/// Whether the report was given to the endpoint since it was armed.
pub fn has_fired() -> bool {
    with(|release| release.is_armed && pac::USBD.events_endepin(ENDPOINT).read() != 0) == Some(true)
}
