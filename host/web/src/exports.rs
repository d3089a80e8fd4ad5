//! Functions of the WebAssembly module. Bytes come through [`input`], outputs are read at [`output`].
#![expect(unsafe_code, reason = "exported names; there is no unsafe block")]

use std::cell::RefCell;

use crate::engine::{Engine, Wanted};

/// State of the module.
#[derive(Default)]
struct State {
    input: Vec<u8>,
    file: Vec<u8>,
    model: Option<Vec<u8>>,
    engine: Option<Engine>,
    output: String,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

/// Makes room for bytes. Returns their address.
#[unsafe(no_mangle)]
extern "C" fn input(length: usize) -> *mut u8 {
    STATE.with_borrow_mut(|state| {
        state.input.resize(length, 0);
        state.input.as_mut_ptr()
    })
}

/// Address of the newest outputs.
#[unsafe(no_mangle)]
extern "C" fn output() -> *const u8 {
    STATE.with_borrow(|state| state.output.as_ptr())
}

/// Takes the bytes of a file: a recording to open, or a journal for the next request.
#[unsafe(no_mangle)]
extern "C" fn file() {
    STATE.with_borrow_mut(|state| state.file = std::mem::take(&mut state.input));
}

/// Takes the bytes of a model file.
#[unsafe(no_mangle)]
extern "C" fn model() {
    STATE.with_borrow_mut(|state| state.model = Some(std::mem::take(&mut state.input)));
}

/// Opens the source that the bytes name. Returns the length of the outputs; 0 if there is no such source.
#[unsafe(no_mangle)]
extern "C" fn open(now: f64) -> usize {
    STATE.with_borrow_mut(|state| {
        let Ok(wanted) = serde_json::from_slice::<Wanted>(&state.input) else {
            return 0;
        };
        let file = std::mem::take(&mut state.file);
        state.engine = Some(Engine::open(now, &wanted, &file, state.model.as_deref()));
        state.take()
    })
}

/// Lets time pass. Returns the length of the outputs.
#[unsafe(no_mangle)]
extern "C" fn tick(now: f64) -> usize {
    with(|engine, _, _| engine.tick(now))
}

/// Takes what a device has sent. Returns the length of the outputs.
#[unsafe(no_mangle)]
extern "C" fn heard(now: f64) -> usize {
    with(|engine, bytes, _| engine.heard(now, bytes))
}

/// Takes a message of the page. Returns the length of the outputs.
#[unsafe(no_mangle)]
extern "C" fn request(now: f64) -> usize {
    with(|engine, bytes, file| engine.request(now, bytes, file))
}

fn with(act: impl FnOnce(&mut Engine, &[u8], &[u8])) -> usize {
    STATE.with_borrow_mut(|state| {
        if let Some(engine) = &mut state.engine {
            act(engine, &state.input, &state.file);
            state.file.clear();
        }
        state.take()
    })
}

impl State {
    fn take(&mut self) -> usize {
        let outputs = self.engine.as_mut().map(Engine::take).unwrap_or_default();
        // Maps with keys of text alone: they can be written.
        self.output = serde_json::to_string(&outputs).unwrap_or_default();
        self.output.len()
    }
}
