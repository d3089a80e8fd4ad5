//! Gain of tuning a model on a person's own recordings, by their duration, for people whom the model has never seen.

mod measurement;
mod tables;

pub(crate) use measurement::{Measured, Measurement};
pub(crate) use tables::{curves, people};
