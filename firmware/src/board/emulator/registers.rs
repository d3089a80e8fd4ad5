//! Registers of the CMSDK peripherals (Arm DDI 0479): the only code that accesses them.

/// A 32-bit register.
#[derive(Clone, Copy)]
pub struct Register(usize);

impl Register {
    /// The register at an address in the peripheral region.
    pub const fn at(address: usize) -> Self {
        assert!(address >= 0x4000_0000 && address < 0x4003_0000 && address.is_multiple_of(4));
        Self(address)
    }

    /// Reads it, side effects included.
    #[expect(unsafe_code, reason = "a register is accessed by its address")]
    pub fn read(self) -> u32 {
        // SAFETY: `at` admits only aligned addresses in the peripheral region, which holds no
        // memory of the program, so the access aliases no Rust object. Every value is a valid
        // `u32`. An address without a peripheral causes a bus fault, which the program handles.
        unsafe { core::ptr::with_exposed_provenance::<u32>(self.0).read_volatile() }
    }

    /// Writes it, side effects included.
    #[expect(unsafe_code, reason = "a register is accessed by its address")]
    pub fn write(self, value: u32) {
        // SAFETY: as for `read`; no value written to these peripherals makes them access the
        // program's memory, for none of them has DMA.
        unsafe { core::ptr::with_exposed_provenance_mut::<u32>(self.0).write_volatile(value) }
    }
}
