//! The closing task: what one can do with a thing.

use super::{
    Brief, WriteError,
    phrases::{pick, the},
    route::side_word,
};
use crate::lexicon::{Class, agree, normal, thing};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Distinction, Side, Verdict};

/// Things to do with a class of things; `{o}` is the thing with its article.
fn affordances(class: Class) -> &'static [&'static str] {
    match class {
        Class::Seat => &[
            "push in {o}",
            "sit on {o}",
            "wipe down {o}",
            "move {o}",
            "bring me {o}",
            "dust {o}",
            "clean {o}",
            "vacuum {o}",
        ],
        Class::Surface => {
            &["wipe down {o}", "clean {o}", "dust {o}", "clear off {o}", "polish {o}", "tidy {o}", "wipe off {o}"]
        }
        Class::Container => &[
            "open {o}",
            "close {o}",
            "look inside {o}",
            "dust {o}",
            "wipe down {o}",
            "clean {o}",
            "empty {o}",
            "organize {o}",
        ],
        Class::Bed => {
            &["make {o}", "lie down on {o}", "change the sheets of {o}", "sit on {o}", "look under {o}", "tidy {o}"]
        }
        Class::Textile => {
            &["bring me {o}", "fold {o}", "pick up {o}", "straighten {o}", "grab {o}", "wash {o}", "shake out {o}"]
        }
        Class::Drape => &["open {o}", "close {o}", "straighten {o}", "pull back {o}", "wash {o}", "draw {o}"],
        Class::Floor => &["vacuum {o}", "straighten {o}", "roll up {o}", "clean {o}", "shake out {o}"],
        Class::Light => &[
            "turn on {o}",
            "turn off {o}",
            "switch off {o}",
            "dust {o}",
            "change the bulb in {o}",
            "clean {o}",
            "switch on {o}",
        ],
        Class::Switch => &["check {o}", "press {o}", "inspect {o}", "wipe {o}", "test {o}"],
        Class::WallArt => {
            &["straighten {o}", "dust {o}", "take down {o}", "look at {o}", "dust off {o}", "clean {o}", "admire {o}"]
        }
        Class::Glass => {
            &["clean {o}", "wipe {o}", "wash {o}", "polish {o}", "look into {o}", "wipe down {o}", "look through {o}"]
        }
        Class::Door => &["open {o}", "close {o}", "knock on {o}", "lock {o}", "clean {o}"],
        Class::Structure | Class::Fabric | Class::Stairs => {
            &["dust {o}", "inspect {o}", "wipe down {o}", "clean {o}", "check {o}", "touch {o}"]
        }
        Class::Water => &["clean {o}", "check {o}", "look into {o}"],
        Class::Plant => &["water {o}", "trim {o}", "dust {o}", "bring me {o}", "move {o}", "check {o}"],
        Class::Ornament => &["dust {o}", "bring me {o}", "pick up {o}", "clean {o}", "move {o}", "admire {o}"],
        Class::Hearth => &["clean out {o}", "light {o}", "sweep {o}", "dust {o}", "check {o}"],
        Class::Fan => &["turn on {o}", "turn off {o}", "dust {o}", "clean {o}", "switch off {o}"],
        Class::Appliance => &["turn on {o}", "turn off {o}", "check {o}", "clean {o}", "wipe down {o}", "inspect {o}"],
        Class::Cooker => &["turn off {o}", "clean {o}", "wipe down {o}", "check {o}", "preheat {o}"],
        Class::Fridge => &["open {o}", "clean {o}", "close {o}", "look inside {o}", "check {o}"],
        Class::Basin => {
            &["clean {o}", "wash your hands in {o}", "scrub {o}", "rinse out {o}", "wipe down {o}", "unclog {o}"]
        }
        Class::Tap => &["turn on {o}", "turn off {o}", "check {o}", "clean {o}", "fix {o}"],
        Class::Toilet => &["clean {o}", "flush {o}", "scrub {o}", "wipe down {o}", "close {o}"],
        Class::Tub => &["clean {o}", "scrub {o}", "rinse out {o}", "wipe down {o}", "wash {o}"],
        Class::Screen => &["turn on {o}", "turn off {o}", "dust {o}", "wipe {o}", "watch {o}", "switch off {o}"],
        Class::Music => &["play {o}", "dust {o}", "tune {o}", "polish {o}"],
        Class::Exercise => &["wipe down {o}", "try {o}", "clean {o}", "inspect {o}"],
        Class::Vehicle => &["wash {o}", "wipe down {o}", "inspect {o}", "polish {o}"],
        Class::Small => &["bring me {o}", "pick up {o}", "grab {o}", "fetch {o}", "dust {o}", "clean {o}"],
        Class::Furnishing | Class::Unknown => {
            &["clean {o}", "dust {o}", "inspect {o}", "look at {o}", "wipe down {o}", "check {o}", "find {o}"]
        }
    }
}

