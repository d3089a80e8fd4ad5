//! Reports to the computer, and the descriptor that says what is in them.

use super::output::{Device, HidKind, MODIFIERS, Output};
use crate::stream::strength::Percent;

/// Bytes of the longest report: a gamepad's.
pub const REPORT_BYTES: usize = 9;
/// Bytes of the longest descriptor.
pub const DESCRIPTOR_BYTES: usize = KEYBOARD.len() + MOUSE.len() + GAMEPAD.len();
/// Counts that a mouse moves by with each report at full strength.
const FASTEST: u8 = 10;

/// Eight modifiers, a key.
#[rustfmt::skip]
const KEYBOARD: &[u8] = &[
    0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x85, 0x01, // generic desktop: keyboard, report 1
    0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, // modifiers
    0x19, 0x00, 0x29, 0x65, 0x25, 0x65, 0x75, 0x08, 0x95, 0x01, 0x81, 0x00, // key
    0xc0,
];
/// Three buttons and five bits more, movement to the right and down.
#[rustfmt::skip]
const MOUSE: &[u8] = &[
    0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x85, 0x02, 0x09, 0x01, 0xa1, 0x00, // generic desktop: mouse, report 2, pointer
    0x05, 0x09, 0x19, 0x01, 0x29, 0x03, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x03, 0x81, 0x02, // buttons
    0x95, 0x05, 0x81, 0x03, // constant
    0x05, 0x01, 0x09, 0x30, 0x09, 0x31, 0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02, 0x81, 0x06, // x, y, relative
    0xc0, 0xc0,
];
/// Sixteen buttons, six axes.
#[rustfmt::skip]
const GAMEPAD: &[u8] = &[
    0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x85, 0x03, // generic desktop: gamepad, report 3
    0x05, 0x09, 0x19, 0x01, 0x29, 0x10, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x10, 0x81, 0x02, // buttons
    0x05, 0x01, 0x19, 0x30, 0x29, 0x35, 0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x06, 0x81, 0x02, // x, y, z, rx, ry, rz
    0xc0,
];

impl Device {
    /// Number of its reports, their length with this number, and their description.
    const fn format(self) -> (u8, usize, &'static [u8]) {
        match self {
            Self::Keyboard => (1, 3, KEYBOARD),
            Self::Mouse => (2, 4, MOUSE),
            Self::Gamepad => (3, REPORT_BYTES, GAMEPAD),
        }
    }
}

/// Descriptor of these devices, in the order of [`Device::ALL`].
#[must_use]
pub fn descriptor(devices: [bool; Device::ALL.len()], bytes: &mut [u8; DESCRIPTOR_BYTES]) -> &[u8] {
    let mut length = 0;
    for (device, is_seen) in Device::ALL.into_iter().zip(devices) {
        if is_seen {
            let (.., part) = device.format();
            bytes[length..][..part.len()].copy_from_slice(part);
            length += part.len();
        }
    }
    &bytes[..length]
}

/// Report of a device to the computer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Report {
    device: Device,
    bytes: [u8; REPORT_BYTES],
}

impl Report {
    /// Nothing is pressed.
    #[must_use]
    pub const fn released(device: Device) -> Self {
        let mut bytes = [0; REPORT_BYTES];
        bytes[0] = device.format().0;
        Self { device, bytes }
    }

    /// An output is pressed, with this strength where it has one.
    #[must_use]
    pub fn pressed(Output { kind, value }: Output, strength: Percent) -> Self {
        let mut report = Self::released(Output { kind, value }.device());
        let [_, data @ ..] = &mut report.bytes;
        let share = |most: u8| (u32::from(strength.get()) * u32::from(most)).div_ceil(100) as u8;
        let place = usize::from(value / 2);
        match kind {
            HidKind::Key if value >= MODIFIERS => data[0] = 1 << (value - MODIFIERS),
            HidKind::Key => data[1] = value,
            HidKind::Click => data[0] = 1 << value,
            // Left and up are negative: the even ones.
            HidKind::Move => data[1 + place] = signed(share(FASTEST), value % 2 == 0),
            HidKind::Button => data[..2].copy_from_slice(&(1_u16 << value).to_le_bytes()),
            HidKind::Axis => data[2 + place] = signed(share(127), value % 2 == 1),
        }
        report
    }

