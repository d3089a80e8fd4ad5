//! Separator of the values of a row of text.

use std::borrow::Cow;
use std::fmt;
use std::iter;

use shared::units::CHANNELS;

shared::names! {
    /// Separator of a table, by its text in a description.
    pub enum Separator {
        /// `,`
        Comma = ",",
        /// `;`, as spreadsheets write where the comma is the decimal point.
        Semicolon = ";",
        /// Tabulator.
        Tab = "\t",
        /// Spaces, any number of them.
        Space = " ",
    }
}

impl Separator {
    /// Separators other than spaces, which names and decimals may hold, in order of precedence.
    const MARKS: [Self; 3] = [Self::Tab, Self::Semicolon, Self::Comma];

    /// The separator of a row: the mark that gives it eight fields, else most; spaces for a row without a mark.
    pub fn of(row: &str) -> Self {
        let count = |separator: &Self| separator.fields(row).len();
        let eight = Self::MARKS.into_iter().find(|mark| count(mark) >= CHANNELS);
        let most = Self::MARKS.into_iter().rev().max_by_key(count);
        let most = most.filter(|mark| count(mark) > 1);
        eight.or(most).unwrap_or(Self::Space)
    }

    /// The fields of a row, without spaces and quotes around them. What is in quotes is not separated.
    pub fn fields(self, row: &str) -> Vec<&str> {
        self.each(row).collect()
    }

    /// One field of a row after the other, as [`Self::fields`] has them.
    pub fn each(self, row: &str) -> impl Iterator<Item = &str> {
        let mut rest = Some(row);
        let fields = iter::from_fn(move || {
            let text = rest?;
            let end = self.end(text);
            rest = end.map(|end| {
                let mut after = text[end..].chars();
                after.next();
                after.as_str()
            });
            Some(&text[..end.unwrap_or(text.len())])
        });
        let fields = fields.filter(move |field| self != Self::Space || !field.is_empty());
        fields.map(unquoted)
    }

    /// Byte at which the first field of a text ends; none if no other follows.
    fn end(self, text: &str) -> Option<usize> {
        // Files have millions of fields, and few a quote: one letter is found faster than by a function.
        let mark = self.name().chars().next()?;
        let end = match self {
            Self::Space => text.find(char::is_whitespace),
            _ => text.find(mark),
        }?;
        if !text[..end].contains('"') {
            return Some(end);
        }
        let mut is_quoted = false;
        text.find(|letter: char| {
            is_quoted ^= letter == '"';
            !is_quoted && (letter == mark || self == Self::Space && letter.is_whitespace())
        })
    }

    /// Whether a field is a number.
    pub fn is_number(self, field: &str) -> bool {
        self.number(field).parse::<f64>().is_ok()
    }

    /// A field as the text of a number. A decimal comma becomes a point, where commas do not separate.
    pub fn number(self, field: &str) -> Cow<'_, str> {
        if self == Self::Comma || !field.contains(',') {
            Cow::Borrowed(field)
        } else {
            Cow::Owned(field.replace(',', "."))
        }
    }
}

/// A field without spaces and quotes around it.
pub(crate) fn unquoted(field: &str) -> &str {
    let field = field.trim();
    let inside = field
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    inside.map_or(field, str::trim)
}

impl fmt::Display for Separator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Space => "spaces",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_go_before_spaces() {
        for (row, separator) in [
            ("gt,emg_0,emg_1", Separator::Comma),
            ("gt;emg_0;emg_1", Separator::Semicolon),
            ("0;0,5;-1,5", Separator::Semicolon),
            ("gt\temg 0\temg 1", Separator::Tab),
            ("0  1.0  2.0", Separator::Space),
            ("1, 2, 3", Separator::Comma),
        ] {
            assert_eq!(Separator::of(row), separator, "{row}");
        }
        assert_eq!(Separator::Comma.fields("\"a\", b ,"), ["a", "b", ""]);
        assert_eq!(Separator::Comma.fields("\"a,b\",c"), ["a,b", "c"]);
        assert_eq!(Separator::Comma.fields("a,\"b,c"), ["a", "\"b,c"]);
        assert_eq!(Separator::Space.fields(" \"a b\"  c "), ["a b", "c"]);
        assert_eq!(Separator::Semicolon.number("-0,5"), "-0.5");
    }
}
