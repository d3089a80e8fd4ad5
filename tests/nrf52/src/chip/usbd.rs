//! USBD (product specification, 6.35), and a host on the other end of the cable.
//!
//! Modelled: enabling, the pull-up, resets of the bus, control transfers, bulk and interrupt endpoints 1 to 7 with their DMA,
//! suspend. Not modelled: isochronous endpoints, errors on the bus, remote wake-up, timing: a transfer takes 20 us, and an
//! interrupt endpoint is asked at the start of each frame. The host is the test's: it makes transfers, and takes packets while it
//! reads.

mod host;

use std::collections::VecDeque;

pub use host::Control;

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};
use crate::refusal::What;
use crate::time::us;

/// Bytes between the DMA registers of two endpoints.
const DMA: u32 = 0x14;
/// EVENTCAUSE: bits (6.35.13).
const READY: u32 = 1 << 11;
/// SHORTS: EP0DATADONE starts EP0STATUS.
const TO_STATUS: u32 = 1 << 2;
const TRANSFER: u64 = us(20);
/// Time between two frames.
const FRAME: u64 = us(1000);
const ASLEEP: &str = "in low-power mode (LOWPOWER: after software has finished)";
/// Most bytes of a packet.
const PACKET: u32 = 64;
const INTERRUPTS: u32 = 0x01ff_ffff;

registers![
    TASKS_STARTEPIN = task(0x004).times(8),
    TASKS_STARTEPOUT = task(0x028).times(8),
    TASKS_EP0RCVOUT = task(0x04c),
    TASKS_EP0STATUS = task(0x050),
    TASKS_EP0STALL = task(0x054),
    EVENTS_USBRESET = event(0x100),
    EVENTS_STARTED = event(0x104),
    EVENTS_ENDEPIN = event(0x108).times(8),
    EVENTS_EP0DATADONE = event(0x128),
    EVENTS_ENDEPOUT = event(0x130).times(8),
    EVENTS_USBEVENT = event(0x158),
    EVENTS_EP0SETUP = event(0x15c),
    EVENTS_EPDATA = event(0x160),
    SHORTS = read_write(0x200, 0x1f),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    EVENTCAUSE = one_clears(0x400, 1 | 0xf << 8),
    EPDATASTATUS = one_clears(0x46c, 0xfe | 0xfe << 16),
    USBADDR = read_only(0x470),
    SETUP = read_only(0x480).times(8),
    SIZE_EPOUT = read_write(0x4a0, 0x7f).times(8),
    ENABLE = read_write(0x500, 1),
    USBPULLUP = read_write(0x504, 1),
    EPINEN = read_write(0x510, 0x1ff).reset(1),
    EPOUTEN = read_write(0x514, 0x1ff).reset(1),
    EPSTALL = read_write(0x518, 0x187),
    LOWPOWER = read_write(0x52c, 1),
    EPIN_PTR = read_write(0x600, !0).times(8).every(DMA),
    EPIN_MAXCNT = read_write(EPIN_PTR + 4, 0x7f).times(8).every(DMA),
    EPOUT_PTR = read_write(0x700, !0).times(8).every(DMA),
    EPOUT_MAXCNT = read_write(EPOUT_PTR + 4, 0x7f).times(8).every(DMA),
];

/// The device, and the host.
#[derive(Default, Debug)]
pub struct Usbd {
    registers: Registers,
    /// Tick at which it is ready, once it was enabled.
    ready: Option<u64>,
    /// True from then until it is disabled.
    is_ready: bool,
    /// Tick of the next transfer on the bus, if one waits.
    transfer: Option<u64>,
    /// Tick of the next frame, if an interrupt endpoint has a packet.
    frame: Option<u64>,
    /// True while the host lets the bus sleep: it asks for nothing.
    is_suspended: bool,
    /// Interrupt IN endpoints that the host asks.
    pub polled: u32,
    /// Packets of IN endpoints that wait for the host.
    waiting: [Option<Vec<u8>>; 8],
    /// Packets of OUT endpoints that wait for the program.
    arrived: [Option<Vec<u8>>; 8],
    /// OUT endpoints that take a packet.
    armed: u32,
    /// The newest control transfer.
    pub control: Control,
    /// True while the host has opened the port: it takes packets.
    pub reads: bool,
    /// Packets that the host has taken: endpoint and bytes.
    pub taken: Vec<(usize, Vec<u8>)>,
    /// Packets that the host sends to an endpoint.
    pub to_send: VecDeque<(usize, Vec<u8>)>,
}

