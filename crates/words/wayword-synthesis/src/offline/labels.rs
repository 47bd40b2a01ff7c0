//! Answers questions from ground-truth labels instead of looking. It is called `labels` in every record, because it
//! perceives nothing.
//!
//! Some datasets label only things within two metres. So for a big thing that a room of this kind usually has, a
//! missing label means "not sure" and not "no", unless the platform lists everything or a calibration decides
//! otherwise.

use super::structured_answer::{labels_as_json, third_of_view};
use crate::dialogue::{QuestionSubject, QuestionThing, read_question};
use std::sync::Arc;
use wayword_checks::open::{Calibration, is_expected};
use wayword_core::{
    AnswerForm, AnswerText, GroundTruth, ModelError, ObjectLabel, View, ViewAnswerer, ViewQuestion, ViewThird,
};
use wayword_language::lexicon::{counted_name, names_agree, normalise_name, same_room, to_plural, with_article};

/// The answerer that reads a view's labels.
#[derive(Debug, Clone, Default)]
pub struct LabelAnswerer {
    /// Whether the labels contain everything that can be seen in a view, so that a missing label means absence.
    pub list_everything: bool,
    /// For single names, whether the user's own data treats a missing label as absence.
    pub calibration: Option<Arc<Calibration>>,
}

/// Most groups of like objects that a description names, the nearest first; farther ones are left out.
const MAX_NAMED_GROUPS: usize = 12;

impl ViewAnswerer for LabelAnswerer {
    fn name(&self) -> &str {
        "labels"
    }

    fn answer_questions(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<AnswerText, ModelError>> {
        asks.iter().map(|ask| self.answer_from_labels(ask)).collect()
    }
}

impl LabelAnswerer {
    /// The answer to one question, or the JSON of a structured answer. An error where the view has no labels.
    fn answer_from_labels(&self, ask: &ViewQuestion<'_>) -> Result<AnswerText, ModelError> {
        let ViewQuestion { view, question, .. } = *ask;
        let truth = view.ground_truth().ok_or_else(|| ModelError::NothingToSee {
            name: "--see labels".into(),
            needs: "labels",
            hint: "name a model that sees pictures, as in --see ollama/llava (docs/MODELS.md), or use a platform with labels",
        })?;
        if ask.answer != AnswerForm::Words {
            return Ok(labels_as_json(view, truth));
        }
        Ok(match read_question(question) {
            QuestionSubject::Room => {
                truth.room.as_deref().map_or_else(not_sure, |room| format!("It is {}.", with_article(room)))
            }
            QuestionSubject::IsRoom(name) => truth.room.as_deref().map_or_else(not_sure, |room| is_room(room, &name)),
            QuestionSubject::Presence { wanted, are_alternatives: or } => {
                self.answer_presence(view, truth, &wanted, or)
            }
            QuestionSubject::Colour { name, .. } => answer_colour(truth, &name),
            QuestionSubject::Number(wanted) => self.answer_number(truth, &wanted),
            QuestionSubject::Place(wanted) => self.answer_presence(view, truth, &[wanted], false),
            QuestionSubject::Other(Some(side)) => describe_view(view, truth, Some(side)),
            QuestionSubject::Other(None) if wants_all(question) => describe_view(view, truth, None),
            QuestionSubject::Other(None) => not_sure(),
        })
    }

    /// "Yes, on the left.", "No, there is no lamp."; for several things, which of them are there.
    fn answer_presence(&self, view: &View, truth: &GroundTruth, wanted: &[QuestionThing], or: bool) -> AnswerText {
        let found: Vec<(&QuestionThing, Option<&ObjectLabel>)> =
            wanted.iter().map(|wanted| (wanted, find_label(view, truth, wanted))).collect();
        if let [(wanted, label)] = found.as_slice() {
            return match label {
                Some(label) => format!("Yes, {}.", place_phrase(third_of_view(view, label))),
                None if self.is_open(truth, wanted) => not_sure(),
                None => denial_answer(&wanted.phrase, wanted.several),
            };
        }
        let there: Vec<String> = found
            .iter()
            .filter_map(|(wanted, label)| {
                Some(format!("{} {}", with_article(&wanted.name), place_phrase(third_of_view(view, (*label)?))))
            })
            .collect();
        let absent = found.iter().filter(|(_, label)| label.is_none());
        let (open, missing): (Vec<_>, Vec<_>) = absent.partition(|(wanted, _)| self.is_open(truth, wanted));
        let missing: Vec<&str> = missing.iter().map(|(wanted, _)| wanted.phrase.as_str()).collect();
        match (there.as_slice(), missing.as_slice()) {
            ([], []) if !open.is_empty() => not_sure(),
            ([], missing) => denial_answer(&missing.join(" or "), false),
            (there, []) => format!("Yes, there is {}.", there.join(" and ")),
            (there, missing) => {
                let begin = if or { "Yes" } else { "No" };
                format!("{begin}, there is {}. There is no {}.", there.join(" and "), missing.join(" or "))
            }
        }
    }

