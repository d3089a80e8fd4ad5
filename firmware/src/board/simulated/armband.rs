//! The simulated armband: obeys commands, streams, and misbehaves as the scenario says.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};

use embassy_time::{Duration, Instant, Timer};
use shared::myo::{Address, Characteristic};
use shared::units::Sample;

use super::gatt::{self, Attribute};
use super::hardware;
use super::scenario::{Corruption, End, Scenario, Step};

/// Microseconds between two notifications.
const PERIOD_US: f64 = 10_000.0;
const SET_MODE: u8 = 0x01;
const SET_SLEEP: u8 = 0x09;

/// Notifications of the wearer's armband, over all connections and all starts of the board.
static SENT: AtomicUsize = AtomicUsize::new(0);

/// How many notifications the wearer's armband has sent.
pub fn sent() -> usize {
    SENT.load(Ordering::Relaxed)
}

/// An armband.
pub struct Armband {
    /// Its address.
    pub address: Address,
    /// Strength of its signal, dBm.
    pub rssi: i8,
    samples: Vec<Sample>,
    table: Vec<Attribute>,
    steps: RefCell<Vec<Step>>,
    period_us: f64,
    /// From one connection event to the next.
    interval_us: u64,
    first_lane: u8,
    end: End,
    is_wearers: bool,
    /// Of the next notification, over all connections.
    next: Cell<usize>,
    /// When it advertises again; never where none.
    advertises_at: Cell<Option<Instant>>,
    link: RefCell<Connection>,
    battery: Cell<u8>,
    refusals: Cell<usize>,
}

/// What a connection sets.
#[derive(Default)]
struct Connection {
    is_lost: bool,
    streams_from: Option<Instant>,
    subscribed: Vec<Characteristic>,
    sent: usize,
    /// What a swap holds back.
    held: Option<(u16, Vec<u8>)>,
}

impl Armband {
    /// Somebody's armband, which does nothing wrong.
    pub fn new(address: Address, rssi: i8, samples: Vec<Sample>) -> Self {
        Self {
            address,
            rssi,
            samples,
            table: gatt::table(),
            refusals: Cell::new(0),
            steps: RefCell::default(),
            period_us: PERIOD_US,
            interval_us: 0,
            first_lane: 0,
            end: End::Silence,
            is_wearers: false,
            next: Cell::new(0),
            advertises_at: Cell::new(Some(Instant::MIN)),
            link: RefCell::default(),
            battery: Cell::new(80),
        }
    }

    /// The wearer's, which does what the scenario says; `next` is its next notification.
    pub fn of_wearer(self, scenario: &Scenario, next: usize) -> Self {
        SENT.store(next, Ordering::Relaxed);
        let refusals = scenario.armband.iter().map(|step| match step {
            Step::Refuse { count } if next == 0 => *count,
            _ => 0,
        });
        let absent = |step: &Step| matches!(step, Step::Absent);
        let has_ended = scenario.end == End::Disconnect && next * 2 >= self.samples.len();
        let is_there = !has_ended && !scenario.armband.iter().any(absent);
        Self {
            advertises_at: Cell::new(is_there.then_some(Instant::MIN)),
            refusals: Cell::new(refusals.sum()),
            steps: RefCell::new(scenario.armband.clone()),
            period_us: PERIOD_US / scenario.pace,
            interval_us: (scenario.interval_ms * 1000.0) as u64,
            first_lane: scenario.first_lane,
            end: scenario.end,
            is_wearers: true,
            next: Cell::new(next),
            ..self
        }
    }

    /// Its advertisement, while it sends one.
    pub fn advertisement(&self) -> Option<&[u8]> {
        let advertises = |at: Instant| at <= Instant::now();
        let is_there = self.advertises_at.get().is_some_and(advertises);
        is_there.then_some(&gatt::ADVERTISEMENT)
    }

    /// A central connects; whether the armband keeps the connection.
    pub fn connected(&self) -> bool {
        *self.link.borrow_mut() = Connection::default();
        if self.refusals.get() > 0 {
            self.refusals.set(self.refusals.get() - 1);
            return false;
        }
        self.advertises_at.set(None);
        true
    }

    /// The connection has ended, by either side.
    pub fn disconnected(&self) {
        let mut link = self.link.borrow_mut();
        // Otherwise its own step said when it advertises.
        if !link.is_lost {
            link.is_lost = true;
            self.advertises_at.set(Some(Instant::now()));
        }
    }

    /// Whether the connection is lost.
    pub fn is_lost(&self) -> bool {
        self.link.borrow().is_lost
    }

    /// The value of an attribute that can be read.
    pub fn read(&self, handle: u16) -> Option<Vec<u8>> {
        match self.attribute(handle)? {
            Attribute::Constant(value) => Some(value.clone()),
            Attribute::Subscription(of) => {
                let on = self.link.borrow().subscribed.contains(of);
                Some(vec![u8::from(on), 0])
            }
            Attribute::Value(Characteristic::FirmwareVersion) => Some(gatt::FIRMWARE.to_vec()),
            Attribute::Value(Characteristic::BatteryLevel) => Some(vec![self.battery.get()]),
            Attribute::Value(_) | Attribute::Other => None,
        }
    }

