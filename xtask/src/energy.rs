//! Estimate on paper of what a board takes from its battery, by instruction counts and the data sheet's currents.

use std::fmt;

use anyhow::Result;

use crate::count::{self, CountTable};

/// Microseconds of one byte at 1 Mbit/s.
const BYTE_US: f64 = 8.0;
/// Bytes of a packet around its payload: preamble, access address, header, checksum (Bluetooth Core, Vol 6, Part B, 2.1).
const FRAME: f64 = 1.0 + 4.0 + 2.0 + 3.0;
/// Bytes of a notification: L2CAP and ATT headers, two samples.
const NOTIFICATION: f64 = 4.0 + 3.0 + 16.0;
/// Between two packets (T_IFS, 4.1.1).
const SPACE_US: f64 = 150.0;
/// The transmitter's start-up without fast ramp-up (nRF52840 product specification, RADIO, TXEN).
const RAMP_UP_US: f64 = 140.0;
const NOTIFICATIONS: f64 = 100.0;
/// Processor time of the Bluetooth stack for one connection event: assumed, not measured.
const STACK_US: f64 = 200.0;
const CLOCK_MHZ: f64 = 64.0;
const PATCH_US: f64 = 50_000.0;
/// Two for each of the words of weights and constants of a patch, if the flash needs them: assumed (docs/budgets.md).
const WAIT_STATES: f64 = 42_700.0;
/// Capacity of the battery whose hours are estimated, in mAh.
const BATTERY_MAH: f64 = 150.0;
/// Milliseconds between two connection events.
const INTERVALS_MS: [f64; 2] = [7.5, 15.0];

/// Currents in milliamperes at 3 V and 25 degrees (nRF52840 product specification, electrical specification of the current consumption).
struct Regulator {
    name: &'static str,
    /// IRADIO_TX1, IRADIO_TX3: 0 dBm, 1 Mbit/s.
    transmits: f64,
    /// IRADIO_RX0, IRADIO_RX1.
    receives: f64,
    /// IS1 - IRADIO_RX0, IS3 - IRADIO_RX1: CoreMark from flash while the radio receives.
    computes: f64,
}

const REGULATORS: [Regulator; 2] = [
    Regulator {
        name: "DC/DC",
        transmits: 6.40,
        receives: 6.26,
        computes: 8.6 - 6.26,
    },
    Regulator {
        name: "LDO",
        transmits: 10.80,
        receives: 10.10,
        computes: 16.2 - 10.10,
    },
];
/// ITIMER2: the high-frequency crystal runs all the time, for the dead-man timer and the UART's receiver.
const CLOCK_MA: f64 = 0.646;

/// Mean currents of a board that streams.
struct Budget {
    regulator: &'static str,
    interval_ms: f64,
    radio_duty: f64,
    core_duty: f64,
    radio_ma: f64,
    core_ma: f64,
}

impl Budget {
    fn new(regulator: &Regulator, interval_ms: f64, patch_cycles: f64) -> Self {
        let events = 1000.0 / interval_ms;
        let notifications = NOTIFICATIONS / events;
        let exchanges = notifications.max(1.0);
        let empty = FRAME * BYTE_US;
        let full = (FRAME + NOTIFICATION) * BYTE_US;
        let transmits = RAMP_UP_US + exchanges * empty;
        let spaces = (2.0 * exchanges - 1.0) * SPACE_US;
        let receives = spaces + notifications * full + (exchanges - notifications) * empty;
        let inference = (patch_cycles + WAIT_STATES) / CLOCK_MHZ / PATCH_US;
        let core_duty = inference + events * STACK_US / 1e6;
        let share = |us: f64| events * us / 1e6;
        Self {
            regulator: regulator.name,
            interval_ms,
            radio_duty: share(transmits + receives),
            core_duty,
            radio_ma: share(transmits) * regulator.transmits + share(receives) * regulator.receives,
            core_ma: core_duty * regulator.computes,
        }
    }

    fn total_ma(&self) -> f64 {
        self.radio_ma + self.core_ma + CLOCK_MA
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "| {} | {:.1} | {:.1} % | {:.1} % | {:.2} | {:.2} | {CLOCK_MA:.2} | {:.2} | {:.0} |",
            self.regulator,
            self.interval_ms,
            100.0 * self.radio_duty,
            100.0 * self.core_duty,
            self.radio_ma,
            self.core_ma,
            self.total_ma(),
            BATTERY_MAH / self.total_ma(),
        )
    }
}

/// Prints the table of docs/energy.md.
pub fn print() -> Result<()> {
    let counts: CountTable = count::committed()?;
    let cycles = counts.cycles("total");
    println!("nRF52840, streaming; a patch takes {cycles:.0} cycles\n");
    println!(
        "| regulator | interval, ms | radio on | core on | radio, mA | core, mA | clock, mA | total, mA | hours of {BATTERY_MAH:.0} mAh |"
    );
    println!("| --- | --: | --: | --: | --: | --: | --: | --: | --: |");
    for budget in budgets(cycles) {
        println!("{budget}");
    }
    Ok(())
}

/// Rows of the table; `cycles` of a patch.
fn budgets(cycles: f64) -> impl Iterator<Item = Budget> {
    REGULATORS
        .iter()
        .flat_map(move |regulator| INTERVALS_MS.map(|ms| Budget::new(regulator, ms, cycles)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_these_rows() -> Result<()> {
        let page = include_str!("../../docs/energy.md").replace("**", "");
        let (_, table) = page.split_once("hours of 150 mAh |\n").unwrap();
        let rows: Vec<_> = table
            .lines()
            .skip(1)
            .take_while(|line| line.starts_with('|'))
            .collect();
        let budgets = budgets(count::committed()?.cycles("total"));
        assert_eq!(rows, budgets.map(|row| row.to_string()).collect::<Vec<_>>());
        Ok(())
    }

    #[test]
    fn an_interval_of_a_notification_has_one_exchange_with_it() {
        let [dcdc, _] = &REGULATORS;
        let budget = Budget::new(dcdc, 10.0, 0.0);
        // Ramp-up 140, empty packet 80, space 150, notification 33 bytes 264: 634 of 10 000 us.
        assert!(
            (budget.radio_duty - 0.0634).abs() < 1e-9,
            "{}",
            budget.radio_duty
        );
        let expected = 0.0220 * 6.40 + 0.0414 * 6.26;
        assert!((budget.radio_ma - expected).abs() < 1e-9);
    }
}
