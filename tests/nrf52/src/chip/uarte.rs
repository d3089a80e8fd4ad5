//! UARTE (product specification, 6.34): both directions by DMA. Flow control, parity and stopping the transmitter are not
//! modelled.

use std::collections::VecDeque;

use super::bus::{Bus, Peripheral};
use super::register::{
    INTEN, Register, Registers, clear, event, one_clears, read_only, read_write, set, task,
};
use crate::refusal::What;
use crate::time::HZ;

const STARTRX: u32 = 0x000;
const STOPRX: u32 = 0x004;
const STARTTX: u32 = 0x008;
const FLUSHRX: u32 = 0x02c;
const RXDRDY: u32 = 0x108;
const ENDRX: u32 = 0x110;
const TXDRDY: u32 = 0x11c;
const ENDTX: u32 = 0x120;
const ERROR: u32 = 0x124;
const RXTO: u32 = 0x144;
const RXSTARTED: u32 = 0x14c;
const TXSTARTED: u32 = 0x150;
const SHORTS: u32 = 0x200;
const ERRORSRC: u32 = 0x480;
const ENABLE: u32 = 0x500;
const PSEL: u32 = 0x508;
const PSEL_TXD: u32 = 0x50c;
const PSEL_RXD: u32 = 0x514;
const BAUDRATE: u32 = 0x524;
const RXD_PTR: u32 = 0x534;
const RXD_AMOUNT: u32 = 0x53c;
const TXD_PTR: u32 = 0x544;
const TXD_AMOUNT: u32 = 0x54c;
const CONFIG: u32 = 0x56c;
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

macro_rules! table {
    ($count:literal) => {
        &[
            task("TASKS_STARTRX", STARTRX),
            task("TASKS_STOPRX", STOPRX),
            task("TASKS_STARTTX", STARTTX),
            task("TASKS_FLUSHRX", FLUSHRX),
            event("EVENTS_CTS", 0x100),
            event("EVENTS_NCTS", 0x104),
            event("EVENTS_RXDRDY", RXDRDY),
            event("EVENTS_ENDRX", ENDRX),
            event("EVENTS_TXDRDY", TXDRDY),
            event("EVENTS_ENDTX", ENDTX),
            event("EVENTS_ERROR", ERROR),
            event("EVENTS_RXTO", RXTO),
            event("EVENTS_RXSTARTED", RXSTARTED),
            event("EVENTS_TXSTARTED", TXSTARTED),
            event("EVENTS_TXSTOPPED", 0x158),
            read_write("SHORTS", SHORTS, 3 << 5),
            read_write("INTEN", INTEN, INTERRUPTS),
            set("INTENSET", 0x304, INTEN, INTERRUPTS),
            clear("INTENCLR", 0x308, INTEN, INTERRUPTS),
            one_clears("ERRORSRC", ERRORSRC, 0xf),
            read_write("ENABLE", ENABLE, 0xf),
            read_write("PSEL", PSEL, DISCONNECTED | 0x3f)
                .times(4)
                .reset(!0),
            read_write("BAUDRATE", BAUDRATE, !0).reset(0x0400_0000),
            read_write("RXD.PTR", RXD_PTR, !0),
            read_write("RXD.MAXCNT", RXD_PTR + 4, $count),
            read_only("RXD.AMOUNT", RXD_AMOUNT),
            read_write("TXD.PTR", TXD_PTR, !0),
            read_write("TXD.MAXCNT", TXD_PTR + 4, $count),
            read_only("TXD.AMOUNT", TXD_AMOUNT),
            read_write("CONFIG", CONFIG, 0x1f),
        ]
    };
}

/// Lengths have 16 bits on the nRF52840, 8 on the nRF52832.
const LONG: &[Register] = table!(0xffff);
const SHORT: &[Register] = table!(0xff);

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

#[derive(Debug)]
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
    /// Bytes that came and found no place.
    pub overruns: u64,
    /// True if RXDRDY comes for a byte whose stop bit is missing too. The specification says that such a byte is not stored
    /// (6.34.4), and not if it is counted.
    pub counts_broken: bool,
}

