//! Charts with two numbered axes: learning curves, and the histogram of the latencies of gestures.

use maud::{Markup, html};

use super::{
    GRID, INK, LINES, MUTED, Point, circle, entry_colour, line, nice_step, picture, points, rect,
    shortened, text,
};
use crate::metric::event::latency::{self, Latency};
use crate::report::cell::latency_in_words;

/// Curves that share their axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::report) struct Panel {
    /// Title, with the unit.
    pub title: String,
    /// Name of the horizontal axis, with the unit.
    pub axis: &'static str,
    /// Curves, at most five, for the colours to differ: the name at the end of the line, and its points, from left to right.
    /// Points that are not finite are left out.
    pub curves: Vec<(String, Vec<Point>)>,
}

const WIDTH: f64 = 520.0;
/// Upper edge of the area inside the axes, below the head line; `FOOT` is the height below it.
const TOP: f64 = 34.0;
const FOOT: f64 = 50.0;
/// Width for the names right of curves.
const NAMES: f64 = 120.0;
const LETTERS: usize = 18;
const LINE_HEIGHT: f64 = 16.0;

/// Area inside the axes and the values at its edges.
struct Chart {
    height: f64,
    left: f64,
    right: f64,
    x: (f64, f64),
    y: (f64, f64),
}

impl Chart {
    const fn bottom(&self) -> f64 {
        self.height - FOOT
    }

    /// Place of a pair of values.
    fn at(&self, (x, y): (f64, f64)) -> Point {
        let part = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
        let (width, height) = (self.right - self.left, self.bottom() - TOP);
        (
            self.left + width * part(x, self.x),
            self.bottom() - height * part(y, self.y),
        )
    }

    /// Both axes with at most `columns` and `rows` numbers, the horizontal one's name, and a grid of horizontal lines.
    fn axes(&self, name: &str, columns: f64, rows: f64) -> Markup {
        let bottom = self.bottom();
        html! {
            (text("middle", (f64::midpoint(self.left, self.right), self.height - 13.0), 11.0, MUTED, name))
            (line((self.left, TOP), (self.left, bottom), MUTED, 1.0))
            (line((self.left, bottom), (self.right, bottom), MUTED, 1.0))
            @for value in ticks(self.y, rows) {
                @let (x, y) = self.at((self.x.0, value));
                (line((x, y), (self.right, y), GRID, 1.0))
                (line((x - 2.5, y), (x, y), MUTED, 1.0))
                (text("end", (x - 5.0, y), 11.0, MUTED, short(value)))
            }
            @for value in ticks(self.x, columns) {
                @let (x, y) = self.at((value, self.y.0));
                (line((x, y), (x, y + 2.5), MUTED, 1.0))
                (text("middle", (x, y + 11.0), 11.0, MUTED, short(value)))
            }
        }
    }
}

/// Round values of a range, at most `parts` and one.
fn ticks((low, high): (f64, f64), parts: f64) -> impl Iterator<Item = f64> {
    let step = nice_step(high - low, parts);
    let last = (high / step + 1e-9).floor() as i64;
    let first = (low / step - 1e-9).ceil() as i64;
    (first..=last).map(move |at| at as f64 * step)
}

