//! First inputs of every target, made by the project's own writers. Nothing is cut from recordings.

use std::fs;
use std::path::Path;

use shared::calibration;
use shared::hid::{HidCommand, Output};
use shared::installation::{Block, Transfer};
use shared::intent::{Intent, Vocabulary};
use shared::model::dimensions::Dimensions;
use shared::model::file::{Model, random};
use shared::model::head::Head;
use shared::myo::binding::to_record;
use shared::myo::{Address, Characteristic, Following};
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::lock::LockTimes;
use shared::stream::safe_state::{Cause, Status};
use shared::stream::smoother::{Gate, Reaction};
use shared::stream::strength::Percent;
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::answer::{Answer, Binding, Counts, Identity, Refusal};
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::emg::EmgReport;
use shared::uart_line::gate::GateCommand;
use shared::uart_line::lock::LockCommand;
use shared::uart_line::{Counters, Kind, Report};
use shared::units::SampleIndex;

use crate::radio::{CONTROL, address, advertisement};
use crate::targets::recording::{PAIRS, PATHS};
use presets::BUILT_IN;
pub use recordings::readers::mat::fixture::{compressed, doubles, file, variable};
use recordings::readers::npy::encode;

/// Number of rows of a recording.
const ROWS: usize = 24;

/// Writes a folder for each target.
pub fn write(folder: &Path) -> std::io::Result<()> {
    for (target, seeds) in all() {
        let folder = folder.join(target);
        fs::create_dir_all(&folder)?;
        for (number, seed) in seeds.iter().enumerate() {
            fs::write(folder.join(format!("seed-{number:02}")), seed)?;
        }
    }
    Ok(())
}

fn all() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    vec![
        ("advertisement", advertisements()),
        ("discovery", vec![attributes()]),
        ("notification", vec![notifications()]),
        ("session", sessions()),
        ("binding", vec![to_record(address(7)).to_vec()]),
        ("pipeline", pipelines()),
        ("command", commands()),
        (
            "installation",
            vec![
                [vec![0x10], vec![0x31; 210]].concat(),
                [vec![0x10], vec![0x31; 90], vec![0, 0x10], vec![0x31; 200]].concat(),
            ],
        ),
        ("report", reports()),
        ("model", models()),
        ("template", vec![template()]),
        ("calibration", vec![record()]),
        ("npy", arrays()),
        ("mat", matrices()),
        ("recording", recordings()),
        ("labels", labels()),
        ("preset", presets()),
        ("description", descriptions()),
    ]
}

/// The record of the smallest model's own head.
fn record() -> Vec<u8> {
    let file = smallest(17);
    let model = Model::parse(&file).expect("a model");
    let head = Head::of(&model).expect("a narrow model");
    calibration::to_record(
        &head,
        Alignment::new(3, true),
        model.checksum,
        &mut [0; calibration::RECORD_BYTES],
    )
    .to_vec()
}

fn advertisements() -> Vec<Vec<u8>> {
    let named = [b"\x04\x09Myo\x02\x01\x06", &advertisement()[..]].concat();
    vec![advertisement().to_vec(), named]
}

/// Returns declarations with their values and descriptors, as an armband has them.
fn attributes() -> Vec<u8> {
    let mut seed = Vec::new();
    let mut handle = 1;
    for characteristic in Characteristic::ALL {
        let mut declaration = vec![0x10, handle + 1, 0];
        declaration.extend(characteristic.uuid().to_le_bytes());
        seed.push(declaration.len() as u8);
        seed.extend(declaration);
        // The value is not read; the description comes next, then the descriptor.
        seed.extend([3, b'E', b'M', b'G', 2, 0, 0]);
        handle += 4;
    }
    seed.push(CONTROL.to_le_bytes().len() as u8);
    seed.extend(CONTROL.to_le_bytes());
    seed
}

/// Returns notifications of four lanes in turn, a loss, a swap, a battery level.
fn notifications() -> Vec<u8> {
    let mut seed = vec![0; 4];
    for number in 0..40_u8 {
        seed.extend([number % 4, 10]);
    }
    seed.extend([2, 30, 0, 10, 1, 10, 3, 10, 202, 10, 1, 80]);
    seed
}

