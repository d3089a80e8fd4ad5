//! Rights of viewers, by the mode of the program: one table, repeated in docs/live.md. One viewer leads a recording session,
//! and all others watch.

use std::sync::{Mutex, PoisonError};

use crate::live::source::Source;
use web::event::ViewerId;

/// Mode of the program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Mode {
    /// `live` with a board or an armband.
    Live,
    /// `live` with a recording or the demo.
    Replay,
    /// `record` with any source but a board.
    Record,
    /// `record` with a board.
    RecordBoard,
}

impl Mode {
    /// Mode for a source, with or without a recording session.
    pub(crate) const fn of(source: &Source, records: bool) -> Self {
        match (source, records) {
            (Source::Port(_), true) => Self::RecordBoard,
            (_, true) => Self::Record,
            (Source::Port(_) | Source::Bluetooth(_), false) => Self::Live,
            (Source::Demo | Source::Replay(_), false) => Self::Replay,
        }
    }
}

/// Permission to send a request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Right {
    /// Every viewer.
    All,
    /// Viewer who leads the session; the first to ask does.
    Leader,
    /// Refusal for everybody, with the reason.
    Nobody(&'static str),
}

use Right::{All, Leader, Nobody};

const NO_SESSION: Right = Nobody(
    "no session is recorded here: `myointent record` has a page for it; viewers of `live` may mark and align",
);
const NOT_HERE: Right = Nobody(
    "viewers of `live` may mark and align: bind an armband with `myointent record --port PATH`, `myointent board --port PATH bind begin` or the board's button",
);
const NO_BOARD: Right = Nobody("there is no board here: `myointent record --port PATH` has one");

/// Requests, and who may send them in [`Mode::Live`], `Replay`, `Record`, `RecordBoard`.
const TABLE: [(&[&str], [Right; 4]); 4] = [
    (
        &["ping", "mark", "align", "cancel", "place"],
        [All, All, All, All],
    ),
    (
        &["session", "gesture"],
        [NO_SESSION, NO_SESSION, Leader, Leader],
    ),
    (&["bind"], [NOT_HERE, NOT_HERE, NO_BOARD, Leader]),
    (&["install"], [NO_SESSION, NO_SESSION, NO_BOARD, Leader]),
];

/// Right to a request; nobody for an unknown one.
pub(super) fn of(request: &str, mode: Mode) -> Right {
    let row = TABLE.iter().find(|(names, _)| names.contains(&request));
    row.map_or(Nobody("there is no such request"), |(_, rights)| {
        rights[mode as usize]
    })
}

/// Viewer who leads: the first to send a request to the session, until it leaves the page.
#[derive(Debug, Default)]
pub(crate) struct Lead(Mutex<Option<ViewerId>>);

impl Lead {
    /// Claims the lead. Returns whether the viewer leads, and whether that is new.
    pub(crate) fn claim(&self, viewer: ViewerId) -> (bool, bool) {
        let mut lead = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_new = lead.is_none();
        (*lead.get_or_insert(viewer) == viewer, is_new)
    }

    /// Releases the lead of a viewer that has left. Returns whether it led.
    pub(crate) fn release(&self, viewer: ViewerId) -> bool {
        let mut lead = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let led = *lead == Some(viewer);
        if led {
            *lead = None;
        }
        led
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_that_of_the_documentation() {
        let page = include_str!("../../../../docs/live.md");
        let word = |right| match right {
            All => "every viewer",
            Leader => "who leads",
            Nobody(_) => "nobody",
        };
        for (names, rights) in TABLE {
            let [live, replay, record, board] = rights.map(word);
            let names = names.join("`, `");
            let row = format!("| `{names}` | {live} | {replay} | {record} | {board} |");
            assert!(page.contains(&row), "docs/live.md lacks {row}");
        }
    }

    #[test]
    fn the_page_on_security_names_every_request_that_a_viewer_may_send() {
        let page = include_str!("../../../../SECURITY.md");
        let (_, section) = page.split_once("## The page of `live`").unwrap();
        let (section, _) = section.split_once("\n## ").unwrap();
        let lines = |right: Right| {
            let named = |line: &&str| {
                line.starts_with(if right == All {
                    "* Every viewer"
                } else {
                    "* Who leads"
                })
            };
            section.lines().filter(named).collect::<String>()
        };
        for (names, rights) in TABLE {
            let right = rights.into_iter().find(|right| !matches!(right, Nobody(_)));
            let line = lines(right.unwrap());
            for name in names.iter().filter(|name| **name != "ping") {
                assert!(line.contains(&format!("`{name}`")), "SECURITY.md: {name}");
            }
        }
    }

    #[test]
    fn a_pairing_and_an_installation_are_for_the_session_of_a_board_alone() {
        for request in ["bind", "install"] {
            for mode in [Mode::Live, Mode::Replay, Mode::Record] {
                assert!(matches!(of(request, mode), Nobody(_)), "{request} {mode:?}");
            }
            assert_eq!(of(request, Mode::RecordBoard), Leader);
        }
        assert!(matches!(of("reboot", Mode::RecordBoard), Nobody(_)));
    }

    #[test]
    fn the_first_leads_until_it_leaves() {
        let lead = Lead::default();
        assert_eq!(lead.claim(1), (true, true));
        assert_eq!(lead.claim(2), (false, false));
        assert_eq!(lead.claim(1), (true, false));
        assert!(!lead.release(2) && lead.release(1));
        assert_eq!(lead.claim(2), (true, true));
    }
}
