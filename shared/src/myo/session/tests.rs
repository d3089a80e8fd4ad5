//! The session as tables: events with their times, and the expected actions.

use super::*;
use crate::myo::AddressKind;
use crate::myo::Uuid;
use crate::myo::characteristic::Characteristic::{self, BatteryLevel, Emg};
use crate::myo::command::Command;
use crate::myo::lane::Lane;
use crate::myo::set_up::write;
use alloc::vec::Vec;

mod binding;
mod properties;

pub(super) const NEAR: Address = address(1);
const FAR: Address = address(2);
const NEVER_SLEEP: Action = write(Command::NeverSleep);
const SET_MODE: Action = write(Command::SetMode(EmgMode::Filtered));
/// Settings without an address: the strongest armband is followed.
pub(super) const ANY: Settings = Settings {
    pinned: None,
    bound: None,
    follow_strongest: true,
    emg: EmgMode::Filtered,
};
/// A value of the Firmware Version of a real armband: 1.5.1970, rev D.
const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

pub(super) const fn address(last: u8) -> Address {
    Address {
        kind: AddressKind::Public,
        bytes: [last, 0, 0, 0, 0, 0xfa],
    }
}

pub(super) fn advertisement() -> [u8; 18] {
    let mut data = [0; 18];
    data[..2].copy_from_slice(&[17, 0x06]);
    data[2..].copy_from_slice(&Uuid::CONTROL.to_le_bytes());
    data
}

pub(super) fn everything() -> Found {
    Characteristic::ALL.into_iter().collect()
}

const fn lane(number: u8) -> Characteristic {
    Emg(Lane::ALL[number as usize])
}

/// A session, and the radio's side of it.
struct Driver {
    session: MyoSession,
}

impl Driver {
    fn new(settings: Settings) -> Self {
        let session = MyoSession::new(settings);
        Self { session }
    }

    fn handle(&mut self, now: u32, event: Event<'_>) -> Vec<Action> {
        let mut actions = Vec::new();
        let act = &mut |action| actions.push(action);
        self.session.handle(Millis(now), event, act);
        actions
    }

