//! File of a journal of a session in progress. It becomes recordings at the end of the session or at the next start.

mod file;
mod name;

pub(crate) use self::file::{FlushOutcome, Journal, open};
pub(super) use self::file::{LARGEST, SECOND};
pub(crate) use self::name::ENDING;

#[cfg(test)]
mod tests;
