//! Access to the page: from this machine alone, or with the token.
//!
//! Other sites open in the same browser are kept out in two ways. Their websocket has a foreign `Origin`. If their name
//! resolves to this machine (DNS rebinding), the `Host` has that name: only addresses and `localhost`, which nobody can
//! redirect, are answered. The port is not compared: a tunnel has its own.

use std::fmt::Write as _;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

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

/// Host that cannot be redirected to another machine, and port.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Authority {
    name: Name,
    port: u16,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Name {
    Localhost,
    Address(IpAddr),
}

impl Authority {
    /// Parses a `Host`, or an origin without its scheme (RFC 3986, 3.2); none for any other name.
    fn parse(text: &str) -> Option<Self> {
        let (name, port) = match text.strip_prefix('[') {
            Some(rest) => {
                let (address, port) = rest.split_once(']')?;
                let address: Ipv6Addr = address.parse().ok()?;
                (Name::Address(address.to_canonical()), port)
            }
            None => {
                let (name, port) = text.split_at(text.find(':').unwrap_or(text.len()));
                // A fully qualified name may end with a dot.
                let name = name.strip_suffix('.').unwrap_or(name);
                let address = || name.parse().map(|address: Ipv4Addr| address.into());
                let name = if name.eq_ignore_ascii_case("localhost") {
                    Name::Localhost
                } else {
                    Name::Address(address().ok()?)
                };
                (name, port)
            }
        };
        let port = match port.strip_prefix(':') {
            Some(digits) if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                digits.parse().ok()?
            }
            // Default port of HTTP.
            None if port.is_empty() => 80,
            _ => return None,
        };
        Some(Self { name, port })
    }
}

/// Request that is answered.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct AllowedRequest<'p> {
    /// Path without the token and the slashes around.
    pub(super) path: &'p str,
    /// Name of this server in the browser.
    pub(super) host: String,
}

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

    /// Checks the origin, the host and the token of a request.
    ///
    /// # Errors
    /// [`Denied`], by the first check that fails.
    pub(super) fn check<'p>(
        &self,
        path: &'p str,
        headers: &HeaderMap,
    ) -> Result<AllowedRequest<'p>, Denied> {
        let host = headers
            .get(header::HOST)
            .and_then(|host| host.to_str().ok())
            .unwrap_or_default();
        let own = Authority::parse(host)
            .filter(|authority| self.is_own(authority.name))
            .ok_or_else(|| Denied::host(host))?;
        if let Some(origin) = headers.get(header::ORIGIN) {
            let origin = origin.to_str().ok();
            let origin = origin.and_then(|origin| origin.strip_prefix("http://"));
            if origin.and_then(Authority::parse) != Some(own) {
                return Err(Denied::Origin);
            }
        }
        let path = path.strip_prefix('/').unwrap_or(path);
        let path = match &self.token {
            None => path,
            Some(token) => {
                let (found, path) = path.split_once('/').ok_or(Denied::Token)?;
                // The length of a token is not secret.
                let same: bool = found.as_bytes().ct_eq(token.as_bytes()).into();
                if !same {
                    return Err(Denied::Token);
                }
                path
            }
        };
        Ok(AllowedRequest {
            path,
            host: host.to_owned(),
        })
    }

    /// Whether this server may be reached by this name.
    const fn is_own(&self, name: Name) -> bool {
        match name {
            Name::Localhost => true,
            Name::Address(address) => is_local(address) || !is_local(self.address.ip()),
        }
    }
}

#[cfg(test)]
mod tests;
