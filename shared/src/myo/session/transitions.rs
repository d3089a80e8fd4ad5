//! Transitions: what each kind of event does in each state.

use super::*;
use crate::myo::arrival_timing::Ordered;
use crate::myo::back_off::REFUSED_MS;
use crate::myo::characteristic::Characteristic;
use crate::myo::command::ArmbandCommand;
use crate::myo::counters::count;
use crate::myo::lane::Lane;
use crate::myo::order::Arrival;
use crate::myo::packet::{Imu, parse_battery, parse_emg};
use crate::myo::set_up::{Response, write};
use crate::myo::stream_monitor::{Due, OPERATION_MS};
use crate::myo::{Action, Address, IMU};
use crate::units::Millis;

impl MyoSession {
    pub(super) fn connect(&mut self, now: Millis, address: Address, act: &mut impl FnMut(Action)) {
        self.state = SessionState::Connecting { since: now };
        act(Action::StopScan);
        self.armband = Some(address);
        act(Action::Connect(address));
    }

    pub(super) fn scan_ended(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        let SessionState::Scanning(scan) = &self.state else {
            return;
        };
        match scan.strongest() {
            Some(address) => self.connect(now, address, act),
            // Not at once: a radio that cannot scan would be asked again and again.
            None => self.back_off(now),
        }
    }

    pub(super) fn connected(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        match self.state {
            SessionState::Connecting { .. } => {
                count(&mut self.counters.connections, 1);
                (self.battery, self.firmware) = (None, None);
                self.begin_step(now, SetUpStep::Discover, Found::NONE, act);
            }
            // Too late: the attempt has timed out. An open connection would keep the armband from
            // advertising.
            SessionState::Idle
            | SessionState::Unbound
            | SessionState::Scanning(_)
            | SessionState::BackingOff { .. } => act(Action::Disconnect),
            SessionState::SettingUp { .. }
            | SessionState::Streaming(_)
            | SessionState::Disconnecting { .. } => {}
        }
    }

    /// The connection ended or failed.
    pub(super) fn disconnected(
        &mut self,
        now: Millis,
        event: MyoEvent<'_>,
        act: &mut impl FnMut(Action),
    ) {
        match (&self.state, event) {
            (SessionState::Disconnecting { delay, .. }, _) => {
                let delay = *delay;
                self.state = SessionState::BackingOff { since: now, delay };
            }
            (SessionState::Connecting { .. }, _) => {
                count(&mut self.counters.failed_connects, 1);
                self.back_off(now);
            }
            (SessionState::SettingUp { .. }, MyoEvent::Disconnected) => self.back_off(now),
            (SessionState::Streaming(_), MyoEvent::Disconnected) => {
                self.back_off(now);
                act(Action::StreamEnded);
            }
            _ => {}
        }
    }

    fn back_off(&mut self, now: Millis) {
        let delay = self.back_off.delay();
        self.state = SessionState::BackingOff { since: now, delay };
    }

    /// Closes the connection; the delay before the next attempt begins with its end.
    pub(super) fn disconnect(&mut self, now: Millis, delay: u32, act: &mut impl FnMut(Action)) {
        let streaming = matches!(self.state, SessionState::Streaming(_));
        self.state = SessionState::Disconnecting { since: now, delay };
        act(Action::Disconnect);
        if streaming {
            act(Action::StreamEnded);
        }
    }

    fn begin_step(
        &mut self,
        now: Millis,
        step: SetUpStep,
        found: Found,
        act: &mut impl FnMut(Action),
    ) {
        self.state = SessionState::SettingUp {
            since: now,
            step,
            found,
        };
        act(step.action(self.settings.emg));
    }

    pub(super) fn operation_answered(
        &mut self,
        now: Millis,
        event: MyoEvent<'_>,
        act: &mut impl FnMut(Action),
    ) {
        let (step, mut found) = match &mut self.state {
            SessionState::SettingUp { step, found, .. } => (*step, *found),
            SessionState::Streaming(monitor)
                if matches!(event, MyoEvent::Done | MyoEvent::Failed) =>
            {
                return monitor.write_answered();
            }
            _ => return,
        };
        let response = step.response(event);
        match response {
            Response::None => return,
            Response::Done | Response::Failed => {}
            Response::Found(these) => found = these,
            Response::Firmware(version) => self.firmware = Some(version),
            Response::Battery(percent) => self.battery = Some(percent),
            Response::Malformed => count(&mut self.counters.malformed, 1),
            Response::Unsupported => {
                count(&mut self.counters.refused, 1);
                return self.disconnect(now, REFUSED_MS, act);
            }
        }
        let failed = matches!(response, Response::Failed | Response::Malformed);
        if failed && !step.is_optional() {
            count(&mut self.counters.failed_set_ups, 1);
            let delay = self.back_off.delay();
            self.disconnect(now, delay, act);
        } else if let Some(next) = step.next(found) {
            self.begin_step(now, next, found, act);
        } else {
            self.start_stream(now, None);
        }
    }

