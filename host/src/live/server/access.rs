//! Who may look: this machine alone, or who knows the token.
//!
//! A page of somebody else in the same browser is kept out twice. Its websocket has a foreign `Origin`. And if its name is
//! made to resolve to this machine (DNS rebinding), it asks for that name: only addresses and `localhost` are answered. Nobody
//! can make those resolve to another machine. The port does not matter: a tunnel has one of its own.

use std::fmt::Write as _;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use axum::http::{HeaderMap, StatusCode, header};
use subtle::ConstantTimeEq as _;

use crate::live::is_local;

/// Which requests are answered.
#[derive(Debug)]
pub(crate) struct Access {
    address: SocketAddr,
    /// First part of every path; none on this machine alone.
    token: Option<String>,
}

/// Why a request is not answered.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub(crate) enum Denied {
    /// A name that anybody may give to this machine, or an address of another one.
    #[error(
        "expected localhost or an address such as 127.0.0.1 or [::1], found \"{0}\": open the page under one of these, with any port\n"
    )]
    Host(String),
    /// A page of somebody else.
    #[error("a page of another origin may not look in\n")]
    Origin,
    /// The token is missing or another one.
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

/// Characters of a refused name that are said again.
const MAX_NAME: usize = 64;

/// A name that cannot be made to mean another machine, and a port.
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
    /// Reads a `Host`, or an origin without its scheme (RFC 3986, 3.2); none for any other name.
    fn parse(text: &str) -> Option<Self> {
        let (name, port) = match text.strip_prefix('[') {
            Some(rest) => {
                let (address, port) = rest.split_once(']')?;
                let address: Ipv6Addr = address.parse().ok()?;
                (Name::Address(address.to_canonical()), port)
            }
            None => {
                let (name, port) = text.split_at(text.find(':').unwrap_or(text.len()));
                // The root of all names may be written.
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
            // The default of HTTP.
            None if port.is_empty() => 80,
            _ => return None,
        };
        Some(Self { name, port })
    }
}

/// A request that is answered.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Allowed<'p> {
    /// The path without the token and the slashes around.
    pub(super) path: &'p str,
    /// As the browser knows this server.
    pub(super) host: String,
}

impl Access {
    /// Of a server on an address; makes a token unless that is of this machine alone.
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

    /// What to open in a browser.
    pub(crate) fn url(&self) -> String {
        let Self { address, token } = self;
        match token {
            Some(token) => format!("http://{address}/{token}/"),
            None => format!("http://{address}/"),
        }
    }

    /// Checks where a request comes from, and what it asks for.
    ///
    /// # Errors
    /// The first of the reasons that it has.
    pub(super) fn check<'p>(
        &self,
        path: &'p str,
        headers: &HeaderMap,
    ) -> Result<Allowed<'p>, Denied> {
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
                // Of texts of another length, the length is no secret.
                let same: bool = found.as_bytes().ct_eq(token.as_bytes()).into();
                if !same {
                    return Err(Denied::Token);
                }
                path
            }
        };
        Ok(Allowed {
            path,
            host: host.to_owned(),
        })
    }

    /// Whether this server may be asked for by this name.
    const fn is_own(&self, name: Name) -> bool {
        match name {
            Name::Localhost => true,
            Name::Address(address) => is_local(address) || !is_local(self.address.ip()),
        }
    }
}

#[cfg(test)]
mod tests;
