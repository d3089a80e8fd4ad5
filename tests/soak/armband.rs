//! Virtual armband and radio in virtual time, in steps of one millisecond.

mod radio;

use std::collections::{BTreeMap, VecDeque};
use std::ops::RangeInclusive;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shared::myo::{Characteristic, Counters, Event};

use self::radio::{Answer, FIRMWARE};
use super::device::{Device, QUEUE, numbered};
use super::faults::{Fault, STALLED_MS};

/// Period of the notifications in microseconds by the device's clock: the armband's runs up to 200 ppm slower or
/// faster. Drawn anew with every connection.
const PERIOD_US: RangeInclusive<u64> = 9_998..=10_002;
/// Largest number of notifications given up where a loss cannot be told from a delay: as many as are held then.
const HELD: u32 = 24;
/// Number of notifications lost in a row from which on the lanes do not show the loss, so it cannot be told from a
/// delay.
const UNSEEN: u32 = 4;
/// Period, in notifications, of those without a delay.
const PROMPT_EVERY: u32 = 5;
/// Longest delay of the other notifications, in microseconds.
const JITTER_US: u64 = 7_000;
/// Longest time to a stream, failed attempts and operations without an answer included.
const PATIENCE_MS: u64 = 120_000;

/// Characteristics of the four lanes of EMG.
const EMG: [Characteristic; 4] = {
    let [_, _, emg @ .., _] = Characteristic::ALL;
    emg
};

/// Notification that the radio has received, with its time.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    at_us: u64,
    emg: Characteristic,
    bytes: [u8; 16],
    length: usize,
}

/// Armband and radio, with the device that they meet.
pub struct Armband<'d, 'm, 's> {
    device: &'d mut Device<'m, 's>,
    random: ChaCha8Rng,
    now_us: u64,
    /// Time from a notification to the next.
    period_us: u64,
    /// Answers of the radio, each at its time.
    answers: VecDeque<(u64, Answer)>,
    scanning: bool,
    /// Number of the next notification since the armband was switched on.
    number: u32,
    /// Time at which the armband sends it.
    sends_at_us: u64,
    on_air: VecDeque<Arrival>,
    /// Time until which the radio delivers nothing.
    held_until_us: u64,
    /// Time until which the inference does not run.
    busy_until_us: u64,
    /// Number of connections that will fail; below, of operations that will not be answered, of those that will be
    /// refused, and of firmware versions that are too old.
    refused: u32,
    unanswered: u32,
    failing: u32,
    outdated: u32,
    injected: Injected,
    /// Packets that arrived while the inference did not run.
    waiting: u32,
    /// Session's count of given-up samples at the last check; below, most that may be given up since.
    given_up: u32,
    may_give_up: u32,
}

/// Counts of the injected faults.
#[derive(Default, Debug)]
struct Injected {
    kinds: BTreeMap<&'static str, u32>,
    connections: u32,
    failed_connects: u32,
    timeouts: u32,
    stalls: u32,
    failed_set_ups: u32,
    refused: u32,
    notifications: u32,
    duplicates: u32,
    swaps: u32,
    malformed: u32,
    foreign: u32,
    /// Notifications lost in streams that went on.
    lost: u32,
    /// Packets that the queue had no room for.
    dropped: u32,
}

impl<'d, 'm, 's> Armband<'d, 'm, 's> {
    /// Creates an armband that advertises, before a device's first event.
    pub fn new(device: &'d mut Device<'m, 's>, seed: u64) -> Self {
        Self {
            device,
            random: ChaCha8Rng::seed_from_u64(seed),
            now_us: 0,
            period_us: *PERIOD_US.start(),
            answers: VecDeque::new(),
            scanning: false,
            number: 0,
            sends_at_us: 0,
            on_air: VecDeque::new(),
            held_until_us: 0,
            busy_until_us: 0,
            refused: 0,
            unanswered: 0,
            failing: 0,
            outdated: 0,
            injected: Injected::default(),
            waiting: 0,
            given_up: 0,
            may_give_up: 0,
        }
    }

    /// Returns the virtual milliseconds so far.
    pub const fn elapsed_ms(&self) -> u64 {
        self.now_us / 1000
    }

