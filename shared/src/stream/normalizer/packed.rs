//! Four bytes of a sample in a word, the first in the low byte: a fraction of the instructions that one at a time would take.

/// The number 1 in each byte.
const ONES: u32 = 0x0101_0101;
/// The high bit of each byte.
const HIGH: u32 = 0x8080_8080;
/// Mask of every other byte.
const EVEN: u32 = 0x00ff_00ff;

/// Sizes of four numbers, 0 to 128, and their signs.
#[derive(Clone, Copy, Debug)]
pub struct Magnitudes {
    /// A byte each.
    sizes: u32,
    /// All bits of a byte where the number is negative.
    negative: u32,
}

impl Magnitudes {
    /// Magnitudes of the signed bytes of a word.
    pub const fn of(word: u32) -> Self {
        let signs = (word & HIGH) >> 7;
        let negative = (signs << 8).wrapping_sub(signs);
        // The complement and one more; no carry leaves a byte, as the complement of a negative number is below 128.
        let sizes = (word ^ negative) + signs;
        Self { sizes, negative }
    }

    /// A byte each, the first in the low byte.
    pub const fn bytes(self) -> [u8; 4] {
        self.sizes.to_le_bytes()
    }

    /// The word with other sizes in place of these.
    pub fn with_sizes(self, size: impl Fn(usize, u8) -> Size) -> u32 {
        let [a, b, c, d] = self.bytes();
        let sizes = [size(0, a).0, size(1, b).0, size(2, c).0, size(3, d).0];
        let flipped = u32::from_le_bytes(sizes) ^ self.negative;
        // As above; the high bits are kept out of the addition, into which that of a zero would carry.
        ((flipped & !HIGH) + (self.negative & ONES)) ^ (flipped & HIGH)
    }
}

/// A size that has both signs in a byte: 0 to 127.
#[derive(Clone, Copy, Debug)]
pub struct Size(u8);

impl Size {
    /// The nearest to a number.
    pub fn nearest(number: i32) -> Self {
        Self(number.clamp(0, i32::from(i8::MAX)) as u8)
    }
}

/// Four sums of sizes, below 65 536 each.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Sums {
    /// First number's sum and, in the high half, the third's.
    even: u32,
    /// Second number's sum and, in the high half, the fourth's.
    odd: u32,
}

impl Sums {
    /// Zero sums.
    pub const ZERO: Self = Self { even: 0, odd: 0 };

    /// Adds the sizes.
    pub const fn add(&mut self, magnitudes: Magnitudes) {
        self.even += magnitudes.sizes & EVEN;
        self.odd += (magnitudes.sizes >> 8) & EVEN;
    }

    /// The sums, in the order of the numbers.
    pub const fn of_each(self) -> [u32; 4] {
        let low = 0xffff;
        [
            self.even & low,
            self.odd & low,
            self.even >> 16,
            self.odd >> 16,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sizes_and_signs_are_those_of_the_bytes(bytes: [i8; 4], sizes in any::<[i8; 4]>()) {
            let magnitudes = Magnitudes::of(u32::from_le_bytes(bytes.map(i8::cast_unsigned)));
            let mut sums = Sums::ZERO;
            sums.add(magnitudes);
            prop_assert_eq!(sums.of_each(), bytes.map(|x| i32::from(x).unsigned_abs()));

            let sizes = sizes.map(|size| size.unsigned_abs().min(127));
            let got = magnitudes.with_sizes(|index, size| {
                assert_eq!(size, bytes[index].unsigned_abs());
                Size::nearest(i32::from(sizes[index]))
            });
            let expected: [i8; 4] = core::array::from_fn(|index| {
                let size = sizes[index] as i8;
                if bytes[index] < 0 { -size } else { size }
            });
            prop_assert_eq!(got.to_le_bytes().map(u8::cast_signed), expected);
        }
    }

    #[test]
    fn the_nearest_size_is_within_both_signs() {
        for (number, size) in [
            (i32::MIN, 0),
            (-1, 0),
            (5, 5),
            (127, 127),
            (128, 127),
            (i32::MAX, 127),
        ] {
            assert_eq!(Size::nearest(number).0, size);
        }
    }
}
