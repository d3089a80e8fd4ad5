//! Pictures as SVG: their elements, colours and type. Lengths are pixels of the page.
//!
//! Pictures are drawn in the colours of a light page; on a dark screen the style sheet replaces each
//! neutral colour by its dark counterpart.

pub(super) mod charts;
pub(super) mod confusion;
pub(super) mod overview;
pub(super) mod timeline;

use maud::{Markup, Render, html};
use shared::intent::Intent;

/// Place in a picture: pixels to the right and down.
type Point = (f64, f64);

/// Colour of text, and of lines that carry data.
pub(super) const INK: &str = "#1F2933";
/// Colour of axes' text and of remarks.
pub(super) const MUTED: &str = "#667085";
/// Colour of grid lines and empty bands.
const GRID: &str = "#E2E6EB";

/// Colours of lines in order. Okabe and Ito, "Color Universal Design" (2008): distinguishable
/// with every common kind of colour vision.
pub(super) const LINES: [&str; 5] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00"];

/// Style sheet of pictures alone, with their colours on a dark screen.
pub(super) const STYLE: &str = "\
svg text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
@media screen and (prefers-color-scheme:dark){\
svg [fill='#1F2933']{fill:#E6E9ED}svg [stroke='#1F2933']{stroke:#E6E9ED}\
svg [fill='#667085']{fill:#9AA4B0}svg [stroke='#667085']{stroke:#9AA4B0}\
svg [fill='#E2E6EB']{fill:#2D353F}svg [stroke='#E2E6EB']{stroke:#2D353F}\
svg [fill='#52606D']{fill:#A9B4C0}\
svg [fill='#B8C0CA']{fill:#56616E}\
svg [fill='#0072B2']{fill:#2B83C0}svg [stroke='#0072B2']{stroke:#2B83C0}\
}";

/// Colour of an entry of a page in every picture; at most [`LINES`] differ.
pub(super) const fn entry_colour(number: usize) -> &'static str {
    LINES[number % LINES.len()]
}

/// Colour of an intent in every picture; rest is grey, so that gestures stand out.
const fn intent_colour(intent: Intent) -> &'static str {
    match intent {
        Intent::Relax => "#B8C0CA",
        Intent::Open => LINES[0],
        Intent::Close => LINES[1],
        Intent::WaveIn => LINES[2],
        Intent::WaveOut => LINES[3],
        Intent::Pinch => LINES[4],
    }
}

/// Picture of `width` x `height` pixels; `title` and `description` are for screen readers.
fn picture((width, height): Point, title: &str, description: &str, body: &Markup) -> Markup {
    html! {
        svg role="img" class=[(width > 600.0).then_some("broad")] viewBox={ "0 0 " (width) " " (height) } style={ "max-width:" (width) "px" } {
            title { (title) } desc { (description) } (body)
        }
    }
}

/// Picture as a file of its own: with its name space and style.
pub(super) fn stand_alone(svg: &Markup) -> String {
    svg.0
        .replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1)
        .replacen("<title>", &format!("<style>{STYLE}</style><title>"), 1)
        // XML has no way to write most control characters.
        .replace(|c: char| c.is_control() && c != '\n', " ")
}

/// Text of `size` pixels at a point: `anchor` is its part at the point, start, middle or end, at half its height.
fn text(anchor: &str, (x, y): Point, size: f64, colour: &str, content: impl Render) -> Markup {
    html! { text x=(px(x)) y=(px(y)) dy="0.5ex" text-anchor=(anchor) font-size=(size) fill=(colour) { (content) } }
}

fn line(from: Point, to: Point, colour: &str, width: f64) -> Markup {
    html! { line x1=(px(from.0)) y1=(px(from.1)) x2=(px(to.0)) y2=(px(to.1)) stroke=(colour) stroke-width=(width) {} }
}

/// Filled rectangle from the left upper to the right lower corner.
fn rect((left, top): Point, (right, bottom): Point, colour: &str, opacity: f64) -> Markup {
    html! {
        rect x=(px(left)) y=(px(top)) width=(px(right - left)) height=(px(bottom - top)) fill=(colour)
            opacity=[(opacity < 1.0).then_some(opacity)] {}
    }
}

fn circle((x, y): Point, radius: f64, colour: &str) -> Markup {
    html! { circle cx=(px(x)) cy=(px(y)) r=(radius) fill=(colour) {} }
}

/// Points as the attribute `points` of a line or an outline.
fn points(of: impl IntoIterator<Item = Point>) -> String {
    let each = |(x, y)| format!("{},{}", px(x), px(y));
    of.into_iter().map(each).collect::<Vec<_>>().join(" ")
}

/// Length in half pixels: finer differences are invisible and make the file long.
fn px(length: f64) -> f64 {
    (length * 2.0).round() / 2.0 + 0.0
}

/// Horizontal axis of shares, from 0 at `left` to 1.
#[derive(Clone, Copy)]
struct ShareAxis {
    left: f64,
    width: f64,
}

impl ShareAxis {
    fn x(self, share: f64) -> f64 {
        self.left + self.width * share.clamp(0.0, 1.0)
    }

    /// Grid lines from `top` to `bottom`, with their numbers at height `labels`.
    fn grid(self, top: f64, bottom: f64, labels: f64) -> Markup {
        html! {
            @for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                (line((self.x(share), top), (self.x(share), bottom), GRID, 1.0))
                @if share * 2.0 % 1.0 == 0.0 { (text("middle", (self.x(share), labels), 11.0, MUTED, share)) }
            }
        }
    }
}

/// Name cut to at most `letters` letters.
fn shortened(name: &str, letters: usize) -> String {
    if name.chars().count() <= letters {
        return name.to_owned();
    }
    name.chars().take(letters - 1).chain(['…']).collect()
}

/// A step of 1, 2 or 5 times a power of ten that divides `span` into `parts` or a little fewer.
fn nice_step(span: f64, parts: f64) -> f64 {
    let rough = (span / parts).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let mut factors = [1.0, 2.0, 5.0].into_iter();
    let factor = factors.find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_has_its_place_on_the_axis() {
        let axis = ShareAxis {
            left: 10.0,
            width: 200.0,
        };
        let places = [0.0, 0.5, 1.0, 7.0].map(|share| axis.x(share));
        assert_eq!(places, [10.0, 110.0, 210.0, 210.0]);
    }

    #[test]
    fn a_long_name_ends_in_an_ellipsis() {
        assert_eq!(shortened("student", 7), "student");
        assert_eq!(shortened("students", 7), "studen…");
    }
}
