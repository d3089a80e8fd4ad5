//! The test harness that `#[test]` expands to, on a core without operating system.
//!
//! The compiler turns each `#[test]` into a constant of type [`TestDescAndFn`] of the crate `test`,
//! and passes the list of them to [`test_main_static`]. A crate that depends on this one under the
//! name `test` so runs its unchanged tests here. Types, fields and variants are those that the
//! compiler expects (1.95 and 1.96); it sets all fields, of which this harness reads some.
//!
//! Without arguments the program lists its tests. With the name of a test it runs that one and
//! exits with 0 if it passed. A panic ends the program, so each test runs in an emulator of its own.

use core::{
    fmt::Debug,
    sync::atomic::{AtomicBool, Ordering},
};

use semihosting::{println, process};

use crate::files::arguments;

/// Exit code if no test has the requested name.
const UNKNOWN_TEST: i32 = 103;

static PANIC_IS_EXPECTED: AtomicBool = AtomicBool::new(false);

pub(crate) fn panic_is_expected() -> bool {
    PANIC_IS_EXPECTED.load(Ordering::Relaxed)
}

/// A test and its description.
#[derive(Debug)]
pub struct TestDescAndFn {
    /// Its description.
    pub desc: TestDesc,
    /// The test itself.
    pub testfn: StaticTestFn,
}

/// Description of a test.
#[derive(Debug)]
pub struct TestDesc {
    /// Path without the crate.
    pub name: StaticTestName,
    /// True if the test is marked `#[ignore]`.
    pub ignore: bool,
    /// Why it is ignored.
    pub ignore_message: Option<&'static str>,
    /// Source file of the test.
    pub source_file: &'static str,
    /// Its first line.
    pub start_line: usize,
    /// Column of its start.
    pub start_col: usize,
    /// Its last line.
    pub end_line: usize,
    /// Column of its end.
    pub end_col: usize,
    /// Set for documentation tests only.
    pub compile_fail: bool,
    /// Set for documentation tests only.
    pub no_run: bool,
    /// Expectation of a panic.
    pub should_panic: ShouldPanic,
    /// Unit test or integration test.
    pub test_type: TestType,
}

/// A test's name.
#[derive(Clone, Copy, Debug)]
pub struct StaticTestName(pub &'static str);

/// A test's function.
#[derive(Clone, Copy, Debug)]
pub struct StaticTestFn(pub fn() -> Result<(), &'static str>);

/// Expectation of a panic in a test.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShouldPanic {
    /// It passes if it returns.
    No,
    /// It passes if it panics.
    Yes,
    /// It should panic with this message; this harness accepts any panic.
    YesWithMessage(&'static str),
}

/// The kind of a test.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TestType {
    /// Unit test in `src`.
    UnitTest,
    /// Integration test in `tests`.
    IntegrationTest,
    /// Elsewhere.
    Unknown,
}

/// Value that a test may return.
pub trait Outcome {
    /// Returns true if the test passed.
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

/// Called with the outcome of every test.
pub fn assert_test_result(outcome: impl Outcome) -> Result<(), &'static str> {
    outcome
        .passed()
        .then_some(())
        .ok_or("the test returned an error")
}

/// Lists the tests, or runs the one named on the command line.
pub fn test_main_static(tests: &[&TestDescAndFn]) {
    let Some(name) = arguments().into_iter().next() else {
        for test in tests.iter().filter(|test| !test.desc.ignore) {
            println!("{}", test.desc.name.0);
        }
        return;
    };
    let Some(test) = tests.iter().find(|test| test.desc.name.0 == name) else {
        println!("no test {name}");
        process::exit(UNKNOWN_TEST)
    };
    let panics = test.desc.should_panic != ShouldPanic::No;
    PANIC_IS_EXPECTED.store(panics, Ordering::Relaxed);
    let passed = (test.testfn.0)().is_ok();
    if panics {
        println!("no panic, where one was expected");
    }
    process::exit(i32::from(!passed || panics));
}
