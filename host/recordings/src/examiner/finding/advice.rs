//! Severity of a finding, and advice.

use shared::units::CHANNELS;

use super::{Finding, Severity};

impl Finding {
    /// Severity of the finding if the recording is kept.
    pub fn severity(&self) -> Severity {
        match self {
            Self::Known(_) => Severity::Note,
            Self::Hum {
                channels, percent, ..
            } if channels.len() == CHANNELS && *percent > 50.0 => Severity::Serious,
            Self::Copy { person: true, .. } => Severity::Serious,
            _ => Severity::Warning,
        }
    }

    /// Name of the kind, by which findings are grouped.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Known(_) => "known",
            Self::Short { .. } => "short",
            Self::Scale { .. } => "scale",
            Self::Constant { .. } => "constant",
            Self::OneSided => "one-sided",
            Self::Counter { .. } => "counter",
            Self::Clipped { .. } => "clipped",
            Self::FewChannels { .. } => "few-channels",
            Self::Dead { .. } => "silent-channel",
            Self::SameChannel { .. } => "same-channel",
            Self::Saturated { .. } => "saturated-channel",
            Self::Hum { .. } => "hum",
            Self::Rate { .. } => "rate",
            Self::Gap { .. } => "gap",
            Self::ClockUnclear { .. } => "clock-unclear",
            Self::Polled { .. } => "polled",
            Self::Held { .. } => "held",
            Self::Repeats { .. } => "repeats",
            Self::Standstill { .. } => "standstill",
            Self::Unrelated { .. } => "unrelated-samples",
            Self::Resembling { .. } => "resembling-samples",
            Self::Devices { .. }
            | Self::ManyColumns { .. }
            | Self::ManyChannels { .. }
            | Self::InTurn { .. } => "two-armbands",
            Self::Windows { .. } => "windows",
            Self::Copy { .. } => "copy",
            Self::Overlap { .. } => "overlap",
        }
    }

    /// Advice on what to do; empty if there is nothing to do.
    pub fn advice(&self) -> String {
        match self {
            Self::Known(_) => "",
            Self::Short { .. } => "record longer",
            Self::Scale { scale, .. } => return scale.advice(),
            Self::Constant { .. } | Self::FewChannels { .. } => {
                "check that the armband streams, and that the columns are the EMG channels"
            }
            Self::OneSided => "record in EMG mode 2 (filtered, not rectified) at 200 Hz",
            Self::Counter { .. } => "take the eight columns beside it for the channels",
            Self::Clipped { .. } => "check the scale: counts from -128 to 127",
            Self::Dead { .. } => {
                "press the electrode against the skin, wipe skin and electrode; if it stays silent, it is broken"
            }
            Self::SameChannel { .. } => "check how the columns were written",
            Self::Saturated { .. } => "less force, or move the armband a little",
            Self::Hum { .. } => {
                "record in EMG mode 2, which filters it, not in mode 3; wipe the electrodes and keep away from mains cables"
            }
            Self::Rate { .. } => {
                "record at 200 Hz: missing samples cannot be made, and times would be wrong by this factor"
            }
            Self::Gap { .. } => "nothing is joined across a gap; record without losses if there are many",
            Self::ClockUnclear { .. } => {
                "check that the rows are 200 a second, or give times in s, ms, us or ns (time_ms)"
            }
            Self::Polled { .. } => "take samples from the armband's notifications, not at a rate of your own",
            Self::Held { .. } | Self::Repeats { .. } => {
                "take each sample once, from the armband's notifications, not at a rate of your own"
            }
            Self::Standstill { .. } => "the armband did not stream then: cut the rows out, into two files",
            Self::Unrelated { .. } => "check that the armband was recorded at 200 Hz, each sample once",
            Self::Resembling { .. } => "give the armband's own samples, 200 a second, as EMG mode 2 sends them",
            Self::Devices { .. } => "keep the rows of one armband in a file",
            Self::ManyColumns { .. } | Self::ManyChannels { .. } => "keep the columns of one armband in a file",
            Self::Windows { .. } => "write each sample, channels 1 to 8, into a row of its own, with its label",
            Self::InTurn { .. } => "write each armband's rows into a file of its own",
            Self::Copy { person: true, .. } => "one of the names is wrong: remove the copy that is",
            Self::Copy { .. } => "remove the copy",
            Self::Overlap { .. } => "remove one of the two: a gesture would count twice",
        }
        .to_owned()
    }
}
