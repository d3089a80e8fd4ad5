//! `myointent board calibrate`: the wearer's last layer, learnt on the board.

use std::io::Write as _;
use std::time::{Duration, Instant};

use anyhow::bail;
use clap::Subcommand;
use shared::calibration::Shown;
use shared::intent::Intent;
use shared::uart_line::answer::Answer;
use shared::uart_line::calibration::{
    CalibrateCommand, CalibrationReport, CalibrationState as State, name,
};
use shared::uart_line::command::Command;

use crate::board::{Board, BoardError};

/// Pause between two questions how far it is: a cue is said that late.
const AGAIN: Duration = Duration::from_millis(100);
/// Longest time of a calibration: two rounds of seven cues, a first window, other movement, and flash.
const PATIENCE: Duration = Duration::from_secs(80);

/// Request about the calibration.
#[derive(Clone, Copy, Debug, Subcommand)]
pub(super) enum CalibrateRequest {
    /// Say what to do, and wait for the result.
    Begin {
        /// Show other movement too, 6 s: fewer false activations, and a little less accuracy.
        #[arg(long)]
        other: bool,
    },
    /// End the one in progress; nothing changes.
    Cancel,
    /// Use the model's own last layer again.
    Forget,
    /// Say how far one is, and whether one is in use.
    State,
}

/// Sends the command, and says what the board asks for until it is over.
pub(super) fn run(board: &mut Board, request: CalibrateRequest) -> anyhow::Result<()> {
    let command = match request {
        CalibrateRequest::Begin { other } => CalibrateCommand::Begin { others: other },
        CalibrateRequest::Cancel => CalibrateCommand::Cancel,
        CalibrateRequest::Forget => CalibrateCommand::Forget,
        CalibrateRequest::State => CalibrateCommand::State,
    };
    let mut out = std::io::stdout();
    let end = Instant::now() + PATIENCE;
    let (mut report, mut is_in_use) = ask(board, command)?;
    let mut said = None;
    let waits = matches!(
        request,
        CalibrateRequest::Begin { .. } | CalibrateRequest::Forget
    );
    while waits
        && matches!(
            report.state,
            State::Teaching | State::Judging | State::Keeping
        )
        && Instant::now() < end
    {
        if said != Some(report) {
            said = Some(report);
            if let Some(cue) = report.cue {
                writeln!(out, "{}", told(cue))?;
            }
        }
        std::thread::sleep(AGAIN);
        (report, is_in_use) = ask(board, CalibrateCommand::State)?;
    }
    let result = result(report);
    if matches!(request, CalibrateRequest::Begin { .. }) && report.state != State::Done {
        bail!("not calibrated, the last layer is as before: {result}");
    }
    let in_use = if is_in_use {
        "a calibration"
    } else {
        "the model's own last layer"
    };
    writeln!(out, "{result}\nin use: {in_use}")?;
    Ok(())
}

/// Whether a calibration is in use; `None` on a board that is older than the question.
pub(super) fn is_in_use(board: &mut Board) -> Result<Option<bool>, BoardError> {
    match ask(board, CalibrateCommand::State) {
        Ok((_, is_in_use)) => Ok(Some(is_in_use)),
        Err(BoardError::Refused(_)) => Ok(None),
        Err(error) => Err(error),
    }
}

fn ask(
    board: &mut Board,
    command: CalibrateCommand,
) -> Result<(CalibrationReport, bool), BoardError> {
    board.ask(Command::Calibrate(command), |answer| match answer {
        Answer::Calibration(report, is_in_use) => Some((*report, *is_in_use)),
        _ => None,
    })
}

/// Instruction to the wearer.
fn told(cue: Shown) -> String {
    match cue {
        Shown::Intent(Intent::Relax) => "rest the arm".to_owned(),
        Shown::Intent(_) => format!("hold {}", name(cue)),
        Shown::Other => "move fingers and arm, but none of these gestures".to_owned(),
    }
}

fn result(report: CalibrationReport) -> String {
    let text = match report.state {
        State::Idle => "no calibration was made since the start",
        State::Teaching => "round one",
        State::Judging => "round two",
        State::Keeping => "being written to flash",
        State::Done => "calibrated",
        State::Worse => "what was learnt labels less right in round two than what was in use",
        State::Weak => {
            "the hold was not stronger than rest; rest the arm, hold each gesture firmly, and try again"
        }
        State::Unusable => "what was shown gives no usable weights; try again",
        State::Interrupted => "samples were lost, or the stream ended; try again",
        State::Cancelled => "it was cancelled",
        State::NotKept => "flash was not written; the model's own last layer is in use",
        State::Unavailable => {
            "this board has no memory for it (nRF52832), or its model no output for other movement"
        }
    };
    let cue = report
        .cue
        .map_or_else(String::new, |cue| format!(", at {}", name(cue)));
    let recalls = report.recalls.map_or_else(String::new, |recalls| {
        let [before, learnt] = [recalls.before, recalls.learnt].map(|one| f64::from(one) / 1000.0);
        format!(": recall {before:.3} before, {learnt:.3} learnt")
    });
    format!("{text}{cue}{recalls}")
}
