//! Uses of a pin that it does not have: it is the crystal's, an antenna's, the reset's, another peripheral's.

use super::gpio::PIN_CNF;
use super::{Chip, GPIO, gpio, uicr};
use crate::refusal::What;

/// Pins of the low-frequency clock's crystal, XL1 and XL2 (product specification, 7.1).
const CRYSTAL: [u32; 2] = [0, 1];
/// Pins of the antenna of NFC.
const ANTENNA: [u32; 2] = [9, 10];

impl Chip {
    /// Refuses pins whose configuration does not fit what else uses them.
    pub(super) fn check_pins(&mut self) {
        for pin in 0..32 * self.model.ports() {
            if let Some(why) = self.misuse(pin) {
                let register = PIN_CNF + gpio::PORT * (pin / 32) + 4 * (pin % 32);
                self.bus.refuse(GPIO + register, What::Pin { why });
            }
        }
    }

    /// Returns the reason why a pin is not what it is used for, if there is one.
    fn misuse(&self, pin: u32) -> Option<&'static str> {
        let port = &self.ports[pin as usize / 32];
        let channels = self.gpiote.channels(pin);
        let is_output = port.is_output(pin % 32);
        let is_driven = is_output || channels > 0;
        let is_used = is_driven || port.is_used(pin % 32);
        let [sends, receives] = self.uarte.pins().map(|of| of == Some(pin));
        let pulses = self.pwm.pin() == Some(pin);
        let crystal = CRYSTAL.contains(&pin) && self.clock_and_power.crystal_has_pins();
        let antenna = ANTENNA.contains(&pin) && self.uicr.get(uicr::NFCPINS) & 1 == 1;
        // Erased it says the same as 0 (4.5.1.7).
        let volts = self.uicr.get(uicr::REGOUT0) & 7;
        let is_low = self.bus.board.is_high_voltage && matches!(volts, 0 | 7);
        let cases = [
            (
                is_used && crystal,
                "the low-frequency clock's crystal has it",
            ),
            (is_used && antenna, "UICR.NFCPINS makes it an antenna's"),
            (
                is_driven && self.reset_pin() == Some(pin),
                "UICR.PSELRESET makes it the reset's",
            ),
            (is_driven && is_low, "its level is 1.8 V, by UICR.REGOUT0"),
            (channels > 1, "two channels of GPIOTE drive it"),
            (
                channels > 0 && (sends || receives),
                "GPIOTE and the UART have it",
            ),
            (pulses && !is_output, "PWM0 has it, and it is no output"),
            (
                pulses && (channels > 0 || sends || receives),
                "PWM0 and another have it",
            ),
            (sends && receives, "the UART sends and receives by it"),
            (
                sends && !is_output,
                "the UART sends by it, and it is no output",
            ),
            (
                receives && !port.is_input(pin % 32),
                "the UART receives by it, and it is no input",
            ),
        ];
        let mut cases = cases.into_iter();
        cases.find(|(is_wrong, _)| *is_wrong).map(|(_, why)| why)
    }

    /// The pin that resets the chip: both words name it (4.5.1.4).
    fn reset_pin(&self) -> Option<u32> {
        let [first, second] = uicr::RESET_PINS.map(|word| self.uicr.get(word));
        (first == second && first >> 31 == 0).then_some(first & 0x3f)
    }
}
