//! `myointent score` of a folder of label files, one for each recording.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use evaluation::SmoothedLabels;
use evaluation::label_files::evaluate_labels;
use evaluation::metric::transition::Rule;
use evaluation::model_evaluation::is_taken;
use evaluation::report::model_report::label_tables;
use evaluation::report::{labels as facts, text};
use execution::progress;
use recordings::Recording;
use recordings::readers::path::existing;

use super::{Arguments, Purpose, emission, label_file, labels};
use crate::cli::arguments::recordings_of;
use crate::cli::output::file_of;

pub(super) fn report(args: &Arguments) -> anyhow::Result<String> {
    if args.rule() != Rule::default() {
        bail!(
            "a folder is scored by the usual rule: leave out --buffer, --strict and --allow-relax"
        );
    }
    let folder = &args.prediction;
    let library = recordings_of(&args.truth, false, args.as_recorded)?;
    let mut found = BTreeMap::new();
    for recording in &library.recordings {
        if let Some(labels) = labels_of(recording, folder, args.delay)? {
            found.insert(recording.full_name(), labels);
        }
    }
    let name = folder.file_name().unwrap_or(folder.as_os_str());
    let mut name = name.to_string_lossy().into_owned();
    if is_taken(&name) {
        name += "/";
    }
    let results = evaluate_labels(&name, found, &library, args.label_lag)
        .with_context(|| folder.display().to_string())?;
    if args.json {
        return Ok(serde_json::to_string_pretty(&results)? + "\n");
    }
    if let Some(first) = results.missing.first() {
        progress::log(&format!(
            "labelled recordings without a file of labels: {}, such as {first}",
            results.missing.len()
        ));
    }
    let facts = facts(&results.lags, &results.gestures);
    Ok(text(&label_tables(&results.scores), &facts))
}

/// Labels of a recording in a folder, or none.
fn labels_of(
    recording: &Recording,
    folder: &Path,
    delay: Option<usize>,
) -> anyhow::Result<Option<SmoothedLabels>> {
    let files = ["csv", "npy", "txt"].map(|ending| file_of(recording, folder, ending));
    let files = files.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mut files = files.into_iter().filter_map(existing);
    let Some(path) = files.next() else {
        return Ok(None);
    };
    if let Some(other) = files.next() {
        bail!(
            "{} and {} are both labels of {}: remove one",
            path.display(),
            other.display(),
            recording.full_name()
        );
    }
    let reference = labels(label_file::read(&path, Purpose::Prediction)?);
    ensure!(
        reference.len() == recording.samples.len(),
        "{}: expected as many labels as {} has samples ({}), found {}",
        path.display(),
        recording.full_name(),
        recording.samples.len(),
        reference.len()
    );
    let emitted = emission(&path, delay)?.labels(&reference);
    Ok(Some(SmoothedLabels { reference, emitted }))
}

#[cfg(test)]
mod tests {
    use std::process::ExitCode;

    use evaluation::model_evaluation::{NamedModel, Selection, evaluate_models};
    use recordings::labels::lag::LabelLag;
    use recordings::synthetic::{self, SynthOptions};
    use recordings::{LoadOptions, load};
    use shared::model::file::random::{SMALL, random_model};

    use super::*;

    /// Runs the program with the words of a line; returns true if it succeeds.
    fn myointent(line: &str) -> bool {
        crate::cli::run(line) == ExitCode::SUCCESS
    }

    fn write_model(file: &str) {
        std::fs::write(file, random_model(SMALL, 5).to_bytes().unwrap()).unwrap();
    }

    #[test]
    fn labels_of_a_folder_are_scored_as_the_model_that_gave_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let (data, file, labels) = (path("data"), path("one.intent"), path("labels"));
        let options = SynthOptions {
            subjects: 4,
            recordings: 2,
            seconds: 30,
            ..SynthOptions::default()
        };
        synthetic::write(&options, Path::new(&data)).unwrap();
        write_model(&file);
        let predict = format!("predict --model {file} --recording {data} --out {labels}");
        assert!(myointent(&predict));
        let score = format!("score --truth {data} --prediction {labels}");
        assert!(myointent(&score));

        let library = load(Path::new(&data), &LoadOptions::default()).unwrap();
        let mut found: BTreeMap<_, _> = library
            .recordings
            .iter()
            .map(|own| {
                let labels = labels_of(own, Path::new(&labels), None).unwrap().unwrap();
                (own.full_name(), labels)
            })
            .collect();
        let lag = LabelLag::default();
        let results = evaluate_labels("one", found.clone(), &library, lag).unwrap();
        let model = NamedModel::read(Path::new(&file)).unwrap();
        let expected = evaluate_models(&[model], &library, &Selection::default()).unwrap();
        let expected = expected.results;
        assert_eq!(
            (&results.lags, &results.gestures),
            (&expected.lags, &expected.gestures)
        );
        assert_eq!(results.scores.len(), expected.scores.len());
        for (own, expected) in results.scores.iter().zip(&expected.scores) {
            assert_eq!(own.reference[0].subjects.len(), 4);
            assert_eq!(own.reference, expected.reference);
            assert_eq!(
                (&own.emission, &own.events),
                (&expected.emission, &expected.events)
            );
        }

        let (first, _) = found.pop_first().unwrap();
        let results = evaluate_labels("one", found, &library, lag).unwrap();
        assert_eq!(results.missing.join(" "), first);
        let none = evaluate_labels("one", BTreeMap::new(), &library, lag).unwrap_err();
        assert!(
            none.to_string().contains(&format!("such as {first}.csv")),
            "{none}"
        );
        assert!(myointent(&format!("{score} --json")));
        assert!(
            !myointent(&format!("{score} --strict")),
            "another rule is refused"
        );
        let beside = format!("{labels}/{first}.txt");
        std::fs::copy(format!("{labels}/{first}.csv"), &beside).unwrap();
        assert!(!myointent(&score), "two files of labels for one recording");
        std::fs::remove_file(beside).unwrap();
        std::fs::write(format!("{labels}/{first}.csv"), "label\n0\n0\n").unwrap();
        assert!(
            !myointent(&score),
            "two labels for 6000 samples are refused"
        );
    }
}
