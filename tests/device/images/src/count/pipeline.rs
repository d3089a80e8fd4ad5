//! The pipeline as a whole and part by part, over the same samples.
//!
//! The whole gives the total. Each part runs again by itself with the same input; the difference
//! between the total and the parts is the rest: the loop, the safe state, the reports. Only patches of
//! a full window are counted, where every part does all its work.

use core::hint::black_box;

use shared::intent::MAX_LOGITS;
use shared::model::encoder::{Encoder, EncoderState};
use shared::model::file::Model;
use shared::model::{Encode, LookBackLogits};
use shared::pipeline::Pipeline;
use shared::stream::preprocess::Preprocessor;
use shared::stream::ring::{Origin, SampleRing};
use shared::stream::smoother::Smoother;
use shared::units::{LOOK_BACK, Millis, PATCH, Patch, SAMPLE_PERIOD_MS, Sample, SampleIndex};

use crate::spans::{Clock, Spans};

#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    preprocess: Spans,
    ring: Spans,
    /// Embed, attention, feed-forward, head.
    encoder_parts: [Spans; 4],
    smoother: Spans,
    rest: Spans,
    /// The whole pipeline.
    pub total: Spans,
    /// The encoder without a probe: its parts add up to it.
    encoder: Spans,
}

impl Counts {
    /// Parts with their names, in the pipeline's order; then the two sums.
    pub fn named(&self) -> [(&'static str, Spans); 10] {
        let [embed, attention, feed_forward, head] = self.encoder_parts;
        [
            ("preprocess", self.preprocess),
            ("ring", self.ring),
            ("embed", embed),
            ("attention", attention),
            ("feed-forward", feed_forward),
            ("head", head),
            ("smoother", self.smoother),
            ("rest", self.rest),
            ("total", self.total),
            ("encoder", self.encoder),
        ]
    }
}

/// The encoder behind a call, so that it is compiled once for the pipeline and for the parts.
#[derive(Clone, Copy, Debug)]
pub struct Apart<'m, const WIDTH: usize, const SLOTS: usize>(pub Encoder<'m, WIDTH, SLOTS>);

impl<const WIDTH: usize, const SLOTS: usize> Encode for Apart<'_, WIDTH, SLOTS> {
    type State = EncoderState<WIDTH, SLOTS>;

    fn classes(&self) -> usize {
        self.0.classes()
    }

    fn fresh(&self) -> Self::State {
        self.0.fresh()
    }

    fn reset(&self, state: &mut Self::State) {
        self.0.reset(state);
    }

    #[inline(never)]
    fn step(&self, state: &mut Self::State, patch: &Patch) -> LookBackLogits {
        self.0.step(state, patch)
    }
}

/// Counts over all the samples.
///
/// # Panics
/// If a probe changes the logits.
pub fn count<const WIDTH: usize, const SLOTS: usize>(
    encoder: Encoder<'_, WIDTH, SLOTS>,
    model: &Model<'_>,
    samples: &[Sample],
) -> Counts {
    let settings = model.header.smoother.in_patches();
    let encoder = Apart(encoder);
    let mut memory = encoder.fresh();
    let mut pipeline = Pipeline::of_model(model, encoder, &mut memory).expect("good settings");

    let mut preprocessor = Preprocessor::new(model.header.preprocessing.median);
    let mut ring = SampleRing::default();
    let [mut state, mut probed_state] = [encoder.fresh(), encoder.fresh()];
    let mut smoother: Smoother<MAX_LOGITS, LOOK_BACK> =
        Smoother::new(settings, encoder.classes()).expect("good settings");

    let clock = Clock::new();
    let mut counts = Counts::default();
    // The median lags one sample: after the first one, every tenth sample completes a patch.
    let Some((first, samples)) = samples.split_first() else {
        return counts;
    };
    let _ = pipeline.sample(Millis(0), *first);
    let _ = preprocessor.push(*first);
    let mut now = Millis(0);
    for (number, patch) in (1..).zip(samples.as_chunks::<PATCH>().0) {
        let patch = black_box(patch);
        let ((), total) = clock.span(|| {
            for sample in patch {
                now = now.plus(SAMPLE_PERIOD_MS);
                black_box(pipeline.sample(now, *sample));
            }
        });

        let mut clean = Patch::default();
        let ((), preprocess) = clock.span(|| {
            for (clean, sample) in clean.iter_mut().zip(patch) {
                *clean = preprocessor.push(*sample).unwrap_or_default();
            }
        });
        let clean = black_box(&clean);
        let ((), ring_time) = clock.span(|| {
            for sample in clean {
                black_box(ring.push(*sample, Origin::Received));
            }
        });
        let (rows, step) = clock.span(|| encoder.step(&mut state, clean));
        let mut probe = clock.probe();
        let probed_rows = encoder.0.step_probed(&mut probed_state, clean, &mut probe);
        assert!(probed_rows == rows, "the probe changed the result");
        if !ring.is_full() {
            continue;
        }
        let window_end = SampleIndex(number * PATCH as u32 - 1);
        let (_, smooth) = clock.span(|| smoother.push(window_end, &rows));

        counts.total.push(total);
        counts.preprocess.push(preprocess);
        counts.ring.push(ring_time);
        counts.encoder.push(step);
        for (spans, part) in counts.encoder_parts.iter_mut().zip(probe.parts) {
            spans.push(part);
        }
        counts.smoother.push(smooth);
        let parts = preprocess + ring_time + step + smooth;
        counts.rest.push(total.saturating_sub(parts));
    }
    counts
}
