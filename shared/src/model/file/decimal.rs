//! Decimal numbers in messages about a file: the library's formatting would take 6 KiB of a board's flash.

use core::fmt;

/// Writes a number with at most six digits behind the point.
pub(super) struct Decimal<'n>(pub(super) &'n f32);

impl fmt::Display for Decimal<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = *self.0;
        if number.is_nan() {
            return formatter.write_str("NaN");
        }
        if number.is_sign_negative() {
            formatter.write_str("-")?;
        }
        let size = number.abs();
        if size == f32::INFINITY {
            return formatter.write_str("inf");
        }
        if size >= 4e9 {
            return formatter.write_str("more than 4000000000");
        }
        let whole = size as u32;
        let millionths = ((size - whole as f32) * 1e6 + 0.5) as u32;
        // Rounded up to the next whole number.
        let (whole, mut rest) = (whole + millionths / 1_000_000, millionths % 1_000_000);
        write!(formatter, "{whole}")?;
        if rest == 0 {
            return Ok(());
        }
        formatter.write_str(".")?;
        while rest > 0 {
            rest *= 10;
            write!(formatter, "{}", rest / 1_000_000)?;
            rest %= 1_000_000;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, string::ToString};

    #[test]
    fn numbers_are_written_as_the_library_writes_them_up_to_six_digits() {
        for number in [
            0.0_f32,
            1.0,
            -1.0,
            100.0,
            0.5,
            -0.25,
            50.0,
            1234.5,
            0.1,
            0.000_001,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ] {
            assert_eq!(Decimal(&number).to_string(), number.to_string());
        }
        for (number, text) in [
            (1.0e-9_f32, "0"),
            (0.999_999_94, "1"),
            (0.123_456_78, "0.123457"),
            (1e30, "more than 4000000000"),
            (-1e30, "-more than 4000000000"),
        ] {
            assert_eq!(Decimal(&number).to_string(), text);
        }
        assert_eq!(format!("{}", Decimal(&3.000_5)), "3.0005");
    }
}
