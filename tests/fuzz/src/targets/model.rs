//! Model file, with length and checksum made right: an accepted file runs, and gives only numbers.

use std::cell::RefCell;
use std::sync::LazyLock;

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use shared::calibration::from_record;
use shared::intent::{MAX_LOGITS, Vocabulary};
use shared::model::Encode;
use shared::model::dimensions::Dimensions;
use shared::model::encoder::{DeviceEncoder, DeviceState, HostEncoder};
use shared::model::file::{Model, random};
use shared::stream::alignment::{Alignment, Profile, TEMPLATE_BYTES, Template};
use shared::stream::smoother::Smoother;
use shared::units::{LOOK_BACK, Patch, SampleIndex};

use crate::input::Input;

/// Bytes of magic, version and length.
const PREFIX: usize = 13;
const CHECKSUM: usize = 4;
/// Checksum with a table that is made once and takes sixteen bytes at a time: a model is long.
static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);
/// Bytes in which the header ends, roughly: half of all changes go there.
const HEADER: usize = 320;
/// Numbers that a trained model does not have.
const WILD: [f32; 16] = [
    0.0,
    -0.0,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    100.0,
    -100.0,
    100.00001,
    1e10,
    1e-38,
    50.0,
    -1e-3,
];

/// Models of the smallest dimensions, and of the longest span.
static BASES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let dimensions = [
        (16, 1, 1, Vocabulary::Three),
        (16, 2, 3, Vocabulary::Five),
        (24, 3, 2, Vocabulary::Six),
        (16, 1, 32, Vocabulary::Three),
    ];
    let models = dimensions.map(|(width, layers, span, vocabulary)| {
        let dimensions = Dimensions {
            other: span < 4,
            ..Dimensions::new(vocabulary, width, layers, span)
        };
        let model = random::random_model(dimensions, width as u64 + span as u64);
        model.to_bytes().expect("a model as the trainer writes it")
    });
    models.to_vec()
});

thread_local! {
    /// Encoder states, made once: they are large.
    static STATES: RefCell<(Box<HostState>, Box<DeviceState>)> = {
        let model = Model::parse(&BASES[0]).expect("a model");
        let host = HostEncoder::new(&model).expect("room for every model").fresh();
        RefCell::new((Box::new(host), Box::new(DeviceState::fresh())))
    };
}

type HostState = <HostEncoder<'static> as Encode>::State;

/// Takes the record of a calibration, unchanged and with model and checksum made right: an accepted one gives only numbers.
pub fn calibration(data: &[u8]) {
    let model = Model::parse(&BASES[0]).expect("a model");
    let mut words = vec![u32::MAX; 1024];
    let page: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
    let length = data.len().min(page.len());
    page[..length].copy_from_slice(&data[..length]);
    check_record(page, &model);
    page[8..12].copy_from_slice(&model.checksum.to_le_bytes());
    let outputs = usize::from(page[6]);
    let end = 12 + outputs.next_multiple_of(4) * usize::from(page[5]) + 8 * outputs;
    if end + CHECKSUM <= page.len() {
        let sum = CRC.checksum(&page[..end]);
        page[end..][..CHECKSUM].copy_from_slice(&sum.to_le_bytes());
        check_record(page, &model);
    }
}

fn check_record(page: &[u8], model: &Model<'_>) {
    let Ok(head) = from_record(page, model) else {
        return;
    };
    assert!(page.starts_with(b"MyoC\x01"), "a record");
    let mut encoder = DeviceEncoder::new(model).expect("a small model");
    encoder.set_head(head);
    STATES.with_borrow_mut(|(_, state)| {
        encoder.reset(state);
        for level in [0, 1, 128, 77] {
            let rows = encoder.step(state, &[[level; 8]; 10]);
            assert!(rows.as_flattened().iter().all(|logit| logit.is_finite()));
        }
    });
}

/// Takes a byte for the kind: a file unchanged, the bytes between prefix and checksum, or changes of a whole model.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let kind = input.byte();
    let file = match kind {
        0 => input.0.to_vec(),
        1 => {
            let mut file = BASES[0][..PREFIX].to_vec();
            file.extend(input.0);
            sealed(file)
        }
        _ => changed(&mut input),
    };
    // The file is read as words: it begins at a multiple of four.
    let mut words = vec![0_u32; file.len().div_ceil(4)];
    let region: &mut [u8] = as_bytes(&mut words);
    region[..file.len()].copy_from_slice(&file);
    check(&region[..file.len()]);
}

fn as_bytes(words: &mut [u32]) -> &mut [u8] {
    bytemuck::cast_slice_mut(words)
}

/// Returns a file with length and checksum.
fn sealed(mut file: Vec<u8>) -> Vec<u8> {
    let length = (file.len() + CHECKSUM) as u32;
    file[9..PREFIX].copy_from_slice(&length.to_le_bytes());
    let sum = CRC.checksum(&file);
    file.extend(sum.to_le_bytes());
    file
}

