//! Layers of the picture.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};
use shared::intent::Intent;
use shared::units::{CHANNELS, CleanSample, SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ};

use super::Timeline;
use super::axis::{AXIS, Axis, BAND, DELAY, HEAD, LEFT, RIGHT, STRIP, WIDTH};
use crate::report::canvas::{
    Area, Drawn, GRID, INK, MUTED, SCALE, TRACE, intent_colour, nice_step, text,
};
use recordings::runs;

/// Draws the name of the recording and the legend.
pub(super) fn head(area: &Area<'_>, timeline: &Timeline) -> Drawn {
    let name = [timeline.subject.as_str(), timeline.recording.as_str()].join(" · ");
    area.draw(&Text::new(
        name,
        (LEFT * SCALE, 16 * SCALE),
        text(13.0, INK, HPos::Left, VPos::Center),
    ))?;
    // The legend of the intents that occur is drawn from the right end.
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

/// Draws vertical lines where the true label changes.
pub(super) fn guides(area: &Area<'_>, axis: &Axis, truth: &[Option<Intent>]) -> Drawn {
    for run in runs(truth).into_iter().skip(1) {
        let x = axis.at(run.start);
        let line = vec![(x, (HEAD - 4) * SCALE), (x, AXIS * SCALE)];
        area.draw(&PathElement::new(line, GRID.stroke_width(2)))?;
    }
    Ok(())
}

/// Draws the highest value of each channel under every unit of width, so that single spikes stay visible.
pub(super) fn traces(area: &Area<'_>, axis: &Axis, emg: &[CleanSample]) -> Drawn {
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
            // The first point is the corner on the base line, where the outline closes.
            let corner = outline.len() == 1;
            match outline.last_mut() {
                Some(last) if last.0 == x && !corner => last.1 = last.1.min(y),
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

/// Draws a band of labels.
pub(super) fn band(
    area: &Area<'_>,
    axis: &Axis,
    top: i32,
    name: &str,
    labels: &[Option<Intent>],
) -> Drawn {
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
    for run in runs(labels) {
        let Some(intent) = run.label else { continue };
        let (left, right) = (axis.at(run.start), axis.at(run.end));
        area.draw(&Rectangle::new(
            [(left, low), (right, high)],
            intent_colour(intent).filled(),
        ))?;
        if right - left > (6 * intent.name().len() as i32 + 6) * SCALE {
            // Text on the band must stay readable: grey changes with the colour scheme, and so must its text.
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

/// Draws a bar under every new label, from its reference time to its emission.
pub(super) fn delays(area: &Area<'_>, axis: &Axis, timeline: &Timeline) -> Drawn {
    for run in runs(&timeline.emitted) {
        if run.label.is_some() {
            let ends = (
                axis.at(run.start),
                axis.at(run.start + timeline.look_ahead_samples),
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

/// Draws the time axis and a remark.
pub(super) fn seconds(area: &Area<'_>, axis: &Axis, look_ahead: usize) -> Drawn {
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
        "short bars: look-ahead of {} ms, from the reference time of a new label to its emission",
        look_ahead * SAMPLE_PERIOD_MS as usize
    );
    let place = ((WIDTH - RIGHT) * SCALE, (AXIS + 29) * SCALE);
    area.draw(&Text::new(
        remark,
        place,
        text(11.0, MUTED, HPos::Right, VPos::Center),
    ))
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
