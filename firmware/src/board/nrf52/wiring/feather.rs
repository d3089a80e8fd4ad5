//! Adafruit's Feather nRF52840 Express, also the Sense.
//!
//! Source: `variants/feather_nrf52840_express/variant.cpp` of Adafruit_nRF52_Arduino and `board.h` of the board in
//! Adafruit_nRF52_Bootloader; Adafruit's guide of the board, "Pinouts", for the divider.
//!
//! The board has two LEDs: one from D6 to ground shows an alignment, and so do `$ALIGN` lines. Left alone: P0.16, the colour LED;
//! P0.31, the reference of the converter; P0.10 (D2), an antenna's.

use embassy_nrf::gpio::Level;

pub const LED_ON: Level = Level::High;
/// Battery's voltage over what the pin sees: 100 kOhm each.
pub const DIVIDER: (u32, u32) = (2, 1);

macro_rules! pins {
    ($p:ident) => {
        Pins {
            // A0 to A5.
            intents: [
                $p.P0_04.into(),
                $p.P0_05.into(),
                $p.P0_30.into(),
                $p.P0_28.into(),
                $p.P0_02.into(),
                $p.P0_03.into(),
            ],
            // D5.
            valid: $p.P1_08.into(),
            // D9.
            strength: $p.P0_26.into(),
            // Red, blue, D6.
            leds: [$p.P1_15.into(), $p.P1_10.into(), $p.P0_07.into()],
            // The user switch.
            button: $p.P1_02.into(),
            // TX, RX.
            tx: $p.P0_25.into(),
            rx: $p.P0_24.into(),
            battery: $p.P0_29.degrade_saadc(),
            divider: None,
        }
    };
}
pub(super) use pins;
