//! The controller's start: roles, memory, random numbers (sdc.h, sdc_soc.h).

use super::memory::Configuration;
use super::mpsl::WORST_ACCURACY;
use super::{Controller, answer, check_priorities, needs, own, take, wrong};
use crate::chip::Chip;
use crate::core::Core;
use crate::memory::{Memory, halves};
use crate::refusal::What;

/// Kinds of configuration (`sdc_cfg_type`).
const CENTRAL_COUNT: u32 = 1;
const PERIPHERAL_COUNT: u32 = 2;
const BUFFERS: u32 = 3;
/// Bytes of random numbers that the controller asks for at its start, at the beginning of its memory.
const RANDOM: u32 = 16;

/// The controller, as far as it is configured.
#[derive(Default, Debug)]
pub struct Sdc {
    is_initialized: bool,
    is_configured: bool,
    roles: Vec<String>,
    /// Configuration that decides about memory.
    pub configuration: Configuration,
    random: Option<u32>,
    /// Function to call when there is something for the program.
    pub(super) callback: Option<u32>,
    /// Memory that the controller was given: its address and content.
    pub(super) memory: Option<(u32, Vec<u8>)>,
}

impl Sdc {
    pub(super) const fn is_enabled(&self) -> bool {
        self.callback.is_some()
    }
}

impl Controller {
    /// Returns the bytes that the controller needs for what the program has asked of it.
    pub fn needed_bytes(&self) -> u32 {
        self.sdc.configuration.bytes() + self.more_bytes
    }

    pub(super) fn configure(
        &mut self,
        name: &str,
        arguments: [u32; 4],
        chip: &Chip,
        core: &Core,
    ) -> Result<i32, What> {
        let memory = &chip.bus.memory;
        let [first, second, third, _] = arguments;
        if name == "sdc_init" {
            let is_accurate = self.mpsl.accuracy <= WORST_ACCURACY;
            needs(is_accurate, "with a clock that is not accurate enough")?;
            needs(first != 0, "without a handler of faults")?;
            self.sdc.is_initialized = true;
            return Ok(answer::SUCCESS);
        }
        needs(self.sdc.is_initialized, "before sdc_init")?;
        needs(!self.sdc.is_enabled(), "after sdc_enable")?;
        if let Some(role) = name.strip_prefix("sdc_support_") {
            return self.support(role);
        }
        match name {
            "sdc_cfg_set" => self.set_configuration(first, second, third, memory),
            "sdc_rand_source_register" => {
                let [low, high] = halves(&take(memory, first, 4)?, 0);
                self.sdc.random = Some(u32::from(low) | u32::from(high) << 16);
                Ok(answer::SUCCESS)
            }
            "sdc_enable" => {
                check_priorities(core)?;
                self.enable(first, second, memory)
            }
            _ => Err(What::UnknownCall { arguments }),
        }
    }

    /// A role or a feature that is to be supported.
    fn support(&mut self, role: &str) -> Result<i32, What> {
        needs(!self.sdc.is_configured, "after sdc_cfg_set")?;
        let has = |one: &str| role == one || self.sdc.roles.iter().any(|known| known == one);
        if has("scan") && has("central") {
            return Err(wrong(
                "beside the other of sdc_support_scan and sdc_support_central: the latter includes the former",
            ));
        }
        self.sdc.configuration.scans |= matches!(role, "scan" | "central");
        self.sdc.configuration.does_both |= role == "parallel_scanning_and_initiating";
        self.sdc.roles.push(role.to_owned());
        Ok(answer::SUCCESS)
    }

    /// Answers with the bytes that are needed.
    fn set_configuration(
        &mut self,
        tag: u32,
        kind: u32,
        at: u32,
        memory: &Memory,
    ) -> Result<i32, What> {
        needs(
            tag as u8 == 0,
            "for another configuration than the default's",
        )?;
        self.sdc.is_configured = true;
        let configuration = &mut self.sdc.configuration;
        match kind & 0xff {
            0 => {}
            CENTRAL_COUNT => configuration.centrals = take(memory, at, 1)?[0],
            PERIPHERAL_COUNT => configuration.peripherals = take(memory, at, 1)?[0],
            BUFFERS => {
                // `sdc_cfg_buffer_cfg_t`.
                let bytes = take(memory, at, 6)?;
                let lengths = [[bytes[0], bytes[1]], [bytes[2], bytes[3]]];
                configuration.packet_bytes = lengths.map(u16::from_le_bytes);
                configuration.packets = [bytes[4], bytes[5]];
                let lengths = &configuration.packet_bytes;
                let in_range = lengths.iter().all(|bytes| (27..=251).contains(bytes));
                let has_packets = !configuration.packets.contains(&0);
                needs(in_range && has_packets, "for packets that cannot be")?;
            }
            _ => return Err(wrong(&format!("of kind {kind}, which is not modelled"))),
        }
        Ok(self.needed_bytes().cast_signed())
    }

    fn enable(&mut self, callback: u32, at: u32, memory: &Memory) -> Result<i32, What> {
        let random = self.sdc.random;
        let random = random.ok_or_else(|| wrong("before sdc_rand_source_register"))?;
        let fits = callback != 0 && at.is_multiple_of(8);
        needs(
            fits,
            "without a callback, or with memory that is not aligned",
        )?;
        self.sdc.memory = Some(own(memory, at + RANDOM, self.needed_bytes() - RANDOM)?);
        self.sdc.callback = Some(callback);
        self.call_later(random, [at, RANDOM]);
        Ok(answer::SUCCESS)
    }
}
