//! A stream: kept awake, silent, resumed, and its malformed values.

use super::*;

#[test]
fn emg_that_overtakes_the_answer_to_its_mode_counts() {
    let mut driver = discovered();
    for answer in answers(5) {
        driver.handle(502, answer);
    }
    // The mode is not written yet: this is of no stream.
    assert_eq!(driver.emg(502, 3), []);
    assert_eq!(driver.handle(503, MyoEvent::Done), [SET_MODE]);
    assert_eq!(driver.emg(504, 0), [deliver(0)]);
    assert_eq!(driver.handle(505, MyoEvent::Done), []);
    assert_eq!(driver.emg(514, 1), [deliver(1)]);
    let counters = driver.session.counters();
    assert_eq!((counters.foreign, counters.notifications), (1, 2));
}

#[test]
fn never_sleep_is_written_every_ten_seconds() {
    let mut driver = streaming();
    let mut written = Vec::new();
    for number in 0..3_200 {
        let now = 501 + 10 * number;
        for action in driver.emg(now, number) {
            if action == NEVER_SLEEP {
                written.push(now - 501);
                assert_eq!(driver.handle(now, MyoEvent::Done), []);
            }
        }
    }
    assert_eq!(written, [10_000, 20_000, 30_000]);
}

#[test]
fn a_write_that_is_never_answered_ends_the_stream() {
    let mut driver = streaming();
    let mut end = Vec::new();
    for number in 0..1_501 {
        end = driver.emg(501 + 10 * number, number);
        end.retain(|action| !matches!(action, Action::Deliver(_)));
    }
    assert_eq!(end, CLOSED);
    assert_eq!(driver.session.counters().timeouts, 1);
}

