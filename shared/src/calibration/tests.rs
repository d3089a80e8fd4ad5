use alloc::{vec, vec::Vec};

use proptest::prelude::*;

use super::*;
use crate::intent::Vocabulary;
use crate::kernels::{Aligned, WEIGHT_ONE, row};
use crate::model::dimensions::Dimensions;
use crate::model::encoder::{DeviceEncoder, HostEncoder};
use crate::model::file::Model;
use crate::model::file::random::random_model;
use crate::model::head::Head;
use crate::model::noise::Noise;
use crate::units::{LOOK_BACK, Patch};

const GESTURES: [Shown; 4] = [
    Shown::Intent(Intent::Relax),
    Shown::Intent(Intent::Open),
    Shown::Intent(Intent::Close),
    Shown::Other,
];

fn file(width: usize, other: bool) -> Vec<u8> {
    let dimensions = Dimensions {
        other,
        ..Dimensions::new(Vocabulary::Three, width, 1, 4)
    };
    random_model(dimensions, 3).to_bytes().unwrap()
}

/// A hidden vector of a class: noise around a mean of its own.
fn hidden(width: usize, class: usize, noise: &mut Noise) -> Vec<f32> {
    let mean = |column: usize| f32::from(((column * 7 + class * 5) % 11) as u8) / 8.0 - 0.6;
    (0..width)
        .map(|column| mean(column) + noise.signed())
        .collect()
}

/// Hidden vectors with what they show: `patches` of each class in turn.
fn shown(width: usize, patches: [usize; 4]) -> Vec<(Vec<f32>, Shown)> {
    let mut noise = Noise(9);
    let mut all = Vec::new();
    for (class, count) in patches.into_iter().enumerate() {
        for _ in 0..count {
            all.push((hidden(width, class, &mut noise), GESTURES[class]));
        }
    }
    all
}

fn sums(shown: &[(Vec<f32>, Shown)]) -> Sums {
    let mut sums = Sums::EMPTY;
    for (hidden, shown) in shown {
        sums.add(hidden, *shown);
    }
    sums
}

fn solved(sums: &Sums, file: &[u8]) -> Result<Head, Refusal> {
    let (mut scratch, mut head) = ([0.0; SCRATCH], Head::EMPTY);
    solve(sums, &Model::parse(file).unwrap(), &mut scratch, &mut head).map(|()| head)
}

/// The weights of an output and its bias.
fn numbers(head: &Head, output: usize) -> Vec<f64> {
    let scale = f64::from(head.scales[output]) / f64::from(WEIGHT_ONE);
    let weights = row::weights(head.tiles(), output, head.width);
    let mut numbers: Vec<f64> = weights.map(|weight| f64::from(weight) * scale).collect();
    numbers.push(f64::from(head.bias[output]));
    numbers
}

/// The heads that the normal equations in f64 give, by elimination with pivots.
fn reference(shown: &[(Vec<f32>, Shown)], old: &Head, row_outputs: usize) -> Vec<Vec<f64>> {
    let columns = old.width + 1;
    let vectors: Vec<(Vec<f64>, usize)> = shown
        .iter()
        .map(|(hidden, shown)| {
            let mut x: Vec<f64> = hidden.iter().map(|&value| f64::from(value)).collect();
            x.push(1.0);
            (x, GESTURES.iter().position(|own| own == shown).unwrap())
        })
        .collect();
    let own = |class: usize| vectors.iter().filter(move |(_, own)| *own == class);
    let classes = if own(3).count() > 0 { 4 } else { 3 };
    let weight = 1.0 / classes as f64;
    let means: Vec<Vec<f64>> = (0..classes)
        .map(|class| {
            let count = own(class).count() as f64;
            (0..columns)
                .map(|column| own(class).map(|(x, _)| x[column]).sum::<f64>() / count)
                .collect()
        })
        .collect();
    let mut matrix = vec![vec![0.0; columns]; columns];
    for a in 0..columns {
        for b in 0..columns {
            let within = vectors
                .iter()
                .map(|(x, class)| (x[a] - means[*class][a]) * (x[b] - means[*class][b]));
            let between = (0..classes).map(|class| weight * means[class][a] * means[class][b]);
            matrix[a][b] = within.sum::<f64>() / vectors.len() as f64 + between.sum::<f64>();
        }
    }
    let trace: f64 = (0..old.width).map(|column| matrix[column][column]).sum();
    let pull = 2.0 * trace / old.width as f64;
    for (column, row) in matrix.iter_mut().enumerate() {
        row[column] += pull;
    }
    (0..old.outputs)
        .map(|output| {
            let before = numbers(old, output);
            let place = output % row_outputs;
            if place >= classes {
                return before;
            }
            let right: Vec<f64> = (0..columns)
                .map(|column| {
                    let asked = (0..classes).map(|class| {
                        let logit = match (place, class) {
                            (place, class) if place == class => 4.0,
                            (0..=2, 0) => -3.0,
                            _ => -2.0,
                        };
                        weight * logit * means[class][column]
                    });
                    pull * before[column] + asked.sum::<f64>()
                })
                .collect();
            eliminated(matrix.clone(), right)
        })
        .collect()
}

