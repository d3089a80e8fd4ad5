//! Tables of fields, from which lines are both written and read.
//!
//! [`Fields`] is a codec of one or more fields. `field!` makes it from a pair of functions, `fields!` for a struct from
//! its parts' codecs. `rows!` makes a line's: a row is its first words, its fields in order, and their value, which is a
//! pattern when the line is written and an expression when it is read.
//!
//! Functions that each field calls are not inlined: the optimiser would make a board's image 3.6 KiB longer.

use core::fmt::{self, Write};

use super::frame::{checksum, hexadecimal, number};
use super::{ParseError, flag};
use crate::units::SampleIndex;

/// Codec of one or more fields.
pub(super) trait Fields<'a> {
    type Value;
    /// Number of fields.
    const COUNT: usize;
    /// Writes the fields, a comma before each.
    fn write(value: &Self::Value, line: &mut Writer<'_, '_>) -> fmt::Result;
    /// Reads the fields; an error names the first wrong one. A single field has the name that its table gives it.
    fn read(line: &mut Reader<'a>, name: &'static str) -> Result<Self::Value, ParseError>;
}

/// Writes `$`, fields, `*` and the checksum, CR LF.
pub(super) struct Writer<'w, 'f> {
    formatter: &'w mut fmt::Formatter<'f>,
    /// Character before the next field: `$`, then commas.
    separator: char,
    /// XOR of the bytes so far, but for the first `$`.
    sum: u8,
}

impl<'w, 'f> Writer<'w, 'f> {
    pub(super) const fn new(formatter: &'w mut fmt::Formatter<'f>) -> Self {
        Self {
            formatter,
            separator: '$',
            sum: b'$',
        }
    }

    /// Begins a field.
    #[inline(never)]
    pub(super) fn field(&mut self) -> Result<&mut Self, fmt::Error> {
        let separator = core::mem::replace(&mut self.separator, ',');
        self.write_char(separator)?;
        Ok(self)
    }

    /// Writes a field, or several with commas between them.
    #[inline(never)]
    pub(super) fn text(&mut self, text: &str) -> fmt::Result {
        self.field()?.write_str(text)
    }

    #[inline(never)]
    fn number(&mut self, number: u32) -> fmt::Result {
        write!(self.field()?, "{number}")
    }

    #[inline(never)]
    pub(super) fn end(self) -> fmt::Result {
        write!(self.formatter, "*{:02X}\r\n", self.sum)
    }
}

impl Write for Writer<'_, '_> {
    #[inline(never)]
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.sum ^= checksum(text);
        self.formatter.write_str(text)
    }
}

/// Fields that are still to be read, as many as are expected.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a>(&'a str);

impl<'a> Reader<'a> {
    #[inline(never)]
    fn next(&mut self) -> &'a str {
        let (field, rest) = self.0.split_once(',').unwrap_or((self.0, ""));
        self.0 = rest;
        field
    }

    pub(super) fn field<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&'a str) -> Option<T>,
    ) -> Result<T, ParseError> {
        read(self.next()).ok_or(wrong(name))
    }
}

/// Finds the row of a body.
pub(super) struct Rows<'a> {
    body: &'a str,
    /// Error if no row fits: `kind` while no row begins with the body's first field, then `command` or `why`, then the
    /// number of fields that the first row with all its words expects.
    pub(super) error: ParseError,
}

impl<'a> Rows<'a> {
    pub(super) const fn new(body: &'a str) -> Self {
        let error = wrong("kind");
        Self { body, error }
    }

    /// The fields behind a row's words, if the body has these words and this number of fields.
    #[inline(never)]
    pub(super) fn find(&mut self, words: &str, fields: usize) -> Option<Reader<'a>> {
        let commas = |text: &str| text.bytes().filter(|&byte| byte == b',').count();
        let behind = self.body.strip_prefix(words);
        match behind.filter(|behind| behind.is_empty() || behind.starts_with(',')) {
            Some(behind) if commas(behind) == fields => {
                return Some(Reader(behind.get(1..).unwrap_or_default()));
            }
            Some(_) if !matches!(self.error, ParseError::Fields { .. }) => {
                let [words, found] = [words, self.body].map(|text| commas(text) + 1);
                let expected = words + fields;
                self.error = ParseError::Fields { expected, found };
            }
            None if self.error == wrong("kind") && first(words) == first(self.body) => {
                let is_refusal = words.starts_with("ERR");
                self.error = wrong(if is_refusal { "why" } else { "command" });
            }
            _ => {}
        }
        None
    }
}

/// First field of a body.
pub(super) fn first(body: &str) -> &str {
    body.split_once(',').map_or(body, |(first, _)| first)
}

pub(super) const fn wrong(field: &'static str) -> ParseError {
    ParseError::Field { field }
}

