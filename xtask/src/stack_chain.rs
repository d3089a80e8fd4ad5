//! The deepest chain of calls in an image, from its instructions: what no run has to reach to be counted.
//!
//! Frames are what a function's prologue takes from the stack pointer, in all of its branches together. Calls are those with
//! their target in the instruction, tail calls counted as calls. A call through a pointer has no target to follow: the executor's
//! polls of tasks, and the formatting of lines. So the depth of an image is the chain from reset, and the deepest of any
//! function below it, and that of the deepest interrupt.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionKind, SymbolKind};

use crate::address;

/// Bytes that the core pushes before a handler runs: eight words, those of the FPU, and a word for alignment.
const EXCEPTION_FRAME: u64 = 4 * (8 + 18 + 1);

/// A function by what it takes and whom it calls.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
struct Function {
    name: String,
    frame: u64,
    calls: BTreeSet<u64>,
}

/// The deepest chains of an image.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Chain {
    /// Bytes of it all.
    pub bytes: u64,
    /// The deepest chain below the executor, caller first: mangled names and frames.
    pub functions: Vec<(String, u64)>,
}

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "deepest chain of calls, {} bytes with reset, executor and an interrupt:",
            self.bytes
        )?;
        let large = self.functions.iter().filter(|(_, frame)| *frame >= 64);
        large
            .into_iter()
            .try_for_each(|(name, frame)| write!(f, "\n{frame:>8}  {name}"))
    }
}

/// Follows the calls of an image.
pub fn deepest(elf: &[u8]) -> Result<Chain> {
    let file = object::File::parse(elf).context("not an ELF image")?;
    let functions = functions(&file)?;
    let depths = Depths::of(&functions);
    let named = |name: &str| {
        let function = functions.iter().find(|(_, function)| function.name == name);
        function.map(|(&at, _)| at)
    };
    let reset = named("Reset").context("no function Reset: the image cannot be checked")?;
    let vectors = file
        .section_by_name(".vector_table")
        .context("no vector table")?;
    let handlers = vectors.data()?.as_chunks::<4>().0.iter();
    let handlers = handlers
        .skip(2)
        .map(|word| u64::from(u32::from_le_bytes(*word)) & !1);
    let interrupt = handlers.map(|at| depths.of_function(at)).max().unwrap_or(0);
    let (deepest, chain) = depths.0.values().max().context("no functions")?;
    Ok(Chain {
        bytes: depths.of_function(reset) + deepest + EXCEPTION_FRAME + interrupt,
        functions: chain
            .iter()
            .map(|at| (functions[at].name.clone(), functions[at].frame))
            .collect(),
    })
}

/// Addresses of the stack in an image, the guard's with them.
pub fn stack(elf: &[u8]) -> Result<Range<u32>> {
    Ok(address(elf, "_stack_end")?..address(elf, "_stack_start")?)
}

/// Deepest chains of calls, by the function that they begin with: bytes and functions. A call back to a caller adds nothing:
/// what recurses is not counted.
struct Depths(BTreeMap<u64, (u64, Vec<u64>)>);

impl Depths {
    fn of(functions: &BTreeMap<u64, Function>) -> Self {
        // Functions that call each other in a circle reach the same ones. Those that they call reach fewer: they come first.
        let mut circles: BTreeMap<_, BTreeSet<u64>> = BTreeMap::new();
        for &at in functions.keys() {
            let reached = reached(functions, at);
            let circle = circles.entry((reached.len(), reached)).or_default();
            circle.insert(at);
        }
        let mut depths = Self(BTreeMap::new());
        for circle in circles.values() {
            let follow = |&at| (at, depths.follow(functions, at, circle.clone()));
            let followed: Vec<_> = circle.iter().map(follow).collect();
            depths.0.extend(followed);
        }
        depths
    }

    /// Follows a function through its circle, but for its callers, and out of the circle.
    fn follow(
        &self,
        functions: &BTreeMap<u64, Function>,
        at: u64,
        mut circle: BTreeSet<u64>,
    ) -> (u64, Vec<u64>) {
        circle.remove(&at);
        let function = &functions[&at];
        let calls = function.calls.iter().filter_map(|&call| {
            if circle.contains(&call) {
                return Some(self.follow(functions, call, circle.clone()));
            }
            self.0.get(&call).cloned()
        });
        let (depth, mut chain) = calls.max().unwrap_or_default();
        chain.insert(0, at);
        (function.frame + depth, chain)
    }

    fn of_function(&self, at: u64) -> u64 {
        self.0.get(&at).map_or(0, |(depth, _)| *depth)
    }
}

/// Functions that are called from one on, itself included.
fn reached(functions: &BTreeMap<u64, Function>, first: u64) -> BTreeSet<u64> {
    let mut reached = BTreeSet::from([first]);
    let mut open = vec![first];
    while let Some(function) = open.pop().and_then(|at| functions.get(&at)) {
        let calls = function.calls.iter().copied();
        open.extend(calls.filter(|call| functions.contains_key(call) && reached.insert(*call)));
    }
    reached
}

