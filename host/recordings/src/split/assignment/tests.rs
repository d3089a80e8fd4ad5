use super::*;
use crate::split::Role;

/// People `names` of a data set, two recordings each.
fn people(data_set: DataSet, names: &[&str]) -> Vec<Recording> {
    let recording = |name: &&str| {
        let subject = format!("{}/{name}", data_set.name());
        Recording::new(data_set, subject, Vec::new(), Vec::new())
    };
    let two = |name| [recording(name), recording(name)];
    names.iter().flat_map(two).collect()
}

const ROSHAMBO: [&str; 8] = ["01", "02", "03", "04", "05", "06", "07", "08"];
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
    let all = people(DataSet::named("roshambo"), &ROSHAMBO);
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
    let own = people(DataSet::OWN, &OWN);
    let with = |seed| assign(&own, &shares(seed)).unwrap();
    let split = with(1);
    assert_eq!(
        [&split.held_out, &split.validation, &split.training].map(Vec::len),
        [2, 1, 3]
    );
    let draws: BTreeSet<_> = (0..20).map(|seed| with(seed).held_out).collect();
    assert!(draws.len() > 5);
    let both = [own.clone(), people(DataSet::SYNTHETIC, &OWN)].concat();
    let both = assign(&both, &shares(1)).unwrap();
    assert!(
        split
            .held_out
            .iter()
            .all(|name| both.held_out.contains(name))
    );
}

#[test]
fn lists_come_before_the_predefined_split_and_draws() {
    let all = people(DataSet::named("roshambo"), &ROSHAMBO);
    let [held_out, validation] = ["roshambo/01", "roshambo/03"].map(|name| vec![name.to_owned()]);
    let listed = Assignment {
        held_out: &held_out,
        validation: &validation,
        ..shares(1)
    };
    let split = assign(&all, &listed).unwrap();
    assert_eq!(split.held_out, held_out);
    assert_eq!(split.validation, validation);
    // A test person trains nobody's model, listed or not.
    assert_eq!(split.test, ["roshambo/06"]);
    let twice = Assignment {
        validation: &held_out,
        ..listed.clone()
    };
    let both = SplitError::TwoRoles("roshambo/01".into());
    assert_eq!(assign(&all, &twice), Err(both));
}

#[test]
fn a_test_person_is_evaluated_where_listed_and_never_validates() {
    let all = people(DataSet::named("roshambo"), &ROSHAMBO);
    let test = ["roshambo/06".to_owned()];
    let release = Assignment {
        held_out: &test,
        ..shares(1)
    };
    let split = assign(&all, &release).unwrap();
    assert_eq!((split.held_out.len(), split.test.len()), (1, 0));
    let validating = Assignment {
        validation: &test,
        ..shares(1)
    };
    let refused = SplitError::TestPerson("roshambo/06".into());
    assert_eq!(assign(&all, &validating), Err(refused));
}

#[test]
fn a_fold_replaces_the_predefined_development_people_but_not_the_test_people() {
    let all = people(DataSet::named("roshambo"), &ROSHAMBO);
    let fold = ["roshambo/01".to_owned(), "roshambo/08".to_owned()];
    let split = assign(
        &all,
        &Assignment {
            held_out: &fold,
            held_out_share: 0.0,
            predefined: false,
            ..shares(1)
        },
    )
    .unwrap();
    assert_eq!(split.held_out, fold);
    assert_eq!((split.test.len(), split.validation.len()), (1, 2));
}

#[test]
fn nobody_to_train_on_is_refused() {
    let own = people(DataSet::OWN, &OWN);
    let everybody = ["own".to_owned()];
    let all_out = Assignment {
        held_out: &everybody,
        ..shares(1)
    };
    assert_eq!(assign(&own, &all_out), Err(SplitError::NothingToTrainOn));
}

#[test]
fn every_subject_has_exactly_one_role() {
    let all = [
        people(DataSet::named("roshambo"), &ROSHAMBO),
        people(DataSet::OWN, &OWN),
        people(DataSet::SYNTHETIC, &["1", "2"]),
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

#[test]
fn a_data_set_named_as_a_whole_does_not_name_its_test_people() {
    let all = [
        people(DataSet::named("roshambo"), &ROSHAMBO),
        people(DataSet::OWN, &OWN),
    ]
    .concat();
    let set = ["roshambo".to_owned()];
    let whole = Assignment {
        held_out: &set,
        ..shares(1)
    };
    let split = assign(&all, &whole).unwrap();
    assert_eq!(split.test, ["roshambo/06"]);
    let own = split
        .held_out
        .iter()
        .filter(|name| name.starts_with("roshambo"));
    assert_eq!(own.count(), 7);
}
