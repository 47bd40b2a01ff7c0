use super::*;
use crate::made_buildings::{add_thing, make_corridor, make_mention};
use wayword_language::reading::steps::StepRelation;

#[test]
fn names_along_are_the_rooms_of_the_walk_and_the_striking_things_that_are_seen_from_it() {
    let mut building = make_corridor(&["kitchen", "attic", "kitchen", "garage"]);
    for (name, seen_from) in [("sofa", 0), ("wall", 0), ("piano", 1), ("refrigerator", 3), ("zzz", 1)] {
        add_thing(&mut building, name, [0.0; 3], &[seen_from]);
    }
    let names: Vec<_> = names_along(&building, &[0, 1, 2]).into_iter().map(|name| (name.is_room, name.name)).collect();
    let salience = |name: &str| wayword_language::lexicon::find_thing(name).map_or(0, |thing| thing.salience);
    assert!(salience("sofa") >= 2 && salience("piano") >= salience("sofa") && salience("wall") < 2);
    let named = |is_room, name: &str| (is_room, name.to_owned());
    assert_eq!(names, [named(true, "attic"), named(true, "kitchen"), named(false, "piano"), named(false, "sofa")]);
}

#[test]
fn can_replace_replaces_a_room_by_another_room_and_a_thing_by_another_thing() {
    let may = |told: (bool, &str), other: (bool, &str)| {
        let name = PlaceQuery { is_room: other.0, name: other.1.to_owned() };
        can_replace(&make_mention(StepRelation::To, told.0, told.1), &name)
    };
    assert!(may((true, "kitchen"), (true, "bedroom")) && may((false, "sofa"), (false, "piano")));
    assert!(!may((true, "kitchen"), (false, "piano")) && !may((false, "sofa"), (true, "bedroom")));
    assert!(!may((true, "kitchen"), (true, "dining room")), "people take one for the other");
    assert!(!may((false, "sofa"), (false, "couch")) && !may((false, "sofa"), (false, "sofa")));
    assert!(!may((true, "stairs"), (true, "bedroom")) && !may((true, "bedroom"), (true, "staircase")));
}

#[test]
fn replacement_words_fit_the_number_the_article_and_the_capitals() {
    let words = |text: &'static str, old: &str, told: &str, name: &str| {
        let span = |words: &str| text.find(words).map(|from| [from, from + words.len()]).unwrap();
        replacement_words(&TokenisedText::from_text(text), span(old), span(told), name)
    };
    assert_eq!(words("pass the sofas", "sofas", "sofas", "piano"), "pianos");
    assert_eq!(words("pass the sofa", "sofa", "sofa", "piano"), "piano");
    assert_eq!(words("pass a sofa", "sofa", "a sofa", "oven"), "an oven");
    assert_eq!(words("pass a sofa", "sofa", "a sofa", "curtains"), "curtains");
    assert_eq!(words("pass the Sofa", "Sofa", "Sofa", "piano"), "Piano");
}
