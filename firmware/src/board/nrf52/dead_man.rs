//! The dead-man timer: makes the pins safe without an instruction of the program.
//!
//! ```text
//! inference --clear--> TIMER1 --compare--> PPI channels 0 to 3 --> GPIOTE: every label pin, `valid`; PWM0: the pulses
//! ```
//!
//! The SoftDevices and the controller library take TIMER0, RTC0 and the PPI channels 17 to 31 and leave what is used
//! here (S132 and S140 specifications, hardware peripherals). The timer is fed by the high-frequency clock, the
//! watchdog by the low-frequency one: no clock fails both. The running timer keeps that clock running.

use embassy_nrf::{
    Peri,
    gpiote::OutputChannel,
    peripherals::TIMER1,
    ppi::{AnyConfigurableChannel, Event, Ppi, Task},
    timer::{Cc, Timer},
};
use shared::intent::{Intent, MAX_CLASSES};

use crate::settings::DEAD_MAN_MS;

/// Counts of a microsecond each: the frequency that a new `Timer` has.
const EXPIRES_US: u32 = DEAD_MAN_MS * 1000;
/// Relax rises after the other labels have fallen, as everywhere.
const RELAX_US: u32 = EXPIRES_US + 2;

pub struct Parts {
    pub timer: Peri<'static, TIMER1>,
    pub links: [Peri<'static, AnyConfigurableChannel>; 4],
}

/// A timer that makes the pins safe unless it is cleared in time.
pub struct DeadMan {
    timer: Timer<'static>,
    expiry: Cc<'static>,
}

impl DeadMan {
    /// Starts it, connected to these pins and to the task that ends the pulses.
    pub fn start(
        parts: Parts,
        intents: &[OutputChannel<'static>; MAX_CLASSES],
        valid: &OutputChannel<'static>,
        stop_pulses: Task<'static>,
    ) -> Self {
        const { assert!(Intent::Relax.class() == 0) };
        let timer = Timer::new(parts.timer);
        let (expiry, relax) = (timer.cc(0), timer.cc(1));
        expiry.write(EXPIRES_US);
        relax.write(RELAX_US);
        let expired = expiry.event_compare();
        let [first, second, third, fourth] = parts.links;
        let [relaxed, open, close, wave_in, wave_out, pinch] = intents;
        let mut falls = [
            Ppi::new_one_to_two(first, expired, valid.task_clr(), open.task_clr()),
            Ppi::new_one_to_two(second, expired, close.task_clr(), wave_in.task_clr()),
            Ppi::new_one_to_two(third, expired, wave_out.task_clr(), pinch.task_clr()),
        ];
        let mut rises = Ppi::new_one_to_two(
            fourth,
            relax.event_compare(),
            relaxed.task_set(),
            stop_pulses,
        );
        for fall in &mut falls {
            fall.enable();
        }
        rises.enable();
        // Dropped, they would be disconnected.
        falls.into_iter().for_each(Ppi::persist);
        rises.persist();
        expiry.clear_events();
        timer.start();
        Self { timer, expiry }
    }

    /// Restarts the period.
    pub fn clear(&mut self) {
        self.timer.clear();
    }

    /// Whether the timer has expired since the last [`DeadMan::acknowledge`]: the pins are safe, and stay so.
    pub fn has_expired(&self) -> bool {
        self.expired().is_triggered()
    }

    /// Lets the pins show a valid label again. To be called in the safe state.
    pub fn acknowledge(&mut self) {
        super::pulses_stopped();
        self.expiry.clear_events();
    }

    /// The event, for whoever sets the pins.
    pub fn expired(&self) -> Event<'static> {
        self.expiry.event_compare()
    }
}
