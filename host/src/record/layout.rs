//! Writer of recordings in ReactEMG's csv layout, with further columns that its readers ignore.
//!
//! `gt` is the label of the muscle. Columns after the channels: `sample`, the index in the stream; `cue`; `trial`, the attempt;
//! `used`, 0 if the trial is not used; `bridged`, 1 if the sample is missing and repeats the one before; `turn` and `mirrored`,
//! the placement of the armband: the reader aligns the channels by it, as the board does.

use std::fmt::Write as _;
use std::ops::Range;

use shared::intent::Intent;
use shared::units::CHANNELS;

use super::assembly::{Part, Take};
pub use recordings::readers::formats::react_emg::{
    MIRRORED_COLUMN, MUSCLE_COLUMN, RECORDER_COLUMNS, TURN_COLUMN,
};

/// Formats samples of a part as csv; `synthetic` marks them as such.
pub(crate) fn csv(take: &Take, part: &Part, samples: Range<usize>, synthetic: bool) -> String {
    let channels: String = (0..CHANNELS)
        .map(|channel| format!(",emg_{channel}"))
        .collect();
    let muscle = if synthetic {
        format!(",{MUSCLE_COLUMN}")
    } else {
        String::new()
    };
    let mut text = format!(
        "gt{channels},{},{TURN_COLUMN},{MIRRORED_COLUMN}{muscle}\n",
        RECORDER_COLUMNS.join(",")
    );
    let class = |label: Option<Intent>| match label {
        Some(intent) => intent.class().to_string(),
        None => "-1".to_owned(),
    };
    for place in samples {
        text += &class(part.labels[place]);
        for value in part.samples[place] {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{value}");
        }
        let (trial, cue) = (part.trials[place], class(part.cues[place]));
        let used = u8::from(!take.bad.contains_key(&trial));
        let placement = part.placements[place];
        let bridged = u8::from(part.bridged[place]);
        let _ = write!(
            text,
            ",{},{cue},{trial},{used},{bridged},{},{}",
            part.index[place],
            placement.turn(),
            u8::from(placement.mirrored())
        );
        if synthetic {
            let _ = write!(text, ",{}", class(part.labels[place]));
        }
        text.push('\n');
    }
    text
}
