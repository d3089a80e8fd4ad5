//! Requests to the attributes of a connected armband.

use embassy_futures::yield_now;
use shared::myo::{Characteristic, ConnectionParameters, Discovery, MyoEvent, Payload};

use super::SessionDriver;
use crate::messages::uart::{self, UartMessage};
use crate::radio::{
    ENABLE_NOTIFICATIONS, Link, MAX_VALUE_BYTES, OperationFailed, handles::Handles,
};

/// First byte of the command that starts a stream (`myohw_command_set_mode` of Thalmic's header).
const SET_MODE: u8 = 1;
/// UUID of the preferred connection parameters, as in the declaration of their characteristic.
const PREFERRED: [u8; 2] = [0x04, 0x2a];

#[derive(Clone, Copy)]
pub(super) enum Request {
    Discover,
    Read(Characteristic),
    Subscribe(Characteristic),
    /// Write of a value, with response.
    Write(Characteristic, Payload),
}

impl SessionDriver<'_> {
    /// Carries out a request, and tells the session its outcome.
    pub(super) async fn carry_out(&self, link: &impl Link, request: Request) {
        let mut value = [0; MAX_VALUE_BYTES];
        let handles = self.handles.get();
        let outcome = match request {
            Request::Discover => {
                let handles = self.discover(link).await;
                self.handles.set(handles);
                return self.handle(MyoEvent::Discovered(handles.found()));
            }
            Request::Read(characteristic) => match handles.value(characteristic) {
                Some(handle) => match link.read(handle, &mut value).await {
                    Ok(length) => {
                        return self.handle(MyoEvent::Read(&value[..length.min(MAX_VALUE_BYTES)]));
                    }
                    Err(failed) => Err(failed),
                },
                None => Err(OperationFailed),
            },
            Request::Write(characteristic, payload) => {
                if payload.as_slice().first() == Some(&SET_MODE) {
                    // Before it: the first notification may come with the response.
                    self.listens.signal(());
                    yield_now().await;
                }
                match handles.value(characteristic) {
                    Some(handle) => link.write(handle, payload.as_slice()).await,
                    None => Err(OperationFailed),
                }
            }
            Request::Subscribe(characteristic) => match handles.subscription(characteristic) {
                Some(handle) => link.write(handle, &ENABLE_NOTIFICATIONS).await,
                None => Err(OperationFailed),
            },
        };
        self.handle(match outcome {
            Ok(()) => MyoEvent::Done,
            Err(_) => MyoEvent::Failed,
        });
    }

    /// Reads attributes until every characteristic is found, or to the end.
    async fn discover(&self, link: &impl Link) -> Handles {
        let mut handles = Handles::default();
        let mut discovery = Discovery::default();
        let mut value = [0; MAX_VALUE_BYTES];
        while let Some(handle) = discovery.handle() {
            let read = link.read(handle, &mut value).await;
            let bytes = read.ok().and_then(|length| value.get(..length));
            if let Some(attribute) = discovery.answered(bytes) {
                handles.insert(attribute);
            }
            if let Some([_, low, high, uuid @ ..]) = bytes
                && *uuid == PREFERRED
            {
                let handle = u16::from_le_bytes([*low, *high]);
                self.say_preferred(link, handle).await;
            }
        }
        handles
    }

    /// Says which connection parameters the armband prefers, once: nobody has seen them.
    async fn say_preferred(&self, link: &impl Link, handle: u16) {
        let mut value = [0; MAX_VALUE_BYTES];
        if self.has_said_preferred.replace(true)
            || !matches!(link.read(handle, &mut value).await, Ok(8..))
        {
            return;
        }
        let [a, b, c, d, e, f, g, h, ..] = value;
        let [min_interval, max_interval, latency, supervision_timeout] =
            [[a, b], [c, d], [e, f], [g, h]].map(u16::from_le_bytes);
        uart::enqueue(UartMessage::Preferred(ConnectionParameters {
            min_interval,
            max_interval,
            latency,
            supervision_timeout,
        }));
    }
}
