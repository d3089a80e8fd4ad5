//! Numbers in libFuzzer's log.

/// Numbers of libFuzzer's log.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Figures {
    pub executions: u64,
    pub branches: u64,
    pub inputs: u64,
}

impl Figures {
    /// Reads each from the last line `#N KIND cov: N ft: N corp: N/...` that has it; the final count counts all.
    pub fn of(log: &str) -> Self {
        let mut figures = Self::default();
        for line in log.lines() {
            let mut words = line.split_whitespace().peekable();
            if let Some(number) = line.strip_prefix("stat::number_of_executed_units:") {
                figures.executions = number.trim().parse().unwrap_or(figures.executions);
            }
            let first = words.peek().and_then(|word| word.strip_prefix('#'));
            let Some(executions) = first.and_then(|word| word.parse().ok()) else {
                continue;
            };
            figures.executions = figures.executions.max(executions);
            while let Some(word) = words.next() {
                let number = words
                    .peek()
                    .and_then(|next| next.split('/').next()?.parse().ok());
                match (word, number) {
                    ("cov:", Some(number)) => figures.branches = number,
                    ("corp:", Some(number)) => figures.inputs = number,
                    _ => {}
                }
            }
        }
        figures
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_last_line() {
        let log = "INFO: Seed: 1\n#2\tINITED cov: 14 ft: 15 corp: 1/1b exec/s: 0 rss: 28Mb\n\
                   #4798095\tDONE   cov: 44 ft: 116 corp: 50/14998b lim: 4096 exec/s: 533121 rss: 28Mb\n\
                   stat::number_of_executed_units: 4798096\n";
        let expected = Figures {
            executions: 4_798_096,
            branches: 44,
            inputs: 50,
        };
        assert_eq!(Figures::of(log), expected);
        assert_eq!(Figures::of("nothing\n"), Figures::default());
    }
}
