//! What images take of flash, RAM and stack, beside their budgets (docs/budgets.md).

use std::fmt;

use anyhow::{Result, ensure};

use super::image::Image;
use crate::size::Size;

/// Bytes of flash for code and constants, SoftDevice, linked-in controller and model excluded.
const FLASH_BUDGET: u64 = 160 * 1024;
/// Bytes of static RAM, the SoftDevice's own and the stack excluded.
const RAM_BUDGET: u64 = 48 * 1024;
/// Most bytes that the no-access region below the stack takes: two regions of 256, and what aligns them.
const STACK_GUARD: u64 = 2 * 256 + 255;
/// Least bytes that must be left for the stack.
pub const STACK_BUDGET: u64 = 12 * 1024;

/// Fails where an image is over a budget.
///
/// # Errors
/// Says which budget, and by how much.
pub fn check(image: Image, size: Size) -> Result<()> {
    ensure!(
        size.own_flash() <= FLASH_BUDGET,
        "{image}: {} bytes of flash, the controller's excluded; the budget is {FLASH_BUDGET}",
        size.own_flash()
    );
    ensure!(
        size.ram() <= RAM_BUDGET,
        "{image}: {} bytes of static RAM, the budget is {RAM_BUDGET}",
        size.ram()
    );
    ensure!(
        size.ram() + STACK_GUARD + STACK_BUDGET <= image.ram(),
        "{image}: {} of {} bytes of RAM taken, {STACK_GUARD} guard the stack, {STACK_BUDGET} must be left for it",
        size.ram(),
        image.ram()
    );
    Ok(())
}

/// The table of `cargo xtask images`.
pub struct Table<'r> {
    /// The images with their sizes.
    pub rows: &'r [(Image, Size)],
    /// Bytes of the deepest stack that the emulated board used; the tasks are the same in every
    /// image.
    pub stack: Option<u64>,
}

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kib = |bytes: u64| bytes as f64 / 1024.0;
        let stack = self
            .stack
            .map_or_else(|| "-".to_owned(), |used| format!("{:.1}", kib(used)));
        writeln!(
            f,
            "| image, KiB    | code  | constants | flash | controller | own   | of  | static RAM | of  | left for the stack | stack measured |"
        )?;
        writeln!(
            f,
            "|---------------|-------|-----------|-------|------------|-------|-----|------------|-----|--------------------|----------------|"
        )?;
        for &(image, size) in self.rows {
            writeln!(
                f,
                "| {image:13} | {:5.1} | {:9.1} | {:5.1} | {:10.1} | {:5.1} | {:3} | {:10.1} | {:3} | {:18.1} | {stack:>14} |",
                kib(size.text),
                kib(size.rodata),
                kib(size.flash()),
                kib(size.controller),
                kib(size.own_flash()),
                FLASH_BUDGET / 1024,
                kib(size.ram()),
                RAM_BUDGET / 1024,
                kib(image.ram().saturating_sub(size.ram() + STACK_GUARD)),
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_counts_initial_values_twice_and_admits_its_last_byte() {
        let full = Size {
            text: FLASH_BUDGET - 10,
            rodata: 0,
            data: 10,
            bss: RAM_BUDGET - 10,
            controller: 0,
        };
        let image = Image::Nrf52840S140;
        assert!(check(image, full).is_ok());
        assert!(check(image, Size { rodata: 1, ..full }).is_err());
        let more = Size {
            bss: full.bss + 1,
            ..full
        };
        assert!(check(image, more).is_err());
    }

    #[test]
    fn the_small_chip_must_keep_room_for_its_stack() {
        let left = |stack| Size {
            bss: Image::Nrf52832S132.ram() - STACK_GUARD - stack,
            ..Size::default()
        };
        assert!(check(Image::Nrf52832S132, left(STACK_BUDGET)).is_ok());
        assert!(check(Image::Nrf52832S132, left(STACK_BUDGET - 1)).is_err());
    }
}
