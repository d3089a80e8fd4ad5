//! `myointent board lock`: the lock of the labels, until the next start.

use anyhow::bail;
use clap::Subcommand;
use shared::stream::lock::LockTimes;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::Command;
use shared::uart_line::lock::LockCommand;
use shared::units::SAMPLE_RATE_HZ;

use crate::board::Board;

/// Request about the lock.
#[derive(Clone, Copy, Debug, Subcommand)]
pub(super) enum LockRequest {
    /// Lock labels at once, and again after each rest.
    On {
        /// Seconds that the hand has to be held open, 0.5 to 10.
        #[arg(long, default_value_t = 1.5, value_name = "SECONDS")]
        sign: f64,
        /// Seconds of rest after which labels are locked again, 1 to 600.
        #[arg(long, default_value_t = 10.0, value_name = "SECONDS")]
        rest: f64,
    },
    /// Lock labels no longer.
    Off,
    /// Lock labels now.
    Lock,
    /// Unlock them now.
    Unlock,
    /// Say whether labels are locked.
    State,
}

/// Sends the command, and returns what the board answers, in words.
pub(super) fn run(board: &mut Board, request: LockRequest) -> anyhow::Result<String> {
    let samples = |seconds: f64| (seconds * f64::from(SAMPLE_RATE_HZ)).round() as u32;
    let command = match request {
        LockRequest::On { sign, rest } => {
            let times = LockTimes {
                sign: samples(sign),
                rest: samples(rest),
            };
            if !times.are_allowed() {
                bail!("--sign is 0.5 to 10, and --rest 1 to 600 seconds, found {sign} and {rest}");
            }
            LockCommand::Set(times)
        }
        LockRequest::Off => LockCommand::Off,
        LockRequest::Lock => LockCommand::Hold { is_locked: true },
        LockRequest::Unlock => LockCommand::Hold { is_locked: false },
        LockRequest::State => LockCommand::State,
    };
    let lock = board.ask(Command::Lock(command), |answer| match answer {
        Answer::Lock(lock) => Some(*lock),
        _ => None,
    })?;
    let seconds = |samples: u32| f64::from(samples) / f64::from(SAMPLE_RATE_HZ);
    Ok(lock.map_or_else(
        || "no lock: `lock on` sets one until the next start\n".to_owned(),
        |lock| {
            let state = if lock.locked { "locked" } else { "unlocked" };
            let (sign, rest) = (seconds(lock.times.sign), seconds(lock.times.rest));
            format!(
                "{state}: hold the hand open for {sign} s to unlock; {rest} s of rest lock again\n"
            )
        },
    ))
}
