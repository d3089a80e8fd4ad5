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
    use super::*;

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
