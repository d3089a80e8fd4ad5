//! The picture in a terminal.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Line as Stroke};
use ratatui::widgets::{Block, Gauge, Paragraph};
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS};

use super::seen::{IN_VIEW, Seen};

/// Columns beside the traces.
const PANEL: u16 = 38;
/// Narrower, the traces are left out.
const LEAST: u16 = PANEL + 20;

/// Draws everything.
pub(super) fn draw(frame: &mut Frame<'_>, seen: &Seen, paused: bool) {
    let [head, body, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(0),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    let state = if seen.connected {
        Span::styled(
            " connected ",
            Style::new().fg(Color::Black).bg(Color::Green),
        )
    } else {
        Span::styled(" lost ", Style::new().fg(Color::White).bg(Color::Red))
    };
    let source = Span::raw(format!(" {}", seen.source));
    frame.render_widget(Line::from_iter([state, source]), head);
    let keys = if paused {
        "paused; space resumes   m mark   a align   q quit"
    } else {
        "space pause   m mark   a align   q quit"
    };
    frame.render_widget(Line::from(keys).style(Modifier::DIM), foot);
    if body.width < LEAST {
        panel(frame, seen, body);
        return;
    }
    let [left, right] =
        Layout::horizontal([Constraint::Min(0), Constraint::Length(PANEL)]).areas(body);
    traces(frame, seen, left);
    panel(frame, seen, right);
}

fn traces(frame: &mut Frame<'_>, seen: &Seen, area: Rect) {
    let most = seen.samples.iter().flatten().flatten();
    let most = most.fold(16.0_f64, |most, value| most.max(value.abs()));
    let lanes: [Rect; CHANNELS] = Layout::vertical([Constraint::Fill(1); CHANNELS]).areas(area);
    for (channel, lane) in lanes.into_iter().enumerate() {
        let [number, lane] =
            Layout::horizontal([Constraint::Length(2), Constraint::Min(0)]).areas(lane);
        let middle = Rect {
            y: number.y + number.height / 2,
            height: number.height.min(1),
            ..number
        };
        frame.render_widget(Line::from((channel + 1).to_string()), middle);
        let empty = IN_VIEW - seen.samples.len();
        let canvas = Canvas::default()
            .marker(Marker::Braille)
            .x_bounds([0.0, IN_VIEW as f64])
            .y_bounds([-most, most])
            .paint(|context| {
                let values = seen.samples.iter().map(|sample| sample.map(|s| s[channel]));
                let values: Vec<_> = values.collect();
                for (place, pair) in values.windows(2).enumerate() {
                    let [Some(y1), Some(y2)] = *pair else {
                        continue;
                    };
                    let x1 = (empty + place) as f64;
                    let (x2, color) = (x1 + 1.0, Color::Cyan);
                    context.draw(&Stroke {
                        x1,
                        y1,
                        x2,
                        y2,
                        color,
                    });
                }
            });
        frame.render_widget(canvas, lane);
    }
}

fn panel(frame: &mut Frame<'_>, seen: &Seen, area: Rect) {
    let scores = u16::try_from(seen.classes.len()).unwrap_or(u16::MAX);
    let [label, bars, numbers] = Layout::vertical([
        Constraint::Length(4),
        Constraint::Length(scores + 2),
        Constraint::Min(0),
    ])
    .areas(area);
    let name = seen.label.as_deref().unwrap_or("no stream");
    let valid = match (&seen.label, &seen.cause) {
        (None, _) => String::new(),
        (Some(_), None) => "valid".to_owned(),
        (Some(_), Some(cause)) => format!("not valid: {cause}"),
    };
    let style = if valid == "valid" {
        Style::new()
            .fg(colour(name))
            .add_modifier(Modifier::BOLD | Modifier::REVERSED)
    } else {
        Style::new().add_modifier(Modifier::DIM)
    };
    let text = vec![
        Line::styled(format!("  {}  ", name.to_uppercase()), style),
        Line::from(valid),
    ];
    frame.render_widget(
        Paragraph::new(text).block(Block::bordered().title("label")),
        label,
    );

    let block = Block::bordered().title("scores");
    let inner = block.inner(bars);
    frame.render_widget(block, bars);
    for (place, name) in seen.classes.iter().enumerate() {
        let y = inner
            .y
            .saturating_add(u16::try_from(place).unwrap_or(u16::MAX));
        if y >= inner.bottom() {
            break;
        }
        let score = seen.scores.get(place).copied().unwrap_or(0.0);
        let row = Rect {
            y,
            height: 1,
            ..inner
        };
        let gauge = Gauge::default()
            .ratio(score.clamp(0.0, 1.0))
            .label(format!("{name} {score:.2}"))
            .gauge_style(Style::new().fg(colour(name)));
        frame.render_widget(gauge, row);
    }

    let ms = |samples: u64| format!("{} ms", samples * u64::from(SAMPLE_PERIOD_MS));
    let rows = [
        ("cue", seen.truth.clone()),
        ("delay", seen.delay.map(ms)),
        ("lost", Some(format!("{} samples by radio", seen.lost))),
        (
            "battery",
            seen.battery.map(|percent| format!("{percent} %")),
        ),
        ("armband", seen.alignment.clone()),
        ("", Some(seen.comment.clone())),
    ];
    let rows = rows.into_iter().filter_map(|(name, value)| {
        let name = Span::styled(format!("{name:9}"), Modifier::DIM);
        Some(Line::from_iter([name, Span::raw(value?)]))
    });
    let block = Block::bordered().title("stream");
    frame.render_widget(
        Paragraph::new(rows.collect::<Vec<_>>()).block(block),
        numbers,
    );
}

fn colour(name: &str) -> Color {
    match name {
        "open" => Color::Blue,
        "close" => Color::Red,
        "wave-in" => Color::Green,
        "wave-out" => Color::Magenta,
        "pinch" => Color::Yellow,
        _ => Color::Gray,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    fn seen() -> Seen {
        let mut seen = Seen::default();
        for message in [
            r#"{"type":"source","kind":"port","name":"/dev/ttyACM0","connected":true,"detail":""}"#,
            r#"{"type":"model","classes":["relax","open","close"],"other":true,"look_ahead":50,"hold":20}"#,
            r#"{"type":"samples","at":1,"first":0,"emg":[[1,2,3,4,5,6,7,8],[-128,127,0,0,0,0,0,0]],"truth":["open",null]}"#,
            r#"{"type":"report","is_label":true,"instant":609,"emitted":660,"label":"close","valid":true,"cause":null,"lost":7}"#,
            r#"{"type":"scores","instant":609,"scores":[0.1,0.2,0.65,0.05]}"#,
            r#"{"type":"board","battery":80}"#,
            r#"{"type":"alignment","state":"aligned","turn":3,"mirrored":true}"#,
            r#"{"type":"comment","text":"armband battery low"}"#,
            "no message",
        ] {
            seen.take(message);
        }
        seen
    }

    fn picture(seen: &Seen, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| draw(frame, seen, false)).unwrap();
        let cells = terminal.backend().buffer().content.chunks(width.into());
        let row = |cells: &[ratatui::buffer::Cell]| {
            cells
                .iter()
                .map(ratatui::buffer::Cell::symbol)
                .collect::<String>()
        };
        cells.map(row).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn everything_that_is_known_is_shown() {
        let picture = picture(&seen(), 100, 30);
        for text in [
            "connected  port /dev/ttyACM0",
            "CLOSE",
            "valid",
            "close 0.65",
            "other 0.05",
            "255 ms",
            "7 samples by radio",
            "80 %",
            "aligned; turn 3, mirrored",
            "armband battery low",
            "q quit",
        ] {
            assert!(picture.contains(text), "{text}\n{picture}");
        }
        let braille = |letter| ('\u{2801}'..='\u{28ff}').contains(&letter);
        assert!(picture.contains(braille), "{picture}");
    }

    #[test]
    fn a_lost_source_shows_no_label() {
        let mut seen = seen();
        seen.take(r#"{"type":"source","kind":"port","name":"x","connected":false,"detail":"the port was closed"}"#);
        let picture = picture(&seen, 100, 30);
        assert!(
            !picture.contains("CLOSE") && picture.contains("NO STREAM"),
            "{picture}"
        );
        assert!(picture.contains("the port was closed"), "{picture}");
    }

    #[test]
    fn no_size_of_a_terminal_is_too_small() {
        let seen = seen();
        for width in (1..120).step_by(7) {
            for height in 1..30 {
                picture(&seen, width, height);
                picture(&Seen::default(), width, height);
            }
        }
    }

    #[test]
    fn missing_samples_leave_a_gap_and_old_ones_go() {
        let mut seen = seen();
        let one = |first: u64| {
            format!(r#"{{"type":"samples","first":{first},"emg":[[0,0,0,0,0,0,0,0]]}}"#)
        };
        seen.take(&one(5));
        assert_eq!(seen.end(), 6);
        let gaps: Vec<_> = seen.samples.iter().map(Option::is_none).collect();
        assert_eq!(gaps, [false, false, true, true, true, false]);
        seen.take(&one(u64::MAX - 1));
        assert_eq!(seen.samples.len(), IN_VIEW);
    }
}
