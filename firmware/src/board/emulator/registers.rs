//! Registers of the CMSDK peripherals (Arm DDI 0479), the only place here that touches them.

/// One 32-bit register.
#[derive(Clone, Copy)]
pub struct Register(usize);

impl Register {
    /// The register at an address of the peripheral region.
    pub const fn at(address: usize) -> Self {
        assert!(address >= 0x4000_0000 && address < 0x4003_0000 && address.is_multiple_of(4));
        Self(address)
    }

    /// Reads it, side effects included.
    #[expect(unsafe_code, reason = "there is no other way to a register")]
    pub fn read(self) -> u32 {
        // SAFETY: `at` admits only aligned addresses of the peripheral region, which is never
        // memory of the program.
        unsafe { core::ptr::with_exposed_provenance::<u32>(self.0).read_volatile() }
    }

    /// Writes it, side effects included.
    #[expect(unsafe_code, reason = "there is no other way to a register")]
    pub fn write(self, value: u32) {
        // SAFETY: as for `read`.
        unsafe { core::ptr::with_exposed_provenance_mut::<u32>(self.0).write_volatile(value) }
    }
}
