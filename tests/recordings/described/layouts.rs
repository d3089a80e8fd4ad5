//! Layouts: what `describe` wrote, what was mended, and what came of it.

use super::{Layout, case, check, folder};

/// Tests of one layout each: a name, a set, and the layout.
macro_rules! layouts {
    ($($name:ident: $find:ident($set:literal), $layout:expr;)*) => {$(
        #[test]
        fn $name() {
            if let Some(folder) = $find(stringify!($name), $set) {
                check(&folder, &$layout);
            }
        }
    )*};
}

layouts! {
    ciil_needs_no_mending: folder("ciil"), Layout {
        wrote: &[
            r#"files = "{person}/{session}_R{trial}_{gesture}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { relax = ["relax"], open = ["open"], close = ["close"], wave-in = ["wavein"], wave-out = ["waveout"] }"#,
            r#"timing = "cues""#,
        ],
        mended: &[],
        found: (22, 1500, "close 905, open 903, relax 898, wave-in 904, wave-out 902"),
    };
    epn10_has_a_double_tap: folder("epn10"), Layout {
        wrote: &[
            r#"files = "{person}/{session}_{gesture}_{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { relax = ["relax"], open = ["open"], close = ["close"], wave-in = ["wavein"], wave-out = ["waveout"], unknown = ["doubletap"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[
            r#"labels = { relax = ["relax"], open = ["open"], close = ["close"], wave-in = ["wavein"], wave-out = ["waveout"], other = ["doubletap"] }"#,
        ],
        found: (7, 1260, "close 302, open 244, relax 4272, wave-in 331, wave-out 273, other 212, unlabelled 207"),
    };
    dutra_moves_has_numbers_in_a_file_beside: folder("dutra-moves"), Layout {
        wrote: &[
            r#"files = "{person}/s{trial}_emg.npy""#,
            r#"label_files = "{person}/s{trial}_ann.npy""#,
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 1, 2, 3, 4, 5, 6, 7] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            "labels = { relax = [0], open = [1], close = [2], wave-in = [3], wave-out = [4], other = [5, 6, 7] }",
            r#"timing = "muscle""#,
        ],
        found: (7, 9, "close 169, open 168, relax 1192, wave-in 169, wave-out 169, other 505"),
    };
    dutra_force_is_a_squeezed_ball: folder("dutra-force"), Layout {
        wrote: &[
            r#"files = "{person}/s{trial}_emg.npy""#,
            "rate = 200",
            "rectified = false",
        ],
        mended: &[
            r#"files = "{person}/{gesture}_emg.npy""#,
            r#"labels = { close = ["*"] }"#,
            r#"timing = "from-activity""#,
        ],
        found: (7, 8, "close 200, relax 216, unlabelled 89"),
    };
    pangestu_needs_no_mending: folder("pangestu"), Layout {
        wrote: &[
            r#"files = "{person}/{gesture}_T{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { open = ["open"], close = ["close"], wave-in = ["wavein"], wave-out = ["waveout"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[],
        found: (8, 147, "close 1586, open 1064, relax 5455, wave-in 1586, wave-out 1156, unlabelled 1883"),
    };
    dideakay_needs_no_mending: folder("dideakay"), Layout {
        wrote: &[
            r#"files = "{person}/{gesture}_{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { relax = ["relax"], open = ["open"], close = ["close"], wave-in = ["wavein"], wave-out = ["waveout"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[],
        found: (3, 32, "close 76, open 73, relax 888, wave-in 86, wave-out 83, unlabelled 184"),
    };
    psl_is_signs_without_rest: folder("psl"), Layout {
        wrote: &[
            r#"files = "{person}/{gesture}_{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { unknown = ["w01", "w02", "w03", "w04", "w05", "w06", "w07", "w08", "w09", "w10", "w11", "w12", "w13", "w14", "w15", "w16", "w17", "w18"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[
            r#"labels = { other = ["*"] }"#,
            r#"timing = "cues""#,
        ],
        found: (14, 1419, "other 2834"),
    };
    libras_is_letters_from_rest: folder("libras"), Layout {
        wrote: &[
            r#"files = "{person}/{gesture}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { unknown = ["*"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[
            r#"labels = { unknown = ["Mao_esticada_1", "Mao_esticada_2", "Mao_esticada_3"], other = ["*"] }"#,
        ],
        found: (5, 427, "relax 1347, other 996, unlabelled 359"),
    };
    lis_is_letters_of_one_signer: folder("lis"), Layout {
        wrote: &[
            r#"files = "p1/{gesture}_{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { unknown = ["A", "B", "C", "D", "E", "F", "G", "H", "I", "J", "K", "L", "M", "N", "O", "P", "Q", "R", "S", "T", "U", "V", "W", "X", "Y", "Z"] }"#,
            r#"timing = "from-activity""#,
        ],
        mended: &[
            r#"labels = { other = ["*"] }"#,
        ],
        found: (1, 579, "relax 543, other 578, unlabelled 34"),
    };
    asl_is_letters_and_nothing: folder("asl"), Layout {
        wrote: &[
            r#"files = "p1/{gesture}_{trial}.npy""#,
            "rate = 200",
            "rectified = false",
            r#"labels = { unknown = ["a", "b", "c", "gestures", "n", "nothingtable", "nothingvertical", "r", "right", "seq", "streamabnrand30s", "streamabntnv40s", "streamabraw", "streamantnvb", "streamrn30s5s", "streamrn30s5scontrol"] }"#,
            r#"timing = "cues""#,
        ],
        mended: &[
            r#"labels = { relax = ["n", "nothingtable", "nothingvertical"], other = ["a", "b", "c", "r"], unknown = ["*"] }"#,
        ],
        found: (1, 337, "relax 510, other 1634, unlabelled 535"),
    };
    emg4_has_gestures_of_two_people: folder("emg4"), Layout {
        wrote: &[
            r#"files = "{person}/{any}.npy""#,
            "rate = 200",
            "rectified = false",
        ],
        mended: &[
            r#"files = "{person}/{gesture}.npy""#,
            r#"labels = { close = ["rock"], open = ["paper"], two-fingers = ["scissors"], other = ["ok"], unknown = ["*"] }"#,
        ],
        found: (2, 14, "close 116, open 118, other 233, unlabelled 96"),
    };
    mused_stroke_has_unnamed_movements: folder("mused-stroke"), Layout {
        wrote: &[
            r#"files = "p1/set1_{session}_emg.npy""#,
            r#"label_files = "p1/set1_{session}_ann.npy""#,
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 1, 2] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            "labels = { relax = [0], other = [1, 2] }",
        ],
        found: (1, 5, "relax 125, other 250"),
    };
    myo_readings_has_sittings_behind_the_person: folder("myo-readings"), Layout {
        wrote: &[
            r#"files = "_readings_right_hand/{person}/{trial}.txt""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "label = 9",
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 1, 2, 3, 4, 5, 6, 7] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            r#"files = "_readings_right_hand/{person}-{session}/{any}.txt""#,
            "labels = { relax = [0], wave-in = [1], wave-out = [2], radial-deviation = [3], ulnar-deviation = [4], pronation = [5], supination = [6], close = [7] }",
        ],
        found: (32, 514, "close 2960, relax 18582, wave-in 2959, wave-out 2959, other 3872"),
    };
    one_subject_myo_has_numbers_for_classes: folder("one-subject-myo"), Layout {
        wrote: &[
            r#"files = "{session}/R_{trial}_C_{gesture}.csv""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 1, 2, 3, 4] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            "labels = { close = [0], open = [1], relax = [2], wave-out = [3], wave-in = [4] }",
        ],
        found: (1, 60, "close 36, open 36, relax 36, wave-in 36, wave-out 36"),
    };
    ss_stm_is_decimals: folder("ss-stm"), Layout {
        wrote: &[
            r#"files = "data/{person}/M{gesture}T{trial}.csv""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "rate = 200",
            "scale = 128",
            "rectified = false",
            "labels = { unknown = [1, 2, 3, 4, 5, 6, 7, 8] }",
            r#"timing = "from-activity""#,
        ],
        mended: &[
            "labels = { relax = [1], wave-in = [2], wave-out = [3], radial-deviation = [4], ulnar-deviation = [5], pronation = [6], supination = [7], close = [8] }",
        ],
        found: (20, 800, "close 269, relax 2013, wave-in 230, wave-out 216, other 918, unlabelled 353"),
    };
    nine_columns_are_channels_and_a_clock: case("nine-columns"), Layout {
        wrote: &[
            r#"files = "{any}.csv""#,
            "rate = 200",
            "rectified = false",
        ],
        mended: &[],
        found: (1, 1, "unlabelled 10"),
    };
    one_file_is_decimals: case("one-file"), Layout {
        wrote: &[
            r#"files = "decimals.csv""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "rate = 200",
            "scale = 128",
            "rectified = false",
        ],
        mended: &[],
        found: (1, 1, "unlabelled 10"),
    };
    volts_are_scaled: case("volts"), Layout {
        wrote: &[
            r#"files = "anna/anna_{trial}.csv""#,
            r#"separator = ",""#,
            "header = true",
            r#"channels = ["emg_0", "emg_1", "emg_2", "emg_3", "emg_4", "emg_5", "emg_6", "emg_7"]"#,
            r#"label = "gt""#,
            "rate = 200",
            "scale = 100000",
            "rectified = false",
            "labels = { relax = [0], open = [1], close = [2] }",
            r#"timing = "cues""#,
        ],
        mended: &[],
        found: (1, 2, "close 38, open 32, relax 50"),
    };
    libemgs_numbers_are_classes: case("libemg-own"), Layout {
        wrote: &[
            r#"files = "{person}/R_{trial}_C_{gesture}.csv""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 1, 2] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            "labels = { close = [0], open = [1], relax = [2] }",
        ],
        found: (2, 24, "close 10, open 15, relax 25"),
    };
    persons_are_folders_with_an_underscore: case("persons/underscore"), Layout {
        wrote: &[
            r#"files = "{person}/subject_{trial}_a.csv""#,
            r#"separator = ",""#,
            "header = true",
            r#"channels = ["emg_0", "emg_1", "emg_2", "emg_3", "emg_4", "emg_5", "emg_6", "emg_7"]"#,
            r#"label = "gt""#,
            "rate = 200",
            "rectified = false",
            "labels = { relax = [0], open = [1], close = [2] }",
            r#"timing = "cues""#,
        ],
        mended: &[],
        found: (2, 2, "close 33, open 39, relax 48"),
    };
    a_left_hand_is_mirrored: case("left-hand"), Layout {
        wrote: &[
            r#"files = "_readings_left_hand/12345-1/7.txt""#,
            r#"separator = ",""#,
            "header = false",
            "channels = [1, 2, 3, 4, 5, 6, 7, 8]",
            "label = 9",
            "rate = 200",
            "rectified = false",
            "labels = { unknown = [0, 7] }",
            r#"timing = "cues""#,
        ],
        mended: &[
            r#"arm = "left""#,
            "labels = { relax = [0], close = [7] }",
        ],
        found: (1, 1, "close 3, relax 17"),
    };
}
