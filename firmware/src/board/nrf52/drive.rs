//! The strength as pulses at a pin, by PWM0. The dead-man timer stops them; the period in progress ends before.

use core::sync::atomic::{AtomicU16, Ordering};

use embassy_nrf::{
    Peri,
    gpio::AnyPin,
    pac,
    peripherals::PWM0,
    ppi::Task,
    pwm::{Config, Prescaler, SequencePwm},
};

use crate::settings::PULSES;

/// Value that the peripheral reads: microseconds for which the pin is high, in each period.
static HIGH_US: AtomicU16 = AtomicU16::new(0);
/// Bit of a value whose pulse begins with the period.
const FIRST_EDGE_FALLS: u16 = 1 << 15;

pub struct Parts {
    pub pwm: Peri<'static, PWM0>,
    pub pin: Peri<'static, AnyPin>,
}

/// Pulses at a pin, or a low level.
pub struct Drive {
    pwm: SequencePwm<'static>,
    runs: bool,
    /// Told to stop, in a period that may not be over.
    stops: bool,
}

impl Drive {
    /// Takes the pin, which stays low.
    pub fn start(parts: Parts) -> Self {
        let mut config = Config::default();
        // Counts of a microsecond.
        config.prescaler = Prescaler::Div16;
        config.max_duty = PULSES.period_us();
        let Ok(pwm) = SequencePwm::new_1ch(parts.pwm, parts.pin, config) else {
            unreachable!("no configuration is refused")
        };
        let sequence = pac::PWM0.dma().seq(0);
        sequence.ptr().write_value(HIGH_US.as_ptr() as u32);
        sequence.maxcnt().write(|count| count.0 = 1);
        sequence.refresh().write(|refresh| refresh.0 = 0);
        pac::PWM0.enable().write(|enable| enable.set_enable(true));
        Self {
            pwm,
            runs: false,
            stops: false,
        }
    }

    /// Task that ends the pulses, for the interconnect.
    #[expect(unsafe_code, reason = "a sequence must not change while it runs")]
    pub fn stop_task(&self) -> Task<'static> {
        // SAFETY: the task ends the sequence; its one value stays where it is for good.
        unsafe { self.pwm.task_stop() }
    }

    /// Makes pulses of this length from the next period on; `None` ends them with the period.
    pub fn set(&mut self, high_us: Option<u16>) {
        self.stops &= pac::PWM0.events_stopped().read() == 0;
        match high_us {
            None if self.runs => {
                pac::PWM0.tasks_stop().write_value(1);
                self.stopped();
            }
            // A start in the last period of another: the next strength, 50 ms later, begins it.
            Some(high_us) if !self.stops => {
                if !self.runs {
                    pac::PWM0.events_stopped().write_value(0);
                }
                HIGH_US.store(FIRST_EDGE_FALLS | high_us, Ordering::SeqCst);
                // By the core, which is awake while the value is read: erratum 109 of the nRF52832.
                pac::PWM0.tasks_dma().seq(0).start().write_value(1);
                self.runs = true;
            }
            _ => {}
        }
    }

    /// Notes that it was told to stop, by whomever.
    pub fn stopped(&mut self) {
        self.stops |= self.runs;
        self.runs = false;
    }
}
