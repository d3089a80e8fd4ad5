//! Text for a board's answers.

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
pub(super) fn identified(identity: &Identity<'_>) -> String {
    let Identity {
        version,
        revision,
        image,
        ..
    } = identity;
    let model = match identity.model {
        Some(checksum) => format!("{checksum:08x} (the last four bytes of its file)"),
        None => "refused; the board's lines say why".to_owned(),
    };
    let mut armband = match identity.armband {
        Some(armband) => armband.to_string(),
        None => "none connected".to_owned(),
    };
    if let Some(firmware) = identity.firmware {
        let (major, minor, patch) = (firmware.major, firmware.minor, firmware.patch);
        armband += &format!(", firmware {major}.{minor}.{patch}");
    }
    if let Some(battery) = identity.battery {
        armband += &format!(", battery {battery} %");
    }
    format!("program   {version}, {revision}, {image}\nmodel     {model}\narmband   {armband}\n")
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

pub(super) fn counted(counts: &Counts) -> String {
    let rows = COUNTS.iter().zip(counts.numbers());
    rows.map(|(name, number)| format!("{number:>10}  {name}\n"))
        .collect()
}

pub(super) fn placed(alignment: Alignment) -> String {
    let turn = match alignment.turn() {
        0 => "worn as in training".to_owned(),
        turn => format!("turned by {turn} of 8 places"),
    };
    let other = if alignment.mirrored() {
        ", on the other arm"
    } else {
        ""
    };
    turn + other
}

pub(super) fn bound(binding: Binding) -> String {
    let following = match binding.following {
        Following::Pinned(address) => format!("{address}, given when the program was built"),
        Following::Bound(address) => format!("{address} is bound"),
        Following::Strongest => "none is bound: the strongest armband is followed".to_owned(),
        Following::Nobody => "none is bound, and none is followed".to_owned(),
        Following::Pairing => "a pairing is in progress".to_owned(),
    };
    let kept = if binding.is_kept {
        ""
    } else {
        "; not kept in flash yet: the page is written once the connection has ended"
    };
    following + kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_count_has_its_name() {
        let text = counted(&Counts::default());
        assert_eq!(text.lines().count(), Counts::default().numbers().len());
    }
}
