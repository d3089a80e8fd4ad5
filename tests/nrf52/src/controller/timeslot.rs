//! Time slots between radio events, in which the program has TIMER0 and the radio, and writes flash (mpsl_timeslot.h).

use super::{Callback, Controller, TIMER0, answer, give, needs, own, take, wrong};
use crate::chip::{Chip, Owner};
use crate::memory::Memory;
use crate::refusal::What;
use crate::time::{ms, us};

/// Bytes that a session needs (`MPSL_TIMESLOT_CONTEXT_SIZE`).
const SESSION: u32 = 96;
/// Signals (`MPSL_TIMESLOT_SIGNAL`).
const START: u32 = 0;
const BLOCKED: u32 = 5;
const IDLE: u32 = 7;
const CLOSED: u32 = 9;
/// Actions (`MPSL_TIMESLOT_SIGNAL_ACTION`).
const END: u8 = 2;
const REQUEST: u8 = 3;
/// Ticks from a request to the earliest start.
const EARLIEST: u64 = us(500);
/// Ticks that a connection event takes of the air, with time to prepare the next one. A guess.
const RADIO: u64 = ms(3);

/// A request (`mpsl_timeslot_request_earliest_t`).
#[derive(Clone, Copy, Debug)]
struct Wanted {
    length: u64,
    timeout: u64,
    is_urgent: bool,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
enum TimeslotState {
    #[default]
    Idle,
    /// It starts then, for so long.
    Requested { at: u64, length: u64 },
    /// It is blocked then.
    Blocked { at: u64 },
    /// It has begun then; its start is not yet signalled.
    Granted { since: u64, length: u64 },
    /// It has begun then, and the program uses it.
    Running { since: u64, length: u64 },
}

/// Time slots of the only session.
#[derive(Default, Debug)]
pub struct Timeslot {
    /// The sessions' memory, and what it holds.
    pub(super) memory: Option<(u32, Vec<u8>)>,
    /// The session's callback, while it is open.
    callback: Option<u32>,
    state: TimeslotState,
    /// Number of requests, from the next one on, that find no time, but for urgent ones.
    pub blocked: usize,
    /// Number of time slots that have begun.
    pub begun: usize,
}

impl Timeslot {
    /// Resets the slots; what a test has asked for stays.
    pub fn reset(&mut self) {
        *self = Self {
            blocked: self.blocked,
            begun: self.begun,
            ..Self::default()
        };
    }

    /// Returns true while the radio is the program's.
    pub const fn is_granted(&self) -> bool {
        matches!(
            self.state,
            TimeslotState::Granted { .. } | TimeslotState::Running { .. }
        )
    }

    pub(super) const fn next(&self) -> Option<u64> {
        match self.state {
            TimeslotState::Requested { at, .. } | TimeslotState::Blocked { at } => Some(at),
            _ => None,
        }
    }

    /// The interrupt of TIMER0: what to call, if a slot begins.
    pub(super) fn begin(&mut self) -> Option<Callback> {
        let TimeslotState::Granted { since, length } = self.state else {
            return None;
        };
        self.state = TimeslotState::Running { since, length };
        self.begun += 1;
        self.callback.map(|function| Callback {
            function,
            arguments: [0, START],
        })
    }
}

impl Controller {
    pub(super) fn set_sessions(
        &mut self,
        [at, count, ..]: [u32; 4],
        memory: &Memory,
    ) -> Result<i32, What> {
        needs(self.timeslot.callback.is_none(), "while a session is open")?;
        needs(at.is_multiple_of(4), "with memory that is not aligned")?;
        needs(
            count & 0xff == 1,
            "for several sessions, which are not modelled",
        )?;
        self.timeslot.memory = Some(own(memory, at, SESSION)?);
        Ok(answer::SUCCESS)
    }

    pub(super) fn open_session(
        &mut self,
        [callback, id, ..]: [u32; 4],
        memory: &Memory,
    ) -> Result<i32, What> {
        let is_free = self.timeslot.memory.is_some() && self.timeslot.callback.is_none();
        needs(is_free, "beyond the sessions that there are")?;
        give(memory, id, &[0])?;
        self.timeslot.callback = Some(callback);
        Ok(answer::SUCCESS)
    }

    pub(super) fn close_session(&mut self, [id, ..]: [u32; 4]) -> i32 {
        match self.timeslot.callback.take_if(|_| id as u8 == 0) {
            Some(callback) => {
                self.timeslot.state = TimeslotState::Idle;
                self.call_later(callback, [0, CLOSED]);
                answer::SUCCESS
            }
            None => answer::AGAIN,
        }
    }

