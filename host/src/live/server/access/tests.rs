//! Names and origins that are answered, and refused ones.

use super::*;

fn access(address: &str) -> Access {
    Access::new(address.parse().unwrap())
}

/// Outcome of a request for `path` with these headers; an empty one is not sent.
fn check(access: &Access, path: &str, [host, origin]: [&str; 2]) -> Result<String, Denied> {
    let mut headers = HeaderMap::new();
    for (name, value) in [(header::HOST, host), (header::ORIGIN, origin)] {
        if !value.is_empty() {
            headers.insert(name, value.parse().unwrap());
        }
    }
    let (path, own) = access.check(path, &headers)?;
    assert_eq!(own, host);
    Ok(path.to_owned())
}

#[test]
#[rustfmt::skip]
fn on_this_machine_its_names_are_answered_with_any_port_and_no_other() {
    let access = access("127.0.0.1:8377");
    assert_eq!(access.url(), "http://127.0.0.1:8377/");
    // A tunnel has its own port; a browser leaves out port 80.
    for host in [
        "127.0.0.1:8377", "127.0.0.1", "127.8.9.1:9000", "localhost:8377", "localhost", "LocalHost:9000", "localhost.", "localhost.:8377",
        "[::1]", "[::1]:9000", "[0:0:0:0:0:0:0:1]:9000", "[::ffff:127.0.0.1]:9000", "[::FFFF:7F00:1]",
    ] {
        assert_eq!(check(&access, "/x", [host, ""]), Ok("x".to_owned()), "{host}");
    }
    for host in [
        "", ":8377", ".", "192.168.0.2:8377", "0.0.0.0:8377", "[::]:8377", "[fe80::1]:8377", "[::ffff:192.168.0.2]:8377",
        "evil.example", "evil.example:8377", "localhost.evil.example:8377", "evil.localhost.example:8377", "notlocalhost:8377",
        ".localhost:8377", "localhost:", "localhost:+80", "localhost..", "localhost:99999", "localhost:8377:8377", "localhost/:8377", "local host:8377",
        "127.0.0.1.evil.example:8377", "127.0.0.1:8377.evil.example", "evil.example:8377@127.0.0.1:8377",
        "evil.example@localhost", "2130706433:8377", "0x7f000001:8377", "[::1", "[::1]8377", "[::1].evil.example:8377",
        "[localhost]:8377",
    ] {
        let denied = check(&access, "/", [host, ""]).unwrap_err();
        assert_eq!(denied.status(), StatusCode::MISDIRECTED_REQUEST, "{host}");
    }
}

#[test]
fn a_page_has_the_origin_of_its_own_host_behind_a_tunnel_too() {
    let access = access("127.0.0.1:8377");
    for (host, origin, is_own) in [
        ("localhost:9000", "http://localhost:9000", true),
        ("[::1]:9000", "http://[::1]:9000", true),
        ("localhost", "http://localhost", true),
        ("localhost:9000", "http://localhost:8377", false),
        ("localhost:9000", "http://127.0.0.1:9000", false),
        ("localhost:9000", "http://localhost", false),
        ("localhost:9000", "https://localhost:9000", false),
        ("localhost:9000", "http://evil.example:9000", false),
        (
            "localhost:9000",
            "http://localhost:9000.evil.example",
            false,
        ),
        ("localhost:9000", "null", false),
    ] {
        let found = check(&access, "/socket", [host, origin]);
        let expected = if is_own {
            Ok("socket".to_owned())
        } else {
            Err(Denied::Origin)
        };
        assert_eq!(found, expected, "{host} {origin}");
    }
}

#[test]
fn for_others_the_token_is_asked_for_and_a_name_still_refused() {
    let access = access("0.0.0.0:8377");
    let token = access.token.clone().unwrap();
    assert_eq!(token.len(), 32);
    assert_ne!(token, self::access("0.0.0.0:8377").token.unwrap());
    let path = format!("/{token}/socket");
    // Requests to another machine's port, and through a tunnel.
    for host in [
        "192.168.0.2:8377",
        "203.0.113.5:81",
        "[fe80::1]:8377",
        "localhost:9000",
        "[::1]",
    ] {
        assert_eq!(
            check(&access, &path, [host, ""]),
            Ok("socket".to_owned()),
            "{host}"
        );
    }
    let denied = check(&access, &path, ["evil.example:8377", ""]);
    assert!(matches!(denied, Err(Denied::Host(_))), "{denied:?}");
    let other = format!("/{}/", token.replace(|digit| digit != '0', "0"));
    let short = format!("/{}/", &token[1..]);
    let twice = format!("/{token}{token}/");
    let bare = format!("/{token}");
    for path in ["", "/", "/socket", "//", &other, &short, &twice, &bare] {
        let denied = check(&access, path, ["192.168.0.2:8377", ""]);
        assert_eq!(denied, Err(Denied::Token), "{path}");
    }
}