/// Picture of the curves, with their names at their ends.
pub(in crate::report) fn curves(panel: &Panel) -> Markup {
    let finite = |&(x, y): &Point| x.is_finite() && y.is_finite();
    let mut curves = panel.curves.clone();
    curves
        .iter_mut()
        .for_each(|(_, points)| points.retain(finite));
    let values = || curves.iter().flat_map(|(_, points)| points);
    let chart = Chart {
        height: 300.0,
        left: 58.0,
        right: WIDTH - NAMES,
        x: range(values().map(|point| point.0), 0.0),
        y: range(values().map(|point| point.1), 0.06),
    };
    let ends = curves.iter().zip(0..);
    let ends = ends.filter_map(|((name, points), at)| Some((*points.last()?, at, name)));
    let told = ends
        .clone()
        .map(|(end, _, name)| format!("{name} ends at {}", short(end.1)));
    let description = match told.collect::<Vec<_>>().join(", ") {
        told if told.is_empty() => "No points.".to_owned(),
        told => told + ".",
    };
    let mut names: Vec<_> = ends
        .map(|(end, at, name)| (chart.at(end), at, name))
        .collect();
    names.sort_by(|a, b| a.0.1.total_cmp(&b.0.1));
    let mut free = 0.0;
    for ((_, y), ..) in &mut names {
        // Names that would overlap move down, in the order of their lines.
        *y = y.max(free);
        free = *y + LINE_HEIGHT;
    }
    let body = html! {
        (text("start", (10.0, 14.0), 13.0, INK, &panel.title))
        (chart.axes(panel.axis, 6.0, 5.0))
        @for (at, (_, own)) in curves.iter().enumerate() {
            polyline fill="none" stroke=(entry_colour(at)) stroke-width="2"
                points=(points(own.iter().map(|&point| chart.at(point)))) {}
            @if let &[only] = own.as_slice() { (circle(chart.at(only), 3.0, entry_colour(at))) }
        }
        @for ((x, y), at, name) in names { (text("start", (x + 8.0, y), 12.0, entry_colour(at), shortened(name, LETTERS))) }
    };
    picture((WIDTH, chart.height), &panel.title, &description, &body)
}

/// Lowest and highest value with a margin, never empty.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    match high - low {
        span if span > 0.0 => (low - margin * span, high + margin * span),
        0.0 => (low - 0.5, high + 0.5),
        _ => (0.0, 1.0),
    }
}

/// Number with at most three decimals and no trailing zeros.
fn short(value: f64) -> String {
    ((value * 1000.0).round() / 1000.0 + 0.0).to_string()
}

/// Histograms of the latencies of recognised gestures, given in samples for each model, none for a missed gesture; on one
/// scale. The median over all gestures is marked, unless it falls on a missed one.
pub(in crate::report) fn latencies(models: &[Vec<Option<i32>>]) -> Vec<Markup> {
    let mut all: Vec<f64> = models.iter().flat_map(|own| milliseconds(own)).collect();
    all.sort_by(f64::total_cmp);
    let axis = Bins::over(&all);
    let counted = models.iter().map(|own| axis.counts(&milliseconds(own)));
    let counted: Vec<_> = counted.collect();
    let highest = counted.iter().flatten().copied().max().unwrap_or(0).max(1);
    let drawn = models.iter().zip(&counted);
    drawn
        .map(|(own, counts)| histogram(own, &axis, counts, highest))
        .collect()
}

fn milliseconds(latencies: &[Option<i32>]) -> Vec<f64> {
    let recognised = latencies.iter().flatten();
    recognised
        .map(|&samples| latency::milliseconds(samples))
        .collect()
}

/// Histogram of one model's latencies; `highest` is the end of the vertical axis.
fn histogram(latencies: &[Option<i32>], axis: &Bins, counts: &[u32], highest: u32) -> Markup {
    let recognised: Vec<i32> = latencies.iter().copied().flatten().collect();
    let quantiles = latency::summary(&recognised, latencies.len());
    let of = latencies.len();
    let mut summary = format!("{} of {of} gestures recognised", recognised.len());
    if let Some(of) = quantiles {
        summary += &format!(": {}", latency_in_words(of));
    }
    let &Bins { start, width, .. } = axis;
    let top = f64::from(highest) * 1.08;
    let chart = Chart {
        height: 340.0,
        left: 50.0,
        right: WIDTH - 10.0,
        x: (start, start + width * counts.len() as f64),
        y: (0.0, top),
    };
    let upright =
        |x: f64, colour, width| line(chart.at((x, 0.0)), chart.at((x, top)), colour, width);
    let body = html! {
        (chart.axes("emitted label after onset, ms", 7.0, top.min(6.0)))
        @for (at, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            @let left = start + width * (at as f64 + 0.06);
            @let right = start + width * (at as f64 + 0.94);
            (rect(chart.at((left, f64::from(count))), chart.at((right, 0.0)), LINES[0], 0.85))
        }
        @if (chart.x.0..=chart.x.1).contains(&0.0) { (upright(0.0, MUTED, 1.0)) }
        @if let Some(Latency::Ms(middle)) = quantiles.map(|of| of.median) { (upright(middle, LINES[1], 2.5)) }
        (text("start", (50.0, 16.0), 12.0, INK, &summary))
    };
    let size = (WIDTH, chart.height);
    picture(size, "Latency of gestures", &summary, &body)
}

