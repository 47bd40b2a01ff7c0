//! Checks the closing task: its object has to be at the end of the path, and be the target.

use super::{
    CheckSubject, CheckWorld, new_finding, pass_finding,
    sides::{self, lies_on, side_word},
};
use crate::memory::RememberedThing;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    lexicon::names_agree,
    reading::{EventContent, TextReading},
};

/// The finding on the task at the end of a text.
pub(super) fn check_task(reading: &TextReading, subject: CheckSubject<'_>) -> CheckFinding {
    let CheckSubject { evidence, target, world, .. } = subject;
    let fail = |reason: String, span| new_finding(CheckKind::Task, Verdict::Fail, reason, span);
    let Some(task) = &reading.task else { return fail("it does not end in a task".into(), None) };
    let object = task.object.map(|at| &reading.events[at]);
    let Some((EventContent::Place(place), span)) = object.map(|event| (&event.what, event.span)) else {
        return fail(format!("its task ({:?}) names no object", task.verb), None);
    };
    let name = &place.name;
    if let Some(target) = target.filter(|target| !names_agree(&target.name, name)) {
        return fail(format!("its task is about {name:?}, and the given target is {:?}", target.name), Some(span));
    }
    let alike: Vec<_> = evidence.final_things().iter().filter(|thing| names_agree(&thing.name, name)).collect();
    // Witnesses look ahead alone. The world has given the target, and what was seen near the end stands there still.
    let is_known_there = || target.is_some() || was_seen_near_end(name, subject);
    if alike.is_empty() && evidence.source.leaves_out() && place.side.is_none() && is_known_there() {
        return pass_finding(CheckKind::Task);
    }
    // In an open world, labels that do not list an object do not deny it.
    if alike.is_empty() && (world == CheckWorld::Open || !evidence.denies_thing_at_end(name)) {
        let reason = format!("the program cannot check whether there is {name:?}");
        return new_finding(CheckKind::Task, Verdict::Unverified, reason, Some(span));
    }
    if alike.is_empty() {
        return fail(format!("{name:?} is not seen from the final viewpoint"), Some(span));
    }
    if sides::is_side_unknown(place, evidence) {
        let reason = format!("the program cannot check on which side of the walker {name:?} is");
        return new_finding(CheckKind::Task, Verdict::Unverified, reason, Some(span));
    }
    // Where the target's id is known, the side is the target's and not that of another object of its name.
    let meant = alike.iter().filter(|thing| {
        target.is_none_or(|target| thing.object.as_ref().is_none_or(|object| *object == target.object))
    });
    let mut turns = meant.filter_map(|thing| thing.turn_rad).peekable();
    let is_known = turns.peek().is_some();
    match place.side.filter(|side| is_known && !turns.any(|turn_rad| lies_on(*side, turn_rad))) {
        Some(side) => fail(format!("{name:?} is not on the {} when one arrives", side_word(side)), Some(span)),
        None => pass_finding(CheckKind::Task),
    }
}

/// A thing at the end of a path is at most so far from it, metres.
const AT_END_M: f64 = 3.0;

/// Whether a frame before the end shows a thing of that name which stands near the end, in its room.
fn was_seen_near_end(name: &str, subject: CheckSubject<'_>) -> bool {
    let Some(memory) = subject.memory else { return false };
    let last = memory.frame_count().saturating_sub(1);
    let is_near = |thing: &RememberedThing| memory.distance_m(thing, last).is_some_and(|far_m| far_m <= AT_END_M);
    let mut alike = memory.things.iter().filter(|thing| names_agree(&thing.name, name));
    alike.any(|thing| is_near(thing) && memory.shares_room(thing, last..=last))
}
