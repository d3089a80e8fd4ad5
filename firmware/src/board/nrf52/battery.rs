//! The board's own battery: its voltage, by the converter and the divider that the board has.

use embassy_nrf::{
    Peri, bind_interrupts,
    gpio::Output,
    interrupt::{self, InterruptExt as _, Priority},
    peripherals::SAADC,
    saadc::{self, AnyInput, ChannelConfig, Config, Saadc, Time},
};

use super::wiring::DIVIDER;

bind_interrupts!(struct Interrupts {
    SAADC => saadc::InterruptHandler;
});

/// Input at which the converter is at its end: 0.6 V of reference by a gain of 1/6.
const RANGE_MV: u32 = 3600;
/// Values of the converter: 12 bits.
const VALUES: u32 = 1 << 12;

/// Parts that measure it.
pub struct Parts {
    pub converter: Peri<'static, SAADC>,
    pub input: AnyInput<'static>,
    /// Keeps the divider in use.
    pub _divider: Option<Output<'static>>,
}

pub struct Battery(Parts);

impl Battery {
    pub fn start(parts: Parts) -> Self {
        interrupt::SAADC.set_priority(Priority::P3);
        Self(parts)
    }

    /// Measures its voltage, millivolts. The converter is off between two measurements.
    pub async fn millivolts(&mut self) -> u32 {
        let mut channel = ChannelConfig::single_ended(self.0.input.reborrow());
        // Up to 800 kOhm before the pin (nRF52840 product specification, SAADC, "Acquisition time").
        channel.time = Time::_40US;
        let converter = self.0.converter.reborrow();
        let mut converter = Saadc::new(converter, Interrupts, Config::default(), [channel]);
        let mut value = [0];
        converter.sample(&mut value).await;
        let [value] = value;
        // Noise about 0 may be negative.
        let value = u32::try_from(value).unwrap_or(0);
        value * RANGE_MV / VALUES * DIVIDER.0 / DIVIDER.1
    }
}
