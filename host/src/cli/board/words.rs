//! Text for a board's answers.

use std::fmt;

use shared::myo::Following;
use shared::stream::alignment::Alignment;
use shared::uart_line::alignment::AlignmentState;
use shared::uart_line::answer::{Binding, Charge, Counts, Identity};

/// Explains why an alignment did not succeed, and what to do.
pub(super) const fn why(state: AlignmentState) -> &'static str {
    match state {
        AlignmentState::PoorDistance => {
            "the gestures fit no placement; open the hand fully, nothing else, and try again"
        }
        AlignmentState::PoorMargin => {
            "the gestures fit several placements; open the hand more strongly, and try again"
        }
        AlignmentState::Timeout => "no two gestures in 30 s",
        AlignmentState::Cancelled => "it was cancelled",
        AlignmentState::Disconnected => "the armband was disconnected",
        AlignmentState::Unavailable => {
            "the model file has no template: `myointent template` makes one"
        }
        AlignmentState::Waiting | AlignmentState::Aligned | AlignmentState::Set => {
            "another one was put in force"
        }
    }
}

/// Prints an identity: program, model and armband, one a line.
pub(super) struct Identified<'a>(pub(super) &'a Identity<'a>);

impl fmt::Display for Identified<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Identity {
            version,
            revision,
            image,
            ..
        } = self.0;
        writeln!(f, "program   {version}, {revision}, {image}")?;
        match self.0.model {
            Some(checksum) => writeln!(
                f,
                "model     {checksum:08x} (the last four bytes of its file)"
            )?,
            None => writeln!(f, "model     refused; the board's lines say why")?,
        }
        match self.0.armband {
            Some(armband) => write!(f, "armband   {armband}")?,
            None => write!(f, "armband   none connected")?,
        }
        if let Some(firmware) = self.0.firmware {
            write!(
                f,
                ", firmware {}.{}.{}",
                firmware.major, firmware.minor, firmware.patch
            )?;
        }
        if let Some(battery) = self.0.battery {
            write!(f, ", battery {battery} %")?;
        }
        writeln!(f)
    }
}

/// Prints the charge of the board's own battery, in the line after an identity.
pub(super) fn charged(charge: Charge) -> String {
    let Charge {
        millivolts,
        percent,
    } = charge;
    format!("battery   {percent} %, {millivolts} mV\n")
}

/// Labels for [`Counts::numbers`], in the same order.
const COUNTS: [&str; 16] = [
    "connections",
    "connections that failed",
    "time-outs",
    "stalls of the stream",
    "set-ups that failed",
    "armbands refused for their firmware",
    "notifications",
    "samples lost",
    "samples given up",
    "duplicates",
    "swaps",
    "malformed packets",
    "foreign packets",
    "packets dropped: inference too slow",
    "lines dropped: line too slow",
    "raw lines dropped: line too slow",
];

pub(super) struct Counted<'a>(pub(super) &'a Counts);

impl fmt::Display for Counted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = COUNTS.iter().zip(self.0.numbers());
        rows.try_for_each(|(name, number)| writeln!(f, "{number:>10}  {name}"))
    }
}

pub(super) struct Placed(pub(super) Alignment);

impl fmt::Display for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(alignment) = self;
        match alignment.turn() {
            0 => f.write_str("worn as in training")?,
            turn => write!(f, "turned by {turn} of 8 places")?,
        }
        if alignment.mirrored() {
            f.write_str(", on the other arm")?;
        }
        Ok(())
    }
}

pub(super) struct Bound(pub(super) Binding);

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.following {
            Following::Pinned(address) => {
                write!(f, "{address}, given when the program was built")?;
            }
            Following::Bound(address) => write!(f, "{address} is bound")?,
            Following::Strongest => {
                f.write_str("none is bound: the strongest armband is followed")?
            }
            Following::Nobody => f.write_str("none is bound, and none is followed")?,
            Following::Pairing => f.write_str("a pairing is in progress")?,
        }
        if !self.0.is_kept {
            f.write_str(
                "; not kept in flash yet: the page is written once the connection has ended",
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_count_has_its_name() {
        let text = Counted(&Counts::default()).to_string();
        assert_eq!(text.lines().count(), Counts::default().numbers().len());
    }
}
