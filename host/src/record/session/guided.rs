//! The course of a guided session: which trial is due.

use std::collections::VecDeque;

use crate::record::protocol::{Course, Step, Trial};

/// The trials of a round that are due, and the one in progress.
#[derive(Debug)]
pub(super) struct Guided {
    rounds: u32,
    trials: Vec<Trial>,
    /// Places of those that are due.
    due: VecDeque<usize>,
    /// Place of the one in progress, and of its step.
    current: Option<(usize, usize)>,
    /// Place of the one before.
    before: Option<usize>,
}

impl Guided {
    /// Without a trial if the course is free.
    pub(super) fn new(course: &Course) -> Self {
        let (rounds, trials) = match course {
            Course::Guided { rounds, trials } => (*rounds, trials.clone()),
            Course::Free { .. } => (0, Vec::new()),
        };
        Self {
            rounds,
            trials,
            due: VecDeque::new(),
            current: None,
            before: None,
        }
    }

    pub(super) const fn rounds(&self) -> u32 {
        self.rounds
    }

    pub(super) fn begin_round(&mut self) {
        self.due = (0..self.trials.len()).collect();
        self.current = None;
        self.before = None;
    }

    /// The first step of the trial that is due; none after the last one of the round.
    pub(super) fn begin_trial(&mut self) -> Option<Step> {
        let place = self.due.pop_front()?;
        self.before = self.current.map(|(place, _)| place);
        self.current = Some((place, 0));
        self.trials[place].steps.first().copied()
    }

    /// The next step of the trial in progress; none at its end.
    pub(super) fn next_step(&mut self) -> Option<Step> {
        let (place, step) = self.current?;
        let next = self.trials[place].steps.get(step + 1).copied()?;
        self.current = Some((place, step + 1));
        Some(next)
    }

    /// The trial in progress is due again.
    pub(super) fn put_back(&mut self) {
        if let Some((place, _)) = self.current.take() {
            self.due.push_front(place);
        }
        self.before = None;
    }

    /// The trial in progress and the one before are due again, that one first.
    pub(super) fn put_back_both(&mut self) {
        let before = self.before.take();
        self.put_back();
        if let Some(place) = before {
            self.due.push_front(place);
        }
    }

    /// Trials of the round that are done, and all of them.
    pub(super) fn progress(&self) -> (usize, usize) {
        let left = self.due.len() + usize::from(self.current.is_some());
        (
            self.trials.len() - left.min(self.trials.len()),
            self.trials.len(),
        )
    }

    /// The steps after the one in progress, in this round.
    pub(super) fn coming(&self) -> impl Iterator<Item = Step> {
        let current = self
            .current
            .into_iter()
            .flat_map(|(place, step)| self.trials[place].steps.iter().skip(step + 1));
        let due = self.due.iter().flat_map(|&place| &self.trials[place].steps);
        current.chain(due).copied()
    }

    /// Samples of a whole round.
    pub(super) fn round_samples(&self) -> u64 {
        let steps = self.trials.iter().flat_map(|trial| &trial.steps);
        steps.map(|step| u64::from(step.samples)).sum()
    }
}
