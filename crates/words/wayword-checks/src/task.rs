//! Checks the closing task: its object has to be at the end of the path, and be the target.

use super::{
    CheckSubject, CheckWorld, new_finding, pass_finding,
    sides::{self, lies_on, side_word},
};
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
