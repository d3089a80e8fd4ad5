//! Numbers on what the radio hands to the inference, so that a queue between them may drop.
//!
//! A bounded queue drops its oldest entry rather than block. With every packet goes the position
//! of its first sample and the number of its stream, and so whatever was dropped, the detector
//! finds out: a jump of the position is a gap, another stream is a disconnection.
//!
//! ```text
//! MyoSession -> Sequencer -> queue, may drop -> GapDetector -> Pipeline
//! ```

use crate::units::{Sample, SampleIndex};

/// One entry of the queue.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Packet {
    /// Which stream: one more after every disconnection; wraps.
    pub stream: u32,
    /// Position of the first sample, counted on from stream to stream.
    pub first: SampleIndex,
    /// Two samples, or none: the stream is over.
    pub samples: Option<[Sample; 2]>,
}

/// Numbers what goes into the queue.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequencer {
    stream: u32,
    next: SampleIndex,
}

impl Sequencer {
    /// Before the first sample.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            stream: 0,
            next: SampleIndex(0),
        }
    }

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

    /// Samples are missing before the next two.
    pub const fn gap(&mut self, missing: u32) {
        self.next = self.next.plus(missing);
    }

    /// The stream is over; what comes next is another.
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

/// What a packet means for the pipeline, in this order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Received {
    /// The stream before ended: `Pipeline::disconnected`.
    pub disconnected: bool,
    /// Samples missing: `Pipeline::gap`, where not 0.
    pub missing: u32,
    /// Two samples: `Pipeline::sample`, twice.
    pub samples: Option<[Sample; 2]>,
}

/// Finds out what is missing among what comes out of the queue.
#[derive(Clone, Copy, Debug, Default)]
pub struct GapDetector {
    /// The stream that goes on; none after its end.
    stream: Option<u32>,
    next: SampleIndex,
}

impl GapDetector {
    /// Before the first packet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            stream: None,
            next: SampleIndex(0),
        }
    }

    /// Takes the next packet that the queue kept.
    pub fn receive(&mut self, packet: Packet) -> Received {
        let other = self.stream.is_some_and(|stream| stream != packet.stream);
        let missing = packet.first.since(self.next);
        let taken = if packet.samples.is_some() { 2 } else { 0 };
        self.next = packet.first.plus(taken);
        self.stream = packet.samples.map(|_| packet.stream);
        Received {
            // The end of a stream is told even if no sample of it was kept.
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

    const QUIET: [Sample; 2] = [[0; 8]; 2];

    fn plain(samples: Option<[Sample; 2]>) -> Received {
        Received {
            disconnected: false,
            missing: 0,
            samples,
        }
    }

    #[test]
    fn what_the_queue_kept_passes_unchanged() {
        let (mut sequencer, mut detector) = (Sequencer::new(), GapDetector::new());
        for value in 0..10 {
            let pair = [[value; 8], [-value; 8]];
            let packet = sequencer.samples(pair);
            assert_eq!(detector.receive(packet), plain(Some(pair)));
        }
        sequencer.gap(6);
        let received = detector.receive(sequencer.samples(QUIET));
        assert_eq!((received.missing, received.disconnected), (6, false));
        assert!(detector.receive(sequencer.end()).disconnected);
        assert_eq!(
            detector.receive(sequencer.samples(QUIET)),
            plain(Some(QUIET))
        );
    }

    #[test]
    fn a_dropped_end_of_stream_is_found_out() {
        let (mut sequencer, mut detector) = (Sequencer::new(), GapDetector::new());
        detector.receive(sequencer.samples(QUIET));
        let _dropped = sequencer.end();
        let received = detector.receive(sequencer.samples(QUIET));
        assert!(received.disconnected);
        assert_eq!(received.missing, 0);
    }

    #[test]
    fn positions_wrap() {
        let mut sequencer = Sequencer::new();
        let mut detector = GapDetector::new();
        sequencer.gap(u32::MAX);
        detector.receive(sequencer.samples(QUIET));
        let received = detector.receive(sequencer.samples(QUIET));
        assert_eq!(received, plain(Some(QUIET)));
    }

    #[derive(Clone, Copy, Debug)]
    enum Step {
        Samples,
        Gap(u32),
        Over,
        Receive,
    }

    fn step() -> impl Strategy<Value = Step> {
        prop_oneof![
            6 => Just(Step::Samples),
            1 => (1_u32..20).prop_map(Step::Gap),
            1 => Just(Step::Over),
            4 => Just(Step::Receive),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// The truth beside it: every sample carries its own position.
        #[test]
        fn whatever_a_full_queue_drops_positions_and_streams_stay_right(
            steps in prop::collection::vec(step(), 1..200),
        ) {
            let (mut sequencer, mut detector) = (Sequencer::new(), GapDetector::new());
            let mut queue = VecDeque::new();
            let (mut position, mut stream) = (0_u32, 0_u32);
            let mut seen: Vec<(u32, u32)> = Vec::new();
            let (mut counted, mut over_since) = (0_u32, true);
            for step in steps {
                let packet = match step {
                    Step::Samples => {
                        position += 2;
                        Some((sequencer.samples(QUIET), Some((position - 2, stream))))
                    }
                    Step::Gap(missing) => {
                        sequencer.gap(missing);
                        position += missing;
                        None
                    }
                    Step::Over => {
                        stream += 1;
                        Some((sequencer.end(), None))
                    }
                    Step::Receive => {
                        if let Some((packet, truth)) = queue.pop_front() {
                            let received = detector.receive(packet);
                            over_since |= received.disconnected;
                            counted += received.missing;
                            if let Some((at, stream)) = truth {
                                prop_assert_eq!(counted, at);
                                counted += 2;
                                if let Some(&(_, before)) = seen.last() {
                                    prop_assert_eq!(over_since, before != stream);
                                }
                                over_since = false;
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
