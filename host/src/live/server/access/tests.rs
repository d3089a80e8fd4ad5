//! Names and origins that are answered, and refused ones.

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
    // A tunnel has its own port; a browser leaves out port 80.
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
        assert!(matches!(named, Err(Denied::Host(_))), "{named:?}");
    }
    // Requests through a tunnel, or to another machine's port.
    for host in [
        "localhost:9000",
        "[::1]",
        "203.0.113.5:81",
        "[fe80::1]:8377",
    ] {
        assert!(access.check(&path, &headers(host)).is_ok(), "{host}");
    }
}
