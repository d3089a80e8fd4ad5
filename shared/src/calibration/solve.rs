//! Closed-form solution for the head of a wearer.

use super::sums::{COLUMNS, Shown, Sums, TRIANGLE, add_products};
use super::{FEWEST_PATCHES, Refusal};
use crate::intent::{Intent, MAX_LOGITS};
use crate::kernels::{WEIGHT_ONE, row};
use crate::model::dimensions::Dimensions;
use crate::model::file::{LinearWeights, Model};
use crate::model::head::{Head, MAX_HEAD_WIDTH};
use crate::units::LOOK_BACK;

/// Target logit of the class that is shown.
const OWN: f32 = 4.0;
/// Target logit of every other output.
const ELSE: f32 = -2.0;
/// Target logit of the gestures while relax is shown: models are surest there.
const AT_REST: f32 = -3.0;
/// By how much the wearer's gestures exceed other movement: means of logits over the patches that show them.
const GESTURE_OVER_OTHER: f32 = 1.0;
/// Ridge penalty on the distance to the model's own head, in mean squares of a column.
const PULL: f32 = 2.0;

/// Numbers in the scratch memory of [`solve`]: the factors of a symmetric matrix, 8.6 KB.
pub const SCRATCH: usize = TRIANGLE;

/// Writes the head of a model for the wearer whose sums these are. Cost: 0.2 million products.
///
/// The weights of the output for other movement stay the model's own if the wearer shows none; its bias never does.
///
/// # Errors
/// Each [`Refusal`]; the head is the model's own then, or as it was if the model is too wide.
pub fn solve(
    sums: &Sums,
    model: &Model<'_>,
    scratch: &mut [f32; SCRATCH],
    head: &mut Head,
) -> Result<(), Refusal> {
    let own = &model.weights.head;
    solve_from(sums, &model.header.dimensions, own, scratch, head)
}

/// Writes the head as [`solve`] does, for a model with these dimensions and this head of its own.
pub(crate) fn solve_from(
    sums: &Sums,
    dimensions: &Dimensions,
    own: &LinearWeights<'_>,
    scratch: &mut [f32; SCRATCH],
    head: &mut Head,
) -> Result<(), Refusal> {
    if !head.copy(dimensions, own) {
        return Err(Refusal::TooWide {
            found: dimensions.width,
        });
    }
    let classes = Classes::of(sums, dimensions)?;
    let columns = sums.columns;
    let pull = matrix(sums, &classes, scratch);
    if !factorize(scratch, columns) {
        return Err(Refusal::NotFinite);
    }
    let outputs = dimensions.row_outputs();
    for output in 0..head.outputs {
        let place = output % outputs;
        let Some(of) = classes.shown(place) else {
            continue;
        };
        let mut x = [0.0; COLUMNS];
        let x = &mut x[..columns];
        let scale = head.scales[output] / WEIGHT_ONE as f32;
        let weights = row::weights(head.tiles(), output, columns - 1);
        for (x, weight) in x.iter_mut().zip(weights) {
            *x = pull * (f32::from(weight) * scale);
        }
        x[columns - 1] = pull * head.bias[output];
        for class in classes.each() {
            let factor = class.weight * target(of, class.shown) / class.patches;
            for (x, sum) in x.iter_mut().zip(&sums.of_class[class.shown.index()]) {
                *x += factor * sum;
            }
        }
        substitute(scratch, x);
        head.put(output, &x[..columns - 1], x[columns - 1]);
    }
    if dimensions.other {
        place_other(sums, &classes, outputs, head);
    }
    if head.complete() {
        Ok(())
    } else {
        head.copy(dimensions, own);
        Err(Refusal::NotFinite)
    }
}

/// Sets the bias of the output for other movement, the last one of each look-back row. Without this a
/// learnt head would be surer of any movement, not of gestures alone, and for each person by another amount.
fn place_other(sums: &Sums, classes: &Classes, outputs: usize, head: &mut Head) {
    for row in 0..LOOK_BACK {
        let (mut over, mut gestures) = (0.0, 0.0);
        for (place, class) in classes.gestures() {
            let own = mean_logit(sums, class, head, row * outputs + place);
            over += own - mean_logit(sums, class, head, (row + 1) * outputs - 1);
            gestures += 1.0;
        }
        head.bias[(row + 1) * outputs - 1] += over / gestures - GESTURE_OVER_OTHER;
    }
}

/// Mean logit of an output over the patches that show a class.
// Not inlined, like the functions below: saves flash, and time does not matter here.
#[inline(never)]
fn mean_logit(sums: &Sums, class: Class, head: &Head, output: usize) -> f32 {
    let mut sum = 0.0;
    let weights = row::weights(head.tiles(), output, sums.columns - 1);
    for (weight, hidden) in weights.zip(&sums.of_class[class.shown.index()]) {
        sum += f32::from(weight) * hidden;
    }
    let scale = head.scales[output] / WEIGHT_ONE as f32;
    sum * scale / class.patches + head.bias[output]
}

/// Target logit of an output in patches that show a class.
fn target(output: Shown, shown: Shown) -> f32 {
    const RELAX: Shown = Shown::Intent(Intent::Relax);
    match (output, shown) {
        (own, shown) if own == shown => OWN,
        (Shown::Intent(_), RELAX) => AT_REST,
        _ => ELSE,
    }
}

