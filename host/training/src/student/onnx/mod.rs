//! The float student as an ONNX file: one step of the stream, a patch and the state in, logits and the new state out.
//!
//! The state is a table with a row for each past patch of the span, the oldest first: key and value of each layer, and a 1.
//! Rows of zeros are patches before the stream, which attention leaves out; a stream begins with zeros alone. What surrounds
//! the network, from the armband's samples to the patch and from the logits to a label, is not in the file (docs/python.md).

mod graph;
mod protobuf;

use burn::module::Param;
use burn::nn::{LayerNorm, Linear};
use burn::tensor::{Device, Tensor};
use shared::intent::Vocabulary;
use shared::model::file::Model;
use shared::stream::preprocess::Preprocessing;
use shared::units::{CHANNELS, LOOK_BACK, PATCH};

use self::graph::{Attribute, Graph};
use super::dequantization::dequantize;
use super::model::{GELU_SCALE, NORM_EPSILON, Student, StudentLayer};
use crate::optimization::read_back;

/// Subtracted from the score of a patch that is not there. In training it is 1e9, which would leave a static quantization
/// no resolution for the scores beside it.
///
/// Such a patch has a key and a value of zeros: its score is its bias b alone, and it adds nothing to the weighted sum. All
/// of them take span x exp(b - 100 - s) from the weights, where s is the score of the newest patch. With a span of at most 32
/// that is below 2^-25, half a step of an f32 at 1, while b - s < 100 - 25 ln 2 - ln 32 = 79. Biases and scores of trained models are within
/// 20 of zero, and a test compares the logits from the first patch on.
const OUTSIDE: f32 = 100.0;
/// Joins rows.
const ROWS: [(&str, Attribute); 1] = [("axis", Attribute::Integer(0))];
/// Joins columns.
const COLUMNS: [(&str, Attribute); 1] = [("axis", Attribute::Integer(1))];

/// Writes the student of a model file, with the weights that its integers mean.
pub fn of_file(model: &Model<'_>) -> Vec<u8> {
    let (student, _) = dequantize(&model.to_parts(), &Device::default());
    let vocabulary = model.header.dimensions.vocabulary;
    onnx(&student, vocabulary, model.header.preprocessing)
}

/// Writes a student. Inputs: `patch`, `[10, 8]`, preprocessed samples over 128, and `state`; outputs: `logits`, a row for
/// each of the six newest patches, the newest first, and `new_state`. All are f32.
pub fn onnx(student: &Student, vocabulary: Vocabulary, preprocessing: Preprocessing) -> Vec<u8> {
    let [_, width] = student.embed.weight.dims();
    let [_, outputs] = student.head.weight.dims();
    let span = student.layers.first().map_or(1, |layer| layer.span);
    let mut columns = vec![width; 2 * student.layers.len()];
    columns.push(1);
    let state = [span - 1, columns.iter().sum()];
    let mut graph = Graph::default();
    graph.input("patch", [PATCH, CHANNELS]);
    graph.input("state", state);

    let shape = graph.integers(&[1, PATCH * CHANNELS]);
    let mut x = graph.node("Reshape", &["patch", &shape], &[]);
    if student.square_root {
        x = graph.node("Sqrt", &[&x], &[]);
    }
    x = linear(&mut graph, &student.embed, &x);

    let sizes = graph.integers(&columns);
    let past = graph.split(&["state", &sizes], columns.len());
    let one = graph.floats(&[1, 1], &[1.0]);
    let mask = mask(&mut graph, &past[columns.len() - 1], &one, span);
    let mut newest = Vec::new();
    for (layer, [keys, values]) in student.layers.iter().zip(past.as_chunks().0) {
        let (output, own) = apply(&mut graph, layer, &x, [keys, values], &mask);
        x = output;
        newest.extend(own);
    }
    newest.push(one);
    let newest: Vec<&str> = newest.iter().map(String::as_str).collect();
    let newest = graph.node("Concat", &newest, &COLUMNS);
    let [first, end, axis] = [1, span, 0].map(|place| graph.integers(&[place]));
    let kept = graph.node("Slice", &["state", &first, &end, &axis], &[]);
    let new_state = graph.node("Concat", &[&kept, &newest], &ROWS);

    x = norm(&mut graph, &student.final_norm, &x);
    x = linear(&mut graph, &student.head, &x);
    let rows = [LOOK_BACK, outputs / LOOK_BACK];
    let shape = graph.integers(&rows);
    x = graph.node("Reshape", &[&x, &shape], &[]);
    graph.output("logits", rows, &x);
    graph.output("new_state", state, &new_state);

    let intents = vocabulary.intents().iter().map(|intent| intent.name());
    let names: Vec<&str> = intents.chain(student.other.then_some("other")).collect();
    let properties = [
        ("columns", names.join(",")),
        ("normalized", preprocessing.normalized.to_string()),
        ("median", preprocessing.median.width().to_string()),
    ];
    graph.file("student", &properties)
}

