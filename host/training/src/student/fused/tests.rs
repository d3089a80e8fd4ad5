use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor, TensorData};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::ThreadPoolBuilder;
use shared::model::dimensions::Companding;
use shared::units::{CHANNELS, LOOK_BACK, PATCH};

use crate::optimization::read_back;
use crate::student::model::{Student, StudentConfig};

const CLASSES: usize = 3;

fn config(d_model: usize, layers: usize, span: usize) -> StudentConfig {
    StudentConfig {
        d_model,
        heads: 4,
        layers,
        span,
        companding: Companding::SquareRoot,
        board: false,
    }
}

/// Student without gradients; none of its parameters is 0 or 1, as some are at the start of training.
fn student(config: &StudentConfig) -> Student {
    let rng = ChaCha8Rng::seed_from_u64(3);
    let device = Device::flex().autodiff();
    Student::new(1, config, CLASSES, false, &device)
        .valid()
        .map(&mut RandomParameters(rng))
}

struct RandomParameters(ChaCha8Rng);

impl ModuleMapper for RandomParameters {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let values = random(param.dims(), &mut self.0) - 0.5;
        param.map(|_| values)
    }
}

/// Random values from 0 to 1.
fn random<const D: usize>(dims: [usize; D], rng: &mut ChaCha8Rng) -> Tensor<D> {
    let values = (0..dims.iter().product()).map(|_| rng.random_range(0.0..1.0_f32));
    Tensor::from_data(TensorData::new(values.collect(), dims), &Device::flex())
}

/// EMG, and weights of the logits in the sum whose gradients are compared.
fn inputs(batch: usize, patches: usize) -> (Tensor<3>, Tensor<4>) {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let emg = random([batch, patches, PATCH * CHANNELS], &mut rng);
    (emg, random([batch, patches, LOOK_BACK, CLASSES], &mut rng))
}

/// Asserts equality up to rounding, relative to the largest value.
fn assert_close(found: &[f32], expected: &[f32], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(0.0_f32, |a, b| a.max(b.abs()));
    // The bias of a single key has no effect: its gradient is only rounding errors.
    let largest = largest.max(0.01);
    for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).abs() <= 1e-5 * largest,
            "{what}, value {at}: {found}, not {expected} (largest {largest})"
        );
    }
}

/// Computes the logits, and the gradient of each parameter.
fn run(
    student: &Student,
    (emg, weights): &(Tensor<3>, Tensor<4>),
    forward: fn(&Student, Tensor<3>) -> Tensor<4>,
) -> (Vec<f32>, Vec<(String, Vec<f32>)>) {
    let student = student.clone().train();
    let logits = forward(&student, emg.clone().autodiff());
    let gradients = (logits.clone() * weights.clone().autodiff())
        .sum()
        .backward();
    let mut collected = Collect {
        gradients: GradientsParams::from_grads(gradients, &student),
        path: Vec::new(),
        found: Vec::new(),
    };
    student.visit(&mut collected);
    (read_back(logits.inner()), collected.found)
}

struct Collect {
    gradients: GradientsParams,
    path: Vec<String>,
    found: Vec<(String, Vec<f32>)>,
}

impl ModuleVisitor for Collect {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let name = self.path.join(".");
        let gradient = self.gradients.get::<D>(param.id);
        let gradient = gradient.unwrap_or_else(|| panic!("no gradient of {name}"));
        self.found.push((name, read_back(gradient)));
    }

    fn enter_module(&mut self, name: &str, _container_type: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _name: &str, _container_type: &str) {
        self.path.pop();
    }
}

fn both_agree(config: &StudentConfig, batch: usize, patches: usize) {
    let student = student(config);
    let inputs = inputs(batch, patches);
    assert!(super::forward(&student, &inputs.0).is_some());
    let (found, found_gradients) = run(&student, &inputs, Student::forward);
    let (expected, gradients) = run(&student, &inputs, Student::portable);
    assert_close(&found, &expected, &format!("{config:?}, {patches} patches"));
    assert_eq!(gradients.len(), 6 + 13 * config.layers);
    for ((name, found), (_, expected)) in found_gradients.iter().zip(&gradients) {
        let what = format!("{config:?}, {patches} patches, {name}");
        assert_close(found, expected, &what);
    }
}

#[test]
fn logits_and_gradients_are_those_of_burns_operations() {
    // A whole block of queries, one query more, fewer patches than the span, a single one.
    for patches in [16, 17, 5, 1] {
        both_agree(&config(32, 1, 7), 2, patches);
    }
    for patches in [120, 61, 26] {
        both_agree(&config(64, 2, 27), 3, patches);
    }
    for d_model in [16, 48, 96, 128] {
        both_agree(&config(d_model, 2, 20), 1, 33);
    }
    let span_of_one = StudentConfig {
        companding: Companding::Linear,
        ..config(32, 2, 1)
    };
    both_agree(&span_of_one, 1, 20);
}

#[test]
fn without_gradients_the_logits_are_the_same() {
    let student = student(&config(64, 2, 27));
    let (emg, _) = inputs(10, 50);
    assert!(super::forward(&student, &emg).is_some());
    let found = read_back(student.forward(emg.clone()));
    assert_close(&found, &read_back(student.portable(emg)), "logits");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let student = student(&config(32, 2, 9));
    let inputs = inputs(21, 30);
    let with = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads for the test");
        pool.install(|| run(&student, &inputs, Student::forward))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn other_widths_are_left_to_burns_operations() {
    let student = student(&config(40, 1, 9));
    let (emg, _) = inputs(1, 30);
    assert!(super::forward(&student, &emg).is_none());
    assert_eq!(student.forward(emg).dims(), [1, 30, LOOK_BACK, CLASSES]);
}
