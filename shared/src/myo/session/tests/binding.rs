//! Which armband is followed.

use super::*;

/// What a session does that scans from 0 while armbands advertise for two seconds, this one and a stronger one.
fn after_two_armbands(driver: &mut Driver) -> Vec<Action> {
    let mut actions = driver.handle(0, Event::Tick);
    for now in (100..2000).step_by(100) {
        actions.extend(driver.advertise(now, NEAR, -60));
        actions.extend(driver.advertise(now, FAR, -20));
        actions.extend(driver.handle(now, Event::Tick));
    }
    actions
}

#[test]
fn without_an_address_nobodys_armband_is_followed() {
    let mut driver = Driver::new(Settings::default());
    assert_eq!(after_two_armbands(&mut driver), []);
}
