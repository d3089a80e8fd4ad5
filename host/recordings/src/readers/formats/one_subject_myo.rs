//! `one-subject-myo`: csv of eight whole numbers, no header; classes in `metadata.json` beside it.
//!
//! LibEMG writes all recordings in this layout. The published ones are recognised by their samples, wherever they lie.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;
use shared::units::Sample;

use super::libemg::class_name;
use crate::catalogue::DataSet;
use crate::labels::motion::Motion;
use crate::readers::error::{Damage, Fault};
use crate::readers::path::{folder, stem};
use crate::recording::{Recording, Timing};

/// A file whose hold starts late, and the sample at which it does.
const LATE_HOLD: (&str, usize) = ("trial_1/R_1_C_3.csv", 60);

/// Whether these are the samples of a published recording.
pub(crate) fn is_published(samples: &[Sample]) -> bool {
    PUBLISHED.binary_search(&checksum(samples)).is_ok()
}

/// FNV-1a of samples, 64 bits.
fn checksum(samples: &[Sample]) -> u64 {
    samples
        .iter()
        .flatten()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &value| {
            (hash ^ u64::from(value.cast_unsigned())).wrapping_mul(0x0100_0000_01b3)
        })
}

/// Reads a published recording; `metadata` is the text of the `metadata.json` in its folder, if there is one.
pub(crate) fn read(
    path: &Path,
    samples: Vec<Sample>,
    metadata: Option<&str>,
) -> Result<Recording, Damage> {
    let session = folder(path, 1).unwrap_or_default();
    let class = metadata.and_then(|text| class_name(text, path));
    let intent = class.as_deref().map(intent).transpose()?.flatten();
    let mut labels = vec![intent; samples.len()];
    let mut notes = Vec::new();
    if class.is_none() {
        notes.push("no labels: no metadata.json names its class".to_owned());
    } else if path.ends_with(LATE_HOLD.0) {
        let before = LATE_HOLD.1.min(labels.len());
        labels[..before].fill(None);
        notes.push("the hold starts 0.3 s late; unlabelled until then".to_owned());
    }
    Ok(Recording {
        data_set: DataSet::named("one-subject-myo"),
        subject: "one-subject-myo/1".to_owned(),
        name: format!("{session}/{}", stem(path).unwrap_or_default()),
        path: path.to_owned(),
        samples,
        labels,
        notes,
        other_movement: Vec::new(),
        timing: Timing::Cues,
        findings: Vec::new(),
        wearer: Normalizer::new(),
    })
}

fn intent(class: &str) -> Result<Option<Intent>, Damage> {
    let expected = "No_Motion, Hand_Open, Hand_Close, Wrist_Flexion, Wrist_Extension";
    match Motion::of_gesture(class) {
        Some(motion) => Ok(motion.label()),
        None => Err(Damage::of_file(Fault::Label {
            expected,
            found: class.to_owned(),
        })),
    }
}

/// Checksums of the published recordings, ascending.
#[rustfmt::skip]
const PUBLISHED: [u64; 61] = [
    0x039a_17fb_6c9d_15bf, 0x0456_9916_3493_68c2, 0x0510_75bc_24b8_5377, 0x074c_1987_e410_322c,
    0x07cd_b52a_e07e_5d80, 0x0fed_3757_466a_3c38, 0x1ab9_de24_8f0b_ec1d, 0x1d29_8201_9c9d_c6b3,
    0x2283_8e13_fcf8_3a16, 0x2cc0_c7a3_3e03_cf4f, 0x321b_c139_2870_c9bf, 0x32c9_72aa_b684_c8e1,
    0x4705_def8_7aae_745c, 0x470f_0294_d802_85af, 0x485d_f689_e15b_81b6, 0x4958_f767_7255_83f2,
    0x4a10_a0f6_6786_26f6, 0x4c33_0458_b6ad_6281, 0x50cb_af07_5be1_1b86, 0x571e_62a8_9af8_8c37,
    0x5be3_1b7c_e0d8_1d24, 0x5cc4_0627_6c5a_be39, 0x5efc_1435_c3cd_9292, 0x6d4d_bb12_3c7d_9959,
    0x7241_9101_95d3_2024, 0x7775_6ef3_b6c8_2b75, 0x7a47_16c4_0ba5_973e, 0x8632_7dd8_3019_7b7b,
    0x8687_798b_f961_4e8c, 0x8c2a_b005_dc23_85f4, 0x8e57_4840_4005_e4ab, 0x8ed3_7fc0_8e54_7def,
    0x8fae_1476_4936_19dd, 0x92fa_4709_ab2b_8f04, 0x939b_ea32_eabd_55ae, 0x9a30_438c_4092_3eee,
    0x9b10_4399_b9e0_1df6, 0x9f9c_588c_71d5_30e2, 0xa268_cc29_9699_1cde, 0xa921_b3ee_5929_00f6,
    0xad26_8645_503b_2ebf, 0xaf49_ad03_3ad4_0ac4, 0xafed_9e28_171b_6d8c, 0xb4b7_34e1_f70c_fb15,
    0xb506_fb06_7802_9994, 0xc74b_d4ca_5347_d301, 0xc7de_ad7a_cffb_3920, 0xc826_19a9_b751_28c0,
    0xcd7d_8198_7c3a_156f, 0xce57_4557_5a39_eac9, 0xcff5_2027_b9c4_0753, 0xd002_fd3a_14fd_4e82,
    0xd0f8_0591_4af0_6426, 0xd4ae_91ea_d8c7_2a46, 0xd85b_fc44_c5ec_b19f, 0xdb2e_49a5_bceb_601b,
    0xdcdd_3b63_e875_27e6, 0xe336_1a4b_e904_3b67, 0xe60d_fc84_cebb_d46e, 0xe8d6_816f_321e_e7fc,
    0xea09_1144_e77d_0d48,
];

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{"continuous": false,
        "data/subject1/sgt/trial_1/R_1_C_3.csv": {"class_idx": 3, "class_name": "Wrist_Extension"}}"#;

    #[test]
    fn the_class_comes_from_the_metadata() {
        let samples = vec![[1, 2, 3, 4, 5, 6, 7, -8]; 100];
        let read = |path: &str| read(Path::new(path), samples.clone(), Some(METADATA)).unwrap();
        let hold = read("/d/trial_2/R_1_C_3.csv");
        assert_eq!(hold.labels, [Some(Intent::WaveOut); 100]);
        let late = read("/d/trial_1/R_1_C_3.csv");
        assert_eq!(
            (late.labels[59], late.labels[60]),
            (None, Some(Intent::WaveOut))
        );
        assert!(!read("/d/stream/raw_emg.csv").has_labels());
    }

    #[test]
    fn checksums_are_those_of_fnv_and_in_order() {
        // "foobarfo", from the reference implementation's rule.
        assert_eq!(checksum(&[]), 0xcbf2_9ce4_8422_2325);
        let naive = b"foobarfo"
            .iter()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        assert_eq!(checksum(&[b"foobarfo".map(|byte| byte as i8)]), naive);
        assert!(PUBLISHED.is_sorted());
        assert!(!is_published(&[[1; 8]]));
    }
}
