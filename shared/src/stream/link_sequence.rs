//! Sequence numbers on the queue between radio and inference, which may drop packets.
//!
//! A bounded queue drops its oldest packet rather than block. Every packet carries the position of its
//! first sample and the number of its stream, so the inference detects whatever was dropped: a jump of
//! the position is a gap, another stream number is a disconnection.
//!
//! ```text
//! MyoSession -> Sequencer -> queue -> QueueGapDetector -> Pipeline
//! ```

use crate::units::{Sample, SampleIndex};

/// Element of the queue between radio and inference.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Packet {
    /// Number of the stream: one more after every disconnection; wraps.
    pub stream: u32,
    /// Position of the first sample, counted over all streams.
    pub first: SampleIndex,
    /// Two samples; none at the end of the stream.
    pub samples: Option<[Sample; 2]>,
}

/// Numbers the packets before the queue.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequencer {
    stream: u32,
    next: SampleIndex,
}

impl Sequencer {
    /// The next two samples.
    pub const fn samples(&mut self, samples: [Sample; 2]) -> Packet {
        let first = self.next;
        self.next = first.plus(2);
        Packet {
            stream: self.stream,
            first,
            samples: Some(samples),
        }
    }

    /// Position of the next sample.
    #[must_use]
    pub const fn due(&self) -> SampleIndex {
        self.next
    }

    /// Skips the positions of samples that are missing before the next two.
    pub const fn gap(&mut self, missing: u32) {
        self.next = self.next.plus(missing);
    }

    /// The end of the stream. The next samples belong to a new one.
    pub const fn end(&mut self) -> Packet {
        let stream = self.stream;
        self.stream = stream.wrapping_add(1);
        Packet {
            stream,
            first: self.next,
            samples: None,
        }
    }
}

/// Result of a received packet, to be passed to the pipeline in this order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Received {
    /// The previous stream ended: `Pipeline::disconnected`.
    pub disconnected: bool,
    /// Number of missing samples: `Pipeline::gap`, unless 0.
    pub missing: u32,
    /// Two samples: `Pipeline::sample`, twice.
    pub samples: Option<[Sample; 2]>,
}

/// Detects what is missing after the queue.
#[derive(Clone, Copy, Debug, Default)]
pub struct QueueGapDetector {
    /// The present stream; none after its end.
    stream: Option<u32>,
    next: SampleIndex,
}

impl QueueGapDetector {
    /// Takes the next packet from the queue.
    pub fn receive(&mut self, packet: Packet) -> Received {
        let other = self.stream.is_some_and(|stream| stream != packet.stream);
        let missing = packet.first.since(self.next);
        let taken = if packet.samples.is_some() { 2 } else { 0 };
        self.next = packet.first.plus(taken);
        self.stream = packet.samples.map(|_| packet.stream);
        Received {
            // The end of a stream is reported even if all of its samples were dropped.
            disconnected: other || packet.samples.is_none(),
            missing,
            samples: packet.samples,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{collections::VecDeque, vec::Vec};
    use proptest::prelude::*;

    const ZEROS: [Sample; 2] = [[0; 8]; 2];

    #[derive(Clone, Copy, Debug)]
    enum QueueStep {
        Samples,
        Gap(u32),
        End,
        Receive,
    }

    fn step() -> impl Strategy<Value = QueueStep> {
        prop_oneof![
            6 => Just(QueueStep::Samples),
            1 => (1_u32..20).prop_map(QueueStep::Gap),
            1 => Just(QueueStep::End),
            4 => Just(QueueStep::Receive),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// The true position and stream of every packet are queued beside it.
        #[test]
        fn whatever_a_full_queue_drops_positions_and_streams_stay_right(
            // Also shortly before both numbers wrap.
            first in prop_oneof![Just(0_u32), u32::MAX - 50..],
            steps in prop::collection::vec(step(), 1..200),
        ) {
            let (mut sequencer, mut detector) = (Sequencer::default(), QueueGapDetector::default());
            sequencer.stream = first;
            sequencer.gap(first);
            let mut queue = VecDeque::new();
            let (mut position, mut stream) = (first, first);
            let mut seen: Vec<(u32, u32)> = Vec::new();
            let (mut counted, mut ended_since) = (0_u32, true);
            for step in steps {
                let packet = match step {
                    QueueStep::Samples => {
                        let at = position;
                        position = at.wrapping_add(2);
                        Some((sequencer.samples(ZEROS), Some((at, stream))))
                    }
                    QueueStep::Gap(missing) => {
                        sequencer.gap(missing);
                        position = position.wrapping_add(missing);
                        None
                    }
                    QueueStep::End => {
                        stream = stream.wrapping_add(1);
                        Some((sequencer.end(), None))
                    }
                    QueueStep::Receive => {
                        if let Some((packet, expected)) = queue.pop_front() {
                            let received = detector.receive(packet);
                            ended_since |= received.disconnected;
                            counted = counted.wrapping_add(received.missing);
                            if let Some((at, stream)) = expected {
                                prop_assert_eq!(counted, at);
                                counted = counted.wrapping_add(2);
                                if let Some(&(_, before)) = seen.last() {
                                    prop_assert_eq!(ended_since, before != stream);
                                }
                                ended_since = false;
                                seen.push((at, stream));
                            }
                        }
                        None
                    }
                };
                if let Some(packet) = packet {
                    if queue.len() == 4 {
                        queue.pop_front();
                    }
                    queue.push_back(packet);
                }
            }
        }
    }
}
