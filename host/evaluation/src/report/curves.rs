//! Learning curves.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{
    ReportError,
    canvas::{self, GRID, INK, LINES, MUTED, SCALE, text},
};

/// A value over steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Curve {
    /// Name at the end of the line.
    pub name: String,
    /// Step and value, steps ascending. Values that are not finite are left out.
    pub points: Vec<(f64, f64)>,
}

/// Curves that share their axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Panel {
    /// Title, with the unit.
    pub title: String,
    /// Name of the horizontal axis: "epoch", "step".
    pub step: String,
    /// Curves, at most five, for the colours to differ.
    pub curves: Vec<Curve>,
}

const SIZE: (i32, i32) = (520, 300);
/// Width for the names right of the lines, in pixels.
const NAMES: i32 = 120;
const LINE_HEIGHT: i32 = 16;

/// Picture of the curves, with their names at their ends.
pub(super) fn svg(panel: &Panel) -> Result<String, ReportError> {
    let curves: Vec<Vec<(f64, f64)>> = panel.curves.iter().map(finite).collect();
    let steps = range(curves.iter().flatten().map(|point| point.0), 0.0);
    let values = range(curves.iter().flatten().map(|point| point.1), 0.06);
    let ends: Vec<_> = panel
        .curves
        .iter()
        .zip(&curves)
        .filter_map(|(curve, points)| {
            Some(format!(
                "{} ends at {}",
                curve.name,
                short(points.last()?.1)
            ))
        })
        .collect();
    let description = if ends.is_empty() {
        "No points.".into()
    } else {
        ends.join(", ") + "."
    };

    canvas::draw(SIZE, &panel.title, &description, |area| {
        let headline = text(13.0, INK, HPos::Left, VPos::Center);
        area.draw(&Text::new(
            panel.title.clone(),
            (10 * SCALE, 14 * SCALE),
            headline,
        ))?;
        let mut chart = ChartBuilder::on(area)
            .margin(10 * SCALE)
            .margin_top(34 * SCALE)
            .margin_right(NAMES * SCALE)
            .x_label_area_size(40 * SCALE)
            .y_label_area_size(48 * SCALE)
            .build_cartesian_2d(steps.0..steps.1, values.0..values.1)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(2))
            .axis_style(MUTED.stroke_width(2))
            .label_style(text(11.0, MUTED, HPos::Left, VPos::Top))
            .axis_desc_style(text(11.0, MUTED, HPos::Left, VPos::Top))
            .x_desc(panel.step.as_str())
            .x_labels(6)
            .y_labels(6)
            .x_label_formatter(&|step| short(*step))
            .y_label_formatter(&|value| short(*value))
            .draw()?;
        for (i, points) in curves.iter().enumerate() {
            chart.draw_series(LineSeries::new(
                points.iter().copied(),
                colour(i).stroke_width(4),
            ))?;
            if let &[only] = points.as_slice() {
                chart.draw_series([Circle::new(only, 3 * SCALE, colour(i).filled())])?;
            }
        }
        let mut names: Vec<_> = (0..curves.len())
            .filter_map(|i| Some((chart.backend_coord(curves[i].last()?), i)))
            .collect();
        names.sort_by_key(|&((_, y), _)| y);
        let mut free = 0;
        for ((x, y), i) in names {
            // Names that would overlap move down, in the order of their lines.
            let y = y.max(free);
            free = y + LINE_HEIGHT * SCALE;
            let style = text(12.0, colour(i), HPos::Left, VPos::Center);
            area.draw(&Text::new(
                panel.curves[i].name.clone(),
                (x + 8 * SCALE, y),
                style,
            ))?;
        }
        Ok(())
    })
}

fn colour(i: usize) -> RGBColor {
    LINES[i % LINES.len()]
}

fn finite(curve: &Curve) -> Vec<(f64, f64)> {
    let whole = |&(step, value): &(f64, f64)| step.is_finite() && value.is_finite();
    curve.points.iter().copied().filter(whole).collect()
}

/// Lowest and highest value with a margin, never empty.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return (0.0, 1.0);
    }
    let span = high - low;
    if span <= 0.0 {
        return (low - 0.5, high + 0.5);
    }
    (low - margin * span, high + margin * span)
}

/// Number with at most three decimals and no trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(12.0), "12");
        assert_eq!(short(0.25), "0.25");
        assert_eq!(short(-0.0001), "0");
        assert_eq!(short(200.0), "200");
    }

    #[test]
    fn empty_flat_and_broken_curves_still_have_axes() {
        assert_eq!(range([].into_iter(), 0.1), (0.0, 1.0));
        assert_eq!(range([2.0].into_iter(), 0.1), (1.5, 2.5));
        let curve = Curve {
            name: "loss".into(),
            points: vec![(0.0, f64::NAN), (1.0, 2.0)],
        };
        let panel = Panel {
            title: "Loss".into(),
            step: "epoch".into(),
            curves: vec![curve, Curve::default()],
        };
        assert!(svg(&panel).unwrap().contains("loss ends at 2."));
    }
}
