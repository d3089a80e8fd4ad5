//! Outputs and their names on the line.
//!
//! ```text
//! output = "key:" key | "click:" ( "left" | "right" | "middle" ) | "move:" ( "left" | "right" | "up" | "down" )
//!        | "button:" ( "1" ... "16" ) | "axis:" ( "x" | "y" | "z" | "rx" | "ry" | "rz" ) ( "+" | "-" )
//! key    = "a" ... "z" | "0" ... "9" | "f1" ... "f12" | "enter" | "escape" | "backspace" | "tab" | "space" | "insert"
//!        | "home" | "page-up" | "delete" | "end" | "page-down" | "right" | "left" | "down" | "up"
//!        | "ctrl" | "shift" | "alt" | "meta"
//! ```

use crate::names::names;

names! {
    /// Kind of an output.
    pub(super) enum HidKind {
        /// Key of a keyboard.
        Key = "key",
        /// Button of a mouse.
        Click = "click",
        /// Movement of a mouse, as fast as the strength.
        Move = "move",
        /// Button of a gamepad.
        Button = "button",
        /// Axis of a gamepad, as far as the strength.
        Axis = "axis",
    }
}

names! {
    /// Device that the computer sees.
    pub enum Device {
        /// A keyboard.
        Keyboard = "keyboard",
        /// A mouse.
        Mouse = "mouse",
        /// A gamepad.
        Gamepad = "gamepad",
    }
}

/// Names of values that follow each other, from the first one on.
type Run = (u8, &'static [&'static str]);

/// Keys by their usages (HID Usage Tables, page 7).
#[rustfmt::skip]
const KEYS: &[Run] = &[
    (0x04, &[
        "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o", "p", "q", "r", "s", "t", "u", "v", "w", "x",
        "y", "z", "1", "2", "3", "4", "5", "6", "7", "8", "9", "0", "enter", "escape", "backspace", "tab", "space",
    ]),
    (0x3a, &["f1", "f2", "f3", "f4", "f5", "f6", "f7", "f8", "f9", "f10", "f11", "f12"]),
    (0x49, &["insert", "home", "page-up", "delete", "end", "page-down", "right", "left", "down", "up"]),
    (MODIFIERS, &["ctrl", "shift", "alt", "meta"]),
];
const CLICKS: &[Run] = &[(0, &["left", "right", "middle"])];
const MOVES: &[Run] = &[(0, &["left", "right", "up", "down"])];
#[rustfmt::skip]
const BUTTONS: &[Run] = &[
    (0, &["1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16"]),
];
#[rustfmt::skip]
const AXES: &[Run] = &[(0, &["x+", "x-", "y+", "y-", "z+", "z-", "rx+", "rx-", "ry+", "ry-", "rz+", "rz-"])];

/// Usage of the first modifier; each is a bit of a report.
pub(super) const MODIFIERS: u8 = 0xe0;

/// A key, a button, a direction or an axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Output {
    pub(super) kind: HidKind,
    /// A value that has a name.
    pub(super) value: u8,
}

impl HidKind {
    const fn runs(self) -> &'static [Run] {
        match self {
            Self::Key => KEYS,
            Self::Click => CLICKS,
            Self::Move => MOVES,
            Self::Button => BUTTONS,
            Self::Axis => AXES,
        }
    }
}

impl Output {
    /// Output of a kind and a value; none if it has no name.
    pub(super) fn new(kind: HidKind, value: u8) -> Option<Self> {
        let output = Self { kind, value };
        output.value_name().map(|_| output)
    }

    fn value_name(self) -> Option<&'static str> {
        self.kind.runs().iter().find_map(|&(first, names)| {
            let place = self.value.checked_sub(first)?;
            names.get(usize::from(place)).copied()
        })
    }

    /// Kind and name of the value, as the line has them with a colon between them.
    #[must_use]
    pub fn names(self) -> [&'static str; 2] {
        [self.kind.name(), self.value_name().unwrap_or_default()]
    }

    /// The output of a name such as `key:space`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let (kind, name) = name.split_once(':')?;
        let kind = HidKind::from_name(kind)?;
        kind.runs().iter().find_map(|&(first, names)| {
            let place = names.iter().position(|known| *known == name)?;
            Some(Self {
                kind,
                value: first + place as u8,
            })
        })
    }

    /// Device that has it.
    #[must_use]
    pub const fn device(self) -> Device {
        match self.kind {
            HidKind::Key => Device::Keyboard,
            HidKind::Click | HidKind::Move => Device::Mouse,
            HidKind::Button | HidKind::Axis => Device::Gamepad,
        }
    }

    /// Whether its report is repeated while it is pressed: it says how far, not where.
    #[must_use]
    pub fn moves(self) -> bool {
        self.kind == HidKind::Move
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{collections::BTreeSet, string::String, vec::Vec};

    /// Every output.
    fn all() -> Vec<Output> {
        let values = |kind| (0..=u8::MAX).filter_map(move |value| Output::new(kind, value));
        HidKind::ALL.into_iter().flat_map(values).collect()
    }

    #[test]
    fn every_output_has_one_name_and_is_read_from_it() {
        let names: BTreeSet<String> = all()
            .iter()
            .map(|output| output.names().join(":"))
            .collect();
        assert_eq!(names.len(), 67 + 3 + 4 + 16 + 12);
        for output in all() {
            assert_eq!(Output::from_name(&output.names().join(":")), Some(output));
        }
        for wrong in [
            "",
            "key",
            "key:",
            "key:A",
            "space",
            "key:space ",
            "button:0",
            "button:17",
            "axis:x",
            "move:x",
        ] {
            assert_eq!(Output::from_name(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn keys_have_the_usages_of_the_standard() {
        for (name, usage) in [
            ("z", 0x1d),
            ("0", 0x27),
            ("space", 0x2c),
            ("f12", 0x45),
            ("up", 0x52),
            ("meta", 0xe3),
        ] {
            let name = alloc::format!("key:{name}");
            assert_eq!(Output::from_name(&name).unwrap().value, usage, "{name}");
        }
    }
}