    /// Handles each event at its time and checks the actions.
    fn run(&mut self, trace: &[(u32, Event<'_>, &[Action])]) {
        for (row, (now, event, expected)) in trace.iter().enumerate() {
            let actions = self.handle(*now, *event);
            assert_eq!(actions, *expected, "row {row}: {event:?} at {now} ms");
        }
    }

    fn advertise(&mut self, now: u32, address: Address, rssi: i8) -> Vec<Action> {
        let data = &advertisement();
        self.handle(
            now,
            Event::Advertisement {
                address,
                rssi,
                data,
            },
        )
    }

    /// Scans from `now`, when a scan is due, and connects.
    fn connecting(&mut self, now: u32) {
        assert_eq!(self.handle(now, Event::Tick), [Action::Scan]);
        assert_eq!(self.advertise(now, NEAR, -40), []);
        let connect = [Action::StopScan, Action::Connect(NEAR)];
        assert_eq!(self.handle(now + 500, Event::Tick), connect);
    }

    /// Like `connecting`, and on to reading the firmware version, at `now` + 501.
    fn discovered(&mut self, now: u32, found: Found) {
        self.connecting(now);
        self.run(&[
            (now + 501, Event::Connected, &[Action::Discover]),
            (
                now + 501,
                Event::Discovered(found),
                &[Action::Read(Characteristic::FirmwareVersion)],
            ),
        ]);
    }

    /// Like `discovered`, and on to a stream, at `now` + 501.
    fn streaming(&mut self, now: u32) {
        self.discovered(now, everything());
        let at = now + 501;
        let read = Action::Read(BatteryLevel);
        let subscribe = Action::Subscribe;
        self.run(&[
            (at, Event::Read(&FIRMWARE), &[read]),
            (at, Event::Read(&[80]), &[subscribe(lane(0))]),
            (at, Event::Done, &[subscribe(lane(1))]),
            (at, Event::Done, &[subscribe(lane(2))]),
            (at, Event::Done, &[subscribe(lane(3))]),
            (at, Event::Done, &[subscribe(BatteryLevel)]),
            (at, Event::Done, &[NEVER_SLEEP]),
            (at, Event::Done, &[SET_MODE]),
            (at, Event::Done, &[]),
        ]);
        assert_eq!(self.session.phase(), Phase::Streaming);
    }

    /// Notification `number`, in its lane.
    fn emg(&mut self, now: u32, number: u32) -> Vec<Action> {
        let characteristic = lane((number % 4) as u8);
        let bytes = &[number as u8; 16];
        self.handle(
            now,
            Event::Notification {
                characteristic,
                bytes,
            },
        )
    }
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
    let mut last = Vec::new();
    let answers = [Event::Read(&FIRMWARE), Event::Read(&[80])];
    for answer in answers.into_iter().chain([Event::Done; 6]) {
        last = driver.handle(600, answer);
    }
    assert_eq!(last, [write(Command::SetMode(EmgMode::Raw))]);
}

#[test]
fn the_strongest_armband_of_half_a_second_wins() {
    let mut driver = Driver::new(ANY);
    driver.run(&[(0, Event::Tick, &[Action::Scan]), (9_000, Event::Tick, &[])]);
    let other = Event::Advertisement {
        address: address(9),
        rssi: -1,
        data: b"\x04\x09Myo",
    };
    assert_eq!(driver.handle(9_100, other), []);
    assert_eq!(driver.advertise(10_000, FAR, -80), []);
    assert_eq!(driver.advertise(10_100, address(3), 127), []); // signal strength unknown
    assert_eq!(driver.advertise(10_200, NEAR, -50), []);
    assert_eq!(driver.advertise(10_499, address(4), -60), []);
    let connect = [Action::StopScan, Action::Connect(NEAR)];
    assert_eq!(driver.handle(10_500, Event::Tick), connect);
    assert_eq!(driver.advertise(10_501, address(5), -1), []);
}

#[test]
fn a_pinned_armband_is_taken_at_once_and_no_other() {
    let pinned = Address::parse("FA:00:00:00:00:01").ok();
    let mut driver = Driver::new(Settings { pinned, ..ANY });
    assert_eq!(driver.handle(0, Event::Tick), [Action::Scan]);
    assert_eq!(driver.advertise(0, FAR, -20), []);
    assert_eq!(driver.handle(2_000, Event::Tick), []);
    // With the address kind of the report, not the one that was assumed.
    let kind = AddressKind::Random;
    let reported = Address { kind, ..NEAR };
    let connect = [Action::StopScan, Action::Connect(reported)];
    assert_eq!(driver.advertise(2_001, reported, -90), connect);
}

#[test]
fn a_scan_that_ends_is_repeated_after_a_delay() {
    let mut driver = Driver::new(ANY);
    driver.run(&[
        (0, Event::Tick, &[Action::Scan]),
        (10, Event::ScanEnded, &[]),
        (309, Event::Tick, &[]),
        (310, Event::Tick, &[Action::Scan]),
    ]);
    // With an armband received before, that one is taken.
    assert_eq!(driver.advertise(320, FAR, -80), []);
    let connect = [Action::StopScan, Action::Connect(FAR)];
    assert_eq!(driver.handle(330, Event::ScanEnded), connect);
}

#[test]
fn failed_connects_back_off_up_to_five_seconds() {
    let mut driver = Driver::new(ANY);
    let mut now = 0;
    for delay in [300, 600, 1200, 2400, 4800, 5000, 5000] {
        driver.connecting(now);
        now += 510;
        assert_eq!(driver.handle(now, Event::ConnectFailed), []);
        assert_eq!(driver.session.phase(), Phase::BackingOff);
        assert_eq!(driver.handle(now + delay - 1, Event::Tick), []);
        now += delay;
    }
    assert_eq!(driver.session.counters().failed_connects, 7);
}

#[test]
fn a_stream_that_ran_makes_the_next_delay_short() {
    let mut driver = Driver::new(ANY);
    for now in [0, 1_000, 2_500] {
        driver.connecting(now);
        driver.handle(now + 510, Event::ConnectFailed);
    }
    driver.streaming(5_000);
    assert_eq!(driver.emg(5_510, 0), [deliver(0)]);
    driver.run(&[
        (5_520, Event::Disconnected, &[Action::StreamEnded]),
        (5_521, Event::Disconnected, &[]),
        (5_819, Event::Tick, &[]),
    ]);
    driver.streaming(5_820);
    assert_eq!(driver.session.counters().connections, 2);
}

#[test]
fn a_stream_without_emg_ends_too_and_backs_off_longer() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    assert_eq!(
        driver.handle(510, Event::Disconnected),
        [Action::StreamEnded]
    );
    driver.streaming(810);
    assert_eq!(
        driver.handle(1_320, Event::Disconnected),
        [Action::StreamEnded]
    );
    assert_eq!(driver.handle(1_919, Event::Tick), []);
    assert_eq!(driver.handle(1_920, Event::Tick), [Action::Scan]);
}

#[test]
fn an_operation_that_is_not_answered_ends_the_connection() {
    let mut driver = Driver::new(ANY);
    driver.connecting(0);
    driver.run(&[
        (5_499, Event::Tick, &[]),
        (5_500, Event::Tick, &[Action::Disconnect]),
        (5_501, Event::Connected, &[]), // too late: it is being closed
        (5_510, Event::ConnectFailed, &[]),
    ]);
    driver.discovered(5_810, everything());
    driver.run(&[
        (11_310, Event::Tick, &[]),
        (11_311, Event::Tick, &[Action::Disconnect]),
        (11_312, Event::Read(&FIRMWARE), &[]),
        (11_320, Event::Disconnected, &[]),
        (11_919, Event::Tick, &[]),
        (11_920, Event::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().timeouts, 2);
}

#[test]
fn a_connection_that_does_not_end_is_waited_for_5_s() {
    let mut driver = Driver::new(ANY);
    driver.connecting(0);
    driver.run(&[
        (5_500, Event::Tick, &[Action::Disconnect]),
        (10_500, Event::Tick, &[]),
        (10_800, Event::Tick, &[Action::Scan]),
        // The connection is established after all, too late.
        (10_900, Event::Connected, &[Action::Disconnect]),
        (10_901, Event::Disconnected, &[]),
    ]);
    assert_eq!(driver.session.phase(), Phase::Scanning);
}

#[test]
fn an_armband_without_a_characteristic_is_disconnected() {
    for absent in Characteristic::ALL {
        let found: Found = Characteristic::ALL
            .into_iter()
            .filter(|one| *one != absent)
            .collect();
        let mut driver = Driver::new(ANY);
        driver.connecting(0);
        driver.handle(501, Event::Connected);
        let expected = if absent == BatteryLevel {
            Action::Read(Characteristic::FirmwareVersion)
        } else {
            Action::Disconnect
        };
        assert_eq!(
            driver.handle(501, Event::Discovered(found)),
            [expected],
            "{absent:?}"
        );
    }
}

#[test]
fn without_a_battery_two_steps_are_skipped() {
    let found = Characteristic::ALL
        .into_iter()
        .filter(|one| *one != BatteryLevel);
    let mut driver = Driver::new(ANY);
    driver.discovered(0, found.collect());
    driver.run(&[
        (502, Event::Read(&FIRMWARE), &[Action::Subscribe(lane(0))]),
        (502, Event::Done, &[Action::Subscribe(lane(1))]),
        (502, Event::Done, &[Action::Subscribe(lane(2))]),
        (502, Event::Done, &[Action::Subscribe(lane(3))]),
        (502, Event::Done, &[NEVER_SLEEP]),
        (502, Event::Done, &[SET_MODE]),
        (502, Event::Done, &[]),
    ]);
    assert_eq!(driver.session.battery(), None);
}

#[test]
fn a_battery_that_fails_does_not_matter() {
    for answer in [Event::Failed, Event::Read(&[])] {
        let mut driver = Driver::new(ANY);
        driver.discovered(0, everything());
        driver.run(&[
            (502, Event::Read(&FIRMWARE), &[Action::Read(BatteryLevel)]),
            (502, answer, &[Action::Subscribe(lane(0))]),
            (502, Event::Done, &[Action::Subscribe(lane(1))]),
            (502, Event::Done, &[Action::Subscribe(lane(2))]),
            (502, Event::Done, &[Action::Subscribe(lane(3))]),
            (502, Event::Done, &[Action::Subscribe(BatteryLevel)]),
            (502, Event::Failed, &[NEVER_SLEEP]),
        ]);
    }
}

#[test]
fn a_step_that_fails_ends_the_connection() {
    for steps in 0..7 {
        let mut driver = Driver::new(ANY);
        driver.discovered(0, everything());
        let answers = [Event::Read(&FIRMWARE), Event::Read(&[80])];
        let answers = answers.into_iter().chain([Event::Done; 6]);
        // The battery's are optional: the read is step 1, the subscription step 6.
        for answer in answers.take(if steps == 0 { 0 } else { steps + 1 }) {
            driver.handle(502, answer);
        }
        let failed = driver.handle(502, Event::Failed);
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
    let mut driver = Driver::new(ANY);
    driver.discovered(0, everything());
    driver.run(&[
        (
            502,
            Event::Read(&[0, 0, 8, 0, 0, 0, 1, 0]),
            &[Action::Disconnect],
        ),
        (510, Event::Disconnected, &[]),
        (60_509, Event::Tick, &[]),
        (60_510, Event::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().refused, 1);
    assert_eq!(driver.session.firmware(), None);
}

#[test]
fn a_firmware_version_too_short_is_malformed() {
    let mut driver = Driver::new(ANY);
    driver.discovered(0, everything());
    let actions = driver.handle(502, Event::Read(&FIRMWARE[..7]));
    assert_eq!(actions, [Action::Disconnect]);
    let Counters {
        malformed,
        failed_set_ups,
        ..
    } = driver.session.counters();
    assert_eq!((malformed, failed_set_ups), (1, 1));
}

#[test]
fn emg_that_overtakes_the_answer_to_its_mode_counts() {
    let mut driver = Driver::new(ANY);
    driver.discovered(0, everything());
    let answers = [Event::Read(&FIRMWARE), Event::Read(&[80])];
    for answer in answers.into_iter().chain([Event::Done; 5]) {
        driver.handle(502, answer);
    }
    // The mode is not written yet: this is of no stream.
    assert_eq!(driver.emg(502, 3), []);
    assert_eq!(driver.handle(503, Event::Done), [SET_MODE]);
    assert_eq!(driver.emg(504, 0), [deliver(0)]);
    assert_eq!(driver.handle(505, Event::Done), []);
    assert_eq!(driver.emg(514, 1), [deliver(1)]);
    let counters = driver.session.counters();
    assert_eq!((counters.foreign, counters.notifications), (1, 2));
}

#[test]
fn never_sleep_is_written_every_ten_seconds() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    let mut written = Vec::new();
    for number in 0..3_200 {
        let now = 501 + 10 * number;
        for action in driver.emg(now, number) {
            if action == NEVER_SLEEP {
                written.push(now - 501);
                assert_eq!(driver.handle(now, Event::Done), []);
            }
        }
    }
    assert_eq!(written, [10_000, 20_000, 30_000]);
}

#[test]
fn a_write_that_is_never_answered_ends_the_stream() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    let mut end = Vec::new();
    for number in 0..1_501 {
        end = driver.emg(501 + 10 * number, number);
        end.retain(|action| !matches!(action, Action::Deliver(_)));
    }
    assert_eq!(end, [Action::Disconnect, Action::StreamEnded]);
    assert_eq!(driver.session.counters().timeouts, 1);
}

#[test]
fn a_silent_stream_gets_its_mode_again_once_and_is_then_closed() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    assert_eq!(driver.emg(510, 0), [deliver(0)]);
    driver.run(&[
        (1_009, Event::Tick, &[]),
        (1_010, Event::Tick, &[SET_MODE]),
        (1_011, Event::Done, &[]),
        (1_509, Event::Tick, &[]),
        (
            1_510,
            Event::Tick,
            &[Action::Disconnect, Action::StreamEnded],
        ),
        (1_520, Event::Disconnected, &[]),
        (1_819, Event::Tick, &[]),
        (1_820, Event::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().stalls, 1);
}

#[test]
fn a_stream_that_resumes_after_the_mode_was_set_again_has_a_gap() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    for number in 0..10 {
        assert_eq!(driver.emg(510 + 10 * number, number).len(), 1);
    }
    assert_eq!(driver.handle(1_100, Event::Tick), [SET_MODE]);
    assert_eq!(driver.handle(1_101, Event::Done), []);
    // 510 ms of silence: 51 were lost, and the next six cannot be placed.
    let resumed: Vec<_> = (0..10)
        .map(|n| driver.emg(1_120 + 10 * n, 61 + n))
        .collect();
    let actions: Vec<_> = resumed.concat();
    let missing = 2 * (51 + 6);
    let expected = [
        Action::Gap { missing },
        deliver(67),
        deliver(68),
        deliver(69),
        deliver(70),
    ];
    assert_eq!(actions, expected);
    assert_eq!(driver.session.counters().given_up, 12);
    // Once per silence, not once per stream.
    assert_eq!(driver.handle(1_710, Event::Tick), [SET_MODE]);
}

#[test]
fn short_long_and_foreign_values_are_handled_and_counted() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    let mut notify = |now, characteristic, bytes: &[u8]| {
        driver.handle(
            now,
            Event::Notification {
                characteristic,
                bytes,
            },
        )
    };
    assert_eq!(notify(510, lane(0), &[0; 16]), [deliver(0)]);
    assert_eq!(notify(520, lane(1), &[1; 15]), []); // short: counts as lost
    assert_eq!(notify(530, lane(2), &[2; 20]), []); // long: its first 16 bytes
    let recovered = [Action::Gap { missing: 2 }, deliver(2), deliver(3)];
    assert_eq!(notify(540, lane(3), &[3; 16]), recovered);
    assert_eq!(notify(541, Characteristic::Command, &[3; 16]), []);
    assert_eq!(notify(542, BatteryLevel, &[]), []);
    assert_eq!(notify(543, BatteryLevel, &[10]), []);
    let session = &driver.session;
    assert_eq!(
        (session.battery(), session.battery_is_low()),
        (Some(10), true)
    );
    let Counters {
        malformed,
        foreign,
        lost,
        ..
    } = session.counters();
    assert_eq!((malformed, foreign, lost), (2, 1, 2));
}

#[test]
fn malformed_emg_alone_counts_as_silence() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    let characteristic = lane(0);
    let bytes = &[0; 3];
    let malformed = Event::Notification {
        characteristic,
        bytes,
    };
    let actions: Vec<_> = (0..110)
        .map(|n| driver.handle(501 + 10 * n, malformed))
        .collect();
    assert_eq!(
        actions.concat(),
        [SET_MODE, Action::Disconnect, Action::StreamEnded]
    );
}

#[test]
fn a_new_connection_starts_a_new_stream() {
    let mut driver = Driver::new(ANY);
    driver.streaming(0);
    for number in 0..3 {
        driver.emg(510 + 10 * number, number);
    }
    assert_eq!(
        driver.handle(540, Event::Disconnected),
        [Action::StreamEnded]
    );
    assert_eq!(driver.session.battery(), Some(80)); // the last known value
    driver.streaming(840);
    // On any lane, without a gap: `StreamEnded` has reported the loss.
    assert_eq!(driver.emg(1_350, 2), [deliver(2)]);
    assert_eq!(driver.session.counters().lost, 0);
}

#[test]
fn time_may_wrap_in_any_phase() {
    let mut driver = Driver::new(ANY);
    let start = u32::MAX - 400;
    assert_eq!(driver.handle(start, Event::Tick), [Action::Scan]);
    assert_eq!(driver.advertise(start, NEAR, -40), []);
    assert_eq!(driver.handle(98, Event::Tick), []);
    let connect = [Action::StopScan, Action::Connect(NEAR)];
    assert_eq!(driver.handle(99, Event::Tick), connect);
}