#[test]
fn a_silent_stream_gets_its_mode_again_once_and_is_then_closed() {
    let mut driver = streaming();
    assert_eq!(driver.emg(510, 0), [deliver(0)]);
    driver.run(&[
        (1_009, MyoEvent::Tick, &[]),
        (1_010, MyoEvent::Tick, &[SET_MODE]),
        (1_011, MyoEvent::Done, &[]),
        (1_509, MyoEvent::Tick, &[]),
        (1_510, MyoEvent::Tick, &CLOSED),
        (1_520, MyoEvent::Disconnected, &[]),
        (1_819, MyoEvent::Tick, &[]),
        (1_820, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().stalls, 1);
}

#[test]
fn an_armband_may_begin_three_seconds_after_its_mode_is_set() {
    // Its first notification is awaited for four seconds, and as long again once the mode was set again.
    for (first, due) in [(3_501, 4_001), (7_501, 8_001)] {
        let mut driver = streaming();
        let mut actions = Vec::new();
        for now in (501..first).step_by(50) {
            let action = driver.handle(now, MyoEvent::Tick);
            actions.extend(action);
        }
        let mode: &[Action] = if first > 4_501 { &[SET_MODE] } else { &[] };
        assert_eq!(actions, mode);
        driver.handle(first, MyoEvent::Done);
        assert_eq!(driver.emg(first, 0), [deliver(0)]);
        assert_eq!(driver.handle(due - 1, MyoEvent::Tick), []);
        assert_eq!(driver.handle(due, MyoEvent::Tick), [SET_MODE]);
    }
    let mut driver = streaming();
    assert_eq!(driver.handle(4_501, MyoEvent::Tick), [SET_MODE]);
    assert_eq!(driver.handle(4_502, MyoEvent::Done), []);
    assert_eq!(driver.handle(8_500, MyoEvent::Tick), []);
    assert_eq!(driver.handle(8_501, MyoEvent::Tick), CLOSED);
}

#[test]
fn a_stream_that_resumes_after_the_mode_was_set_again_has_a_gap() {
    let mut driver = streaming();
    for number in 0..10 {
        assert_eq!(driver.emg(510 + 10 * number, number).len(), 1);
    }
    assert_eq!(driver.handle(1_100, MyoEvent::Tick), [SET_MODE]);
    assert_eq!(driver.handle(1_101, MyoEvent::Done), []);
    // 510 ms of silence: 51 were lost, and the next six cannot be placed.
    let resumed = (0..10).flat_map(|n| driver.emg(1_120 + 10 * n, 61 + n));
    let missing = 2 * (51 + 6);
    let delivered = [67, 68, 69, 70].map(deliver);
    let expected = [&[Action::Gap { missing }][..], &delivered].concat();
    assert_eq!(resumed.collect::<Vec<_>>(), expected);
    assert_eq!(driver.session.counters().given_up, 12);
    // Once per silence, not once per stream.
    assert_eq!(driver.handle(1_710, MyoEvent::Tick), [SET_MODE]);
}

#[test]
fn short_long_and_foreign_values_are_handled_and_counted() {
    let mut driver = streaming();
    let mut notify =
        |now, characteristic, bytes: &[u8]| driver.handle(now, notification(characteristic, bytes));
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
    let counters = session.counters();
    assert_eq!(
        (counters.malformed, counters.foreign, counters.lost),
        (2, 1, 2)
    );
}

#[test]
fn malformed_emg_alone_counts_as_silence() {
    let mut driver = streaming();
    let malformed = notification(lane(0), &[0; 3]);
    let actions = (0..110).flat_map(|n| driver.handle(501 + 10 * n, malformed));
    let expected = [&[SET_MODE][..], &CLOSED].concat();
    assert_eq!(actions.collect::<Vec<_>>(), expected);
}

#[test]
fn a_new_connection_starts_a_new_stream() {
    let mut driver = streaming();
    for number in 0..3 {
        driver.emg(510 + 10 * number, number);
    }
    driver.run(&[(540, MyoEvent::Disconnected, &[Action::StreamEnded])]);
    assert_eq!(driver.session.battery(), Some(80)); // the last known value
    driver.streaming(840);
    // On any lane, without a gap: `StreamEnded` has reported the loss.
    assert_eq!(driver.emg(1_350, 2), [deliver(2)]);
    assert_eq!(driver.session.counters().lost, 0);
}

const SUBSCRIBE_IMU: Action = Action::Subscribe(Imu);
const WITH_IMU: Action = write(ArmbandCommand::SetMode(EmgMode::Filtered, true));

/// A movement of all ones.
const MOVEMENT: MyoEvent<'_> = notification(Imu, &[1; 20]);
const MOVED: Action = Action::Imu(crate::myo::Imu([0x0101; 10]));

#[test]
fn the_imu_is_subscribed_to_and_set_in_the_mode_once_the_stream_runs_and_ends_with_the_wish() {
    let mut driver = streaming();
    // Nobody has asked.
    assert_eq!(driver.handle(502, MOVEMENT), []);
    assert_eq!(driver.session.counters().foreign, 1);
    driver.session.set_imu(true);
    assert_eq!(driver.emg(510, 0), [deliver(0), SUBSCRIBE_IMU]);
    driver.run(&[
        (520, MyoEvent::Tick, &[]),
        (521, MyoEvent::Done, &[WITH_IMU]),
        (522, MyoEvent::Done, &[]),
        (530, MOVEMENT, &[MOVED]),
    ]);
    assert_eq!(driver.emg(540, 1), [deliver(1)]);
    let short = notification(Imu, &[1; 19]);
    assert_eq!(driver.handle(550, short), []);
    assert_eq!(driver.session.counters().malformed, 1);
    driver.session.set_imu(false);
    driver.run(&[
        (560, MOVEMENT, &[SET_MODE]),
        (561, MyoEvent::Done, &[]),
        (570, MyoEvent::Tick, &[]),
    ]);
    driver.session.set_imu(true);
    driver.run(&[
        (580, MyoEvent::Tick, &[WITH_IMU]),
        (581, MyoEvent::Done, &[]),
    ]);
}

#[test]
fn a_session_with_the_imu_asks_for_it_in_every_stream_and_its_movement_is_no_sign_of_life() {
    let mut driver = Driver::new(Settings { imu: true, ..ANY });
    driver.discovered(0, everything());
    for answer in answers(6) {
        driver.handle(502, answer);
    }
    driver.run(&[
        (503, MyoEvent::Done, &[SUBSCRIBE_IMU]),
        (504, MyoEvent::Failed, &[WITH_IMU]),
        (505, MyoEvent::Done, &[]),
    ]);
    assert_eq!(driver.emg(510, 0), [deliver(0)]);
    // The mode that is set again has the IMU too.
    driver.run(&[
        (1_009, MOVEMENT, &[MOVED]),
        (1_010, MyoEvent::Tick, &[WITH_IMU]),
        (1_011, MyoEvent::Done, &[]),
        (1_510, MOVEMENT, &[MOVED, CLOSED[0], CLOSED[1]]),
        (1_511, MOVEMENT, &[]),
    ]);
}
