//! Trials of a guided session: which one is due.

use std::collections::VecDeque;

use crate::record::protocol::{Course, Step, Trial};

/// Trials of a round that are due, and the current one.
#[derive(Debug)]
pub(super) struct Guided {
    rounds: u32,
    trials: Vec<Trial>,
    /// Indices of the trials that are due.
    due: VecDeque<usize>,
    /// Indices of the current trial and its step.
    current: Option<(usize, usize)>,
    /// Index of the previous trial.
    before: Option<usize>,
}

impl Guided {
    /// Creates the course; one of a free session has no trials.
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

    /// Begins the trial that is due and returns its first step; none after the last trial of the round.
    pub(super) fn begin_trial(&mut self) -> Option<Step> {
        let place = self.due.pop_front()?;
        self.before = self.current.map(|(place, _)| place);
        self.current = Some((place, 0));
        self.trials[place].steps.first().copied()
    }

    /// Advances the current trial and returns its next step; none at its end.
    pub(super) fn next_step(&mut self) -> Option<Step> {
        let (place, step) = self.current?;
        let next = self.trials[place].steps.get(step + 1).copied()?;
        self.current = Some((place, step + 1));
        Some(next)
    }

    /// Makes the current trial due again.
    pub(super) fn put_back(&mut self) {
        if let Some((place, _)) = self.current.take() {
            self.due.push_front(place);
        }
        self.before = None;
    }

    /// Makes the previous and the current trial due again, in this order.
    pub(super) fn put_back_both(&mut self) {
        let before = self.before.take();
        self.put_back();
        if let Some(place) = before {
            self.due.push_front(place);
        }
    }

    /// Number of trials done in this round, and of all.
    pub(super) fn progress(&self) -> (usize, usize) {
        let left = self.due.len() + usize::from(self.current.is_some());
        (
            self.trials.len() - left.min(self.trials.len()),
            self.trials.len(),
        )
    }

    /// Steps after the current one, in this round.
    pub(super) fn coming(&self) -> impl Iterator<Item = Step> {
        let current = self
            .current
            .into_iter()
            .flat_map(|(place, step)| self.trials[place].steps.iter().skip(step + 1));
        let due = self.due.iter().flat_map(|&place| &self.trials[place].steps);
        current.chain(due).copied()
    }

    /// Samples of a round.
    pub(super) fn round_samples(&self) -> u64 {
        let steps = self.trials.iter().flat_map(|trial| &trial.steps);
        steps.map(|step| u64::from(step.samples)).sum()
    }
}
