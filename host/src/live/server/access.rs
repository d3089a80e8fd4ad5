//! Access to the page: from this machine alone, or with the token.
//!
//! Other sites open in the same browser are kept out in two ways. Their websocket has a foreign `Origin`. If their name
//! resolves to this machine (DNS rebinding), the `Host` has that name: only addresses and `localhost`, which nobody can
//! redirect, are answered. The port is not compared: a tunnel has its own.

use std::fmt::Write as _;
use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, StatusCode, header};
use subtle::ConstantTimeEq as _;

use crate::live::is_local;

/// Rule for the requests that are answered.
#[derive(Debug)]
pub(crate) struct Access {
    address: SocketAddr,
    /// Token, the first part of every path; none for a page on this machine alone.
    token: Option<String>,
}

/// Reason why a request is not answered.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub(crate) enum Denied {
    /// Foreign name, or an address of another machine.
    #[error(
        "expected localhost or an address such as 127.0.0.1 or [::1], found \"{0}\": open the page under one of these, with any port\n"
    )]
    Host(String),
    /// Page of another origin.
    #[error("a page of another origin may not look in\n")]
    Origin,
    /// Missing or wrong token.
    #[error("expected the whole address that `myointent live` printed, with its token\n")]
    Token,
}

impl Denied {
    fn host(found: &str) -> Self {
        let letters = found.chars().filter(char::is_ascii_graphic);
        Self::Host(letters.take(MAX_NAME).collect())
    }

    pub(super) const fn status(&self) -> StatusCode {
        match self {
            Self::Host(_) => StatusCode::MISDIRECTED_REQUEST,
            Self::Origin | Self::Token => StatusCode::FORBIDDEN,
        }
    }
}

/// Greatest number of characters of a refused name in the answer.
const MAX_NAME: usize = 64;

impl Access {
    /// Rule for a server on an address; draws a token unless the address is of this machine alone.
    pub(crate) fn new(address: SocketAddr) -> Self {
        let token = (!is_local(address.ip())).then(|| {
            let random: [u8; 16] = rand::random();
            random.iter().fold(String::new(), |mut text, byte| {
                let _ = write!(text, "{byte:02x}");
                text
            })
        });
        Self { address, token }
    }

    /// URL to open in a browser.
    pub(crate) fn url(&self) -> String {
        let Self { address, token } = self;
        match token {
            Some(token) => format!("http://{address}/{token}/"),
            None => format!("http://{address}/"),
        }
    }

    /// Checks the host, the origin and the token of a request. Returns the path without the token and the slashes around, and the
    /// name of this server in the browser.
    ///
    /// # Errors
    /// [`Denied`], by the first check that fails.
    pub(super) fn check<'r>(
        &self,
        path: &'r str,
        headers: &'r HeaderMap,
    ) -> Result<(&'r str, &'r str), Denied> {
        let text = |name| {
            headers
                .get(name)
                .map(|own| own.to_str().unwrap_or_default())
        };
        let host = text(header::HOST).unwrap_or_default();
        if !self.is_own(host) {
            return Err(Denied::host(host));
        }
        // A browser writes both alike.
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        if !text(header::ORIGIN).is_none_or(is_own) {
            return Err(Denied::Origin);
        }
        let path = path.strip_prefix('/').unwrap_or(path);
        let Some(token) = &self.token else {
            return Ok((path, host));
        };
        let (found, path) = path.split_once('/').ok_or(Denied::Token)?;
        // The length of a token is not secret.
        let same: bool = found.as_bytes().ct_eq(token.as_bytes()).into();
        if same {
            Ok((path, host))
        } else {
            Err(Denied::Token)
        }
    }

    /// Whether this server may be reached by a host: `localhost`, with or without the dot of the root, or an address, which nobody can
    /// redirect to another machine; with or without a port.
    fn is_own(&self, host: &str) -> bool {
        let with_port = host.parse().map(|at: SocketAddr| at.ip());
        let address = with_port.or_else(|_| {
            let bare = host.strip_prefix('[').and_then(|own| own.strip_suffix(']'));
            bare.unwrap_or(host).parse::<IpAddr>()
        });
        let (name, port) = host.split_once(':').unwrap_or((host, "80"));
        let name = name.strip_suffix('.').unwrap_or(name);
        let is_port = port.parse::<u16>().is_ok() && !port.starts_with('+');
        let is_localhost = name.eq_ignore_ascii_case("localhost") && is_port;
        let is_ours = |address| is_local(address) || !is_local(self.address.ip());
        address.map_or(is_localhost, is_ours)
    }
}

#[cfg(test)]
mod tests;
