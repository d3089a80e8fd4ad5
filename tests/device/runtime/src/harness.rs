//! The test harness that `#[test]` expands to, on a core without operating system.
//!
//! The compiler turns each `#[test]` into a constant of the type [`TestDescAndFn`] of a crate
//! `test`, and hands their list to [`test_main_static`]. A crate that has this one as its
//! dependency `test` thus runs its plain tests here. Fields, names and values are the compiler's
//! (1.95 and 1.96 alike); it sets them all and this harness reads some.
//!
//! Without arguments the program lists its tests. With the name of a test it runs that one and
//! exits with 0 if it passed: a panic ends the program, so every test has an emulator to itself.

use core::{
    fmt::Debug,
    sync::atomic::{AtomicBool, Ordering},
};

use semihosting::{println, process};

use crate::arguments;

/// Exit code where no test has the name asked for.
const UNKNOWN: i32 = 103;

static PANIC_IS_EXPECTED: AtomicBool = AtomicBool::new(false);

pub(crate) fn panic_is_expected() -> bool {
    PANIC_IS_EXPECTED.load(Ordering::Relaxed)
}

/// A test and what is known of it.
#[derive(Debug)]
pub struct TestDescAndFn {
    /// What is known of it.
    pub desc: TestDesc,
    /// The test itself.
    pub testfn: StaticTestFn,
}

/// What is known of a test.
#[derive(Debug)]
pub struct TestDesc {
    /// Path without the crate.
    pub name: StaticTestName,
    /// Whether `#[ignore]` stands by it.
    pub ignore: bool,
    /// Why it is ignored.
    pub ignore_message: Option<&'static str>,
    /// Where it stands.
    pub source_file: &'static str,
    /// Where it begins.
    pub start_line: usize,
    /// Where it begins.
    pub start_col: usize,
    /// Where it ends.
    pub end_line: usize,
    /// Where it ends.
    pub end_col: usize,
    /// Of documentation tests.
    pub compile_fail: bool,
    /// Of documentation tests.
    pub no_run: bool,
    /// Whether it passes by a panic.
    pub should_panic: ShouldPanic,
    /// Where tests of its kind live.
    pub test_type: TestType,
}

/// A test's name.
#[derive(Clone, Copy, Debug)]
pub struct StaticTestName(pub &'static str);

/// A test's function.
#[derive(Clone, Copy, Debug)]
pub struct StaticTestFn(pub fn() -> Result<(), &'static str>);

/// Whether a test passes by a panic.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShouldPanic {
    /// It passes by coming to its end.
    No,
    /// It passes by any panic.
    Yes,
    /// It passes by a panic of this message; any will do here.
    YesWithMessage(&'static str),
}

/// Where tests of a kind live.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TestType {
    /// In `src`.
    UnitTest,
    /// In `tests`.
    IntegrationTest,
    /// Elsewhere.
    Unknown,
}

/// What a test may give back.
pub trait Outcome {
    /// Whether it passed.
    fn passed(self) -> bool;
}

impl Outcome for () {
    fn passed(self) -> bool {
        true
    }
}

impl<E: Debug> Outcome for Result<(), E> {
    fn passed(self) -> bool {
        self.inspect_err(|error| println!("{error:?}")).is_ok()
    }
}

/// Wraps every test's body.
///
/// # Errors
/// Where the test gave an error back, which is printed.
pub fn assert_test_result(outcome: impl Outcome) -> Result<(), &'static str> {
    outcome
        .passed()
        .then_some(())
        .ok_or("the test gave an error")
}

/// Lists the tests, or runs the one that the command line names.
pub fn test_main_static(tests: &[&TestDescAndFn]) {
    let Some(name) = arguments().into_iter().next() else {
        for test in tests.iter().filter(|test| !test.desc.ignore) {
            println!("{}", test.desc.name.0);
        }
        return;
    };
    let Some(test) = tests.iter().find(|test| test.desc.name.0 == name) else {
        println!("no test {name}");
        process::exit(UNKNOWN)
    };
    let panics = test.desc.should_panic != ShouldPanic::No;
    PANIC_IS_EXPECTED.store(panics, Ordering::Relaxed);
    let passed = (test.testfn.0)().is_ok();
    if panics {
        println!("no panic, where one was expected");
    }
    process::exit(i32::from(!passed || panics));
}
