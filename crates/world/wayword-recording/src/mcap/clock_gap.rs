//! Measures how far the stamps of two streams are from each other by the recorder's clock.

use super::message_times::MessageTimes;

/// Stamps that differ by at most this are of one clock: messages arrive late and unevenly, nanoseconds.
const MAX_LATENCY_NS: i64 = 500_000_000;
/// The differences of a constant gap scatter by at most this, nanoseconds.
const MAX_SCATTER_NS: i64 = 1_000_000_000;
/// Fewest pictures from which a gap is judged.
const MIN_PICTURES: usize = 4;
/// Most pictures that are looked at.
const MAX_PICTURES: usize = 2000;
/// Stretches of the recording that have to agree.
const STRETCHES: usize = 4;
/// Longest time without a message over which stamps are interpolated, nanoseconds.
const MAX_PAUSE_NS: i64 = 10_000_000_000;
/// The recorder's times are of use if stamps run at most this many times faster or slower. A file that was written all at once
/// has the times at which it was written.
const MAX_RATE: f64 = 5.0;

/// How far the stamps of poses are ahead of those of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClockGap {
    /// Not by more than messages are late; or this cannot be known.
    None,
    /// By this, all the time, nanoseconds.
    Constant(i64),
    /// By something between these, nanoseconds.
    Unsteady(i64, i64),
}

impl ClockGap {
    /// Its largest size.
    pub(crate) fn most_ns(self) -> i64 {
        match self {
            Self::None => 0,
            Self::Constant(gap_ns) => gap_ns.saturating_abs(),
            Self::Unsteady(least_ns, most_ns) => least_ns.saturating_abs().max(most_ns.saturating_abs()),
        }
    }
}

/// The gap between the pictures and the poses of one stream.
pub(crate) fn measure_gap(pictures: &[MessageTimes], poses: &[MessageTimes]) -> ClockGap {
    let (pictures, poses) = (forward_messages(pictures), forward_messages(poses));
    if !runs_with_recorder(&pictures) || !runs_with_recorder(&poses) {
        return ClockGap::None;
    }
    let step = pictures.len().div_ceil(MAX_PICTURES).max(1);
    let looked_at = pictures.iter().step_by(step);
    let gaps: Vec<i64> = looked_at
        .clone()
        .filter_map(|picture| Some(stamp_at(&poses, picture.logged_ns)?.saturating_sub(picture.stamp_ns)))
        .collect();
    // Where the two were hardly ever recorded together, their recorder's times say nothing.
    if gaps.len() < MIN_PICTURES || gaps.len() * 2 < looked_at.count().min(poses.len()) {
        return ClockGap::None;
    }
    judge_gaps(&gaps)
}

/// Judges gaps in the order of their times.
fn judge_gaps(gaps: &[i64]) -> ClockGap {
    let stretch = gaps.len().div_ceil(STRETCHES).max(MIN_PICTURES);
    let stretches: Vec<Vec<i64>> = gaps.chunks(stretch).map(sorted).collect();
    let is_near = |gap: &i64| gap.saturating_abs() <= MAX_LATENCY_NS;
    // A message that was sent on time shows that the clocks agree, however late the others came.
    if stretches.iter().all(|gaps| gaps.iter().filter(|gap| is_near(gap)).count() * 10 >= gaps.len()) {
        return ClockGap::None;
    }
    let all = sorted(gaps);
    let middles = sorted(&stretches.iter().map(|gaps| share_of(gaps, 0.5)).collect::<Vec<_>>());
    let spread = |from: i64, to: i64| to.saturating_sub(from);
    let is_constant = spread(share_of(&middles, 0.0), share_of(&middles, 1.0)) <= MAX_LATENCY_NS
        && spread(share_of(&all, 0.1), share_of(&all, 0.9)) <= MAX_SCATTER_NS;
    if is_constant {
        ClockGap::Constant(share_of(&all, 0.5))
    } else {
        ClockGap::Unsteady(share_of(&all, 0.0), share_of(&all, 1.0))
    }
}

fn sorted(numbers: &[i64]) -> Vec<i64> {
    let mut numbers = numbers.to_vec();
    numbers.sort_unstable();
    numbers
}

/// The number at a share of a sorted list: 0.5 for the median.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length is an index")]
fn share_of(sorted: &[i64], share: f64) -> i64 {
    let at = (share * sorted.len().saturating_sub(1) as f64) as usize;
    sorted.get(at).copied().unwrap_or(0)
}

/// The messages with stamps in the order in which they were recorded, without those that come late or twice.
fn forward_messages(times: &[MessageTimes]) -> Vec<MessageTimes> {
    let mut stamped: Vec<MessageTimes> = times.iter().copied().filter(|times| times.stamp_ns != 0).collect();
    stamped.sort_by_key(|times| (times.logged_ns, times.stamp_ns));
    let mut latest_ns = i64::MIN;
    let mut forward = stamped.clone();
    forward.retain(|times| {
        let is_new = times.stamp_ns > latest_ns;
        latest_ns = latest_ns.max(times.stamp_ns);
        is_new
    });
    // A single wrong stamp in the future would hide all others.
    if forward.len() * 3 < stamped.len() { stamped } else { forward }
}

