//! The picture of the whole matter: muscles above, what the hand was asked and what was emitted below.

use std::ops::Range;

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};
use shared::intent::Intent;
use shared::units::{CHANNELS, CleanSample, SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ};

use super::{
    ReportError,
    canvas::{self, Area, Drawn, GRID, INK, MUTED, SCALE, TRACE, intent_colour, nice_step, text},
};

/// One recording with its labels; the three sequences run sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Who was recorded.
    pub subject: String,
    /// Which recording of theirs.
    pub recording: String,
    /// After median and rectification, 0..=128.
    pub emg: Vec<CleanSample>,
    /// The label of each sample as published; none where it says nothing.
    pub truth: Vec<Option<Intent>>,
    /// The label emitted *for* each sample, `look_ahead_samples` after it came.
    pub emitted: Vec<Option<Intent>>,
    /// Samples between an instant and the label that speaks of it.
    pub look_ahead_samples: usize,
}

impl Timeline {
    /// A part of the recording; what lies outside of it is cut off.
    #[must_use]
    pub fn section(&self, samples: Range<usize>) -> Self {
        fn part<T: Copy>(of: &[T], samples: &Range<usize>) -> Vec<T> {
            let end = samples.end.min(of.len());
            of[samples.start.min(end)..end].to_vec()
        }
        Self {
            emg: part(&self.emg, &samples),
            truth: part(&self.truth, &samples),
            emitted: part(&self.emitted, &samples),
            ..self.clone()
        }
    }
}

const WIDTH: i32 = 1100;
const LEFT: i32 = 78;
const RIGHT: i32 = 14;
const HEAD: i32 = 34;
const STRIP: i32 = 30;
const TRUTH: i32 = HEAD + STRIP * CHANNELS as i32 + 12;
const BAND: i32 = 24;
const EMITTED: i32 = TRUTH + BAND + 5;
/// Bars that show how long after its instant a new label is known.
const DELAY: i32 = EMITTED + BAND + 3;
const AXIS: i32 = DELAY + 10;
const HEIGHT: i32 = AXIS + 36;

/// The picture as an SVG file of its own, for a README.
///
/// # Errors
/// [`ReportError::Draw`] on a bug of the layout only.
pub fn timeline_svg(timeline: &Timeline) -> Result<String, ReportError> {
    svg(timeline).map(|svg| canvas::stand_alone(&svg))
}

/// The picture as a part of the page.
pub(super) fn svg(timeline: &Timeline) -> Result<String, ReportError> {
    let title = format!(
        "EMG and labels: {}, {}",
        timeline.subject, timeline.recording
    );
    let axis = Axis {
        samples: timeline
            .emg
            .len()
            .max(timeline.truth.len())
            .max(timeline.emitted.len())
            .max(1),
    };
    let description = format!(
        "{:.1} s of eight channels; below them {} true and {} emitted stretches of one intent each.",
        axis.samples as f64 / f64::from(SAMPLE_RATE_HZ),
        stretches(&timeline.truth).len(),
        stretches(&timeline.emitted).len(),
    );
    canvas::draw((WIDTH, HEIGHT), &title, &description, |area| {
        head(area, timeline)?;
        guides(area, &axis, &timeline.truth)?;
        traces(area, &axis, &timeline.emg)?;
        band(area, &axis, TRUTH, "true", &timeline.truth)?;
        band(area, &axis, EMITTED, "emitted", &timeline.emitted)?;
        delays(area, &axis, timeline)?;
        seconds(area, &axis, timeline.look_ahead_samples)
    })
}

/// Samples to units of the drawing.
struct Axis {
    samples: usize,
}

impl Axis {
    fn x(&self, sample: f64) -> i32 {
        let width = f64::from((WIDTH - LEFT - RIGHT) * SCALE);
        LEFT * SCALE
            + (width * sample.min(self.samples as f64) / self.samples as f64).round() as i32
    }

    fn at(&self, sample: usize) -> i32 {
        self.x(sample as f64)
    }
}

