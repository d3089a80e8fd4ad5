//! Flash, RAM and stack of the images, beside their budgets (docs/budgets.md).

use std::fmt;

use anyhow::{Result, ensure};

use super::image::Image;
use crate::size::Size;

/// Most bytes that the no-access region below the stack takes: two regions of 256, and what aligns them.
const STACK_GUARD: u64 = 2 * 256 + 255;
/// Least bytes that must be left for the stack.
const STACK_BUDGET: u64 = 12 * 1024;

/// Least bytes of RAM that nothing uses, below the deepest chain of calls.
const SPARE: u64 = 6 * 1024;

/// Sizes of an image.
#[derive(Clone, Copy)]
pub struct BudgetRow {
    /// The image.
    pub image: Image,
    /// Bytes of flash and RAM.
    pub size: Size,
    /// Bytes of its deepest chain of calls.
    pub chain: u64,
}

impl BudgetRow {
    /// Bytes of RAM that are left for the stack.
    const fn left(&self) -> u64 {
        self.image
            .ram()
            .saturating_sub(self.size.ram() + STACK_GUARD)
    }

    /// Bytes of RAM that nothing uses.
    const fn spare(&self) -> u64 {
        self.left()
            .saturating_sub(self.chain + self.image.softdevice_stack())
    }
}

/// Fails where an image is over a budget.
pub fn check(row: &BudgetRow) -> Result<()> {
    let &BudgetRow { image, size, .. } = row;
    ensure!(
        size.flash() <= image.flash_budget(),
        "{image}: {} bytes of flash, the budget is {}",
        size.flash(),
        image.flash_budget()
    );
    ensure!(
        size.ram() <= image.ram_budget(),
        "{image}: {} bytes of static RAM, the budget is {}",
        size.ram(),
        image.ram_budget()
    );
    ensure!(
        size.ram() + STACK_GUARD + STACK_BUDGET <= image.ram(),
        "{image}: {} of {} bytes of RAM taken, {STACK_GUARD} guard the stack, {STACK_BUDGET} must be left for it",
        size.ram(),
        image.ram()
    );
    ensure!(
        row.spare() >= SPARE,
        "{image}: {} bytes of RAM are spare below the deepest chain of calls, which takes {}; they must be {SPARE}",
        row.spare(),
        row.chain
    );
    Ok(())
}

/// The table of `cargo xtask images`.
pub struct BudgetTable<'r>(pub &'r [BudgetRow]);

impl fmt::Display for BudgetTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kib = |bytes: u64| bytes as f64 / 1024.0;
        writeln!(
            f,
            "| image, KiB    | code  | constants | flash | of  | controller | own   | static RAM | of  | left for the stack | deepest chain | spare |"
        )?;
        writeln!(
            f,
            "|---------------|-------|-----------|-------|-----|------------|-------|------------|-----|--------------------|---------------|-------|"
        )?;
        for row in self.0 {
            let &BudgetRow { image, size, chain } = row;
            writeln!(
                f,
                "| {image:13} | {:5.1} | {:9.1} | {:5.1} | {:3} | {:10.1} | {:5.1} | {:10.1} | {:3} | {:18.1} | {:13.1} | {:5.1} |",
                kib(size.text),
                kib(size.rodata),
                kib(size.flash()),
                image.flash_budget() / 1024,
                kib(size.controller),
                kib(size.own_flash()),
                kib(size.ram()),
                image.ram_budget() / 1024,
                kib(row.left()),
                kib(chain),
                kib(row.spare()),
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(image: Image, size: Size) -> BudgetRow {
        BudgetRow {
            image,
            size,
            chain: 0,
        }
    }

    #[test]
    fn the_budget_counts_initial_values_twice_and_admits_its_last_byte() {
        let full = Size {
            text: Image::Nrf52840S140.flash_budget() - 10,
            rodata: 0,
            data: 10,
            bss: Image::Nrf52840S140.ram_budget() - 10,
            controller: 0,
        };
        let check = |size| check(&row(Image::Nrf52840S140, size));
        assert!(check(full).is_ok());
        assert!(check(Size { rodata: 1, ..full }).is_err());
        let more = Size {
            bss: full.bss + 1,
            ..full
        };
        assert!(check(more).is_err());
    }

    #[test]
    fn the_small_chip_must_keep_room_for_its_stack() {
        let left = |stack| Size {
            bss: Image::Nrf52832S132.ram() - STACK_GUARD - stack,
            ..Size::default()
        };
        let small = |stack| row(Image::Nrf52832S132, left(stack));
        assert!(check(&small(STACK_BUDGET)).is_ok());
        assert!(check(&small(STACK_BUDGET - 1)).is_err());
        let chain = STACK_BUDGET - 1536 - SPARE;
        let deep = |chain| BudgetRow {
            chain,
            ..small(STACK_BUDGET)
        };
        assert!(check(&deep(chain)).is_ok());
        assert!(check(&deep(chain + 1)).is_err());
    }
}
