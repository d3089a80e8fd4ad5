//! The printed table: counts beside the committed ones and the budget.

use std::fmt;

use super::table::{ALIGNMENT, CALIBRATION, CountTable, PARTS, milliseconds};

/// Instructions of a whole patch, 50 ms of EMG.
pub const BUDGET: u64 = 130_000;

/// Percent by which a count is higher than another.
pub fn change(now: u64, before: u64) -> f64 {
    (now as f64 / before.max(1) as f64 - 1.0) * 100.0
}

/// A table, beside the committed one if there is one to compare with.
pub struct Comparison<'a> {
    /// Table of the new counts.
    pub table: &'a CountTable,
    /// Committed table to compare the new one with, if any.
    pub committed: Option<&'a CountTable>,
}

impl fmt::Display for Comparison<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { table, committed } = self;
        writeln!(f, "instructions per patch, {} patches", table.patches)?;
        writeln!(
            f,
            "{:<14}{:>9}{:>9}{:>11}{:>9}{:>14}",
            "part", "mean", "largest", "committed", "change", "cycles, est."
        )?;
        for name in PARTS.map(|(name, _)| name).into_iter().chain(["total"]) {
            let Some(part) = table.part(name) else {
                continue;
            };
            write!(f, "{name:<14}{:>9}{:>9}", part.mean, part.largest)?;
            match committed.and_then(|committed| committed.part(name)) {
                Some(before) => {
                    let change = change(part.mean, before.mean);
                    write!(f, "{:>11}{change:>+7.1} %", before.mean)?;
                }
                None => write!(f, "{:>20}", "")?,
            }
            writeln!(f, "{:>14.0}", table.cycles(name))?;
        }
        let (mean, largest) = (|name| table.mean(name), |name| table.largest(name));
        let ms = |name| milliseconds(largest(name));
        let encoder = mean("encoder");
        writeln!(f, "embed to head without a probe between them: {encoder}")?;
        if table.part(ALIGNMENT[0]).is_some() {
            let [waiting, end, again, fit, turn, arm] = ALIGNMENT;
            writeln!(
                f,
                "alignment: {} a patch while gestures are waited for\n\
                 alignment: {} for the sample that ends it, about {:.1} ms: {} for the fit, {} to turn the window, \
                 and a patch\n\
                 alignment: {} for each of the next 66 samples, at most {}, about {:.1} ms\n\
                 alignment: {} for each of 106 samples while the model decides on the arm, at most {}, about {:.1} ms",
                mean(waiting),
                largest(end),
                ms(end),
                mean(fit),
                mean(turn),
                mean(again),
                largest(again),
                ms(again),
                mean(arm),
                largest(arm),
                ms(arm),
            )?;
        }
        if table.part(CALIBRATION[0]).is_some() {
            let [teach, judge, solve] = CALIBRATION;
            writeln!(
                f,
                "calibration: {} a patch of round one, at most {}; {} of round two, at most {}; {} for the solve, about {:.1} ms",
                mean(teach),
                largest(teach),
                mean(judge),
                largest(judge),
                largest(solve),
                ms(solve),
            )?;
        }
        writeln!(f, "state of the encoder: {} bytes", table.state)?;
        let total = mean("total");
        let judgement = if total > BUDGET { "over" } else { "within" };
        let share = 100.0 * total as f64 / BUDGET as f64;
        let milliseconds = table.cycles("total") / 64e3;
        write!(
            f,
            "budget {BUDGET}: {judgement}, {share:.1} % of it; about {milliseconds:.1} ms at 64 MHz"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::output;
    use super::*;

    #[test]
    fn an_alignment_is_shown_where_it_was_counted() {
        let without = output("", 10_000);
        let with: Vec<_> = ALIGNMENT
            .iter()
            .map(|name| format!("{name} 21 64000\n"))
            .collect();
        let text = |output: &str| {
            let table = &CountTable::parse(output).unwrap();
            let committed = None;
            Comparison { table, committed }.to_string()
        };
        assert!(!text(&without).contains("alignment"));
        let text = text(&(without + &with.concat()));
        assert!(
            text.contains(
                "alignment: 64000 for the sample that ends it, about 1.5 ms: 21 for the fit"
            ),
            "{text}"
        );
    }

    #[test]
    fn the_table_shows_changes_cycles_and_the_budget() {
        let [table, committed] =
            [10_200, 10_000].map(|mean| CountTable::parse(&output("", mean)).unwrap());
        let committed = Some(&committed);
        let table = &table;
        let text = Comparison { table, committed }.to_string();
        let line = text
            .lines()
            .find(|line| line.starts_with("embed "))
            .unwrap();
        let words: Vec<_> = line.split_whitespace().collect();
        assert_eq!(
            words,
            ["embed", "10200", "160000", "10000", "+2.0", "%", "15300"]
        );
        assert!(
            text.contains("budget 130000: within, 7.8 % of it"),
            "{text}"
        );
    }
}