fn sessions() -> Vec<Vec<u8>> {
    let set_up = |bits: u8| {
        let mut seed = vec![bits, 0, 0, 0, 0, 31, 0, 17, 1, 2, 0xd8, 31, 220];
        (0..16).for_each(|_| seed.extend([0, 1]));
        (0..30).for_each(|number| seed.extend([8 + number % 4, 10]));
        seed
    };
    let mut paired = set_up(0);
    paired.extend([28, 1, 17, 1, 1, 0xd0, 31, 250, 31, 250, 31, 250, 31, 250]);
    let mut ended = set_up(4);
    ended.extend([27, 1, 29, 1, 1, 31, 201]);
    vec![set_up(2), set_up(4), paired, ended]
}

fn pipelines() -> Vec<Vec<u8>> {
    let samples = |seed: &mut Vec<u8>, count: u8| {
        seed.extend([0x20, count, 3, 9, 27, 81, 243, 217, 139, 161]);
    };
    let mut long = vec![0, 5, 1, 0, 0, 0, 0, 0];
    (0..3).for_each(|_| samples(&mut long, 255));
    let mut lossy = vec![0x31, 5, 1, 2, 0, 0, 0, 0];
    for _ in 0..8 {
        samples(&mut lossy, 100);
        lossy.extend([6, 2]);
    }
    lossy.extend([13, 10, 210, 15, 3, 1]);
    samples(&mut lossy, 200);
    vec![long, lossy]
}

fn commands() -> Vec<Vec<u8>> {
    let commands = [
        Command::Identify,
        Command::Counters,
        Command::Raw(true),
        Command::Imu(true),
        Command::Strength(true),
        Command::Align(AlignCommand::Begin(Arm::Unknown)),
        Command::Align(AlignCommand::Set(Alignment::new(5, true))),
        Command::Align(AlignCommand::State),
        Command::Bind(BindCommand::Set(address(1))),
        Command::Calibrate(CalibrateCommand::Begin { others: true }),
        Command::Bind(BindCommand::Forget),
        Command::Gate(GateCommand::Set(Gate {
            entry: Some(150),
            other: Some(-50),
            reaction: Some(Reaction::Fast),
        })),
        Command::Lock(LockCommand::Set(LockTimes::USUAL)),
        Command::Install(Transfer {
            length: 86_776,
            checksum: 0x577b_d53b,
        }),
        Command::Block(1355, Block(std::array::from_fn(|place| (7 * place) as u8))),
        Command::Align(AlignCommand::Begin(Arm::Known { mirrored: true })),
        Command::Hid(HidCommand::Set(
            Intent::Close,
            Output::from_name("key:space"),
        )),
    ];
    let line = |command: &Command| command.to_string().into_bytes();
    let body = |command: &Command| {
        let line = command.to_string();
        line.as_bytes()[1..line.len() - 5].to_vec()
    };
    let mut seeds: Vec<_> = commands.iter().map(body).collect();
    seeds.push(commands.iter().flat_map(line).collect());
    seeds
}

fn reports() -> Vec<Vec<u8>> {
    let report = Report {
        kind: Kind::Label,
        sequence: 2,
        instant: SampleIndex(609),
        emitted: SampleIndex(660),
        status: Status::Valid(Intent::Close),
        counters: Counters::default(),
        strength: None,
    };
    let strong = Report {
        strength: Percent::new(64),
        ..report
    };
    let safe = Report {
        kind: Kind::State,
        status: Status::Safe(Cause::ModelRefused),
        sequence: u32::MAX,
        ..report
    };
    let alignment = AlignmentReport {
        sequence: 97,
        emitted: SampleIndex(2550),
        state: AlignmentState::Aligned,
        gestures: 2,
        alignment: Alignment::new(5, false),
        quality: Some((214, 1130)),
    };
    let emg = EmgReport {
        first: SampleIndex(1200),
        samples: [
            [0, 1, -1, 127, -128, 5, 6, 7],
            [8, 9, 10, 11, 12, 13, 14, 15],
        ],
    };
    let armband = Address::parse("FA:12:34:56:78:9A").expect("an address");
    let identity = Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "nrf52840-s140",
        model: Some(0x5f3a_0c11),
        armband: Some(armband),
        firmware: None,
        battery: Some(80),
    };
    let binding = Binding {
        following: Following::Bound(armband),
        is_kept: true,
    };
    let lines = [
        report.to_string(),
        safe.to_string(),
        alignment.to_string(),
        emg.to_string(),
        Answer::Identity(identity).to_string(),
        Answer::Counts(Counts::default()).to_string(),
        Answer::Binding(binding).to_string(),
        Answer::Refused(Refusal::Checksum(4)).to_string(),
        strong.to_string(),
    ];
    let bodies = lines.clone().map(|line| line[1..line.len() - 5].to_owned());
    let all = lines.into_iter().chain(bodies);
    all.map(String::into_bytes).collect()
}

