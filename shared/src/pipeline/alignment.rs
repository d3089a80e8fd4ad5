//! Alignment as a part of the pipeline: which electrode is which, while the stream continues.

mod arm;

use super::Pipeline;
use crate::calibration::FAVOUR;
use crate::model::Encode;
use crate::stream::alignment::{
    Aligner, Alignment, AlignmentOutcome, AlignmentProgress, Arm, ArmDecision, Fit, GESTURES, Poor,
    Profile, Template,
};
use crate::stream::preprocess::Preprocessor;
use crate::uart_line::alignment::{AlignmentReport, AlignmentState, Quality};
use crate::uart_line::calibration::CalibrationState;
use crate::units::{PATCH, Patch, Sample};

/// Placement of the armband, as far as a pipeline knows it.
#[derive(Debug, Default)]
pub(super) struct Placement {
    /// Template that alignments are found by.
    pub(super) template: Option<Template>,
    /// Alignment in force.
    pub(super) current: Alignment,
    /// Alignment of each new connection: that under which the head in use was learnt.
    pub(super) learnt: Alignment,
    /// Whether `current` was found or given, not assumed.
    pub(super) is_known: bool,
    stage: Stage,
    view: View,
    news: Option<News>,
}

/// Stage of an alignment.
#[derive(Debug, Default)]
enum Stage {
    /// No alignment is in progress.
    #[default]
    Idle,
    /// Gestures are waited for.
    Gestures(Aligner),
    /// The model decides on which arm the armband is.
    Arm(ArmDecision),
}

impl Stage {
    /// Gestures found so far; none if no alignment is in progress.
    const fn gestures(&self) -> Option<u8> {
        match self {
            Self::Idle => None,
            Self::Gestures(aligner) => Some(aligner.gestures()),
            Self::Arm(_) => Some(GESTURES),
        }
    }
}

/// The stream as the alignment in progress sees it: not normalized, as the template was measured, in patches of its own.
#[derive(Debug, Default)]
struct View {
    preprocessor: Preprocessor,
    patch: Patch,
    filled: usize,
}

impl View {
    /// Takes a sample; returns the patch that it completes.
    fn push(&mut self, sample: Sample) -> Option<&Patch> {
        self.patch[self.filled] = self.preprocessor.push(sample)?;
        self.filled += 1;
        if self.filled < PATCH {
            return None;
        }
        self.filled = 0;
        Some(&self.patch)
    }
}

/// Report that is due.
#[derive(Clone, Copy, Debug)]
struct News {
    state: AlignmentState,
    gestures: u8,
    quality: Option<Quality>,
}

impl News {
    /// A report without a result.
    const fn of(state: AlignmentState, gestures: u8) -> Self {
        Self {
            state,
            gestures,
            quality: None,
        }
    }

    fn result(state: AlignmentState, fit: Fit) -> Self {
        Self {
            state,
            gestures: GESTURES,
            quality: Some(fit.into()),
        }
    }
}

/// Phase of the alignment, for an LED.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AlignmentPhase {
    /// No alignment was found or given since the armband was connected.
    None,
    /// Gestures are waited for.
    Waiting,
    /// An alignment was found or given, and is in force.
    Aligned,
}

