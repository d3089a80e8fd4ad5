//! HTTP client.

use std::time::Duration;

use ureq::Agent;

use super::error::FetchError;

/// Longest wait for a connection, and for the first line of an answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// Client for an address; an `https` address is never left for one without TLS.
pub(super) fn agent(url: &str) -> Agent {
    let config = Agent::config_builder()
        .http_status_as_error(false)
        .https_only(url.starts_with("https://"))
        .timeout_connect(Some(PATIENCE))
        .timeout_recv_response(Some(PATIENCE))
        .user_agent(concat!("myointent/", env!("CARGO_PKG_VERSION")));
    let config = if is_here(url) {
        // A proxy does not lead back to this machine.
        config.proxy(None)
    } else {
        config
    };
    config.build().new_agent()
}

/// Whether an address is on this machine.
fn is_here(url: &str) -> bool {
    url.starts_with("http://127.0.0.1:") || url.starts_with("http://localhost:")
}

/// Error of a request that got no answer.
pub(super) fn request_error(url: &str, error: &ureq::Error) -> FetchError {
    let host = url.split('/').nth(2).unwrap_or(url);
    FetchError::new(format!("cannot reach {host}: {error}"))
}