fn functions(file: &object::File<'_>) -> Result<BTreeMap<u64, Function>> {
    let mut found: BTreeMap<u64, (String, u64)> = BTreeMap::new();
    // Where constants begin among the instructions, and where these go on.
    let mut marks: BTreeMap<u64, bool> = BTreeMap::new();
    for symbol in file.symbols() {
        let name = symbol.name().unwrap_or_default();
        let at = symbol.address() & !1;
        if name.starts_with("$d") || name.starts_with("$t") {
            marks.insert(at, name.starts_with("$t"));
        } else if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
            found.insert(at, (name.to_owned(), symbol.size()));
        }
    }
    ensure!(!found.is_empty(), "no symbols: the image cannot be checked");
    let mut functions = BTreeMap::new();
    let is_code = |section: &object::Section<'_, '_>| section.kind() == SectionKind::Text;
    for section in file.sections().filter(is_code) {
        let (start, bytes) = (section.address(), section.data().unwrap_or_default());
        for (&at, (name, size)) in found.range(start..start + bytes.len() as u64) {
            let from = (at - start) as usize;
            let code = &bytes[from..bytes.len().min(from + *size as usize)];
            let is_code = |at: u64| marks.range(..=at).next_back().is_none_or(|(_, code)| *code);
            let mut function = of_code(at, code, is_code);
            function.name.clone_from(name);
            functions.insert(at, function);
        }
    }
    Ok(functions)
}

/// Frame and calls of the instructions at an address (Arm `DDI0403`, A5 to A7).
fn of_code(at: u64, code: &[u8], is_code: impl Fn(u64) -> bool) -> Function {
    let mut function = Function::default();
    let halves = code.as_chunks::<2>().0;
    let end = at + code.len() as u64;
    let mut place = 0;
    while let Some(half) = halves.get(place) {
        let address = at + 2 * place as u64;
        place += 1;
        if !is_code(address) {
            continue;
        }
        let first = u32::from(u16::from_le_bytes(*half));
        let (taken, offset) = if first >> 11 >= 0b11101 {
            let Some(half) = halves.get(place) else {
                break;
            };
            place += 1;
            let second = u32::from(u16::from_le_bytes(*half));
            (taken_by_wide(first, second), branch_of_wide(first, second))
        } else {
            (taken_by(first), branch_of(first))
        };
        function.frame += taken;
        // Relative to the address of the branch and four.
        let target = offset.map(|offset| address.wrapping_add(4).wrapping_add_signed(offset));
        if let Some(target) = target.filter(|target| !(at..end).contains(target)) {
            function.calls.insert(target);
        }
    }
    function
}

/// Returns the bytes that an instruction of 16 bits takes from the stack.
const fn taken_by(first: u32) -> u64 {
    match first & 0xff80 {
        // PUSH
        0xb400 | 0xb480 | 0xb500 | 0xb580 => 4 * (first & 0x1ff).count_ones() as u64,
        // SUB SP, SP, #imm7
        0xb080 => 4 * (first & 0x7f) as u64,
        _ => 0,
    }
}

/// Returns the bytes that an instruction of 32 bits takes from the stack.
const fn taken_by_wide(first: u32, second: u32) -> u64 {
    let constant = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff;
    let bytes = match first {
        // STMDB SP!, registers
        0xe92d => 4 * second.count_ones(),
        // STRD Rt, Rt2, [SP, #-imm]!
        0xe96d => 4 * (second & 0xff),
        // STR Rt, [SP, #-imm]!
        0xf84d if second & 0x0f00 == 0x0d00 => second & 0xff,
        // VPUSH
        0xed2d | 0xed6d if second & 0x0e00 == 0x0a00 => 4 * (second & 0xff),
        // SUB SP, SP, #constant
        0xf1ad | 0xf5ad if second & 0x8f00 == 0x0d00 => expanded(constant),
        // SUBW SP, SP, #imm12
        0xf2ad | 0xf6ad if second & 0x8f00 == 0x0d00 => constant,
        _ => 0,
    };
    bytes as u64
}

/// A modified immediate constant of 12 bits (A5.3.2).
const fn expanded(constant: u32) -> u32 {
    let byte = constant & 0xff;
    match constant >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | byte & 0x7f).rotate_right(constant >> 7),
    }
}

/// Returns the offset in bytes of a branch of 16 bits; none for another instruction.
fn branch_of(first: u32) -> Option<i64> {
    match first >> 12 {
        0b1101 if first >> 8 & 0xf < 0xe => Some(signed(first & 0xff, 8) * 2),
        0b1110 => Some(signed(first & 0x7ff, 11) * 2),
        _ => None,
    }
}

