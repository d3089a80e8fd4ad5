//! The emulated core beside another one, unicorn's: random instructions on random registers.
//!
//! `pip install unicorn`, then `cargo test --test differential -- --ignored`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::Arc;

use rsemu::core::space::{AddressSpace, RamStore, Region};
use rsemu::cpu::arm::v7m::{ArmV7m, Config};
use shared::model::noise::Noise;

const CASES: usize = 10_000;
const CODE: u32 = 0x1000;
/// Bits of xPSR that instructions change: N, Z, C, V, Q and GE.
const FLAGS: u32 = 0xf80f_0000;
const THUMB: u32 = 1 << 24;

/// Instructions: a name, bits that are fixed, and bits that may be anything. Four bits `r` of a register are 0 to 12.
const INSTRUCTIONS: &[(&str, &str)] = &[
    ("shift by a constant", "000 xx xxxxx xxx xxx"),
    ("data processing, 16 bits", "010000 xxxx xxx xxx"),
    ("constant of 8 bits", "001 xx xxx xxxxxxxx"),
    ("extend, 16 bits", "10110010 xx xxx xxx"),
    ("and, bic", "11110 x 0 000x x rrrr 0 xxx rrrr xxxxxxxx"),
    ("orr, orn", "11110 x 0 001x x rrrr 0 xxx rrrr xxxxxxxx"),
    ("eor", "11110 x 0 0100 x rrrr 0 xxx rrrr xxxxxxxx"),
    ("add", "11110 x 0 1000 x rrrr 0 xxx rrrr xxxxxxxx"),
    ("adc, sbc", "11110 x 0 101x x rrrr 0 xxx rrrr xxxxxxxx"),
    ("sub", "11110 x 0 1101 x rrrr 0 xxx rrrr xxxxxxxx"),
    ("rsb", "11110 x 0 1110 x rrrr 0 xxx rrrr xxxxxxxx"),
    (
        "and, bic of a register",
        "1110101 000x x rrrr 0 xxx rrrr xx xx rrrr",
    ),
    (
        "orr, orn of a register",
        "1110101 001x x rrrr 0 xxx rrrr xx xx rrrr",
    ),
    (
        "add of a register",
        "1110101 1000 x rrrr 0 xxx rrrr xx xx rrrr",
    ),
    (
        "adc, sbc of a register",
        "1110101 101x x rrrr 0 xxx rrrr xx xx rrrr",
    ),
    ("pkh", "1110101 0110 0 rrrr 0 xxx rrrr xx x0 rrrr"),
    ("movw", "11110 x 100100 xxxx 0 xxx rrrr xxxxxxxx"),
    ("movt", "11110 x 101100 xxxx 0 xxx rrrr xxxxxxxx"),
    ("ssat, usat", "11110 0 11x0x0 rrrr 0 xx1 rrrr xx 0 xxxxx"),
    (
        "ssat16, usat16",
        "11110 0 11x010 rrrr 0 000 rrrr 00 00 xxxx",
    ),
    ("sbfx, ubfx", "11110 0 11x100 rrrr 0 0xx rrrr xx 0 0xxxx"),
    (
        "shift by a register",
        "11111010 0 xx x rrrr 1111 rrrr 0000 rrrr",
    ),
    ("extend and add", "11111010 0 00x rrrr 1111 rrrr 10 xx rrrr"),
    (
        "extend bytes and add",
        "11111010 0 10x rrrr 1111 rrrr 10 xx rrrr",
    ),
    (
        "extend pairs and add",
        "11111010 0 01x rrrr 1111 rrrr 10 xx rrrr",
    ),
    (
        "parallel, halfwords",
        "11111010 1 x01 rrrr 1111 rrrr 0x 0x rrrr",
    ),
    (
        "parallel, bytes",
        "11111010 1 x00 rrrr 1111 rrrr 0x 0x rrrr",
    ),
    (
        "parallel, exchanged",
        "11111010 1 x10 rrrr 1111 rrrr 0x 0x rrrr",
    ),
    (
        "parallel, halved",
        "11111010 1 x00 rrrr 1111 rrrr 0x 10 rrrr",
    ),
    ("qadd, qsub", "11111010 1 000 rrrr 1111 rrrr 10 xx rrrr"),
    ("sel", "11111010 1 010 rrrr 1111 rrrr 1000 rrrr"),
    ("mla, mls", "11111011 0000 rrrr rrrr rrrr 000x rrrr"),
    ("smlaxy", "11111011 0001 rrrr rrrr rrrr 00xx rrrr"),
    ("smlad", "11111011 0010 rrrr rrrr rrrr 000x rrrr"),
    ("smlaw", "11111011 0011 rrrr rrrr rrrr 000x rrrr"),
    ("smlsd", "11111011 0100 rrrr rrrr rrrr 000x rrrr"),
    ("smmla, smmls", "11111011 0101 rrrr rrrr rrrr 000x rrrr"),
    ("usada8", "11111011 0111 rrrr rrrr rrrr 0000 rrrr"),
    ("sdiv, udiv", "11111011 10x1 rrrr 1111 rrrr 1111 rrrr"),
    ("smull, umull", "11111011 10x0 rrrr 0xx0 10x1 0000 rrrr"),
    ("smlal, umlal", "11111011 11x0 rrrr 0xx0 10x1 0000 rrrr"),
    ("smlalxy", "11111011 1100 rrrr 0xx0 10x1 10xx rrrr"),
    ("smlald, smlsld", "11111011 110x rrrr 0xx0 10x1 110x rrrr"),
    ("umaal", "11111011 1110 rrrr 0xx0 10x1 0110 rrrr"),
    ("vmla, vmls", "11101110 0x00 xxxx xxxx 1010 xx x0 xxxx"),
    ("vnmla, vnmls", "11101110 0x01 xxxx xxxx 1010 xx x0 xxxx"),
    ("vmul, vnmul", "11101110 0x10 xxxx xxxx 1010 xx x0 xxxx"),
    ("vadd, vsub", "11101110 0x11 xxxx xxxx 1010 xx x0 xxxx"),
    ("vdiv", "11101110 1x00 xxxx xxxx 1010 x0 x0 xxxx"),
    ("vfma, vfms", "11101110 1x10 xxxx xxxx 1010 xx x0 xxxx"),
    ("vabs", "11101110 1x11 0000 xxxx 1010 11 x0 xxxx"),
    ("vneg, vsqrt", "11101110 1x11 0001 xxxx 1010 x1 x0 xxxx"),
    ("vcmp", "11101110 1x11 0100 xxxx 1010 x1 x0 xxxx"),
    (
        "vcvt from an integer",
        "11101110 1x11 1000 xxxx 1010 x1 x0 xxxx",
    ),
    (
        "vcvt to an integer",
        "11101110 1x11 110x xxxx 1010 x1 x0 xxxx",
    ),
];

