//! The picture of a recording: EMG above, true and emitted labels below.

use maud::{Markup, html};
use recordings::runs;
use shared::intent::Intent;
use shared::units::{CHANNELS, CleanSample, SAMPLE_RATE_HZ};

use super::{GRID, INK, MUTED, intent_colour, line, nice_step, picture, points, rect, text};

/// One recording with its labels; the three sequences run sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::report) struct Timeline<'a> {
    /// The person.
    pub subject: &'a str,
    /// Name of the recording.
    pub recording: String,
    /// EMG after median and rectification, 0..=128.
    pub emg: &'a [CleanSample],
    /// The true label of each sample; none where it is unknown.
    pub truth: &'a [Option<Intent>],
    /// The label that a user sees at each sample, look-ahead included.
    pub emitted: Vec<Option<Intent>>,
}

/// Width of the picture, and of its margins.
const WIDTH: f64 = 1100.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 14.0;
/// Head line: recording and legend.
const HEAD: f64 = 34.0;
/// Height of the strip of a channel.
const STRIP: f64 = 30.0;
/// Upper edges of the two bands of labels, and their height.
const TRUTH: f64 = HEAD + STRIP * CHANNELS as f64 + 12.0;
const BAND: f64 = 24.0;
const EMITTED: f64 = TRUTH + BAND + 5.0;
const AXIS: f64 = EMITTED + BAND + 6.0;
const HEIGHT: f64 = AXIS + 22.0;

const TRACE: &str = "#52606D";

pub(in crate::report) fn svg(timeline: &Timeline<'_>) -> Markup {
    let (emg, truth, emitted) = (timeline.emg, timeline.truth, &timeline.emitted);
    let (subject, recording) = (timeline.subject, &timeline.recording);
    let title = format!("EMG and labels: {subject}, {recording}");
    let samples = emg.len().max(truth.len()).max(emitted.len()).max(1);
    let axis = Axis { samples };
    let description = format!(
        "{:.1} s of eight channels; below them {} true and {} emitted runs of one label each.",
        axis.samples as f64 / f64::from(SAMPLE_RATE_HZ),
        runs(truth).len(),
        runs(emitted).len(),
    );
    let body = html! {
        (head(timeline))
        @for run in runs(truth).into_iter().skip(1) {
            (line((axis.at(run.start), HEAD - 4.0), (axis.at(run.start), AXIS), GRID, 1.0))
        }
        (traces(&axis, emg))
        (band(&axis, TRUTH, "true", truth))
        (band(&axis, EMITTED, "emitted", emitted))
        (seconds(&axis))
    };
    picture((WIDTH, HEIGHT), &title, &description, &body)
}

/// Time axis over at least one sample.
struct Axis {
    samples: usize,
}

impl Axis {
    /// Position of a time between samples, in half pixels.
    fn x(&self, sample: f64) -> f64 {
        let samples = self.samples as f64;
        let width = (WIDTH - LEFT - RIGHT) * 2.0;
        LEFT + (width * sample.min(samples) / samples).round() / 2.0
    }

    fn at(&self, sample: usize) -> f64 {
        self.x(sample as f64)
    }
}

/// Name of the recording, and the legend of the intents that occur, from the right end.
fn head(timeline: &Timeline<'_>) -> Markup {
    let occurs = |intent: &Intent| {
        let labels = timeline.truth.iter().chain(&timeline.emitted);
        labels.flatten().any(|label| label == intent)
    };
    let mut x = WIDTH - RIGHT;
    let mut places = Vec::new();
    for intent in Intent::ALL.into_iter().filter(occurs).rev() {
        // No font is measured: 7 pixels a letter is wide enough at this size.
        x -= 7.0 * intent.name().len() as f64 + 18.0;
        places.push((x, intent));
        x -= 16.0;
    }
    html! {
        (text("start", (LEFT, 16.0), 13.0, INK, format!("{} · {}", timeline.subject, timeline.recording)))
        @for (x, intent) in places {
            (text("start", (x + 18.0, 16.0), 12.0, INK, intent.name()))
            (rect((x, 10.0), (x + 12.0, 22.0), intent_colour(intent), 1.0))
        }
    }
}

