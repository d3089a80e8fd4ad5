//! `myointent-research cross-validate`: compares presets, baselines and floors on all people, for several seeds.

mod contenders;
mod output;

use std::io::Write as _;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum as _};
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::write_whole;
use myointent::cli::arguments::warn_of_test_people;
use myointent::cli::steps::DataArguments;
use presets::OperatingPoint;
use presets::resolve::{ConfigError, fold_people, test_people};
use recordings::folds::Protocol;
use training::backend::BackendArguments;

use self::contenders::{contenders, presets};
use self::output::{merged, picture, tables};
use super::{print_tables, write_tables};
use crate::baselines::Baseline;
use crate::cross_validation::{Contender, ContenderKind, CrossValidation, Job, Origin, people};

#[derive(Debug, Args)]
#[command(
    after_help = "A job is one fold of one preset with one seed: it trains the student (and before it the teacher\n\
    that it learns from) without the people of the fold, and evaluates the integer student on them. A fold has people of\n\
    all data sets found, also of those that the preset does not train on; test people are in none. The seed decides folds,\n\
    validation people and training. A person's value is the mean over seeds; intervals are over people, from six on. People\n\
    whose recordings have all classes of the model and people with fewer stand in rows of their own; `n` is a column's\n\
    number of people where its row has more.\n\n\
    Baselines are trained on the recordings and people of the first preset. The tables end with the constant relax and the energy\n\
    detector.\n\n\
    Jobs are independent. An interrupted job continues where it stopped; a finished one is not repeated. Tables are printed\n\
    for the folds that all have, and written to the folder when these are all folds; beside them recognition.svg, the share of\n\
    gestures recognised by the time since their onset.\n\n\
    Examples:\n  \
    myointent-research cross-validate --preset cpu --preset mine.toml --seeds 42,7 --data recordings\n  \
    myointent-research cross-validate --preset cpu --baselines lstm,ed-tcn --data recordings\n  \
    myointent-research cross-validate --preset cpu --list | sh       job by job, or pass the lines to a scheduler"
)]
pub(super) struct Arguments {
    /// Presets to compare, the first one with all others: built-in ones, or TOML files. Repeat the option.
    #[arg(long, required = true)]
    preset: Vec<String>,
    /// The paper's baselines to compare, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    baselines: Vec<Baseline>,
    /// Run the jobs of this preset or baseline only.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Seeds, separated by commas; everything is trained with each.
    #[arg(long, value_delimiter = ',', default_value = "42,7")]
    seeds: Vec<u64>,
    /// Whom a fold holds out: `4-fold` (or any number) a fourth of the people of each data set, `loso` one of each, `sets`
    /// everybody of one data set.
    #[arg(long, default_value_t = Protocol::LeaveGroupsOut(4))]
    protocol: Protocol,
    /// Also evaluate with this operating point, as a preset's `smoother.reaction`: `steady`, `balanced,other=0,caution=4`, or
    /// `entry=1` for labels that wait. Repeat the option. Nothing is trained again.
    #[arg(long, value_name = "POINT")]
    reaction: Vec<OperatingPoint>,
    /// Also evaluate the test people (host/recordings/people.toml), once for a release: by the student of every fold and seed, none of
    /// which has seen them. They stand in a table of their own. Nothing is trained again.
    #[arg(long)]
    test_people: bool,
    /// Number of the only fold to run, 1 first; all if not given.
    #[arg(long)]
    fold: Option<usize>,
    /// Folder; run folders are NAME/seed-S/fold-K in it.
    #[arg(long, value_name = "DIR", default_value = "runs/cross-validation")]
    out: PathBuf,
    /// Print the jobs as commands, one per line, without running them.
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Runs the jobs, or lists them; prints and writes the tables when no job is left.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let presets = presets(arguments)?;
    // All data sets, regardless of the presets' own: all people are evaluated.
    let mut readable = presets[0].clone();
    readable.data.data_sets.clear();
    let library = Arc::new(arguments.data.load(&readable)?);
    let of = fold_people(&presets[0], &library, arguments.protocol).len();
    if of < 2
        || arguments
            .fold
            .is_some_and(|number| !(1..=of).contains(&number))
    {
        let number = arguments.fold.unwrap_or(1);
        return Err(ConfigError::Fold { number, of }.into());
    }
    let folds = arguments.fold.map_or(1..=of, |number| number..=number);
    let contenders = contenders(&presets, &arguments.baselines, arguments.only.as_deref())?;
    let mut out = std::io::stdout().lock();
    if arguments.list {
        // The floors train nothing: the command that makes the tables computes them.
        let jobs = selected(arguments, folds, &contenders).filter(|(own, ..)| own.is_trained());
        for (contender, seed, fold) in jobs {
            writeln!(out, "{}", command(arguments, contender, seed, fold))?;
        }
        return Ok(());
    }
    let device = arguments.backend.device()?;
    let data = arguments.data.folder();
    let interrupt = Interrupt::listen();
    let validation = CrossValidation {
        folder: &arguments.out,
        protocol: arguments.protocol,
        test_people: arguments.test_people,
        gates: gates(arguments).collect(),
        library,
        data: data.as_deref(),
        strict: arguments.data.strict,
        device,
        interrupt: &interrupt,
    };
    let job = |contender: &Contender, seed, fold| Job {
        contender: contender.with_seed(seed),
        fold,
    };
    if arguments.test_people {
        warn_of_test_people(test_people(&presets[0], &validation.library).len());
    }
    for (contender, seed, fold) in selected(arguments, folds, &contenders) {
        validation.run(&job(contender, seed, fold))?;
    }
    // Other commands may have run other folds and seeds. A fold counts if all contenders have it.
    let mut results = vec![Vec::new(); contenders.len()];
    let (mut counted, mut left) = (0, 0);
    for &seed in &arguments.seeds {
        for fold in 1..=of {
            let all: Result<Option<Vec<_>>, _> = contenders
                .iter()
                .map(|contender| validation.done(&job(contender, seed, fold)))
                .collect();
            let Some(all) = all? else {
                left += 1;
                continue;
            };
            counted += 1;
            for (own, scores) in results.iter_mut().zip(all) {
                own.push((Origin { seed, fold }, scores));
            }
        }
    }
    if counted == 0 {
        progress::log("no tables yet: no fold has been run with everything that is compared");
        return Ok(());
    }
    let merged = |people| {
        let gates = || gates(arguments);
        merged(&contenders, &results, gates, people)
    };
    let (development, test) = (
        merged(|own| Some(&own.development)),
        merged(|own| own.test.as_ref()),
    );
    let tables = tables(&development, &test);
    print_tables(&tables, &mut out)?;
    if left > 0 {
        progress::log(&format!(
            "these are {counted} of {} folds, not everybody: nothing was written; give the same command without --fold and --only",
            counted + left
        ));
        return Ok(());
    }
    let people = people(&development, &test);
    for path in write_tables(&arguments.out, &tables, &people)? {
        writeln!(out, "{}", path.display())?;
    }
    if let Some(picture) = picture(&development) {
        let path = arguments.out.join("recognition.svg");
        write_whole(&path, picture.as_bytes())?;
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}

/// Operating points: the preset's own, then those asked for.
fn gates(arguments: &Arguments) -> impl Iterator<Item = Option<OperatingPoint>> {
    let asked = arguments.reaction.iter().copied().map(Some);
    std::iter::once(None).chain(asked)
}

/// Jobs, as contender, seed and fold.
fn selected<'a>(
    arguments: &'a Arguments,
    folds: RangeInclusive<usize>,
    contenders: &'a [Contender],
) -> impl Iterator<Item = (&'a Contender, u64, usize)> {
    let only = arguments.only.as_ref();
    arguments.seeds.iter().flat_map(move |&seed| {
        folds.clone().flat_map(move |fold| {
            contenders
                .iter()
                .filter(move |own| only.is_none_or(|only| own.argument() == *only))
                .map(move |contender| (contender, seed, fold))
        })
    })
}