struct Case {
    name: &'static str,
    code: Vec<u8>,
    /// Registers 0 to 12, xPSR, FPSCR, single-precision registers.
    state: Vec<u32>,
}

struct Draw(Noise);

impl Draw {
    fn below(&mut self, bound: u32) -> u32 {
        (((self.0.signed() + 1.0) * 0.5 * bound as f32) as u32).min(bound - 1)
    }

    /// A word: anything, or one at which arithmetic turns.
    fn word(&mut self) -> u32 {
        match self.below(4) {
            0 => [
                0,
                1,
                0x7fff_ffff,
                0x8000_0000,
                0xffff_ffff,
                0x7fff_8000,
                0x0080_ff7f,
            ][self.below(7) as usize],
            _ => self.below(1 << 16) << 16 | self.below(1 << 16),
        }
    }

    /// A number: ordinary, or an end of the range.
    fn float(&mut self) -> u32 {
        const ENDS: [f32; 6] = [0.0, -0.0, 1.0, f32::INFINITY, f32::MIN_POSITIVE, 3e9];
        match self.below(4) {
            0 => ENDS[self.below(6) as usize].to_bits(),
            1 => self.word(),
            _ => (self.0.signed() * 1e6).to_bits(),
        }
    }

    fn code(&mut self, pattern: &str) -> Vec<u8> {
        let mut bits = String::new();
        let pattern = pattern.replace(' ', "").replace("rrrr", "r");
        for bit in pattern.chars() {
            let _ = match bit {
                'x' => write!(bits, "{}", self.below(2)),
                'r' => write!(bits, "{:04b}", self.below(13)),
                fixed => write!(bits, "{fixed}"),
            };
        }
        let halves = bits.as_bytes().chunks(16).map(|half| {
            let half = std::str::from_utf8(half).unwrap_or_default();
            u16::from_str_radix(half, 2).expect("sixteen bits")
        });
        halves.flat_map(u16::to_le_bytes).collect()
    }