fn eliminated(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for step in 0..n {
        let best = (step..n)
            .max_by(|&x, &y| a[x][step].abs().total_cmp(&a[y][step].abs()))
            .unwrap();
        a.swap(step, best);
        b.swap(step, best);
        let (pivot, value) = (a[step].clone(), b[step]);
        for below in step + 1..n {
            let factor = a[below][step] / pivot[step];
            for (entry, pivot) in a[below].iter_mut().zip(&pivot) {
                *entry -= factor * pivot;
            }
            b[below] -= factor * value;
        }
    }
    for step in (0..n).rev() {
        let known: f64 = (step + 1..n)
            .map(|column| a[step][column] * b[column])
            .sum();
        b[step] = (b[step] - known) / a[step][step];
    }
    b
}

#[test]
fn the_head_is_that_of_the_normal_equations_in_double_precision() {
    for (width, other, patches) in [
        (16, true, [40, 20, 25, 30]),
        (16, true, [40, 20, 25, 0]),
        (24, false, [9, 60, 11, 0]),
        (64, true, [240, 120, 120, 120]),
    ] {
        let file = file(width, other);
        let model = Model::parse(&file).unwrap();
        let shown = shown(width, patches);
        let head = solved(&sums(&shown), &file).unwrap();
        let old = Head::of(&model).unwrap();
        let expected = reference(&shown, &old, model.header.dimensions.row_outputs());
        for (output, expected) in expected.iter().enumerate() {
            let step = f64::from(head.scales[output]);
            // The bias of the output for other movement has a test of its own.
            let is_other = other && output % 4 == 3;
            let counted = width + usize::from(!is_other);
            let numbers = numbers(&head, output);
            for (found, expected) in numbers.iter().zip(expected).take(counted) {
                let most = 0.501 * step + 1e-4;
                assert!(
                    (found - expected).abs() <= most,
                    "{output}: {found} {expected}"
                );
            }
        }
    }
}

/// The checksum is the same on the PC and on the emulated core.
#[test]
fn every_machine_gives_the_same_bits() {
    let file = file(32, true);
    let model = Model::parse(&file).unwrap();
    let encoder = DeviceEncoder::new(&model).unwrap();
    let mut state = encoder.fresh();
    let (mut noise, mut sums) = (Noise(4), Sums::EMPTY);
    for patch in 0..120 {
        let level = 1 + patch / 30 * 30;
        let mut samples = Patch::default();
        for value in samples.as_flattened_mut() {
            *value = (noise.bits() % level) as u8;
        }
        let _ = encoder.step(&mut state, &samples);
        sums.add(encoder.hidden(&state), GESTURES[patch as usize / 30]);
    }
    let head = solved(&sums, &file).unwrap();
    let mut bytes = [0; RECORD_BYTES];
    let bytes = to_record(&head, Alignment::NONE, model.checksum, &mut bytes);
    // Without its own checksum, with which any record has the same.
    assert_eq!(
        crate::checksum::crc32(&bytes[..bytes.len() - 4]),
        2_001_499_842
    );
}

