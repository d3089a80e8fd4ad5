//! The count of executed instructions.