/// Whether stamps and the recorder's times run at about the same rate.
fn runs_with_recorder(messages: &[MessageTimes]) -> bool {
    let (Some(first), Some(last)) = (messages.first(), messages.last()) else { return false };
    let stamps = last.stamp_ns.saturating_sub(first.stamp_ns) as f64;
    let logged = last.logged_ns.saturating_sub(first.logged_ns) as f64;
    stamps > 0.0 && logged > 0.0 && (1.0 / MAX_RATE..=MAX_RATE).contains(&(stamps / logged))
}

/// The stamp of a stream at a time of the recorder, between the two messages around it.
fn stamp_at(messages: &[MessageTimes], logged_ns: i64) -> Option<i64> {
    let next = messages.partition_point(|message| message.logged_ns < logged_ns);
    let after = messages.get(next)?;
    if after.logged_ns == logged_ns {
        return Some(after.stamp_ns);
    }
    let before = messages.get(next.checked_sub(1)?)?;
    let gap_ns = after.logged_ns.saturating_sub(before.logged_ns);
    if gap_ns > MAX_PAUSE_NS {
        return None;
    }
    let passed = logged_ns.saturating_sub(before.logged_ns) as f64 / gap_ns as f64;
    #[allow(clippy::cast_possible_truncation, reason = "a part of an i64 is one")]
    let passed_ns = (passed * after.stamp_ns.saturating_sub(before.stamp_ns) as f64) as i64;
    Some(before.stamp_ns.saturating_add(passed_ns))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// Messages every `step` milliseconds, for 20 seconds of the recorder's time from its second 1000 on. `times` makes the stamp
    /// and the time at which the message arrived, milliseconds, from the true time.
    fn stream(step: i64, times: impl Fn(i64) -> (i64, i64)) -> Vec<MessageTimes> {
        let message = |at: i64| {
            let (stamp, logged) = times(at * step);
            MessageTimes { stamp_ns: stamp * MS, logged_ns: (1_000_000 + logged) * MS }
        };
        (1..20_000 / step).map(message).collect()
    }

    #[test]
    fn a_constant_gap_is_measured_whatever_the_rates_and_latencies() {
        for gap in [-20_000, -6_000, -700, 700, 20_000, 9_000_000] {
            let pictures = stream(130, |at| (at, at + 90 + at % 60));
            let poses = stream(20, |at| (at + gap, at + at % 11));
            let ClockGap::Constant(found) = measure_gap(&pictures, &poses) else { panic!("{gap}") };
            assert!((found / MS - gap).abs() <= 150, "{gap} {found}");
        }
    }

    #[test]
    fn what_is_usual_is_no_gap() {
        let pictures = |latency: fn(i64) -> i64| stream(100, move |at| (at, at + latency(at)));
        let poses = |times: fn(i64) -> (i64, i64)| stream(20, times);
        for (what, gap) in [
            ("one clock", measure_gap(&pictures(|_| 0), &poses(|at| (at, at)))),
            ("late pictures", measure_gap(&pictures(|_| 450), &poses(|at| (at, at)))),
            ("uneven latency", measure_gap(&pictures(|at| at * 37 % 490), &poses(|at| (at, at + at * 13 % 300)))),
            (
                "at times very late",
                measure_gap(&pictures(|at| if at % 300 == 0 { 50 } else { 2500 }), &poses(|at| (at, at))),
            ),
            ("drift", measure_gap(&pictures(|_| 0), &poses(|at| (at + at / 100, at)))),
            ("stamps of zero", measure_gap(&stream(100, |at| (0, at)), &poses(|at| (at, at)))),
            ("written at once", measure_gap(&pictures(|at| -at), &poses(|at| (at, at / 1000)))),
            ("one topic after the other", measure_gap(&pictures(|_| 0), &poses(|at| (at, at + 30_000)))),
        ] {
            assert_eq!(gap, ClockGap::None, "{what}");
        }
        // Slow simulated time, a thousand seconds off.
        let simulated = |at: i64| (at / 3 + 1_000_000, at);
        assert_eq!(measure_gap(&stream(100, simulated), &stream(20, simulated)), ClockGap::None);
    }

    #[test]
    fn a_gap_that_changes_is_unsteady() {
        let pictures = stream(100, |at| (at, at));
        let stepped = stream(20, |at| (if at < 10_000 { at + 6_000 } else { at + 12_000 }, at));
        let ClockGap::Unsteady(least, most) = measure_gap(&pictures, &stepped) else { panic!() };
        assert_eq!((least / MS, most / MS), (6_000, 12_000));
        assert!(matches!(measure_gap(&pictures, &stream(20, |at| (at + at / 5, at))), ClockGap::Unsteady(..)));
    }

    #[test]
    fn doubled_and_relayed_messages_do_not_hide_a_gap() {
        let pictures = stream(100, |at| (at, at));
        let mut poses = stream(20, |at| (at + 5_000, at));
        poses.extend(stream(20, |at| (at + 5_000, at + 2_000)));
        assert_eq!(measure_gap(&pictures, &poses), ClockGap::Constant(5_000 * MS));
    }
}