/// The task of a text, and the name of its object.
pub(super) fn task(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<(String, String), WriteError> {
    let (name, object) = match &brief.walk.path.target {
        Some(target) => {
            let told_by = target.told_by.get(rng.random_range(0..target.told_by.len().max(1)));
            let must = target.has_namesake && !target.told_by.is_empty();
            let told_by = if must {
                target.told_by.first().filter(|_| rng.random_bool(0.7)).or(told_by)
            } else {
                told_by.filter(|_| rng.random_bool(0.3))
            };
            (target.name.clone(), told_by.map_or_else(|| the(&target.name), |told_by| told(&target.name, told_by, rng)))
        }
        None => {
            let name = free_object(brief, rng).ok_or(WriteError::NoObject)?;
            let object = the(&name);
            (name, object)
        }
    };
    let class = thing(&name).map_or(Class::Unknown, |thing| thing.class);
    Ok((pick(rng, affordances(class)).replace("{o}", &object), name))
}

/// A thing with what tells it from its likes.
fn told(name: &str, told_by: &Distinction, rng: &mut ChaCha8Rng) -> String {
    match told_by {
        Distinction::Colour { colour } => format!("the {colour} {name}"),
        Distinction::OnSide { side: side @ (Side::Left | Side::Right) } => {
            format!("the {name} {} {}", pick(rng, &["on your", "on the", "to your"]), side_word(*side))
        }
        Distinction::OnSide { .. } => the(name),
        Distinction::NextTo { neighbour } => {
            format!("the {name} {} the {neighbour}", pick(rng, &["next to", "by", "near", "beside", "closest to"]))
        }
        Distinction::Range { nearest: true } => {
            pick(rng, &["the nearest {n}", "the {n} nearest to you", "the {n} closest to you", "the closest {n}"])
                .replace("{n}", name)
        }
        Distinction::Range { nearest: false } => {
            pick(rng, &["the farthest {n}", "the {n} farthest from you"]).replace("{n}", name)
        }
    }
}

/// Something that was seen alone of its kind from the last frame, the more of a landmark the better.
fn free_object(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Option<String> {
    let last = brief.walk.path.frames.len() - 1;
    let blamed = |name: &str| {
        let failed = brief.complaints.iter().flat_map(|complaint| {
            complaint
                .findings
                .iter()
                .filter(|finding| finding.verdict == Verdict::Fail)
                .map(move |finding| (complaint, finding))
        });
        failed
            .filter_map(|(complaint, finding)| complaint.text.get(finding.span?[0]..finding.span?[1]))
            .any(|words| normal(words) == normal(name))
    };
    let seen: Vec<_> = brief.walk.seen(last).collect();
    let alone = |name: &str| seen.iter().filter(|other| agree(&other.sighting.name, name)).count() == 1;
    let plain = |name: &str| name.len() <= 40 && name.chars().all(|c| c.is_alphabetic() || c == ' ');
    let candidates = seen.iter().filter(|seen| plain(&seen.sighting.name) && !blamed(&seen.sighting.name));
    let scored = candidates.map(|seen| {
        let name = &seen.sighting.name;
        let (salience, class) = thing(name).map_or((0, Class::Unknown), |thing| (thing.salience, thing.class));
        // One of several, or a part of the building, only where there is nothing else.
        let poor =
            seen.sighting.several || matches!(class, Class::Structure | Class::Fabric | Class::Stairs | Class::Unknown);
        let score = f64::from(salience) + if alone(name) { 4.0 } else { 0.0 } - if poor { 20.0 } else { 0.0 };
        (score + rng.random_range(0.0..2.0), name.clone())
    });
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}
