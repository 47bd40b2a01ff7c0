//! Checks the closing task: its object has to be at the end of the path, and be the target.

use super::{
    Subject, World, finding, pass,
    sides::{self, lies_on, word},
};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    lexicon::agree,
    reading::{Reading, What},
};

pub(super) fn task(reading: &Reading, subject: Subject<'_>) -> Finding {
    let Subject { evidence, target, world, .. } = subject;
    let fail = |reason: String, span| finding(Check::Task, Verdict::Fail, reason, span);
    let Some(task) = &reading.task else { return fail("it does not end in a task".into(), None) };
    let object = task.object.map(|at| &reading.events[at]);
    let Some((What::Place(place), span)) = object.map(|event| (&event.what, event.span)) else {
        return fail(format!("its task ({:?}) names no object", task.verb), None);
    };
    let name = &place.name;
    if let Some(target) = target.filter(|target| !agree(&target.name, name)) {
        return fail(format!("its task is about {name:?}, and the given target is {:?}", target.name), Some(span));
    }
    let alike: Vec<_> = evidence.final_things().iter().filter(|thing| agree(&thing.name, name)).collect();
    // In an open world, labels that do not list an object do not deny it.
    if alike.is_empty() && (world == World::Open || !evidence.denies_thing_at_end(name)) {
        let reason = format!("the program cannot check whether there is {name:?}");
        return finding(Check::Task, Verdict::Unverified, reason, Some(span));
    }
    if alike.is_empty() {
        return fail(format!("{name:?} is not seen from the final viewpoint"), Some(span));
    }
    if sides::is_unknown(place, evidence) {
        let reason = format!("the program cannot check on which side of the walker {name:?} is");
        return finding(Check::Task, Verdict::Unverified, reason, Some(span));
    }
    // Where the target's id is known, the side is the target's and not that of another object of its name.
    let meant = alike.iter().filter(|thing| {
        target.is_none_or(|target| thing.object.as_ref().is_none_or(|object| *object == target.object))
    });
    let mut turns = meant.filter_map(|thing| thing.turn_rad).peekable();
    let is_known = turns.peek().is_some();
    match place.side.filter(|side| is_known && !turns.any(|turn_rad| lies_on(*side, turn_rad))) {
        Some(side) => fail(format!("{name:?} is not on the {} when one arrives", word(side)), Some(span)),
        None => pass(Check::Task),
    }
}