    /// Whether the labels leave open that the thing is there. They do not if they contain one of another colour or in
    /// another part of the view.
    fn is_open(&self, truth: &GroundTruth, wanted: &QuestionThing) -> bool {
        let is_listed = truth.labels.iter().any(|label| names_agree(&label.name, &wanted.name));
        if self.list_everything || is_listed {
            return false;
        }
        let calibrated = self.calibration.as_ref().and_then(|calibration| calibration.leaves_open(&wanted.name));
        let is_expected = || truth.room.as_deref().is_some_and(|room| is_expected(&wanted.name, room));
        calibrated.unwrap_or_else(is_expected)
    }

    /// "There are two lamps."
    fn answer_number(&self, truth: &GroundTruth, wanted: &QuestionThing) -> AnswerText {
        match truth.labels.iter().filter(|label| names_agree(&label.name, &wanted.name)).count() {
            0 if self.is_open(truth, wanted) => not_sure(),
            0 => format!("There are no {}.", to_plural(&wanted.name)),
            count => format!("There {} {}.", if count > 1 { "are" } else { "is" }, counted_name(count, &wanted.name)),
        }
    }
}

/// Whether a question asks for everything in the view.
fn wants_all(question: &str) -> bool {
    let asked = question.to_lowercase();
    ["describe", "objects", "what do you see", "what can you see", "what is there"]
        .iter()
        .any(|all| asked.contains(all))
}

fn not_sure() -> AnswerText {
    "I am not sure.".to_owned()
}

fn place_phrase(third: ViewThird) -> &'static str {
    match third {
        ViewThird::Left => "on the left",
        ViewThird::Middle => "in the middle",
        ViewThird::Right => "on the right",
    }
}

/// "There is a bed in the middle, two lamps on the left and a chair on the right."
fn describe_view(view: &View, truth: &GroundTruth, only: Option<ViewThird>) -> AnswerText {
    // Objects of one name and place: name, place, distance of the nearest in metres, how many.
    let mut groups: Vec<(&str, ViewThird, f64, usize)> = Vec::new();
    for label in &truth.labels {
        let (third, distance_m) = (third_of_view(view, label), label.distance_m.unwrap_or(f64::INFINITY));
        if only.is_some_and(|only| only != third) {
            continue;
        }
        match groups.iter_mut().find(|(name, at, ..)| *name == label.name && *at == third) {
            Some(group) => (group.2, group.3) = (group.2.min(distance_m), group.3 + 1),
            None => groups.push((&label.name, third, distance_m, 1)),
        }
    }
    groups.sort_by(|a, b| a.2.total_cmp(&b.2));
    let items: Vec<String> = groups
        .iter()
        .take(MAX_NAMED_GROUPS)
        .map(|(name, third, _, count)| format!("{} {}", counted_name(*count, name), place_phrase(*third)))
        .collect();
    let verb = if groups.first().is_some_and(|group| group.3 > 1) { "are" } else { "is" };
    match items.as_slice() {
        [] => "I see nothing of note.".to_owned(),
        [only] => format!("There {verb} {only}."),
        [before @ .., last] => format!("There {verb} {} and {last}.", before.join(", ")),
    }
}

/// "No, there is no lamp."
fn denial_answer(said: &str, several: bool) -> AnswerText {
    format!("No, there {} no {said}.", if several { "are" } else { "is" })
}

/// The label that a question asks for, of the colour and in the part of the view that it names.
fn find_label<'a>(view: &View, truth: &'a GroundTruth, wanted: &QuestionThing) -> Option<&'a ObjectLabel> {
    let has_colour = |label: &ObjectLabel| wanted.colour.is_none() || label.colour == wanted.colour;
    let is_there = |label: &ObjectLabel| wanted.place.is_none_or(|place| place == third_of_view(view, label));
    truth.labels.iter().find(|label| names_agree(&label.name, &wanted.name) && has_colour(label) && is_there(label))
}

/// The answer to "Is this a kitchen?" where `room` is the room of the label.
fn is_room(room: &str, name: &str) -> AnswerText {
    if same_room(room, name) { "Yes.".to_owned() } else { format!("No, it is {}.", with_article(room)) }
}

