//! Judges the clocks of a recording: which messages belong together, and how far the stamps of poses are from those of the
//! pictures.
//!
//! Every message has two times: the stamp in its header, and the time at which the recorder received it. The recorder has one
//! clock for all topics, so its times show where stamps begin again ([`super::clock_parts`]), and where two topics were stamped
//! by different clocks ([`super::clock_gap`]).

use super::{
    clock_gap::{ClockGap, measure_gap},
    clock_parts::{RecordingParts, find_parts},
    message_times::{MessageClock, MessageTimes, StreamTiming},
    topics::UnclearReason,
    transform_tree::TransformEdge,
};
use crate::describe::{RecordingClock, RecordingDescription};

const PART_HINT: &str = "set `part` to one of these numbers, or leave it out";
const CLOCK_HINT: &str = "write `clock = \"recorder\"` into a file NAME.toml beside the recording, or into recording.toml, to \
                          place pictures and poses by the times at which they were recorded, or `clock = \"stamps\"` to \
                          believe the stamps";
/// Most cuts that a remark gives in seconds.
const MAX_TOLD_CUTS: usize = 3;
/// Stamps stand still if they cover less than this share of the recorder's time.
const STANDING_SHARE: i64 = 1000;
/// Shortest time over which stamps can be said to stand still, nanoseconds.
const MIN_STANDING_NS: i64 = 1_000_000_000;
/// Localisers stamp a frame of the ground in another one (`odom` in `map`) ahead, so that others need not wait for it, or behind,
/// because they are slow: by up to this, nanoseconds. Such a frame moves little.
const MAX_GROUND_GAP_NS: i64 = 2_000_000_000;

/// A constant gap up to this may be the time that a camera needs to compress and send a picture, nanoseconds: its stamp is right then.
const MAX_DELAY_NS: i64 = 1_200_000_000;

/// Which messages count, and at what times.
#[derive(Debug)]
pub(crate) struct ClockPlan {
    pub(crate) camera: StreamTiming,
    /// For each edge of the chain of poses.
    pub(crate) edges: Vec<StreamTiming>,
    /// What the user has to be told.
    pub(crate) remarks: Vec<String>,
}

/// The clocks of the pictures and of the edges from the camera up to a fixed frame.
///
/// # Errors
/// When the clocks contradict each other, and nothing shows which is right, or when the user names a part that is not there.
pub(crate) fn plan_clocks(
    shots: &[MessageTimes],
    chain: &[&TransformEdge],
    described: &RecordingDescription,
) -> Result<ClockPlan, UnclearReason> {
    let mut remarks = Vec::new();
    if described.clock == Some(RecordingClock::Recorder) {
        return Ok(ClockPlan::whole(MessageClock::Log, chain.len(), remarks));
    }
    let streams: Vec<(&str, Vec<MessageTimes>)> = std::iter::once(("the pictures", shots.to_vec()))
        .chain(chain.iter().filter(|edge| edge.is_moving()).map(|edge| (edge.name.as_str(), edge.message_times())))
        .collect();
    if let Some((name, _)) = streams.iter().find(|(_, times)| stamps_stand_still(times)) {
        remarks.push(format!(
            "the stamps of {name} stand still, so pictures and poses are placed by the times at which they were recorded"
        ));
        return Ok(ClockPlan::whole(MessageClock::Log, chain.len(), remarks));
    }
    let times: Vec<&[MessageTimes]> = streams.iter().map(|(_, times)| times.as_slice()).collect();
    let parts = find_parts(&times);
    let chosen = choose_part(&parts, shots, described, &mut remarks)?;
    let mut moving = 0;
    let timings = chain.iter().map(|edge| {
        moving += usize::from(edge.is_moving());
        // An edge that does not move is valid in all parts.
        let logged_ns = if edge.is_moving() { parts.logged_ns(chosen, moving) } else { i64::MIN..=i64::MAX };
        StreamTiming { clock: MessageClock::Stamp, logged_ns, shift_ns: 0 }
    });
    let mut plan = ClockPlan {
        edges: timings.collect(),
        camera: StreamTiming { clock: MessageClock::Stamp, logged_ns: parts.logged_ns(chosen, 0), shift_ns: 0 },
        remarks,
    };
    if described.clock != Some(RecordingClock::Stamps) {
        plan.shift_edges(shots, chain)?;
    }
    Ok(plan)
}

impl ClockPlan {
    /// All messages, on one clock.
    pub(crate) fn whole(clock: MessageClock, edges: usize, remarks: Vec<String>) -> Self {
        Self { camera: StreamTiming::whole(clock), edges: vec![StreamTiming::whole(clock); edges], remarks }
    }

    /// The same messages, at the recorder's times.
    pub(crate) fn on_recorder_clock(&self) -> Self {
        let on_log = |timing: &StreamTiming| StreamTiming { clock: MessageClock::Log, ..timing.clone() };
        Self {
            camera: on_log(&self.camera),
            edges: self.edges.iter().map(on_log).collect(),
            remarks: self.remarks.clone(),
        }
    }

