//! Tests of the choice of the armband that is followed.

use super::*;

/// Actions of a session that scans from 0 while two armbands advertise for two seconds, this one and a stronger one.
fn after_two_armbands(driver: &mut Driver) -> Vec<Action> {
    let mut actions = driver.handle(0, MyoEvent::Tick);
    for now in (100..2000).step_by(100) {
        actions.extend(driver.advertise(now, NEAR, -60));
        actions.extend(driver.advertise(now, FAR, -20));
        actions.extend(driver.handle(now, MyoEvent::Tick));
    }
    actions
}

#[test]
fn without_an_address_nobodys_armband_is_followed() {
    let mut driver = Driver::new(Settings::default());
    assert_eq!(after_two_armbands(&mut driver), []);
}

const BOUND: Settings = Settings {
    bound: Some(NEAR),
    follow_strongest: false,
    ..ANY
};

#[test]
fn a_bound_armband_is_followed_and_never_a_stronger_one() {
    let mut driver = Driver::new(BOUND);
    let expected = [Action::Scan, Action::StopScan, Action::Connect(NEAR)];
    assert_eq!(after_two_armbands(&mut driver), expected);
    let mut driver = Driver::new(BOUND);
    assert_eq!(driver.handle(0, MyoEvent::Tick), [Action::Scan]);
    for now in (100..20_000).step_by(100) {
        assert_eq!(driver.advertise(now, FAR, -20), []);
    }
    assert_eq!(driver.session.following(), Following::Bound(NEAR));
}

#[test]
fn the_settings_address_wins_over_the_bound_one_and_cannot_be_changed() {
    let mut driver = Driver::new(Settings {
        pinned: Address::parse("FA:00:00:00:00:01").ok(),
        bound: Some(FAR),
        ..ANY
    });
    assert_eq!(driver.handle(0, MyoEvent::Pair), [Action::Scan]);
    assert_eq!(driver.handle(1, MyoEvent::Bind(None)), []);
    assert_eq!(driver.advertise(2, FAR, -20), []);
    assert_eq!(driver.handle(2_000, MyoEvent::Tick), []);
    assert_eq!(driver.session.following(), Following::Pinned(NEAR));
    // At once, and with the address kind of the report, not the assumed one.
    let kind = AddressKind::Random;
    let reported = Address { kind, ..NEAR };
    assert_eq!(driver.advertise(2_001, reported, -90), connect(reported));
}

/// End of a pairing that has found this armband.
const BINDS: [Action; 3] = [
    Action::Keep(Some(NEAR)),
    Action::StopScan,
    Action::Connect(NEAR),
];

#[test]
fn a_pairing_binds_the_strongest_armband_of_30_seconds() {
    let mut driver = Driver::new(Settings::default());
    driver.run(&[
        (0, MyoEvent::Tick, &[]),
        (1_000, MyoEvent::Pair, &[Action::Scan]),
        (2_000, MyoEvent::Tick, &[]),
    ]);
    assert_eq!(driver.session.following(), Following::Pairing);
    assert_eq!(driver.advertise(3_000, FAR, -50), []);
    assert_eq!(driver.advertise(30_900, NEAR, -40), []);
    assert_eq!(driver.advertise(30_950, address(3), -45), []);
    driver.run(&[
        (30_999, MyoEvent::Tick, &[]),
        (31_000, MyoEvent::Tick, &BINDS),
    ]);
    assert_eq!(driver.session.following(), Following::Bound(NEAR));
    assert!(!driver.session.pairing_failed());
    // From now on it is the only one.
    driver.run(&[(31_100, MyoEvent::ConnectFailed, &[])]);
    driver.run(&[(31_400, MyoEvent::Tick, &[Action::Scan])]);
    assert_eq!(driver.advertise(31_500, FAR, -1), []);
}

#[test]
fn a_pairing_without_an_armband_changes_nothing() {
    let anew = [Action::StopScan, Action::Scan];
    for (settings, after, ends) in [
        (Settings::default(), Following::Nobody, &anew[..1]),
        (BOUND, Following::Bound(NEAR), &anew),
    ] {
        let mut driver = Driver::new(settings);
        driver.handle(0, MyoEvent::Tick);
        driver.handle(1_000, MyoEvent::Pair);
        assert_eq!(driver.handle(2_000, NO_ARMBAND), []);
        assert_eq!(driver.handle(31_000, MyoEvent::Tick), ends);
        assert_eq!(driver.session.following(), after);
        assert!(driver.session.pairing_failed());
    }
}

#[test]
fn a_pairing_ends_a_stream_and_hears_its_armband_too() {
    let mut driver = Driver::new(BOUND);
    assert_eq!(driver.handle(0, MyoEvent::Tick), [Action::Scan]);
    assert_eq!(driver.advertise(1, NEAR, -50), connect(NEAR));
    driver.run(&[
        (2, MyoEvent::Connected, &[Action::Discover]),
        (3, MyoEvent::Pair, &[Action::Disconnect]),
        (4, MyoEvent::Disconnected, &[]),
        (303, MyoEvent::Tick, &[]),
        (304, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.advertise(400, NEAR, -50), []);
    assert_eq!(driver.handle(30_003, MyoEvent::Tick), BINDS);
}

#[test]
fn a_scan_that_ends_during_a_pairing_is_repeated_and_forgets_nobody() {
    let mut driver = Driver::new(Settings::default());
    driver.run(&[(0, MyoEvent::Pair, &[Action::Scan])]);
    assert_eq!(driver.advertise(100, NEAR, -50), []);
    driver.run(&[
        (200, MyoEvent::ScanEnded, &[]),
        (500, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.handle(30_000, MyoEvent::Tick), BINDS);
}

#[test]
fn binding_and_forgetting_end_the_connection_first() {
    let mut driver = streaming();
    let ended = [
        Action::Keep(Some(FAR)),
        Action::Disconnect,
        Action::StreamEnded,
    ];
    driver.run(&[
        (600, MyoEvent::Bind(Some(FAR)), &ended),
        (610, MyoEvent::Disconnected, &[]),
        (910, MyoEvent::Tick, &[Action::Scan]),
    ]);
    assert_eq!(driver.advertise(1_000, NEAR, -10), []);
    assert_eq!(driver.advertise(1_100, FAR, -90), connect(FAR));

    // A scan that goes on is interrupted too: the armband is kept in between.
    let mut driver = Driver::new(BOUND);
    let anew = [Action::Keep(Some(FAR)), Action::StopScan, Action::Scan];
    driver.run(&[
        (0, MyoEvent::Tick, &[Action::Scan]),
        (1, MyoEvent::Bind(Some(FAR)), &anew),
    ]);
    assert_eq!(driver.advertise(2, NEAR, -10), []);

    let mut driver = Driver::new(BOUND);
    let forgotten = [Action::Keep(None), Action::StopScan];
    driver.run(&[
        (0, MyoEvent::Tick, &[Action::Scan]),
        (1, MyoEvent::Bind(None), &forgotten),
    ]);
    assert_eq!(driver.session.phase(), Phase::Unbound);
    assert_eq!(driver.advertise(2, NEAR, -10), []);
    driver.run(&[(100_000, MyoEvent::Tick, &[])]);
}
