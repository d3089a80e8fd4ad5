//! Every refusal, on folders that are right but for one thing.

use super::*;
use crate::comparison::results::StudyResults;
use crate::comparison::results::fixture::Fixture;

fn refusal(fixture: &Fixture) -> ResultsError {
    StudyResults::load(fixture.path()).unwrap_err()
}

#[test]
fn a_fold_without_results_is_refused_with_the_command_that_evaluates_it() {
    let fixture = Fixture::new();
    fixture.fold("main", 1, 2).held_out("roshambo/01").write();
    let second = fixture.fold("main", 2, 2).held_out("roshambo/02").write();
    std::fs::remove_file(second.join("results.json")).unwrap();
    let error = refusal(&fixture);
    assert!(matches!(&error, ResultsError::NotEvaluated { run } if *run == second));
    let command = format!("myointent-research evaluate --run {}", second.display());
    assert!(error.to_string().contains(&command), "{error}");
}

#[test]
fn folds_of_other_settings_are_refused_with_the_keys() {
    let fixture = Fixture::new();
    fixture.fold("main", 1, 2).held_out("roshambo/01").write();
    let second = fixture.fold("main", 2, 2).held_out("roshambo/02");
    second
        .config(|config| {
            config.preset.seed += 1;
            config.preset.teacher_training.epochs += 1;
            config.preset.data.held_out = vec!["roshambo/02".to_owned()];
            config.preset.data.validation = vec!["roshambo/01".to_owned()];
        })
        .write();
    let ResultsError::RunsDiffer { keys, .. } = refusal(&fixture) else {
        panic!("expected a refusal for different settings");
    };
    let names: Vec<_> = keys
        .iter()
        .filter_map(|key| key.split(':').next())
        .collect();
    assert_eq!(names, ["seed", "teacher_training.epochs"]);
}

#[test]
fn a_subject_held_out_twice_is_refused() {
    let fixture = Fixture::new();
    for number in [1, 2] {
        let fold = fixture.fold("main", number, 2);
        fold.held_out("roshambo/01").write();
    }
    assert!(matches!(
        refusal(&fixture),
        ResultsError::HeldOutTwice { subject, .. } if subject == "roshambo/01"
    ));
}

#[test]
fn the_same_fold_in_two_folders_is_refused() {
    let fixture = Fixture::new();
    let first = fixture.fold("main", 1, 2).held_out("roshambo/01").write();
    let copy = fixture.path().join("main/fold-1-again");
    std::fs::rename(first, copy).unwrap();
    fixture.fold("main", 1, 2).held_out("roshambo/02").write();
    assert!(matches!(
        refusal(&fixture),
        ResultsError::DuplicateFold { number: 1, .. }
    ));
}

#[test]
fn a_fold_beyond_its_protocol_is_refused() {
    let fixture = Fixture::new();
    fixture.fold("main", 3, 2).held_out("roshambo/01").write();
    assert!(matches!(
        refusal(&fixture),
        ResultsError::NoSuchFold {
            number: 3,
            of: 2,
            ..
        }
    ));
}

#[test]
fn a_held_out_subject_with_another_role_is_refused() {
    for role in ["training", "validation"] {
        let fixture = Fixture::new();
        let fold = fixture.fold("main", 1, 1).held_out("roshambo/01");
        fold.config(move |config| {
            let split = &mut config.split;
            match role {
                "training" => split.training.push("roshambo/01".to_owned()),
                _ => split.validation.push("roshambo/01".to_owned()),
            }
        })
        .write();
        assert!(matches!(
            refusal(&fixture),
            ResultsError::TwoRoles { subject, .. } if subject == "roshambo/01"
        ));
    }
}

#[test]
fn results_of_an_older_configuration_are_refused() {
    let fixture = Fixture::new();
    let fold = fixture.fold("main", 1, 1).held_out("roshambo/01");
    fold.config(|config| config.split.held_out = vec!["roshambo/02".to_owned()])
        .write();
    assert!(matches!(refusal(&fixture), ResultsError::Stale { .. }));
    let fixture = Fixture::new();
    let fold = fixture.fold("main", 1, 1).held_out("roshambo/01");
    fold.results(|results| {
        results.published[0].events.subjects[0].subject = "roshambo/07".to_owned();
    })
    .write();
    assert!(matches!(
        refusal(&fixture),
        ResultsError::Stale { subject, .. } if subject == "roshambo/07"
    ));
}

#[test]
fn a_folder_without_runs_is_refused_with_the_expected_layout() {
    let fixture = Fixture::new();
    std::fs::create_dir_all(fixture.path().join("tables")).unwrap();
    let error = refusal(&fixture).to_string();
    assert!(error.contains("VARIANT/fold-K"), "{error}");
}
