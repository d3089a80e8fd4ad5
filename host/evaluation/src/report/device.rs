//! Cost of a model file on a board.

use shared::model::encoder::DeviceEncoder;
use shared::model::file::Model;
use shared::units::{PATCH, SAMPLE_PERIOD_MS};

use super::Table;
use super::cell::none;

/// Flash that a board keeps for a model file, in KiB (memory.x).
const FLASH_KIB: f64 = 160.0;
/// Clock of the boards, instructions at one cycle each.
const CLOCK_HZ: f64 = 64e6;
/// Cycles per instruction, estimated for the shipped model without wait states: 192 600 cycles, 125 525 instructions.
const CYCLES: f64 = 1.535;

/// Bytes of the encoder's state on a board, whatever the model; on a PC, whose addresses are longer, it has a few more.
const STATE: usize = 17_960;

/// Shape of a model: width, layers, span, classes, other movement known.
type Shape = (usize, usize, usize, usize, bool);

/// Instructions of the whole pipeline for a patch, by shape.
///
/// Counted by `cargo xtask count --model FILE` on the emulated Cortex-M4F; docs/budgets.md. The first is the committed
/// count.
const COUNTED: [(Shape, u32); 3] = [
    ((64, 2, 27, 3, true), 126_133),
    ((64, 2, 27, 5, true), 127_342),
    ((64, 2, 27, 6, true), 128_175),
];

/// Column of the instructions in [`table`].
const INSTRUCTIONS: usize = 5;

/// Table with a row for each model, given by name and file; invalid files have none.
pub(super) fn table<'m>(models: impl IntoIterator<Item = (&'m str, &'m [u8])>) -> Table {
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
    let rows = models
        .into_iter()
        .filter_map(|(name, file)| cost(name, file));
    rows.for_each(|row| table.push(row));
    table
}

fn cost(name: &str, file: &[u8]) -> Option<[String; 9]> {
    let model = Model::parse(file).ok()?;
    let own = &model.header.dimensions;
    let (width, layers, span) = (own.width, own.layers, own.span);
    let shape = (width, layers, span, own.vocabulary.classes(), own.other);
    let counted = COUNTED.into_iter().find(|(of, _)| *of == shape);
    let time = counted.map(|(_, count)| f64::from(count) * CYCLES / CLOCK_HZ * 1e3);
    let patch = f64::from(SAMPLE_PERIOD_MS) * PATCH as f64;
    let kib = model.length as f64 / 1024.0;
    let refused = DeviceEncoder::new(&model).err();
    Some([
        name.to_owned(),
        format!("{width} x {layers} x {span}"),
        format!("{kib:.1}"),
        format!("{:.0} %", 100.0 * kib / FLASH_KIB),
        format!("{:.1}", STATE as f64 / 1024.0),
        counted.map_or_else(none, |(_, count)| count.to_string()),
        time.map_or_else(none, |time| format!("{time:.1}")),
        time.map_or_else(none, |time| format!("{:.0} %", 100.0 * time / patch)),
        refused.map_or_else(|| "yes".to_owned(), |error| error.to_string()),
    ])
}

/// Whether the instructions of every model are known.
pub(super) fn all_counted(table: &Table) -> bool {
    table.rows.iter().all(|row| row[INSTRUCTIONS] != none())
}

#[cfg(test)]
mod tests {
    use shared::intent::Vocabulary;
    use shared::model::dimensions::Dimensions;
    use shared::model::file::random::random_model;

    use super::*;

    /// Row of a random model.
    fn row(width: usize, other: bool) -> Vec<String> {
        let dimensions = Dimensions {
            width,
            layers: 2,
            span: 27,
            vocabulary: Vocabulary::Three,
            other,
        };
        let bytes = random_model(dimensions, 1).to_bytes().unwrap();
        table([("m", &bytes[..]), ("damaged", &bytes[1..])])
            .rows
            .remove(0)
    }

    #[test]
    fn the_shipped_shape_has_the_committed_count_and_others_none() {
        let committed = include_str!("../../../../tests/device/instructions.txt");
        let line = |name: &str| {
            let of = |line: &str| line.strip_prefix(name).map(|rest| rest.trim().to_owned());
            committed.lines().find_map(of).unwrap()
        };
        let total = line("total").split(' ').next().unwrap().to_owned();
        assert_eq!(STATE.to_string(), line("state"));
        let shipped = row(64, true);
        assert_eq!(shipped[INSTRUCTIONS..], [&total, "3.0", "6 %", "yes"]);
        assert_eq!(row(48, true)[INSTRUCTIONS], "-");
        assert_eq!(row(64, false)[INSTRUCTIONS], "-");
    }

    #[test]
    fn a_model_that_no_board_runs_says_why() {
        let row = row(96, true);
        assert!(row[8].contains("96"), "{}", row[8]);
        assert_eq!(row[INSTRUCTIONS], "-");
    }
}