    /// Takes what is written; whether it can be.
    pub fn write(&self, handle: u16, value: &[u8]) -> bool {
        let mut link = self.link.borrow_mut();
        match (self.attribute(handle), value) {
            (Some(Attribute::Subscription(of)), [1, 0]) => link.subscribed.push(*of),
            (Some(Attribute::Value(Characteristic::Command)), [SET_MODE, 3, emg, ..]) => {
                link.streams_from = matches!(emg, 2 | 3).then(Instant::now);
                if self.is_wearers && link.streams_from.is_some() {
                    hardware::report_stream();
                }
            }
            (Some(Attribute::Value(Characteristic::Command)), [SET_SLEEP, 1, _]) => {}
            _ => return false,
        }
        true
    }

    fn attribute(&self, handle: u16) -> Option<&Attribute> {
        let place = usize::from(handle).checked_sub(1)?;
        self.table.get(place)
    }

    /// Notifies until the connection is lost.
    pub async fn stream(&self, mut notify: impl FnMut(u16, &[u8])) {
        loop {
            let Some(from) = self.link.borrow().streams_from else {
                Timer::after_millis(1).await;
                continue;
            };
            let pairs = self.samples.len() / 2;
            if self.next.get() >= pairs {
                return self.end().await;
            }
            let sent = self.link.borrow().sent;
            let due = (self.period_us * (sent + 1) as f64) as u64;
            let due = due.next_multiple_of(self.interval_us.max(1));
            let due = from + Duration::from_micros(due);
            // All that are due are received at once, as from a Bluetooth stack that has queued them.
            if due > Instant::now() {
                Timer::at(due).await;
            }
            let number = self.next.get();
            while let Some(step) = self.take_action(number) {
                match step {
                    Step::Delay { ms, .. } => Timer::after_millis(ms).await,
                    Step::Vanish { for_ms, .. } | Step::Sleep { for_ms, .. } => {
                        return self.lose(Some(for_ms));
                    }
                    Step::Battery { percent, .. } => {
                        self.battery.set(percent);
                        if self.notifies(Characteristic::BatteryLevel) {
                            notify(self.handle(Characteristic::BatteryLevel), &[percent]);
                        }
                    }
                    _ => {}
                }
            }
            let lane = (usize::from(self.first_lane) + sent) % gatt::EMG.len();
            self.next.set(number + 1);
            if self.is_wearers {
                SENT.store(number + 1, Ordering::Relaxed);
            }
            self.link.borrow_mut().sent += 1;
            hardware::received(number);
            for (handle, value) in self.packets(number, lane) {
                notify(handle, &value);
            }
        }
    }

    /// What is sent for a notification.
    fn packets(&self, number: usize, lane: usize) -> VecDeque<(u16, Vec<u8>)> {
        let value: Vec<u8> = self.samples[2 * number..2 * number + 2]
            .iter()
            .flatten()
            .map(|byte| byte.cast_unsigned())
            .collect();
        let emg = gatt::EMG[lane];
        let handle = self.handle(emg);
        let mut sent = VecDeque::new();
        let steps = self.steps.borrow();
        let step = steps.iter().find(|step| match **step {
            Step::Drop { at, count } => (at..at + count).contains(&number),
            Step::Corrupt { at, .. } | Step::Duplicate { at } | Step::Swap { at } => at == number,
            _ => false,
        });
        match step {
            _ if !self.notifies(emg) => {}
            Some(Step::Drop { .. }) => {}
            Some(Step::Duplicate { .. }) => {
                sent.extend([(handle, value.clone()), (handle, value)]);
            }
            Some(Step::Swap { .. }) => {
                self.link.borrow_mut().held = Some((handle, value));
                return sent;
            }
            Some(Step::Corrupt { kind, .. }) => match kind {
                Corruption::Short => sent.push_back((handle, value[..9].to_vec())),
                Corruption::Long => {
                    sent.push_back((handle, [&value[..], &[0xde, 0xad, 0xbe, 0xef]].concat()));
                }
                Corruption::Foreign => sent.push_back((gatt::FOREIGN, value)),
                Corruption::Garbage => {}
            },
            _ => sent.push_back((handle, value)),
        }
        sent.extend(self.link.borrow_mut().held.take());
        sent
    }

    fn take_action(&self, number: usize) -> Option<Step> {
        let mut steps = self.steps.borrow_mut();
        let place = steps.iter().position(|step| match *step {
            Step::Delay { at, .. }
            | Step::Vanish { at, .. }
            | Step::Sleep { at, .. }
            | Step::Battery { at, .. } => at == number,
            _ => false,
        });
        place.map(|place| steps.remove(place))
    }

    async fn end(&self) {
        match self.end {
            End::Silence => std::future::pending().await,
            End::Disconnect => self.lose(None),
        }
    }

    fn lose(&self, for_ms: Option<u64>) {
        self.link.borrow_mut().is_lost = true;
        self.advertises_at
            .set(for_ms.map(|ms| Instant::now() + Duration::from_millis(ms)));
    }

    fn notifies(&self, characteristic: Characteristic) -> bool {
        self.link.borrow().subscribed.contains(&characteristic)
    }

    fn handle(&self, characteristic: Characteristic) -> u16 {
        gatt::value_handle(&self.table, characteristic)
    }
}
