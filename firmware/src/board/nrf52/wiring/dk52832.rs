//! Nordic's development kit for the nRF52832, PCA10040. Its debugger connects the UART to USB.
//!
//! Source: the kit's user guide, "Buttons and LEDs" and "Virtual COM port". The label pins are free on the headers; none is a
//! button's, which would short a high output to ground.

use embassy_nrf::gpio::Level;

pub const LED_ON: Level = Level::Low;

macro_rules! pins {
    ($p:ident) => {
        Pins {
            intents: [
                $p.P0_11.into(),
                $p.P0_12.into(),
                $p.P0_22.into(),
                $p.P0_23.into(),
                $p.P0_24.into(),
                $p.P0_25.into(),
            ],
            valid: $p.P0_26.into(),
            strength: $p.P0_27.into(),
            // LED 1 to 3, and button 1.
            leds: [$p.P0_17.into(), $p.P0_18.into(), $p.P0_19.into()],
            button: $p.P0_13.into(),
            tx: $p.P0_06.into(),
            rx: $p.P0_08.into(),
        }
    };
}
pub(super) use pins;