/// Returns a model with bytes changed, numbers replaced, and pieces inserted and removed.
fn changed(input: &mut Input<'_>) -> Vec<u8> {
    let base = &BASES[input.below(4)];
    let mut file = base[..base.len() - CHECKSUM].to_vec();
    while !input.is_empty() {
        let kind = input.byte();
        let [low, high] = input.array();
        let mut at = PREFIX + usize::from(u16::from_le_bytes([low, high]));
        if kind & 0x80 != 0 {
            at %= HEADER;
        }
        let at = at % file.len();
        match kind % 8 {
            0 | 1 => file[at] = input.byte(),
            2 | 3 => {
                let wild = WILD[input.below(WILD.len())].to_le_bytes();
                let count = wild.len().min(file.len() - at);
                // Tensors begin at multiples of four.
                let at = at / 4 * 4;
                file[at..at + count].copy_from_slice(&wild[..count]);
            }
            4 => {
                let piece = input.take(4);
                file.splice(at..at, piece.iter().copied());
            }
            5 => {
                let end = (at + input.below(8)).min(file.len());
                file.drain(at..end);
                file.resize(file.len().max(PREFIX), 0);
            }
            6 => file[at] = file[at].wrapping_add(1),
            // All numbers from here on are replaced: a tensor and more.
            _ => {
                let wild = WILD[input.below(WILD.len())].to_le_bytes();
                let end = (at / 4 * 4 + 4 * usize::from(input.byte())).min(file.len());
                for word in file[at / 4 * 4..end].chunks_exact_mut(4) {
                    word.copy_from_slice(&wild);
                }
            }
        }
    }
    let trailing = file.len() % 3;
    let mut file = sealed(file);
    file.resize(file.len() + trailing, 0xff);
    file
}

fn check(region: &[u8]) {
    let model = match Model::parse(region) {
        Ok(model) => model,
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 250, "{message}");
            return;
        }
    };
    assert!(model.length <= region.len());
    let provenance = model.header.provenance;
    assert!(
        provenance
            .metrics
            .iter()
            .all(|(_, value)| value.is_finite())
    );
    let _ = provenance.data_sets.iter().count() + provenance.subjects_seen.iter().count();
    if let Some(template) = model.header.template {
        let _ = template.fit(Profile::new([1, 2, 3, 4, 5, 6, 7, 8000]));
    }
    let without = Model::with_template(&region[..model.length], None);
    let without = without.expect("the same without a template");
    let without = Model::parse(&without).expect("a model");
    assert!(without.header.template.is_none());
    assert_eq!(without.header.dimensions, model.header.dimensions);
    STATES.with_borrow_mut(|(host, device)| encode(&model, host, device));
}

/// Runs the model over the strongest and the weakest possible inputs.
fn encode(model: &Model<'_>, host: &mut HostState, device: &mut DeviceState) {
    let encoder = HostEncoder::new(model).expect("room for every model");
    let on_device = DeviceEncoder::new(model).ok();
    let classes = encoder.classes();
    let outputs = model.header.dimensions.row_outputs();
    let settings = model.header.smoother.in_patches();
    let smoother = Smoother::<MAX_LOGITS, LOOK_BACK>::new(settings, classes);
    let mut smoother = smoother.expect("settings that were checked");
    encoder.reset(host);
    device.reset();
    for number in 0..8 {
        let rows = encoder.step(host, &patch(number));
        for row in rows {
            assert!(row.iter().all(|logit| logit.is_finite()), "{row:?}");
            assert!(row[outputs..].iter().all(|&logit| logit == 0.0));
        }
        if let Some(on_device) = &on_device {
            assert_eq!(
                on_device.step(device, &patch(number)),
                rows,
                "as on the device"
            );
        }
        if let Some(decision) = smoother.push(SampleIndex(number), &rows) {
            assert!(decision.class < classes);
        }
    }
}

/// Returns a patch: silence, the strongest signal, or between.
fn patch(number: u32) -> Patch {
    std::array::from_fn(|sample| {
        std::array::from_fn(|channel| match number {
            0 => 0,
            1 => 128,
            2 => 255,
            3 => 128 * ((sample + channel) % 2) as u8,
            _ => (number as usize * 37 + sample * 17 + channel * 5) as u8 % 129,
        })
    })
}

/// Takes the alignment template of a model file, then the mean activity of eight electrodes.
pub fn template(data: &[u8]) {
    let _ = Template::from_bytes(data);
    let mut input = Input(data);
    let bytes: [u8; TEMPLATE_BYTES] = input.array();
    let means = [(); 8].map(|()| input.word());
    let Ok(template) = Template::from_bytes(&bytes) else {
        return;
    };
    assert_eq!(template.to_bytes(), bytes, "what is read is written back");
    let profile = Profile::new(means);
    assert!(
        profile
            .values()
            .into_iter()
            .all(|value| (-1793..=1794).contains(&value))
    );
    let fits = template.fit(profile);
    let fit = fits.nearest;
    for arm in [fit, fits.other_arm] {
        assert!(Alignment::all().any(|one| one == arm.alignment));
    }
    assert_ne!(
        fit.alignment.mirrored(),
        fits.other_arm.alignment.mirrored()
    );
    assert_eq!(fits.lead(), fits.other_arm.distance - fit.distance);
    // An armband turned by the answer needs no further turn and fits as well as before; so does the other arm.
    let turned = fit.alignment.apply(means);
    let again = template.fit(Profile::new(turned));
    assert_eq!(again.nearest.distance, fit.distance);
    assert_eq!(again.other_arm.distance, fits.other_arm.distance);
}
