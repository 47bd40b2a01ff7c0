//! Tests with made-up texts.

use super::*;

fn of(text: &str) -> TargetDescription {
    describe_target(text, &["zorble".to_owned()].into()).unwrap()
}

fn near(said: &TargetDescription, at: usize) -> (RelationKind, &str) {
    (said.relations[at].how, said.relations[at].to[0].name.as_str())
}

#[test]
fn room_level_and_object_are_read_with_the_move_first_or_the_task_first() {
    for text in [
        "Go to the bedroom on level 2 and fluff the pillow closest to the window.",
        "Fluff the pillow closest to the window in the bedroom on the second floor",
        "In the bedroom on level two, fluff the pillow closest to the window",
    ] {
        let said = of(text);
        assert_eq!((said.name.as_str(), said.level), ("pillow", Some(LevelMention::Number(2))), "{text}");
        assert_eq!(said.room.as_ref().unwrap().name, "bedroom", "{text}");
        assert_eq!(near(&said, 0), (RelationKind::Closest, "window"), "{text}");
        assert_eq!(said.relations.len(), 1, "{text}");
    }
}

#[test]
fn things_in_a_room_and_rooms_next_to_it_belong_to_the_room() {
    let said = of("Go to the bathroom next to the office with two sinks and wipe the mirror above the left sink");
    let room = said.room.clone().unwrap();
    assert_eq!(
        (room.name.as_str(), room.beside, room.things),
        ("bathroom", vec!["office".into()], vec!["sink".into()])
    );
    assert_eq!((said.name.as_str(), near(&said, 0)), ("mirror", (RelationKind::Above, "sink")));
}

#[test]
fn ranks_sides_and_looks_are_read_before_and_after_the_object() {
    let said = of("Go to the kitchen and turn on the leftmost lamp");
    assert_eq!((said.name.as_str(), said.ranks), ("lamp", vec![NamesakeRank::Leftmost]));
    assert_eq!(of("Walk to the hallway and dust the second picture from the left").ranks, [NamesakeRank::FromLeft(1)]);
    assert!(of("Dust the red picture in the hallway").has_look);
    let said = of("Go to the hallway and dust the picture on your left");
    assert_eq!(said.side, Some(ArrivalSide { is_left: true, is_yours: true }));
    let said = of("Go to the hallway and dust the picture to the left of the mirror");
    assert_eq!((said.side, near(&said, 0)), (None, (RelationKind::LeftOf, "mirror")));
}

#[test]
fn between_has_two_landmarks_and_names_of_the_building_count() {
    let said = of("Enter the garage and move the zorble between the car and the shelf");
    assert_eq!((said.name.as_str(), said.relations[0].how), ("zorble", RelationKind::Between));
    assert_eq!(said.relations[0].to.len(), 2);
}