/// Terms of the scores, `[1, 1, span]`: 0 for the patch and for those that the state has.
fn mask(graph: &mut Graph, known: &str, one: &str, span: usize) -> String {
    let known = graph.node("Concat", &[known, one], &ROWS);
    let shape = graph.integers(&[1, 1, span]);
    let known = graph.node("Reshape", &[&known, &shape], &[]);
    let missing = graph.node("Sub", &[&known, one], &[]);
    let outside = graph.floats(&[1], &[OUTSIDE]);
    graph.node("Mul", &[&missing, &outside], &[])
}

/// A layer; also gives its key and its value of the patch.
fn apply(
    graph: &mut Graph,
    layer: &StudentLayer,
    x: &str,
    [past_keys, past_values]: [&str; 2],
    mask: &str,
) -> (String, Vec<String>) {
    let [width, _] = layer.out.weight.dims();
    let (span, heads, head) = (layer.span, layer.heads, width / layer.heads);
    let normalised = norm(graph, &layer.norm1, x);
    let qkv = linear(graph, &layer.qkv, &normalised);
    let mut query = graph.split(&[&qkv], 3);
    let own = query.split_off(1);

    // `[span, heads, head]` in another order of the axes.
    let shape = graph.integers(&[span, heads, head]);
    let mut over_span = |past: &str, own: &str, axes| {
        let all = graph.node("Concat", &[past, own], &ROWS);
        let all = graph.node("Reshape", &[&all, &shape], &[]);
        graph.node("Transpose", &[&all], &[("perm", Attribute::Integers(axes))])
    };
    let keys = over_span(past_keys, &own[0], &[1, 2, 0]);
    let values = over_span(past_values, &own[1], &[1, 0, 2]);

    let shape = graph.integers(&[heads, 1, head]);
    let query = graph.node("Reshape", &[&query[0], &shape], &[]);
    let scale = graph.floats(&[1], &[1.0 / (head as f32).sqrt()]);
    let query = graph.node("Mul", &[&query, &scale], &[]);
    let scores = graph.node("MatMul", &[&query, &keys], &[]);
    let mut bias = read_back(layer.relative_bias.val());
    // A bias is that of an age; the oldest patch comes first.
    bias.chunks_mut(span).for_each(<[f32]>::reverse);
    let bias = graph.floats(&[heads, 1, span], &bias);
    let scores = graph.node("Add", &[&scores, &bias], &[]);
    let scores = graph.node("Add", &[&scores, mask], &[]);
    let weights = graph.node("Softmax", &[&scores], &[]);
    let attended = graph.node("MatMul", &[&weights, &values], &[]);
    let shape = graph.integers(&[1, width]);
    let attended = graph.node("Reshape", &[&attended, &shape], &[]);
    let attended = linear(graph, &layer.out, &attended);
    let x = graph.node("Add", &[x, &attended], &[]);

    let normalised = norm(graph, &layer.norm2, &x);
    let hidden = linear(graph, &layer.ff1, &normalised);
    let scale = graph.floats(&[1], &[GELU_SCALE]);
    let gate = graph.node("Mul", &[&hidden, &scale], &[]);
    let gate = graph.node("Sigmoid", &[&gate], &[]);
    let hidden = graph.node("Mul", &[&hidden, &gate], &[]);
    let hidden = linear(graph, &layer.ff2, &hidden);
    (graph.node("Add", &[&x, &hidden], &[]), own)
}

fn linear(graph: &mut Graph, linear: &Linear, x: &str) -> String {
    let [inputs, outputs] = linear.weight.dims();
    let weight = graph.floats(&[inputs, outputs], &read_back(linear.weight.val()));
    let bias = vector(graph, linear.bias.as_ref(), outputs);
    graph.node("Gemm", &[x, &weight, &bias], &[])
}

fn norm(graph: &mut Graph, norm: &LayerNorm, x: &str) -> String {
    let [width] = norm.gamma.dims();
    let gain = vector(graph, Some(&norm.gamma), width);
    let bias = vector(graph, norm.beta.as_ref(), width);
    let epsilon = [("epsilon", Attribute::Float(NORM_EPSILON as f32))];
    graph.node("LayerNormalization", &[x, &gain, &bias], &epsilon)
}

/// A vector of parameters; zeros without any.
fn vector(graph: &mut Graph, parameter: Option<&Param<Tensor<1>>>, length: usize) -> String {
    let values =
        parameter.map_or_else(|| vec![0.0; length], |parameter| read_back(parameter.val()));
    graph.floats(&[length], &values)
}
