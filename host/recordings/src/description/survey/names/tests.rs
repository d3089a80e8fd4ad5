use super::*;

/// The pattern of each row's paths, with labels elsewhere or not.
const PATHS: &str = "\
{person}/{session}_{gesture}_{trial}.npy: p01/testing_doubletap_05.npy p01/training_open_01.npy p02/testing_open_05.npy p02/training_close_02.npy
{person}/{session}_R{trial}_{gesture}.npy: m1/train_R0_relax.npy m1/test_trial_0_R1_close.npy m2/train_R0_close.npy m2/test_trial_1_R0_open.npy
data/{person}/M{gesture}T{trial}.csv: data/sub1/M5T2.csv data/sub2/M1T1.csv data/sub2/M5T1.csv data/sub1/M1T2.csv
d/{person}_{session}_emg.npy + labels: d/subject01_session01_emg.npy d/subject02_session01_emg.npy d/subject02_session02_emg.npy
{person}/{trial}_{gesture}.npy: EMG_S1/1_fist.npy EMG_S1/10_thumb_up.npy EMG_S2/1_fist.npy EMG_S2/10_thumb_up.npy
{session}/R_{trial}_C_{gesture}.csv: trial_1/R_0_C_2.csv trial_1/R_1_C_0.csv trial_2/R_0_C_2.csv trial_2/R_0_C_0.csv
C_{gesture}_R_{trial}_emg.csv: C_0_R_0_emg.csv C_1_R_0_emg.csv C_0_R_1_emg.csv
d/{any}/{person}_{any}_{trial}-{gesture}-{any}-emg.csv: d/s6_r_5/s6_r_5-paper-2-emg.csv d/s1_l_1/s1_l_1-rock-2-emg.csv d/s1_l_1/s1_l_1-paper-1-emg.csv d/s6_r_5/s6_r_5-paper-3-emg.csv
{person}/{gesture}_{trial}.csv: a/wave_in_3.csv a/open_3.csv b/wave_in_4.csv b/open_3.csv
{any}.csv + labels: anna.csv bob.csv
raw.csv: raw.csv
{any}.csv: emg-1444331136.csv channels_time.csv
{person}/s{trial}_emg.npy: p1/s1_emg.npy p2/s1_emg.npy p2/s2_emg.npy p3/s1_emg.npy
{person}/s_{trial}_a.csv + labels: s_1/s_1_a.csv s_2/s_2_a.csv
{person}/{gesture}_{trial}.npy: p1/w08_01.npy p1/w08_02.npy p2/w09_01.npy p2/w09_02.npy";

#[test]
fn paths_show_their_pattern() {
    for case in PATHS.lines() {
        let (expected, paths) = case.split_once(": ").unwrap();
        let labelled = expected.strip_suffix(" + labels");
        let (expected, has_labels) = (labelled.unwrap_or(expected), labelled.is_some());
        let paths: Vec<PathBuf> = paths.split(' ').map(PathBuf::from).collect();
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
