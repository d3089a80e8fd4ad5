//! Armband that obeys commands, streams, and misbehaves as its [`Behaviour`] says.

use shared::myo::{Address, Characteristic};
use shared::units::Sample;

use crate::behaviour::{ArmbandFault, Behaviour, Corruption, End};
use crate::gatt::{self, Attribute};

/// Microseconds between two notifications.
const PERIOD_US: f64 = 10_000.0;
const SET_MODE: u8 = 0x01;
const SET_SLEEP: u8 = 0x09;
/// Requests for connection parameters on a connection.
const REQUESTS: u8 = 3;

/// Notification: handle and value.
pub type Notification = (u16, Vec<u8>);

/// Virtual armband. Times are microseconds on its driver's clock.
#[derive(Debug)]
pub struct Armband {
    /// Bluetooth address.
    pub address: Address,
    /// Strength of its signal, dBm.
    pub rssi: i8,
    samples: Vec<Sample>,
    table: Vec<Attribute>,
    behaviour: Behaviour,
    is_wearers: bool,
    /// Number of the next notification, over all connections.
    next: usize,
    /// Time at which it advertises again; `None` for never.
    advertises_at_us: Option<u64>,
    link: Connection,
    battery: u8,
    refusals: usize,
}

/// State of a connection.
#[derive(Default, Debug)]
struct Connection {
    is_lost: bool,
    /// True if the armband has ended the connection, and said so.
    is_closed: bool,
    streams_from_us: Option<u64>,
    /// Whether its mode has the IMU on.
    moves: bool,
    subscribed: Vec<Characteristic>,
    sent: usize,
    /// Time until which a step delays everything.
    delayed_until_us: u64,
    /// Time of the next request for connection parameters.
    asks_at_us: Option<u64>,
    /// Number of requests so far, which is the identifier of the last one.
    asked: u8,
    /// Identifiers of requests without an answer.
    unanswered: Vec<u8>,
}

impl Armband {
    /// Creates an armband without a wearer and without faults.
    pub fn new(address: Address, rssi: i8, samples: Vec<Sample>) -> Self {
        Self {
            address,
            rssi,
            samples,
            table: gatt::table(),
            behaviour: Behaviour::default(),
            is_wearers: false,
            next: 0,
            advertises_at_us: Some(0),
            link: Connection::default(),
            battery: 80,
            refusals: 0,
        }
    }

    /// Makes it the wearer's, with this behaviour; `next` is the number of its next notification.
    pub fn of_wearer(self, behaviour: Behaviour, next: usize) -> Self {
        let refusals = behaviour.steps.iter().map(|step| match step {
            ArmbandFault::Refuse { count } if next == 0 => *count,
            _ => 0,
        });
        let refusals = refusals.sum();
        let absent = |step: &ArmbandFault| matches!(step, ArmbandFault::Absent);
        let has_ended = behaviour.end == End::Disconnect && next * 2 >= self.samples.len();
        let is_there = !has_ended && !behaviour.steps.iter().any(absent);
        Self {
            advertises_at_us: is_there.then_some(0),
            refusals,
            behaviour,
            is_wearers: true,
            next,
            ..self
        }
    }

    /// Returns true if it is the wearer's armband.
    pub const fn is_wearers(&self) -> bool {
        self.is_wearers
    }

    /// Returns the number of notifications that it has sent, over all connections.
    pub const fn sent(&self) -> usize {
        self.next
    }

