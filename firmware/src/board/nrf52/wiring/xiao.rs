//! Seeed's XIAO nRF52840, also the Sense and the Plus.
//!
//! Source: `variants/Seeed_XIAO_nRF52840/variant.cpp` of Adafruit_nRF52_Arduino, and Seeed's wiki page of the board ("What
//! are the considerations when using XIAO nRF52840 (Sense) for battery charging?").
//!
//! The board has no button but reset: one between D10 and ground begins an alignment or a pairing, and so do commands.
//! Left alone: P0.13, the current of the charger; P0.17, its state; P1.08, the supply of the Sense's motion sensor.

use embassy_nrf::gpio::Level;

/// Level that lights a colour of the board's LED.
pub const LED_ON: Level = Level::Low;
/// Battery's voltage over what the pin sees: 1 MOhm above 510 kOhm.
pub const DIVIDER: (u32, u32) = (1510, 510);

macro_rules! pins {
    ($p:ident) => {
        Pins {
            // D0 to D5.
            intents: [
                $p.P0_02.into(),
                $p.P0_03.into(),
                $p.P0_28.into(),
                $p.P0_29.into(),
                $p.P0_04.into(),
                $p.P0_05.into(),
            ],
            // D8.
            valid: $p.P1_13.into(),
            // D9.
            strength: $p.P1_14.into(),
            // Green, blue, red.
            leds: [$p.P0_30.into(), $p.P0_06.into(), $p.P0_26.into()],
            // D10.
            button: $p.P1_15.into(),
            // D6, D7.
            tx: $p.P1_11.into(),
            rx: $p.P1_12.into(),
            battery: $p.P0_31.degrade_saadc(),
            // The lower end of the divider. Low for good: high, or open, the pin above would see more than the chip's supply.
            divider: Some(Output::new($p.P0_14, Level::Low, OutputDrive::Standard)),
        }
    };
}
pub(super) use pins;
