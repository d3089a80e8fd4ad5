//! The link between board and armbands. Every request takes two connection intervals, as on air.

use std::cell::RefCell;
use std::future;

use embassy_futures::select::select;
use embassy_time::{Duration, Instant, Timer};
use shared::myo::{Address, ConnectionParameters};
use virtual_armband::{Armband, Notification};

use super::{fault, hardware};
use crate::radio::{
    Advertisement, ConnectFailed, ConnectionHandler, Disconnected, Link, OperationFailed, Pace,
    REST, Radio, SCAN_SECONDS, Scanned,
};

/// Milliseconds between two advertisements of an armband.
const ADVERTISING_MS: u64 = 100;
const CONNECTING_MS: u64 = 50;
/// Milliseconds of a request and its response.
const REQUEST_MS: u64 = 15;
/// Milliseconds after which a link that the armband ends is noticed.
const NOTICED_MS: u64 = 1;
/// Milliseconds after which a link that falls silent is given up.
const SUPERVISION_MS: u64 = 10 * ConnectionParameters::OURS.supervision_timeout as u64;

/// The board's Bluetooth stack, in a room with armbands.
pub struct SimulatedRadio<'a> {
    pub armbands: &'a [RefCell<Armband>],
}

impl Radio for SimulatedRadio<'_> {
    const LEAVES_FLASH_TIME: bool = true;

    async fn silence(&mut self) {}

    async fn scan(&mut self, pace: impl Fn() -> Pace, mut report: impl FnMut(Scanned<'_>)) {
        let mut begun = Instant::now();
        loop {
            let windows = match pace() {
                Pace::Always => 1,
                Pace::Seldom => u64::from(REST),
            };
            Timer::after_millis(ADVERTISING_MS * windows).await;
            fault::radio_works().await;
            // As a SoftDevice, which says nothing when a scan begins.
            if begun.elapsed() >= Duration::from_secs(SCAN_SECONDS.into()) {
                begun = Instant::now();
                report(Scanned::Answered);
            }
            for armband in self.armbands {
                let armband = armband.borrow();
                if let Some(data) = armband.advertisement(hardware::now_us()) {
                    let heard = Advertisement::new(armband.address, armband.rssi, data);
                    report(Scanned::Advertisement(&heard));
                }
            }
        }
    }

    async fn connect(
        &mut self,
        address: Address,
        handler: &impl ConnectionHandler,
    ) -> Result<(), ConnectFailed> {
        Timer::after_millis(CONNECTING_MS).await;
        fault::radio_works().await;
        let there = |one: &&RefCell<Armband>| {
            let one = one.borrow();
            one.address == address && one.advertisement(hardware::now_us()).is_some()
        };
        let Some(armband) = self.armbands.iter().find(there) else {
            // A controller tries until it is told to stop.
            return future::pending().await;
        };
        let is_kept = armband.borrow_mut().connected();
        let link = SimulatedLink(armband);
        let lost = async {
            if !is_kept {
                // A controller reports the connection before the other side has answered in it.
                return Timer::after_millis(REQUEST_MS).await;
            }
            while !armband.borrow().is_lost() {
                // Both Bluetooth stacks answer such a request by themselves.
                let asked = armband.borrow_mut().take_request(hardware::now_us());
                if let Some(identifier) = asked {
                    armband.borrow_mut().answered(identifier);
                }
                Timer::after_millis(NOTICED_MS).await;
            }
            if !armband.borrow().has_closed() {
                Timer::after_millis(SUPERVISION_MS).await;
            }
            fault::radio_works().await;
        };
        // Whatever the handler waits for ends with the link.
        select(lost, handler.run(&link)).await;
        Ok(())
    }
}

/// A connection; dropped with it.
struct SimulatedLink<'a>(&'a RefCell<Armband>);

impl Drop for SimulatedLink<'_> {
    fn drop(&mut self) {
        self.0.borrow_mut().disconnected(hardware::now_us());
    }
}

impl Link for SimulatedLink<'_> {
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        request().await;
        let found = self.0.borrow().read(handle).ok_or(OperationFailed)?;
        let length = found.len().min(value.len());
        value[..length].copy_from_slice(&found[..length]);
        Ok(length)
    }

    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        request().await;
        let mut armband = self.0.borrow_mut();
        let streamed = armband.streams();
        let taken = armband.write(handle, value, hardware::now_us());
        if armband.is_wearers() && armband.streams() && !streamed {
            hardware::report_stream();
        }
        taken.then_some(()).ok_or(OperationFailed)
    }

    async fn listen(&self, mut on_notification: impl FnMut(u16, &[u8])) -> Disconnected {
        let notify = |handle: u16, value: &[u8]| {
            if !fault::radio_has_stopped() {
                on_notification(handle, value);
            }
        };
        self.stream(notify).await;
        // The end of the link drops this.
        future::pending().await
    }
}

impl SimulatedLink<'_> {
    /// Notifies until the armband is gone.
    async fn stream(&self, mut notify: impl FnMut(u16, &[u8])) {
        while !self.0.borrow().is_lost() {
            let (due, streams) = {
                let armband = self.0.borrow();
                (armband.due_us(), armband.streams())
            };
            let Some(due) = due else {
                if streams {
                    return future::pending().await;
                }
                Timer::after_millis(1).await;
                continue;
            };
            // All that are due are received at once, as from a Bluetooth stack that has queued them.
            let due = Instant::from_micros(due);
            if due > Instant::now() {
                Timer::at(due).await;
            }
            for (handle, value) in self.send() {
                notify(handle, &value);
            }
        }
    }

    fn send(&self) -> Vec<Notification> {
        let mut armband = self.0.borrow_mut();
        let number = armband.sent();
        let notifications = armband.send(hardware::now_us());
        if armband.sent() > number {
            if armband.is_wearers() {
                hardware::sent(armband.sent());
            }
            hardware::received(number);
        }
        notifications
    }
}

async fn request() {
    Timer::after_millis(REQUEST_MS).await;
    fault::radio_works().await;
}