    /// Moves the stamps of each edge to the clock of the pictures, if the recorder's times show that it is another one.
    fn shift_edges(&mut self, shots: &[MessageTimes], chain: &[&TransformEdge]) -> Result<(), UnclearReason> {
        let shots = self.camera.counting(shots);
        let mut is_by_recorder = false;
        for (edge, timing) in chain.iter().zip(&mut self.edges).filter(|(edge, _)| edge.is_moving()) {
            let times = timing.counting(&edge.message_times());
            let gap = measure_gap(&shots, &times);
            match gap {
                ClockGap::None => {}
                _ if edge.places_ground() && gap.most_ns() <= MAX_GROUND_GAP_NS => {}
                ClockGap::Constant(ahead_ns) if ahead_ns.saturating_abs() <= MAX_DELAY_NS => {
                    self.remarks.push(format!(
                        "by the recorder's clock, the stamps of {} are {:.1} s {} those of the pictures; that is taken for a delay on \
                         the way to the recorder, and the stamps are believed. If the clocks differ, {CLOCK_HINT}",
                        edge.name,
                        seconds(ahead_ns.saturating_abs()),
                        if ahead_ns < 0 { "behind" } else { "ahead of" },
                    ));
                }
                ClockGap::Constant(ahead_ns) => {
                    timing.shift_ns = ahead_ns.saturating_neg();
                    self.remarks.push(format!(
                        "by the recorder's clock, the stamps of {} are {:.1} s {} those of the pictures, so they are moved by that \
                         time; if the stamps are right, write `clock = \"stamps\"` into a NAME.toml beside the recording, or into \
                         recording.toml",
                        edge.name,
                        seconds(ahead_ns.saturating_abs()),
                        if ahead_ns < 0 { "behind" } else { "ahead of" },
                    ));
                }
                // Simulated time and that of the day cannot be meant to fit.
                ClockGap::Unsteady(..) if !stamps_overlap(&shots, &times) => {
                    self.remarks.push(format!(
                        "the stamps of {} are of another time than those of the pictures, so both are placed by the times at \
                         which they were recorded",
                        edge.name
                    ));
                    is_by_recorder = true;
                }
                ClockGap::Unsteady(least_ns, most_ns) => {
                    let reason = format!(
                        "by the recorder's clock, the stamps of {} are between {:.1} and {:.1} s ahead of those of the pictures, \
                         and not by a constant time",
                        edge.name,
                        seconds(least_ns),
                        seconds(most_ns)
                    );
                    return Err((reason, CLOCK_HINT));
                }
            }
        }
        if is_by_recorder {
            *self = self.on_recorder_clock();
        }
        Ok(())
    }
}

/// The part that the user names, else that with the most pictures.
fn choose_part(
    parts: &RecordingParts,
    shots: &[MessageTimes],
    described: &RecordingDescription,
    remarks: &mut Vec<String>,
) -> Result<usize, UnclearReason> {
    let count_shots = |part: usize| {
        let logged_ns = parts.logged_ns(part, 0);
        shots.iter().filter(|times| logged_ns.contains(&times.logged_ns)).count()
    };
    let counts: Vec<usize> = (0..parts.count()).map(count_shots).collect();
    let most = (0..counts.len()).rev().max_by_key(|part| counts.get(*part));
    let chosen = described.part.map_or(Some(most.unwrap_or(0)), |part| part.checked_sub(1));
    let Some(chosen) = chosen.filter(|part| *part < counts.len()) else {
        let reason = format!("part = {}, but its parts are 1 to {}", described.part.unwrap_or(0), counts.len());
        return Err((reason, PART_HINT));
    };
    if counts.len() > 1 {
        let first_ns = shots.iter().map(|times| times.logged_ns).min().unwrap_or(0);
        let cuts = parts.cuts().map(|cut| {
            format!("by {:.1} s after {:.1} s", seconds(cut.back_ns), seconds(cut.first_ns().saturating_sub(first_ns)))
        });
        let cuts: Vec<String> = cuts.take(MAX_TOLD_CUTS).collect();
        let more = if counts.len() - 1 > cuts.len() { ", and again later" } else { "" };
        remarks.push(format!(
            "the stamps go back {}{more}, while the recorder's time goes on, as when a simulator or a driver starts again. So \
             the recording is cut there into {} parts, and only part {} is used, with {} of {} pictures; `part = N` in a NAME.toml \
             beside the recording, or in recording.toml, chooses another",
            cuts.join(", "),
            counts.len(),
            chosen + 1,
            counts.get(chosen).copied().unwrap_or(0),
            shots.len(),
        ));
    }
    Ok(chosen)
}

/// Whether stamps are set, but do not go on while the recorder's time does.
fn stamps_stand_still(times: &[MessageTimes]) -> bool {
    let stamped: Vec<&MessageTimes> = times.iter().filter(|times| times.stamp_ns != 0).collect();
    let span = |time_ns: fn(&MessageTimes) -> i64| {
        let all = || stamped.iter().map(|times| time_ns(times));
        all().max().unwrap_or(0).saturating_sub(all().min().unwrap_or(0))
    };
    let logged_ns = span(|times| times.logged_ns);
    stamped.len() > 2
        && logged_ns >= MIN_STANDING_NS
        && span(|times| times.stamp_ns).saturating_mul(STANDING_SHARE) < logged_ns
}

/// Whether the stamps of two streams have times in common.
fn stamps_overlap(some: &[MessageTimes], others: &[MessageTimes]) -> bool {
    let span = |times: &[MessageTimes]| {
        let stamps = || times.iter().map(|times| times.stamp_ns).filter(|stamp_ns| *stamp_ns != 0);
        Some((stamps().min()?, stamps().max()?))
    };
    let (Some(some), Some(others)) = (span(some), span(others)) else { return false };
    some.0 <= others.1 && others.0 <= some.1
}

fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-9
}
