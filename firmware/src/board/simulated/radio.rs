//! The link between board and armbands. Every request takes two connection intervals, as on air.

use std::future;

use embassy_futures::select::select;
use embassy_time::{Duration, Instant, Timer};
use shared::myo::Address;

use super::armband::Armband;
use super::fault;
use crate::radio::{
    Advertisement, ConnectFailed, ConnectionHandler, Disconnected, Link, OperationFailed, Radio,
    SCAN_SECONDS, Scanned,
};

/// Milliseconds between two advertisements of an armband.
const ADVERTISING_MS: u64 = 100;
/// Milliseconds until a connection is established.
const CONNECTING_MS: u64 = 50;
/// Milliseconds of a request and its response.
const REQUEST_MS: u64 = 15;
/// Milliseconds after which the end of a link is noticed.
const NOTICED_MS: u64 = 1;

/// The board's Bluetooth stack, in a room with armbands.
pub struct SimulatedRadio<'a> {
    /// Those within its reach.
    pub armbands: &'a [Armband],
}

impl Radio for SimulatedRadio<'_> {
    async fn scan(&mut self, mut report: impl FnMut(Scanned<'_>)) {
        let mut begun = Instant::now();
        loop {
            Timer::after_millis(ADVERTISING_MS).await;
            fault::radio_works().await;
            // As a SoftDevice, which says nothing when a scan begins.
            if begun.elapsed() >= Duration::from_secs(SCAN_SECONDS.into()) {
                begun = Instant::now();
                report(Scanned::Answered);
            }
            for armband in self.armbands {
                if let Some(data) = armband.advertisement() {
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
        let there = |one: &&Armband| one.address == address && one.advertisement().is_some();
        let Some(armband) = self.armbands.iter().find(there) else {
            // A controller tries until it is told to stop.
            return future::pending().await;
        };
        if !armband.connected() {
            return Err(ConnectFailed);
        }
        let link = SimulatedLink(armband);
        let lost = async {
            while !armband.is_lost() {
                Timer::after_millis(NOTICED_MS).await;
            }
        };
        select(lost, handler.run(&link)).await;
        Ok(())
    }
}

/// A connection; dropped with it.
struct SimulatedLink<'a>(&'a Armband);

impl Drop for SimulatedLink<'_> {
    fn drop(&mut self) {
        self.0.disconnected();
    }
}

impl Link for SimulatedLink<'_> {
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        request().await;
        let found = self.0.read(handle).ok_or(OperationFailed)?;
        let length = found.len().min(value.len());
        value[..length].copy_from_slice(&found[..length]);
        Ok(length)
    }

    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        request().await;
        let taken = self.0.write(handle, value);
        taken.then_some(()).ok_or(OperationFailed)
    }

    async fn listen(&self, mut on_notification: impl FnMut(u16, &[u8])) -> Disconnected {
        let notify = |handle: u16, value: &[u8]| {
            if !fault::radio_has_stopped() {
                on_notification(handle, value);
            }
        };
        self.0.stream(notify).await;
        fault::radio_works().await;
        Disconnected
    }
}

async fn request() {
    Timer::after_millis(REQUEST_MS).await;
    fault::radio_works().await;
}