    pub(super) fn notification(
        &mut self,
        now: Millis,
        characteristic: Characteristic,
        bytes: &[u8],
        act: &mut impl FnMut(Action),
    ) {
        let connected = matches!(
            self.state,
            SessionState::SettingUp { .. } | SessionState::Streaming(_)
        );
        match characteristic {
            Characteristic::Emg(lane) => self.emg(now, lane, bytes, act),
            Characteristic::BatteryLevel if connected => match parse_battery(bytes) {
                Ok(percent) => self.battery = Some(percent),
                Err(_) => count(&mut self.counters.malformed, 1),
            },
            Characteristic::Imu
                if IMU && self.settings.imu && matches!(self.state, SessionState::Streaming(_)) =>
            {
                match Imu::parse(bytes) {
                    Ok(imu) => act(Action::Imu(imu)),
                    Err(_) => count(&mut self.counters.malformed, 1),
                }
            }
            _ => count(&mut self.counters.foreign, 1),
        }
    }

    fn emg(&mut self, now: Millis, lane: Lane, bytes: &[u8], act: &mut impl FnMut(Action)) {
        // The first EMG may overtake the confirmation of the mode, and belongs to the stream.
        if let SessionState::SettingUp {
            since,
            step: SetUpStep::SetMode,
            ..
        } = self.state
        {
            self.start_stream(now, Some(since));
        }
        let SessionState::Streaming(monitor) = &mut self.state else {
            return count(&mut self.counters.foreign, 1);
        };
        monitor.notified(now);
        let Ok(pair) = parse_emg(bytes) else {
            return count(&mut self.counters.malformed, 1);
        };
        count(&mut self.counters.notifications, 1);
        monitor.emg(now);
        let arrival = Arrival {
            at: now,
            lane,
            pair,
        };
        let back_off = &mut self.back_off;
        let out = &mut |ordered| match ordered {
            Ordered::Pair(pair) => {
                back_off.reset();
                act(Action::Deliver(pair));
            }
            Ordered::Gap { missing } => act(Action::Gap { missing }),
        };
        self.sequence.push(arrival, &mut self.counters, out);
    }

    /// Does what is due at `now`.
    pub(super) fn handle_time(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        self.end_pairing(now, act);
        match &mut self.state {
            SessionState::Idle => self.start_scan(act),
            SessionState::BackingOff { since, delay } if now.elapsed_since(*since) >= *delay => {
                self.start_scan(act);
            }
            SessionState::Scanning(scan) => {
                if self.pairing.is_none()
                    && let Some(address) = scan.choice(now)
                {
                    self.connect(now, address, act);
                }
            }
            SessionState::Connecting { since } | SessionState::SettingUp { since, .. }
                if now.elapsed_since(*since) >= OPERATION_MS =>
            {
                self.time_out(now, act);
            }
            SessionState::Disconnecting { since, delay }
                if now.elapsed_since(*since) >= OPERATION_MS =>
            {
                let delay = *delay;
                count(&mut self.counters.timeouts, 1);
                self.state = SessionState::BackingOff { since: now, delay };
            }
            SessionState::Streaming(monitor) => match monitor.due(now, self.settings.imu) {
                Due::Nothing => {}
                Due::NeverSleep => act(write(ArmbandCommand::NeverSleep)),
                Due::SubscribeImu => act(Action::Subscribe(Characteristic::Imu)),
                Due::SetMode => {
                    act(write(ArmbandCommand::SetMode(
                        self.settings.emg,
                        monitor.has_imu(),
                    )));
                }
                Due::Unanswered => self.time_out(now, act),
                Due::Stalled => {
                    count(&mut self.counters.stalls, 1);
                    let delay = self.back_off.delay();
                    self.disconnect(now, delay, act);
                }
            },
            _ => {}
        }
    }

    /// Starts a stream; `write` where the mode's confirmation is still to come.
    fn start_stream(&mut self, now: Millis, write: Option<Millis>) {
        self.sequence = Sequence::new();
        self.state = SessionState::Streaming(StreamMonitor::new(now, write));
    }

    pub(super) fn start_scan(&mut self, act: &mut impl FnMut(Action)) {
        let following = self.following();
        if following == Following::Nobody {
            self.state = SessionState::Unbound;
        } else {
            self.state = SessionState::Scanning(Scan::new(following.address()));
            act(Action::Scan);
        }
    }

    fn time_out(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        count(&mut self.counters.timeouts, 1);
        let delay = self.back_off.delay();
        self.disconnect(now, delay, act);
    }
}
