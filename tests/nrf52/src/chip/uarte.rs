//! UARTE (product specification, 6.34): both directions by DMA. Flow control, parity and stopping the transmitter are not
//! modelled.

use std::collections::VecDeque;

use super::bus::{Bus, Peripheral};
use super::register::{Registers, registers};
use crate::refusal::What;
use crate::time::HZ;

/// Bits of events whose interrupt can be enabled.
const INTERRUPTS: u32 = 0x7 | 1 << 4 | 7 << 7 | 1 << 17 | 3 << 19 | 1 << 22;

const ENABLED: u32 = 8;
const DISCONNECTED: u32 = 1 << 31;
/// The value of BAUDRATE for 115200 baud, and the baud rate that comes of it (6.34.9.17).
const BAUD_115200: u32 = 0x01d6_0000;
const BAUD: u64 = 115_108;
/// Start, eight bits, stop.
const BITS: u64 = 10;
/// Bytes that wait while no buffer is given (6.34.3 promises four after the receiver was told to stop).
const FIFO: usize = 4;
/// Thousandths by which two clocks may differ: half a bit at the middle of the stop bit, nine and a half bits on.
const TOLERANCE: i64 = 1000 / 19;
/// Times of a byte from STOPRX to RXTO: four more may come (6.34.3).
const STOPPING: u64 = 5;
/// SHORTS: ENDRX starts STARTRX.
const RESTARTS: u32 = 1 << 5;
/// ERRORSRC: a byte came while the FIFO was full; a stop bit was missing.
const OVERRUN: u32 = 1;
const FRAMING: u32 = 1 << 2;

registers![
    TASKS_STARTRX = task(0x000),
    TASKS_STOPRX = task(0x004),
    TASKS_STARTTX = task(0x008),
    TASKS_FLUSHRX = task(0x02c),
    EVENTS_CTS = event(0x100),
    EVENTS_NCTS = event(0x104),
    EVENTS_RXDRDY = event(0x108),
    EVENTS_ENDRX = event(0x110),
    EVENTS_TXDRDY = event(0x11c),
    EVENTS_ENDTX = event(0x120),
    EVENTS_ERROR = event(0x124),
    EVENTS_RXTO = event(0x144),
    EVENTS_RXSTARTED = event(0x14c),
    EVENTS_TXSTARTED = event(0x150),
    EVENTS_TXSTOPPED = event(0x158),
    SHORTS = read_write(0x200, 3 << 5),
    INTEN = read_write(0x300, INTERRUPTS),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    ERRORSRC = one_clears(0x480, 0xf),
    ENABLE = read_write(0x500, 0xf),
    PSEL_RTS = read_write(0x508, DISCONNECTED | 0x3f).reset(!0),
    PSEL_TXD = read_write(0x50c, DISCONNECTED | 0x3f).reset(!0),
    PSEL_CTS = read_write(0x510, DISCONNECTED | 0x3f).reset(!0),
    PSEL_RXD = read_write(0x514, DISCONNECTED | 0x3f).reset(!0),
    BAUDRATE = read_write(0x524, !0).reset(0x0400_0000),
    RXD_PTR = read_write(0x534, !0),
    RXD_MAXCNT = read_write(RXD_PTR + 4, 0xffff),
    RXD_AMOUNT = read_only(0x53c),
    TXD_PTR = read_write(0x544, !0),
    TXD_MAXCNT = read_write(TXD_PTR + 4, 0xffff),
    TXD_AMOUNT = read_only(0x54c),
    CONFIG = read_write(0x56c, 0x1f),
];

/// Mask of a length on the nRF52832; on the nRF52840 it has 16 bits.
const SHORT: u32 = 0xff;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Received {
    /// Tick at which its last bit is over.
    pub at: u64,
    pub byte: u8,
    /// True if its stop bit is missing.
    pub is_broken: bool,
}

#[derive(Clone, Copy, Debug)]
struct Buffer {
    address: u32,
    length: u32,
    done: u32,
}

