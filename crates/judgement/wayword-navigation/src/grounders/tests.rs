use super::*;
use std::sync::Arc;
use wayword_core::{
    DVec3, GroundTruth, Heading, ModelError, ObjectId, ObjectLabel, PhraseGrounder, Pose, TextEncoder, View,
};

/// Counts letters: texts with the same letters are alike.
struct Letters;

impl TextEncoder for Letters {
    fn name(&self) -> &str {
        "letters"
    }

    fn encode_texts(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, ModelError> {
        let vector = |text: &&str| {
            let mut counts = vec![0.0f32; 26];
            for letter in text.bytes().filter(u8::is_ascii_lowercase) {
                counts[usize::from(letter - b'a')] += 1.0;
            }
            let length = counts.iter().map(|count| count * count).sum::<f32>().sqrt().max(1e-9);
            counts.into_iter().map(|count| count / length).collect()
        };
        Ok(texts.iter().map(vector).collect())
    }
}

fn view(things: &[(&str, f64)], room: Option<&str>) -> View {
    let label = |(at, (name, distance_m)): (usize, &(&str, f64))| ObjectLabel {
        object: ObjectId::new(format!("{name}-{at}")).unwrap(),
        name: (*name).to_owned(),
        heading: Heading::NORTH,
        elevation_rad: 0.0,
        box_px: None,
        distance_m: Some(*distance_m),
        position: None,
        colour: None,
        room: None,
    };
    let labels = things.iter().enumerate().map(label).collect();
    let truth = GroundTruth { labels, lists_objects: true, room: room.map(str::to_owned) };
    View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.5, None, Some(truth))
}

fn scores(grounder: &dyn PhraseGrounder, view: &View, phrases: &[&str]) -> Vec<f32> {
    grounder.score_phrases(&[view], phrases).remove(0).unwrap()
}

#[test]
fn lexical_scores_the_share_of_places_in_view() {
    let kitchen = view(&[("sink", 1.0), ("armchair", 2.0)], Some("kitchen"));
    let views = LexicalGrounder::new(GrounderScope::Views);
    let told = scores(
        &views,
        &kitchen,
        &["wipe the sink", "the sink and the lamp", "go into the kitchen", "the lamp", "go on"],
    );
    assert_eq!(told, [1.0, 0.5, 1.0, 0.0, 0.0]);
    let akin = scores(&views, &kitchen, &["the chair"])[0];
    assert!(akin > 0.5 && akin < 1.0, "an armchair is a chair, but not the word: {akin}");
}

#[test]
fn a_detector_sees_no_rooms() {
    let kitchen = view(&[("sink", 1.0)], Some("kitchen"));
    for boxes in [
        &LexicalGrounder::new(GrounderScope::Boxes) as &dyn PhraseGrounder,
        &EncoderGrounder::new(GrounderScope::Boxes, Arc::new(Letters)),
    ] {
        let told = scores(boxes, &kitchen, &["the sink in the kitchen"]);
        assert!((told[0] - 1.0).abs() < 1e-6, "{}: the room does not count: {told:?}", boxes.name());
    }
    let empty = view(&[], Some("kitchen"));
    assert_eq!(scores(&EncoderGrounder::new(GrounderScope::Boxes, Arc::new(Letters)), &empty, &["kitchen"]), [0.0]);
    assert!(scores(&EncoderGrounder::new(GrounderScope::Views, Arc::new(Letters)), &empty, &["kitchen"])[0] > 0.99);
}

#[test]
fn the_nearest_of_the_best_is_pointed_at() {
    let near = view(&[("sink", 3.0), ("sink", 1.0), ("lamp", 0.5)], None);
    let none = view(&[], None);
    for grounder in [
        &LexicalGrounder::new(GrounderScope::Boxes) as &dyn PhraseGrounder,
        &EncoderGrounder::new(GrounderScope::Boxes, Arc::new(Letters)),
    ] {
        let object = grounder.point_to_object(&[&none, &near], "wipe the sink").unwrap().unwrap();
        assert_eq!(object.as_str(), "sink-1", "{}", grounder.name());
        assert_eq!(grounder.point_to_object(&[&none], "wipe the sink").unwrap(), None);
    }
}

#[test]
fn ground_without_labels_is_an_error() {
    let blind = View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.5, None, None);
    for grounder in [
        &LexicalGrounder::new(GrounderScope::Views) as &dyn PhraseGrounder,
        &EncoderGrounder::new(GrounderScope::Views, Arc::new(Letters)),
    ] {
        let told = grounder.score_phrases(&[&blind], &["the sink"]).remove(0).unwrap_err().to_string();
        assert!(told.contains("needs labels, but this view has none") && told.contains("--grounder hf/"), "{told}");
    }
}
