//! Pins, their delay, and the raw stream.

use super::*;

impl Expectation {
    pub(super) fn check_pins(&self, output: &BoardOutput) -> anyhow::Result<()> {
        let pins = output.pins();
        if let Some(expected) = self.rises {
            let rises = pins
                .windows(2)
                .filter(|pair| !pair[0].valid && pair[1].valid);
            let found = rises.count();
            ensure!(
                found == expected,
                "valid rose {found} times, expected {expected}"
            );
        }
        if let Some(within) = self.safe_within_ms {
            let fault = *output.faults_us().first().context("no fault")?;
            let first_start = pins.chunk_by(|one, next| one.at_us <= next.at_us).next();
            let before = first_start.unwrap_or_default();
            let after = before.iter().filter(|pins| pins.at_us >= fault);
            let after: Vec<_> = after.skip_while(|pins| pins.valid).collect();
            let fell = after.first().context("the pins never became safe")?;
            ensure!(
                fell.at_us - fault <= within * 1000,
                "safe {} us after the fault, expected within {within} ms",
                fell.at_us - fault
            );
            ensure!(
                after.iter().all(|pins| !pins.valid),
                "valid again after the fault"
            );
        }
        Ok(())
    }

    pub(super) fn check_delay(&self, output: &BoardOutput) -> anyhow::Result<()> {
        let Some(expected) = self.delay_tenths_ms else {
            return Ok(());
        };
        let streams = output.streams_us();
        let began = *streams.first().context("no stream")?;
        let mut labels: Vec<_> = output.reports()?;
        labels.dedup_by_key(|report| (report.status.valid(), report.status.label()));
        let mut pins = output.pins();
        pins.dedup_by_key(|pins| (pins.valid, pins.high.clone()));
        let labels = labels.iter().filter(|report| report.status.valid());
        let pins = pins.iter().filter(|pins| pins.valid);
        let mut delays = Vec::new();
        for (report, pins) in labels.zip(pins) {
            ensure!(pins.high == [report.status.label()], "{pins:?}: {report}");
            // A sample takes five milliseconds; the first one is due by then.
            let sampled = began + 5000 * (u64::from(report.emitted.0) + 1);
            delays.push((pins.at_us - sampled + 50) / 100);
        }
        let longest = *delays.iter().max().context("no label")?;
        let mean = delays.iter().sum::<u64>() / delays.len() as u64;
        ensure!(
            (mean, longest) == expected,
            "mean and longest delay {:?} of {}, expected {expected:?}",
            (mean, longest),
            delays.len()
        );
        Ok(())
    }

    pub(super) fn check_raw(&self, samples: &[Sample], output: &BoardOutput) -> anyhow::Result<()> {
        let Some(least) = self.raw_without_holes else {
            return Ok(());
        };
        let raw = output.emg()?;
        ensure!(
            raw.len() >= least,
            "{} raw lines, expected {least}",
            raw.len()
        );
        let first = raw.first().context("no raw samples")?.first.0 as usize;
        for (report, place) in raw.iter().zip((first..).step_by(2)) {
            ensure!(report.first.0 as usize == place, "a hole before {report}");
            ensure!(
                samples.get(place..place + 2) == Some(&report.samples[..]),
                "other samples: {report}"
            );
        }
        Ok(())
    }
}
