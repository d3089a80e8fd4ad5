//! Nordic's development kit for the nRF52840, PCA10056. Its debugger connects the UART to USB.
//!
//! Source: the kit's user guide, "Buttons and LEDs" and "Virtual COM port". The label pins are free on the headers; none is a
//! button's, which would short a high output to ground.

use embassy_nrf::gpio::Level;

pub const LED_ON: Level = Level::Low;

macro_rules! pins {
    ($p:ident) => {
        Pins {
            intents: [
                $p.P1_01.into(),
                $p.P1_02.into(),
                $p.P1_03.into(),
                $p.P1_04.into(),
                $p.P1_05.into(),
                $p.P1_06.into(),
            ],
            valid: $p.P1_07.into(),
            strength: $p.P1_08.into(),
            // LED 1 to 3, and button 1.
            leds: [$p.P0_13.into(), $p.P0_14.into(), $p.P0_15.into()],
            button: $p.P0_11.into(),
            tx: $p.P0_06.into(),
            rx: $p.P0_08.into(),
        }
    };
}
pub(super) use pins;
