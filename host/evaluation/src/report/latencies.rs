//! Histogram of the latencies of gestures.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{
    ReportError,
    canvas::{self, GRID, INK, LINES, MUTED, SCALE, nice_step, text},
    cell::quantile,
};
use crate::metric::event::latency::{self, Latency};

const SIZE: (i32, i32) = (520, 340);

/// A histogram of the latencies of recognised gestures, given in samples; none for a missed gesture. The median over
/// all gestures is marked, unless it falls on a missed one.
pub(super) fn svg(latencies: &[Option<i32>]) -> Result<String, ReportError> {
    let recognised: Vec<i32> = latencies.iter().copied().flatten().collect();
    let mut sorted: Vec<f64> = recognised
        .iter()
        .map(|&samples| latency::milliseconds(samples))
        .collect();
    sorted.sort_by(f64::total_cmp);
    let quantiles = latency::summary(&recognised, latencies.len());
    let mut summary = format!(
        "{} of {} gestures recognised",
        recognised.len(),
        latencies.len()
    );
    if let Some(of) = quantiles {
        let (median, p90) = (quantile(of.median), quantile(of.p90));
        summary += &format!(", median {median} ms, 90 % {p90} ms").replace("missed ms", "missed");
    }
    let middle = quantiles.and_then(|of| match of.median {
        Latency::Ms(milliseconds) => Some(milliseconds),
        Latency::Missed => None,
    });
    let Bins {
        start,
        width,
        counts,
    } = bins(&sorted);
    let end = start + width * counts.len() as f64;
    let highest = counts.iter().copied().max().unwrap_or(0).max(1);

    canvas::draw(SIZE, "Latency of gestures", &summary, |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(10 * SCALE)
            .margin_top(34 * SCALE)
            .x_label_area_size(40 * SCALE)
            .y_label_area_size(40 * SCALE)
            .build_cartesian_2d(start..end, 0.0..f64::from(highest) * 1.08)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(2))
            .axis_style(MUTED.stroke_width(2))
            .label_style(text(11.0, MUTED, HPos::Left, VPos::Top))
            .axis_desc_style(text(11.0, MUTED, HPos::Left, VPos::Top))
            .x_desc("emitted label after onset, ms")
            .x_labels(7)
            .y_labels(highest.min(5) as usize + 1)
            .x_label_formatter(&|ms| format!("{ms:.0}"))
            .y_label_formatter(&|count| format!("{count:.0}"))
            .draw()?;
        let gap = width * 0.06;
        chart.draw_series(counts.iter().enumerate().map(|(i, &count)| {
            let left = start + width * i as f64;
            Rectangle::new(
                [(left + gap, 0.0), (left + width - gap, f64::from(count))],
                LINES[0].mix(0.85).filled(),
            )
        }))?;
        let upright = |x: f64| vec![(x, 0.0), (x, f64::from(highest) * 1.08)];
        if (start..=end).contains(&0.0) {
            chart.draw_series([PathElement::new(upright(0.0), MUTED.stroke_width(2))])?;
        }
        if let Some(middle) = middle {
            let line = PathElement::new(upright(middle), LINES[1].stroke_width(5));
            chart.draw_series([line])?;
        }
        let headline = text(12.0, INK, HPos::Left, VPos::Center);
        area.draw(&Text::new(
            summary.clone(),
            (50 * SCALE, 16 * SCALE),
            headline,
        ))
    })
}

struct Bins {
    start: f64,
    width: f64,
    counts: Vec<u32>,
}

/// Bins of a round width, at most 41, the last value in the last one.
fn bins(sorted: &[f64]) -> Bins {
    let (low, high) = (
        sorted.first().copied().unwrap_or(0.0),
        sorted.last().copied().unwrap_or(0.0),
    );
    // 10 ms: two samples; narrower bins would show the armband's clock.
    let width = nice_step(high - low, 40.0).max(10.0);
    let start = (low / width).floor() * width;
    let place = |value: f64| ((value - start) / width) as usize;
    let mut counts = vec![0; place(high) + 1];
    for &value in sorted {
        counts[place(value)] += 1;
    }
    Bins {
        start,
        width,
        counts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_latency_falls_into_one_bin_of_round_width() {
        let bins = bins(&[-95.0, 0.0, 5.0, 304.0]);
        assert_eq!((bins.start, bins.width), (-100.0, 10.0));
        assert_eq!(bins.counts.len(), 41);
        assert_eq!(
            (bins.counts[0], bins.counts[10], bins.counts[40]),
            (1, 2, 1)
        );
    }

    #[test]
    fn one_latency_and_none_are_drawn_too() {
        assert!(svg(&[]).unwrap().contains("0 of 0 gestures"));
        let missed = svg(&[Some(24), None]).unwrap();
        assert!(missed.contains("1 of 2 gestures recognised, median 120 ms, 90 % missed"));
    }
}
