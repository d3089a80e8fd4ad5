//! The picture of a confusion matrix.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{
    ReportError,
    canvas::{self, INK, LINES, MUTED, SCALE, text},
};
use crate::metric::confusion::Confusion;

const CELL: i32 = 84;
const GUTTER: i32 = 92;
const HEAD: i32 = 52;

/// Picture of a square per pair of true and emitted label, with its share of the true label in percent and in depth of
/// colour. Samples without an emitted label are left out.
pub(super) fn svg(confusion: &Confusion) -> Result<String, ReportError> {
    let classes = confusion.intents.len();
    let side = CELL * classes as i32;
    let diagonal: Vec<_> = (0..classes)
        .map(|class| {
            format!(
                "{} {:.0} %",
                confusion.intents[class],
                100.0 * share(confusion, class, class)
            )
        })
        .collect();
    let description = format!(
        "Share of each true intent that was emitted as itself: {}.",
        diagonal.join(", ")
    );
    canvas::draw(
        (GUTTER + side + 8, HEAD + side + 8),
        "Confusion matrix",
        &description,
        |area| {
            let at = |x: i32, y: i32| (x * SCALE, y * SCALE);
            let label = |label: &str, points, colour, h, (x, y)| {
                area.draw(&Text::new(
                    label.to_owned(),
                    at(x, y),
                    text(points, colour, h, VPos::Center),
                ))
            };
            label(
                "emitted",
                11.0,
                MUTED,
                HPos::Center,
                (GUTTER + side / 2, 12),
            )?;
            label("true", 11.0, MUTED, HPos::Right, (GUTTER - 10, 36))?;
            for (class, name) in confusion.intents.iter().enumerate() {
                let middle = CELL * class as i32 + CELL / 2;
                label(name, 12.0, INK, HPos::Center, (GUTTER + middle, 36))?;
                label(name, 12.0, INK, HPos::Right, (GUTTER - 10, HEAD + middle))?;
            }
            for row in 0..classes {
                for column in 0..classes {
                    let (x, y) = (GUTTER + CELL * column as i32, HEAD + CELL * row as i32);
                    let share = share(confusion, row, column);
                    let square = Rectangle::new(
                        [at(x + 1, y + 1), at(x + CELL - 1, y + CELL - 1)],
                        LINES[0].mix(0.06 + 0.94 * share).filled(),
                    );
                    area.draw(&square)?;
                    // White on deep blue, ink on pale: either way at least 4.5 to 1.
                    let colours = if share > 0.6 {
                        (WHITE, WHITE)
                    } else {
                        (INK, MUTED)
                    };
                    let middle = (x + CELL / 2, y + CELL / 2);
                    let percent = format!("{:.1} %", 100.0 * share);
                    label(
                        &percent,
                        14.0,
                        colours.0,
                        HPos::Center,
                        (middle.0, middle.1 - 8),
                    )?;
                    let count = confusion.counts[row][column].to_string();
                    label(
                        &count,
                        10.0,
                        colours.1,
                        HPos::Center,
                        (middle.0, middle.1 + 12),
                    )?;
                }
            }
            Ok(())
        },
    )
}

/// Part of the emitted labels of the true class `row` that is `column`; 0 for a class without any.
fn share(confusion: &Confusion, row: usize, column: usize) -> f64 {
    let emitted = &confusion.counts[row][..confusion.intents.len()];
    match emitted.iter().sum::<u64>() {
        0 => 0.0,
        total => emitted[column] as f64 / total as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_the_true_class() {
        let confusion = Confusion {
            intents: vec!["relax", "open", "close"],
            counts: vec![vec![30, 10, 0, 7], vec![0; 4], vec![1, 0, 0, 0]],
        };
        assert_eq!(share(&confusion, 0, 1), 0.25);
        assert_eq!(share(&confusion, 1, 1), 0.0);
        assert_eq!(share(&confusion, 2, 0), 1.0);
        assert!(svg(&confusion).unwrap().contains("25.0 %"));
    }
}
