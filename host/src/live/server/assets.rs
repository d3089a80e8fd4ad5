//! Answers with the files of the page.

use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse as _, Response};
use web::page::FILES;

const CROSS_ORIGIN_RESOURCE_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-resource-policy");

/// Answers with a file, for a browser that knows this server as `host`.
pub(super) fn answer(path: &str, host: &str) -> Response {
    let Some((_, kind, text)) = FILES.iter().find(|(name, ..)| *name == path) else {
        return (StatusCode::NOT_FOUND, "no such file\n").into_response();
    };
    let mut response = text.into_response();
    let headers = response.headers_mut();
    let fixed = [
        (CONTENT_TYPE, *kind),
        // A cached page could be of another version of the program.
        (CACHE_CONTROL, "no-store"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        // The address may contain a token.
        (REFERRER_POLICY, "no-referrer"),
        (CROSS_ORIGIN_RESOURCE_POLICY, "same-origin"),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Ok(policy) = HeaderValue::from_str(&policy(host)) {
        headers.insert(CONTENT_SECURITY_POLICY, policy);
    }
    response
}

/// Content security policy: own files only, nothing inline, no frames. Some browsers exclude the websocket from `'self'`.
fn policy(host: &str) -> String {
    format!(
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
         connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use shared::intent::Vocabulary;
    use web::page::CSS;

    #[test]
    fn every_file_is_served_with_its_policy_and_nothing_else() {
        for (path, kind, _) in FILES {
            let response = answer(path, "127.0.0.1:8377");
            assert_eq!(response.status(), StatusCode::OK);
            assert_eq!(response.headers()[CONTENT_TYPE], *kind);
            let policy = response.headers()[CONTENT_SECURITY_POLICY]
                .to_str()
                .unwrap();
            assert!(policy.starts_with("default-src 'none';"), "{policy}");
            assert!(!policy.contains("unsafe"), "{policy}");
        }
        for path in ["index.html", "../Cargo.toml", "live.js/", "/"] {
            assert_eq!(answer(path, "x").status(), StatusCode::NOT_FOUND);
        }
    }

    /// Reads the custom properties `#rrggbb` of the light scheme and of the dark one, which overrides them.
    fn schemes() -> [BTreeMap<&'static str, [f64; 3]>; 2] {
        let (_, _, text) = FILES.iter().find(|(name, ..)| *name == "live.css").unwrap();
        let blocks: Vec<_> = text.split(":root {").skip(1).collect();
        let [light, dark] = [blocks[0], blocks[1]].map(|block| {
            let (block, _) = block.split_once('}').unwrap();
            let pairs = block
                .split(';')
                .filter_map(|line| line.trim().split_once(": #"));
            let named = pairs.map(|(name, digits)| {
                // #fff is #ffffff.
                let digit = |at: usize| &digits[at * digits.len() / 6..][..1];
                let channel = |at: usize| {
                    let digits = digit(2 * at).to_owned() + digit(2 * at + 1);
                    f64::from(u8::from_str_radix(&digits, 16).unwrap()) / 255.0
                };
                (name.trim_start_matches("--"), [0, 1, 2].map(channel))
            });
            named.collect::<BTreeMap<_, _>>()
        });
        let mut both = light.clone();
        both.extend(dark);
        [light, both]
    }

    /// Contrast of two colours, 1 to 21 (WCAG 2.2, contrast ratio).
    fn contrast(one: [f64; 3], other: [f64; 3]) -> f64 {
        let luminance = |colour: [f64; 3]| {
            let [red, green, blue] = colour.map(|value| {
                if value <= 0.04045 {
                    value / 12.92
                } else {
                    ((value + 0.055) / 1.055).powf(2.4)
                }
            });
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
        one.max(other) / one.min(other)
    }

    #[test]
    fn text_stands_out_from_its_ground_in_both_schemes() {
        assert!((contrast([0.0; 3], [1.0; 3]) - 21.0).abs() < 1e-9);
        let classes = Vocabulary::Six.intents().iter().map(|intent| intent.name());
        let classes: Vec<_> = classes.collect();
        // All colours that rules give to text, and those of the classes.
        let mut texts: BTreeSet<&str> = classes.iter().copied().collect();
        for (_, kind, text) in FILES {
            if *kind == CSS {
                let rules = text.split(['{', '}', ';']);
                let colours = rules.filter_map(|rule| rule.trim().strip_prefix("color: var(--"));
                texts.extend(colours.map(|colour| colour.trim_end_matches(')')));
            }
        }
        // Excluded: the class of the session's task.
        texts.retain(|text| !["now", "on-class"].contains(text));
        assert!(
            texts.contains("quiet") && texts.contains("bad"),
            "{texts:?}"
        );
        let plain = texts
            .iter()
            .flat_map(|&text| ["card", "ground"].map(|ground| (text, ground)));
        let filled = classes.iter().copied().filter(|&class| class != "relax");
        let filled = filled
            .chain(["focus", "good"])
            .map(|ground| ("on-class", ground));
        let pairs: Vec<_> = plain.chain(filled).chain([("ink", "line")]).collect();
        for (scheme, colours) in ["light", "dark"].into_iter().zip(schemes()) {
            for (text, ground) in &pairs {
                let ratio = contrast(colours[text], colours[ground]);
                assert!(ratio >= 4.5, "{scheme}: {text} on {ground}: {ratio:.2}");
            }
        }
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        let page = FILES[0].2;
        for (path, _, text) in FILES {
            let addresses = text.replace("http://www.w3.org/2000/svg", "");
            assert!(
                !addresses.contains("//www") && !addresses.contains("https:"),
                "{path}"
            );
            assert!(!text.contains("style=\""), "{path}: an inline style");
        }
        assert!(!page.contains("<script>") && !page.contains("<style"));
    }
}