/// "The sofa is red.", or "I am not sure." where no label of that name has a colour.
fn answer_colour(truth: &GroundTruth, name: &str) -> AnswerText {
    let label = truth.labels.iter().find(|label| normalise_name(&label.name) == normalise_name(name));
    label.and_then(|label| label.colour.as_ref()).map_or_else(not_sure, |colour| format!("The {name} is {colour}."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, Heading, ObjectId, Pose};

    fn view() -> View {
        let label = |id: &str, name: &str, deg: f64, colour: Option<&str>| ObjectLabel {
            object: ObjectId::new(id).unwrap(),
            name: name.into(),
            heading: Heading::new(deg.to_radians()).unwrap(),
            elevation_rad: 0.0,
            box_px: None,
            distance_m: Some(deg.abs()),
            position: None,
            colour: colour.map(str::to_owned),
            room: None,
        };
        let labels = vec![
            label("1", "sofa", 0.0, Some("green")),
            label("2", "lamp", -30.0, None),
            label("3", "lamp", -35.0, None),
            label("4", "oven", 35.0, None),
        ];
        let truth = GroundTruth { labels, lists_objects: true, room: Some("office".into()) };
        View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), std::f64::consts::FRAC_PI_2, None, Some(truth))
    }

    fn ask(question: &str) -> String {
        let view = view();
        LabelAnswerer::default()
            .answer_questions(&[ViewQuestion { view: &view, question, history: &[], answer: AnswerForm::Words }])
            .remove(0)
            .unwrap()
    }

    #[test]
    fn labels_affirm_and_deny() {
        assert_eq!(
            ask(crate::dialogue::OPENING_REQUEST),
            "There is a sofa in the middle, two lamps on the left and an oven on the right."
        );
        assert_eq!(ask("Which room is this?"), "It is an office.");
        assert_eq!(ask("Is there a couch?"), "Yes, in the middle.");
        assert_eq!(ask("Is there a mirror?"), "No, there is no mirror.");
        assert_eq!(ask("What colour is the sofa?"), "The sofa is green.");
        assert_eq!(ask("What colour is the oven?"), "I am not sure.");
    }

    #[test]
    fn free_questions_are_answered_too() {
        for (question, answer) in [
            ("Do you see a lamp?", "Yes, on the left."),
            ("Are there any chairs in the room?", "No, there are no chairs."),
            ("Is there really an oven?", "Yes, on the right."),
            ("Is there a red sofa?", "No, there is no red sofa."),
            ("Is there a lamp on the right?", "No, there is no lamp."),
            ("Is there a lamp or a mirror?", "Yes, there is a lamp on the left. There is no mirror."),
            ("Do you see a mirror or a bed?", "No, there is no mirror or bed."),
            ("What kind of room is this?", "It is an office."),
            ("Is this a kitchen?", "No, it is an office."),
            ("How many lamps are there?", "There are two lamps."),
            ("Where is the oven?", "Yes, on the right."),
            ("What is on the left side of the room?", "There are two lamps on the left."),
            ("Is there a door leading to the living room?", "No, there is no door."),
            ("What is the weather like?", "I am not sure."),
        ] {
            assert_eq!(ask(question), answer, "{question}");
        }
    }

    #[test]
    fn labels_leave_usual_things_of_a_room_open() {
        let known = view();
        let mut truth = known.ground_truth().unwrap().clone();
        truth.room = Some("dining room".into());
        let view = View::new(known.pose, known.horizontal_fov_rad, None, Some(truth));
        let ask = |question: &str| {
            LabelAnswerer::default()
                .answer_questions(&[ViewQuestion { view: &view, question, history: &[], answer: AnswerForm::Words }])
                .remove(0)
                .unwrap()
        };
        assert_eq!(ask("Is there a dining table?"), "I am not sure.");
        assert_eq!(ask("How many dining tables are there?"), "I am not sure.");
        assert_eq!(ask("Is there a dining table or a lamp?"), "Yes, there is a lamp on the left.");
        assert_eq!(ask("Is there a toilet?"), "No, there is no toilet.");
        assert_eq!(ask("Is there a mirror?"), "No, there is no mirror.");
    }

    #[test]
    fn complete_labels_deny_unlisted_things() {
        let known = view();
        let mut truth = known.ground_truth().unwrap().clone();
        truth.room = Some("dining room".into());
        let view = View::new(known.pose, known.horizontal_fov_rad, None, Some(truth));
        let question = "Is there a dining table?";
        let answer = |labels: LabelAnswerer| {
            labels
                .answer_questions(&[ViewQuestion { view: &view, question, history: &[], answer: AnswerForm::Words }])
                .remove(0)
                .unwrap()
        };
        assert_eq!(
            answer(LabelAnswerer { list_everything: true, ..LabelAnswerer::default() }),
            "No, there is no dining table."
        );
        let calibrated = |close: &str| {
            let head = "platform = \"matterport\"\nfrom = \"a.json\"\ntexts = 1\n[names.\"dining table\"]\n";
            let calibration: Calibration =
                toml::from_str(&format!("{head}close = {close}\nfar = 0.0\nnowhere = 0.0")).unwrap();
            answer(LabelAnswerer { calibration: Some(Arc::new(calibration)), ..LabelAnswerer::default() })
        };
        assert_eq!(calibrated("2.0"), "No, there is no dining table.");
        assert_eq!(calibrated("0.1"), "I am not sure.", "a small offset decides nothing");
        let offices = ["-2.0", "0.0"].map(calibrated);
        assert_eq!(offices, ["I am not sure.", "I am not sure."]);
    }

    #[test]
    fn a_view_without_labels_is_an_error() {
        let blind = View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.0, None, None);
        let error = LabelAnswerer::default()
            .answer_questions(&[ViewQuestion {
                view: &blind,
                question: "Which room is this?",
                history: &[],
                answer: AnswerForm::Words,
            }])
            .remove(0);
        let message = error.unwrap_err().to_string();
        assert!(message.starts_with("--see labels needs labels, but this view has none: name a model"));
    }
}
