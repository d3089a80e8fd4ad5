//! The device's pipeline, fed piece by piece.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;

use evaluation::inference;
use evaluation::model_evaluation::NamedModel;
use pyo3::prelude::*;
use self_cell::{MutBorrow, self_cell};
use shared::model::Encode;
use shared::model::encoder::HostEncoder;
use shared::model::file;
use shared::stream::alignment::Arm;

use crate::arrays::with_samples;
use crate::event::Event;
use crate::failure::told;
use crate::model::Model;

type State = <HostEncoder<'static> as Encode>::State;

/// A model's bytes, and the encoder's state, which the pipeline changes.
struct Memory {
    model: Arc<NamedModel>,
    state: MutBorrow<State>,
}

type Running<'a> = inference::Stream<'a>;

self_cell! {
    struct Board {
        owner: Box<Memory>,
        #[not_covariant]
        dependent: Running,
    }
}

/// A stream through the pipeline that a board runs, from its start on; it writes what `myointent replay` prints.
///
/// The clock is that of the samples: two arrive together, every 10 ms.
///
/// Args:
///     model: The model.
///     align: Begin an alignment with the first sample: the wearer opens the hand twice, with rest before and after.
///     mirrored: Whether the armband is on the other arm than in training; None has the alignment find it.
#[pyclass(module = "myointent")]
pub struct Stream(Board);

#[pymethods]
impl Stream {
    #[new]
    #[pyo3(signature = (model, *, align = false, mirrored = None))]
    fn new(model: &Model, align: bool, mirrored: Option<bool>) -> PyResult<Self> {
        let align =
            align.then(|| mirrored.map_or(Arm::Unknown, |mirrored| Arm::Known { mirrored }));
        let memory = Box::new(Memory {
            model: model.named.clone(),
            state: MutBorrow::new(State::fresh()),
        });
        let board = Board::try_new(memory, |memory| {
            let model = file::Model::parse(&memory.model.bytes).map_err(told)?;
            let encoder = HostEncoder::new(&model).map_err(told)?;
            Running::new(&model, encoder, memory.state.borrow_mut(), align).map_err(told)
        });
        board.map(Self)
    }

    /// Takes the next samples and returns the lines that they cause, in order. The first call also returns the line of
    /// the start.
    ///
    /// Args:
    ///     samples: Raw samples as the armband sends them, shape (n, 8), whole numbers from -128 to 127, 200 Hz; any
    ///         number of them. An int8 array in C order is not copied.
    fn push(&mut self, samples: &Bound<'_, PyAny>) -> PyResult<Vec<Event>> {
        with_samples(samples, |samples| {
            let mut events = Vec::new();
            self.0.with_dependent_mut(|_, stream| {
                let ControlFlow::Continue(()) = stream.push::<Infallible>(
                    samples,
                    |_| (),
                    |line| {
                        events.push(Event(line));
                        ControlFlow::Continue(())
                    },
                );
            });
            Ok(events)
        })
    }
}
