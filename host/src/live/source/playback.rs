//! A recording or a simulated person, through the device's pipeline in real time.

use std::time::Instant;

use web::playback::{LATE, PERIOD, Playback, SampleSource};
use web::scored_pipeline::ScoredPipeline;

use super::Context;

/// Samples to play in real time, and the model to run on them.
#[derive(Debug)]
pub(crate) struct PlaybackSource {
    /// `demo` or `replay`, and the name of the source.
    pub(crate) named: (&'static str, String),
    pub(crate) model: Vec<u8>,
    pub(crate) samples: SampleSource,
    /// Speed-up, at least 1.
    pub(crate) speed: u32,
}

impl PlaybackSource {
    /// Plays until it is stopped.
    ///
    /// # Errors
    /// When the model is refused.
    pub(crate) fn run(self, context: &Context) -> anyhow::Result<()> {
        let hub = &context.hub;
        let scored = ScoredPipeline::open(&self.model)?;
        let emit = &mut |event| hub.publish(&event);
        let mut playback = Playback::begin(self.named, self.samples, scored, hub.now(), emit);
        let mut due = Instant::now();
        while !context.stop.requested() {
            let now = Instant::now();
            std::thread::sleep(due.saturating_duration_since(now));
            if now.saturating_duration_since(due) > LATE {
                due = now;
            }
            due += PERIOD / self.speed.max(1);
            while let Ok(request) = context.requests.try_recv() {
                playback.request(hub.now(), &request, emit);
            }
            playback.step(hub.now(), emit);
        }
        Ok(())
    }
}
