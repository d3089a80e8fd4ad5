//! Registers of a peripheral: which there are, what may be written to them, and what they hold.
//!
//! Everything that a table does not list is refused: an access to a register that is not modelled, a bit that is
//! reserved, a read of a task, a write to a status.

use crate::refusal::What;

/// Offset of the enabled interrupts in every peripheral that has any (product specification, 6.1.5).
pub const INTEN: u32 = 0x300;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RegisterKind {
    /// Writing 1 starts something (6.1.6). It cannot be read.
    Task,
    /// Holds 1 after something has happened. The program writes 0 alone.
    Event,
    /// Holds what was written.
    ReadWrite,
    /// Holds what the peripheral says.
    ReadOnly,
    /// Takes a value and does not give it back.
    WriteOnly,
    /// Sets bits of another register; reads as that.
    Set(u32),
    /// Clears bits of another register; reads as that.
    Clear(u32),
    /// Writing 1 clears a bit.
    OneClears,
}

/// One register, or several side by side.
#[derive(Clone, Copy, Debug)]
pub struct Register {
    /// Its name in the product specification.
    pub name: &'static str,
    /// Offset of the first one from the peripheral's base address, in bytes.
    pub offset: u32,
    pub count: u32,
    /// Bytes from one to the next.
    pub stride: u32,
    /// Effect of an access.
    pub kind: RegisterKind,
    /// Bits that are not reserved.
    pub mask: u32,
    /// Value that a reset leaves in it.
    pub reset: u32,
}

impl Register {
    const fn new(offset: u32, kind: RegisterKind, mask: u32) -> Self {
        Self {
            name: "",
            offset,
            count: 1,
            stride: 4,
            kind,
            mask,
            reset: 0,
        }
    }

    pub const fn named(self, name: &'static str) -> Self {
        Self { name, ..self }
    }

    pub const fn times(self, count: u32) -> Self {
        Self { count, ..self }
    }

    pub const fn every(self, stride: u32) -> Self {
        Self { stride, ..self }
    }

    pub const fn reset(self, reset: u32) -> Self {
        Self { reset, ..self }
    }

    fn holds(&self, offset: u32) -> bool {
        let Some(distance) = offset.checked_sub(self.offset) else {
            return false;
        };
        distance.is_multiple_of(self.stride) && distance / self.stride < self.count
    }
}

pub const fn task(offset: u32) -> Register {
    Register::new(offset, RegisterKind::Task, 1)
}

pub const fn event(offset: u32) -> Register {
    Register::new(offset, RegisterKind::Event, 0)
}

pub const fn read_write(offset: u32, mask: u32) -> Register {
    Register::new(offset, RegisterKind::ReadWrite, mask)
}

pub const fn read_only(offset: u32) -> Register {
    Register::new(offset, RegisterKind::ReadOnly, 0)
}

pub const fn write_only(offset: u32, mask: u32) -> Register {
    Register::new(offset, RegisterKind::WriteOnly, mask)
}

pub const fn set(offset: u32, of: u32, mask: u32) -> Register {
    Register::new(offset, RegisterKind::Set(of), mask)
}

pub const fn clear(offset: u32, of: u32, mask: u32) -> Register {
    Register::new(offset, RegisterKind::Clear(of), mask)
}

pub const fn one_clears(offset: u32, mask: u32) -> Register {
    Register::new(offset, RegisterKind::OneClears, mask)
}

/// Defines the table of a peripheral's registers, `TABLE`, and the offset of each by its name.
macro_rules! registers {
    ($($name:ident = $kind:ident($($of:expr),+) $(.$with:ident($value:expr))*),* $(,)?) => {
        $(
            #[allow(dead_code, reason = "many only hold what is written to them")]
            pub const $name: u32 = $crate::chip::register::$kind($($of),+).offset;
        )*
        const TABLE: &[$crate::chip::register::Register] = &[$(
            $crate::chip::register::$kind($($of),+)$(.$with($value))*.named(stringify!($name))
        ),*];
    };
}
pub(super) use registers;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Written {
    Task,
    /// No effect: a task was written 0.
    Nothing,
    /// The register at this offset holds something else, or was written the same again.
    Stored(u32),
}

/// The registers of one peripheral.
#[derive(Default, Debug)]
pub struct Registers {
    pub name: &'static str,
    pub base: u32,
    table: Vec<Register>,
    values: Vec<u32>,
}

impl Registers {
    /// Creates the registers with the values that a reset leaves.
    pub fn new(name: &'static str, base: u32, table: &'static [Register]) -> Self {
        let mut registers = Self {
            name,
            base,
            table: table.to_vec(),
            values: vec![0; 0x1000 / 4],
        };
        for register in table {
            for number in 0..register.count {
                registers.put(register.offset + number * register.stride, register.reset);
            }
        }
        registers
    }

    /// Changes the registers that begin at these offsets: a variant of the peripheral.
    pub fn changed(mut self, offsets: &[u32], change: impl Fn(&mut Register)) -> Self {
        let found = self.table.iter_mut();
        let found = found.filter(|one| offsets.contains(&one.offset));
        found.for_each(change);
        self
    }

