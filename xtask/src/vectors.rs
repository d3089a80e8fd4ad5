//! Checks the vector table of an image.
//!
//! A handler under a name that the vector table does not contain links without a warning and is never
//! called. So the table of the linked image is read.

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _};

/// Vectors of the core itself, before the first interrupt.
const CORE_VECTORS: usize = 16;

/// Fails where one of the interrupts, given by number, leads to no handler or the default one.
pub fn check(elf: &[u8], needed: &[usize]) -> Result<()> {
    let file = object::File::parse(elf).context("not an ELF image")?;
    let table = file
        .section_by_name(".vector_table")
        .context("no section .vector_table")?
        .data()?;
    let default = file
        .symbols()
        .find(|symbol| symbol.name() == Ok("DefaultHandler_"))
        .context("no symbol DefaultHandler_")?
        .address();
    for &interrupt in needed {
        let vector = handler(table, interrupt);
        ensure!(
            vector.is_some_and(|vector| vector != 0 && vector != default),
            "interrupt {interrupt} has no handler: it is bound under a name that the vector table \
             does not contain"
        );
    }
    Ok(())
}

/// The address of an interrupt's handler, the Thumb bit set as a symbol has it.
fn handler(table: &[u8], interrupt: usize) -> Option<u64> {
    let (vectors, _) = table.as_chunks::<4>();
    let vector = vectors.get(CORE_VECTORS + interrupt)?;
    Some(u32::from_le_bytes(*vector).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interrupts_follow_the_cores_own_vectors() {
        let table: Vec<u8> = (0..20_u32).flat_map(u32::to_le_bytes).collect();
        assert_eq!(handler(&table, 0), Some(16));
        assert_eq!(handler(&table, 3), Some(19));
        assert_eq!(handler(&table, 4), None);
    }
}
