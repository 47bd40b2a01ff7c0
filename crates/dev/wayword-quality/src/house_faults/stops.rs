//! Faults of the place where a text stops: another thing in sight, and a relation that does not hold.

use super::{
    claims::LandmarkClaim,
    plan::PlanThing,
    subject::FaultSubject,
    word_lists::{LandmarkWord, STOP_THINGS},
};

/// The nearest thing of a name that is no place to stop at is farther from the end than this, metres.
const WRONG_END_M: f64 = 3.5;
/// Things within this distance of the end may be those at which the text stops, metres.
const END_REACH_M: f64 = 6.0;
/// A walker is not between two things of which one is farther from the end than this, metres.
const BETWEEN_M: f64 = 6.0;
/// Two things are not next to each other from this distance on, metres.
const NEXT_TO_M: f64 = 4.0;

/// The thing at which the last piece of a text stops, with the number of the piece.
fn find_stop_landmark<'s>(subject: &'s FaultSubject<'_>) -> Option<(usize, &'s LandmarkClaim)> {
    let (at, piece) = subject.pieces.iter().enumerate().next_back()?;
    let landmark = piece.claims.landmarks.iter().find(|landmark| landmark.preposition().is_some())?;
    (piece.claims.is_stop && landmark.has_article && landmark.after != "and").then_some((at, landmark))
}

/// The text with the stop at another thing of the room or in sight, of which none is near the end.
pub(super) fn stop_elsewhere(subject: &FaultSubject<'_>) -> Vec<String> {
    let Some((at, landmark)) = find_stop_landmark(subject) else { return Vec::new() };
    let (walk, end) = (&subject.walk, subject.walk.end());
    let end_room = walk.spots.last().and_then(|spot| spot.room);
    let replaced = STOP_THINGS.iter().filter_map(|name| {
        let word = LandmarkWord::for_name(name).filter(|word| !word.overlaps(landmark.word))?;
        let is_there = walk.things.iter().any(|sighted| {
            let is_visible = sighted.sight_m.last().is_some_and(|off_m| off_m.is_finite());
            sighted.thing.name == *name && (is_visible || end_room == Some(sighted.thing.room))
        });
        if !is_there || subject.measure_nearest_m(word, end) <= WRONG_END_M {
            return None;
        }
        Some(subject.text.with_words(at, landmark.phrase, &format!("the {name}"))?.render())
    });
    replaced.collect()
}

/// The text with a relation between the thing at the stop and another thing that does not hold.
pub(super) fn relate_wrongly(subject: &FaultSubject<'_>) -> Vec<String> {
    let Some((at, landmark)) = find_stop_landmark(subject).filter(|(_, landmark)| !landmark.is_plural) else {
        return Vec::new();
    };
    let Some((preposition, place)) = landmark.preposition() else { return Vec::new() };
    let phrase = subject.text.pieces.get(at).and_then(|piece| piece.get(landmark.phrase[0]..landmark.phrase[1]));
    let (end, [_, name_end]) = (subject.walk.end(), landmark.name);
    let mut edited = Vec::new();
    for name in STOP_THINGS {
        let word = LandmarkWord::for_name(name).filter(|word| !word.overlaps(landmark.word));
        let Some(word) = word.filter(|_| is_on_storey(subject, name)) else { continue };
        if let Some(phrase) = phrase.filter(|_| subject.measure_nearest_m(word, end) > BETWEEN_M) {
            let between = format!("between {phrase} and the {name}");
            edited.extend(subject.text.with_words(at, [place[0], name_end], &between));
        }
        if preposition != "next to" && are_apart(subject, landmark.word, word) {
            edited.extend(subject.text.with_words(at, [name_end, name_end], &format!(" next to the {name}")));
        }
    }
    edited.iter().map(|text| text.render()).collect()
}

/// Whether the storey of the end has a thing of this name in the plan.
fn is_on_storey(subject: &FaultSubject<'_>, name: &str) -> bool {
    let mut things = subject.walk.plan.things.iter();
    things.any(|thing| thing.name == name && thing.distance_m(subject.walk.end()).is_finite())
}

/// Whether no thing near the end that one word may mean is near any thing of the storey that another word may mean.
fn are_apart(subject: &FaultSubject<'_>, near: &LandmarkWord, other: &LandmarkWord) -> bool {
    let end = subject.walk.end();
    let things = |word: &LandmarkWord, reach_m: f64| -> Vec<&PlanThing> {
        let all = subject.walk.plan.things.iter();
        all.filter(|thing| word.can_mean(&thing.name) && thing.distance_m(end) <= reach_m).collect()
    };
    let (ones, others) = (things(near, END_REACH_M), things(other, f64::MAX));
    let is_apart = |one: &&PlanThing| others.iter().all(|other| one.gap_m(other) >= NEXT_TO_M);
    !ones.is_empty() && !others.is_empty() && ones.iter().all(is_apart)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{frames_along, hallway_house, hallway_subject},
        },
        *,
    };

    #[test]
    fn stop_elsewhere_takes_things_in_sight_of_the_end_that_are_far_from_it() {
        let plan = HousePlan::new(hallway_house());
        // From the bedroom's door the bed is 2.7 m away, the plant 2.8 m, and the dresser 3.8 m.
        let to_the_door = frames_along(&[[4.5, 0.8], [8.5, 0.8], [8.5, 2.2]]);
        let subject = FaultSubject::new(&plan, &to_the_door, "Turn left. Stop in front of the wide bed.").unwrap();
        assert_eq!(stop_elsewhere(&subject), ["Turn left. Stop in front of the dresser."]);
        let inside = hallway_subject(&plan, "Turn left. Stop in front of the bed.");
        assert!(stop_elsewhere(&inside).is_empty(), "the dresser is 0.7 m from the end");
        assert!(stop_elsewhere(&hallway_subject(&plan, "Turn left. Stop.")).is_empty());
    }

    #[test]
    fn relate_wrongly_takes_things_that_are_far_from_the_thing_at_the_stop() {
        let plan = HousePlan::new(hallway_house());
        let edited = relate_wrongly(&hallway_subject(&plan, "Turn left. Stop by the bed."));
        assert!(edited.contains(&"Turn left. Stop between the bed and the bookshelf.".to_owned()), "{edited:?}");
        assert!(edited.contains(&"Turn left. Stop by the bed next to the bookshelf.".to_owned()), "{edited:?}");
        assert!(!edited.iter().any(|text| text.contains("dresser")), "it is near: {edited:?}");
        assert!(relate_wrongly(&hallway_subject(&plan, "Turn left. Walk past the bed. Stop.")).is_empty());
    }
}
