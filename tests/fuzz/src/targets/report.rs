//! The lines of labels, states, alignments and samples: what parses is written back byte for byte, and is no command.

use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::uart_line::command::CommandReader;
use shared::uart_line::emg::EmgReport;

use super::command::framed;

/// A line as it is, then the same as the body of a line.
pub fn run(data: &[u8]) {
    check(data);
    let mut line = framed(data);
    line.extend(*b"\r\n");
    check(&line);
}

fn check(line: &[u8]) {
    let report = Report::parse(line).map(|report| report.to_string());
    let alignment = AlignmentReport::parse(line).map(|report| report.to_string());
    let emg = EmgReport::parse(line).map(|report| report.to_string());
    let most = [99, 77, 54];
    let mut kinds = 0;
    for (written, most) in [report, alignment, emg].into_iter().zip(most) {
        let Ok(written) = written else { continue };
        kinds += 1;
        assert_eq!(written.as_bytes(), line);
        assert!(written.len() <= most, "{} bytes", written.len());
        is_not_answered(&written);
    }
    assert!(kinds <= 1, "a line of two kinds");
}

/// A receiver connected to the own transmitter does not talk to itself.
pub fn is_not_answered(line: &str) {
    let mut reader = CommandReader::new();
    let answer = line.bytes().find_map(|byte| reader.push(byte));
    assert_eq!(answer, None, "the device answers its own line {line:?}");
}