/// Bins of a round width, at most 41.
struct Bins {
    start: f64,
    width: f64,
    number: usize,
}

impl Bins {
    /// Bins over sorted values, the last value in the last one.
    fn over(sorted: &[f64]) -> Self {
        let low = sorted.first().copied().unwrap_or(0.0);
        let high = sorted.last().copied().unwrap_or(0.0);
        // 10 ms: two samples; narrower bins would show the armband's clock.
        let width = nice_step(high - low, 40.0).max(10.0);
        let start = (low / width).floor() * width;
        let number = ((high - start) / width) as usize + 1;
        Self {
            start,
            width,
            number,
        }
    }

    fn counts(&self, values: &[f64]) -> Vec<u32> {
        let mut counts = vec![0; self.number];
        for value in values {
            counts[((value - self.start) / self.width) as usize] += 1;
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let found = [12.0, 0.25, -0.0001, 200.0, 0.1 + 0.2].map(short);
        assert_eq!(found, ["12", "0.25", "0", "200", "0.3"]);
    }

    #[test]
    fn ticks_are_round_and_inside_the_range() {
        let found = ticks((-0.03, 1.27), 5.0);
        assert!(found.eq([0.0, 0.5, 1.0]));
        let found = ticks((1.0, 30.0), 6.0);
        assert!(found.eq([5.0, 10.0, 15.0, 20.0, 25.0, 30.0]));
    }

    #[test]
    fn empty_flat_and_broken_curves_still_have_axes() {
        assert_eq!(range([].into_iter(), 0.1), (0.0, 1.0));
        assert_eq!(range([2.0].into_iter(), 0.1), (1.5, 2.5));
        let loss = vec![(0.0, f64::NAN), (1.0, 2.0)];
        let panel = Panel {
            title: "Loss".into(),
            axis: "epoch",
            curves: vec![("loss".into(), loss), Default::default()],
        };
        assert!(curves(&panel).0.contains("loss ends at 2."));
        assert!(curves(&Panel::default()).0.contains("No points."));
    }

    #[test]
    fn every_latency_falls_into_one_bin_of_round_width() {
        let values = [-95.0, 0.0, 5.0, 304.0];
        let axis = Bins::over(&values);
        let counts = axis.counts(&values);
        assert_eq!((axis.start, axis.width, counts.len()), (-100.0, 10.0, 41));
        assert_eq!((counts[0], counts[10], counts[40]), (1, 2, 1));
    }

    #[test]
    fn latencies_of_several_models_are_drawn_on_one_scale() {
        let models = [vec![Some(24)], vec![Some(90); 2]];
        let (alone, both) = (&latencies(&models[..1])[0].0, latencies(&models));
        // The numbers at the ends of the axes.
        for number in [">450</text>", ">2</text>"] {
            assert!(!alone.contains(number), "{number}");
            assert!(both.iter().all(|own| own.0.contains(number)), "{number}");
        }
    }

    #[test]
    fn one_latency_and_none_are_drawn_too() {
        assert!(latencies(&[vec![]])[0].0.contains("0 of 0 gestures"));
        for (missed, words) in [
            (0, "half within 120 ms, nine in ten within 120 ms"),
            (1, "half within 120 ms, more than one in ten missed"),
            (2, "more than half missed"),
        ] {
            let own = [vec![Some(24)], vec![None; missed]].concat();
            let svg = &latencies(&[own])[0].0;
            let words = format!("1 of {} gestures recognised: {words}", 1 + missed);
            assert!(svg.contains(&words), "{words}: {svg}");
        }
    }
}
