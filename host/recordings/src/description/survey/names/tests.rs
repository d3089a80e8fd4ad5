use super::*;

#[test]
fn paths_show_their_pattern() {
    for (paths, has_labels, expected) in [
        (
            &[
                "p01/testing_doubletap_05.npy",
                "p01/training_open_01.npy",
                "p02/testing_open_05.npy",
                "p02/training_close_02.npy",
            ][..],
            false,
            "{person}/{session}_{gesture}_{trial}.npy",
        ),
        (
            &[
                "m1/train_R0_relax.npy",
                "m1/test_trial_0_R1_close.npy",
                "m2/train_R0_close.npy",
                "m2/test_trial_1_R0_open.npy",
            ],
            false,
            "{person}/{session}_R{trial}_{gesture}.npy",
        ),
        (
            &[
                "data/sub1/M5T2.csv",
                "data/sub2/M1T1.csv",
                "data/sub2/M5T1.csv",
                "data/sub1/M1T2.csv",
            ],
            false,
            "data/{person}/M{gesture}T{trial}.csv",
        ),
        (
            &[
                "d/subject01_session01_emg.npy",
                "d/subject02_session01_emg.npy",
                "d/subject02_session02_emg.npy",
            ],
            true,
            "d/{person}_{session}_emg.npy",
        ),
        (
            &[
                "EMG_S1/1_fist.npy",
                "EMG_S1/10_thumb_up.npy",
                "EMG_S2/1_fist.npy",
                "EMG_S2/10_thumb_up.npy",
            ],
            false,
            "{person}/{trial}_{gesture}.npy",
        ),
        (
            &[
                "trial_1/R_0_C_2.csv",
                "trial_1/R_1_C_0.csv",
                "trial_2/R_0_C_2.csv",
                "trial_2/R_0_C_0.csv",
            ],
            false,
            "{session}/R_{trial}_C_{gesture}.csv",
        ),
        (
            &["C_0_R_0_emg.csv", "C_1_R_0_emg.csv", "C_0_R_1_emg.csv"],
            false,
            "C_{gesture}_R_{trial}_emg.csv",
        ),
        (
            &[
                "d/s6_r_5/s6_r_5-paper-2-emg.csv",
                "d/s1_l_1/s1_l_1-rock-2-emg.csv",
                "d/s1_l_1/s1_l_1-paper-1-emg.csv",
                "d/s6_r_5/s6_r_5-paper-3-emg.csv",
            ],
            false,
            "d/{any}/{person}_{any}_{trial}-{gesture}-{any}-emg.csv",
        ),
        (
            &[
                "a/wave_in_3.csv",
                "a/open_3.csv",
                "b/wave_in_4.csv",
                "b/open_3.csv",
            ],
            false,
            "{person}/{gesture}_{trial}.csv",
        ),
        (&["anna.csv", "bob.csv"], true, "{any}.csv"),
        (&["raw.csv"], false, "raw.csv"),
        (
            &["emg-1444331136.csv", "channels_time.csv"],
            false,
            "{any}.csv",
        ),
        (
            &[
                "p1/s1_emg.npy",
                "p2/s1_emg.npy",
                "p2/s2_emg.npy",
                "p3/s1_emg.npy",
            ],
            false,
            "{person}/s{trial}_emg.npy",
        ),
        (
            &["s_1/s_1_a.csv", "s_2/s_2_a.csv"],
            true,
            "{person}/s_{trial}_a.csv",
        ),
        (
            &[
                "p1/w08_01.npy",
                "p1/w08_02.npy",
                "p2/w09_01.npy",
                "p2/w09_02.npy",
            ],
            false,
            "{person}/{gesture}_{trial}.npy",
        ),
    ] {
        let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
        let found = pattern(&paths, has_labels).unwrap();
        assert_eq!(found.to_string(), expected);
        for path in &paths {
            assert!(
                found.fields_of(path, |_| true).is_some(),
                "{expected}: {}",
                path.display()
            );
        }
    }
    assert_eq!(pattern(&[], false), None);
}

proptest::proptest! {
    /// Whatever the paths are, the guess is a pattern that is written as it is read, or none.
    #[test]
    fn any_paths_give_a_pattern_or_none(paths in proptest::collection::vec("[a-c1-2_./{-]{1,12}", 0..6)) {
        let paths: Vec<PathBuf> = paths.iter().map(|path| PathBuf::from(format!("x/{path}.csv"))).collect();
        if let Some(found) = pattern(&paths, false) {
            let read = Pattern::try_from(found.to_string());
            proptest::prop_assert_eq!(read, Ok(found));
        }
    }
}
