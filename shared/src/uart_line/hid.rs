//! Outputs to a computer on the line: those of open, close, wave-in, wave-out and pinch.
//!
//! ```text
//! outputs = switch "," output "," output "," output "," output "," output
//! switch  = "on" | "off"
//! output  = such as "key:space" | "-"     crate::hid::Output
//! gesture = a label but relax
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::command::Switch;
use super::fields::{Fields, Reader, Writer, field};
use crate::hid::{Output, Settings};
use crate::intent::Intent;

/// Codec of a label that may have an output.
pub(super) struct Gesture;
field!(Gesture => Intent: |text, label| text.write_str(label.name()), |text| {
    Intent::from_name(text).filter(|label| *label != Intent::Relax)
});

field!(Output => Self: |text, output| {
    let [kind, name] = output.names();
    write!(text, "{kind}:{name}")
}, Self::from_name);

impl Fields<'_> for Settings {
    type Value = Self;
    const COUNT: usize = 1 + crate::hid::GESTURES;

    fn write(settings: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        Switch::write(&settings.on, line)?;
        let mut outputs = settings.outputs.iter();
        outputs.try_for_each(|output| Option::<Output>::write(output, line))
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        let mut settings = Self {
            on: Switch::read(line, "switch")?,
            ..Self::OFF
        };
        for output in &mut settings.outputs {
            *output = Option::<Output>::read(line, "output")?;
        }
        Ok(settings)
    }
}