impl Uarte {
    /// After a reset; what is on the line does not care.
    pub fn new(short_lengths: bool, before: Option<Self>) -> Self {
        let table = if short_lengths { SHORT } else { LONG };
        let (line, sent, overruns, counts_broken) =
            before.map_or_else(Default::default, |before| {
                let Self {
                    line,
                    sent,
                    overruns,
                    counts_broken,
                    ..
                } = before;
                (line, sent, overruns, counts_broken)
            });
        Self {
            registers: Registers::new("UARTE0", 0x4000_2000, table),
            sending: None,
            receiving: None,
            listens: false,
            stops: None,
            fifo: VecDeque::new(),
            line,
            sent,
            overruns,
            counts_broken,
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
        self.raise(ERROR, bus);
    }

    /// A byte is over on the line.
    fn take(&mut self, received: Received, bus: &mut Bus) {
        if !self.listens {
            return;
        }
        if received.is_broken || bus.fast().abs() > TOLERANCE {
            // It is not stored; those that follow are (6.34.4).
            if self.counts_broken {
                self.raise(RXDRDY, bus);
            }
            return self.error(FRAMING, bus);
        }
        if self.fifo.len() == FIFO {
            self.overruns += 1;
            return self.error(OVERRUN, bus);
        }
        self.fifo.push_back(received.byte);
        self.raise(RXDRDY, bus);
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
            self.raise(ENDRX, bus);
        }
    }

    /// The receiver stops: ENDRX comes before RXTO (6.34.3).
    fn stop(&mut self, bus: &mut Bus) {
        self.end_reception(bus);
        (self.listens, self.stops) = (false, None);
        self.raise(RXTO, bus);
    }

    /// Starts a transfer of either direction.
    fn start(&mut self, is_send: bool, bus: &mut Bus) {
        if is_send {
            let buffer = self.buffer(TXD_PTR, bus);
            self.raise(TXSTARTED, bus);
            if buffer.length == 0 {
                self.raise(ENDTX, bus);
            } else {
                self.sending = Some((buffer, bus.now + Self::byte_ticks(bus)));
            }
        } else {
            let buffer = self.buffer(RXD_PTR, bus);
            self.raise(RXSTARTED, bus);
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
            PSEL..=PSEL_RXD | BAUDRATE | CONFIG if self.is_enabled() => "it has to be disabled",
            _ => return,
        };
        self.unexpected(offset, bus, expected);
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let is_send = offset == STARTTX;
        let pin = if is_send { PSEL_TXD } else { PSEL_RXD };
        let is_busy = match offset {
            STARTTX => self.sending.is_some(),
            STARTRX | FLUSHRX => self.receiving.is_some(),
            _ => false,
        };
        let when = match offset {
            _ if !self.is_enabled() => "while it is disabled",
            _ if self.registers.get(pin) & DISCONNECTED != 0 => "without a pin",
            _ if is_busy => "while the transfer before is under way",
            STOPRX if !self.listens => "while the receiver is stopped",
            STOPRX if self.registers.get(SHORTS) & RESTARTS != 0 => {
                "while the shortcut from ENDRX would start it again"
            }
            FLUSHRX if self.listens => "before RXTO",
            _ => "",
        };
        if !when.is_empty() {
            return self.untimely(offset, bus, when);
        }
        match offset {
            STOPRX => self.stops = Some(bus.now + STOPPING * Self::byte_ticks(bus)),
            FLUSHRX => self.flush(bus),
            _ => self.start(is_send, bus),
        }
    }

    fn shorts(&self, event: u32) -> Vec<u32> {
        let restarts = event == ENDRX && self.registers.get(SHORTS) & RESTARTS != 0;
        restarts.then_some(STARTRX).into_iter().collect()
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
            self.raise(TXDRDY, bus);
            if buffer.done == buffer.length {
                self.registers.put(TXD_AMOUNT, buffer.done);
                self.raise(ENDTX, bus);
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