fn smallest(seed: u64) -> Vec<u8> {
    let dimensions = Dimensions {
        width: 16,
        layers: 1,
        span: 1,
        vocabulary: Vocabulary::Three,
        other: true,
    };
    let model = random::random_model(dimensions, seed);
    model.to_bytes().expect("a model as the trainer writes it")
}

fn models() -> Vec<Vec<u8>> {
    let file = smallest(1);
    // The bytes lie behind the prefix and before the checksum: the first kilobyte, which ends within a tensor.
    let body = [&[1], &file[13..1024]].concat();
    let changes = (0..8_u8).map(|kind| vec![2, kind % 4, kind | 0x80, 10 * kind, 0, kind, kind]);
    let tensors = (0..8_u8).map(|kind| vec![2, kind % 4, kind, 77 * (kind % 3), kind, kind, 9]);
    let mut seeds: Vec<_> = changes.chain(tensors).collect();
    seeds.push(body);
    seeds
}

fn template() -> Vec<u8> {
    let file = smallest(1);
    // A file in a vector begins at a multiple of four on every platform that fuzzes.
    let model = Model::parse(&file).expect("a model");
    let template = model.header.template.expect("a template");
    let mut seed = template.to_bytes().to_vec();
    seed.extend((1..=8_u32).flat_map(|mean| (mean * 100).to_le_bytes()));
    seed
}

fn arrays() -> Vec<Vec<u8>> {
    vec![
        encode("|i1", &[3, 8], &[7; 24]),
        encode("<f8", &[2, 3], &[0; 48]),
        encode("|S7", &[2], b"rock\0\0\0paper\0\0"),
        encode("<U7", &[1], &[0; 28]),
        encode("<i8", &[0, 8], &[]),
        [&[1, 2, 3, 8][..], &[5; 48]].concat(),
    ]
}

fn matrices() -> Vec<Vec<u8>> {
    let plain = doubles("data", [2, 3], &[1.0, 4.0, 2.0, 5.0, 3.0, -0.5]);
    let small = variable("pulse", [3, 1], 6, 1, &[0, 100, 0x80]);
    let text = variable("note", [1, 2], 4, 4, &[65, 0, 66, 0]);
    let compressed = compressed(&plain);
    vec![
        file(&[compressed, text.clone(), small]),
        [plain, text].concat(),
        b"\x84data\x02\0\0\0\x03\x06\x09\x30\0\0\0\0\0\0\xf0?".to_vec(),
    ]
}

/// Returns a file of each layout, behind the number of its path.
fn recordings() -> Vec<Vec<u8>> {
    let counts = [2_i8, -3, 40, 5, -60, 7, 8, -9].map(i8::cast_unsigned);
    let array = encode("|i1", &[ROWS, 8], &counts.repeat(ROWS));
    let nine = [&[1], &counts[..]].concat();
    let labelled = encode("|i1", &[ROWS, 9], &nine.repeat(ROWS));
    let int16 = |&count: &u8| i16::from(count.cast_signed()).to_le_bytes();
    let words: Vec<u8> = counts.iter().flat_map(int16).collect();
    let uci = "time\tchannel1\tchannel2\tchannel3\tchannel4\tchannel5\tchannel6\tchannel7\tchannel8\tclass\n";
    let row = |at: usize| format!("{}\t1e-05\t{at}e-05\t0\t0\t0\t0\t0\t-1e-05\t2\n", 40 * at);
    let uci = uci.to_owned() + &(0..ROWS).map(row).collect::<String>();
    let emg = "\"ch1\":[1,2],\"ch2\":[1,2],\"ch3\":[1,2],\"ch4\":[1,2],\"ch5\":[1,2],\"ch6\":[1,2],\"ch7\":[1,2],\"ch8\":[1,2]";
    let json = format!(
        "{{\"trainingSamples\":{{\"idx_1\":{{\"gestureName\":\"open\",\"groundTruthIndex\":[1,2],\"emg\":{{{emg}}}}},\
         \"idx_2\":{{\"gestureName\":\"noGesture\",\"emg\":{{{emg}}}}},\"idx_3\":{{\"gestureName\":\"fist\",\
         \"groundTruth\":[0,1],\"emg\":{{{emg}}}}}}},\"testingSamples\":{{}}}}"
    );
    let rows = ROWS as i32;
    let mat = file(&[compressed(&doubles("data", [rows, 8], &[0.5; 8 * ROWS]))]);
    let pulses = file(&[
        variable("emg", [rows, 8], 6, 1, &counts.repeat(ROWS)),
        variable("pulse", [rows, 1], 6, 1, &[100; ROWS]),
    ]);
    let table = |header: &str, row: &str| (header.to_owned() + &row.repeat(ROWS)).into_bytes();
    let files: [Vec<u8>; PATHS.len() - PAIRS.len()] = [
        table(
            "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n",
            "2,1,2,3,4,5,6,7,-128\n",
        ),
        table(
            "index,timestamp,0,1,2,3,4,5,6,7\r\n",
            "0,5,1,2,3,4,5,6,7,8\r\n",
        ),
        uci.into_bytes(),
        b"1,2,3,4,5,6,7,8,7\n".repeat(ROWS),
        b"0.5,0,0,0,0,0,0,-1\n".repeat(ROWS),
        b"5,0,0,0,0,0,0,-1\n".repeat(ROWS),
        words.repeat(ROWS),
        json.into_bytes(),
        array.clone(),
        array.clone(),
        labelled,
        array.clone(),
        array,
        mat,
        pulses,
        b"1,2,3,4,5,6,7,8,3\n".repeat(ROWS),
    ];
    let pairs = pairs().into_iter().map(|[beside, file]| {
        let length = (beside.len() as u16).to_le_bytes();
        [&length[..], &beside, &file].concat()
    });
    let numbered = |(number, file): (usize, Vec<u8>)| [&[number as u8], &file[..]].concat();
    let all = files.into_iter().chain(pairs).enumerate();
    all.map(numbered).collect()
}

