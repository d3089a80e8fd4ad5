//! Missing part: a skipped test, or with `MYOINTENT_REQUIRE=all` a failed one. The tests run in processes of their own,
//! because the variable is the whole process's.

use std::process::Command;

/// Runs the ignored test below with a value of `MYOINTENT_REQUIRE`; returns true if it passed, and the text that it
/// printed.
fn with(required: Option<&str>) -> (bool, String) {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--ignored", "--exact", "finds_no_recordings"]);
    command.env("MYOINTENT_DATA", "/nowhere");
    match required {
        Some(value) => command.env("MYOINTENT_REQUIRE", value),
        None => command.env_remove("MYOINTENT_REQUIRE"),
    };
    let output = command.output().unwrap();
    let printed = [output.stdout, output.stderr].concat();
    (
        output.status.success(),
        String::from_utf8_lossy(&printed).into_owned(),
    )
}

#[test]
fn a_missing_part_skips_a_test_unless_everything_is_required() {
    let (passed, printed) = with(None);
    assert!(passed, "{printed}");
    assert!(printed.contains("SKIPPED finds_no_recordings"), "{printed}");
    let (passed, printed) = with(Some("all"));
    assert!(!passed, "{printed}");
    assert!(printed.contains("/nowhere"), "{printed}");
    let (passed, printed) = with(Some("some"));
    assert!(!passed, "{printed}");
    assert!(printed.contains("expected all"), "{printed}");
}

#[test]
#[ignore = "run by the test above, with MYOINTENT_DATA at a folder that does not exist"]
fn finds_no_recordings() {
    assert_eq!(myointent_tests::data(), None);
}
