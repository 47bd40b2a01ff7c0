//! Finds the places at which the stamps of a recording begin again while the recorder's time goes on: a simulator was reset, a
//! camera's driver started again, or a bag was played in a loop. Stamps before and after such a place are not one time.

use super::message_times::MessageTimes;
use std::ops::RangeInclusive;

/// Stamps that go back by less than this are late messages, nanoseconds.
const MIN_BACK_NS: i64 = 1_000_000_000;
/// The messages that are looked at on both sides of a step back. Late messages lie among others that are on time.
const MESSAGES_AROUND: usize = 10;
/// Fewest messages before and after a step back. Fewer are stray ones.
const MIN_MESSAGES: usize = 2;
/// Two streams that go back within this time go back for one reason, nanoseconds.
const SAME_CUT_NS: i64 = 5_000_000_000;

/// A place at which the stamps of one stream go back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StampRestart {
    stream: usize,
    /// The recorder's times of the last message before it, and of the first one after it.
    before_ns: i64,
    after_ns: i64,
    back_ns: i64,
}

/// A place at which all streams are cut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StreamCut {
    /// For each stream the recorder's time of the first message after it.
    after_ns: Vec<i64>,
    /// How far the stamps go back.
    pub(crate) back_ns: i64,
}

impl StreamCut {
    /// The recorder's time at which the first stream goes back.
    pub(crate) fn first_ns(&self) -> i64 {
        self.after_ns.iter().copied().min().unwrap_or(0)
    }
}

/// The parts of a recording. In each of them stamps go on.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct RecordingParts {
    cuts: Vec<StreamCut>,
}

impl RecordingParts {
    pub(crate) fn count(&self) -> usize {
        self.cuts.len() + 1
    }

    pub(crate) fn cuts(&self) -> impl Iterator<Item = &StreamCut> {
        self.cuts.iter()
    }

    /// The recorder's times of a stream's messages in a part.
    pub(crate) fn logged_ns(&self, part: usize, stream: usize) -> RangeInclusive<i64> {
        let after_ns = |cut: Option<&StreamCut>| cut.and_then(|cut| cut.after_ns.get(stream)).copied();
        let from = part.checked_sub(1).and_then(|before| after_ns(self.cuts.get(before))).unwrap_or(i64::MIN);
        let to = after_ns(self.cuts.get(part)).map_or(i64::MAX, |after_ns| after_ns.saturating_sub(1));
        from..=to
    }
}

/// The parts of a recording, by its streams: the times of their messages in the order of the file.
pub(crate) fn find_parts(streams: &[&[MessageTimes]]) -> RecordingParts {
    let restarts = streams.iter().enumerate().flat_map(|(stream, times)| find_restarts(stream, times));
    let mut restarts: Vec<StampRestart> = restarts.collect();
    restarts.sort_by_key(|restart| restart.after_ns);
    let mut cuts: Vec<(Vec<StampRestart>, i64)> = Vec::new();
    for restart in restarts {
        match cuts.last_mut() {
            Some((together, last_ns))
                if restart.before_ns <= last_ns.saturating_add(SAME_CUT_NS)
                    && together.iter().all(|other| other.stream != restart.stream) =>
            {
                *last_ns = restart.after_ns;
                together.push(restart);
            }
            _ => cuts.push((vec![restart], restart.after_ns)),
        }
    }
    let cut = |(together, _): (Vec<StampRestart>, i64)| {
        let first_ns = together.first().map_or(0, |restart| restart.after_ns);
        let own = |stream: usize| together.iter().find(|restart| restart.stream == stream);
        StreamCut {
            after_ns: (0..streams.len()).map(|stream| own(stream).map_or(first_ns, |own| own.after_ns)).collect(),
            back_ns: together.iter().map(|restart| restart.back_ns).max().unwrap_or(0),
        }
    };
    RecordingParts { cuts: cuts.into_iter().map(cut).collect() }
}

