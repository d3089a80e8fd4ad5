//! Where the tests find their reference numbers and recordings.
