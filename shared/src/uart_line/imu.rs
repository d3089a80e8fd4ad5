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
use super::frame::{framed, hexadecimal};
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

impl ImuReport {
    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }
}

rows!(ImuReport {
    "IMU" (sample: SampleIndex, imu: Imu) => Self { sample, imu },
});

field!(Imu => Self: |text, imu| {
    let mut values = imu.0.iter();
    values.try_for_each(|value| write!(text, "{:04X}", value.cast_unsigned()))
}, imu);

fn imu(text: &str) -> Option<Imu> {
    let (digits, rest) = text.as_bytes().as_chunks::<4>();
    let mut imu = Imu([0; 10]);
    if digits.len() != imu.0.len() || !rest.is_empty() {
        return None;
    }
    for (value, digits) in imu.0.iter_mut().zip(digits) {
        *value = hexadecimal(digits, 4, b'A')? as i16;
    }
    Some(imu)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uart_line::tests::line as framed_line;
    use alloc::string::ToString;

    #[test]
    fn the_line_is_that_of_the_documentation_and_each_wrong_field_is_named() {
        let report = ImuReport {
            sample: SampleIndex(1200),
            imu: Imu([16_384, 0, 0, 1, 2048, 0, 0, -16, 0, 0]),
        };
        let line = report.to_string();
        assert!(include_str!("imu.rs").contains(alloc::format!("//! {line}").trim_end()));
        assert_eq!(ImuReport::parse(line.as_bytes()), Ok(report));
        let sample = SampleIndex(u32::MAX);
        assert_eq!(ImuReport { sample, ..report }.to_string().len(), 61);
        for (from, to, field) in [
            ("IMU", "EMG", "kind"),
            ("1200", "01200", "sample"),
            ("0000000", "000000", "imu"),
            ("FFF0", "fff0", "imu"),
        ] {
            let body = line[1..line.len() - 5].replacen(from, to, 1);
            let found = ImuReport::parse(framed_line(&body).as_bytes());
            assert_eq!(found, Err(ParseError::Field { field }), "{body}");
        }
    }
}
