//! Learning rate over the steps of a run.

/// Linear warm-up from 0, then linear decay to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    peak: f64,
    warm_up: usize,
    total: usize,
}

impl Schedule {
    /// A schedule over `total` steps whose first `warm_up_share` rise to `peak`.
    ///
    /// As in the reference, the very first step has rate 0, and steps beyond `total` do too.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a number of steps"
    )]
    pub fn new(peak: f64, warm_up_share: f64, total: usize) -> Self {
        Self {
            peak,
            warm_up: (warm_up_share * total as f64) as usize,
            total,
        }
    }

    /// Rate of a step, 0 first.
    #[must_use]
    pub fn rate(&self, step: usize) -> f64 {
        if step < self.warm_up {
            return self.peak * step as f64 / self.warm_up as f64;
        }
        let left = self.total.saturating_sub(step) as f64;
        self.peak * left / self.total.saturating_sub(self.warm_up).max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_from_zero_to_the_peak_and_falls_back_to_zero() {
        let schedule = Schedule::new(1e-4, 0.05, 1000);
        let close = |step, rate: f64| (schedule.rate(step) - rate).abs() < 1e-15;
        assert!(close(0, 0.0));
        assert!(close(25, 0.5e-4));
        assert!(close(50, 1e-4));
        assert!(close(525, 0.5e-4));
        assert!(close(1000, 0.0));
        assert!(close(1200, 0.0));
    }
}