/// Shell command of one job, to be run in the current folder.
fn command(arguments: &Arguments, contender: &Contender, seed: u64, fold: usize) -> String {
    let program = std::env::args().next();
    let program = program.unwrap_or_else(|| "myointent-research".to_owned());
    let mut words = vec![program, "cross-validate".to_owned()];
    let mut option = |name: &str, value: Option<String>| {
        words.push(format!("--{name}"));
        words.extend(value);
    };
    for preset in &arguments.preset {
        option("preset", Some(preset.clone()));
    }
    if let ContenderKind::Baseline(_) = contender.kind {
        option("baselines", Some(contender.argument()));
    }
    option("only", Some(contender.argument()));
    option("seeds", Some(seed.to_string()));
    option("protocol", Some(arguments.protocol.to_string()));
    option("fold", Some(fold.to_string()));
    option("out", Some(arguments.out.display().to_string()));
    for point in &arguments.reaction {
        option("reaction", Some(point.to_string()));
    }
    if arguments.test_people {
        option("test-people", None);
    }
    if let Some(data) = arguments.data.folder() {
        option("data", Some(data.display().to_string()));
    }
    let backend = arguments.backend.backend;
    if let Some(backend) = backend.and_then(|backend| backend.to_possible_value()) {
        option("backend", Some(backend.get_name().to_owned()));
    }
    if arguments.data.strict {
        option("strict", None);
    }
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    words.join(" ")
}

/// Quotes a word where a shell needs it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        let words = ["runs/fold-1", "my data", "it's", ""].map(quoted);
        assert_eq!(words, ["runs/fold-1", "'my data'", r"'it'\''s'", "''"]);
    }
}