    pub(super) fn request_slot(
        &mut self,
        [id, request, ..]: [u32; 4],
        chip: &Chip,
    ) -> Result<i32, What> {
        let is_open = self.timeslot.callback.is_some() && id as u8 == 0;
        needs(is_open, "of a session that is not open")?;
        let is_idle = self.timeslot.state == TimeslotState::Idle;
        needs(is_idle, "before the request before is answered")?;
        self.schedule(wanted(request, &chip.bus.memory)?, chip.bus.now);
        Ok(answer::SUCCESS)
    }

    /// Finds time for a slot: after the next connection event, or in place of some where it is urgent.
    fn schedule(&mut self, wanted: Wanted, now: u64) {
        let Wanted {
            length,
            timeout,
            is_urgent,
        } = wanted;
        let fits = length + RADIO <= self.air.interval_ticks();
        let is_blocked = self.timeslot.blocked > 0 && !is_urgent;
        self.timeslot.blocked -= usize::from(is_blocked);
        let at = match self.air.next_connection_event() {
            None => Some(now + EARLIEST),
            Some(event) if fits => Some(event + RADIO),
            Some(_) if is_urgent => Some(now + EARLIEST),
            Some(_) => None,
        };
        self.timeslot.state = match at.filter(|at| !is_blocked && at.saturating_sub(now) <= timeout)
        {
            Some(at) => TimeslotState::Requested { at, length },
            None => TimeslotState::Blocked { at: now + timeout },
        };
    }

    pub(super) fn advance_timeslot(&mut self, chip: &mut Chip) {
        let now = chip.bus.now;
        match self.timeslot.state {
            TimeslotState::Requested { at, length } if at <= now => {
                self.timeslot.state = TimeslotState::Granted { since: now, length };
                chip.owner = Owner::TimeSlot;
                chip.start_slot_timer();
                self.interrupts.push(TIMER0);
            }
            TimeslotState::Blocked { at } if at <= now => {
                self.timeslot.state = TimeslotState::Idle;
                self.signal(BLOCKED);
            }
            _ => {}
        }
    }

    fn signal(&mut self, signal: u32) {
        if let Some(callback) = self.timeslot.callback {
            self.call_later(callback, [0, signal]);
        }
    }

    /// The callback has returned from the start of a slot, with what it wants (`mpsl_timeslot_signal_return_param_t`).
    pub(super) fn end_of_start(&mut self, wants: u32, chip: &mut Chip) -> Result<(), What> {
        let now = chip.bus.now;
        if let TimeslotState::Running { since, length } = self.timeslot.state
            && now - since > length
        {
            let (took, granted) = ((now - since) / us(1), length / us(1));
            return Err(wrong(&format!(
                "that took {took} us of a slot of {granted}"
            )));
        }
        needs(chip.nvmc.is_read_only(), "that left flash writable")?;
        chip.owner = Owner::Controller;
        chip.stop_slot_timer();
        self.timeslot.state = TimeslotState::Idle;
        match take(&chip.bus.memory, wants, 1)?[0] {
            END => self.signal(IDLE),
            REQUEST => {
                let request = chip.bus.memory.word(wants + 4).unwrap_or_default();
                self.schedule(wanted(request, &chip.bus.memory)?, now);
            }
            action => {
                return Err(wrong(&format!(
                    "with action {action}, which is not modelled"
                )));
            }
        }
        Ok(())
    }
}

fn wanted(request: u32, memory: &Memory) -> Result<Wanted, What> {
    const EARLIEST_KIND: u8 = 0;
    let bytes = take(memory, request, 16)?;
    let word = |offset: u32| memory.word(request + offset).unwrap_or_default();
    let (length, timeout) = (word(8), word(12));
    let (kind, clock, priority) = (bytes[0], bytes[4], bytes[5]);
    let is_earliest = kind == EARLIEST_KIND;
    needs(
        is_earliest,
        "for another slot than the earliest, which is not modelled",
    )?;
    let is_allowed =
        (100..=100_000).contains(&length) && timeout < 256_000_000 && clock <= 1 && priority <= 1;
    needs(is_allowed, "for a slot that cannot be")?;
    Ok(Wanted {
        length: us(length.into()),
        timeout: us(timeout.into()),
        is_urgent: priority == 0,
    })
}
