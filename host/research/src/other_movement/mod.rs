//! Gain of showing a model what is not meant: the same person's model tuned without and with other movement.

mod halves;
mod measurement;

pub(crate) use measurement::{Measurement, SHOWN, Values, Variant};
