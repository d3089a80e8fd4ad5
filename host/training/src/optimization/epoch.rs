//! The optimizer steps of one epoch.

use rand_chacha::ChaCha8Rng;

use super::checkpoint::Checkpoint;
use super::learner::Learner;
use super::optimizer::gradients;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunError;
use presets::training::LearningRate;

/// Epoch of a training.
pub(super) struct Epoch<'a> {
    /// Name in the progress bar.
    pub(super) title: &'a str,
    /// Number of the epoch, from 1.
    pub(super) number: usize,
    pub(super) schedule: &'a LearningRate,
    /// Generator of all random draws of the epoch.
    pub(super) rng: ChaCha8Rng,
    pub(super) interrupt: &'a Interrupt,
}

impl Epoch<'_> {
    /// Runs the steps of the epoch, from its beginning or from a checkpoint within it; calls `after` after each. Returns none if
    /// the user interrupts.
    pub(super) fn take<L: Learner>(
        mut self,
        learner: &L,
        mut training: Checkpoint<L::Model>,
        mut after: impl FnMut(&mut Checkpoint<L::Model>) -> Result<(), RunError>,
    ) -> Result<Option<Checkpoint<L::Model>>, RunError> {
        let items = learner.epoch(&mut self.rng);
        let bar = progress::bar(items.len(), self.title);
        let first = training.progress.step;
        let done = training.progress.within.as_ref().map_or(0, |within| {
            // The items are drawn again first; then the generator jumps to its position.
            self.rng.set_word_pos(within.drawn.into());
            within.steps
        });
        bar.inc(done as u64);
        for (at, item) in items.into_iter().enumerate().skip(done) {
            if self.interrupt.requested() {
                return Ok(None);
            }
            let shards = learner.shards(&item, &mut self.rng);
            let (gradients, metrics) = gradients(learner, &training.model, shards);
            for metric in metrics.iter().filter(|metric| metric.weight > 0.0) {
                let what = format!("training loss ({})", metric.name);
                finite(learner.name(), self.number, what, metric.mean)?;
            }
            let rate = self.schedule.rate(first + at);
            training.model = training.optimizer.step(rate, training.model, gradients);
            let within = training.progress.within.get_or_insert_default();
            within.steps = at + 1;
            // An epoch draws far less than 2^64 words.
            within.drawn = self.rng.get_word_pos() as u64;
            within.means.add(&metrics);
            bar.set_message(within.means.to_string());
            after(&mut training)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(Some(training))
    }
}

/// Refuses a loss that is not finite.
pub(super) fn finite(name: &str, epoch: usize, what: String, loss: f64) -> Result<(), RunError> {
    if loss.is_finite() {
        return Ok(());
    }
    Err(RunError::Diverged {
        name: name.to_owned(),
        epoch,
        what,
        loss,
    })
}
