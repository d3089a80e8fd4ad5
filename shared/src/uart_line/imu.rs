//! The UART line of the armband's movement, as its IMU sent it.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = "IMU," sample "," movement
//! sample   = number                 index of the sample that was due when it came, in one count with the other lines
//! movement = 40 hexadecimal digits  ten numbers of 16 bits in two's complement, upper case: see `Imu`
//! ```
//!
//! Written only after the command `IMU,on`, over USB alone: 50 lines of at most 61 bytes a second. Without a line number.
//!
//! ```text
//! $IMU,1200,4000000000000001080000000000FFF000000000*29
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::fields::{Fields, Reader, Rows, Writer, field, rows};
use super::frame::hexadecimals;
use crate::myo::Imu;
use crate::units::SampleIndex;

/// Content of a line. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct ImuReport {
    /// Index of the sample that was due.
    pub sample: SampleIndex,
    /// The movement.
    pub imu: Imu,
}

rows!(ImuReport {
    "IMU" (sample: SampleIndex, imu: Imu) => Self { sample, imu },
});

field!(Imu => Self: |text, imu| {
    let mut values = imu.0.iter();
    values.try_for_each(|value| write!(text, "{:04X}", value.cast_unsigned()))
}, |text| hexadecimals(text, 4).map(|values| Self(values.map(|value| value as i16))));