    /// Bytes as they are sent, its number first.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.device.format().1]
    }
}

const fn signed(size: u8, is_negative: bool) -> u8 {
    if is_negative {
        size.wrapping_neg()
    } else {
        size
    }
}

/// Finds which reports are to be sent.
#[derive(Clone, Copy, Default, Debug)]
pub struct Reporter {
    /// Output that is pressed, with the report sent last; none while nothing is pressed.
    pressed: Option<(Output, Report)>,
    /// Whether that is released before anything else.
    is_interrupted: bool,
}

impl Reporter {
    /// The next report, once the last one was sent, for an output that is to be pressed, or none; `None` if the computer knows
    /// it. Another output is pressed after the release of the last one.
    pub fn next(&mut self, wanted: Option<(Output, Percent)>) -> Option<Report> {
        let is_interrupted = core::mem::take(&mut self.is_interrupted);
        if let Some((pressed, _)) = self.pressed
            && (is_interrupted || wanted.is_none_or(|(output, _)| output != pressed))
        {
            self.pressed = None;
            return Some(Report::released(pressed.device()));
        }
        let (output, strength) = wanted?;
        let report = Report::pressed(output, strength);
        let before = self.pressed.replace((output, report));
        (before != self.pressed).then_some(report)
    }

    /// Has whatever is pressed released, and pressed again if it still is to be.
    pub const fn interrupt(&mut self) {
        self.is_interrupted = true;
    }

    /// Report that releases what is pressed, if anything is.
    #[must_use]
    pub fn release(&self) -> Option<Report> {
        let (output, _) = self.pressed?;
        Some(Report::released(output.device()))
    }

