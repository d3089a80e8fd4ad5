//! Whether a learnt head is used in place of the one before.

use crate::intent::{Intent, MAX_CLASSES};

/// Recall that the judged head may lose: the one that is used learns from all rounds, and is better.
const MOST_LOST: f32 = 0.05;

/// Labels as emitted of two heads, counted in what the wearer is asked for: the head before, and the learnt one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Judgement {
    right: [[u32; MAX_CLASSES]; 2],
    all: [u32; MAX_CLASSES],
}

impl Judgement {
    /// Adds both labels of an instant; `None` before the first.
    pub fn add(&mut self, asked: Intent, labels: [Option<Intent>; 2]) {
        let class = asked.class();
        self.all[class] += 1;
        for (right, label) in self.right.iter_mut().zip(labels) {
            right[class] += u32::from(label == Some(asked));
        }
    }

    /// Mean recall over the classes that were asked for, of each head; 0 if nothing was.
    #[must_use]
    pub fn recalls(&self) -> [f32; 2] {
        let classes = self.all.iter().filter(|all| **all > 0).count().max(1) as f32;
        self.right.map(|right| {
            let mut sum = 0.0;
            for (right, &all) in right.into_iter().zip(&self.all) {
                sum += right as f32 / all.max(1) as f32;
            }
            sum / classes
        })
    }

    /// Whether the learnt head is used: unless it loses more than 0.05.
    #[must_use]
    pub fn accepts(&self) -> bool {
        let [before, learnt] = self.recalls();
        learnt >= before - MOST_LOST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_weigh_the_same_and_a_small_loss_is_borne() {
        let judge = |instants: &[(Intent, Intent, u32)]| {
            let mut judgement = Judgement::default();
            for &(asked, learnt, times) in instants {
                for _ in 0..times {
                    judgement.add(asked, [Some(asked), Some(learnt)]);
                }
            }
            let hundredths = judgement.recalls().map(|recall| (recall * 100.0) as u32);
            (hundredths, judgement.accepts())
        };
        use Intent::{Close, Open, Relax};
        let half = [(Relax, Relax, 900), (Open, Open, 10), (Open, Close, 10)];
        assert_eq!(judge(&half), ([100, 75], false));
        let little = [(Relax, Relax, 1), (Open, Open, 91), (Open, Relax, 9)];
        assert_eq!(judge(&little), ([100, 95], true));
        assert_eq!(judge(&[]), ([0; 2], true));
    }
}
