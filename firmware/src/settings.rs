//! Settings for the builder of a device. Pins are in `board/nrf52/wiring`.

use shared::myo::{Address, EmgMode, Settings};
use shared::stream::alignment::Arm;
use shared::stream::lock::LockTimes;

#[cfg(target_os = "none")]
use crate::pulses::Pulses;

/// The one armband to connect to, as `MYOINTENT_ARMBAND=F1:23:45:67:89:AB` when the program is
/// built; without it, the one that is bound at run time.
const ARMBAND: Option<&str> = option_env!("MYOINTENT_ARMBAND");

/// Whether a board to which no armband is bound follows the one with the strongest signal, as `MYOINTENT_UNBOUND=strongest`
/// when the program is built.
///
/// Off without it: whoever comes near with an armband would move the wearer's hand. Why a newcomer has to bind first:
/// docs/decisions.md.
const FOLLOW_STRONGEST: bool = match option_env!("MYOINTENT_UNBOUND") {
    None => false,
    Some(text) => match text.as_bytes() {
        b"strongest" => true,
        b"nobody" => false,
        _ => panic!("MYOINTENT_UNBOUND is neither strongest nor nobody"),
    },
};

/// The EMG mode of the armband. It must be the one that the model was trained on.
const EMG: EmgMode = EmgMode::Filtered;

/// Whether an alignment begins by itself at the first full window of each connection, as `MYOINTENT_ALIGN=connect` when the
/// program is built. A button begins one in any case.
///
/// Off without it: whoever wears the armband as in training loses accuracy by an alignment, and what is done in the 30 s
/// after the first window is taken for openings of the hand, which half of all fists fit as well (docs/alignment.md).
pub const ALIGN_ON_CONNECTION: bool = match option_env!("MYOINTENT_ALIGN") {
    None => false,
    Some(text) => match text.as_bytes() {
        b"connect" => true,
        b"button" => false,
        _ => panic!("MYOINTENT_ALIGN is neither connect nor button"),
    },
};

/// Lock of the labels at each start, as `MYOINTENT_LOCK=on` when the program is built, by the usual times. A command sets it, or takes
/// it away, until the next start.
pub const LOCK: Option<LockTimes> = match option_env!("MYOINTENT_LOCK") {
    None => None,
    Some(text) => match text.as_bytes() {
        b"on" => Some(LockTimes::USUAL),
        b"off" => None,
        _ => panic!("MYOINTENT_LOCK is neither on nor off"),
    },
};

/// Whether lines have the strength at each start, as `MYOINTENT_STRENGTH=on` when the program is built. A command switches it.
pub const STRENGTH: bool = match option_env!("MYOINTENT_STRENGTH") {
    None => false,
    Some(text) => match text.as_bytes() {
        b"on" => true,
        b"off" => false,
        _ => panic!("MYOINTENT_STRENGTH is neither on nor off"),
    },
};

/// Kind of the pulses that tell the strength, as `MYOINTENT_PULSES=servo` when the program is built.
#[cfg(target_os = "none")]
pub const PULSES: Pulses = match option_env!("MYOINTENT_PULSES") {
    None => Pulses::Pwm,
    Some(text) => match text.as_bytes() {
        b"pwm" => Pulses::Pwm,
        b"servo" => Pulses::Servo,
        _ => panic!("MYOINTENT_PULSES is neither pwm nor servo"),
    },
};

/// Arm that an alignment assumes, as `MYOINTENT_MIRRORED=0` or `1` when the program is built: whether the electrodes
/// run the other way round than in training, on the other arm. A command may tell otherwise.
///
/// Without it that is found too. For one person in eight an open hand does not tell the arms apart (docs/decisions.md): tell
/// it where it is known.
pub const ARM: Arm = match option_env!("MYOINTENT_MIRRORED") {
    None => Arm::Unknown,
    Some(text) => match text.as_bytes() {
        b"0" => Arm::Known { mirrored: false },
        b"1" => Arm::Known { mirrored: true },
        _ => panic!("MYOINTENT_MIRRORED is neither 0 nor 1"),
    },
};

/// Source of the clock of 32.768 kHz.
#[cfg(target_os = "none")]
#[derive(Clone, Copy)]
pub enum SlowClock {
    /// The crystal that a development kit has, of 20 ppm.
    #[cfg(feature = "radio-softdevice")]
    Crystal,
    /// The chip's own oscillator, of 500 ppm while it is calibrated.
    Oscillator,
}

/// The clock's source. `MYOINTENT_SLOW_CLOCK=oscillator`, when the program is built, is for a kit under a SoftDevice whose board has
/// no crystal: the radio would never start.
///
/// Without a SoftDevice it is the oscillator, on every board. Boards that are sold with one name lack the crystal, or have a
/// microphone at its pins. And the source must not change while the watchdog keeps the clock running.
#[cfg(target_os = "none")]
pub const SLOW_CLOCK: SlowClock = match option_env!("MYOINTENT_SLOW_CLOCK") {
    #[cfg(feature = "radio-softdevice")]
    None => SlowClock::Crystal,
    #[cfg(feature = "radio-trouble")]
    None => SlowClock::Oscillator,
    Some(text) => match text.as_bytes() {
        #[cfg(feature = "radio-softdevice")]
        b"crystal" => SlowClock::Crystal,
        b"oscillator" => SlowClock::Oscillator,
        _ => panic!("MYOINTENT_SLOW_CLOCK is not oscillator, nor crystal with a SoftDevice"),
    },
};

#[cfg(target_os = "none")]
impl SlowClock {
    /// Quarters of a second between two calibrations: Nordic's recommendation for changes of 0.5 degrees a second.
    pub const CALIBRATION_INTERVAL: u8 = 16;
    /// Intervals after which a calibration is made although the temperature has not changed.
    pub const MOST_SKIPPED: u8 = 2;
    /// Greatest error of the oscillator, parts in a million.
    #[cfg(feature = "radio-trouble")]
    pub const OSCILLATOR_PPM: u16 = 500;

    /// Name in the line that says which clock runs.
    pub const fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "radio-softdevice")]
            Self::Crystal => "the crystal",
            Self::Oscillator => "the chip's oscillator",
        }
    }
}

/// Milliseconds without a heartbeat of one task after which the board restarts.
pub const WATCHDOG_MS: u32 = 2000;

/// Milliseconds without progress of the inference after which hardware clears the pins.
///
/// More than the 200 ms of silence, which the program handles itself. Less than 250 ms by the 8 % that the
/// high-frequency clock of an nRF52 may be slow without its crystal (product specifications, HFINT).
pub const DEAD_MAN_MS: u32 = 225;
const _: () = assert!(DEAD_MAN_MS * 92 / 100 > shared::stream::safe_state::SILENCE_MS);
const _: () = assert!(DEAD_MAN_MS * 108 / 100 < 250);

/// Settings of the Myo session, with no armband bound.
pub const SESSION: Settings = Settings {
    bound: None,
    follow_strongest: FOLLOW_STRONGEST,
    pinned: match ARMBAND {
        None => None,
        Some(text) => match Address::parse(text) {
            Ok(address) => Some(address),
            Err(_) => panic!("MYOINTENT_ARMBAND is no address such as F1:23:45:67:89:AB"),
        },
    },
    emg: EMG,
    imu: false,
};
