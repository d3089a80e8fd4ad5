//! Where a step has come to, for whoever counts what its parts cost.

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

/// Is told of every part of a step as it ends.
pub trait Probe {
    /// `part` has ended.
    fn done(&mut self, part: Part);
}

/// Nobody counts: the compiler leaves nothing of it.
impl Probe for () {
    #[inline(always)]
    fn done(&mut self, _: Part) {}
}