/// Implements [`Fields`] for a codec of one field.
macro_rules! field {
    ($codec:ty => $value:ty: |$text:ident, $field:ident| $write:expr, $read:expr) => {
        impl<'a> Fields<'a> for $codec {
            type Value = $value;
            const COUNT: usize = 1;

            fn write($field: &Self::Value, line: &mut Writer<'_, '_>) -> fmt::Result {
                let $text = line.field()?;
                $write
            }

            fn read(line: &mut Reader<'a>, name: &'static str) -> Result<$value, ParseError> {
                line.field(name, $read)
            }
        }
    };
}

/// Implements [`Fields`] for a struct: its fields in the order of the line, with their codecs.
macro_rules! fields {
    ($type:ident { $($fields:tt)+ }) => {
        fields!(<'a> $type { $($fields)+ });
    };
    (<$life:lifetime> $type:ty { $($field:ident: $codec:ty),+ $(,)? }) => {
        impl<$life> Fields<$life> for $type {
            type Value = Self;
            const COUNT: usize = 0 $(+ <$codec as Fields<'_>>::COUNT)+;

            fn write(value: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
                $(<$codec as Fields<'_>>::write(&value.$field, line)?;)+
                Ok(())
            }

            fn read(line: &mut Reader<$life>, _name: &'static str) -> Result<Self, ParseError> {
                Ok(Self { $($field: <$codec as Fields<'_>>::read(line, stringify!($field))?),+ })
            }
        }
    };
}

/// Implements `Display` of a line, CR LF included, and `of_body`, which reads its body.
macro_rules! rows {
    ($type:ident $(<$life:lifetime>)? { $(
        $words:literal $(($($field:ident: $codec:ty),+))?
            => $value:ident $(:: $variant:ident)? $(($($parts:tt)*))? $({$($named:tt)*})?
    ),+ $(,)? }) => {
        impl $(<$life>)? fmt::Display for $type $(<$life>)? {
            fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                let mut line = Writer::new(formatter);
                match self {
                    $($value $(:: $variant)? $(($($parts)*))? $({$($named)*})? => {
                        line.text($words)?;
                        $($(<$codec as Fields<'_>>::write($field, &mut line)?;)+)?
                    })+
                }
                line.end()
            }
        }

        impl $(<$life>)? $type $(<$life>)? {
            pub(in crate::uart_line) fn of_body(body: & $($life)? str) -> Result<Self, ParseError> {
                let mut rows = Rows::new(body);
                $(
                    if let Some(ref mut _line) = rows.find($words, 0 $($(+ <$codec as Fields<'_>>::COUNT)+)?) {
                        $($(let $field = <$codec as Fields<'_>>::read(_line, stringify!($field))?;)+)?
                        return Ok($value $(:: $variant)? $(($($parts)*))? $({$($named)*})?);
                    }
                )+
                Err(rows.error)
            }
        }
    };
}

pub(super) use {field, fields, rows};

/// Implements [`Fields`] for a codec of a number.
macro_rules! number {
    ($codec:ty: |$value:ident| $number:expr, $read:expr) => {
        impl Fields<'_> for $codec {
            type Value = Self;
            const COUNT: usize = 1;

            fn write($value: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
                line.number($number)
            }

            fn read(line: &mut Reader<'_>, name: &'static str) -> Result<Self, ParseError> {
                line.field(name, $read)
            }
        }
    };
}

number!(u32: |value| *value, number);
number!(u8: |value| u32::from(*value), |text| number(text)?.try_into().ok());
number!(bool: |value| u32::from(*value), flag);
number!(SampleIndex: |value| value.0, |text| number(text).map(Self));

/// Codec of a CRC-32: eight lower-case hexadecimal digits.
pub(super) struct Crc;
field!(Crc => u32: |text, value| write!(text, "{value:08x}"), |text| hexadecimal(text.as_bytes(), 8, b'a'));

/// Codec of a name that the board gives itself.
impl<'a> Fields<'a> for str {
    type Value = &'a str;
    const COUNT: usize = 1;

    fn write(name: &&str, line: &mut Writer<'_, '_>) -> fmt::Result {
        line.text(name)
    }

    fn read(line: &mut Reader<'a>, name: &'static str) -> Result<&'a str, ParseError> {
        let is_letter = |byte: u8| byte.is_ascii_graphic() && !matches!(byte, b'$' | b'*');
        let is_name = |text: &&str| !text.is_empty() && text.bytes().all(is_letter);
        line.field(name, |text| Some(text).filter(is_name))
    }
}

/// Codec of fields that are `-` where there is no value.
impl<'a, C: Fields<'a>> Fields<'a> for Option<C> {
    type Value = Option<C::Value>;
    const COUNT: usize = C::COUNT;

    fn write(value: &Self::Value, line: &mut Writer<'_, '_>) -> fmt::Result {
        match value {
            Some(value) => C::write(value, line),
            None => (0..C::COUNT).try_for_each(|_| line.text("-")),
        }
    }

    fn read(line: &mut Reader<'a>, name: &'static str) -> Result<Self::Value, ParseError> {
        let mut ahead = *line;
        if (0..C::COUNT).all(|_| ahead.next() == "-") {
            *line = ahead;
            return Ok(None);
        }
        C::read(line, name).map(Some)
    }
}
