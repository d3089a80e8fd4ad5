//! Commands to a pipeline, as a board carries them out between two samples. News comes with the reports: those returned, those of
//! the alignment and those of the calibration.

use super::{Pipeline, Reports};
use crate::model::Encode;
use crate::stream::alignment::{Alignment, Arm};
use crate::stream::smoother::Gate;
use crate::uart_line::answer::{Accepted, Answer, Refusal};
use crate::uart_line::calibration::{CalibrateCommand, CalibrationReport, CalibrationState};
use crate::uart_line::command::AlignCommand;
use crate::uart_line::gate::GateCommand;
use crate::uart_line::lock::{LockCommand, Locking};
use crate::units::Millis;

/// Result of a command to a pipeline.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Done {
    /// The command about the alignment is accepted.
    Align(Accepted),
    /// Alignment in force.
    Alignment(Alignment),
    /// Gate in force from now on.
    Gate(Gate),
    /// Lock in force from now on.
    Lock(Option<Locking>),
    /// The command about the calibration is carried out.
    Calibrated,
}

impl Done {
    /// Answer on the line, where `calibration` answers a command about the calibration.
    pub fn answer(self, calibration: impl FnOnce() -> Answer<'static>) -> Answer<'static> {
        match self {
            Self::Align(accepted) => Answer::Align(accepted),
            Self::Alignment(alignment) => Answer::Alignment(alignment),
            Self::Gate(gate) => Answer::Gate(gate),
            Self::Lock(lock) => Answer::Lock(lock),
            Self::Calibrated => calibration(),
        }
    }
}

impl<E: Encode> Pipeline<'_, E> {
    /// Carries out a command about the alignment. `streams` says whether an armband streams, and `arm` what is known of the arm
    /// where the command says nothing of it.
    ///
    /// # Errors
    /// [`Refusal::NoStream`] where one is to begin without a stream.
    pub fn align(
        &mut self,
        command: AlignCommand,
        streams: bool,
        arm: Arm,
    ) -> Result<Done, Refusal> {
        match command {
            AlignCommand::State => {}
            AlignCommand::Begin(_) if !streams => return Err(Refusal::NoStream),
            AlignCommand::Begin(Arm::Unknown) => self.begin_alignment(arm),
            AlignCommand::Begin(told) => self.begin_alignment(told),
            AlignCommand::Cancel => self.cancel_alignment(),
            AlignCommand::Set(alignment) => self.set_alignment(alignment),
        }
        Ok(match Accepted::of(command) {
            Some(accepted) => Done::Align(accepted),
            None => Done::Alignment(self.alignment()),
        })
    }

    /// Carries out a command about the confidence gate.
    ///
    /// # Errors
    /// [`Refusal::Arguments`] where the model has no such margins.
    pub fn change_gate(&mut self, command: GateCommand) -> Result<Done, Refusal> {
        match command {
            GateCommand::Set(gate) if !self.set_gate(gate) => Err(Refusal::Arguments),
            GateCommand::Set(_) | GateCommand::State => Ok(Done::Gate(self.gate())),
        }
    }

    /// Carries out a command about the lock of the labels.
    pub fn change_lock(&mut self, command: LockCommand) -> Done {
        match command {
            LockCommand::Set(times) => self.set_lock(Some(times)),
            LockCommand::Off => self.set_lock(None),
            LockCommand::Hold { is_locked } => self.hold_lock(is_locked),
            LockCommand::State => {}
        }
        Done::Lock(self.lock().map(Locking::from))
    }

    /// Carries out a command about the calibration, but for [`CalibrateCommand::Forget`]: whoever keeps the calibration removes it.
    ///
    /// # Errors
    /// [`Refusal::NoStream`] where one is to begin without a stream.
    pub fn calibrate(
        &mut self,
        now: Millis,
        command: CalibrateCommand,
        streams: bool,
        arm: Arm,
    ) -> Result<Reports, Refusal> {
        match command {
            CalibrateCommand::Begin { .. } if !streams => return Err(Refusal::NoStream),
            CalibrateCommand::Begin { others } => {
                if let Some(reports) = self.begin_calibration(now, others, arm) {
                    return Ok(reports);
                }
                let unavailable = CalibrationReport::of(CalibrationState::Unavailable, None);
                self.calibration.news = Some(unavailable);
            }
            CalibrateCommand::Cancel => {
                self.cancel_calibration();
            }
            CalibrateCommand::Forget | CalibrateCommand::State => {}
        }
        Ok(Reports::default())
    }
}
