//! Writes the closing task of an instruction ("... and dust the lamp") and chooses its object where no target is given.

use super::{WriteError, WritingBrief, object::TaskObject};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::Verdict;
use wayword_language::lexicon::{ThingClass, find_thing, names_agree, normalise_name};

/// Draws a task; returns its words and the name of its object.
pub(super) fn draw_task(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> Result<(String, String), WriteError> {
    let object = TaskObject::for_brief(brief, rng)?;
    let wording = &brief.profile.wording;
    let phrase = object.object_phrase(&object.in_view(wording, rng), wording, rng);
    Ok((task_phrase(wording.draw_verb(&object.name, 1.0, rng), &phrase), object.name))
}

/// The words of a task. A particle follows a short object only: "turn the lamp on", but "turn on the lamp by the door".
pub(super) fn task_phrase(verb: &str, object: &str) -> String {
    match verb.split_once(" {o} ") {
        Some((verb, particle)) if object.split(' ').count() > 3 => format!("{verb} {particle} {object}"),
        _ => verb.replace("{o}", object),
    }
}

/// Chooses an object for the task that was seen from the last frame, preferably the only one of its kind and a good
/// landmark.
pub(in crate::writer) fn free_object(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> Option<String> {
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
            .any(|words| normalise_name(words) == normalise_name(name))
    };
    let seen: Vec<_> = brief.walk.seen_from(last).collect();
    let alone = |name: &str| seen.iter().filter(|other| names_agree(&other.sighting.name, name)).count() == 1;
    let plain = |name: &str| name.len() <= 40 && name.chars().all(|c| c.is_alphabetic() || c == ' ');
    let candidates = seen.iter().filter(|seen| plain(&seen.sighting.name) && !blamed(&seen.sighting.name));
    let scored = candidates.map(|seen| {
        let name = &seen.sighting.name;
        let (salience, class) =
            find_thing(name).map_or((0, ThingClass::Unknown), |thing| (thing.salience, thing.class));
        // One of several, or a part of the building, is chosen only if there is no other object.
        let poor = seen.sighting.several
            || matches!(class, ThingClass::Structure | ThingClass::Fabric | ThingClass::Stairs | ThingClass::Unknown);
        let score = f64::from(salience) + if alone(name) { 4.0 } else { 0.0 } - if poor { 20.0 } else { 0.0 };
        (score + rng.random_range(0.0..2.0), name.clone())
    });
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}
