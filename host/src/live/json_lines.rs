//! Events as lines of JSON on an output, for scripts and other programs.
//!
//! The messages are those of the page. A slow reader loses some and is told how many; the source never waits for it.

use std::io::Write;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio::sync::broadcast::error::RecvError;
use tokio::sync::watch;
use tokio::time::sleep;

use super::hub::{Addressed, Hub, Subscription};

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

/// Event that wakes the writer.
enum Wakeup {
    Received(Result<Addressed, RecvError>),
    Stop,
    Quiet,
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
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .build()?;
        let (stop, stopped) = watch::channel(false);
        let subscription = hub.subscribe();
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
    for message in subscription.known.drain(..) {
        line(output, &message)?;
    }
    loop {
        // Biased order: what was published before the end is still written.
        let wakeup = tokio::select! {
            biased;
            received = subscription.following.recv() => Wakeup::Received(received),
            _ = stop.wait_for(|stop| *stop) => Wakeup::Stop,
            () = sleep(QUIET) => Wakeup::Quiet,
        };
        match wakeup {
            Wakeup::Received(Ok((None, message))) => line(output, &message)?,
            Wakeup::Received(Ok((Some(_), _))) => {}
            Wakeup::Received(Err(RecvError::Lagged(messages))) => {
                let skipped = hub.resubscribe(&mut subscription, messages);
                line(output, &skipped)?;
                for message in subscription.known.drain(..) {
                    line(output, &message)?;
                }
            }
            Wakeup::Received(Err(RecvError::Closed)) | Wakeup::Stop => return Ok(()),
            Wakeup::Quiet => {
                let quiet = serde_json::json!({ "type": "quiet", "at": hub.now() });
                line(output, &quiet.to_string())?;
            }
        }
    }
}

fn line(output: &mut impl Write, message: &str) -> std::io::Result<()> {
    writeln!(output, "{message}")?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind;
    use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
    use web::event::Event;

    /// Output with a slow reader, who may close it.
    struct Pipe(SyncSender<String>);

    impl Write for Pipe {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let text = String::from_utf8_lossy(bytes).into_owned();
            let sent = self.0.send(text);
            sent.map_err(|_| ErrorKind::BrokenPipe)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    fn started() -> (Arc<Hub>, JsonLines, Receiver<String>) {
        let hub = Arc::new(Hub::new());
        let (sender, lines) = sync_channel(1);
        let running = JsonLines::start(hub.clone(), Pipe(sender)).unwrap();
        (hub, running, lines)
    }

    fn mark(sample: u32) -> Event {
        let text = String::new();
        Event::Mark { sample, text }
    }

    #[test]
    fn a_slow_reader_is_told_how_many_messages_it_lost() {
        let (hub, running, lines) = started();
        for sample in 0..3000 {
            hub.publish(&mark(sample));
        }
        let reader = std::thread::spawn(move || lines.iter().collect::<String>());
        running.stop().unwrap();
        let text = reader.join().unwrap();
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
    fn a_full_disk_is_no_closed_output() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(ErrorKind::StorageFull.into())
            }

            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let hub = Arc::new(Hub::new());
        let running = JsonLines::start(hub.clone(), Full).unwrap();
        hub.publish(&mark(1));
        assert_eq!(running.stop().unwrap_err().kind(), ErrorKind::StorageFull);
    }

    #[test]
    fn a_reader_that_takes_nothing_does_not_hold_up_the_end() {
        let (hub, running, _lines) = started();
        for sample in 0..100 {
            hub.publish(&mark(sample));
        }
        running.stop().unwrap();
    }
}
