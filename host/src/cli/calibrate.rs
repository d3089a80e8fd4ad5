//! `myointent calibrate`: a model file whose last layer is learnt from one person's holds.

use std::io::Write as _;

use clap::Args;

use crate::cli::Kept;
use crate::cli::arguments::OwnModel;
use evaluation::calibration::calibrate_file;
use execution::run_folder::write_whole;

#[derive(Debug, Args)]
#[command(
    after_help = "A round is a hold of each gesture and two of rest; two rounds are enough, half a minute. The first half of the rounds teaches,\n\
    the others judge the new head beside the model's own. It is used, learnt from all rounds, unless it loses more than 0.05 mean\n\
    recall: then nothing is written and the exit code is 3. The first opening shows how the armband sits; the new file is for an\n\
    armband that sits so.\n\
    docs/calibration.md says what it gains.\n\n\
    Example:\n  myointent calibrate --model models/three-class.intent --data MINE --out mine.intent"
)]
pub struct Arguments {
    #[command(flatten)]
    own: OwnModel,
    /// Show six seconds of labelled other movement too: it raises fewer labels then, and so do gestures.
    #[arg(long)]
    show_others: bool,
}

/// Calibrates the model, and writes it unless it is worse.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let OwnModel {
        model,
        out,
        subject,
        ..
    } = &arguments.own;
    let (bytes, library) = arguments.own.read()?;
    let done = calibrate_file(&bytes, &library, subject.as_deref(), arguments.show_others)?;
    let [old, new] = done.recalls;
    let Some(file) = done.file else {
        let kept = Kept(format!(
            "in the later rounds the new head labels {new:.3} right, the old one {old:.3}: nothing was written, go on with {}",
            model.display()
        ));
        return Err(kept.into());
    };
    write_whole(out, &file)?;
    writeln!(
        std::io::stdout(),
        "{}: {} rounds{}; mean recall in the later ones {old:.3} -> {new:.3}\n{} ({} bytes)",
        done.subject,
        done.rounds,
        if done.others {
            " and other movement"
        } else {
            ""
        },
        out.display(),
        file.len()
    )?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;
    use std::process::ExitCode;

    use recordings::synthetic::{SynthOptions, write};

    use crate::cli::{KEPT, run};

    fn calibrate(data: &Path, out: &Path) -> ExitCode {
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/three-class.intent");
        let [model, data, out] = [&model, data, out].map(|path| path.display());
        run(&format!(
            "calibrate --model {model} --data {data} --out {out}"
        ))
    }

    /// The rows of a table with the gestures' labels exchanged.
    fn exchanged(table: &str) -> String {
        let row = |row: &str| match row.split_once(',') {
            Some(("1", rest)) => format!("2,{rest}\n"),
            Some(("2", rest)) => format!("1,{rest}\n"),
            _ => format!("{row}\n"),
        };
        table.lines().map(row).collect()
    }

    #[test]
    fn a_file_is_written_once_and_none_if_the_later_rounds_are_worse() {
        let folder = tempfile::tempdir().unwrap();
        let [data, first, second] =
            ["data", "a.intent", "b.intent"].map(|name| folder.path().join(name));
        let options = SynthOptions {
            subjects: 1,
            recordings: 2,
            seconds: 60,
            ..SynthOptions::default()
        };
        let files = write(&options, &data).unwrap();
        assert_eq!(calibrate(&data, &first), ExitCode::SUCCESS);
        let written = fs::read(&first).unwrap();
        assert_eq!(calibrate(&data, &first), ExitCode::FAILURE);
        assert_eq!(fs::read(&first).unwrap(), written);
        let taught = files.first().unwrap();
        fs::write(taught, exchanged(&fs::read_to_string(taught).unwrap())).unwrap();
        assert_eq!(calibrate(&data, &second), ExitCode::from(KEPT));
        assert!(!second.exists());
    }
}
