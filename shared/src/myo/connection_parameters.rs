//! Connection parameters: the board's own, and its response to an armband that requests others.

/// Milliseconds between two looks at the parameters in force.
pub const LOOK_MS: u32 = 500;
/// Most requests for our parameters in a connection.
const REQUESTS: u8 = 3;

/// Parameters of a connection, in the units of the Bluetooth specification (Vol 4, Part E, 7.8.12).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ConnectionParameters {
    /// Shortest interval, in units of 1.25 ms.
    pub min_interval: u16,
    /// Longest interval, in the same units.
    pub max_interval: u16,
    /// Intervals that the armband may leave out.
    pub latency: u16,
    /// Time without a packet after which the connection is lost, in units of 10 ms.
    pub supervision_timeout: u16,
}

impl ConnectionParameters {
    /// 7.5 to 15 ms, no latency, 2 s. The armband has a notification every 10 ms; how many it keeps for a longer interval is
    /// unknown.
    pub const OURS: Self = Self {
        min_interval: 6,
        max_interval: 12,
        latency: 0,
        supervision_timeout: 200,
    };

    /// Whether notifications come as soon as with ours.
    const fn is_as_quick_as_ours(self) -> bool {
        self.max_interval <= Self::OURS.max_interval && self.latency == Self::OURS.latency
    }
}

/// Holds our parameters in a connection, for a radio that grants the armband whatever it asks for.
///
/// Ours are asked for again, but not for ever: an armband may insist, and each change costs air time. Then its stream shows
/// what is lost.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ParameterHold {
    /// Requests in this connection so far.
    requests: u8,
}

impl ParameterHold {
    /// The parameters to request, given those in force; none if these are good enough, or requested often enough. To be
    /// called every [`LOOK_MS`].
    pub const fn look(&mut self, found: ConnectionParameters) -> Option<ConnectionParameters> {
        if found.is_as_quick_as_ours() || self.requests == REQUESTS {
            return None;
        }
        self.requests += 1;
        Some(ConnectionParameters::OURS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OURS: ConnectionParameters = ConnectionParameters::OURS;

    fn interval(min: u16, max: u16) -> ConnectionParameters {
        ConnectionParameters {
            min_interval: min,
            max_interval: max,
            ..OURS
        }
    }

    #[test]
    fn ours_and_quicker_ones_are_left_alone() {
        let mut hold = ParameterHold::default();
        let later_lost = ConnectionParameters {
            supervision_timeout: 600,
            ..OURS
        };
        for found in [OURS, interval(6, 6), interval(12, 12), later_lost] {
            assert_eq!(hold.look(found), None, "{found:?}");
        }
        assert_eq!(hold, ParameterHold::default());
    }

    #[test]
    fn a_longer_interval_or_a_latency_is_answered_with_ours() {
        let lazy = ConnectionParameters { latency: 1, ..OURS };
        let longest = ConnectionParameters {
            min_interval: 6,
            max_interval: u16::MAX,
            latency: u16::MAX,
            supervision_timeout: 0,
        };
        for found in [interval(6, 13), interval(24, 40), lazy, longest] {
            let answer = ParameterHold::default().look(found);
            assert_eq!(answer, Some(OURS), "{found:?}");
        }
    }

    #[test]
    fn an_armband_that_insists_has_its_way_after_three_requests() {
        let mut hold = ParameterHold::default();
        let asked = [(); 10].map(|()| hold.look(interval(24, 40)));
        let asked = asked.iter().flatten().count();
        assert_eq!(asked, 3);
        // Also where it gives way in between.
        let mut hold = ParameterHold::default();
        let longer = interval(24, 24);
        let found = [longer, OURS, longer, OURS, longer, longer];
        let asked = found.map(|found| hold.look(found).is_some());
        assert_eq!(asked, [true, false, true, false, true, false]);
    }
}
