//! A link and its connection events (`ble_gap.h`), as a central.

use super::SoftDevice;
use super::calls::{answer, reason};
use super::events::{self, HANDLE, Parameters, air_us};
use super::gattc::Request;
use crate::memory::Memory;
use crate::refusal::What;
use crate::time::{ms, us};

/// Connection events from a request for other parameters to their instant.
const UPDATE_EVENTS: u64 = 6;

/// A link.
#[derive(Debug)]
pub struct Link {
    /// Index of the armband.
    pub armband: usize,
    pub(super) parameters: Parameters,
    /// The next connection event.
    pub(super) at: u64,
    /// Request that the armband gets at the next connection event.
    pub(super) request: Option<Request>,
    /// Answer that it gives at the connection event after that.
    pub(super) response: Option<Vec<u8>>,
    /// It ends then, for this reason.
    ends: Option<(u64, u8)>,
    /// Other parameters, from then on.
    update: Option<(u64, Parameters)>,
}

impl Link {
    /// A link whose first connection event is at this time; the armband may end it there.
    pub fn new(armband: usize, parameters: Parameters, at: u64, is_kept: bool) -> Self {
        Self {
            armband,
            parameters,
            at,
            request: None,
            response: None,
            ends: (!is_kept).then_some((at, reason::REMOTE_ENDED)),
            update: None,
        }
    }
}

impl SoftDevice {
    /// Success, if that is the handle of a connection.
    pub(super) fn answer_of(&self, handle: u16) -> u32 {
        match &self.link {
            Some(_) if handle == HANDLE => answer::SUCCESS,
            _ => answer::INVALID_CONN_HANDLE,
        }
    }

    pub(super) fn disconnect(&mut self, handle: u16, now: u64) -> u32 {
        match &mut self.link {
            Some(link) if handle == HANDLE => {
                if link.ends.is_some() {
                    return answer::INVALID_STATE;
                }
                link.ends = Some((now, reason::LOCAL_ENDED));
                answer::SUCCESS
            }
            _ => answer::INVALID_CONN_HANDLE,
        }
    }

    pub(super) fn update_parameters(
        &mut self,
        handle: u16,
        parameters: u32,
        now: u64,
        memory: &Memory,
    ) -> Result<u32, What> {
        if handle != HANDLE || self.link.is_none() {
            return Ok(answer::INVALID_CONN_HANDLE);
        }
        let interval = self.interval_ticks();
        let Some(parameters) = connection_parameters(parameters, memory) else {
            return Ok(answer::INVALID_PARAM);
        };
        if let Some(link) = &mut self.link {
            if link.update.is_some() {
                return Ok(answer::BUSY);
            }
            link.update = Some((now + UPDATE_EVENTS * interval, parameters));
        }
        Ok(answer::SUCCESS)
    }

    /// Ticks from one connection event to the next.
    pub(super) fn interval_ticks(&self) -> u64 {
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
            return self.push(events::disconnected(HANDLE, reason));
        }
        let response = link.response.take();
        let update = link.update.take_if(|(at, _)| *at <= now);
        if let Some((_, [_, interval, latency, timeout])) = update {
            link.parameters = [interval, interval, latency, timeout];
        }
        let (number, parameters) = (link.armband, link.parameters);
        let is_updated = update.is_some();
        if let Some(response) = response.filter(|_| !self.armbands[number].is_lost()) {
            self.push(response);
        }
        self.carry_request_out(now);
        if is_updated {
            self.push(events::updated(HANDLE, parameters));
        }
        self.notify(number, now);
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

    /// Takes all notifications that are due.
    fn notify(&mut self, armband: usize, now: u64) {
        let air = air_us(now);
        while self.armbands[armband]
            .due_us()
            .is_some_and(|due| due <= air)
        {
            let number = self.armbands[armband].sent();
            let notifications = self.armbands[armband].send(air);
            let one = &self.armbands[armband];
            if one.is_wearers() && one.sent() > number {
                self.received.push((now, number));
            }
            for (attribute, value) in notifications {
                self.push(events::notified(HANDLE, attribute, &value));
            }
        }
    }
}

/// `ble_gap_conn_params_t`, if it is allowed (Bluetooth Core Specification, volume 6, part B, 4.5.1 and 4.5.2).
pub fn connection_parameters(address: u32, memory: &Memory) -> Option<Parameters> {
    let mut parameters = [0; 4];
    for (number, field) in (0..).step_by(2).zip(&mut parameters) {
        *field = memory.half(address + number)?;
    }
    let [least, most, latency, timeout] = parameters;
    let outlasts = u32::from(timeout) * 8 > (u32::from(latency) + 1) * u32::from(most) * 2;
    let is_allowed = least >= 6 && least <= most && most <= 3200 && latency < 500;
    (is_allowed && outlasts && (10..=3200).contains(&timeout)).then_some(parameters)
}