/// A class that was shown.
#[derive(Clone, Copy)]
struct Class {
    shown: Shown,
    /// Share of the class in the mean over all.
    weight: f32,
    patches: f32,
}

/// Classes that were shown, in the order of a row's outputs; `None` for an output whose class was not.
struct Classes {
    classes: [Option<Class>; MAX_LOGITS],
}

impl Classes {
    fn of(sums: &Sums, dimensions: &Dimensions) -> Result<Self, Refusal> {
        let intents = dimensions.vocabulary.intents();
        for &class in intents {
            let found = sums.patches(Shown::Intent(class));
            if found < FEWEST_PATCHES {
                return Err(Refusal::TooFew { class, found });
            }
        }
        let others = sums.patches(Shown::Other);
        if (1..FEWEST_PATCHES).contains(&others) {
            return Err(Refusal::TooFewOthers { found: others });
        }
        let all = sums.patches.iter().filter(|patches| **patches > 0).count();
        let with_others = others > 0;
        // Sums of another vocabulary or width are of another model.
        if sums.columns != dimensions.width + 1
            || all != intents.len() + usize::from(with_others)
            || with_others && !dimensions.other
        {
            return Err(Refusal::WrongModel);
        }
        let class = |shown: Shown| Class {
            shown,
            weight: 1.0 / all as f32,
            patches: sums.patches(shown) as f32,
        };
        let mut classes = [None; MAX_LOGITS];
        for (place, &intent) in classes.iter_mut().zip(intents) {
            *place = Some(class(Shown::Intent(intent)));
        }
        if with_others {
            classes[intents.len()] = Some(class(Shown::Other));
        }
        Ok(Self { classes })
    }

    /// Class of a row's output; `None` if it was not shown.
    fn shown(&self, output: usize) -> Option<Shown> {
        self.classes
            .get(output)
            .copied()
            .flatten()
            .map(|own| own.shown)
    }

    /// The gestures, with their places in a row.
    fn gestures(&self) -> impl Iterator<Item = (usize, Class)> {
        let classes = self.classes.into_iter().enumerate();
        let classes = classes.filter_map(|(place, class)| Some((place, class?)));
        classes.filter(|(_, class)| {
            !matches!(class.shown, Shown::Intent(Intent::Relax) | Shown::Other)
        })
    }

    fn each(&self) -> impl Iterator<Item = Class> {
        self.classes.into_iter().flatten()
    }
}

/// Writes the matrix of the normal equations; returns the penalty that is on its diagonal.
///
/// The matrix is the covariance within the classes, pooled over all patches, plus the second moments of the classes' means,
/// each class weighed the same. One set of sums is enough for that, however unequal the holds.
fn matrix(sums: &Sums, classes: &Classes, matrix: &mut [f32; TRIANGLE]) -> f32 {
    let all = 1.0 / classes.each().map(|class| class.patches).sum::<f32>();
    for (entry, product) in matrix.iter_mut().zip(&sums.products) {
        *entry = product * all;
    }
    for class in classes.each() {
        let factor = (class.weight / class.patches - all) / class.patches;
        let own = &sums.of_class[class.shown.index()][..sums.columns];
        add_products(matrix, own, factor);
    }
    let diagonal = |row: usize| start(row) + row;
    let width = sums.columns - 1;
    let mut trace = 0.0;
    for row in 0..width {
        trace += matrix[diagonal(row)];
    }
    let pull = PULL * trace / width as f32;
    for row in 0..sums.columns {
        matrix[diagonal(row)] += pull;
    }
    pull
}

/// Index of a row's first entry in a triangle.
const fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

/// Factorizes a symmetric matrix in place into `L D L^T`: `D` on the diagonal, `L` below it. Returns whether it is
/// positive definite.
fn factorize(matrix: &mut [f32; TRIANGLE], columns: usize) -> bool {
    for row in 0..columns {
        let (above, rest) = matrix.split_at_mut(start(row));
        let own = &mut rest[..=row];
        // Entries of `L D` first.
        for column in 0..row {
            let other = &above[start(column)..][..column];
            own[column] -= product(&own[..column], other);
        }
        let mut pivot = own[row];
        for column in 0..row {
            let scaled = own[column];
            own[column] = scaled / above[start(column) + column];
            pivot -= scaled * own[column];
        }
        own[row] = pivot;
        if !(pivot > 0.0 && pivot < f32::MAX) {
            return false;
        }
    }
    true
}

/// Solves `L D L^T x = b` in place.
#[inline(never)]
fn substitute(factor: &[f32; TRIANGLE], x: &mut [f32]) {
    for row in 0..x.len() {
        x[row] -= product(&factor[start(row)..][..row], &x[..row]);
    }
    for (row, x) in x.iter_mut().enumerate() {
        *x /= factor[start(row) + row];
    }
    for row in (0..x.len()).rev() {
        let (above, own) = x.split_at_mut(row);
        for (x, entry) in above.iter_mut().zip(&factor[start(row)..]) {
            *x -= entry * own[0];
        }
    }
}

/// Sum of products, from the first to the last.
#[inline(never)]
fn product(a: &[f32], b: &[f32]) -> f32 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

const _: () = assert!(start(COLUMNS) == TRIANGLE && COLUMNS == MAX_HEAD_WIDTH + 1);
