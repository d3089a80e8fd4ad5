//! The session as tables: events with their times, and the expected actions.

use super::*;
use crate::myo::AddressKind;
use crate::myo::Uuid;
use crate::myo::characteristic::Characteristic::{self, BatteryLevel, Emg, Imu};
use crate::myo::command::ArmbandCommand;
use crate::myo::lane::Lane;
use crate::myo::progress::RadioProgress;
use crate::myo::set_up::write;
use alloc::vec::Vec;

mod binding;
mod connecting;
mod streaming;

pub(in crate::myo) const NEAR: Address = address(1);
const FAR: Address = address(2);
const NEVER_SLEEP: Action = write(ArmbandCommand::NeverSleep);
const SET_MODE: Action = write(ArmbandCommand::SetMode(EmgMode::Filtered, false));
/// Settings without an address: the strongest armband is followed.
pub(in crate::myo) const ANY: Settings = Settings {
    pinned: None,
    bound: None,
    follow_strongest: true,
    emg: EmgMode::Filtered,
    imu: false,
};
/// A value of the Firmware Version of a real armband: 1.5.1970, rev D.
const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

const fn address(last: u8) -> Address {
    Address {
        kind: AddressKind::Public,
        bytes: [last, 0, 0, 0, 0, 0xfa],
    }
}

fn advertisement() -> [u8; 18] {
    let mut data = [0; 18];
    data[..2].copy_from_slice(&[17, 0x06]);
    data[2..].copy_from_slice(&Uuid::CONTROL.to_le_bytes());
    data
}

fn everything() -> Found {
    Characteristic::ALL.into_iter().collect()
}

fn everything_but(absent: Characteristic) -> Found {
    let all = Characteristic::ALL.into_iter();
    all.filter(|one| *one != absent).collect()
}

const fn lane(number: u8) -> Characteristic {
    Emg(Lane::ALL[number as usize])
}

/// Advertisement of something else, stronger than any armband.
const NO_ARMBAND: MyoEvent<'_> = MyoEvent::Advertisement {
    address: address(9),
    rssi: -1,
    data: b"\x04\x09Myo",
};

/// End of a stream by the session.
const CLOSED: [Action; 2] = [Action::Disconnect, Action::StreamEnded];

/// End of a scan that has found this armband.
const fn connect(armband: Address) -> [Action; 2] {
    [Action::StopScan, Action::Connect(armband)]
}

const fn notification(characteristic: Characteristic, bytes: &[u8]) -> MyoEvent<'_> {
    MyoEvent::Notification {
        characteristic,
        bytes,
    }
}

/// Answers to the steps of a set-up after the discovery, up to the `done`th write or subscription.
fn answers(done: usize) -> impl Iterator<Item = MyoEvent<'static>> {
    let reads = [MyoEvent::Read(&FIRMWARE), MyoEvent::Read(&[80])];
    reads
        .into_iter()
        .chain([MyoEvent::Done; 8].into_iter().take(done))
}

/// A session, and the radio's side of it.
pub(in crate::myo) struct Driver {
    pub(in crate::myo) session: MyoSession,
    pub(in crate::myo) progress: RadioProgress,
}

impl Driver {
    pub(in crate::myo) fn new(settings: Settings) -> Self {
        Self {
            session: MyoSession::new(settings),
            progress: RadioProgress::default(),
        }
    }

    pub(in crate::myo) fn handle(&mut self, now: u32, event: MyoEvent<'_>) -> Vec<Action> {
        let mut actions = Vec::new();
        let act = &mut |action| actions.push(action);
        self.session.handle(Millis(now), event, act);
        self.progress.handled(Millis(now), event, &self.session);
        actions
    }

