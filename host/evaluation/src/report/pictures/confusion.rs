//! The picture of a confusion matrix.

use maud::{Markup, html};

use super::{INK, LINES, MUTED, picture, rect, text};
use crate::metric::confusion::Confusion;

const CELL: f64 = 84.0;
const GUTTER: f64 = 92.0;
const HEAD: f64 = 52.0;

/// Picture of a square per pair of true and predicted label, with its share of the true label in percent and in depth of
/// colour. Samples without a predicted label are left out.
pub(in crate::report) fn matrix(confusion: &Confusion) -> Markup {
    let names = &confusion.intents;
    let classes = names.len();
    let side = CELL * classes as f64;
    let diagonal: Vec<_> = (0..classes)
        .map(|class| {
            format!(
                "{} {:.0} %",
                names[class],
                100.0 * share(confusion, class, class)
            )
        })
        .collect();
    let description = format!(
        "Share of each true intent that was predicted as itself: {}.",
        diagonal.join(", ")
    );
    let middle = |class: usize| CELL * (class as f64 + 0.5);
    let body = html! {
        (text("middle", (GUTTER + side / 2.0, 12.0), 11.0, MUTED, "predicted"))
        (text("end", (GUTTER - 10.0, 36.0), 11.0, MUTED, "true"))
        @for (class, name) in names.iter().enumerate() {
            (text("middle", (GUTTER + middle(class), 36.0), 12.0, INK, name))
            (text("end", (GUTTER - 10.0, HEAD + middle(class)), 12.0, INK, name))
        }
        @for row in 0..classes {
            @for column in 0..classes {
                @let (x, y) = (GUTTER + middle(column), HEAD + middle(row));
                @let share = share(confusion, row, column);
                // White on deep blue, ink on pale: either way at least 4.5 to 1.
                @let colours = if share > 0.6 { ["#FFFFFF"; 2] } else { [INK, MUTED] };
                @let half = CELL / 2.0 - 1.0;
                (rect((x - half, y - half), (x + half, y + half), LINES[0], 0.06 + 0.94 * share))
                (text("middle", (x, y - 8.0), 14.0, colours[0], format!("{:.1} %", 100.0 * share)))
                (text("middle", (x, y + 12.0), 10.0, colours[1], confusion.counts[row][column]))
            }
        }
    };
    let size = (GUTTER + side + 8.0, HEAD + side + 8.0);
    picture(size, "Confusion matrix", &description, &body)
}

/// Part of the predicted labels of the true class `row` that is `column`; 0 for a class without any.
fn share(confusion: &Confusion, row: usize, column: usize) -> f64 {
    let predicted = &confusion.counts[row][..confusion.intents.len()];
    match predicted.iter().sum::<u64>() {
        0 => 0.0,
        total => predicted[column] as f64 / total as f64,
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
        let svg = matrix(&confusion).0;
        assert!(svg.contains("25.0 %"));
        // Labels at the times that they are for, not when they are emitted.
        assert!(svg.contains("predicted") && !svg.contains("emitted"));
    }
}