/// The places at which the stamps of a stream go back.
fn find_restarts(stream: usize, times: &[MessageTimes]) -> Vec<StampRestart> {
    let stamped: Vec<MessageTimes> = times.iter().copied().filter(|times| times.stamp_ns != 0).collect();
    let mut restarts = Vec::new();
    // The highest stamp of this part, and the recorder's time of the message before.
    let (mut highest_ns, mut before_ns) = (i64::MIN, i64::MIN);
    // The messages of this part, and those since the last late one.
    let (mut messages, mut since_late) = (0, MESSAGES_AROUND);
    for (at, now) in stamped.iter().enumerate() {
        let next = stamped.get(at..stamped.len().min(at + MESSAGES_AROUND)).unwrap_or_default();
        // Even if no time was lost, the stamps that follow are behind.
        let is_behind = |times: &MessageTimes| {
            let passed_ns = times.logged_ns.saturating_sub(before_ns);
            passed_ns >= 0 && times.stamp_ns < highest_ns.saturating_sub(MIN_BACK_NS).saturating_add(passed_ns)
        };
        let back_ns = highest_ns.saturating_sub(now.stamp_ns);
        let stays_behind = next.len() >= MIN_MESSAGES && next.iter().all(is_behind);
        since_late += 1;
        if back_ns > MIN_BACK_NS && messages > 0 {
            // Where single messages came late before, these are the last of them.
            if stays_behind && since_late > MESSAGES_AROUND {
                if messages >= MIN_MESSAGES {
                    restarts.push(StampRestart { stream, before_ns, after_ns: now.logged_ns, back_ns });
                }
                (highest_ns, messages, since_late) = (now.stamp_ns, 0, MESSAGES_AROUND);
            } else {
                since_late = 0;
            }
        }
        highest_ns = highest_ns.max(now.stamp_ns);
        before_ns = now.logged_ns;
        messages += 1;
    }
    restarts
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// A stream of (stamp, recorder's time), milliseconds.
    fn stream(times: &[(i64, i64)]) -> Vec<MessageTimes> {
        times.iter().map(|(stamp, logged)| MessageTimes { stamp_ns: stamp * MS, logged_ns: logged * MS }).collect()
    }

    fn run(stamp: i64, logged: i64, count: i64) -> Vec<(i64, i64)> {
        (0..count).map(|at| (stamp + at * 100, logged + at * 100)).collect()
    }

    #[test]
    fn stamps_that_begin_again_cut_every_stream_at_its_own_place() {
        let camera = stream(&[run(1_000, 50_000, 40), run(1_000, 60_000, 40)].concat());
        let poses = stream(&[run(1_000, 50_050, 42), run(1_000, 60_350, 40)].concat());
        let still = stream(&run(900_000, 50_000, 200));
        let parts = find_parts(&[&camera, &poses, &still]);
        assert_eq!(parts.count(), 2);
        assert_eq!(parts.logged_ns(0, 0), i64::MIN..=60_000 * MS - 1);
        assert_eq!(parts.logged_ns(1, 1), 60_350 * MS..=i64::MAX);
        assert_eq!(parts.logged_ns(1, 2), 60_000 * MS..=i64::MAX);
        let back_s: Vec<i64> = parts.cuts().map(|cut| cut.back_ns / MS).collect();
        assert_eq!(back_s, [4_100]);
    }

    #[test]
    fn a_loop_is_cut_each_time() {
        let looped: Vec<_> = (0..4).flat_map(|round| run(5_000, 100_000 + round * 6_000, 50)).collect();
        assert_eq!(find_parts(&[&stream(&looped)]).count(), 4);
    }

    #[test]
    fn late_stray_doubled_and_jumping_stamps_are_no_restart() {
        let mut late = run(1_000, 50_000, 40);
        late.insert(30, (1_500, 53_000));
        let doubled: Vec<_> = run(1_000, 50_000, 40).into_iter().flat_map(|time| [time, time]).collect();
        // A relay sends each message again, two seconds late.
        let mut relayed = [run(1_000, 50_000, 60), run(1_000, 52_050, 60)].concat();
        relayed.sort_by_key(|(_, logged)| *logged);
        let jitter: Vec<_> = (0..60).map(|at| (1_000 + at * 100 - (at % 7) * 130, 50_000 + at * 100)).collect();
        // The recorder's time goes back too: the file is not in order.
        let unordered = [run(9_000, 58_000, 20), run(1_000, 50_000, 20)].concat();
        let paused = [run(1_000, 50_000, 20), run(3_000, 90_000, 20)].concat();
        let stray = [vec![(90_000, 50_000)], run(1_000, 50_100, 30)].concat();
        for times in [late, doubled, relayed, jitter, unordered, paused, stray, run(0, 0, 30), Vec::new()] {
            assert_eq!(find_parts(&[&stream(&times)]).count(), 1, "{times:?}");
        }
    }
}
