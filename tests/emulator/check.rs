//! Conditions that must hold in every run in the emulator, whatever happened in it.

use anyhow::bail;
use xtask::{firmware::STACK_BUDGET, stack};

use super::Run;

impl Run {
    /// Checks the conditions that must hold in every run, whatever happened in it.
    ///
    /// # Errors
    /// As [`Output::check`](crate::output::Output::check), where the board may have restarted if a fault was injected; when
    /// the inference was too slow, the stack over its budget, or an error in the armband's log.
    pub fn check(&self) -> anyhow::Result<()> {
        stack::record(&self.image, self.stack())?;
        self.output.check(self.may_restart)?;
        let fault = if self.comments().iter().any(|c| c.contains("too slow")) {
            Some("the inference dropped packets".to_owned())
        } else if self.stack() > STACK_BUDGET {
            Some(format!("{} bytes of stack", self.stack()))
        } else if self.event_count("error") > 0 {
            Some("an error in the armband's log".to_owned())
        } else {
            None
        };
        match fault {
            Some(fault) => bail!("{fault}\n{}", self.tails()),
            None => Ok(()),
        }
    }
}