    /// Returns its advertisement, while it sends one.
    pub fn advertisement(&self, now_us: u64) -> Option<&'static [u8]> {
        let is_there = self.advertises_at_us.is_some_and(|at| at <= now_us);
        is_there.then_some(&gatt::ADVERTISEMENT)
    }

    /// Connects a central; returns true if the armband keeps the connection.
    pub fn connected(&mut self) -> bool {
        self.link = Connection::default();
        if self.refusals > 0 {
            self.refusals -= 1;
            return false;
        }
        self.advertises_at_us = None;
        true
    }

    /// Ends the connection, by either side.
    pub fn disconnected(&mut self, now_us: u64) {
        // Otherwise the step that lost the link has set the next advertisement.
        if !self.link.is_lost {
            self.link.is_lost = true;
            self.advertises_at_us = Some(now_us);
        }
    }

    /// Returns true if the connection is lost.
    pub const fn is_lost(&self) -> bool {
        self.link.is_lost
    }

    /// Returns true if the armband has ended the connection itself; else the central hears nothing more.
    pub const fn has_closed(&self) -> bool {
        self.link.is_closed
    }

    /// Returns true while it streams.
    pub const fn streams(&self) -> bool {
        self.link.streams_from_us.is_some()
    }

    /// Returns the value of an attribute; `None` where it cannot be read.
    pub fn read(&self, handle: u16) -> Option<Vec<u8>> {
        match self.attribute(handle)? {
            Attribute::Constant(value) => Some(value.clone()),
            Attribute::Subscription(_) if self.hides_subscriptions() => None,
            Attribute::Subscription(of) => Some(vec![u8::from(self.notifies(*of)), 0]),
            Attribute::Value(Characteristic::FirmwareVersion) => Some(gatt::FIRMWARE.to_vec()),
            Attribute::Value(Characteristic::BatteryLevel) => Some(vec![self.battery]),
            Attribute::Value(_) | Attribute::Other => None,
        }
    }

    /// Takes a written value; returns false where none can be written.
    pub fn write(&mut self, handle: u16, value: &[u8], now_us: u64) -> bool {
        match (self.attribute(handle), value) {
            (Some(Attribute::Subscription(of)), [1, 0]) => {
                let of = *of;
                self.link.subscribed.push(of);
            }
            (
                Some(Attribute::Value(Characteristic::Command)),
                [SET_MODE, 3, emg, imu @ (0 | 1), 0],
            ) => {
                let from = now_us + self.begins_after_us();
                self.link.moves = *imu == 1;
                let streams = matches!(emg, 2 | 3);
                // A stream in progress goes on.
                if !(streams && self.streams() && self.link.sent > 0) {
                    self.link.streams_from_us = streams.then_some(from);
                }
            }
            (Some(Attribute::Value(Characteristic::Command)), [SET_SLEEP, 1, _]) => {}
            _ => return false,
        }
        true
    }

    /// Takes the request for other connection parameters that is due, by its identifier; ends the connection if one was not
    /// answered.
    pub fn take_request(&mut self, now_us: u64) -> Option<u8> {
        let asks = self.behaviour.steps.iter().find_map(|step| match *step {
            ArmbandFault::AskParameters { first_ms, every_ms } => {
                Some((first_ms * 1000, every_ms * 1000))
            }
            _ => None,
        });
        let (first_us, every_us) = asks?;
        let due = *self.link.asks_at_us.get_or_insert(now_us + first_us);
        if self.link.is_lost || now_us < due {
            return None;
        }
        if self.link.asked == REQUESTS {
            self.link.asks_at_us = Some(u64::MAX);
            if !self.link.unanswered.is_empty() {
                self.link.is_closed = true;
                self.lose(Some(now_us));
            }
            return None;
        }
        self.link.asks_at_us = Some(now_us + every_us);
        self.link.asked += 1;
        self.link.unanswered.push(self.link.asked);
        Some(self.link.asked)
    }

    /// Takes the answer to a request for connection parameters, whatever it says.
    pub fn answered(&mut self, identifier: u8) {
        self.link.unanswered.retain(|one| *one != identifier);
    }

    fn hides_subscriptions(&self) -> bool {
        let hides = |step: &ArmbandFault| matches!(step, ArmbandFault::HideSubscriptions);
        self.behaviour.steps.iter().any(hides)
    }

    /// Microseconds from a command that sets the mode to the EMG.
    fn begins_after_us(&self) -> u64 {
        let late = self.behaviour.steps.iter().map(|step| match step {
            ArmbandFault::BeginLate { ms } => ms * 1000,
            _ => 0,
        });
        late.sum()
    }

    fn attribute(&self, handle: u16) -> Option<&Attribute> {
        let place = usize::from(handle).checked_sub(1)?;
        self.table.get(place)
    }

    /// Returns the time at which it sends next; `None` while it does not stream, or has nothing left to send.
    pub fn due_us(&self) -> Option<u64> {
        let from = self.link.streams_from_us.filter(|_| !self.link.is_lost)?;
        if self.has_nothing_left() {
            // The end is due at once.
            return (self.behaviour.end == End::Disconnect).then_some(0);
        }
        let period = PERIOD_US / self.behaviour.pace;
        let interval = (self.behaviour.interval_ms * 1000.0) as u64;
        let due = (period * (self.link.sent + 1) as f64) as u64;
        let due = from + due.next_multiple_of(interval.max(1));
        Some(due.max(self.link.delayed_until_us))
    }

    fn has_nothing_left(&self) -> bool {
        self.next >= self.samples.len() / 2
    }

    /// Sends the notification that is due, with the faults of its behaviour: nothing, one or several. The link may be
    /// lost before it, or it may come later.
    pub fn send(&mut self, now_us: u64) -> Vec<Notification> {
        let mut sent = Vec::new();
        if self.has_nothing_left() {
            self.link.is_closed = true;
            self.lose(None);
            return sent;
        }
        let number = self.next;
        while let Some(step) = self.take_action(number) {
            match step {
                ArmbandFault::Delay { ms, .. } => {
                    self.link.delayed_until_us = now_us + ms * 1000;
                    return sent;
                }
                ArmbandFault::Vanish { for_ms, .. } | ArmbandFault::Sleep { for_ms, .. } => {
                    self.link.is_closed = matches!(step, ArmbandFault::Sleep { .. });
                    self.lose(Some(now_us + for_ms * 1000));
                    return sent;
                }
                ArmbandFault::Battery { percent, .. } => {
                    self.battery = percent;
                    if self.notifies(Characteristic::BatteryLevel) {
                        sent.push((self.handle(Characteristic::BatteryLevel), vec![percent]));
                    }
                }
                _ => {}
            }
        }
        let emg = gatt::EMG[self.link.sent % gatt::EMG.len()];
        self.next = number + 1;
        self.link.sent += 1;
        if self.notifies(emg) {
            sent.extend(self.packet(number, emg));
        }
        if self.link.moves && number % 2 == 1 && self.notifies(Characteristic::Imu) {
            sent.push((self.handle(Characteristic::Imu), movement(number)));
        }
        sent
    }

    /// Returns the packet that is sent for a notification, if one is.
    fn packet(&self, number: usize, emg: Characteristic) -> Option<Notification> {
        let samples = self.samples[2 * number..2 * number + 2].as_flattened();
        let mut value: Vec<u8> = samples.iter().map(|byte| byte.cast_unsigned()).collect();
        let mut handle = self.handle(emg);
        for step in &self.behaviour.steps {
            match *step {
                ArmbandFault::Drop { at, count } if (at..at + count).contains(&number) => {
                    return None;
                }
                ArmbandFault::Corrupt { at, kind } if at == number => match kind {
                    Corruption::Short => value.truncate(9),
                    Corruption::Long => value.extend([0xde, 0xad, 0xbe, 0xef]),
                    Corruption::Foreign => handle = gatt::FOREIGN,
                },
                _ => {}
            }
        }
        Some((handle, value))
    }

    fn take_action(&mut self, number: usize) -> Option<ArmbandFault> {
        let steps = &mut self.behaviour.steps;
        let place = steps.iter().position(|step| match *step {
            ArmbandFault::Delay { at, .. }
            | ArmbandFault::Vanish { at, .. }
            | ArmbandFault::Sleep { at, .. }
            | ArmbandFault::Battery { at, .. } => at == number,
            _ => false,
        });
        place.map(|place| steps.remove(place))
    }

    fn lose(&mut self, advertises_at_us: Option<u64>) {
        self.link.is_lost = true;
        self.advertises_at_us = advertises_at_us;
    }

    fn notifies(&self, characteristic: Characteristic) -> bool {
        self.link.subscribed.contains(&characteristic)
    }

    fn handle(&self, characteristic: Characteristic) -> u16 {
        gatt::value_handle(&self.table, characteristic)
    }
}

/// Value of the IMU behind a notification: at rest, but for a turn by the number of the notification.
fn movement(number: usize) -> Vec<u8> {
    let values = [16_384, 0, 0, 0, 0, 0, 2048, number as i16, 0, 0];
    values.map(i16::to_le_bytes).concat()
}
