//! Lengths of the pulses that tell a hand the strength.

use shared::intent::Intent;
use shared::stream::safe_state::Status;
use shared::stream::strength::Percent;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pulses {
    /// A motor's driver: 1 kHz; the share of a period is the strength of the label, whichever it is.
    Pwm,
    /// A servo: 50 Hz; 1.5 ms, up to 0.5 ms less in open, up to 0.5 ms more in close.
    Servo,
}

impl Pulses {
    pub const fn period_us(self) -> u16 {
        match self {
            Self::Pwm => 1000,
            Self::Servo => 20_000,
        }
    }

    /// Microseconds of a pulse; none while the label is not valid.
    pub fn high_us(self, status: Status, strength: Percent) -> Option<u16> {
        const MIDDLE: u16 = 1500;
        let percent = u16::from(strength.get());
        let high_us = match (self, status.label()) {
            (Self::Pwm, _) => 10 * percent,
            (Self::Servo, Intent::Open) => MIDDLE - 5 * percent,
            (Self::Servo, Intent::Close) => MIDDLE + 5 * percent,
            (Self::Servo, _) => MIDDLE,
        };
        status.valid().then_some(high_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::stream::safe_state::Cause;

    #[test]
    fn pulses_follow_label_and_strength_and_end_in_the_safe_state() {
        let half = Percent::new(50).expect("at most 100");
        let of = |pulses: Pulses, status| pulses.high_us(status, half);
        let [relax, open, close, pinch] =
            [Intent::Relax, Intent::Open, Intent::Close, Intent::Pinch].map(Status::Valid);
        assert_eq!(of(Pulses::Pwm, open), Some(500));
        assert_eq!(of(Pulses::Pwm, pinch), Some(500));
        assert_eq!(Pulses::Pwm.high_us(relax, Percent::ZERO), Some(0));
        assert_eq!(of(Pulses::Servo, open), Some(1250));
        assert_eq!(of(Pulses::Servo, close), Some(1750));
        assert_eq!(of(Pulses::Servo, relax), Some(1500));
        for pulses in [Pulses::Pwm, Pulses::Servo] {
            assert_eq!(of(pulses, Status::Safe(Cause::Silence)), None);
            let full = Percent::new(100).expect("at most 100");
            assert!(pulses.high_us(close, full) <= Some(pulses.period_us()));
        }
    }
}
