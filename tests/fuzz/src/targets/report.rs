//! Lines of a device, of every kind: a line that parses is written back byte for byte, and is no command.

use shared::uart_line::command::CommandReader;
use shared::uart_line::line::{Line, LineReader, MAX_LINE_BYTES};

use super::command::framed;

/// Takes a line unchanged, then the same bytes as the body of a line.
pub fn run(data: &[u8]) {
    check(data);
    let mut line = framed(data);
    line.extend(*b"\r\n");
    check(&line);
    stream(data);
}

/// Feeds bytes to the reader: what it finds is a line, and it takes the next line after any bytes.
fn stream(data: &[u8]) {
    let mut reader = LineReader::default();
    for &byte in data {
        if let Some(Ok(line)) = reader.push(byte) {
            let written = line.to_string();
            assert!(written.len() <= MAX_LINE_BYTES, "{} bytes", written.len());
            assert_eq!(Line::parse(written.as_bytes()), Ok(line));
        }
    }
    let next =
        b"\n$STATE,0,0,0,relax,0,boot,0,0,0*3F\r\n# send $BIND,begin*4A\r\n$OK,RAW,on*41\r\n";
    let found: Vec<_> = next
        .iter()
        .filter_map(|&byte| match reader.push(byte)? {
            Ok(Line::Report(_)) => Some("report"),
            Ok(Line::Comment(_)) => Some("comment"),
            Ok(Line::Answer(_)) => Some("answer"),
            _ => None,
        })
        .collect();
    assert!(
        found.ends_with(&["report", "comment", "answer"]),
        "lines after {data:?}: {found:?}"
    );
}

fn check(line: &[u8]) {
    let Ok(any) = Line::parse(line) else { return };
    let written = any.to_string();
    assert_eq!(written.as_bytes(), line);
    let most = match any {
        Line::Report(_) => 103,
        Line::Alignment(_) => 77,
        Line::Imu(_) => 61,
        Line::Emg(_) => 54,
        Line::Answer(_) | Line::Calibration(_) | Line::Comment(_) => usize::MAX,
    };
    assert!(written.len() <= most, "{} bytes", written.len());
    if !matches!(any, Line::Comment(_)) {
        is_not_answered(&written);
    }
}

/// Checks that a receiver connected to its own transmitter does not answer itself.
fn is_not_answered(line: &str) {
    let mut reader = CommandReader::default();
    let answer = line.bytes().find_map(|byte| reader.push(byte));
    assert_eq!(answer, None, "the device answers its own line {line:?}");
}
