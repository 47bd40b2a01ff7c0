//! The two times of a message, and which of them counts.

use std::ops::RangeInclusive;

/// The clock by which times are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MessageClock {
    /// The stamps in the messages' headers.
    Stamp,
    /// The times at which the recorder received the messages.
    Log,
}

/// The two times of a message, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MessageTimes {
    pub(crate) stamp_ns: i64,
    pub(crate) logged_ns: i64,
}

impl MessageTimes {
    /// The time on a clock; `None` if that is the stamp and it is 0.
    pub(crate) fn time_on(self, clock: MessageClock) -> Option<i64> {
        match clock {
            MessageClock::Stamp => Some(self.stamp_ns).filter(|stamp_ns| *stamp_ns != 0),
            MessageClock::Log => Some(self.logged_ns),
        }
    }
}

/// Which messages of a stream count, and at what times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StreamTiming {
    pub(crate) clock: MessageClock,
    /// The recorder's times of the messages that count, nanoseconds.
    pub(crate) logged_ns: RangeInclusive<i64>,
    /// This is added to each stamp, nanoseconds.
    pub(crate) shift_ns: i64,
}

impl StreamTiming {
    /// All messages, at their times on a clock.
    pub(crate) fn whole(clock: MessageClock) -> Self {
        Self { clock, logged_ns: i64::MIN..=i64::MAX, shift_ns: 0 }
    }

    /// The time of a message; `None` if it does not count, or has no time on this clock.
    pub(crate) fn time_of(&self, times: MessageTimes) -> Option<i64> {
        let time_ns = times.time_on(self.clock).filter(|_| self.logged_ns.contains(&times.logged_ns))?;
        Some(if self.clock == MessageClock::Stamp { time_ns.saturating_add(self.shift_ns) } else { time_ns })
    }

    /// Those messages that count.
    pub(crate) fn counting(&self, times: &[MessageTimes]) -> Vec<MessageTimes> {
        times.iter().copied().filter(|times| self.logged_ns.contains(&times.logged_ns)).collect()
    }
}