impl Usbd {
    /// Creates the device after a reset.
    pub fn new() -> Self {
        Self {
            registers: Registers::new("USBD", 0x4002_7000, TABLE),
            control: Control {
                is_over: true,
                ..Control::default()
            },
            ..Self::default()
        }
    }

    /// Returns true if the host sees a device.
    pub fn is_attached(&self) -> bool {
        self.registers.get(ENABLE) & self.registers.get(USBPULLUP) == 1
    }

    pub fn address(&self) -> u32 {
        self.registers.get(USBADDR)
    }

    fn cause(&mut self, bits: u32, bus: &mut Bus) {
        let causes = self.registers.get(EVENTCAUSE);
        self.registers.put(EVENTCAUSE, causes | bits);
        self.raise(EVENTS_USBEVENT, bus);
    }

    /// Whether the host takes the packets of an endpoint, not counting frames.
    fn takes(&self, endpoint: usize, is_frame: bool) -> bool {
        let is_polled = self.polled >> endpoint & 1 == 1;
        is_polled == is_frame && (is_polled || self.reads)
    }

    fn schedule(&mut self, bus: &Bus) {
        if self.is_suspended {
            return;
        }
        let waits = |is_frame| {
            (1..8)
                .any(|endpoint| self.waiting[endpoint].is_some() && self.takes(endpoint, is_frame))
        };
        let takes = waits(false);
        if waits(true) && self.frame.is_none() {
            self.frame = Some((bus.now / FRAME + 1) * FRAME);
        }
        let sends = self.to_send.front();
        let sends = sends.is_some_and(|(endpoint, _)| self.armed >> endpoint & 1 == 1);
        let control = self.waiting[0].is_some();
        if (takes || sends || control) && self.transfer.is_none() {
            self.transfer = Some(bus.now + TRANSFER);
        }
    }

    /// Pointer and length of an endpoint's DMA; refused where that is not RAM.
    fn buffer(&mut self, pointer: u32, bus: &mut Bus) -> (u32, u32) {
        let (address, length) = (self.registers.get(pointer), self.registers.get(pointer + 4));
        if length > PACKET || !bus.memory.is_ram(address, length) {
            self.refuse(pointer, bus, What::NoDma { address, length });
        }
        (address, length)
    }

    fn start_in(&mut self, endpoint: usize, bus: &mut Bus) {
        let offset = 4 * endpoint as u32;
        let is_enabled = self.registers.get(EPINEN) >> endpoint & 1 == 1;
        let when = if !is_enabled {
            Some("while the endpoint is disabled")
        } else if self.registers.get(LOWPOWER) == 1 {
            Some(ASLEEP)
        } else if self.waiting[endpoint].is_some() {
            Some("before the host has taken the last packet")
        } else {
            None
        };
        if let Some(when) = when {
            return self.untimely(TASKS_STARTEPIN + offset, bus, when);
        }
        let (address, length) = self.buffer(EPIN_PTR + DMA * endpoint as u32, bus);
        self.waiting[endpoint] = bus.memory.read(address, length);
        self.raise(EVENTS_STARTED, bus);
        self.raise(EVENTS_ENDEPIN + offset, bus);
        self.schedule(bus);
    }

    fn start_out(&mut self, endpoint: usize, bus: &mut Bus) {
        let offset = 4 * endpoint as u32;
        let is_enabled = self.registers.get(EPOUTEN) >> endpoint & 1 == 1;
        if self.registers.get(LOWPOWER) == 1 {
            return self.untimely(TASKS_STARTEPOUT + offset, bus, ASLEEP);
        }
        let Some(packet) = self.arrived[endpoint].take_if(|_| is_enabled) else {
            let when = if is_enabled {
                "before the host has sent a packet"
            } else {
                "while the endpoint is disabled"
            };
            return self.untimely(TASKS_STARTEPOUT + offset, bus, when);
        };
        let (address, length) = self.buffer(EPOUT_PTR + DMA * endpoint as u32, bus);
        if length != self.registers.get(SIZE_EPOUT + offset) {
            let expected = "that of SIZE_EPOUT (6.35.10)";
            let place = EPOUT_PTR + DMA * endpoint as u32 + 4;
            return self.unexpected(place, bus, expected);
        }
        bus.memory.write(address, &packet);
        self.raise(EVENTS_STARTED, bus);
        self.raise(EVENTS_ENDEPOUT + offset, bus);
    }

    /// The host takes packets: of interrupt endpoints at the start of a frame, or of the others.
    fn take(&mut self, is_frame: bool, bus: &mut Bus) {
        for endpoint in 1..8 {
            if !self.takes(endpoint, is_frame) {
                continue;
            }
            if let Some(packet) = self.waiting[endpoint].take() {
                self.taken.push((endpoint, packet));
                self.acknowledged(1 << endpoint, bus);
            }
        }
    }

