//! Recordings as csv, in ReactEMG's layout, with further columns that its readers ignore. `gt` is the label of the muscle.
//! Columns after the channels: `sample`, the index in the stream; `cue`; `trial`, the attempt; `used`, 0 if the trial is not
//! used; `bridged`, 1 if the sample is missing and repeats the one before; `movement`, the name of another movement where cue
//! or label is -2; `turn` and `mirrored`, the placement of the armband: the reader aligns the channels by it, as the board
//! does.

use std::fmt::Write as _;
use std::ops::Range;

use recordings::description::own::{
    MIRRORED_COLUMN, MOVEMENT_COLUMN, MUSCLE_COLUMN, RECORDER_COLUMNS, TURN_COLUMN,
};
use recordings::imu;
use recordings::labels::motion::Motion;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use super::assembly::{AssembledRecording, Assembly};

/// Greatest number of samples of a recording: an hour, a third of what readers take from one file.
const LONGEST: usize = 3600 * SAMPLE_RATE_HZ as usize;

/// Parts of the recordings that become a file each: those in which something was asked for, none longer than an hour.
pub fn pieces(assembly: &Assembly) -> impl Iterator<Item = (&AssembledRecording, Range<usize>)> {
    let is_cued = |part: &&AssembledRecording| part.cues.iter().any(|cue| *cue != Motion::Unknown);
    assembly.parts.iter().filter(is_cued).flat_map(|part| {
        let files = part.files(LONGEST).into_iter();
        files.map(move |samples| (part, samples))
    })
}

/// Formats the movement beside samples of a part; none without any.
pub fn movement(part: &AssembledRecording, samples: &Range<usize>) -> Option<String> {
    let rows = part.movement.iter().filter(|(at, _)| samples.contains(at));
    let rows: Vec<_> = rows.map(|&(at, imu)| (at - samples.start, imu)).collect();
    (!rows.is_empty()).then(|| imu::text(&rows))
}

/// Formats samples of a part as csv; `synthetic` marks them as such.
pub fn csv(
    assembly: &Assembly,
    part: &AssembledRecording,
    samples: Range<usize>,
    synthetic: bool,
) -> String {
    let channels: String = (0..CHANNELS)
        .map(|channel| format!(",emg_{channel}"))
        .collect();
    let muscle = if synthetic {
        format!(",{MUSCLE_COLUMN}")
    } else {
        String::new()
    };
    let mut text = format!(
        "gt{channels},{},{MOVEMENT_COLUMN},{TURN_COLUMN},{MIRRORED_COLUMN}{muscle}\n",
        RECORDER_COLUMNS.join(",")
    );
    for at in samples {
        let (motion, cue) = (part.motions[at], part.cues[at]);
        text += &motion.number().to_string();
        for value in part.samples[at] {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{value}");
        }
        let trial = part.trials[at];
        let used = u8::from(!assembly.rejected.contains_key(&trial));
        let placement = part.placements[at];
        let bridged = u8::from(part.bridged[at]);
        let movement = [motion, cue]
            .into_iter()
            .find(|motion| matches!(motion, Motion::Other(_)));
        let _ = write!(
            text,
            ",{},{},{trial},{used},{bridged},{},{},{}",
            part.index[at],
            cue.number(),
            movement.map_or("", Motion::name),
            placement.turn(),
            u8::from(placement.mirrored())
        );
        if synthetic {
            let _ = write!(text, ",{}", motion.number());
        }
        text.push('\n');
    }
    text
}