#[derive(Default, Debug)]
pub struct Uarte {
    registers: Registers,
    sending: Option<(Buffer, u64)>,
    receiving: Option<Buffer>,
    /// True from STARTRX to RXTO.
    listens: bool,
    /// Tick of RXTO, once the receiver was told to stop.
    stops: Option<u64>,
    fifo: VecDeque<u8>,
    /// Bytes that are still to come, by time.
    pub line: VecDeque<Received>,
    /// Bytes that were sent, each with the tick at which its last bit was over.
    pub sent: Vec<(u64, u8)>,
    /// True if RXDRDY comes for a byte whose stop bit is missing too. The specification says that such a byte is not stored
    /// (6.34.4), and not if it is counted.
    pub counts_broken: bool,
}

impl Uarte {
    pub fn new(short_lengths: bool) -> Self {
        let mut registers = Registers::new("UARTE0", 0x4000_2000, TABLE);
        if short_lengths {
            let lengths = [RXD_MAXCNT, TXD_MAXCNT];
            registers = registers.changed(&lengths, |length| length.mask = SHORT);
        }
        Self {
            registers,
            ..Self::default()
        }
    }

    const fn byte_ticks(bus: &Bus) -> u64 {
        // Within 10 % of 1000.
        HZ * BITS * 1000 / (BAUD * (1000 + bus.fast()).cast_unsigned())
    }

    fn is_enabled(&self) -> bool {
        self.registers.get(ENABLE) == ENABLED
    }

    /// The pins by which it sends and receives, while it is enabled.
    pub fn pins(&self) -> [Option<u32>; 2] {
        [PSEL_TXD, PSEL_RXD].map(|offset| {
            let pin = self.registers.get(offset);
            (self.is_enabled() && pin & DISCONNECTED == 0).then_some(pin & 0x3f)
        })
    }

    fn buffer(&mut self, pointer: u32, bus: &mut Bus) -> Buffer {
        let (address, length) = (self.registers.get(pointer), self.registers.get(pointer + 4));
        if !bus.memory.is_ram(address, length) {
            self.refuse(pointer, bus, What::NoDma { address, length });
        }
        Buffer {
            address,
            length,
            done: 0,
        }
    }

    fn error(&mut self, source: u32, bus: &mut Bus) {
        let sources = self.registers.get(ERRORSRC);
        self.registers.put(ERRORSRC, sources | source);
        self.raise(EVENTS_ERROR, bus);
    }

    /// A byte is over on the line.
    fn take(&mut self, received: Received, bus: &mut Bus) {
        if !self.listens {
            return;
        }
        if received.is_broken || bus.fast().abs() > TOLERANCE {
            // It is not stored; those that follow are (6.34.4).
            if self.counts_broken {
                self.raise(EVENTS_RXDRDY, bus);
            }
            return self.error(FRAMING, bus);
        }
        if self.fifo.len() == FIFO {
            return self.error(OVERRUN, bus);
        }
        self.fifo.push_back(received.byte);
        self.raise(EVENTS_RXDRDY, bus);
        self.drain(bus);
    }

    /// Moves bytes from the FIFO to RAM.
    fn drain(&mut self, bus: &mut Bus) {
        while let Some(mut buffer) = self.receiving
            && let Some(byte) = self.fifo.pop_front()
        {
            bus.memory.write(buffer.address + buffer.done, &[byte]);
            buffer.done += 1;
            self.receiving = Some(buffer);
            if buffer.done == buffer.length {
                self.end_reception(bus);
            }
        }
    }

    fn end_reception(&mut self, bus: &mut Bus) {
        if let Some(buffer) = self.receiving.take() {
            self.registers.put(RXD_AMOUNT, buffer.done);
            self.raise(EVENTS_ENDRX, bus);
        }
    }

    /// The receiver stops: ENDRX comes before RXTO (6.34.3).
    fn stop(&mut self, bus: &mut Bus) {
        self.end_reception(bus);
        (self.listens, self.stops) = (false, None);
        self.raise(EVENTS_RXTO, bus);
    }

    /// Starts a transfer of either direction.
    fn start(&mut self, is_send: bool, bus: &mut Bus) {
        if is_send {
            let buffer = self.buffer(TXD_PTR, bus);
            self.raise(EVENTS_TXSTARTED, bus);
            if buffer.length == 0 {
                self.raise(EVENTS_ENDTX, bus);
            } else {
                self.sending = Some((buffer, bus.now + Self::byte_ticks(bus)));
            }
        } else {
            let buffer = self.buffer(RXD_PTR, bus);
            self.raise(EVENTS_RXSTARTED, bus);
            self.listens = true;
            self.receiving = Some(buffer);
            self.drain(bus);
        }
    }

