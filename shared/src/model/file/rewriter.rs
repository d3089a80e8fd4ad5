//! A file with another header or head, everything else as it is.

use alloc::vec::Vec;

use super::{
    ALIGNMENT, CHECKSUM_BYTES, PREFIX_BYTES,
    error::ModelError,
    owned::linear,
    reader::Model,
    wire_aggregation::WireAggregation,
    wire_header::WireHeader,
    writer::{append, append_tensor, bytes_of, prefix, seal},
};
use crate::intent::Intent;
use crate::model::head::Head;
use crate::stream::alignment::Template;
use crate::stream::smoother::Reaction;

impl Model<'_> {
    /// The file with another alignment template, or with none; everything else is as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`].
    pub fn with_template(file: &[u8], template: Option<&Template>) -> Result<Vec<u8>, ModelError> {
        let template = bytes_of(template.copied());
        Self::with_header(file, |header| header.template = &template)
    }

    /// The file with another operating point: a reaction, then the margin of every class but relax, and that over movement
    /// outside the vocabulary, which only a model that knows such movement has. `None` leaves a value as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`], and [`ModelError::NoOther`].
    pub fn with_gate(
        file: &[u8],
        entry: Option<f32>,
        other: Option<f32>,
        reaction: Option<Reaction>,
    ) -> Result<Vec<u8>, ModelError> {
        if other.is_some() && !Model::parse(file)?.header.dimensions.other {
            return Err(ModelError::NoOther);
        }
        let reaction = reaction.map(Reaction::margins);
        Self::with_header(file, |header| {
            if let Some(entry) = entry.or(reaction.map(|margins| margins.entry)) {
                header.entry_margins[Intent::Relax.class() + 1..].fill(entry);
            }
            if let Some(margins) = reaction {
                header.other_margin = header.other_margin.and(margins.other);
                let (mode, _) = header.aggregation.interpret();
                header.aggregation = WireAggregation::new(mode, margins.early);
            }
            header.other_margin = other.or(header.other_margin);
        })
    }

    /// The file with another look-back head; everything else is as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`], and [`ModelError::OtherHead`] if the head is one for other dimensions.
    pub fn with_head(file: &[u8], head: &Head) -> Result<Vec<u8>, ModelError> {
        let model = Model::parse(file)?;
        if !head.fits(&model.header.dimensions) {
            return Err(ModelError::OtherHead);
        }
        let mut parts = model.to_parts();
        parts.head = linear(&head.linear(), model.header.dimensions.width);
        parts.to_bytes()
    }

    fn with_header<'h>(
        file: &'h [u8],
        change: impl FnOnce(&mut WireHeader<'h>),
    ) -> Result<Vec<u8>, ModelError> {
        let model = Model::parse(file)?;
        let body = &file[PREFIX_BYTES..model.length - CHECKSUM_BYTES];
        let (mut header, mut rest) = postcard::take_from_bytes::<WireHeader<'_>>(body)
            .map_err(|_| ModelError::Header { field: "header" })?;
        change(&mut header);
        let mut out = prefix();
        append(&mut out, &header);
        while !rest.is_empty() {
            let end = PREFIX_BYTES + body.len();
            let (field, after) = postcard::take_from_bytes::<&[u8]>(rest)
                .map_err(|_| ModelError::Header { field: "tensors" })?;
            let start = end - after.len() - field.len();
            // Zeros stand before the tensor where its place in the old file asked for them.
            append_tensor(
                &mut out,
                &field[start.next_multiple_of(ALIGNMENT) - start..],
            );
            rest = after;
        }
        seal(&mut out);
        Model::parse(&out)?;
        Ok(out)
    }
}
