//! nice!nano 2, and boards with its pins.
//!
//! Source: `boards/arm/nice_nano` of ZMK (`nice_nano.dtsi`, `nice_nano_v2.dts`, `arduino_pro_micro_pins.dtsi`) and `board.h` of
//! the board in Adafruit_nRF52_Bootloader.
//!
//! The board has one LED: others, from 106 and 115 as printed on it to ground, show an armband and an alignment. It has no button but
//! reset: one between 113 and ground begins an alignment or a pairing. Commands and lines do the same. Left alone: P0.13, which
//! switches the pin VCC; P0.09 and P0.10, an antenna's.

use embassy_nrf::gpio::Level;

pub const LED_ON: Level = Level::High;
/// Battery's voltage over what the converter sees: the chip's own divider of VDDH, which is the battery's.
pub const DIVIDER: (u32, u32) = (5, 1);

macro_rules! pins {
    ($p:ident) => {
        Pins {
            // 017, 020, 022, 024, 100, 011 as printed on it.
            intents: [
                $p.P0_17.into(),
                $p.P0_20.into(),
                $p.P0_22.into(),
                $p.P0_24.into(),
                $p.P1_00.into(),
                $p.P0_11.into(),
            ],
            // 104.
            valid: $p.P1_04.into(),
            // 111.
            strength: $p.P1_11.into(),
            // The board's, 106, 115.
            leds: [$p.P0_15.into(), $p.P1_06.into(), $p.P1_15.into()],
            // 113.
            button: $p.P1_13.into(),
            // 006, 008.
            tx: $p.P0_06.into(),
            rx: $p.P0_08.into(),
            battery: VddhDiv5Input.degrade_saadc(),
            divider: None,
        }
    };
}
pub(super) use pins;
