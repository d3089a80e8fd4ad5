//! Events as lines of JSON on an output, for scripts and other programs.
//!
//! The messages are those of the page. A slow reader loses some and is told how many; the source never waits for it.

use std::io::Write;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio::sync::watch;
use tokio::time::timeout;

use super::hub::{Hub, Subscription};

/// Longest time without a line: only a write shows that the reader has closed the output.
const QUIET: Duration = Duration::from_secs(1);
/// Time that a reader has to take the last lines.
const PATIENCE: Duration = Duration::from_secs(1);

/// Thread that writes the lines.
#[derive(Debug)]
pub(crate) struct JsonLines {
    thread: JoinHandle<std::io::Result<()>>,
    stop: watch::Sender<bool>,
}

impl JsonLines {
    /// Starts the thread that writes every event from now on, each line at once.
    ///
    /// # Errors
    /// When the system gives no thread or no clock.
    pub(crate) fn start(
        hub: Arc<Hub>,
        mut output: impl Write + Send + 'static,
    ) -> std::io::Result<Self> {
        let (stop, stopped) = watch::channel(false);
        // No viewer of a page has this number.
        let subscription = hub.subscribe(0);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("lines".to_owned())
            .spawn(move || runtime.block_on(write(&hub, subscription, &mut output, stopped)))?;
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
        let _ = self.stop.send(true);
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
async fn write(
    hub: &Hub,
    mut subscription: Subscription,
    output: &mut impl Write,
    mut stop: watch::Receiver<bool>,
) -> std::io::Result<()> {
    loop {
        let next = tokio::select! {
            // What was published before the end is still written.
            biased;
            next = timeout(QUIET, subscription.next(hub)) => next,
            _ = stop.wait_for(|stop| *stop) => return Ok(()),
        };
        let quiet = || serde_json::json!({ "type": "quiet", "at": hub.now() });
        let message = next.unwrap_or_else(|_| quiet().to_string().into());
        writeln!(output, "{message}")?;
        output.flush()?;
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

    /// Writes to an output, and publishes a mark.
    fn written(output: Pipe) -> (JsonLines, Arc<Hub>) {
        let hub = Arc::new(Hub::new());
        let running = JsonLines::start(hub.clone(), output).unwrap();
        mark(&hub);
        (running, hub)
    }

    fn mark(hub: &Hub) {
        let (sample, text) = (7, String::new());
        hub.send(None, &Event::Mark { sample, text });
    }

    #[test]
    fn a_reader_may_be_512_messages_behind_and_is_told_how_many_more_it_lost() {
        for (behind, lost) in [(512, 0), (513, 513)] {
            let (sender, lines) = sync_channel(0);
            let (running, hub) = written(Pipe::Slow(sender));
            // The first one is being written.
            let mut text = lines.recv().unwrap();
            (0..behind).for_each(|_| mark(&hub));
            let reader = std::thread::spawn(move || {
                text.extend(lines.iter().flatten());
                text
            });
            running.stop().unwrap();
            let text = String::from_utf8(reader.join().unwrap()).unwrap();
            let told = format!(r#"{{"type":"skipped","messages":{lost}}}"#);
            assert_eq!(text.contains(&told), lost > 0, "{text}");
            assert_eq!(text.matches(r#""mark""#).count(), 1 + behind - lost);
        }
    }

    #[test]
    fn a_full_disk_is_an_error_and_a_reader_that_takes_nothing_does_not_hold_up_the_end() {
        let full = written(Pipe::Full).0.stop().unwrap_err();
        assert_eq!(full.kind(), ErrorKind::StorageFull);
        let (sender, _lines) = sync_channel(1);
        let (running, hub) = written(Pipe::Slow(sender));
        (0..100).for_each(|_| mark(&hub));
        running.stop().unwrap();
    }
}