    /// Handles each event at its time and checks the actions.
    fn run(&mut self, trace: &[(u32, MyoEvent<'_>, &[Action])]) {
        for (row, (now, event, expected)) in trace.iter().enumerate() {
            let actions = self.handle(*now, *event);
            assert_eq!(actions, *expected, "row {row}: {event:?} at {now} ms");
        }
    }

    pub(in crate::myo) fn advertise(
        &mut self,
        now: u32,
        address: Address,
        rssi: i8,
    ) -> Vec<Action> {
        let data = &advertisement();
        let event = MyoEvent::Advertisement {
            address,
            rssi,
            data,
        };
        self.handle(now, event)
    }

    /// Scans from `now`, when a scan is due, and connects.
    fn connecting(&mut self, now: u32) {
        assert_eq!(self.handle(now, MyoEvent::Tick), [Action::Scan]);
        assert_eq!(self.advertise(now, NEAR, -40), []);
        assert_eq!(self.handle(now + 500, MyoEvent::Tick), connect(NEAR));
    }

    /// Like `connecting`, and on to reading the firmware version, at `now` + 501.
    fn discovered(&mut self, now: u32, found: Found) {
        self.connecting(now);
        self.run(&[
            (now + 501, MyoEvent::Connected, &[Action::Discover]),
            (
                now + 501,
                MyoEvent::Discovered(found),
                &[Action::Read(Characteristic::FirmwareVersion)],
            ),
        ]);
    }

    /// Like `discovered`, and on to a stream, at `now` + 501.
    pub(in crate::myo) fn streaming(&mut self, now: u32) {
        self.discovered(now, everything());
        let (firmware, battery) = (MyoEvent::Read(&FIRMWARE), MyoEvent::Read(&[80]));
        let at = now + 501;
        assert_eq!(self.handle(at, firmware), [Action::Read(BatteryLevel)]);
        assert_eq!(self.handle(at, battery), [Action::Subscribe(lane(0))]);
        let done = [
            Action::Subscribe(lane(1)),
            Action::Subscribe(lane(2)),
            Action::Subscribe(lane(3)),
            Action::Subscribe(BatteryLevel),
            NEVER_SLEEP,
            SET_MODE,
        ];
        assert_eq!(self.done(at), done);
        assert_eq!(self.session.phase(), Phase::Streaming);
    }

    /// Actions of the writes and subscriptions that succeed, to the last.
    fn done(&mut self, now: u32) -> Vec<Action> {
        let next = || Some(self.handle(now, MyoEvent::Done)).filter(|actions| !actions.is_empty());
        core::iter::from_fn(next).flatten().collect()
    }

    /// Notification `number`, in its lane.
    pub(in crate::myo) fn emg(&mut self, now: u32, number: u32) -> Vec<Action> {
        let characteristic = lane((number % 4) as u8);
        self.handle(now, notification(characteristic, &[number as u8; 16]))
    }
}

/// A session that has found everything, and reads the firmware version.
fn discovered() -> Driver {
    let mut driver = Driver::new(ANY);
    driver.discovered(0, everything());
    driver
}

/// A session that streams from 501 ms on.
fn streaming() -> Driver {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    driver
}

fn deliver(number: u8) -> Action {
    Action::Deliver([[number.cast_signed(); 8]; 2])
}

#[test]
fn an_armband_is_found_set_up_and_streams() {
    let mut driver = Driver::new(ANY);
    assert_eq!(driver.session.phase(), Phase::Idle);
    driver.streaming(0);
    for number in 0..100 {
        let delivered = driver.emg(510 + 10 * number, number);
        assert_eq!(delivered, [deliver(number as u8)]);
    }
    let session = &driver.session;
    assert_eq!(
        (session.battery(), session.battery_is_low()),
        (Some(80), false)
    );
    assert_eq!(session.firmware().map(|version| version.minor), Some(5));
    let expected = Counters {
        connections: 1,
        notifications: 100,
        ..Counters::default()
    };
    assert_eq!(session.counters(), expected);
}

#[test]
fn the_mode_is_the_settings() {
    let emg = EmgMode::Raw;
    let mut driver = Driver::new(Settings { emg, ..ANY });
    driver.discovered(0, everything());
    let last = answers(6).map(|answer| driver.handle(600, answer)).last();
    let last = last.unwrap();
    assert_eq!(last, [write(ArmbandCommand::SetMode(EmgMode::Raw, false))]);
}

#[test]
fn an_armband_without_a_characteristic_is_disconnected() {
    for absent in Characteristic::ALL {
        let mut driver = Driver::new(ANY);
        driver.connecting(0);
        driver.handle(501, MyoEvent::Connected);
        let expected = if [BatteryLevel, Imu].contains(&absent) {
            Action::Read(Characteristic::FirmwareVersion)
        } else {
            Action::Disconnect
        };
        let discovered = MyoEvent::Discovered(everything_but(absent));
        assert_eq!(driver.handle(501, discovered), [expected], "{absent:?}");
    }
}

#[test]
fn without_a_battery_two_steps_are_skipped() {
    let mut driver = Driver::new(ANY);
    driver.discovered(0, everything_but(BatteryLevel));
    let first = driver.handle(502, MyoEvent::Read(&FIRMWARE));
    assert_eq!(first, [Action::Subscribe(lane(0))]);
    let lanes = [1, 2, 3].map(|number| Action::Subscribe(lane(number)));
    let done = [&lanes[..], &[NEVER_SLEEP, SET_MODE]].concat();
    assert_eq!(driver.done(502), done);
    assert_eq!(driver.session.battery(), None);
}

#[test]
fn a_battery_that_fails_does_not_matter() {
    for answer in [MyoEvent::Failed, MyoEvent::Read(&[])] {
        let mut driver = discovered();
        driver.handle(502, MyoEvent::Read(&FIRMWARE));
        let lanes = [answer, MyoEvent::Done, MyoEvent::Done, MyoEvent::Done];
        for (number, answer) in (0..).zip(lanes) {
            let next = driver.handle(502, answer);
            assert_eq!(next, [Action::Subscribe(lane(number))]);
        }
        let battery = driver.handle(502, MyoEvent::Done);
        assert_eq!(battery, [Action::Subscribe(BatteryLevel)]);
        assert_eq!(driver.handle(502, MyoEvent::Failed), [NEVER_SLEEP]);
    }
}

#[test]
fn a_step_that_fails_ends_the_connection() {
    for steps in 0..7 {
        let mut driver = discovered();
        // The battery's are optional: the read is step 1, the subscription step 6.
        for answer in answers(6).take(if steps == 0 { 0 } else { steps + 1 }) {
            driver.handle(502, answer);
        }
        let failed = driver.handle(502, MyoEvent::Failed);
        if steps == 5 {
            assert_eq!(failed, [NEVER_SLEEP]);
        } else {
            assert_eq!(failed, [Action::Disconnect], "after {steps}");
            assert_eq!(driver.session.counters().failed_set_ups, 1);
        }
    }
}

#[test]
fn firmware_of_major_0_is_refused_for_a_minute() {
    let mut driver = discovered();
    let old = MyoEvent::Read(&[0, 0, 8, 0, 0, 0, 1, 0]);
    driver.run(&[
        (502, old, &[Action::Disconnect]),
        (510, MyoEvent::Disconnected, &[]),
        (60_509, MyoEvent::Tick, &[]),
        (60_510, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().refused, 1);
    assert_eq!(driver.session.firmware(), None);
}

#[test]
fn a_firmware_version_too_short_is_malformed() {
    let mut driver = discovered();
    let actions = driver.handle(502, MyoEvent::Read(&FIRMWARE[..7]));
    assert_eq!(actions, [Action::Disconnect]);
    let counters = driver.session.counters();
    assert_eq!((counters.malformed, counters.failed_set_ups), (1, 1));
}

#[test]
fn time_may_wrap_in_any_phase() {
    let mut driver = Driver::new(ANY);
    let start = u32::MAX - 400;
    assert_eq!(driver.handle(start, MyoEvent::Tick), [Action::Scan]);
    assert_eq!(driver.advertise(start, NEAR, -40), []);
    assert_eq!(driver.handle(98, MyoEvent::Tick), []);
    assert_eq!(driver.handle(99, MyoEvent::Tick), connect(NEAR));
}
