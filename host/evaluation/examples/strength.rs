//! Strength against a measured force: `cargo run --release -p myointent-evaluation --example strength -- MODEL.intent DIR`.
//!
//! `DIR/PERSON/NAME_emg.npy` is EMG (n x 8, whole numbers), `NAME_force.npy` the force beside each sample (n), at 200 Hz. Values
//! are compared every 50 ms, over the second half of each recording: the first is for the range, and for the fit. Nothing else
//! is fitted on the person judged. A person is the mean of their recordings.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use evaluation::inference::Stream;
use recordings::readers::npy::{self, Values};
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::stream::normalizer::Normalizer;
use shared::stream::strength::{Percent, Strength};
use shared::uart_line::line::Line;
use shared::units::{CHANNELS, HOLD, PATCH, Sample};

/// Lags of the linear filter, of 50 ms.
const LAGS: usize = 4;
/// Inputs of the linear filter, and a constant.
const INPUTS: usize = LAGS * CHANNELS + 1;
/// Patches of a window of constant force, and of the longest lag.
const SECOND: usize = 20;

/// One recording, a value a patch.
struct Squeeze {
    samples: Vec<Sample>,
    /// Share of the recording's largest force.
    force: Vec<f64>,
    inputs: Vec<[f64; INPUTS]>,
}

type People = BTreeMap<String, Vec<Squeeze>>;
type Filter = [f64; INPUTS];

fn main() -> Result<(), Box<dyn Error>> {
    let [_, model, folder] = &std::env::args().collect::<Vec<_>>()[..] else {
        return Err("expected MODEL.intent DIR".into());
    };
    let bytes = std::fs::read(model)?;
    let model = Model::parse(&bytes)?;
    let people = read(Path::new(folder))?;
    let recordings = people.values().map(Vec::len).sum::<usize>();
    println!(
        "{} people, {recordings} recordings, second halves; median of people (worst)\n",
        people.len()
    );
    println!(
        "| | r | error, % | a fifth told apart | variation | lag, ms |\n| --- | --: | --: | --: | --: | --: |"
    );
    let judge = |name, estimate: &dyn Fn(&str, &Squeeze) -> Vec<f64>| {
        let person = |(person, squeezes): (&String, &Vec<Squeeze>)| {
            let scores = squeezes.iter().map(|squeeze| {
                let half = squeeze.force.len() / 2;
                scores(&estimate(person, squeeze)[half..], &squeeze.force[half..])
            });
            let scores: Vec<_> = scores.collect();
            std::array::from_fn(|column| mean(scores.iter().map(|scores| scores[column])))
        };
        row(name, &people.iter().map(person).collect::<Vec<[f64; 5]>>());
    };
    judge("`$LABEL`", &|_, squeeze| labels(&model, &squeeze.samples));
    judge("the same, label given", &|_, squeeze| {
        given(&squeeze.samples)
    });
    judge("linear, fitted on others", &|person, squeeze| {
        let others = people.iter().filter(|(other, _)| *other != person);
        let rows = others
            .flat_map(|(_, squeezes)| squeezes)
            .flat_map(|other| other.inputs.iter().zip(&other.force));
        filtered(&fit(rows), squeeze)
    });
    judge("linear, fitted on the first half", &|_, squeeze| {
        let half = squeeze.force.len() / 2;
        filtered(
            &fit(squeeze.inputs[..half].iter().zip(&squeeze.force)),
            squeeze,
        )
    });
    judge("constant, the median force", &|_, squeeze| {
        vec![median(squeeze.force.clone()); squeeze.force.len()]
    });
    Ok(())
}

fn read(folder: &Path) -> Result<People, Box<dyn Error>> {
    let mut people = People::new();
    for person in std::fs::read_dir(folder)? {
        let person = person?;
        for file in std::fs::read_dir(person.path())? {
            let path = file?.path();
            let Some(name) = path.to_str().and_then(|path| path.strip_suffix("_emg.npy")) else {
                continue;
            };
            let emg = numbers(&path)?;
            let force = numbers(Path::new(&format!("{name}_force.npy")))?;
            let most = force.iter().copied().fold(0.0, f64::max);
            let samples: Vec<Sample> = emg
                .as_chunks()
                .0
                .iter()
                .map(|sample| sample.map(|x: f64| x as i8))
                .collect();
            let force = force
                .chunks_exact(PATCH)
                .map(|patch| patch[PATCH - 1].max(0.0) / most);
            let squeeze = Squeeze {
                inputs: inputs(&samples),
                force: force.collect(),
                samples,
            };
            people
                .entry(person.file_name().to_string_lossy().into_owned())
                .or_default()
                .push(squeeze);
        }
    }
    Ok(people)
}

fn numbers(path: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    match npy::read(path)?.values {
        Values::Numbers(numbers) => Ok(numbers),
        _ => Err(format!("{}: no numbers", path.display()).into()),
    }
}

/// Strength of the newest label.
fn labels(model: &Model<'_>, samples: &[Sample]) -> Vec<f64> {
    let encoder = HostEncoder::new(model).expect("a model");
    let mut state = encoder.fresh();
    let mut stream = Stream::new(model, encoder, &mut state, None).expect("its settings");
    let mut newest = 0.0;
    let patch = |patch: &[Sample]| {
        let _: ControlFlow<()> = stream.push(
            patch,
            |_| (),
            |line| {
                if let Line::Report(report) = line {
                    newest = f64::from(report.strength.map_or(0, Percent::get)) / 100.0;
                }
                ControlFlow::Continue(())
            },
        );
        newest
    };
    samples.chunks_exact(PATCH).map(patch).collect()
}