/// Returns files, each behind the file that is read beside it.
fn pairs() -> [[Vec<u8>; 2]; PAIRS.len()] {
    let samples = encode("<i8", &[4, 8], &1_i64.to_le_bytes().repeat(32));
    let names = encode("|S7", &[4], b"none\0\0\0paper\0\0rock\0\0\0scissor");
    let numbers = encode("|i1", &[4], &[0, 5, 6, 12]);
    let metadata =
        br#"{"continuous":false,"a/trial_1/R_1_C_3.csv":{"class_name":"Wrist_Extension"}}"#;
    [
        [names, samples.clone()],
        [numbers, samples],
        [metadata.to_vec(), b"1,2,3,4,5,6,7,-8\n".repeat(70)],
    ]
}

/// Returns the built-in presets, and a change of each kind.
fn presets() -> Vec<Vec<u8>> {
    let texts = BUILT_IN.map(|(_, text)| [&[0], text.as_bytes()].concat());
    let changes = (0..8_u8).map(|kind| vec![1 + kind % 3, kind, 9 + kind, 2, kind, b'1']);
    texts.into_iter().chain(changes).collect()
}

/// Returns tables alone, and behind a description of each kind of label.
fn descriptions() -> Vec<Vec<u8>> {
    let row = |at: i32| {
        let counts: Vec<String> = (0..8)
            .map(|channel| ((at * 7 + channel * 3) % 19 - 9).to_string())
            .collect();
        format!(
            "{}.{:03},{},{}\n",
            at / 200,
            at % 200 * 5,
            counts.join(","),
            ["rest", "fist"][at as usize / 40 % 2]
        )
    };
    let rows: String = (0..90).map(row).collect();
    let table = format!("t,a,b,c,d,e,f,g,h,pose\n{rows}");
    let start = "files = \"{person}/{trial}.csv\"\nchannels = [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\"]\nrate = 200\n";
    let labelled = format!(
        "{start}time = \"t\"\nlabel = \"pose\"\nlabels = {{ relax = [\"rest\"], close = [\"fist\"], unknown = [\"*\"] }}\n\
         scale = 1\ntiming = \"muscle\"\n"
    );
    let named = "files = \"{person}/{gesture}.csv\"\nlabels = { open = [1] }\nrate = 200\ntiming = \"from-activity\"\n";
    let texts = ["", start, &labelled, named];
    let before = |text| format!("{text}\0{table}").into_bytes();
    texts.map(before).to_vec()
}

fn labels() -> Vec<Vec<u8>> {
    vec![
        b"relax\nopen\nnone\n-1\n2\n".to_vec(),
        b"time,gt,prediction\n0,1,open\n5,-1,wave-in\n".to_vec(),
        encode("|i1", &[4], &[0, 1, 2, 255]),
        encode("|i1", &[2, 9], &[1; 18]),
        encode("|S7", &[2], b"open\0\0\0close\0\0"),
    ]
}