    /// Waits for the stream and for the inference, and lets so many notifications pass.
    pub fn stream(&mut self, notifications: u32) {
        let patience = self.elapsed_ms() + PATIENCE_MS;
        while !self.device.is_streaming() || self.now_us < self.busy_until_us {
            assert!(self.elapsed_ms() < patience, "no stream within two minutes");
            self.millisecond();
        }
        for _ in 0..u64::from(notifications) * self.period_us / 1000 {
            self.millisecond();
        }
    }

    /// Asserts that labels are valid after a pause without faults, and that every count equals the injected one.
    pub fn must_be_true(&mut self) {
        assert!(self.device.is_valid(), "not valid after {}", self.summary());
        let counters = self.device.session.counters();
        let injected = &self.injected;
        // Missing samples were lost, or given up because their place among the lost ones was unknown. The numbers that
        // samples carry say how many are missing: no other sample may be.
        let totals = self.device.truth.totals;
        let dropped = 2 * u64::from(self.device.dropped);
        let lost = 2 * u64::from(injected.lost + injected.malformed);
        let gone = lost + u64::from(counters.given_up) + dropped;
        assert_eq!(totals.missing, gone, "{}", self.summary());
        // Samples that came were taken, given up or dropped.
        let came = 2 * u64::from(counters.notifications - counters.duplicates);
        let taken = totals.samples + u64::from(counters.given_up) + dropped;
        assert_eq!(came, taken, "{}", self.summary());
        assert_eq!(totals.counted, totals.missing, "{}", self.summary());
        let expected = Counters {
            connections: injected.connections,
            failed_connects: injected.failed_connects,
            timeouts: injected.timeouts,
            stalls: injected.stalls,
            failed_set_ups: injected.failed_set_ups,
            refused: injected.refused,
            notifications: injected.notifications,
            lost: u32::try_from(totals.counted - dropped).expect("fewer than 2^32"),
            given_up: counters.given_up,
            duplicates: injected.duplicates,
            reordered: injected.swaps,
            malformed: injected.malformed,
            foreign: injected.foreign,
        };
        assert_eq!(counters, expected, "{injected:?}");
        assert_eq!(self.device.dropped, injected.dropped, "{injected:?}");
        let given_up = counters.given_up - self.given_up;
        assert!(
            given_up <= self.may_give_up,
            "{given_up} samples given up, {} at most",
            self.may_give_up
        );
        (self.given_up, self.may_give_up) = (counters.given_up, 0);
    }

