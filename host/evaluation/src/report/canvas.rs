//! Common parts of all pictures: scale, colours, type, a title for screen readers.
//!
//! Pictures are drawn in the colours of a light page; on a dark screen the style sheet replaces each
//! neutral colour by its dark counterpart.

use std::io;

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};
use shared::intent::Intent;

use super::ReportError;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;

/// Units of the drawing per pixel of the page: plotters knows whole units only.
pub(super) const SCALE: i32 = 2;

/// Colour of text, and of lines that carry data.
pub(super) const INK: RGBColor = RGBColor(0x1F, 0x29, 0x33);
/// Colour of axes' text and of remarks.
pub(super) const MUTED: RGBColor = RGBColor(0x66, 0x70, 0x85);
/// Colour of grid lines and empty bands.
pub(super) const GRID: RGBColor = RGBColor(0xE2, 0xE6, 0xEB);
/// Colour of a muscle's trace.
pub(super) const TRACE: RGBColor = RGBColor(0x52, 0x60, 0x6D);

/// Colours of lines in order. Okabe and Ito, "Color Universal Design" (2008): distinguishable
/// with every common kind of colour vision.
pub(super) const LINES: [RGBColor; 5] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
];

/// Style sheet of pictures alone, with their colours on a dark screen.
pub(super) const STYLE: &str = "\
svg text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
@media screen and (prefers-color-scheme:dark){\
svg [fill='#1F2933']{fill:#E6E9ED}svg [stroke='#1F2933']{stroke:#E6E9ED}\
svg [fill='#667085']{fill:#9AA4B0}svg [stroke='#667085']{stroke:#9AA4B0}\
svg [fill='#E2E6EB']{fill:#2D353F}svg [stroke='#E2E6EB']{stroke:#2D353F}\
svg [fill='#52606D']{fill:#A9B4C0}svg [stroke='#52606D']{stroke:#A9B4C0}\
svg [fill='#B8C0CA']{fill:#56616E}\
svg [fill='#0072B2']{fill:#2B83C0}svg [stroke='#0072B2']{stroke:#2B83C0}\
}";

/// Colour of an entry of a page in every picture; at most [`LINES`] differ.
pub(super) const fn entry_colour(number: usize) -> RGBColor {
    LINES[number % LINES.len()]
}

/// Colour of an intent in every picture; rest is grey, so that gestures stand out.
pub(super) fn intent_colour(intent: Intent) -> RGBColor {
    match intent {
        Intent::Relax => RGBColor(0xB8, 0xC0, 0xCA),
        Intent::Open => LINES[0],
        Intent::Close => LINES[1],
        Intent::WaveIn => LINES[2],
        Intent::WaveOut => LINES[3],
        Intent::Pinch => LINES[4],
    }
}

/// Style of text of `points` pixels, anchored where it is put.
pub(super) fn text(points: f64, colour: RGBColor, h: HPos, v: VPos) -> TextStyle<'static> {
    // plotters divides a size by 1.24, the height of a font's box.
    let size = points * f64::from(SCALE) * 1.24;
    ("sans-serif", size)
        .into_font()
        .color(&colour)
        .pos(Pos::new(h, v))
}

/// Draws a picture of `width` x `height` pixels; `title` and `description` are for screen readers.
///
/// The SVG is fit for a page: no fixed size, no name space.
pub(super) fn draw(
    (width, height): (i32, i32),
    title: &str,
    description: &str,
    paint: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<String, ReportError> {
    let size = (
        (width * SCALE).unsigned_abs(),
        (height * SCALE).unsigned_abs(),
    );
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(&area)
            .and_then(|()| area.present())
            .map_err(|error| ReportError::Draw {
                picture: title.to_owned(),
                reason: error.to_string(),
            })?;
    }
    let body = svg.split_once('>').map_or("", |(_opening, body)| body);
    Ok(format!(
        "<svg role=\"img\" viewBox=\"0 0 {} {}\" style=\"max-width:{width}px\"><title>{}</title><desc>{}</desc>{body}",
        size.0,
        size.1,
        escape(title),
        escape(description),
    ))
}

/// The picture as a file of its own.
pub(super) fn stand_alone(svg: &str) -> String {
    svg.replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1)
        .replacen("<title>", &format!("<style>{STYLE}</style><title>"), 1)
}

/// Escapes text for HTML and SVG, element content and quoted attributes alike.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // XML has no way to write most control characters.
            control if control.is_control() && control != '\n' => safe.push(' '),
            plain => safe.push(plain),
        }
    }
    safe
}

/// A step of 1, 2 or 5 times a power of ten that divides `span` into `parts` or a little fewer.
pub(super) fn nice_step(span: f64, parts: f64) -> f64 {
    let rough = (span / parts).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}