/// Strength were each label close.
fn given(samples: &[Sample]) -> Vec<f64> {
    let (mut normalizer, mut strength, mut newest) =
        (Normalizer::default(), Strength::default(), 0.0);
    let patch = |(place, patch): (usize, &[Sample])| {
        for &sample in patch {
            strength.push(sample);
            normalizer.push(sample);
        }
        if place % (HOLD / PATCH) == 0 {
            strength.learn(Intent::Close, normalizer.rest());
            newest = f64::from(strength.of(Intent::Close, normalizer.rest()).get()) / 100.0;
        }
        newest
    };
    samples.chunks_exact(PATCH).enumerate().map(patch).collect()
}

/// |x| of each electrode in the newest patches, and a constant.
fn inputs(samples: &[Sample]) -> Vec<[f64; INPUTS]> {
    let level = |patch: &[Sample], electrode: usize| {
        mean(
            patch
                .iter()
                .map(|sample| f64::from(sample[electrode]).abs()),
        )
    };
    let mut inputs = [0.0; INPUTS];
    let patches = samples.chunks_exact(PATCH).map(|patch| {
        inputs.copy_within(..(LAGS - 1) * CHANNELS, CHANNELS);
        let levels: [f64; CHANNELS] = std::array::from_fn(|electrode| level(patch, electrode));
        inputs[..CHANNELS].copy_from_slice(&levels);
        inputs[INPUTS - 1] = 1.0;
        inputs
    });
    patches.collect()
}

/// Ridge regression.
fn fit<'i>(rows: impl Iterator<Item = (&'i [f64; INPUTS], &'i f64)>) -> Filter {
    let mut system = [[0.0; INPUTS + 1]; INPUTS];
    for (inputs, force) in rows {
        for (row, left) in system.iter_mut().zip(inputs) {
            for (sum, right) in row.iter_mut().zip(inputs.iter().chain([force])) {
                *sum += left * right;
            }
        }
    }
    let trace: f64 = (0..INPUTS).map(|place| system[place][place]).sum();
    for (place, row) in system[..INPUTS - 1].iter_mut().enumerate() {
        row[place] += 0.01 * trace / INPUTS as f64;
    }
    for pivot in 0..INPUTS {
        let own = system[pivot].map(|value| value / system[pivot][pivot]);
        for row in &mut system {
            let factor = row[pivot];
            row.iter_mut()
                .zip(own)
                .for_each(|(value, own)| *value -= factor * own);
        }
        system[pivot] = own;
    }
    system.map(|row| row[INPUTS])
}

fn filtered(filter: &Filter, squeeze: &Squeeze) -> Vec<f64> {
    let dot = |inputs: &[f64; INPUTS]| {
        inputs
            .iter()
            .zip(filter)
            .map(|(input, weight)| input * weight)
            .sum()
    };
    squeeze.inputs.iter().map(dot).collect()
}

/// Correlation; mean absolute error; share of pairs of patches, 0.18 to 0.22 of the force apart, in the right order; variation
/// in seconds of constant force; lag of the best correlation.
fn scores(found: &[f64], force: &[f64]) -> [f64; 5] {
    let r = correlation(found, force);
    let error = mean(
        found
            .iter()
            .zip(force)
            .map(|(found, force)| (found - force).abs()),
    );
    let mut order = Vec::new();
    for (weak, &less) in force.iter().enumerate() {
        for (strong, &more) in force.iter().enumerate() {
            if (0.18..0.22).contains(&(more - less)) {
                let difference = found[strong] - found[weak];
                order.push(if difference == 0.0 {
                    0.5
                } else {
                    f64::from(difference > 0.0)
                });
            }
        }
    }
    let variation = force
        .chunks_exact(SECOND)
        .zip(found.chunks_exact(SECOND))
        .filter_map(|(force, found)| {
            let (least, most) = force.iter().fold((1.0_f64, 0.0_f64), |(least, most), &x| {
                (least.min(x), most.max(x))
            });
            let level = mean(found.iter().copied());
            let square = mean(found.iter().map(|x| (x - level).powi(2)));
            (least > 0.2 && most - least < 0.04 && level > 0.0).then(|| square.sqrt() / level)
        });
    let late = |lag: usize| correlation(&found[lag..], &force[..force.len() - lag]);
    let early = |lag: usize| correlation(&found[..found.len() - lag], &force[lag..]);
    let lags = (1..=SECOND).flat_map(|lag| [(late(lag), lag as f64), (early(lag), -(lag as f64))]);
    let lag = lags
        .fold(
            (r, 0.0),
            |best, next| if next.0 > best.0 { next } else { best },
        )
        .1;
    [r, 100.0 * error, mean(order), mean(variation), 50.0 * lag]
}

fn correlation(one: &[f64], two: &[f64]) -> f64 {
    let [one, two] = [one, two].map(|values| {
        let mean = mean(values.iter().copied());
        values.iter().map(|x| x - mean).collect::<Vec<_>>()
    });
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let spread = product(&one, &one) * product(&two, &two);
    if spread == 0.0 {
        0.0
    } else {
        product(&one, &two) / spread.sqrt()
    }
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .into_iter()
        .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| !value.is_nan());
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn row(name: &str, people: &[[f64; 5]]) {
    let column = |at: usize| people.iter().map(move |scores| scores[at]);
    let middle = |at| median(column(at).collect());
    let least = |at| column(at).fold(f64::INFINITY, f64::min);
    println!(
        "| {name} | {:.3} ({:.3}) | {:.1} ({:.1}) | {:.2} ({:.2}) | {:.3} | {:.0} |",
        middle(0),
        least(0),
        middle(1),
        column(1).fold(0.0, f64::max),
        middle(2),
        least(2),
        middle(3),
        middle(4),
    );
}