/// Returns the offset in bytes of a branch of 32 bits: `BL`, `B.W`, `B<c>.W`; none for another instruction.
fn branch_of_wide(first: u32, second: u32) -> Option<i64> {
    if first >> 11 != 0b11110 || second & 0x8000 == 0 {
        return None;
    }
    let (sign, j1, j2) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1);
    let low = second & 0x7ff;
    if second & 0x5000 != 0 {
        // BL, and B without a condition.
        if second & 0x1000 == 0 {
            return None;
        }
        let (i1, i2) = (!(j1 ^ sign) & 1, !(j2 ^ sign) & 1);
        let bits = sign << 23 | i1 << 22 | i2 << 21 | (first & 0x3ff) << 11 | low;
        return Some(signed(bits, 24) * 2);
    }
    // Conditions 0b111x are other instructions.
    (first >> 7 & 7 != 7).then(|| {
        let bits = sign << 19 | j2 << 18 | j1 << 17 | (first & 0x3f) << 11 | low;
        signed(bits, 20) * 2
    })
}

/// A signed number of `count` bits.
const fn signed(bits: u32, count: u32) -> i64 {
    ((bits << (32 - count)) as i32 >> (32 - count)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(halves: &[u16]) -> Function {
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        of_code(0x1000, &code, |_| true)
    }

    #[test]
    fn prologues_take_what_an_assembler_says() {
        for (halves, bytes) in [
            (&[0xb5f0][..], 20),       // push {r4-r7, lr}
            (&[0xe92d, 0x4ff0], 36),   // push.w {r4-r11, lr}
            (&[0xf84d, 0xbd04], 4),    // str r11, [sp, #-4]!
            (&[0xe96d, 0x0102], 8),    // strd r0, r1, [sp, #-8]!
            (&[0xed2d, 0x8b10], 64),   // vpush {d8-d15}
            (&[0xb0a6], 152),          // sub sp, #152
            (&[0xf5ad, 0x6d06], 2144), // sub.w sp, sp, #2144
            (&[0xf6ad, 0x0d04], 2052), // subw sp, sp, #2052
            (&[0xb026], 0),            // add sp, #152
            (&[0xb1a0], 0),            // cbz r0, .+44
            (&[0xb5f0, 0xb0a6, 0xbf00], 172),
        ] {
            assert_eq!(function(halves).frame, bytes, "{halves:x?}");
        }
    }

    #[test]
    fn calls_go_where_an_assembler_says() {
        for (halves, target) in [
            (&[0xf000, 0xf87e][..], Some(0x1100)), // bl .+0x100
            (&[0xf7ff, 0xff7e], Some(0x0f00)),     // bl .-0x100
            (&[0xf000, 0xb87e], Some(0x1100)),     // b.w .+0x100
            (&[0xf000, 0x807e], Some(0x1100)),     // beq.w .+0x100
            (&[0xe07e], Some(0x1100)),             // b .+0x100
            (&[0xd07e], Some(0x1100)),             // beq .+0x100
            (&[0xe7fe], None),                     // b .: a loop
            (&[0x4780], None),                     // blx r0
            (&[0xf3bf, 0x8f5f], None),             // dmb sy
        ] {
            let calls: Vec<u64> = function(halves).calls.into_iter().collect();
            assert_eq!(calls, target.into_iter().collect::<Vec<_>>(), "{halves:x?}");
        }
    }

    #[test]
    fn constants_among_instructions_are_none() {
        let code = [0xf0, 0xb5, 0xf0, 0xb5];
        let function = of_code(0, &code, |at| at < 2);
        assert_eq!(function.frame, 20);
    }

    #[test]
    fn the_deepest_of_all_calls_counts_and_recursion_ends() {
        let function = |frame, calls: &[u64]| Function {
            name: String::new(),
            frame,
            calls: calls.iter().copied().collect(),
        };
        let functions = BTreeMap::from([
            (1, function(10, &[2, 3])),
            (2, function(20, &[4])),
            (3, function(5, &[4, 1])),
            (4, function(100, &[])),
        ]);
        let depths = Depths::of(&functions);
        assert_eq!(depths.of_function(1), 130);
        assert_eq!(depths.0[&1].1, [1, 2, 4]);
        assert_eq!(depths.of_function(9), 0);
    }

    #[test]
    fn the_depth_of_functions_that_call_each_other_does_not_depend_on_their_addresses() {
        // main calls poll; poll and wake call each other; either goes on to a deeper one.
        let [main, poll, wake, format, log] = [0, 1, 2, 3, 4];
        let frames = [5, 20, 10, 100, 90];
        let calls: [&[usize]; 5] = [&[poll], &[wake, log], &[poll, format], &[], &[]];
        // main, poll, wake, format; poll's; wake, poll, log, or wake, format.
        let expected = [135, 130, 120, 100, 90];
        let forward = [main, poll, wake, format, log];
        let [mut backward, mut mixed] = [forward; 2];
        backward.reverse();
        mixed.rotate_left(2);
        for order in [forward, backward, mixed] {
            let address = |function: usize| order[function] as u64 * 2;
            let functions = (0..5).map(|at| {
                let calls = calls[at].iter().map(|call| address(*call)).collect();
                let (name, frame) = (at.to_string(), frames[at]);
                (address(at), Function { name, frame, calls })
            });
            let functions = functions.collect();
            let depths = Depths::of(&functions);
            let found = [0, 1, 2, 3, 4].map(|at| depths.of_function(address(at)));
            assert_eq!(found, expected, "{order:?}");
        }
    }
}
