use super::*;
use wayword_language::reading::read_instruction;

fn measured(texts: &[&str]) -> WayWording {
    let readings: Vec<TextReading> = texts.iter().map(|text| read_instruction(text, &BTreeSet::new())).collect();
    let mut way = WayWording::default();
    for (text, reading) in texts.iter().zip(&readings) {
        way.add_text(text, reading);
    }
    way.keep_common();
    way
}

#[test]
fn a_shape_is_a_clause_of_several_texts_without_names() {
    let way = measured(&[
        "Walk past the piano and turn left at the desk. Stop by the sofa.",
        "Walk past the globe, then turn right at the lamp. Wait in the attic.",
        "Leave the kitchen. Walk past the bench and turn left at the stove and stop by the sink.",
    ]);
    assert_eq!(way.shapes[&ClauseKind::Pass]["walk past the {l}"], 3.0);
    assert_eq!(way.shapes[&ClauseKind::TurnAt]["turn {s} at the {l}"], 3.0);
    assert!(!way.shapes.contains_key(&ClauseKind::Leave), "one text is no formula");
    assert_eq!((way.kinds[&ClauseKind::Leave], way.kinds[&ClauseKind::StopAt]), (1.0, 2.0));
    assert_eq!(
        (way.joints[&ClauseJoint::And], way.joints[&ClauseJoint::CommaThen], way.joints[&ClauseJoint::Stop]),
        (2.0, 1.0, 1.0)
    );
    assert_eq!((way.stop_joints[&ClauseJoint::Stop], way.stop_joints[&ClauseJoint::And]), (2.0, 1.0));
}

#[test]
fn a_clause_with_extra_detail_is_no_shape() {
    for text in [
        "Walk past the second piano.",
        "Walk past the green piano.",
        "Walk past the spooky piano.",
        "Walk past piano.",
        "Past the piano.",
        "Turn left in the far corner.",
        "Do not walk past the piano.",
        "Wait in the piano.",
        "Walk ten feet past the piano.",
    ] {
        let way = measured(&[text; 4]);
        assert!(way.shapes.values().all(BTreeMap::is_empty), "{text}: {:?}", way.shapes);
    }
}

#[test]
fn names_are_counted_by_their_usual_name() {
    let way = measured(&["Cross the hall. Stop by the couch."; 3]);
    assert_eq!(way.rooms["hallway"]["hall"], 3.0);
    assert_eq!(way.things["sofa"]["couch"], 3.0);
    assert_eq!(way.thing_mentions("sofa"), 3.0);
}

#[test]
fn every_built_in_shape_is_read_as_its_kind() {
    let own = WayWording::built_in();
    assert!(own.shapes.len() > 30 && own.joints.len() > 5, "way.toml is not read");
    for (kind, shapes) in &own.shapes {
        assert!(own.kinds.contains_key(kind), "{kind:?} has no share");
        for shape in shapes.keys() {
            assert!(shapes::reads_the_same(*kind, shape, &ALLOWED_SHAPE_WORDS), "{kind:?}: {shape}");
        }
    }
}

#[test]
fn few_texts_are_completed_by_our_own_constructions() {
    let text = "Walk past the piano.";
    let reading = read_instruction(text, &BTreeSet::new());
    let way = WayWording::from_texts([(text, &reading)]);
    assert_eq!(&way, WayWording::built_in());
}
