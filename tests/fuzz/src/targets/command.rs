//! Receiver of the UART: any bytes, and any text in a right frame.

use shared::uart_line::answer::Answer;
use shared::uart_line::command::{Command, CommandReader, MAX_COMMAND_BYTES};

/// Takes bytes unchanged, then the same bytes as the body of a line.
pub fn run(data: &[u8]) {
    let mut reader = CommandReader::default();
    for &byte in data {
        check(reader.push(byte));
    }
    reader.interrupt();
    let mut line = framed(data);
    line.extend(*b"\r\n");
    let mut answers = 0;
    for byte in line {
        if let Some(answer) = reader.push(byte) {
            answers += 1;
            check(Some(answer));
        }
    }
    let one_line = !data.iter().any(|byte| matches!(byte, b'$' | b'\r' | b'\n'));
    assert!(answers <= 1 || !one_line, "one answer a line");
    if let (true, Ok(Some(command))) = (one_line, Command::parse(&framed(data))) {
        let written = command.to_string();
        let lower = written.to_lowercase();
        // An address may be written in lower case, which changes the checksum and nothing else.
        let sent = String::from_utf8(framed(data)).expect("a command is text");
        let same = |text: &str| {
            text.trim_end()
                .rsplit_once('*')
                .map(|(body, _)| body.to_owned())
        };
        assert_eq!(
            same(&lower),
            same(&sent.to_lowercase()),
            "read and written back"
        );
        assert_eq!(
            Command::parse(written.trim_end().as_bytes()),
            Ok(Some(command))
        );
    }
}

fn check(found: Option<Result<Command, shared::uart_line::answer::Refusal>>) {
    match found {
        None => {}
        Some(Ok(command)) => {
            let line = command.to_string();
            assert!(line.len() <= MAX_COMMAND_BYTES + 2, "{line}");
            let again = Command::parse(line.trim_end().as_bytes());
            assert_eq!(again, Ok(Some(command)), "{line}");
        }
        Some(Err(refusal)) => {
            let line = Answer::Refused(refusal).to_string();
            assert_eq!(
                Command::parse(line.trim_end().as_bytes()),
                Ok(None),
                "{line}"
            );
        }
    }
}

/// Returns a line with the right checksum, without its end.
pub fn framed(body: &[u8]) -> Vec<u8> {
    let sum = body.iter().fold(0, |sum, byte| sum ^ byte);
    [b"$", body, format!("*{sum:02X}").as_bytes()].concat()
}
