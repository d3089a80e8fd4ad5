//! Golden checks that run on the host and on the emulated core: each is a test here and, by [`ON_BOTH`], a test there.

use std::path::Path;

use checks::Check;

use crate::preprocess;
use crate::smoother;

/// Reads a check's data from the folder of reference numbers.
pub type Read = fn(&Path) -> Check;

macro_rules! on_both {
    ($($name:ident: $read:expr,)*) => {
        /// Names of the checks, and functions that read their data.
        pub const ON_BOTH: &[(&str, Read)] = &[$((stringify!($name), $read)),*];
        $(
            #[test]
            fn $name() {
                if let Some(golden) = myointent_tests::golden(stringify!($name)) {
                    let listed = ON_BOTH.iter().find(|(name, _)| *name == stringify!($name));
                    let (_, read) = listed.expect("every check is on the list");
                    read(&golden).run();
                }
            }
        )*
    };
}

on_both! {
    whole_recordings_become_the_reference_input: preprocess::whole,
    the_stream_gives_the_reference_input_one_sample_late: preprocess::stream,
    rectifying_first_is_the_other_variant: preprocess::rectified_first,
    a_window_cleaned_by_itself_has_the_live_edges: preprocess::live_edges,
    live_labels_are_the_references_in_every_case: smoother::live,
}
