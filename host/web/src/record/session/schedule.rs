//! Cue blocks of a guided session: which one is due.

use std::collections::VecDeque;

use crate::record::protocol::{Course, CueBlock, MotionStep};

/// Cue blocks of a round that are due, and the current one.
#[derive(Debug)]
pub(super) struct RoundSchedule {
    rounds: u32,
    blocks: Vec<CueBlock>,
    /// Indices of the blocks that are due.
    due: VecDeque<usize>,
    /// Indices of the current block and its step.
    current: Option<(usize, usize)>,
    /// Index of the previous block.
    previous: Option<usize>,
}

impl RoundSchedule {
    /// Creates the schedule; one of a free session has no blocks.
    pub(super) fn new(course: &Course) -> Self {
        let (rounds, blocks) = match course {
            Course::Guided { rounds, blocks } => (*rounds, blocks.clone()),
            Course::Free { .. } => (0, Vec::new()),
        };
        Self {
            rounds,
            blocks,
            due: VecDeque::new(),
            current: None,
            previous: None,
        }
    }

    pub(super) const fn rounds(&self) -> u32 {
        self.rounds
    }

    pub(super) fn begin_round(&mut self) {
        self.due = (0..self.blocks.len()).collect();
        self.current = None;
        self.previous = None;
    }

    /// Begins the block that is due and returns its first step; none after the last block of the round.
    pub(super) fn begin_block(&mut self) -> Option<MotionStep> {
        let block = self.due.pop_front()?;
        self.previous = self.current.map(|(block, _)| block);
        self.current = Some((block, 0));
        self.blocks[block].steps.first().copied()
    }

    /// Advances the current block and returns its next step; none at its end.
    pub(super) fn next_step(&mut self) -> Option<MotionStep> {
        let (block, step) = self.current?;
        let next = self.blocks[block].steps.get(step + 1).copied()?;
        self.current = Some((block, step + 1));
        Some(next)
    }

    /// Makes the current block due again.
    pub(super) fn put_back(&mut self) {
        if let Some((block, _)) = self.current.take() {
            self.due.push_front(block);
        }
        self.previous = None;
    }

    /// Makes the previous and the current block due again, in this order.
    pub(super) fn put_back_both(&mut self) {
        let previous = self.previous.take();
        self.put_back();
        if let Some(block) = previous {
            self.due.push_front(block);
        }
    }

    /// Number of blocks done in this round, and of all.
    pub(super) fn progress(&self) -> (usize, usize) {
        let left = self.due.len() + usize::from(self.current.is_some());
        (
            self.blocks.len() - left.min(self.blocks.len()),
            self.blocks.len(),
        )
    }

    /// Steps after the current one, in this round.
    pub(super) fn upcoming(&self) -> impl Iterator<Item = MotionStep> {
        let current = self
            .current
            .into_iter()
            .flat_map(|(block, step)| self.blocks[block].steps.iter().skip(step + 1));
        let due = self.due.iter().flat_map(|&block| &self.blocks[block].steps);
        current.chain(due).copied()
    }

    /// Samples of a round.
    pub(super) fn round_samples(&self) -> u64 {
        let steps = self.blocks.iter().flat_map(|block| &block.steps);
        steps.map(|step| u64::from(step.samples)).sum()
    }
}