    fn case(&mut self, number: usize) -> Case {
        let (name, pattern) = INSTRUCTIONS[number % INSTRUCTIONS.len()];
        let code = self.code(pattern);
        let mut state: Vec<u32> = (0..13).map(|_| self.word()).collect();
        state.push(self.word() & FLAGS | THUMB);
        state.push(0);
        state.extend((0..32).map(|_| self.float()));
        Case { name, code, state }
    }
}

/// Runs an instruction on the emulated core.
fn run(case: &Case) -> Vec<u32> {
    let flash = Arc::new(RamStore::new(0x2000));
    flash
        .write_at(0, &[0, 0, 0, 0x20, 1, 0x10, 0, 0])
        .expect("in flash");
    flash.write_at(CODE.into(), &case.code).expect("in flash");
    let space = AddressSpace::new("test", 32);
    let region = Region::ram("flash", Arc::clone(&flash));
    space.topology().map(region, 0).expect("free");
    let core = ArmV7m::new(Config::CORTEX_M4F);
    core.attach_space(Arc::new(space));
    core.step();
    core.with_sys(|system| system.write_word(0xe000_ed88, 0xf << 20));
    for (number, value) in (0..13).zip(&case.state) {
        core.set_reg(number, *value);
    }
    core.set_xpsr(case.state[13]);
    core.set_fpscr(case.state[14]);
    for (number, value) in (0..32).zip(&case.state[15..]) {
        core.set_s(number, *value);
    }
    core.step();
    let mut found: Vec<u32> = (0..13).map(|number| core.reg(number)).collect();
    found.extend([core.xpsr(), core.fpscr()]);
    found.extend((0..32).map(|number| core.s(number)));
    found
}

fn words(words: &[u32]) -> String {
    words
        .iter()
        .map(|word| format!("{word:x}"))
        .collect::<Vec<_>>()
        .join(" ")
}

#[test]
#[ignore = "needs Python with unicorn"]
fn random_instructions_do_what_unicorns_do() {
    let mut draw = Draw(Noise(7));
    let cases: Vec<Case> = (0..CASES).map(|number| draw.case(number)).collect();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/differential.py");
    let python = std::env::var("MYOINTENT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let other = Command::new(python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let mut other = other.expect("Python");
    let mut input = String::new();
    for case in &cases {
        let code: String = case.code.iter().map(|byte| format!("{byte:02x}")).collect();
        let _ = writeln!(input, "{code} {}", words(&case.state));
    }
    let mut pipe = other.stdin.take().expect("a pipe");
    let writer = std::thread::spawn(move || pipe.write_all(input.as_bytes()));
    let output = other.wait_with_output().expect("its output");
    writer.join().expect("no panic").expect("it reads all");
    let output = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.lines().count(), CASES, "a line for each instruction");
    let mut differ: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (case, expected) in cases.iter().zip(output.lines()) {
        let mut found = run(case);
        let mut expected: Vec<_> = expected
            .split(' ')
            .map(|word| u32::from_str_radix(word, 16).unwrap_or(!0))
            .collect();
        for state in [&mut found, &mut expected] {
            state
                .get_mut(13)
                .into_iter()
                .for_each(|xpsr| *xpsr &= FLAGS);
        }
        // rsemu 0.0.7 subtracts by adding the negative: a second operand that is no number changes its sign.
        let is_known = |one: u32, two: u32| {
            let is_sign = one ^ two == 1 << 31 && f32::from_bits(one).is_nan();
            is_sign && case.name == "vadd, vsub"
        };
        let places = found.iter().zip(&expected).enumerate();
        let differs = |(one, two): (&u32, &u32)| one != two && !is_known(*one, *two);
        let places: Vec<_> = places.filter(|(_, pair)| differs(*pair)).collect();
        if !places.is_empty() || expected.len() != found.len() {
            let said = format!(
                "{:02x?} on {:x?}: {places:x?}",
                case.code,
                &case.state[..15]
            );
            differ.entry(case.name).or_default().push(said);
        }
    }
    for (name, cases) in &differ {
        println!("{name}: {}, first {}", cases.len(), cases[0]);
    }
    assert!(
        differ.is_empty(),
        "{} kinds of instructions differ",
        differ.len()
    );
}
