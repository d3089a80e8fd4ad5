//! Scans, the choice of an armband, and connections that fail.

use super::*;

#[test]
fn the_strongest_armband_of_half_a_second_wins() {
    let mut driver = Driver::new(ANY);
    driver.run(&[
        (0, MyoEvent::Tick, &[Action::Scan]),
        (9_000, MyoEvent::Tick, &[]),
    ]);
    assert_eq!(driver.handle(9_100, NO_ARMBAND), []);
    assert_eq!(driver.advertise(10_000, FAR, -80), []);
    assert_eq!(driver.advertise(10_100, address(3), 127), []); // signal strength unknown
    assert_eq!(driver.advertise(10_200, NEAR, -50), []);
    assert_eq!(driver.advertise(10_499, address(4), -60), []);
    assert_eq!(driver.handle(10_500, MyoEvent::Tick), connect(NEAR));
    assert_eq!(driver.advertise(10_501, address(5), -1), []);
}

#[test]
fn a_scan_that_ends_is_repeated_after_a_delay() {
    let mut driver = Driver::new(ANY);
    driver.run(&[
        (0, MyoEvent::Tick, &[Action::Scan]),
        (10, MyoEvent::ScanEnded, &[]),
        (309, MyoEvent::Tick, &[]),
        (310, MyoEvent::Tick, &[Action::Scan]),
    ]);
    // With an armband received before, that one is taken.
    assert_eq!(driver.advertise(320, FAR, -80), []);
    assert_eq!(driver.handle(330, MyoEvent::ScanEnded), connect(FAR));
}

#[test]
fn failed_connects_back_off_up_to_five_seconds() {
    let mut driver = Driver::new(ANY);
    let mut now = 0;
    for delay in [300, 600, 1200, 2400, 4800, 5000, 5000] {
        driver.connecting(now);
        now += 510;
        assert_eq!(driver.handle(now, MyoEvent::ConnectFailed), []);
        assert_eq!(driver.session.phase(), Phase::BackingOff);
        assert_eq!(driver.handle(now + delay - 1, MyoEvent::Tick), []);
        now += delay;
    }
    assert_eq!(driver.session.counters().failed_connects, 7);
}

#[test]
fn a_stream_that_ran_makes_the_next_delay_short() {
    let mut driver = Driver::new(ANY);
    for now in [0, 1_000, 2_500] {
        driver.connecting(now);
        driver.handle(now + 510, MyoEvent::ConnectFailed);
    }
    driver.streaming(5_000);
    assert_eq!(driver.emg(5_510, 0), [deliver(0)]);
    driver.run(&[
        (5_520, MyoEvent::Disconnected, &[Action::StreamEnded]),
        (5_521, MyoEvent::Disconnected, &[]),
        (5_819, MyoEvent::Tick, &[]),
    ]);
    driver.streaming(5_820);
    assert_eq!(driver.session.counters().connections, 2);
}

#[test]
fn a_stream_without_emg_ends_too_and_backs_off_longer() {
    let mut driver = streaming();
    driver.run(&[(510, MyoEvent::Disconnected, &[Action::StreamEnded])]);
    driver.streaming(810);
    driver.run(&[
        (1_320, MyoEvent::Disconnected, &[Action::StreamEnded]),
        (1_919, MyoEvent::Tick, &[]),
        (1_920, MyoEvent::Tick, &[Action::Scan]),
    ]);
}

#[test]
fn an_operation_that_is_not_answered_ends_the_connection() {
    let mut driver = Driver::new(ANY);
    driver.connecting(0);
    driver.run(&[
        (5_499, MyoEvent::Tick, &[]),
        (5_500, MyoEvent::Tick, &[Action::Disconnect]),
        (5_501, MyoEvent::Connected, &[]), // too late: it is being closed
        (5_510, MyoEvent::ConnectFailed, &[]),
    ]);
    driver.discovered(5_810, everything());
    driver.run(&[
        (11_310, MyoEvent::Tick, &[]),
        (11_311, MyoEvent::Tick, &[Action::Disconnect]),
        (11_312, MyoEvent::Read(&FIRMWARE), &[]),
        (11_320, MyoEvent::Disconnected, &[]),
        (11_919, MyoEvent::Tick, &[]),
        (11_920, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.session.counters().timeouts, 2);
}

#[test]
fn a_connection_that_does_not_end_is_waited_for_5_s() {
    let mut driver = Driver::new(ANY);
    driver.connecting(0);
    driver.run(&[
        (5_500, MyoEvent::Tick, &[Action::Disconnect]),
        (10_500, MyoEvent::Tick, &[]),
        (10_800, MyoEvent::Tick, &[Action::Scan]),
        // The connection is established after all, too late.
        (10_900, MyoEvent::Connected, &[Action::Disconnect]),
        (10_901, MyoEvent::Disconnected, &[]),
    ]);
    assert_eq!(driver.session.phase(), Phase::Scanning);
}
