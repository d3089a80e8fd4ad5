//! The stream in a terminal, for a machine without a browser.

mod draw;
mod seen;

use std::sync::mpsc::SyncSender;
use std::time::Duration;

use ratatui::crossterm::event::{self, Event as Input, KeyCode, KeyEventKind, KeyModifiers};
use tokio::sync::broadcast::error::TryRecvError;

use self::seen::Seen;
use super::event::Event;
use super::hub::Hub;
use super::source::Request;

/// Between two pictures.
const FRAME: Duration = Duration::from_millis(40);

/// What a key asks for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Action {
    Quit,
    Pause,
    Mark,
    Align,
}

/// Shows the stream until `over` or until the user leaves; the terminal is then as before.
///
/// # Errors
/// When the terminal cannot be drawn on, or gives no keys.
pub(super) fn show(
    hub: &Hub,
    requests: &SyncSender<Request>,
    over: impl Fn() -> bool,
) -> std::io::Result<()> {
    let mut terminal = ratatui::try_init()?;
    let shown = run(&mut terminal, hub, requests, over);
    ratatui::restore();
    shown
}

fn run(
    terminal: &mut ratatui::DefaultTerminal,
    hub: &Hub,
    requests: &SyncSender<Request>,
    over: impl Fn() -> bool,
) -> std::io::Result<()> {
    let mut subscription = hub.subscribe();
    let mut seen = Seen::default();
    let (mut paused, mut marks) = (false, 0);
    while !over() {
        for message in subscription.known.drain(..) {
            seen.take(&message);
        }
        loop {
            match subscription.following.try_recv() {
                // The picture stands; what comes meanwhile is not kept here.
                Ok(_) if paused => {}
                Ok(message) => seen.take(&message),
                Err(TryRecvError::Lagged(_)) => subscription = hub.subscribe(),
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
            }
        }
        terminal.draw(|frame| draw::draw(frame, &seen, paused))?;
        if !event::poll(FRAME)? {
            continue;
        }
        match action(&event::read()?) {
            Some(Action::Quit) => break,
            Some(Action::Pause) => paused = !paused,
            Some(Action::Mark) => {
                marks += 1;
                let text = format!("mark {marks}");
                #[expect(clippy::cast_possible_truncation, reason = "counted as on the UART")]
                let sample = seen.end().saturating_sub(1) as u32;
                hub.publish(&Event::Mark { sample, text });
            }
            // A source that takes no requests is busy or ending.
            Some(Action::Align) => drop(requests.try_send(Request::Align)),
            None => {}
        }
    }
    Ok(())
}

fn action(input: &Input) -> Option<Action> {
    let Input::Key(key) = input else {
        return None;
    };
    if key.kind != KeyEventKind::Press {
        return None;
    }
    let control = key.modifiers.contains(KeyModifiers::CONTROL);
    match key.code {
        // The terminal is raw: it sends no signal.
        KeyCode::Char('c') if control => Some(Action::Quit),
        KeyCode::Char('q') | KeyCode::Esc => Some(Action::Quit),
        KeyCode::Char(' ') => Some(Action::Pause),
        KeyCode::Char('m') => Some(Action::Mark),
        KeyCode::Char('a') => Some(Action::Align),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::crossterm::event::KeyEvent;

    #[test]
    fn keys_are_those_of_the_last_line_and_ctrl_c_leaves() {
        let key = |code, modifiers| action(&Input::Key(KeyEvent::new(code, modifiers)));
        let plain = |letter| key(KeyCode::Char(letter), KeyModifiers::NONE);
        assert_eq!(plain('q'), Some(Action::Quit));
        assert_eq!(plain(' '), Some(Action::Pause));
        assert_eq!(plain('m'), Some(Action::Mark));
        assert_eq!(plain('a'), Some(Action::Align));
        assert_eq!(plain('c'), None);
        let control = key(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(control, Some(Action::Quit));
    }
}