/// The highest value of each channel under every unit of width, so that single spikes stay visible.
fn traces(axis: &Axis, emg: &[CleanSample]) -> Markup {
    let full = full_scale(emg);
    html! {
        @for channel in 0..CHANNELS {
            @let base = HEAD + STRIP * (channel as f64 + 1.0);
            polygon fill=(TRACE) points=(points(outline(axis, emg, channel, base, full))) {}
            (text("end", (LEFT - 10.0, base - STRIP / 2.0), 11.0, MUTED, format!("EMG {}", channel + 1)))
        }
    }
}

/// Outline of a channel above its base line.
fn outline(
    axis: &Axis,
    emg: &[CleanSample],
    channel: usize,
    base: f64,
    full: f64,
) -> Vec<(f64, f64)> {
    let mut outline = vec![(axis.at(0), base)];
    for (sample, values) in emg.iter().enumerate() {
        let part = (f64::from(values[channel]) / full).min(1.0);
        let (x, y) = (axis.at(sample), base - part * (STRIP - 3.0));
        // The first point is the corner on the base line, where the outline closes.
        let corner = outline.len() == 1;
        match outline.last_mut() {
            Some(last) if last.0 == x && !corner => last.1 = last.1.min(y),
            _ => outline.push((x, y)),
        }
    }
    outline.push((axis.at(emg.len()), base));
    outline
}

/// The value that fills a strip: 99.5 % of all values are below, so that one spike does not set the scale.
fn full_scale(emg: &[CleanSample]) -> f64 {
    let mut counts = [0usize; 256];
    emg.iter()
        .flatten()
        .for_each(|&value| counts[usize::from(value)] += 1);
    let mut above = emg.len() * CHANNELS / 200;
    let mut value = 255;
    while value > 1 && counts[value] <= above {
        above -= counts[value];
        value -= 1;
    }
    value as f64
}

fn band(axis: &Axis, top: f64, name: &str, labels: &[Option<Intent>]) -> Markup {
    let (bottom, middle) = (top + BAND, top + BAND / 2.0);
    let (start, end) = (axis.at(0), axis.at(axis.samples));
    html! {
        (text("end", (LEFT - 10.0, middle), 12.0, INK, name))
        // Unlabelled time stays visible as an empty frame.
        rect x=(start) y=(top) width=(end - start) height=(BAND) fill="none" stroke=(GRID) {}
        @for run in runs(labels) {
            @if let Some(intent) = run.label {
                @let (left, right) = (axis.at(run.start), axis.at(run.end));
                (rect((left, top), (right, bottom), intent_colour(intent), 1.0))
                @if right - left > 6.0 * intent.name().len() as f64 + 6.0 {
                    // Text on the band must stay readable: grey changes with the colour scheme, and so must its text.
                    @let colour = match intent { Intent::Relax => INK, Intent::Open => "#FFFFFF", _ => "#000000" };
                    (text("middle", (f64::midpoint(left, right), middle), 11.0, colour, intent.name()))
                }
            }
        }
    }
}

fn seconds(axis: &Axis) -> Markup {
    let rate = f64::from(SAMPLE_RATE_HZ);
    let length = axis.samples as f64 / rate;
    let step = nice_step(length, 10.0);
    html! {
        (line((axis.at(0), AXIS), (axis.at(axis.samples), AXIS), MUTED, 1.0))
        @for tick in 0..=(length / step * (1.0 + 1e-9)) as u32 {
            @let second = step * f64::from(tick);
            @let x = axis.x(second * rate);
            (line((x, AXIS), (x, AXIS + 4.0), MUTED, 1.0))
            (text("middle", (x, AXIS + 13.0), 11.0, MUTED, format!("{} s", (second * 100.0).round() / 100.0)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_spike_does_not_set_the_scale() {
        let mut emg = vec![[10; CHANNELS]; 1000];
        emg[5][0] = 128;
        assert_eq!(full_scale(&emg), 10.0);
        assert_eq!(full_scale(&[]), 1.0);
    }
}
