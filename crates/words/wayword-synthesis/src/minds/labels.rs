//! Answers from ground truth. Named `labels` wherever it takes part: it perceives nothing.

use crate::{
    dialogue::{counted, with_article},
    lexicon::{agree, normal},
};
use wayword_core::{Answer, Answerer, Ask, GroundTruth, Label, ModelError, View, Where};

/// The answerer that reads a view's labels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Labels;

/// Most kinds of objects that a description names, the nearest first.
const MOST_NAMED: usize = 12;

impl Answerer for Labels {
    fn name(&self) -> &str {
        "labels"
    }

    fn answer(&self, asks: &[Ask<'_>]) -> Vec<Result<Answer, ModelError>> {
        asks.iter().map(|ask| answer(ask.view, ask.question)).collect()
    }
}

fn answer(view: &View, question: &str) -> Result<Answer, ModelError> {
    let truth = view.ground_truth().ok_or_else(|| ModelError::NothingToSee {
        mind: "labels".into(),
        needs: "labels",
        hint: "name a model that sees pictures, or use a platform or data folder with labels",
    })?;
    let asked = question.to_lowercase();
    let subject = |lead: &str| asked.strip_prefix(lead).map(|rest| rest.trim_end_matches('?').trim());
    Ok(if asked.contains("room") {
        truth.room.as_deref().map_or_else(not_sure, |room| format!("It is {}.", with_article(room)))
    } else if let Some(name) = subject("is there ") {
        presence(view, truth, name)
    } else if let Some(name) = subject("what colour is the ") {
        colour(truth, name)
    } else if asked.contains("describe") || asked.contains("objects") {
        describe(view, truth)
    } else {
        not_sure()
    })
}

fn not_sure() -> Answer {
    "I am not sure.".to_owned()
}

fn third(view: &View, label: &Label) -> Where {
    Where::at(view.pose.heading.turn_to(label.heading), view.horizontal_fov_rad)
}

fn phrase(third: Where) -> &'static str {
    match third {
        Where::Left => "on the left",
        Where::Middle => "in the middle",
        Where::Right => "on the right",
    }
}

/// "There is a bed in the middle, two lamps on the left and a chair on the right."
fn describe(view: &View, truth: &GroundTruth) -> Answer {
    let mut groups: Vec<(&str, Where, f64, usize)> = Vec::new();
    for label in &truth.labels {
        let (third, distance_m) = (third(view, label), label.distance_m.unwrap_or(f64::INFINITY));
        match groups.iter_mut().find(|(name, at, ..)| *name == label.name && *at == third) {
            Some(group) => (group.2, group.3) = (group.2.min(distance_m), group.3 + 1),
            None => groups.push((&label.name, third, distance_m, 1)),
        }
    }
    groups.sort_by(|a, b| a.2.total_cmp(&b.2));
    let items: Vec<String> = groups
        .iter()
        .take(MOST_NAMED)
        .map(|(name, third, _, count)| format!("{} {}", counted(*count, name), phrase(*third)))
        .collect();
    let verb = if groups.first().is_some_and(|group| group.3 > 1) { "are" } else { "is" };
    match items.as_slice() {
        [] => "I see nothing of note.".to_owned(),
        [only] => format!("There {verb} {only}."),
        [before @ .., last] => format!("There {verb} {} and {last}.", before.join(", ")),
    }
}

fn presence(view: &View, truth: &GroundTruth, name: &str) -> Answer {
    let name = ["a ", "an ", "any ", "some "].iter().find_map(|article| name.strip_prefix(article)).unwrap_or(name);
    match truth.labels.iter().find(|label| agree(&label.name, name)) {
        Some(label) => format!("Yes, {}.", phrase(third(view, label))),
        None => format!("No, there is no {name}."),
    }
}

fn colour(truth: &GroundTruth, name: &str) -> Answer {
    let label = truth.labels.iter().find(|label| normal(&label.name) == normal(name));
    label.and_then(|label| label.colour.as_ref()).map_or_else(not_sure, |colour| format!("The {name} is {colour}."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, Heading, ObjectId, Pose};

    fn view() -> View {
        let label = |id: &str, name: &str, deg: f64, colour: Option<&str>| Label {
            object: ObjectId::new(id).unwrap(),
            name: name.into(),
            heading: Heading::new(deg.to_radians()).unwrap(),
            elevation_rad: 0.0,
            box_px: None,
            distance_m: Some(deg.abs()),
            position: None,
            colour: colour.map(str::to_owned),
        };
        let labels = vec![
            label("1", "sofa", 0.0, Some("green")),
            label("2", "lamp", -30.0, None),
            label("3", "lamp", -35.0, None),
            label("4", "oven", 35.0, None),
        ];
        let truth = GroundTruth { labels, room: Some("office".into()) };
        View::new(Pose::level(DVec3::ZERO, Heading::NORTH), std::f64::consts::FRAC_PI_2, None, Some(truth))
    }

    fn ask(question: &str) -> String {
        let view = view();
        Labels.answer(&[Ask { view: &view, question, history: &[] }]).remove(0).unwrap()
    }

    #[test]
    fn it_tells_what_is_there_and_what_is_not() {
        assert_eq!(
            ask(crate::dialogue::OPENING),
            "There is a sofa in the middle, two lamps on the left and an oven on the right."
        );
        assert_eq!(ask("Which room is this?"), "It is an office.");
        assert_eq!(ask("Is there a couch?"), "Yes, in the middle.");
        assert_eq!(ask("Is there a mirror?"), "No, there is no mirror.");
        assert_eq!(ask("What colour is the sofa?"), "The sofa is green.");
        assert_eq!(ask("What colour is the oven?"), "I am not sure.");
    }

    #[test]
    fn without_labels_it_says_so() {
        let blind = View::new(Pose::level(DVec3::ZERO, Heading::NORTH), 1.0, None, None);
        assert!(Labels.answer(&[Ask { view: &blind, question: "Which room is this?", history: &[] }])[0].is_err());
    }
}
