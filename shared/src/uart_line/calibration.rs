//! State of a calibration on the line.
//!
//! ```text
//! state  = of `CalibrationState`
//! cue    = the intents of a label | "other" | "-"
//! before = number | "-"      recall of the head in use before, in thousandths, over round two
//! learnt = number | "-"      recall of the learnt head
//! in-use = "0" | "1"         whether a calibration is in use
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::fields::{Fields, Reader, Writer, field, fields};
use crate::calibration::Shown;
use crate::intent::Intent;
use crate::names::names;

names! {
    /// State of a calibration.
    #[derive(Default)]
    pub enum CalibrationState {
        /// None since the start, or the calibration was forgotten.
        #[default]
        Idle = "idle",
        /// Round one: do what the cue says until the next cue.
        Teaching = "teaching",
        /// Round two, the same; the learnt head is compared.
        Judging = "judging",
        /// The result is being written to flash.
        Keeping = "keeping",
        /// The learnt head is in use and kept.
        Done = "done",
        /// Nothing changed: the learnt head labels less right.
        Worse = "worse",
        /// Nothing changed: the hold of the cue was not 1.4 times as strong as rest.
        Weak = "weak",
        /// Nothing changed: what was shown gives no usable weights.
        Unusable = "unusable",
        /// Nothing changed: samples were lost, or the stream or the model ended.
        Interrupted = "interrupted",
        /// Nothing changed: ended on request, or by an alignment.
        Cancelled = "cancelled",
        /// Flash did not take it: the model's own head is in use.
        NotKept = "not-kept",
        /// The board has no memory for it (nRF52832), or the model no output for other movement.
        Unavailable = "unavailable",
    }
}

/// Command about the calibration.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum CalibrateCommand {
    /// Begin one.
    Begin {
        /// Whether other movement is shown too.
        others: bool,
    },
    /// End the one in progress; nothing changes.
    Cancel,
    /// Use the model's own head, from now on.
    Forget,
    /// Change nothing.
    State,
}

/// State, cue and result of a calibration.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct CalibrationReport {
    /// State.
    pub state: CalibrationState,
    /// Cue of the wearer, or the last one when it ended.
    pub cue: Option<Shown>,
    /// Recall in round two, in thousandths: of the head before, and of the learnt one.
    pub recalls: Option<Recalls>,
}

/// Two recalls in thousandths.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Recalls {
    /// Recall of the head before.
    pub before: u32,
    /// Recall of the learnt head.
    pub learnt: u32,
}

impl CalibrationReport {
    /// A report without a result.
    #[must_use]
    pub const fn of(state: CalibrationState, cue: Option<Shown>) -> Self {
        Self {
            state,
            cue,
            recalls: None,
        }
    }

    /// A report with the recalls of a judgement, 0 to 1.
    pub(crate) fn judged(state: CalibrationState, recalls: [f32; 2]) -> Self {
        let [before, learnt] = recalls.map(|recall| (recall * 1000.0 + 0.5) as u32);
        Self {
            state,
            cue: None,
            recalls: Some(Recalls { before, learnt }),
        }
    }
}

/// The comment that a board writes, CR LF included.
impl fmt::Display for CalibrationReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "# calibration: {}", self.state.name())?;
        if let Some(cue) = self.cue {
            write!(formatter, ", {}", name(cue))?;
        }
        if let Some(Recalls { before, learnt }) = self.recalls {
            write!(
                formatter,
                ", recall {before} of 1000 before, {learnt} learnt"
            )?;
        }
        formatter.write_str("\r\n")
    }
}

fields!(CalibrationReport { state: CalibrationState, cue: Option<Shown>, recalls: Option<Recalls> });
fields!(Recalls {
    before: u32,
    learnt: u32
});
field!(CalibrationState => Self: |text, state| text.write_str(state.name()), CalibrationState::from_name);
field!(Shown => Self: |text, cue| text.write_str(name(*cue)), |text| match text {
    OTHER => Some(Shown::Other),
    _ => Intent::from_name(text).map(Shown::Intent),
});

/// Name of other movement.
const OTHER: &str = "other";

/// Name of a cue on the line.
#[must_use]
pub const fn name(cue: Shown) -> &'static str {
    match cue {
        Shown::Intent(intent) => intent.name(),
        Shown::Other => OTHER,
    }
}
