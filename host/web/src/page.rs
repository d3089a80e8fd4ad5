//! Files of the page, compiled into the program that serves it.

/// Makes path, MIME type and text of each file.
macro_rules! files {
    ($($path:literal $page:literal)*; $($kind:ident: $($name:literal)*;)*) => {
        &[
            $(($path, HTML, include_str!(concat!("../page/", $page))),)*
            $($(($name, $kind, include_str!(concat!("../page/", $name))),)*)*
        ]
    };
}

/// Path, MIME type and text of each file.
#[rustfmt::skip]
pub const FILES: &[(&str, &str, &str)] = files! {
    "" "index.html" "sessions" "sessions.html";
    ICON: "icon.svg";
    CSS: "live.css" "layout.css" "session.css" "wearer.css" "sessions.css";
    SCRIPT: "agreement.js" "arm.js" "armband.js" "arrival.js" "blocks.js" "bluetooth.js" "calibration.js" "clock.js" "dom.js" "empty.js"
            "ending.js" "english-session.js" "english.js" "german-program.js" "german-session.js" "german.js" "gestures.js"
            "guide.js" "help.js" "history.js" "link.js" "live.js" "notes.js" "now.js" "panel.js" "placement.js"
            "rates.js" "recordings.js" "result.js" "rows.js" "save.js" "serial.js" "session.js"
            "sessions.js" "socket.js" "sources.js" "steps.js" "store.js" "stored.js" "tab.js"
            "texts.js" "time.js" "traces.js" "wearer.js";
};

const HTML: &str = "text/html; charset=utf-8";
const ICON: &str = "image/svg+xml";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour such as `#fff` or `#0b63c5` (WCAG 2.2).
    fn luminance(colour: &str) -> f64 {
        let digits = colour.trim_start_matches('#');
        let width = digits.len() / 3;
        let parts = [0, 1, 2].map(|at| {
            let part = digits[at * width..][..width].repeat(3 - width);
            let value = f64::from(u8::from_str_radix(&part, 16).unwrap()) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        });
        0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]
    }

    #[test]
    fn the_colours_of_both_schemes_have_the_contrast_of_wcag() {
        let (.., css) = FILES.iter().find(|(path, ..)| *path == "live.css").unwrap();
        let schemes = css.split(":root {").skip(1);
        let schemes = schemes.map(|part| part.split('}').next().unwrap());
        let schemes: Vec<_> = schemes.filter(|part| part.contains("--card")).collect();
        assert_eq!(schemes.len(), 2, "light and dark");
        for scheme in schemes {
            let colours: Vec<(&str, f64)> = scheme
                .split("--")
                .filter_map(|part| part.split_once(": #"))
                .map(|(name, value)| (name, luminance(value.split(';').next().unwrap())))
                .collect();
            assert!(colours.len() > 16, "{colours:?}");
            let of = |wanted| colours.iter().find(|(name, _)| *name == wanted).unwrap().1;
            let grounds = ["card", "ground", "on-class"];
            for (name, colour) in &colours {
                // Backgrounds, and lines that only divide, need none; an edge shows where a button is.
                let least = match *name {
                    "card" | "ground" | "on-class" | "line" => continue,
                    "edge" => 3.0,
                    _ => 4.5,
                };
                for ground in grounds {
                    let [low, high] = [colour.min(of(ground)), colour.max(of(ground))];
                    let contrast = (high + 0.05) / (low + 0.05);
                    assert!(contrast >= least, "{name} on {ground}: {contrast}");
                }
            }
        }
    }
}