    /// Returns the number of times that each fault has happened.
    pub const fn faults_seen(&self) -> &BTreeMap<&'static str, u32> {
        &self.injected.kinds
    }

    /// Returns the counts so far as text.
    pub fn summary(&self) -> String {
        format!(
            "{:?}; {:?}; pipeline {:?}; {} packets dropped by a full queue; injected {:?}",
            self.device.truth.totals,
            self.device.session.counters(),
            self.device.truth.counters(),
            self.device.dropped,
            self.injected,
        )
    }

    /// Injects a fault.
    pub fn suffer(&mut self, fault: Fault) {
        *self.injected.kinds.entry(fault.kind()).or_default() += 1;
        match fault {
            Fault::Lose(count) => self.lose(count),
            Fault::LoseEveryOther(times) => {
                for _ in 0..times {
                    self.lose(1);
                    self.sent(1);
                }
            }
            Fault::Duplicate => {
                self.sent(1);
                self.injected.duplicates += 1;
                let newest = self.newest();
                self.on_air.push_back(newest);
            }
            Fault::Swap => {
                self.sent(2);
                self.injected.swaps += 1;
                let [first, second] = self.newest_two();
                first.at_us = first.at_us.max(second.at_us);
                second.at_us = first.at_us;
                std::mem::swap(first, second);
            }
            Fault::Stall(milliseconds) => {
                self.held_until_us = self.now_us + 1000 * u64::from(milliseconds);
            }
            Fault::Silence(milliseconds) => self.lose(milliseconds / 10),
            Fault::Disconnect {
                refused,
                unanswered,
            } => {
                (self.refused, self.unanswered) = (refused, unanswered);
                self.disconnect();
            }
            Fault::FailedSetUp => {
                self.failing = 1;
                self.disconnect();
            }
            Fault::OldFirmware => {
                self.outdated = 1;
                self.disconnect();
            }
            Fault::Malformed(length) => {
                self.sent(1);
                self.injected.malformed += 1;
                self.on_air.back_mut().expect("just sent").length = length.into();
            }
            Fault::Foreign => {
                self.injected.foreign += 1;
                self.event(Event::Notification {
                    characteristic: Characteristic::FirmwareVersion,
                    bytes: &FIRMWARE,
                });
            }
            Fault::Backlog(milliseconds) => {
                self.busy_until_us = self.now_us + 1000 * u64::from(milliseconds);
            }
        }
    }

    /// Loses the link, with what is on the air.
    fn disconnect(&mut self) {
        self.on_air.clear();
        self.answers.clear();
        self.event(Event::Disconnected);
    }

    /// Loses so many notifications that the armband sends. Many of them end the stream, and no counter counts them.
    fn lose(&mut self, count: u32) {
        self.settle();
        if 10 * count >= STALLED_MS {
            self.injected.stalls += 1;
        } else {
            self.injected.lost += count;
            self.may_give_up += if count < UNSEEN { 0 } else { 2 * HELD };
        }
        self.number += count;
        self.sends_at_us += u64::from(count) * self.period_us;
        let next = self.sends_at_us;
        while self.now_us < next {
            self.millisecond();
        }
    }

    /// Lets so many notifications be sent and stay on the air.
    fn sent(&mut self, count: usize) {
        self.settle();
        let hold = std::mem::replace(&mut self.held_until_us, u64::MAX);
        while self.on_air.len() < count {
            self.millisecond();
        }
        self.held_until_us = hold;
    }

    /// Lets what is on the air arrive.
    fn settle(&mut self) {
        while !self.on_air.is_empty() {
            self.millisecond();
        }
    }

    fn newest(&self) -> Arrival {
        *self.on_air.back().expect("just sent")
    }

    fn newest_two(&mut self) -> [&mut Arrival; 2] {
        let [.., first, second] = self.on_air.make_contiguous() else {
            unreachable!("two were sent");
        };
        [first, second]
    }

    /// Advances the time by a millisecond.
    fn millisecond(&mut self) {
        self.now_us += 1000;
        if self.device.is_streaming() {
            self.send();
        } else {
            // The armband's own time goes on.
            self.sends_at_us = self.now_us;
            self.on_air.clear();
            self.period_us = self.random.random_range(PERIOD_US);
        }
        self.receive();
        while self
            .answers
            .front()
            .is_some_and(|(at, _)| *at <= self.now_us)
        {
            if let Some((_, answer)) = self.answers.pop_front() {
                self.answer(answer);
            }
        }
        if self.elapsed_ms().is_multiple_of(50) {
            self.event(Event::Tick);
        }
        if self.now_us >= self.busy_until_us {
            self.injected.dropped += self.waiting.saturating_sub(QUEUE as u32);
            self.waiting = 0;
            self.device.infer(Device::clock(self.now_us / 1000));
        }
    }

    fn send(&mut self) {
        while self.sends_at_us <= self.now_us {
            let number = self.number;
            let delay = if number.is_multiple_of(PROMPT_EVERY) {
                0
            } else {
                self.random.random_range(0..=JITTER_US)
            };
            let pair =
                [2 * number, 2 * number + 1].map(|sample| numbered(sample).map(i8::cast_unsigned));
            let mut bytes = [0; 16];
            bytes.copy_from_slice(pair.as_flattened());
            self.on_air.push_back(Arrival {
                at_us: self.sends_at_us + delay,
                emg: EMG[number as usize % 4],
                bytes,
                length: bytes.len(),
            });
            self.number = number + 1;
            self.sends_at_us += self.period_us;
        }
    }

    fn receive(&mut self) {
        let due = |arrival: &Arrival| arrival.at_us <= self.now_us;
        if self.now_us < self.held_until_us || !self.on_air.front().is_some_and(due) {
            return;
        }
        while let Some(arrival) = self
            .on_air
            .pop_front_if(|arrival| arrival.at_us <= self.now_us)
        {
            if arrival.length == arrival.bytes.len() {
                self.injected.notifications += 1;
                self.waiting += 1;
            }
            self.event(Event::Notification {
                characteristic: arrival.emg,
                bytes: &arrival.bytes[..arrival.length],
            });
        }
    }
}