    fn acknowledged(&mut self, endpoint: u32, bus: &mut Bus) {
        let status = self.registers.get(EPDATASTATUS);
        self.registers.put(EPDATASTATUS, status | endpoint);
        self.raise(EVENTS_EPDATA, bus);
    }

    /// A packet of the host's is there.
    fn arrive(&mut self, endpoint: usize, packet: Vec<u8>) {
        self.registers
            .put(SIZE_EPOUT + 4 * endpoint as u32, packet.len() as u32);
        self.arrived[endpoint] = Some(packet);
        self.armed &= !(1 << endpoint);
    }
}

impl Peripheral for Usbd {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let is_endpoints = (SIZE_EPOUT..ENABLE).contains(&offset) || offset > ENABLE;
        if is_endpoints && !self.is_ready {
            return self.untimely(offset, bus, "before it is ready (6.35.2)");
        }
        match offset {
            ENABLE if self.registers.get(ENABLE) == 1 => self.ready = Some(bus.now + us(50)),
            ENABLE => {
                (self.ready, self.transfer, self.frame, self.armed) = (None, None, None, 0);
                self.is_ready = false;
                (self.waiting, self.arrived) = Default::default();
            }
            SIZE_EPOUT..ENABLE => {
                self.armed |= 1 << ((offset - SIZE_EPOUT) / 4);
                self.schedule(bus);
            }
            // A disabled endpoint forgets its packet.
            EPINEN => {
                for endpoint in 1..8 {
                    if self.registers.get(EPINEN) >> endpoint & 1 == 0 {
                        self.waiting[endpoint] = None;
                    }
                }
            }
            _ => {}
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let control = [TASKS_EP0RCVOUT, TASKS_EP0STATUS, TASKS_EP0STALL].contains(&offset);
        let when = match self.registers.get(ENABLE) {
            0 => Some("while it is disabled"),
            _ if !self.is_ready => Some("before it is ready (6.35.2)"),
            _ if control && self.control.is_over => Some("without a control transfer"),
            _ => None,
        };
        if let Some(when) = when {
            return self.untimely(offset, bus, when);
        }
        match offset {
            TASKS_STARTEPIN..TASKS_STARTEPOUT => {
                self.start_in((offset - TASKS_STARTEPIN) as usize / 4, bus)
            }
            TASKS_STARTEPOUT..TASKS_EP0RCVOUT => {
                self.start_out((offset - TASKS_STARTEPOUT) as usize / 4, bus)
            }
            TASKS_EP0RCVOUT => {
                let data = self.control.data.clone();
                self.arrive(0, data);
                self.raise(EVENTS_EP0DATADONE, bus);
            }
            TASKS_EP0STALL => (self.control.is_over, self.control.is_stalled) = (true, true),
            _ => self.control.is_over = true,
        }
    }

    fn shorts(&self, event: u32) -> Vec<u32> {
        let ends = event == EVENTS_EP0DATADONE && self.registers.get(SHORTS) & TO_STATUS != 0;
        ends.then_some(TASKS_EP0STATUS).into_iter().collect()
    }

    fn next(&self) -> Option<u64> {
        let times = [self.ready, self.transfer, self.frame];
        times.into_iter().flatten().min()
    }

    fn due(&mut self, bus: &mut Bus) {
        let now = bus.now;
        if self.ready.take_if(|at| *at <= now).is_some() {
            self.is_ready = true;
            self.cause(READY, bus);
        }
        let is_frame = self.frame.take_if(|at| *at <= now).is_some();
        if is_frame {
            self.take(true, bus);
        }
        if self.transfer.take_if(|at| *at <= now).is_none() {
            return;
        }
        if let Some(packet) = self.waiting[0].take() {
            self.control.data.extend(packet);
            self.raise(EVENTS_EP0DATADONE, bus);
        }
        self.take(false, bus);
        if let Some((endpoint, packet)) = self
            .to_send
            .pop_front_if(|(endpoint, _)| self.armed >> *endpoint & 1 == 1)
        {
            self.arrive(endpoint, packet);
            self.acknowledged(1 << (16 + endpoint), bus);
        }
        self.schedule(bus);
    }
}

/// Registers without names that the workarounds of errata 171 and 187 write, after a reset.
pub fn errata() -> Registers {
    registers![
        UNLOCK = read_write(0xc00, 0xffff),
        ERRATUM171 = read_write(0xc14, 0xc0),
        ERRATUM187 = read_write(0xd14, 3),
    ];
    Registers::new("ERRATA", 0x4006_e000, TABLE)
}
