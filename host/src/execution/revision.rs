//! Which source the program was built from.

/// Git revision of the source that this program was compiled from, `-dirty` at its end if that had changes; none if it
/// was compiled outside its repository.
#[must_use]
pub fn revision() -> Option<&'static str> {
    // Set by build.rs.
    option_env!("MYOINTENT_REVISION").filter(|revision| !revision.is_empty())
}