#[test]
fn gestures_exceed_other_movement_alike_in_every_wearer_however_often_one_calibrates() {
    let file = file(32, true);
    for patches in [[60, 40, 20, 0], [20, 20, 40, 30]] {
        let shown = shown(32, patches);
        let head = solved(&sums(&shown), &file).unwrap();
        let again = Model::with_head(&file, &head).unwrap();
        let again = solved(&sums(&shown), &again).unwrap();
        let rows = |head| (0..LOOK_BACK).map(move |row| (head, row));
        for (head, row) in [&head, &again].into_iter().flat_map(rows) {
            let over = |class: usize| {
                let [own, other] = [class, 3].map(|place| numbers(head, 4 * row + place));
                let logit = |numbers: &[f64], x: &[f32]| {
                    let products = numbers.iter().zip(x).map(|(w, &x)| w * f64::from(x));
                    products.sum::<f64>() + numbers[32]
                };
                let of = shown.iter().filter(|(_, own)| *own == GESTURES[class]);
                let all = of.map(|(x, _)| logit(&own, x) - logit(&other, x));
                all.sum::<f64>() / patches[class] as f64
            };
            let mean = f64::midpoint(over(1), over(2));
            assert!((mean - 1.0).abs() < 1e-4, "{mean}");
        }
    }
}

#[test]
fn a_calibrated_encoder_gives_the_logits_of_the_file_with_its_head() {
    let file = file(16, true);
    let model = Model::parse(&file).unwrap();
    let head = solved(&sums(&shown(16, [20, 20, 20, 20])), &file).unwrap();
    let written = Model::with_head(&file, &head).unwrap();
    let written = Model::parse(&written).unwrap();
    assert_eq!(Head::of(&written).unwrap(), head);
    let [own, lent] = [&written, &model].map(|model| HostEncoder::new(model).unwrap());
    let lent = lent.with_head(&head);
    let plain = HostEncoder::new(&model).unwrap();
    let (mut states, mut noise, mut differ) =
        ([own.fresh(), own.fresh(), own.fresh()], Noise(1), 0);
    for _ in 0..12 {
        let mut patch = Patch::default();
        for value in patch.as_flattened_mut() {
            *value = (noise.bits() % 129) as u8;
        }
        let [a, b, c] = &mut states;
        let logits = own.step(a, &patch);
        assert_eq!(logits, lent.step(b, &patch));
        differ += usize::from(logits != plain.step(c, &patch));
    }
    assert_eq!(differ, 12);
}

#[test]
fn a_head_of_other_dimensions_is_not_used() {
    let [narrow, wide] = [file(16, true), file(24, true)];
    let head = Head::of(&Model::parse(&narrow).unwrap()).unwrap();
    let model = Model::parse(&wide).unwrap();
    let encoder = HostEncoder::new(&model).unwrap();
    let lent = encoder.with_head(&head);
    let patch = [[9; 8]; 10];
    assert_eq!(
        encoder.step(&mut encoder.fresh(), &patch),
        lent.step(&mut lent.fresh(), &patch)
    );
    assert!(Model::with_head(&wide, &head).is_err());
}