fn head(area: &Area<'_>, timeline: &Timeline) -> Drawn {
    let name = [timeline.subject.as_str(), timeline.recording.as_str()].join(" · ");
    area.draw(&Text::new(
        name,
        (LEFT * SCALE, 16 * SCALE),
        text(13.0, INK, HPos::Left, VPos::Center),
    ))?;
    // From the right end: the legend of the intents that occur.
    let mut x = WIDTH - RIGHT;
    let occurs = |intent: &Intent| {
        timeline.truth.contains(&Some(*intent)) || timeline.emitted.contains(&Some(*intent))
    };
    for intent in Intent::ALL.into_iter().filter(occurs).rev() {
        // No font is measured: 7 pixels a letter is wide enough at this size.
        x -= 7 * intent.name().len() as i32;
        area.draw(&Text::new(
            intent.name(),
            (x * SCALE, 16 * SCALE),
            text(12.0, INK, HPos::Left, VPos::Center),
        ))?;
        x -= 18;
        let square = [(x * SCALE, 10 * SCALE), ((x + 12) * SCALE, 22 * SCALE)];
        area.draw(&Rectangle::new(square, intent_colour(intent).filled()))?;
        x -= 16;
    }
    Ok(())
}

/// Upright lines through everything where the true intent changes.
fn guides(area: &Area<'_>, axis: &Axis, truth: &[Option<Intent>]) -> Drawn {
    for (samples, _) in stretches(truth).into_iter().skip(1) {
        let x = axis.at(samples.start);
        let line = vec![(x, (HEAD - 4) * SCALE), (x, AXIS * SCALE)];
        area.draw(&PathElement::new(line, GRID.stroke_width(2)))?;
    }
    Ok(())
}

/// Per channel the highest value under every unit of width: single spikes survive the thinning.
fn traces(area: &Area<'_>, axis: &Axis, emg: &[CleanSample]) -> Drawn {
    let full = full_scale(emg);
    for channel in 0..CHANNELS {
        let base = (HEAD + STRIP * (channel as i32 + 1)) * SCALE;
        let y = |value: u8| {
            let part = (f64::from(value) / full).min(1.0);
            base - (part * f64::from((STRIP - 3) * SCALE)).round() as i32
        };
        let mut outline = vec![(axis.at(0), base)];
        for (sample, values) in emg.iter().enumerate() {
            let (x, y) = (axis.at(sample), y(values[channel]));
            match outline.last_mut() {
                Some(last) if last.0 == x => last.1 = last.1.min(y),
                _ => outline.push((x, y)),
            }
        }
        outline.push((axis.at(emg.len()), base));
        area.draw(&Polygon::new(outline, TRACE.filled()))?;
        let name = format!("EMG {}", channel + 1);
        let place = ((LEFT - 10) * SCALE, base - STRIP * SCALE / 2);
        area.draw(&Text::new(
            name,
            place,
            text(11.0, MUTED, HPos::Right, VPos::Center),
        ))?;
    }
    Ok(())
}

/// The value that fills a strip: 99.5 % of all values lie below, so that one spike does not flatten the rest.
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

fn band(area: &Area<'_>, axis: &Axis, top: i32, name: &str, labels: &[Option<Intent>]) -> Drawn {
    let (low, high) = (top * SCALE, (top + BAND) * SCALE);
    let middle = i32::midpoint(low, high);
    let style = text(12.0, INK, HPos::Right, VPos::Center);
    area.draw(&Text::new(
        name.to_owned(),
        ((LEFT - 10) * SCALE, middle),
        style,
    ))?;
    // Unlabelled time stays visible as an empty frame.
    let whole = [(axis.at(0), low), (axis.at(axis.samples), high)];
    area.draw(&Rectangle::new(whole, GRID.stroke_width(2)))?;
    for (samples, label) in stretches(labels) {
        let Some(intent) = label else { continue };
        let (left, right) = (axis.at(samples.start), axis.at(samples.end));
        area.draw(&Rectangle::new(
            [(left, low), (right, high)],
            intent_colour(intent).filled(),
        ))?;
        if right - left > (6 * intent.name().len() as i32 + 6) * SCALE {
            // Readable on the band: grey turns with the screen, and so must the word on it.
            let colour = match intent {
                Intent::Relax => INK,
                Intent::Open => WHITE,
                _ => BLACK,
            };
            let style = text(11.0, colour, HPos::Center, VPos::Center);
            area.draw(&Text::new(
                intent.name(),
                (i32::midpoint(left, right), middle),
                style,
            ))?;
        }
    }
    Ok(())
}