impl<E: Encode> Pipeline<'_, E> {
    /// The template of the model, without which there is no alignment; none before the first call.
    pub const fn set_template(&mut self, template: Option<Template>) {
        self.placement.template = template;
    }

    /// The alignment in force. At first and after a disconnection that under which the head in use was learnt,
    /// [`Alignment::NONE`] for the model's own.
    #[must_use]
    pub const fn alignment(&self) -> Alignment {
        self.placement.current
    }

    /// The phase, for an LED. An alignment that failed leaves the phase before it.
    #[must_use]
    pub const fn alignment_phase(&self) -> AlignmentPhase {
        if self.placement.stage.gestures().is_some() {
            AlignmentPhase::Waiting
        } else if self.placement.is_known {
            AlignmentPhase::Aligned
        } else {
            AlignmentPhase::None
        }
    }

    /// Begins an alignment, anew if one is in progress. Labels go on meanwhile under the old one. `arm` is what is known of the
    /// arm, whatever the alignment in force says.
    pub fn begin_alignment(&mut self, arm: Arm) {
        self.end_alignment();
        self.end_calibration(CalibrationState::Cancelled);
        let placement = &mut self.placement;
        placement.view = View::default();
        let state = if placement.template.is_some() {
            let arm = arm.seen_from(placement.current);
            placement.stage = Stage::Gestures(Aligner::new(arm));
            AlignmentState::Waiting
        } else {
            AlignmentState::Unavailable
        };
        placement.news = Some(News::of(state, 0));
    }

    /// Ends an alignment in progress; the alignment in force stays.
    pub fn cancel_alignment(&mut self) {
        if let Some(gestures) = self.end_alignment() {
            self.placement.news = Some(News::of(AlignmentState::Cancelled, gestures));
        }
    }

    /// Puts an alignment in force, such as one that was stored, and ends one in progress.
    pub fn set_alignment(&mut self, alignment: Alignment) {
        self.end_alignment();
        self.end_calibration(CalibrationState::Cancelled);
        self.placement.news = Some(News::of(AlignmentState::Set, 0));
        self.realign(alignment);
    }

    /// Ends an alignment in progress, if any, without a report; returns the gestures found so far.
    pub(super) fn end_alignment(&mut self) -> Option<u8> {
        let stage = core::mem::take(&mut self.placement.stage);
        if matches!(stage, Stage::Arm(_)) {
            // The encoder has taken the window in other placements.
            self.encode_anew();
        }
        stage.gestures()
    }

    /// The newest report about the alignment since the last call, to be written on the UART; to be called after every other
    /// method. What was not taken is replaced by what comes later.
    pub fn take_alignment_report(&mut self) -> Option<AlignmentReport> {
        let News {
            state,
            gestures,
            quality,
        } = self.placement.news.take()?;
        Some(AlignmentReport {
            sequence: self.output.next_sequence(),
            emitted: self.window.newest,
            state,
            gestures,
            alignment: self.placement.current,
            quality,
        })
    }

    /// The armband may have been taken off.
    pub(super) fn drop_alignment(&mut self) {
        let gestures = self.end_alignment();
        let placement = &mut self.placement;
        if gestures.is_some() || placement.current != placement.learnt {
            let gestures = gestures.unwrap_or(0);
            placement.news = Some(News::of(AlignmentState::Disconnected, gestures));
            placement.current = placement.learnt;
        }
        placement.is_known = placement.learnt != Alignment::NONE;
    }

    /// The next sample does not follow the previous one. The armband need not have moved.
    pub(super) fn interrupt_alignment(&mut self) {
        if let Stage::Gestures(aligner) = &mut self.placement.stage {
            aligner.interrupt();
            self.placement.view = View::default();
        }
        self.interrupt_decision();
    }

    /// Shows a sample to the alignment in progress.
    pub(super) fn watch(&mut self, sample: Sample) {
        let placement = &mut self.placement;
        let (Stage::Gestures(aligner), Some(template)) =
            (&mut placement.stage, &placement.template)
        else {
            return;
        };
        let Some(patch) = placement.view.push(placement.current.apply(sample)) else {
            return;
        };
        let progress = aligner.push(patch, template);
        if progress == AlignmentProgress::Gesture {
            let gestures = aligner.gestures();
            placement.news = Some(News::of(AlignmentState::Waiting, gestures));
        }
        self.proceed(progress);
    }

    /// Aligns by an opening that fills the window; its profile is as received.
    pub(super) fn align_by(&mut self, opening: Profile) {
        let current = self.placement.current;
        let arm = self.calibration.arm().seen_from(current);
        if let Some(template) = &self.placement.template {
            let opening = opening.aligned(current);
            let progress = AlignmentProgress::of(opening, arm, u64::MAX, template, FAVOUR);
            self.proceed(progress);
        }
    }

    fn proceed(&mut self, progress: AlignmentProgress) {
        match progress {
            AlignmentProgress::Waiting | AlignmentProgress::Gesture => {}
            AlignmentProgress::Undecided(mut decision) => {
                decision.start(self.window.ring.complete());
                self.placement.stage = Stage::Arm(decision);
                if !self.has_model() {
                    self.interrupt_decision();
                }
            }
            AlignmentProgress::Done(outcome) => self.finish(outcome),
        }
    }

    /// Ends an alignment with an outcome.
    fn finish(&mut self, outcome: AlignmentOutcome) {
        let placement = &mut self.placement;
        let gestures = placement.stage.gestures().unwrap_or(GESTURES);
        placement.stage = Stage::Idle;
        placement.news = Some(match outcome {
            AlignmentOutcome::Aligned(fit) => News::result(AlignmentState::Aligned, fit),
            AlignmentOutcome::Poor(fit, Poor::Distance) => {
                News::result(AlignmentState::PoorDistance, fit)
            }
            AlignmentOutcome::Poor(fit, Poor::Margin) => {
                News::result(AlignmentState::PoorMargin, fit)
            }
            AlignmentOutcome::Timeout => News::of(AlignmentState::Timeout, gestures),
        });
        // A calibration has one opening, of three seconds.
        if let (true, Some(news)) = (self.calibration.is_busy(), &mut placement.news) {
            news.gestures = 1;
        }
        if let AlignmentOutcome::Aligned(fit) = outcome {
            self.realign(self.placement.current.then(fit.alignment));
        }
    }

    /// Rearranges all samples so far, and has the encoder take them again.
    pub(super) fn realign(&mut self, alignment: Alignment) {
        self.placement.is_known = true;
        let change = self.placement.current.inverse().then(alignment);
        if change == Alignment::NONE {
            return;
        }
        self.placement.current = alignment;
        self.window.rearrange(change);
        self.calibration.realigned();
        self.encode_anew();
    }
}
