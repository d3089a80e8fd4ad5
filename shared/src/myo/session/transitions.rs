//! What each kind of event does in each state.

use super::*;
use crate::myo::back_off::REFUSED_MS;
use crate::myo::characteristic::Characteristic;
use crate::myo::command::Command;
use crate::myo::counters::count;
use crate::myo::elapsed;
use crate::myo::lane::Lane;
use crate::myo::order::Arrival;
use crate::myo::packet::{parse_battery, parse_emg};
use crate::myo::sequence::Ordered;
use crate::myo::set_up::{Answer, write};
use crate::myo::stream::{ANSWER_MS, Duty};
use crate::myo::{Action, Address};
use crate::units::Millis;

impl MyoSession {
    pub(super) fn connect(&mut self, now: Millis, address: Address, act: &mut impl FnMut(Action)) {
        self.state = State::Connecting { since: now };
        act(Action::StopScan);
        self.armband = Some(address);
        act(Action::Connect(address));
    }

    pub(super) fn scan_ended(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        let State::Scanning(scan) = &self.state else {
            return;
        };
        match scan.strongest() {
            Some(address) => self.connect(now, address, act),
            // Not again at once: a radio that cannot scan would be asked without end.
            None => self.rest(now),
        }
    }

    pub(super) fn connected(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        match self.state {
            State::Connecting { .. } => {
                count(&mut self.counters.connections, 1);
                (self.battery, self.firmware) = (None, None);
                self.begin(now, Step::Discover, Found::NONE, act);
            }
            // Nobody waits for this connection any more, and it would keep the armband from
            // advertising.
            State::Idle | State::Scanning(_) | State::BackingOff { .. } => act(Action::Disconnect),
            State::SettingUp { .. } | State::Streaming(_) | State::Disconnecting { .. } => {}
        }
    }

    /// The connection is gone, or never came.
    pub(super) fn gone(&mut self, now: Millis, event: Event<'_>, act: &mut impl FnMut(Action)) {
        match (&self.state, event) {
            (State::Disconnecting { rest, .. }, _) => {
                let rest = *rest;
                self.state = State::BackingOff { since: now, rest };
            }
            (State::Connecting { .. }, _) => {
                count(&mut self.counters.failed_connects, 1);
                self.rest(now);
            }
            (State::SettingUp { .. }, Event::Disconnected) => self.rest(now),
            (State::Streaming(_), Event::Disconnected) => {
                self.rest(now);
                act(Action::StreamEnded);
            }
            _ => {}
        }
    }

    fn rest(&mut self, now: Millis) {
        let rest = self.back_off.rest();
        self.state = State::BackingOff { since: now, rest };
    }

    /// Closes the connection and rests once it is gone.
    fn leave(&mut self, now: Millis, rest: u32, act: &mut impl FnMut(Action)) {
        let streaming = matches!(self.state, State::Streaming(_));
        self.state = State::Disconnecting { since: now, rest };
        act(Action::Disconnect);
        if streaming {
            act(Action::StreamEnded);
        }
    }

    fn begin(&mut self, now: Millis, step: Step, found: Found, act: &mut impl FnMut(Action)) {
        self.state = State::SettingUp {
            since: now,
            step,
            found,
        };
        act(step.action(self.settings.emg));
    }

    pub(super) fn answered(&mut self, now: Millis, event: Event<'_>, act: &mut impl FnMut(Action)) {
        let (step, mut found) = match &mut self.state {
            State::SettingUp { step, found, .. } => (*step, *found),
            State::Streaming(stream) if matches!(event, Event::Done | Event::Failed) => {
                return stream.answered();
            }
            _ => return,
        };
        let answer = step.answer(event);
        match answer {
            Answer::None => return,
            Answer::Done | Answer::Failed => {}
            Answer::Found(these) => found = these,
            Answer::Firmware(version) => self.firmware = Some(version),
            Answer::Battery(percent) => self.battery = Some(percent),
            Answer::Malformed => count(&mut self.counters.malformed, 1),
            Answer::Refused => {
                count(&mut self.counters.refused, 1);
                return self.leave(now, REFUSED_MS, act);
            }
        }
        let failed = matches!(answer, Answer::Failed | Answer::Malformed);
        if failed && !step.is_optional() {
            count(&mut self.counters.failed_set_ups, 1);
            let rest = self.back_off.rest();
            self.leave(now, rest, act);
        } else if let Some(next) = step.next(found) {
            self.begin(now, next, found, act);
        } else {
            self.stream(now, None);
        }
    }

    pub(super) fn notified(
        &mut self,
        now: Millis,
        characteristic: Characteristic,
        bytes: &[u8],
        act: &mut impl FnMut(Action),
    ) {
        let connected = matches!(self.state, State::SettingUp { .. } | State::Streaming(_));
        match characteristic {
            Characteristic::Emg(lane) => self.emg(now, lane, bytes, act),
            Characteristic::BatteryLevel if connected => match parse_battery(bytes) {
                Ok(percent) => self.battery = Some(percent),
                Err(_) => count(&mut self.counters.malformed, 1),
            },
            _ => count(&mut self.counters.foreign, 1),
        }
    }

    fn emg(&mut self, now: Millis, lane: Lane, bytes: &[u8], act: &mut impl FnMut(Action)) {
        // The first EMG may overtake the answer that confirms its mode, and counts.
        if let State::SettingUp {
            since,
            step: Step::SetMode,
            ..
        } = self.state
        {
            self.stream(now, Some(since));
        }
        let State::Streaming(stream) = &mut self.state else {
            return count(&mut self.counters.foreign, 1);
        };
        let Ok(pair) = parse_emg(bytes) else {
            return count(&mut self.counters.malformed, 1);
        };
        count(&mut self.counters.notifications, 1);
        stream.hear(now);
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

    /// Does what is due because time passed.
    pub(super) fn keep_time(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        match &mut self.state {
            State::Idle => self.scan(act),
            State::BackingOff { since, rest } if elapsed(now, *since) >= *rest => self.scan(act),
            State::Scanning(scan) => {
                if let Some(address) = scan.choice(now) {
                    self.connect(now, address, act);
                }
            }
            State::Connecting { since } | State::SettingUp { since, .. }
                if elapsed(now, *since) >= ANSWER_MS =>
            {
                self.time_out(now, act);
            }
            State::Disconnecting { since, rest } if elapsed(now, *since) >= ANSWER_MS => {
                let rest = *rest;
                count(&mut self.counters.timeouts, 1);
                self.state = State::BackingOff { since: now, rest };
            }
            State::Streaming(stream) => match stream.duty(now) {
                Duty::Nothing => {}
                Duty::KeepAwake => act(write(Command::NeverSleep)),
                Duty::Stir => act(write(Command::SetMode(self.settings.emg))),
                Duty::Unanswered => self.time_out(now, act),
                Duty::Stalled => {
                    count(&mut self.counters.stalls, 1);
                    let rest = self.back_off.rest();
                    self.leave(now, rest, act);
                }
            },
            _ => {}
        }
    }

    /// Begins to stream; `written` where the mode's confirmation is still to come.
    fn stream(&mut self, now: Millis, written: Option<Millis>) {
        self.sequence = Sequence::new();
        self.state = State::Streaming(Stream::new(now, written));
    }

    fn scan(&mut self, act: &mut impl FnMut(Action)) {
        self.state = State::Scanning(Scan::new(self.settings.pinned));
        act(Action::Scan);
    }

    fn time_out(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        count(&mut self.counters.timeouts, 1);
        let rest = self.back_off.rest();
        self.leave(now, rest, act);
    }
}
