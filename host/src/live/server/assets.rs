//! The files of the page, part of the program.

use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse as _, Response};

const CROSS_ORIGIN_RESOURCE_POLICY: HeaderName =
    HeaderName::from_static("cross-origin-resource-policy");

/// Path, type and text of each.
const FILES: [(&str, &str, &str); 15] = [
    ("", HTML, include_str!("../page/index.html")),
    (
        "icon.svg",
        "image/svg+xml",
        include_str!("../page/icon.svg"),
    ),
    ("live.css", CSS, include_str!("../page/live.css")),
    ("session.css", CSS, include_str!("../page/session.css")),
    ("live.js", SCRIPT, include_str!("../page/live.js")),
    ("armband.js", SCRIPT, include_str!("../page/armband.js")),
    ("clock.js", SCRIPT, include_str!("../page/clock.js")),
    ("gestures.js", SCRIPT, include_str!("../page/gestures.js")),
    ("panel.js", SCRIPT, include_str!("../page/panel.js")),
    ("save.js", SCRIPT, include_str!("../page/save.js")),
    ("seen.js", SCRIPT, include_str!("../page/seen.js")),
    ("result.js", SCRIPT, include_str!("../page/result.js")),
    ("session.js", SCRIPT, include_str!("../page/session.js")),
    ("time.js", SCRIPT, include_str!("../page/time.js")),
    ("traces.js", SCRIPT, include_str!("../page/traces.js")),
];

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// One of the files, for a browser that knows this server as `host`.
pub(super) fn answer(path: &str, host: &str) -> Response {
    let Some((_, kind, text)) = FILES.iter().find(|(name, ..)| *name == path) else {
        return (StatusCode::NOT_FOUND, "no such file\n").into_response();
    };
    let mut response = text.into_response();
    let headers = response.headers_mut();
    let fixed = [
        (CONTENT_TYPE, *kind),
        // The page of another version of the program.
        (CACHE_CONTROL, "no-store"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        // The address may have a token.
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

/// Nothing from elsewhere, nothing inline, in nobody's frame. Not every browser takes the websocket for `'self'`.
fn policy(host: &str) -> String {
    format!(
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
         connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_served_with_its_policy_and_nothing_else() {
        for (path, kind, _) in FILES {
            let response = answer(path, "127.0.0.1:8377");
            assert_eq!(response.status(), StatusCode::OK);
            assert_eq!(response.headers()[CONTENT_TYPE], kind);
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