#[test]
fn too_little_or_something_else_is_refused() {
    let with = file(16, true);
    let refusal = |patches, file: &[u8]| solved(&sums(&shown(16, patches)), file).unwrap_err();
    let few = |class, found| Refusal::TooFew { class, found };
    assert_eq!(refusal([8, 20, 20, 0], &with), few(Intent::Relax, 8));
    assert_eq!(refusal([20, 20, 0, 0], &with), few(Intent::Close, 0));
    let others = Refusal::TooFewOthers { found: 8 };
    assert_eq!(refusal([20, 20, 20, 8], &with), others);
    for (width, other, expected) in [
        (16, false, Refusal::WrongModel),
        (24, true, Refusal::WrongModel),
        (72, true, Refusal::TooWide { found: 72 }),
    ] {
        assert_eq!(refusal([20; 4], &file(width, other)), expected, "{width}");
    }
    let mut waved = sums(&shown(16, [20; 4]));
    waved.add(&[0.0; 16], Shown::Intent(Intent::WaveIn));
    assert_eq!(solved(&waved, &with), Err(Refusal::WrongModel));
    for broken in [f32::NAN, f32::INFINITY, 1e30] {
        let mut sums = sums(&shown(16, [20; 4]));
        sums.add(&[broken; 16], Shown::Other);
        assert_eq!(solved(&sums, &with), Err(Refusal::NotFinite), "{broken}");
    }
    let mut sums = sums(&shown(16, [20; 4]));
    let before = sums.clone();
    sums.add(&[0.0; 24], Shown::Other);
    assert_eq!(sums, before);
}

#[test]
fn a_record_is_read_again_and_refused_with_any_byte_changed_or_missing() {
    let file = file(16, true);
    let model = Model::parse(&file).unwrap();
    let head = solved(&sums(&shown(16, [20; 4])), &file).unwrap();
    let mut page = Aligned([0xff; RECORD_BYTES]);
    let alignment = Alignment::new(5, true);
    let length = to_record(&head, alignment, model.checksum, &mut page.0).len();
    let encoder = HostEncoder::new(&model).unwrap();
    let lent = encoder.with_head(&head);
    let mut read = encoder;
    let kept = from_record(&page.0, &model).unwrap();
    assert_eq!(kept.alignment, alignment);
    read.set_head(kept);
    let (mut states, patch) = ([encoder.fresh(), encoder.fresh()], [[9; 8]; 10]);
    let [a, b] = &mut states;
    assert_eq!(lent.step(a, &patch), read.step(b, &patch));
    let read = |bytes: &[u8], model: &Model<'_>| from_record(bytes, model).map(|_| ());
    assert_eq!(read(&page.0[1..], &model), Err(RecordError::Missing));
    for at in 0..length {
        for change in [1, 0x80, 0xff] {
            let mut page = page;
            page.0[at] ^= change;
            let error = read(&page.0, &model).unwrap_err();
            match at {
                0..4 => assert_eq!(error, RecordError::Missing),
                4 => assert!(matches!(error, RecordError::Version { .. })),
                _ => assert_eq!(error, RecordError::Damaged, "{at}"),
            }
        }
        assert!(read(&page.0[..at], &model).is_err());
    }
    assert_eq!(read(&[0xff; 4096], &model), Err(RecordError::Missing));
    let other = random_model(model.header.dimensions, 4).to_bytes().unwrap();
    let other = Model::parse(&other).unwrap();
    let (expected, found) = (other.checksum, model.checksum);
    let refused = Err(RecordError::WrongModel { expected, found });
    assert_eq!(read(&page.0, &other), refused);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(target_os = "none") { 4 } else { 64 }))]
    #[test]
    fn any_sums_are_solved_or_refused_and_a_head_is_one_of_a_file(
        size in -30..30_i32,
        patches in proptest::array::uniform4(0..40_usize),
        seed in any::<u64>(),
    ) {
        let file = file(16, true);
        let (mut noise, mut sums) = (Noise(seed), Sums::EMPTY);
        let size = libm::ldexpf(1.0, size);
        for (class, count) in patches.into_iter().enumerate() {
            for _ in 0..count {
                let hidden: Vec<f32> = hidden(16, class, &mut noise).iter().map(|x| x * size).collect();
                sums.add(&hidden, GESTURES[class]);
            }
        }
        if let Ok(head) = solved(&sums, &file) {
            prop_assert!(Model::with_head(&file, &head).is_ok());
        } else if (-10..6).contains(&(libm::log2f(size) as i32)) {
            prop_assert!(patches[..3].iter().any(|&count| count < 9) || (1..9).contains(&patches[3]));
        }
    }
}