    /// The report that is to be repeated: what is pressed is a movement.
    #[must_use]
    pub fn repeated(&self) -> Option<Report> {
        let (output, report) = self.pressed?;
        output.moves().then_some(report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};
    use proptest::prelude::*;

    fn of(name: &str, percent: u8) -> (Output, Percent) {
        (
            Output::from_name(name).unwrap(),
            Percent::new(percent).unwrap(),
        )
    }

    /// Length of each report by its descriptor: a plain reader of its items, which are short.
    fn lengths(mut items: &[u8]) -> Vec<(u8, u32)> {
        let (mut size, mut count, mut depth, mut found) = (0, 0, 0, vec![]);
        while let [prefix, rest @ ..] = items {
            let (data, rest) = rest.split_at([0, 1, 2, 4][usize::from(prefix & 3)]);
            match (prefix & 0xfc, data) {
                (0x74, [bits]) => size = u32::from(*bits),
                (0x94, [times]) => count = u32::from(*times),
                (0x84, [number]) => found.push((*number, 0)),
                (0x80, _) => found.last_mut().unwrap().1 += size * count,
                (0xa0, _) => depth += 1,
                (0xc0, _) => depth -= 1,
                _ => {}
            }
            items = rest;
        }
        assert_eq!(depth, 0);
        found
            .iter()
            .map(|(number, bits)| (*number, 1 + bits / 8))
            .collect()
    }

    #[test]
    fn reports_are_as_long_as_their_descriptor_says() {
        for devices in (0..8).map(|bits| [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]) {
            let mut bytes = [0; DESCRIPTOR_BYTES];
            let expected: Vec<_> = Device::ALL
                .into_iter()
                .zip(devices)
                .filter(|(_, is_seen)| *is_seen)
                .map(|(device, _)| Report::released(device))
                .map(|report| (report.bytes()[0], report.bytes().len() as u32))
                .collect();
            assert_eq!(lengths(descriptor(devices, &mut bytes)), expected);
        }
    }

    #[test]
    fn a_report_says_what_is_pressed_and_how_hard() {
        for (name, percent, expected) in [
            ("key:space", 0, &[1, 0, 0x2c][..]),
            ("key:shift", 100, &[1, 2, 0]),
            ("click:right", 50, &[2, 2, 0, 0]),
            ("move:left", 100, &[2, 0, 0xf6, 0]),
            ("move:down", 1, &[2, 0, 0, 1]),
            ("button:1", 7, &[3, 1, 0, 0, 0, 0, 0, 0, 0]),
            ("button:16", 7, &[3, 0, 0x80, 0, 0, 0, 0, 0, 0]),
            ("axis:x+", 0, &[3, 0, 0, 0, 0, 0, 0, 0, 0]),
            ("axis:x+", 50, &[3, 0, 0, 64, 0, 0, 0, 0, 0]),
            ("axis:rz-", 100, &[3, 0, 0, 0, 0, 0, 0, 0, 0x81]),
        ] {
            let (output, strength) = of(name, percent);
            assert_eq!(
                Report::pressed(output, strength).bytes(),
                expected,
                "{name}"
            );
        }
    }

    /// Bytes of the reports until the computer knows what is wanted.
    fn sent(reporter: &mut Reporter, wanted: Option<(Output, Percent)>) -> Vec<Vec<u8>> {
        core::iter::from_fn(|| reporter.next(wanted))
            .map(|report| report.bytes().to_vec())
            .collect()
    }

    #[test]
    fn a_change_releases_before_it_presses_and_the_same_is_not_repeated() {
        let mut reporter = Reporter::default();
        assert!(sent(&mut reporter, None).is_empty());
        let (key, strong) = (Some(of("key:a", 10)), Some(of("key:a", 90)));
        assert_eq!(sent(&mut reporter, key), [[1, 0, 4]]);
        // A key is no harder.
        assert!(sent(&mut reporter, strong).is_empty());
        assert_eq!(
            sent(&mut reporter, Some(of("key:b", 10))),
            [[1, 0, 0], [1, 0, 5]]
        );
        assert_eq!(
            sent(&mut reporter, Some(of("click:left", 10))),
            [vec![1, 0, 0], vec![2, 1, 0, 0]]
        );
        assert_eq!(sent(&mut reporter, None), [[2, 0, 0, 0]]);
        assert!(sent(&mut reporter, None).is_empty());
    }

    #[test]
    fn an_interruption_releases_what_is_pressed_and_nothing_else() {
        let mut reporter = Reporter::default();
        reporter.interrupt();
        assert!(sent(&mut reporter, None).is_empty());
        let key = Some(of("key:a", 10));
        assert_eq!(sent(&mut reporter, key), [[1, 0, 4]]);
        reporter.interrupt();
        assert_eq!(sent(&mut reporter, key), [[1, 0, 0], [1, 0, 4]]);
        reporter.interrupt();
        assert_eq!(sent(&mut reporter, None), [[1, 0, 0]]);
        assert_eq!(reporter.release(), None);
    }

    #[test]
    fn movement_is_repeated_and_an_axis_follows_the_strength() {
        let mut reporter = Reporter::default();
        assert_eq!(sent(&mut reporter, Some(of("axis:y-", 1))).len(), 1);
        assert_eq!(sent(&mut reporter, Some(of("axis:y-", 2))).len(), 1);
        assert_eq!(reporter.repeated(), None);
        assert_eq!(sent(&mut reporter, Some(of("move:up", 30))).len(), 2);
        assert_eq!(reporter.repeated().unwrap().bytes(), [2, 0, 0, 0xfd]);
        assert_eq!(reporter.release(), Some(Report::released(Device::Mouse)));
    }

    proptest! {
        #[test]
        fn after_any_wishes_the_last_report_of_each_device_is_what_is_wanted(
            wishes in prop::collection::vec((0_usize..6, 0_u8..=100, any::<bool>()), 1..40),
        ) {
            let names = ["", "key:a", "key:ctrl", "click:left", "button:3", "axis:z+"];
            let mut reporter = Reporter::default();
            let mut known = Device::ALL.map(Report::released);
            for (name, percent, is_interrupted) in wishes {
                if is_interrupted {
                    reporter.interrupt();
                }
                let wanted = Output::from_name(names[name]).zip(Percent::new(percent));
                while let Some(report) = reporter.next(wanted) {
                    known[report.device as usize] = report;
                    let pressed = known.iter().filter(|one| **one != Report::released(one.device));
                    prop_assert!(pressed.count() <= 1);
                }
                let expected = Device::ALL.map(|device| match wanted {
                    Some((output, strength)) if output.device() == device => Report::pressed(output, strength),
                    _ => Report::released(device),
                });
                prop_assert_eq!(known, expected);
            }
        }
    }
}
