//! Events as lines of JSON on an output, for scripts and other programs.
//!
//! The messages are those of the page. A slow reader loses some and is told how many; the source never waits for it.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::hub::{Hub, Subscription};

/// Longest time without a line: only a write shows that the reader has closed the output.
const QUIET: Duration = Duration::from_secs(1);
/// Time that a reader has to take the last lines.
const PATIENCE: Duration = Duration::from_secs(1);
/// Pause between two looks for messages: short beside the 10 ms between two of an armband.
const PAUSE: Duration = Duration::from_millis(2);

/// Thread that writes the lines.
#[derive(Debug)]
pub(crate) struct JsonLines {
    thread: JoinHandle<std::io::Result<()>>,
    stop: Arc<AtomicBool>,
}

impl JsonLines {
    /// Starts the thread that writes every event from now on, each line at once.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(crate) fn start(
        hub: Arc<Hub>,
        mut output: impl Write + Send + 'static,
    ) -> std::io::Result<Self> {
        let stop = Arc::<AtomicBool>::default();
        let stopped = stop.clone();
        // No viewer of a page has this number.
        let mut subscription = hub.subscribe(0);
        let thread = std::thread::Builder::new()
            .name("lines".to_owned())
            .spawn(move || write(&hub, &mut subscription, &mut output, &stopped))?;
        Ok(Self { thread, stop })
    }

    /// Whether the output takes no more lines.
    pub(crate) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Ends the thread after the messages published before. A reader that takes nothing more is left behind.
    ///
    /// # Errors
    /// Error that kept a line from being written.
    pub(crate) fn stop(self) -> std::io::Result<()> {
        self.stop.store(true, Ordering::Release);
        let end = Instant::now() + PATIENCE;
        while !self.thread.is_finished() {
            if Instant::now() > end {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        match self.thread.join() {
            Ok(written) => written,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Writes lines until the output is closed or the program ends.
fn write(
    hub: &Hub,
    subscription: &mut Subscription,
    output: &mut impl Write,
    stop: &AtomicBool,
) -> std::io::Result<()> {
    let mut last = Instant::now();
    loop {
        // Looked at first: what was published before the end is still written.
        let is_over = stop.load(Ordering::Acquire);
        let mut messages = subscription.take(hub);
        if messages.is_empty() && last.elapsed() > QUIET {
            let quiet = serde_json::json!({ "type": "quiet", "at": hub.now() });
            messages.push(quiet.to_string().into());
        }
        if !messages.is_empty() {
            last = Instant::now();
        }
        for message in messages {
            writeln!(output, "{message}")?;
            output.flush()?;
        }
        if is_over {
            return Ok(());
        }
        std::thread::sleep(PAUSE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Error, ErrorKind};
    use std::sync::mpsc::{SyncSender, sync_channel};
    use web::event::Event;

    /// Output with a slow reader, or on a full disk.
    enum Pipe {
        Slow(SyncSender<Vec<u8>>),
        Full,
    }

    impl Write for Pipe {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            match self {
                Self::Slow(sender) => {
                    let sent = sender.send(bytes.to_vec());
                    sent.map_err(|_| Error::from(ErrorKind::BrokenPipe))?;
                    Ok(bytes.len())
                }
                Self::Full => Err(ErrorKind::StorageFull.into()),
            }
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    /// Writes to an output, and publishes marks.
    fn written(output: Pipe, marks: u32) -> JsonLines {
        let hub = Arc::new(Hub::new());
        let running = JsonLines::start(hub.clone(), output).unwrap();
        for sample in 0..marks {
            let text = String::new();
            hub.send(None, &Event::Mark { sample, text });
        }
        running
    }

    #[test]
    fn a_slow_reader_is_told_how_many_messages_it_lost() {
        let (sender, lines) = sync_channel(1);
        let running = written(Pipe::Slow(sender), 3000);
        let reader = std::thread::spawn(move || lines.iter().flatten().collect::<Vec<u8>>());
        running.stop().unwrap();
        let text = String::from_utf8(reader.join().unwrap()).unwrap();
        let (mut marks, mut skipped) = (0, 0);
        for line in text.lines() {
            let message: serde_json::Value = serde_json::from_str(line).unwrap();
            marks += u64::from(message["type"] == "mark");
            skipped += message["messages"].as_u64().unwrap_or(0);
        }
        assert!(skipped > 0, "{text}");
        assert_eq!(marks + skipped, 3000);
    }

    #[test]
    fn a_full_disk_is_an_error_and_a_reader_that_takes_nothing_does_not_hold_up_the_end() {
        let full = written(Pipe::Full, 1).stop().unwrap_err();
        assert_eq!(full.kind(), ErrorKind::StorageFull);
        let (sender, _lines) = sync_channel(1);
        written(Pipe::Slow(sender), 100).stop().unwrap();
    }
}
