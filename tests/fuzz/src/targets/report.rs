//! Lines of a device, of every kind: a line that parses is written back byte for byte, and is no command.

use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::CommandReader;
use shared::uart_line::emg::EmgReport;
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
    let mut reader = LineReader::new();
    for &byte in data {
        if let Some(Ok(line)) = reader.push(byte) {
            let written = line.to_string();
            assert!(written.len() <= MAX_LINE_BYTES, "{} bytes", written.len());
            assert_eq!(Line::parse(written.as_bytes()), Ok(line));
        }
    }
    let next = b"\n$STATE,0,0,0,relax,0,boot,0,0,0*3F\r\n";
    let mut last = false;
    for &byte in next {
        last = matches!(reader.push(byte), Some(Ok(Line::Report(_))));
    }
    assert!(last, "a line after {data:?} is not found");
}

fn check(line: &[u8]) {
    let report = Report::parse(line).map(|report| report.to_string());
    let alignment = AlignmentReport::parse(line).map(|report| report.to_string());
    let emg = EmgReport::parse(line).map(|report| report.to_string());
    let answer = Answer::parse(line).map(|answer| answer.to_string());
    let most = [103, 77, 54, usize::MAX];
    let mut kinds = 0;
    let all = [report, alignment, emg, answer];
    for (written, most) in all.into_iter().zip(most) {
        let Ok(written) = written else { continue };
        kinds += 1;
        assert_eq!(written.as_bytes(), line);
        assert!(written.len() <= most, "{} bytes", written.len());
        is_not_answered(&written);
    }
    assert!(kinds <= 1, "a line of two kinds");
    let any = Line::parse(line);
    let is_comment = matches!(any, Ok(Line::Comment(_)));
    assert_eq!(any.is_ok(), kinds == 1 || is_comment, "{any:?}");
    if let Ok(any) = any {
        assert_eq!(any.to_string().as_bytes(), line);
    }
}

/// Checks that a receiver connected to its own transmitter does not answer itself.
fn is_not_answered(line: &str) {
    let mut reader = CommandReader::new();
    let answer = line.bytes().find_map(|byte| reader.push(byte));
    assert_eq!(answer, None, "the device answers its own line {line:?}");
}
