//! The line as a whole and part by part, over the same samples.
//!
//! The whole gives the total. Each part runs again by itself with what it gets in the line; what
//! the total has beyond the parts is the rest: the loop, the safe state, the reports. Only patches
//! that come when the window is full are counted: then every part has all its work.

use core::hint::black_box;

use shared::model::encoder::{
        Encoder, EncoderState, Logits, Patch,
        rebuild::{Rebuild, TILE},
    };
use shared::intent::MAX_CLASSES;
use shared::model::file::Model;
use shared::pipeline::{Encode, Pipeline};
use shared::stream::preprocess::Preprocessor;
use shared::stream::ring::SampleRing;
use shared::stream::safe_state::Start;
use shared::stream::smoother::Smoother;
use shared::units::{LOOK_BACK, Millis, PATCH, SAMPLE_PERIOD_MS, Sample, SampleIndex};

use crate::spans::{Clock, Spans};

/// Instructions per patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    preprocess: Spans,
    ring: Spans,
    /// Embed, attention, feed-forward, head.
    encoder_parts: [Spans; 4],
    smoother: Spans,
    rest: Spans,
    /// The whole line.
    pub total: Spans,
    /// The encoder without a probe: what its parts have to add up to.
    encoder: Spans,
    /// From scratch over the window: a patch's share of it.
    rebuild: Spans,
    /// What it does in one piece.
    slice: Spans,
}

impl Counts {
    /// Parts with their names, the line's order; the two sums; then what the way from scratch takes.
    pub fn named(&self) -> [(&'static str, Spans); 12] {
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
            ("recompute", self.rebuild),
            ("slice", self.slice),
        ]
    }
}

/// The encoder compiled by itself, alike in the line and apart from it.
#[derive(Clone, Copy, Debug)]
struct Apart<'m, const D: usize, const L: usize, const SPAN: usize>(Encoder<'m, D, L, SPAN>);

impl<const D: usize, const L: usize, const SPAN: usize> Encode for Apart<'_, D, L, SPAN> {
    type State = EncoderState<D, L, SPAN>;

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
    fn step(&self, state: &mut Self::State, patch: &Patch) -> Logits {
        self.0.step(state, patch)
    }
}

/// Counts over all the samples.
///
/// A device has to look up first which of several shapes its model has: some ten instructions more.
///
/// # Panics
/// If the model has another shape, or patches at once give other outputs than one by one.
pub fn count<const D: usize, const L: usize, const SPAN: usize>(
    model: &Model<'_>,
    samples: &[Sample],
) -> Counts {
    let settings = model.header.smoother.in_patches();
    let encoder = Apart(Encoder::<D, L, SPAN>::new(model).expect("the model's shape"));
    let mut memory = encoder.fresh();
    let mut line =
        Pipeline::new(encoder, &mut memory, settings, Start::Boot).expect("good settings");

    let mut preprocessor = Preprocessor::new();
    let mut ring = SampleRing::new();
    let [mut state, mut probed_state] = [encoder.fresh(), encoder.fresh()];
    let mut smoother: Smoother<MAX_CLASSES, LOOK_BACK> =
        Smoother::new(settings, encoder.classes()).expect("good settings");

    let clock = Clock::new();
    let mut counts = Counts::default();
    // The median lags a sample: after the first one, the last of as many as a patch has completes it.
    let Some((first, samples)) = samples.split_first() else {
        return counts;
    };
    let _ = line.sample(Millis(0), *first);
    let _ = preprocessor.push(*first);
    let mut now = Millis(0);
    for (number, patch) in (1..).zip(samples.as_chunks::<PATCH>().0) {
        let patch = black_box(patch);
        let ((), total) = clock.span(|| {
            for sample in patch {
                now = now.plus(SAMPLE_PERIOD_MS);
                black_box(line.sample(now, *sample));
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
                black_box(ring.push(*sample));
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

    let mut rebuilt = encoder.fresh();
    let mut rebuild = Rebuild::begin(&mut rebuilt, &ring);
    let mut of_two = 0;
    while !rebuild.is_done() {
        let (outputs, slice) = clock.span(|| rebuild.slice(&encoder.0, &mut rebuilt, &ring));
        counts.slice.push(slice);
        of_two += slice;
        if outputs.is_some() {
            counts.rebuild.push(of_two / TILE as u32);
            of_two = 0;
        }
    }
    let next = Patch::default();
    let outputs = [&mut state, &mut rebuilt].map(|state| encoder.step(state, &next));
    assert!(
        outputs[0] == outputs[1],
        "from scratch it comes out another"
    );
    counts
}
