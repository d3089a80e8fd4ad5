use super::*;

/// People of these paths below `/d`, and the sentences on the choices.
fn who(paths: &[&str]) -> (Vec<String>, Vec<String>) {
    let mut recordings: Vec<Recording> = paths
        .iter()
        .map(|path| Recording {
            path: Path::new("/d").join(path),
            ..Recording::new(DataSet::OWN, "", vec![[1; 8]], vec![None])
        })
        .collect();
    let told = by_folder(Path::new("/d"), &mut recordings, &|_| false);
    let named = recordings.iter().map(Recording::full_name);
    (named.collect(), told)
}

#[test]
fn copies_and_groups_are_different_people_and_told() {
    let (named, told) = who(&["backup/anna/1.csv", "backup/zbackup/anna/1.csv"]);
    assert_eq!(named, ["own/anna/1", "own/zbackup/anna/1"]);
    assert_eq!(told[0], "people: 2, by folder: anna, zbackup/anna");
    assert!(told[1].contains("one name: anna, zbackup/anna"), "{told:?}");
    let (_, told) = who(&["lab/anna/1.csv", "lab/bob/1.csv", "home/eva/1.csv"]);
    assert!(
        told[1].contains("lab holds no recording itself: lab/anna, lab/bob"),
        "{told:?}"
    );
}

#[test]
fn sessions_belong_to_the_folder_above_wherever_they_stand() {
    let (named, told) = who(&["anna/1/a.csv", "anna/2/a.csv", "bob/monday/trial_1/a.csv"]);
    assert_eq!(
        named,
        ["own/anna/1/a", "own/anna/2/a", "own/bob/monday/trial_1/a"]
    );
    assert_eq!(
        told[1],
        "folders taken as sessions, not as people: 1, 2, monday, trial_1"
    );
    let (named, _) = who(&[
        "monday/anna/a.csv",
        "tuesday/anna/a.csv",
        "tuesday/bob/a.csv",
    ]);
    let expected = [
        "own/anna/monday/a",
        "own/anna/tuesday/a",
        "own/bob/tuesday/a",
    ];
    assert_eq!(named, expected);
    // Numbers below the requested folder are people, as in published sets.
    assert_eq!(who(&["01/a.csv", "02/a.csv"]).0, ["own/01/a", "own/02/a"]);
    // People of test and training are numbered apart in published sets.
    assert_eq!(
        who(&["train/p1/a.csv", "test/p1/a.csv"]).0,
        ["own/train/p1/a", "own/test/p1/a"]
    );
}

#[test]
fn what_lies_below_a_persons_recordings_is_theirs() {
    let (named, _) = who(&["anna/1.csv", "anna/kitchen/1.csv", "bob/1.csv"]);
    assert_eq!(named, ["own/anna/1", "own/anna/kitchen/1", "own/bob/1"]);
}

#[test]
fn a_folder_whose_sessions_are_named_after_it_is_a_person_whatever_its_name() {
    let [test, anna] =
        ["test", "anna"].map(|name| format!("{name}/{name}_20261128T084900Z_quick_1.csv"));
    let (named, _) = who(&[&test, &anna]);
    assert_eq!(
        named,
        [&test, &anna].map(|path| format!("own/{}", path.trim_end_matches(".csv")))
    );
    // The folder of one person alone.
    let mut recordings = [Recording {
        path: Path::new("/d").join(&test),
        ..Recording::new(DataSet::OWN, "", vec![[1; 8]], vec![None])
    }];
    by_folder(Path::new("/d/test"), &mut recordings, &|_| false);
    assert_eq!(recordings[0].subject, "own/test");
}

#[test]
fn loose_files_are_of_the_folders_name_which_is_nobody_elses() {
    assert_eq!(who(&["1.csv", "anna/1.csv"]).0, ["own/d/1", "own/anna/1"]);
    assert_eq!(who(&["1.csv", "d/1.csv"]).0, ["own/d/./1", "own/d/1"]);
    assert_eq!(
        who(&["s1_a.csv", "s2_a.csv"]).0,
        ["own/s1/s1_a", "own/s2/s2_a"]
    );
    assert_eq!(
        who(&["s1_a.csv", "notes_a.csv"]).0,
        ["own/d/s1_a", "own/d/notes_a"]
    );
    let (named, _) = who(&["monday/1.csv", "tuesday/1.csv"]);
    assert_eq!(named, ["own/d/monday/1", "own/d/tuesday/1"]);
    let (named, _) = who(&["anna/monday/1.csv", "anna/tuesday/1.csv"]);
    assert_eq!(named, ["own/anna/monday/1", "own/anna/tuesday/1"]);
}

#[test]
fn the_same_name_in_two_spellings_is_told() {
    let (_, told) = who(&["Anna/1.csv", "anna/1.csv"]);
    assert!(told[1].contains("Anna, anna"), "{told:?}");
}

#[test]
fn published_people_keep_their_names() {
    let mut recordings = vec![Recording::new(
        DataSet::named("roshambo"),
        "roshambo/01",
        vec![[1; 8]],
        vec![None],
    )];
    assert!(by_folder(Path::new("/d"), &mut recordings, &|_| false).is_empty());
    assert_eq!(recordings[0].subject, "roshambo/01");
}
