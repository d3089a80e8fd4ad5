use super::*;
use crate::fixture::people;
use crate::split::Role;

fn roshambo() -> Vec<Recording> {
    let names = ["01", "02", "03", "04", "05", "06", "07", "08"];
    people(DataSet::named("roshambo"), names)
}

const OWN: [&str; 6] = ["a", "b", "c", "d", "e", "f"];

fn shares(seed: u64) -> Assignment<'static> {
    Assignment {
        seed,
        held_out_share: 0.3,
        validation_share: 0.2,
        predefined: true,
        ..Assignment::default()
    }
}

#[test]
fn the_predefined_split_decides_for_the_sets_that_it_names() {
    let all = roshambo();
    let split = assign(&all, &shares(1)).unwrap();
    assert_eq!(split.test, ["roshambo/06"]);
    assert_eq!(split.held_out, ["roshambo/03"]);
    assert_eq!(split.validation, ["roshambo/08"]);
    assert_eq!(split.training.len(), 5);
    assert_eq!(split.select(&all, Role::Training).len(), 10);
    assert_eq!(split, assign(&all, &shares(2)).unwrap());
}

#[test]
fn other_sets_draw_by_the_seed_and_do_not_depend_on_one_another() {
    let own = people(DataSet::OWN, OWN);
    let with = |seed| assign(&own, &shares(seed)).unwrap();
    let split = with(1);
    let roles = [&split.held_out, &split.validation, &split.training];
    assert_eq!(roles.map(Vec::len), [2, 1, 3]);
    let draws: BTreeSet<_> = (0..20).map(|seed| with(seed).held_out).collect();
    assert!(draws.len() > 5);
    let both = [own.clone(), people(DataSet::SYNTHETIC, OWN)].concat();
    let both = assign(&both, &shares(1)).unwrap();
    let mut held_out = split.held_out.iter();
    assert!(held_out.all(|name| both.held_out.contains(name)));
}

/// Roles where lists hold out and validate with these subjects and sets.
fn listed(all: &[Recording], held_out: &[&str], validation: &[&str]) -> Result<Split, SplitError> {
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let [held_out, validation]: [Vec<String>; 2] = [owned(held_out), owned(validation)];
    let assignment = Assignment {
        held_out: &held_out,
        validation: &validation,
        ..shares(1)
    };
    assign(all, &assignment)
}

#[test]
fn lists_come_before_the_predefined_split_and_draws() {
    let all = roshambo();
    let split = listed(&all, &["roshambo/01"], &["roshambo/03"]).unwrap();
    assert_eq!(split.held_out, ["roshambo/01"]);
    assert_eq!(split.validation, ["roshambo/03"]);
    // A test person trains nobody's model, listed or not.
    assert_eq!(split.test, ["roshambo/06"]);
    let twice = listed(&all, &["roshambo/01"], &["roshambo/01"]);
    assert_eq!(twice, Err(SplitError::TwoRoles("roshambo/01".into())));
}

#[test]
fn a_test_person_is_evaluated_where_listed_by_name_and_never_validates() {
    let all = [roshambo(), people(DataSet::OWN, OWN)].concat();
    let is_of_set = |name: &&String| name.starts_with("roshambo");
    for (held_out, test, own) in [("roshambo/06", 0, 1), ("roshambo", 1, 7)] {
        let split = listed(&all, &[held_out], &[]).unwrap();
        let count = split.held_out.iter().filter(is_of_set).count();
        assert_eq!((split.test.len(), count), (test, own), "{held_out}");
    }
    let validating = listed(&all, &[], &["roshambo/06"]);
    let refused = SplitError::TestPerson("roshambo/06".into());
    assert_eq!(validating, Err(refused));
}

#[test]
fn a_fold_replaces_the_predefined_development_people_but_not_the_test_people() {
    let all = roshambo();
    let fold = ["roshambo/01".to_owned(), "roshambo/08".to_owned()];
    let folded = Assignment {
        held_out: &fold,
        held_out_share: 0.0,
        predefined: false,
        ..shares(1)
    };
    let split = assign(&all, &folded).unwrap();
    assert_eq!(split.held_out, fold);
    assert_eq!((split.test.len(), split.validation.len()), (1, 2));
}

#[test]
fn nobody_to_train_on_is_refused() {
    let own = people(DataSet::OWN, OWN);
    let all_out = listed(&own, &["own"], &[]);
    assert_eq!(all_out, Err(SplitError::NothingToTrainOn));
}

#[test]
fn every_subject_has_exactly_one_role() {
    let all = [
        roshambo(),
        people(DataSet::OWN, OWN),
        people(DataSet::SYNTHETIC, ["1", "2"]),
    ]
    .concat();
    for seed in 0..10 {
        let split = assign(&all, &shares(seed)).unwrap();
        let mut roles = [split.training, split.validation, split.held_out, split.test].concat();
        roles.sort_unstable();
        let mut known: Vec<_> = all.iter().map(|r| r.subject.clone()).collect();
        known.sort_unstable();
        known.dedup();
        assert_eq!(roles, known);
    }
}
