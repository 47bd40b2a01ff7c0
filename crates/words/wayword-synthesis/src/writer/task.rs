//! The closing task: what one can do with a thing.

use super::{
    Brief, WriteError,
    phrases::{pick, the},
    route::side_word,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Distinction, Side, Verdict};
use wayword_language::lexicon::{Class, agree, normal, thing};

/// Things to do with a class of things; `{o}` is the thing with its article. Where a class is common enough in
/// REVERIE's train split, they are what people ask for most there, the commonest first: a picture is brought, taken
/// down or removed far more often than admired.
fn affordances(class: Class) -> &'static [&'static str] {
    match class {
        Class::Seat => &[
            "pull out {o}",
            "bring me {o}",
            "sit on {o}",
            "move {o}",
            "clean {o}",
            "sit down on {o}",
            "push in {o}",
            "dust off {o}",
        ],
        Class::Surface => &[
            "clean {o}",
            "wipe down {o}",
            "clean off {o}",
            "wipe off {o}",
            "dust off {o}",
            "clear off {o}",
            "dust {o}",
        ],
        Class::Container => &[
            "open {o}",
            "clean {o}",
            "look inside {o}",
            "dust {o}",
            "wipe down {o}",
            "clean off {o}",
            "empty {o}",
            "dust off {o}",
        ],
        Class::Bed => {
            &["make {o}", "lie down on {o}", "change the sheets of {o}", "sit on {o}", "look under {o}", "tidy {o}"]
        }
        Class::Textile => &["bring me {o}", "pick up {o}", "fold {o}", "grab {o}", "fetch {o}", "straighten {o}"],
        Class::Drape => &["close {o}", "open {o}", "pull down {o}", "pull back {o}", "wash {o}", "take down {o}"],
        Class::Floor => &["vacuum {o}", "straighten {o}", "roll up {o}", "clean {o}", "shake out {o}"],
        Class::Light => &[
            "turn off {o}",
            "turn on {o}",
            "change the bulb in {o}",
            "switch off {o}",
            "dust {o}",
            "clean {o}",
            "switch on {o}",
        ],
        Class::Switch => &["check {o}", "press {o}", "inspect {o}", "wipe {o}", "test {o}"],
        Class::WallArt => &[
            "bring me {o}",
            "take down {o}",
            "remove {o}",
            "clean {o}",
            "dust off {o}",
            "straighten {o}",
            "dust {o}",
            "look at {o}",
        ],
        Class::Glass => {
            &["clean {o}", "polish {o}", "wipe {o}", "wash {o}", "wipe down {o}", "look into {o}", "wipe off {o}"]
        }
        Class::Door => &["open {o}", "close {o}", "knock on {o}", "lock {o}", "clean {o}"],
        Class::Structure | Class::Fabric | Class::Stairs => {
            &["dust {o}", "inspect {o}", "wipe down {o}", "clean {o}", "check {o}", "touch {o}"]
        }
        Class::Water => &["clean {o}", "check {o}", "look into {o}"],
        Class::Plant => &["water {o}", "bring me {o}", "move {o}", "pick up {o}", "trim {o}", "look at {o}"],
        Class::Ornament => &["bring me {o}", "pick up {o}", "move {o}", "dust {o}", "clean {o}", "fetch {o}"],
        Class::Hearth => &["light {o}", "turn on {o}", "clean out {o}", "sweep out {o}", "turn off {o}"],
        Class::Fan => &["turn on {o}", "turn off {o}", "dust {o}", "clean {o}", "switch off {o}"],
        Class::Appliance => &["turn on {o}", "turn off {o}", "check {o}", "clean {o}", "wipe down {o}", "open {o}"],
        Class::Cooker => &["turn off {o}", "clean {o}", "wipe down {o}", "check {o}", "turn on {o}"],
        Class::Fridge => &["open {o}", "clean {o}", "close {o}", "look inside {o}", "check {o}"],
        Class::Basin => &[
            "clean {o}",
            "fill {o}",
            "clean out {o}",
            "rinse out {o}",
            "wipe out {o}",
            "drain {o}",
            "wash your hands in {o}",
        ],
        Class::Tap => &["turn on {o}", "turn off {o}", "check {o}", "clean {o}", "fix {o}"],
        Class::Toilet => &["flush {o}", "clean {o}", "scrub {o}", "sit down on {o}", "open the lid of {o}"],
        Class::Tub => &["clean {o}", "fill {o}", "clean out {o}", "scrub {o}", "rinse out {o}"],
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

/// A thing with what sets it apart from others of its name.
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

/// An object for the task that was seen from the last frame: best the only one of its kind, and a good landmark.
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
