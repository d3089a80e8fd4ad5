//! Memory that the controller needs, by the macros of its header (`sdc.h`, "Memory requirement defines").

/// The configuration that decides it (`sdc_cfg_t`), with the defaults of `sdc.h`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Configuration {
    /// Links as a central.
    pub centrals: u8,
    /// Links as a peripheral. One is kept unless the program says otherwise, whatever roles it asks for.
    pub peripherals: u8,
    /// Bytes of a packet that is sent, and of one that is received.
    pub packet_bytes: [u16; 2],
    /// Packets for each link that are to be sent, and that are received.
    pub packets: [u8; 2],
    /// True if scanning or the role of a central is supported.
    pub scans: bool,
    /// True if it scans and connects at the same time.
    pub does_both: bool,
}

impl Default for Configuration {
    fn default() -> Self {
        Self {
            centrals: 1,
            peripherals: 1,
            packet_bytes: [27, 27],
            packets: [3, 2],
            scans: false,
            does_both: false,
        }
    }
}

/// Entries of the filter accept list (`SDC_DEFAULT_FAL_SIZE`).
pub const ACCEPTED: usize = 8;
/// Advertisements that are kept (`SDC_DEFAULT_SCAN_BUFFER_COUNT`).
const REPORTS: u32 = 3;

impl Configuration {
    /// Returns the bytes that the controller needs at most.
    pub fn bytes(&self) -> u32 {
        // `__MEM_ADDITIONAL_LINK_SIZE`: 15 bytes with each packet, and one of 27 bytes each way is in the base.
        let packets = self.packet_bytes.into_iter().zip(self.packets);
        let additional: u32 = packets
            .map(|(bytes, count)| u32::from(count) * (u32::from(bytes) + 15) - 42)
            .sum();
        let links = |count: u8, base: u32, shared: u32| match u32::from(count) {
            0 => 0,
            count => count * (base + additional) + shared,
        };
        let scan = if self.scans { 408 + REPORTS * 104 } else { 0 };
        let both = if self.does_both { 384 } else { 0 };
        let accepted = 4 + 8 * ACCEPTED as u32;
        links(self.centrals, 803, 21) + links(self.peripherals, 923, 17) + scan + both + accepted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_of_the_macros() {
        // 803 + 2 * 42 + 42 + 21, 923 + 2 * 42 + 42 + 17, 4 + 8 * 8.
        let default = Configuration::default();
        assert_eq!(default.bytes(), 950 + 1066 + 68);
        let central = Configuration {
            peripherals: 0,
            packets: [3, 20],
            scans: true,
            ..default
        };
        assert_eq!(central.bytes(), 803 + 2 * 42 + 19 * 42 + 21 + 720 + 68);
    }
}
