//! Marks between the parts of a step, for counting what each part costs.

/// A part of a step, norms and residual sums included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Part {
    /// The patch embedding.
    Embed,
    /// The attention of one layer.
    Attention,
    /// The feed-forward of one layer.
    FeedForward,
    /// The look-back head.
    Head,
}

/// Called at the end of every part of a step.
pub trait Probe {
    /// `part` has ended.
    fn done(&mut self, part: Part);
}

/// Counts nothing, and compiles to nothing.
impl Probe for () {
    #[inline(always)]
    fn done(&mut self, _: Part) {}
}
