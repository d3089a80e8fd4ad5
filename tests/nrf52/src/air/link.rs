//! A link and its connection events, as a central.

use super::{Air, AirEvent, air_us, reason};
use crate::time::{ms, us};

/// Connection interval and what belongs to it: least, most, latency, time-out.
pub type Parameters = [u16; 4];

/// Connection events from a request for other parameters to their instant.
const UPDATE_EVENTS: u64 = 6;
/// The ATT MTU of an armband, a device of Bluetooth 4.0.
const MTU: u16 = 23;
/// Bytes that an answer has room for, without its header.
const MOST: usize = MTU as usize - 1;

#[derive(Debug)]
pub enum AirRequest {
    Mtu,
    /// Read of an attribute, by its handle.
    Read(u16),
    /// Write of an attribute, by its handle, with the bytes.
    Write(u16, Vec<u8>),
}

#[derive(Debug)]
pub(super) struct AirLink {
    pub(super) armband: usize,
    parameters: Parameters,
    pub(super) at: u64,
    /// Packets that the armband gets at the next connection event.
    waiting: u16,
    /// Request that the armband gets at the next connection event.
    request: Option<AirRequest>,
    /// Answer that it gives at the connection event after that.
    response: Option<AirEvent>,
    /// Tick at which it ends, and the reason.
    ends: Option<(u64, u8)>,
    /// Tick of other parameters, and those.
    update: Option<(u64, Parameters)>,
}

impl AirLink {
    /// A link whose first connection event is at this time; the armband may end it there.
    pub(super) fn new(armband: usize, parameters: Parameters, at: u64, is_kept: bool) -> Self {
        Self {
            armband,
            parameters,
            at,
            waiting: 0,
            request: None,
            response: None,
            ends: (!is_kept).then_some((at, reason::REMOTE_ENDED)),
            update: None,
        }
    }
}

impl Air {
    /// Ends the link; false without a link, or if it ends already.
    pub fn disconnect(&mut self, now: u64) -> bool {
        let link = self.link.as_mut().filter(|link| link.ends.is_none());
        link.is_some_and(|link| link.ends.replace((now, reason::LOCAL_ENDED)).is_none())
    }

    /// Asks for other parameters; false if there is no link, or others are under way.
    pub fn update_parameters(&mut self, now: u64, parameters: Parameters) -> bool {
        let at = now + UPDATE_EVENTS * self.interval_ticks();
        let link = self.link.as_mut().filter(|link| link.update.is_none());
        link.is_some_and(|link| link.update.replace((at, parameters)).is_none())
    }

    /// Answers the armband's request for other parameters.
    pub fn answer(&mut self, identifier: u8) {
        if let Some(link) = &self.link {
            self.armbands[link.armband].answered(identifier);
        }
    }

    /// Sends a request, one at a time; false if there is no link, or another is under way.
    pub fn request(&mut self, request: AirRequest) -> bool {
        let is_free = |link: &&mut AirLink| link.request.is_none() && link.response.is_none();
        let link = self.link.as_mut().filter(is_free);
        link.is_some_and(|link| link.request.replace(request).is_none())
    }

    /// Counts a packet that the armband is to get.
    pub fn send_packet(&mut self) {
        if let Some(link) = &mut self.link {
            link.waiting += 1;
        }
    }

    /// Returns the tick of the next connection event, while there is a link.
    pub fn next_connection_event(&self) -> Option<u64> {
        self.link.as_ref().map(|link| link.at)
    }

    /// Ticks from one connection event to the next.
    pub fn interval_ticks(&self) -> u64 {
        let asked = self.link.as_ref().map(|link| link.parameters[1]);
        // Units of 1.25 ms.
        us(1250) * u64::from(asked.unwrap_or(12))
    }

    /// A connection event: both sides send what they have.
    pub(super) fn advance_link(&mut self, now: u64) {
        let interval = self.interval_ticks();
        let Some(link) = self.link.as_mut().filter(|link| link.at <= now) else {
            return;
        };
        link.at = now + interval;
        if let Some((_, reason)) = link.ends.take_if(|(at, _)| *at <= now) {
            let armband = link.armband;
            self.link = None;
            self.armbands[armband].disconnected(air_us(now));
            return self.events.push_back(AirEvent::Disconnected(reason));
        }
        let is_lost = self.armbands[link.armband].is_lost();
        let sent = std::mem::take(&mut link.waiting);
        let response = link.response.take();
        let update = link.update.take_if(|(at, _)| *at <= now);
        if let Some((_, [_, interval, latency, timeout])) = update {
            link.parameters = [interval, interval, latency, timeout];
        }
        let (number, parameters) = (link.armband, link.parameters);
        if !is_lost {
            let sent = (sent > 0).then_some(AirEvent::Sent(sent));
            self.events.extend(sent.into_iter().chain(response));
        }
        self.carry_request_out(now);
        if update.is_some() {
            self.events.push_back(AirEvent::Updated(parameters));
        }
        self.notify(number, now);
        let asked = self.armbands[number].take_request(air_us(now));
        self.events.extend(asked.map(AirEvent::Asked));
        let armband = &self.armbands[number];
        if armband.is_lost()
            && let Some(link) = self.link.as_mut().filter(|link| link.ends.is_none())
        {
            // Units of 10 ms.
            let timeout = ms(10) * u64::from(link.parameters[3]);
            link.ends = Some(if armband.has_closed() {
                (now, reason::REMOTE_ENDED)
            } else {
                (now + timeout, reason::CONNECTION_TIMEOUT)
            });
        }
    }

    /// The armband takes the request, at a connection event.
    fn carry_request_out(&mut self, now: u64) {
        let Some(link) = &mut self.link else {
            return;
        };
        let armband = &mut self.armbands[link.armband];
        link.response = match link.request.take() {
            None => return,
            Some(AirRequest::Mtu) => Some(AirEvent::Mtu(MTU)),
            Some(AirRequest::Read(attribute)) => {
                let mut value = armband.read(attribute);
                value.iter_mut().for_each(|value| value.truncate(MOST));
                Some(AirEvent::Read(attribute, value))
            }
            Some(AirRequest::Write(attribute, value)) => {
                let is_taken = armband.write(attribute, &value, air_us(now));
                Some(AirEvent::Written(attribute, is_taken))
            }
        };
    }

    /// Takes all notifications that are due.
    fn notify(&mut self, armband: usize, now: u64) {
        let air = air_us(now);
        while self.armbands[armband]
            .due_us()
            .is_some_and(|due| due <= air)
        {
            let number = self.armbands[armband].sent();
            let notifications = self.armbands[armband].send(air);
            if self.armbands[armband].sent() > number {
                self.received.push((now, number));
            }
            let notified = notifications
                .into_iter()
                .map(|(attribute, value)| AirEvent::Notified(attribute, value));
            self.events.extend(notified);
        }
    }
}

/// Returns true for connection parameters that are allowed (Bluetooth Core Specification, volume 6, part B, 4.5.1 and 4.5.2).
pub fn parameters_are_allowed([least, most, latency, timeout]: Parameters) -> bool {
    let outlasts = u32::from(timeout) * 8 > (u32::from(latency) + 1) * u32::from(most) * 2;
    let in_range = least >= 6 && least <= most && most <= 3200 && latency < 500;
    in_range && outlasts && (10..=3200).contains(&timeout)
}