    pub fn get(&self, offset: u32) -> u32 {
        self.values[offset as usize / 4]
    }

    /// Sets the value at an offset, as the peripheral itself does.
    pub fn put(&mut self, offset: u32, value: u32) {
        self.values[offset as usize / 4] = value;
    }

    fn find(&self, offset: u32) -> Option<&Register> {
        self.table.iter().find(|one| one.holds(offset))
    }

    pub fn name_of(&self, offset: u32) -> String {
        match self.find(offset) {
            Some(one) if one.count > 1 => {
                let number = (offset - one.offset) / one.stride;
                format!("{}.{}[{number}]", self.name, one.name)
            }
            Some(one) => format!("{}.{}", self.name, one.name),
            None => format!("{}+{offset:#05x}", self.name),
        }
    }

    /// Returns true if the register at an offset is of this kind.
    pub fn is(&self, offset: u32, kind: RegisterKind) -> bool {
        self.find(offset).is_some_and(|one| one.kind == kind)
    }

    /// Returns the value that the program reads, or the reason to refuse the read.
    pub fn read(&self, offset: u32) -> Result<u32, What> {
        let register = self.find(offset).ok_or(What::NotModelled)?;
        match register.kind {
            RegisterKind::Task | RegisterKind::WriteOnly => Err(What::NotReadable),
            RegisterKind::Set(of) | RegisterKind::Clear(of) => Ok(self.get(of)),
            _ => Ok(self.get(offset)),
        }
    }

    /// Writes a value, as the program does. Returns the effect, or the reason to refuse the write.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<Written, What> {
        let register = *self.find(offset).ok_or(What::NotModelled)?;
        let reserved = value & !register.mask;
        if register.kind == RegisterKind::ReadOnly {
            return Err(What::NotWritable { value });
        }
        if register.kind == RegisterKind::Event && value != 0 {
            return Err(What::EventSet { value });
        }
        // Clearing a bit that is always clear is what `INTENCLR` is written all ones for.
        if reserved != 0 && !matches!(register.kind, RegisterKind::Clear(_)) {
            return Err(What::Reserved { value, reserved });
        }
        match register.kind {
            RegisterKind::Task if value == 0 => return Ok(Written::Nothing),
            RegisterKind::Task => return Ok(Written::Task),
            RegisterKind::Set(of) => {
                self.put(of, self.get(of) | value);
                return Ok(Written::Stored(of));
            }
            RegisterKind::Clear(of) => {
                self.put(of, self.get(of) & !value);
                return Ok(Written::Stored(of));
            }
            RegisterKind::OneClears => self.put(offset, self.get(offset) & !value),
            _ => self.put(offset, value),
        }
        Ok(Written::Stored(offset))
    }

    /// Returns true if an event has happened and its interrupt is enabled. Bit n is the event at 0x100 + 4 n (6.1.5).
    pub fn interrupts(&self) -> bool {
        let mut enabled = self.get(INTEN);
        while enabled != 0 {
            let bit = enabled.trailing_zeros();
            if self.get(0x100 + 4 * bit) != 0 {
                return true;
            }
            enabled &= enabled - 1;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    registers![
        TASKS_START = task(0x000),
        EVENTS_DONE = event(0x104),
        INTENSET = set(0x304, INTEN, 1 << 1),
        INTENCLR = clear(0x308, INTEN, 1 << 1),
        STATUS = read_only(0x400),
        CC = read_write(0x540, 0xff).times(4).every(8).reset(7),
    ];

    fn registers() -> Registers {
        Registers::new("ANY0", 0, TABLE)
    }

    #[test]
    fn what_no_table_lists_is_refused() {
        let mut any = registers();
        assert_eq!(any.read(0x544), Err(What::NotModelled));
        assert_eq!(any.write(0x560, 0), Err(What::NotModelled));
        assert_eq!(any.read(0x000), Err(What::NotReadable));
        assert_eq!(any.write(0x400, 1), Err(What::NotWritable { value: 1 }));
        assert_eq!(any.write(0x104, 1), Err(What::EventSet { value: 1 }));
        let refused = What::Reserved {
            value: 0x1ff,
            reserved: 0x100,
        };
        assert_eq!(any.write(0x540, 0x1ff), Err(refused));
    }

    #[test]
    fn an_event_interrupts_once_it_is_enabled() {
        let mut any = registers();
        any.put(0x104, 1);
        assert!(!any.interrupts());
        assert_eq!(any.write(0x304, 2), Ok(Written::Stored(INTEN)));
        assert_eq!(any.read(0x308), Ok(2));
        assert!(any.interrupts());
        assert_eq!(any.write(0x104, 0), Ok(Written::Stored(0x104)));
        assert!(!any.interrupts());
    }

    #[test]
    fn registers_side_by_side_have_numbers() {
        let any = registers();
        assert_eq!(any.get(0x558), 7);
        assert_eq!(any.name_of(0x558), "ANY0.CC[3]");
        assert_eq!(any.name_of(0x55c), "ANY0+0x55c");
    }
}
