//! Who may look: this machine alone, or who knows the token.
//!
//! A page of somebody else in the same browser is kept out twice. Its websocket has a foreign `Origin`. And if its name is
//! made to resolve to this machine (DNS rebinding), it asks for that name: only addresses and `localhost` are answered.

use std::fmt::Write as _;
use std::net::{IpAddr, SocketAddr};

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
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub(crate) enum Denied {
    /// A name that anybody may give to this machine.
    #[error(
        "expected an address such as 127.0.0.1, or localhost, in place of the name in this page's address\n"
    )]
    Host,
    /// A page of somebody else.
    #[error("a page of another origin may not look in\n")]
    Origin,
    /// The token is missing or another one.
    #[error("expected the whole address that `myointent live` printed, with its token\n")]
    Token,
}

impl Denied {
    pub(super) const fn status(self) -> StatusCode {
        match self {
            Self::Host => StatusCode::MISDIRECTED_REQUEST,
            Self::Origin | Self::Token => StatusCode::FORBIDDEN,
        }
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
            .and_then(|host| host.to_str().ok());
        let host = host.filter(|host| self.is_own(host)).ok_or(Denied::Host)?;
        if let Some(origin) = headers.get(header::ORIGIN)
            && origin.to_str().ok() != Some(&format!("http://{host}"))
        {
            return Err(Denied::Origin);
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

    /// Whether a `Host` names this server by an address, or as `localhost`.
    fn is_own(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            // The default of HTTP.
            _ => (host, Some(80)),
        };
        if port != Some(self.address.port()) {
            return false;
        }
        let bare = name
            .strip_prefix('[')
            .and_then(|name| name.strip_suffix(']'));
        let address: Option<IpAddr> = bare.unwrap_or(name).parse().ok();
        match address {
            Some(address) => is_local(address) || !is_local(self.address.ip()),
            None => name.eq_ignore_ascii_case("localhost"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access(address: &str) -> Access {
        Access::new(address.parse().unwrap())
    }

    fn headers(host: Option<&str>, origin: Option<&str>) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in [(header::HOST, host), (header::ORIGIN, origin)] {
            if let Some(value) = value {
                headers.insert(name, value.parse().unwrap());
            }
        }
        headers
    }

    #[test]
    fn on_this_machine_names_of_it_are_answered_with_any_port() {
        let access = access("127.0.0.1:8377");
        // A tunnel has a port of its own; a browser leaves out port 80.
        for host in [
            "127.0.0.1:8377",
            "127.0.0.1:9000",
            "127.0.0.1:80",
            "127.0.0.1",
            "127.0.0.1.:8377",
            "127.8.9.1:8377",
            "localhost:8377",
            "localhost:9000",
            "localhost",
            "LOCALHOST:8377",
            "LocalHost:9000",
            "localhost.",
            "localhost.:9000",
            "[::1]",
            "[::1]:8377",
            "[::1]:9000",
            "[0:0:0:0:0:0:0:1]:9000",
            "[0000:0000:0000:0000:0000:0000:0000:0001]",
            "[::ffff:127.0.0.1]:9000",
            "[::FFFF:7F00:1]:9000",
        ] {
            let found = access.check("/", &headers(Some(host), None));
            assert!(found.is_ok(), "{host}: {found:?}");
        }
        assert_eq!(access.url(), "http://127.0.0.1:8377/");
    }

    #[test]
    fn on_this_machine_no_other_name_is_answered() {
        let access = access("127.0.0.1:8377");
        for host in [
            None,
            Some(""),
            Some(":8377"),
            Some("."),
            Some("192.168.0.2:8377"),
            Some("0.0.0.0:8377"),
            Some("[::]:8377"),
            Some("[fe80::1]:8377"),
            Some("[::ffff:192.168.0.2]:8377"),
            Some("evil.example"),
            Some("evil.example:8377"),
            Some("localhost.evil.example:8377"),
            Some("evil.localhost.example:8377"),
            Some("notlocalhost:8377"),
            Some("localhost..:8377"),
            Some(".localhost:8377"),
            Some("localhost:"),
            Some("localhost:99999"),
            Some("localhost:+80"),
            Some("localhost:8377:8377"),
            Some("localhost/:8377"),
            Some("local host:8377"),
            Some("127.0.0.1.evil.example:8377"),
            Some("127.0.0.1:8377.evil.example"),
            Some("evil.example:8377@127.0.0.1:8377"),
            Some("evil.example@localhost"),
            Some("2130706433:8377"),
            Some("0x7f000001:8377"),
            Some("[::1"),
            Some("::1]"),
            Some("[::1]8377"),
            Some("[::1].evil.example:8377"),
            Some("[127.0.0.1]:8377"),
            Some("[localhost]:8377"),
            Some("[::1%25lo]:8377"),
        ] {
            let found = access.check("/", &headers(host, None));
            assert_eq!(
                found.err().map(|denied| denied.status()),
                Some(StatusCode::MISDIRECTED_REQUEST),
                "{host:?}"
            );
        }
    }

    #[test]
    fn a_page_has_the_origin_of_its_own_host_behind_a_tunnel_too() {
        let access = access("127.0.0.1:8377");
        for (host, origin, expected) in [
            ("localhost:9000", "http://localhost:9000", true),
            ("[::1]:9000", "http://[::1]:9000", true),
            ("localhost.:9000", "http://localhost.:9000", true),
            ("localhost", "http://localhost", true),
            ("localhost:80", "http://localhost", true),
            ("LOCALHOST:9000", "http://localhost:9000", true),
            ("localhost:9000", "http://localhost:8377", false),
            ("localhost:9000", "http://127.0.0.1:9000", false),
            ("localhost:9000", "http://localhost", false),
            ("localhost:9000", "http://evil.example:9000", false),
            (
                "localhost:9000",
                "http://localhost:9000.evil.example",
                false,
            ),
        ] {
            let found = access.check("/socket", &headers(Some(host), Some(origin)));
            assert_eq!(found.is_ok(), expected, "{host} {origin}: {found:?}");
        }
    }

    #[test]
    fn a_page_of_another_origin_is_kept_out() {
        let access = access("127.0.0.1:8377");
        let host = Some("127.0.0.1:8377");
        for (origin, expected) in [
            ("http://127.0.0.1:8377", None),
            ("http://localhost:8377", Some(Denied::Origin)),
            ("http://evil.example", Some(Denied::Origin)),
            ("https://127.0.0.1:8377", Some(Denied::Origin)),
            ("null", Some(Denied::Origin)),
        ] {
            let found = access.check("/socket", &headers(host, Some(origin)));
            assert_eq!(found.err(), expected, "{origin}");
        }
    }

    #[test]
    fn for_others_the_token_is_asked_for_and_a_name_still_refused() {
        let access = access("0.0.0.0:8377");
        let token = access.token.clone().unwrap();
        assert_eq!(token.len(), 32);
        assert_ne!(token, self::access("0.0.0.0:8377").token.unwrap());
        let headers = |host| headers(Some(host), None);
        let check = |path: &str| {
            let found = access.check(path, &headers("192.168.0.2:8377"));
            found.map(|allowed| allowed.path.to_owned())
        };
        assert_eq!(check(&format!("/{token}/")), Ok(String::new()));
        assert_eq!(check(&format!("/{token}/socket")), Ok("socket".to_owned()));
        let other = format!("/{}/", token.replace(|digit| digit != '0', "0"));
        let short = format!("/{}/", &token[1..]);
        let twice = format!("/{token}{token}/");
        let bare = format!("/{token}");
        for path in ["", "/", "/socket", "//", &other, &short, &twice, &bare] {
            assert_eq!(check(path), Err(Denied::Token), "{path}");
        }
        let path = format!("/{token}/");
        for host in ["evil.example:8377", "localhost.evil.example", "[::1]evil"] {
            let named = access.check(&path, &headers(host));
            assert_eq!(named.err(), Some(Denied::Host), "{host}");
        }
        // Through a tunnel, or another machine's port.
        for host in [
            "localhost:9000",
            "[::1]",
            "203.0.113.5:81",
            "[fe80::1]:8377",
        ] {
            assert!(access.check(&path, &headers(host)).is_ok(), "{host}");
        }
    }
}
