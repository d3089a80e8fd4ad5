//! The time driver of embassy, in microseconds.
//!
//! No periodic tick: an emulator that is late merges ticks, and the clock falls behind. TIMER0 runs
//! freely and is only read; TIMER1 interrupts once, at the next deadline.

use core::{cell::RefCell, task::Waker};

use cortex_m::peripheral::NVIC;
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

use super::{irq::Irq, registers::Register, straps};

const COUNTS_PER_US: u64 = 25;
/// Longest alarm. TIMER0 wraps after 171 s, and `now` has to be called at least once in between.
const LONGEST_US: u64 = 1_000_000;

const ENABLE: u32 = 1;
const ENABLE_WITH_INTERRUPT: u32 = 1 | 1 << 3;

const COUNTER: Timer = Timer::at(0x4000_0000);
const ALARM: Timer = Timer::at(0x4000_1000);

/// A CMSDK timer: counts down from `reload`.
struct Timer {
    control: Register,
    value: Register,
    reload: Register,
    clear: Register,
}

impl Timer {
    const fn at(base: usize) -> Self {
        Self {
            control: Register::at(base),
            value: Register::at(base + 0x4),
            reload: Register::at(base + 0x8),
            clear: Register::at(base + 0xc),
        }
    }
}

struct Clock {
    /// The value of TIMER0 at the last reading, and all counts until then.
    counted: Mutex<RefCell<(u32, u64)>>,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock {
    counted: Mutex::new(RefCell::new((u32::MAX, 0))),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

/// Starts both timers; until then the time is 0.
pub fn start() {
    COUNTER.reload.write(u32::MAX);
    COUNTER.value.write(u32::MAX);
    COUNTER.control.write(ENABLE);
    Irq::Alarm.unmask();
    critical_section::with(|section| CLOCK.arm(section, 0));
}

/// The interrupt handler of TIMER1.
pub fn on_alarm() {
    ALARM.clear.write(1);
    ALARM.control.write(0);
    critical_section::with(|section| CLOCK.wake_and_arm(section));
}

impl Clock {
    fn now_in(&self, section: CriticalSection<'_>) -> u64 {
        let mut counted = self.counted.borrow(section).borrow_mut();
        let value = COUNTER.value.read();
        let (last, total) = *counted;
        let total = total + u64::from(last.wrapping_sub(value));
        *counted = (value, total);
        total / (COUNTS_PER_US * straps::time_scale())
    }

    /// Wakes the tasks that are due and sets the alarm for the next deadline.
    fn wake_and_arm(&self, section: CriticalSection<'_>) {
        let mut queue = self.queue.borrow(section).borrow_mut();
        let next = queue.next_expiration(self.now_in(section));
        drop(queue);
        let wait = next.saturating_sub(self.now_in(section));
        self.arm(section, wait);
    }

    fn arm(&self, _: CriticalSection<'_>, wait_us: u64) {
        let counts = wait_us.clamp(1, LONGEST_US) * COUNTS_PER_US * straps::time_scale();
        let counts = u32::try_from(counts).unwrap_or(u32::MAX);
        ALARM.control.write(0);
        ALARM.reload.write(counts);
        ALARM.value.write(counts);
        ALARM.control.write(ENABLE_WITH_INTERRUPT);
    }
}

impl Driver for Clock {
    fn now(&self) -> u64 {
        critical_section::with(|section| self.now_in(section))
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|section| {
            let mut queue = self.queue.borrow(section).borrow_mut();
            if queue.schedule_wake(at, waker) {
                drop(queue);
                // The handler sets the alarm, or wakes the task if the deadline has passed.
                NVIC::pend(Irq::Alarm);
            }
        });
    }
}
