//! Labels as keys, buttons and axes of a USB keyboard, mouse or gamepad (HID).
//!
//! ```text
//! label, strength --Settings--> Output --Reporter--> Report --USB--> computer
//! ```
//!
//! At most one output is pressed at a time. It is released at every change of the label and in the safe state.
//! Format of reports and descriptors: USB-IF, Device Class Definition for HID 1.11, and HID Usage Tables.

mod output;
pub mod record;
mod report;

use crate::intent::{Intent, MAX_CLASSES};
use crate::stream::safe_state::Status;
pub use output::{Device, Output};
pub use report::{DESCRIPTOR_BYTES, REPORT_BYTES, Report, Reporter, descriptor};

/// Labels that may have an output: all but relax.
pub const GESTURES: usize = MAX_CLASSES - 1;

/// Outputs of the labels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Settings {
    /// Whether the computer sees them.
    pub on: bool,
    /// Outputs in class order, from open on.
    pub outputs: [Option<Output>; GESTURES],
}

/// Command about the outputs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum HidCommand {
    /// Show them to the computer, or no longer.
    Switch(bool),
    /// Give a label, which is not relax, this output, or none.
    Set(Intent, Option<Output>),
    /// Change nothing.
    State,
}

impl Settings {
    /// Nothing, and switched off.
    pub const OFF: Self = Self {
        on: false,
        outputs: [None; GESTURES],
    };

    /// Settings after a command.
    #[must_use]
    pub fn after(mut self, command: HidCommand) -> Self {
        match command {
            HidCommand::Switch(on) => self.on = on,
            HidCommand::Set(label, output) => {
                if let Some(place) = self.place(label) {
                    *place = output;
                }
            }
            HidCommand::State => {}
        }
        self
    }

    fn place(&mut self, label: Intent) -> Option<&mut Option<Output>> {
        self.outputs.get_mut(label.class().checked_sub(1)?)
    }

    /// Output that is pressed in this state.
    #[must_use]
    pub fn output(mut self, status: Status) -> Option<Output> {
        let is_pressed = self.on && status.valid();
        *self.place(status.label()).filter(|_| is_pressed)?
    }

    /// Devices that the computer sees, in the order of [`Device::ALL`].
    #[must_use]
    pub fn devices(&self) -> [bool; Device::ALL.len()] {
        Device::ALL.map(|device| {
            let mut outputs = self.outputs.iter().flatten();
            self.on && outputs.any(|output| output.device() == device)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::safe_state::Cause;

    #[test]
    fn a_label_has_its_output_while_it_is_valid_and_the_outputs_are_on() {
        let space = Output::from_name("key:space");
        let set = HidCommand::Set(Intent::Close, space);
        let off = Settings::OFF.after(set);
        let close = Status::Valid(Intent::Close);
        assert_eq!(off.output(close), None);
        let on = off.after(HidCommand::Switch(true));
        assert_eq!(on.output(close), space);
        for other in [
            Status::Valid(Intent::Relax),
            Status::Valid(Intent::Open),
            Status::Safe(Cause::Silence),
        ] {
            assert_eq!(on.output(other), None);
        }
        assert_eq!(on.after(HidCommand::State), on);
        assert_eq!(
            on.after(HidCommand::Set(Intent::Close, None)).output(close),
            None
        );
        assert_eq!(on.after(HidCommand::Set(Intent::Relax, space)), on);
    }

    #[test]
    fn the_computer_sees_the_devices_that_labels_use() {
        let with = |names: &[&str]| {
            let mut outputs = names.iter().map(|name| Output::from_name(name));
            let outputs = core::array::from_fn(|_| outputs.next().flatten());
            Settings { on: true, outputs }
        };
        assert_eq!(with(&[]).devices(), [false; 3]);
        assert_eq!(with(&["key:a", "key:b"]).devices(), [true, false, false]);
        assert_eq!(
            with(&["click:left", "axis:x+"]).devices(),
            [false, true, true]
        );
        let off = with(&["key:a"]).after(HidCommand::Switch(false));
        assert_eq!(off.devices(), [false; 3]);
    }
}
