//! Virtual time, in ticks of the core's clock of 64 MHz since power came.

/// Ticks in a second.
pub const HZ: u64 = 64_000_000;

/// Ticks in `count` microseconds.
pub const fn us(count: u64) -> u64 {
    count * (HZ / 1_000_000)
}

/// Ticks in `count` milliseconds.
pub const fn ms(count: u64) -> u64 {
    us(count * 1000)
}

/// Periods of the low-frequency clock of 32 768 Hz that have begun by then.
pub const fn low_frequency(ticks: u64) -> u64 {
    // 32768 / 64e6 = 8 / 15625
    ticks * 8 / 15625
}

/// Returns the tick at which a period of the low-frequency clock begins.
pub const fn of_low_frequency(periods: u64) -> u64 {
    (periods * 15625).div_ceil(8)
}
