//! Which source the program was built from.

/// What marks a revision whose source had changes that were not committed.
const DIRTY: &str = "-dirty";

/// Git revision of the source that this program was compiled from, `-dirty` at its end if that had changes; none if it
/// was compiled outside its repository.
#[must_use]
pub fn revision() -> Option<&'static str> {
    // Set by build.rs.
    option_env!("MYOINTENT_REVISION").filter(|revision| !revision.is_empty())
}

/// Whether a revision's source had changes that were not committed.
#[must_use]
pub fn is_dirty(revision: &str) -> bool {
    revision.ends_with(DIRTY)
}
