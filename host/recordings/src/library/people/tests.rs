use super::*;

/// A recording at a path below `/d`.
fn at(path: &str) -> Recording {
    Recording {
        path: Path::new("/d").join(path),
        ..Recording::new(DataSet::OWN, "", vec![[1; 8]], vec![None])
    }
}

/// People of these paths below `/d`, and the sentences on the choices.
fn who(paths: &[&str]) -> (Vec<String>, Vec<String>) {
    let mut recordings: Vec<Recording> = paths.iter().map(|path| at(path)).collect();
    let told = by_folder(Path::new("/d"), &mut recordings, &|_| false);
    let named = recordings.iter().map(Recording::full_name);
    (named.collect(), told)
}

/// Asserts that the recordings of these paths have these names, but for the set's.
fn named(paths: &str, expected: &str) {
    let (found, _) = who(&paths.split(' ').collect::<Vec<_>>());
    assert_eq!(found.join(" ").replace("own/", ""), expected, "{paths}");
}

#[test]
fn copies_and_groups_are_different_people_and_told() {
    let (named, told) = who(&["backup/anna/1.csv", "backup/zbackup/anna/1.csv"]);
    assert_eq!(named, ["own/anna/1", "own/zbackup/anna/1"]);
    assert_eq!(told[0], "people: 2, by folder: anna, zbackup/anna");
    assert!(told[1].contains("one name: anna, zbackup/anna"), "{told:?}");
    let (_, told) = who(&["lab/anna/1.csv", "lab/bob/1.csv", "home/eva/1.csv"]);
    let words = "lab holds no recording itself: lab/anna, lab/bob";
    assert!(told[1].contains(words), "{told:?}");
    let (_, told) = who(&["Anna/1.csv", "anna/1.csv"]);
    assert!(told[1].contains("Anna, anna"), "{told:?}");
}

#[test]
fn sessions_belong_to_the_folder_above_wherever_they_stand() {
    let (named_so, told) = who(&["anna/1/a.csv", "anna/2/a.csv", "bob/monday/trial_1/a.csv"]);
    let expected = ["own/anna/1/a", "own/anna/2/a", "own/bob/monday/trial_1/a"];
    assert_eq!(named_so, expected);
    let words = "folders taken as sessions, not as people: 1, 2, monday, trial_1";
    assert_eq!(told[1], words);
    named(
        "monday/anna/a.csv tuesday/anna/a.csv tuesday/bob/a.csv",
        "anna/monday/a anna/tuesday/a bob/tuesday/a",
    );
    // Numbers below the requested folder are people, as in published sets.
    named("01/a.csv 02/a.csv", "01/a 02/a");
    // People of test and training are numbered apart in published sets.
    named("train/p1/a.csv test/p1/a.csv", "train/p1/a test/p1/a");
}

#[test]
fn a_folder_whose_sessions_are_named_after_it_is_a_person_whatever_its_name() {
    let [test, anna] = ["test", "anna"].map(|own| format!("{own}/{own}_20261128T084900Z_quick_1"));
    named(&format!("{test}.csv {anna}.csv"), &format!("{test} {anna}"));
    // The folder of one person alone.
    let mut recordings = [at(&test)];
    by_folder(Path::new("/d/test"), &mut recordings, &|_| false);
    assert_eq!(recordings[0].subject, "own/test");
}

#[test]
fn loose_files_are_of_the_folders_name_which_is_nobody_elses() {
    named("1.csv anna/1.csv", "d/1 anna/1");
    named("1.csv d/1.csv", "d/./1 d/1");
    named("s1_a.csv s2_a.csv", "s1/s1_a s2/s2_a");
    named("s1_a.csv notes_a.csv", "d/s1_a d/notes_a");
    named("monday/1.csv tuesday/1.csv", "d/monday/1 d/tuesday/1");
    named(
        "anna/monday/1.csv anna/tuesday/1.csv",
        "anna/monday/1 anna/tuesday/1",
    );
    // What lies below a person's recordings is theirs.
    named(
        "anna/1.csv anna/home/1.csv bob/1.csv",
        "anna/1 anna/home/1 bob/1",
    );
}
