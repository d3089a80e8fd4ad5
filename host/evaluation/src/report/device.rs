//! Cost of a model file on a board.

use shared::model::encoder::DeviceEncoder;
use shared::model::file::Model;
use shared::units::{PATCH, SAMPLE_PERIOD_MS};

use super::Table;

/// Flash that a board keeps for a model file, in KiB (memory.x).
const FLASH_KIB: f64 = 160.0;
/// Clock of the boards, instructions at one cycle each.
const CLOCK_HZ: f64 = 64e6;
/// Cycles per instruction, estimated for the shipped model without wait states: 190 900 cycles, 124 342 instructions.
const CYCLES: f64 = 1.535;

/// Bytes of the encoder's state on a board, whatever the model; on a PC, whose addresses are longer, it has a few more.
const STATE: usize = 17_960;

/// Instructions of the whole pipeline for a patch: width, layers, span, classes, other movement known, count.
///
/// Counted by `cargo xtask count --model FILE` on the emulated Cortex-M4F; docs/budgets.md. The first is the committed
/// count.
const COUNTED: [(usize, usize, usize, usize, bool, u32); 3] = [
    (64, 2, 27, 3, true, 124_342),
    (64, 2, 27, 5, false, 125_072),
    (64, 2, 27, 6, false, 125_280),
];

/// The cost of one model.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Device {
    name: String,
    file: usize,
    width: usize,
    layers: usize,
    span: usize,
    /// Reason why a board refuses the model; none if it runs it.
    refused: Option<String>,
    /// Bytes of the encoder's state on a board, whatever the model.
    state: usize,
    instructions: Option<u32>,
}

impl Device {
    /// Cost of a model file; none if the file is invalid.
    pub(super) fn of(name: &str, bytes: &[u8]) -> Option<Self> {
        let model = Model::parse(bytes).ok()?;
        let dimensions = &model.header.dimensions;
        let own = (
            dimensions.width,
            dimensions.layers,
            dimensions.span,
            dimensions.vocabulary.classes(),
            dimensions.other,
        );
        let counted = COUNTED
            .iter()
            .find(|of| (of.0, of.1, of.2, of.3, of.4) == own);
        let encoder = DeviceEncoder::new(&model);
        Some(Self {
            name: name.to_owned(),
            file: model.length,
            width: dimensions.width,
            layers: dimensions.layers,
            span: dimensions.span,
            state: STATE,
            refused: encoder.err().map(|error| error.to_string()),
            instructions: counted.map(|of| of.5),
        })
    }
}

/// Table with a row for each model.
pub(super) fn table(devices: &[Device]) -> Table {
    let caption = "Flash: of 160 KiB that a board keeps for a model. State: RAM of the encoder, the same for every model. Instructions: the whole \
                   pipeline, sample to label, for a patch of 10 samples (50 ms); time: estimated, at 64 MHz without wait states";
    let mut table = Table::new(
        caption,
        [
            "model",
            "width x layers x span",
            "flash KiB",
            "of 160",
            "state KiB",
            "instructions",
            "time ms",
            "of the core",
            "runs on a board",
        ],
    );
    for own in devices {
        let kib = own.file as f64 / 1024.0;
        let time = own
            .instructions
            .map(|count| f64::from(count) * CYCLES / CLOCK_HZ * 1e3);
        let patch = f64::from(SAMPLE_PERIOD_MS) * PATCH as f64;
        table.push([
            own.name.clone(),
            format!("{} x {} x {}", own.width, own.layers, own.span),
            format!("{kib:.1}"),
            format!("{:.0} %", 100.0 * kib / FLASH_KIB),
            format!("{:.1}", own.state as f64 / 1024.0),
            own.instructions
                .map_or_else(|| "-".to_owned(), |count| count.to_string()),
            time.map_or_else(|| "-".to_owned(), |time| format!("{time:.1}")),
            time.map_or_else(
                || "-".to_owned(),
                |time| format!("{:.0} %", 100.0 * time / patch),
            ),
            own.refused.clone().unwrap_or_else(|| "yes".to_owned()),
        ]);
    }
    table
}

/// Whether the instructions of every model are known.
pub(super) fn all_counted(devices: &[Device]) -> bool {
    devices.iter().all(|own| own.instructions.is_some())
}

#[cfg(test)]
mod tests {
    use shared::intent::Vocabulary;
    use shared::model::dimensions::Dimensions;
    use shared::model::file::random::random_model;

    use super::*;

    fn device(width: usize, other: bool) -> Device {
        let dimensions = Dimensions {
            width,
            layers: 2,
            span: 27,
            vocabulary: Vocabulary::Three,
            other,
        };
        let bytes = random_model(dimensions, 1).to_bytes().unwrap();
        Device::of("m", &bytes).unwrap()
    }

    #[test]
    fn the_shipped_shape_has_the_committed_count_and_others_none() {
        let committed = include_str!("../../../../tests/device/instructions.txt");
        let line = |name: &str| {
            let of = |line: &str| line.strip_prefix(name).map(|rest| rest.trim().to_owned());
            committed.lines().find_map(of).unwrap()
        };
        let shipped = device(64, true);
        let total = line("total").split(' ').next().unwrap().to_owned();
        assert_eq!(shipped.instructions.unwrap().to_string(), total);
        assert_eq!(shipped.state.to_string(), line("state"));
        assert_eq!(device(48, true).instructions, None);
        assert_eq!(device(64, false).instructions, None);
        let row = &table(&[shipped]).rows[0];
        assert_eq!(row[6..], ["3.0", "6 %", "yes"]);
    }

    #[test]
    fn a_model_that_no_board_runs_says_why() {
        let row = &table(&[device(96, true)]).rows[0];
        assert!(row[8].contains("96"), "{}", row[8]);
        assert_eq!(row[5], "-");
    }
}