/// Under every change of label: from the instant it speaks of to the instant when it is emitted.
fn delays(area: &Area<'_>, axis: &Axis, timeline: &Timeline) -> Drawn {
    for (samples, label) in stretches(&timeline.emitted) {
        if label.is_some() {
            let ends = (
                axis.at(samples.start),
                axis.at(samples.start + timeline.look_ahead_samples),
            );
            let bar = [
                (ends.0, DELAY * SCALE),
                (ends.1.max(ends.0 + 1), (DELAY + 4) * SCALE),
            ];
            area.draw(&Rectangle::new(bar, INK.filled()))?;
        }
    }
    Ok(())
}

fn seconds(area: &Area<'_>, axis: &Axis, look_ahead: usize) -> Drawn {
    let rate = f64::from(SAMPLE_RATE_HZ);
    let length = axis.samples as f64 / rate;
    let line = vec![
        (axis.at(0), AXIS * SCALE),
        (axis.at(axis.samples), AXIS * SCALE),
    ];
    area.draw(&PathElement::new(line, MUTED.stroke_width(2)))?;
    let step = nice_step(length, 10.0);
    for tick in 0..=(length / step * (1.0 + 1e-9)) as u32 {
        let second = step * f64::from(tick);
        let x = axis.x(second * rate);
        area.draw(&PathElement::new(
            vec![(x, AXIS * SCALE), (x, (AXIS + 4) * SCALE)],
            MUTED.stroke_width(2),
        ))?;
        let label = format!("{} s", (second * 100.0).round() / 100.0);
        area.draw(&Text::new(
            label,
            (x, (AXIS + 13) * SCALE),
            text(11.0, MUTED, HPos::Center, VPos::Center),
        ))?;
    }
    let remark = format!(
        "short bars: look-ahead of {} ms, from the instant a new label speaks of until it is emitted",
        look_ahead * SAMPLE_PERIOD_MS as usize
    );
    let place = ((WIDTH - RIGHT) * SCALE, (AXIS + 29) * SCALE);
    area.draw(&Text::new(
        remark,
        place,
        text(11.0, MUTED, HPos::Right, VPos::Center),
    ))
}

/// The stretches of equal labels, in order, without a gap between them.
fn stretches(labels: &[Option<Intent>]) -> Vec<(Range<usize>, Option<Intent>)> {
    let mut start = 0;
    labels
        .chunk_by(PartialEq::eq)
        .map(|chunk| {
            let samples = start..start + chunk.len();
            start = samples.end;
            (samples, chunk[0])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_cover_every_sample_once() {
        let (relax, open) = (Some(Intent::Relax), Some(Intent::Open));
        let expected = [(0..2, relax), (2..3, open), (3..5, None)];
        assert_eq!(stretches(&[relax, relax, open, None, None]), expected);
        assert!(stretches(&[]).is_empty());
    }

    #[test]
    fn one_spike_does_not_set_the_scale() {
        let mut emg = vec![[10; CHANNELS]; 1000];
        emg[5][0] = 128;
        assert_eq!(full_scale(&emg), 10.0);
        assert_eq!(full_scale(&[]), 1.0);
    }

    #[test]
    fn a_section_is_cut_from_all_three_sequences() {
        let timeline = Timeline {
            emg: vec![[1; CHANNELS]; 10],
            truth: vec![Some(Intent::Open); 10],
            emitted: vec![None; 6],
            ..Timeline::default()
        };
        let section = timeline.section(4..8);
        assert_eq!(
            (
                section.emg.len(),
                section.truth.len(),
                section.emitted.len()
            ),
            (4, 4, 2)
        );
        assert_eq!(timeline.section(20..30).emg, Vec::<CleanSample>::new());
    }
}