    /// Moves what the FIFO still holds to RAM; ENDRX comes even if that is nothing (6.34.3).
    fn flush(&mut self, bus: &mut Bus) {
        let buffer = self.buffer(RXD_PTR, bus);
        self.receiving = Some(buffer);
        self.drain(bus);
        self.end_reception(bus);
    }
}

impl Peripheral for Uarte {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        let expected = match offset {
            ENABLE if value != 0 && value != ENABLED => "0 or 8",
            BAUDRATE if value != BAUD_115200 => "0x01d60000, 115200 baud: no other is modelled",
            CONFIG if value != 0 => "0: flow control, parity and two stop bits are not modelled",
            ENABLE if value == 0 && self.sending.is_some() => "the transmitter has to end first",
            ENABLE if value == 0 => {
                (self.receiving, self.listens, self.stops) = (None, false, None);
                return self.fifo.clear();
            }
            // Only while it is disabled (6.34.1).
            PSEL_RTS..=PSEL_RXD | BAUDRATE | CONFIG if self.is_enabled() => "it has to be disabled",
            _ => return,
        };
        self.unexpected(offset, bus, expected);
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let is_send = offset == TASKS_STARTTX;
        let pin = if is_send { PSEL_TXD } else { PSEL_RXD };
        let is_busy = match offset {
            TASKS_STARTTX => self.sending.is_some(),
            TASKS_STARTRX | TASKS_FLUSHRX => self.receiving.is_some(),
            _ => false,
        };
        let when = match offset {
            _ if !self.is_enabled() => "while it is disabled",
            _ if self.registers.get(pin) & DISCONNECTED != 0 => "without a pin",
            _ if is_busy => "while the transfer before is under way",
            TASKS_STOPRX if !self.listens => "while the receiver is stopped",
            TASKS_STOPRX if self.registers.get(SHORTS) & RESTARTS != 0 => {
                "while the shortcut from ENDRX would start it again"
            }
            TASKS_FLUSHRX if self.listens => "before RXTO",
            _ => "",
        };
        if !when.is_empty() {
            return self.untimely(offset, bus, when);
        }
        match offset {
            TASKS_STOPRX => self.stops = Some(bus.now + STOPPING * Self::byte_ticks(bus)),
            TASKS_FLUSHRX => self.flush(bus),
            _ => self.start(is_send, bus),
        }
    }

    fn shorts(&self, event: u32) -> Vec<u32> {
        let restarts = event == EVENTS_ENDRX && self.registers.get(SHORTS) & RESTARTS != 0;
        restarts.then_some(TASKS_STARTRX).into_iter().collect()
    }

    fn next(&self) -> Option<u64> {
        let sends = self.sending.map(|(_, at)| at);
        let receives = self.line.front().map(|received| received.at);
        [sends, receives, self.stops].into_iter().flatten().min()
    }

    fn due(&mut self, bus: &mut Bus) {
        if let Some((mut buffer, at)) = self.sending.filter(|(_, at)| *at <= bus.now) {
            let byte = bus.memory.read(buffer.address + buffer.done, 1);
            // A receiver whose clock is right takes another bit for the last one.
            let wrong = u8::from(bus.fast().abs() > TOLERANCE) << 7;
            self.sent.extend(byte.map(|byte| (at, byte[0] ^ wrong)));
            buffer.done += 1;
            self.sending = None;
            self.raise(EVENTS_TXDRDY, bus);
            if buffer.done == buffer.length {
                self.registers.put(TXD_AMOUNT, buffer.done);
                self.raise(EVENTS_ENDTX, bus);
            } else {
                self.sending = Some((buffer, at + Self::byte_ticks(bus)));
            }
        }
        while let Some(received) = self.line.pop_front_if(|received| received.at <= bus.now) {
            self.take(received, bus);
        }
        if self.stops.is_some_and(|at| at <= bus.now) {
            self.stop(bus);
        }
    }
}
