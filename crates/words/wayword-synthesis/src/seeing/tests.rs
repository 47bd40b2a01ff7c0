use super::*;
use crate::{
    dialogue::{DialogueMode, RulesAsker},
    observe::caption_view,
};
use std::sync::Mutex;
use wayword_core::{AnswerText, DVec3, Heading, Pose, ViewAnswerer, ViewThird, WayOut};

/// An answerer that gives these answers in order and records its questions.
struct Scripted {
    answers: Mutex<Vec<String>>,
    asked: Mutex<Vec<String>>,
}

impl ViewAnswerer for Scripted {
    fn name(&self) -> &str {
        "test/eye"
    }

    fn answer_questions(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<AnswerText, ModelError>> {
        let one = |ask: &ViewQuestion<'_>| {
            self.asked.lock().unwrap().push(ask.question.to_owned());
            Ok(self.answers.lock().unwrap().remove(0))
        };
        asks.iter().map(one).collect()
    }
}

/// The caption that these answers give, and the questions.
fn seen(answers: &[&str], questions: usize) -> (Caption, Vec<String>) {
    let answerer = Scripted {
        answers: Mutex::new(answers.iter().map(|answer| (*answer).to_owned()).collect()),
        asked: Mutex::default(),
    };
    let view = View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.0, None, None);
    let observers = ObservationRoles {
        asker: &RulesAsker::default(),
        answerer: &answerer,
        summariser: &RulesSummariser,
        mode: DialogueMode::Structured { questions },
        prompts_hash: None,
        detector: None,
    };
    let caption = caption_view(&view, observers).unwrap();
    (caption, answerer.asked.into_inner().unwrap())
}

const GOOD: &str = r#"{"room": "living room", "room_sure": "sure",
    "ways_out": [{"kind": "doorway", "side": "right", "leads_to": "kitchen"}, {"kind": "door", "side": "left", "leads_to": "unknown"}],
    "things": [
      {"name": "sofa", "colours": ["dark grey", "white"], "material": "leather", "side": "left", "distance": "near", "sure": "sure"},
      {"name": "armchair or stool", "colours": [], "material": "", "side": "right", "distance": "near", "sure": "sure"},
      {"name": "piano", "colours": ["black"], "material": "", "side": "middle", "distance": "far", "sure": "perhaps"},
      {"name": "wall", "colours": ["white"], "material": "", "side": "middle", "distance": "far", "sure": "sure"},
      {"name": "brick wall", "colours": [], "material": "", "side": "right", "distance": "far", "sure": "sure"},
      {"name": "lamps", "colours": [], "material": "", "side": "middle", "distance": "near", "sure": "sure"}],
    "stands_out": ["brick wall"]}"#;

fn of<'a>(caption: &'a Caption, name: &str) -> &'a ObjectSighting {
    caption.sightings.iter().find(|sighting| sighting.name == name).unwrap_or_else(|| panic!("{name}: {caption:?}"))
}

#[test]
fn an_answer_becomes_evidence_and_a_caption_in_one_call() {
    let (caption, asked) = seen(&[GOOD], 0);
    assert_eq!((asked.len(), caption.form, caption.room.as_deref()), (1, None, Some("living room")));
    let sofa = of(&caption, "sofa");
    assert_eq!((sofa.witness, sofa.place, sofa.is_far), (WitnessAnswer::Seen, Some(ViewThird::Left), false));
    assert_eq!((sofa.colour.as_deref(), sofa.more_colours.as_slice()), (Some("dark grey"), &["white".to_owned()][..]));
    assert_eq!(sofa.material.as_deref(), Some("leather"));
    for doubtful in ["armchair", "stool", "piano"] {
        assert_eq!(of(&caption, doubtful).witness, WitnessAnswer::Unsure, "{doubtful}");
    }
    assert!(of(&caption, "lamp").several);
    let walls = caption.sightings.iter().filter(|sighting| sighting.name == "wall");
    // A plain wall is kept as evidence, although the caption does not name it.
    let of_walls: Vec<_> =
        walls.map(|wall| (wall.material.as_deref(), wall.colour.as_deref(), wall.stands_out)).collect();
    assert_eq!(of_walls, [(None, Some("white"), false), (Some("brick"), None, true)]);
    let kitchen = WayOut { name: "doorway".into(), place: Some(ViewThird::Right), leads_to: Some("kitchen".into()) };
    assert_eq!(caption.ways[0], kitchen);
    assert_eq!(
        caption.text,
        "A living room with a brick wall on the right, a dark grey leather sofa on the left, several lamps in the middle, \
         a doorway on the right and a door on the left. A doorway on the right leads to a kitchen."
    );
    assert_eq!(caption.transcript[0].answer, GOOD);
}

#[test]
fn answers_with_other_names_case_and_types_are_parsed() {
    for answer in [
        format!("Sure! Here is what I see:\n```json\n{GOOD}\n```\nLet me know if you need more."),
        GOOD.replace("\"things\"", "\"Objects\"")
            .replace("\"left\"", "\"LEFT\"")
            .replace("\"sure\": \"sure\"", "\"Sure\": true"),
        GOOD.replace("{\"name\": \"sofa\"", "{\"label\": \"A Sofa\"")
            .replace("\"side\": \"left\"", "\"position\": \"on the far left\""),
        GOOD.replace("[\"dark grey\", \"white\"]", "\"dark grey and white\"").replace("}],\n", "},],\n"),
    ] {
        let (caption, asked) = seen(&[&answer], 0);
        assert_eq!((asked.len(), caption.form), (1, None), "{answer}");
        let sofa = of(&caption, "sofa");
        assert_eq!((sofa.place, sofa.colour.as_deref()), (Some(ViewThird::Left), Some("dark grey")), "{answer}");
    }
}

#[test]
fn patterns_second_colours_pictures_and_certainty_in_numbers_are_kept() {
    let things = r#"{"room": "hall", "things": [
        {"name": "black-and-white checkered tile floor", "sure": "0.9"},
        {"name": "picture of a ship", "detail": "", "sure": "95%"},
        {"name": "rug", "colours": ["red", "blue"], "detail": "striped", "sure": "0.3"},
        {"name": "beige wall", "detail": "none", "sure": 1}]}"#;
    let (caption, _) = seen(&[things], 0);
    let looks = |name: &str| {
        let seen = of(&caption, name);
        (seen.witness, seen.colour.as_deref(), seen.more_colours.join(" "), seen.detail.as_deref())
    };
    let (sure, unsure) = (WitnessAnswer::Seen, WitnessAnswer::Unsure);
    assert_eq!(looks("floor"), (sure, Some("black"), "white".to_owned(), Some("checkered")));
    assert_eq!(looks("picture"), (sure, None, String::new(), Some("of a ship")));
    assert_eq!(looks("rug"), (unsure, Some("red"), "blue".to_owned(), Some("striped")));
    assert_eq!(looks("wall"), (sure, Some("beige"), String::new(), None));
}

#[test]
fn missing_fields_and_bare_names_are_enough() {
    let (caption, _) = seen(&[r#"{"things": ["sofa", "two lamps", 7, null, {"name": ["chair"]}]}"#], 0);
    assert_eq!(caption.room, None);
    let names: Vec<&str> = caption.sightings.iter().map(|sighting| sighting.name.as_str()).collect();
    assert_eq!(names, ["sofa", "lamp", "chair"]);
}

#[test]
fn an_answer_that_breaks_the_form_is_asked_for_once_more() {
    let bad = [
        "There is a sofa on the left.",
        r#"{"things": [1, 2, 3]}"#,
        r#"{"mood": "calm"}"#,
        "{\"room\": \"ha",
        "I'm sorry, I can't help with that.",
        r#"{"room": "卧室", "room_sure": "sure", "things": [{"name": "床", "side": "left", "sure": "sure"}]}"#,
    ];
    for bad in bad {
        let (caption, asked) = seen(&[bad, GOOD], 0);
        assert_eq!((asked.len(), caption.form), (2, Some(FormOutcome::Mended)), "{bad}");
        assert!(complaint_in_question(&asked[1]).is_some_and(|why| !why.is_empty()), "{asked:?}");
        let trouble = if bad.starts_with("I'm sorry") { AnswerTrouble::Refusal } else { AnswerTrouble::Form };
        assert_eq!(caption.transcript[1].trouble, Some(trouble));
        assert_eq!(caption.transcript[0].answer, bad);
    }
}

#[test]
fn an_answer_that_breaks_it_twice_is_read_as_words() {
    let (caption, asked) = seen(&["Hm.", "It is a kitchen with a red table on the left and a fridge."], 0);
    assert_eq!((asked.len(), caption.form, caption.room.as_deref()), (2, Some(FormOutcome::Broken), Some("kitchen")));
    assert_eq!(of(&caption, "table").colour.as_deref(), Some("red"));
    let (refused, _) = seen(&["I'm sorry, I can't assist with that."; 2], 0);
    assert_eq!((refused.form, refused.sightings.len(), refused.room), (Some(FormOutcome::Broken), 0, None));
    assert_eq!(refused.text, "A place.");
}

#[test]
fn an_answer_cut_twice_yields_its_complete_part() {
    let cut = &GOOD[..GOOD.find("\"piano\"").unwrap()];
    let (caption, _) = seen(&[cut, cut], 0);
    assert_eq!((caption.form, caption.room.as_deref()), (Some(FormOutcome::Broken), Some("living room")));
    assert_eq!(of(&caption, "sofa").witness, WitnessAnswer::Seen);
}

#[test]
fn an_answer_of_two_megabytes_is_refused_and_cut_in_the_transcript() {
    let long = format!("{{\"things\": [{}]}}", "\"sofa\", ".repeat(250_000));
    let (caption, asked) = seen(&[&long, &long], 0);
    assert_eq!(caption.form, Some(FormOutcome::Broken));
    assert!(asked[1].contains("bytes, more than"), "{}", asked[1]);
    assert!(caption.transcript.iter().all(|exchange| exchange.answer.len() <= MAX_TRANSCRIPT_ANSWER_BYTES));
    let many =
        format!("{{\"room\": \"hall\", \"things\": [{}]}}", "{\"name\": \"sofa\", \"side\": \"x\"}, ".repeat(900));
    assert!(seen(&[&many, &many], 0).0.sightings.len() <= 24);
}

#[test]
fn open_questions_are_asked_up_to_the_limit() {
    let open = r#"{"room": "unknown", "things": [{"name": "sofa"}, {"name": "piano", "sure": "perhaps"}, {"name": "harp", "sure": "perhaps"}]}"#;
    assert_eq!(seen(&[open], 0).1.len(), 1);
    let (caption, asked) = seen(&[open, "It is a music room.", "Yes, on the left.", "No."], 3);
    assert_eq!(asked[1..], ["Which room is this?", "Is there a piano?", "Is there a harp?"]);
    assert_eq!(caption.room.as_deref(), Some("music room"));
    assert_eq!(of(&caption, "piano").witness, WitnessAnswer::Seen);
    assert_eq!(of(&caption, "harp").witness, WitnessAnswer::Denied);
    assert_eq!(caption.text, "A music room with a sofa and a piano.");
}

#[test]
fn a_refused_question_is_repeated_once_and_then_left_open() {
    let open =
        r#"{"room": "hall", "things": [{"name": "piano", "sure": "perhaps"}, {"name": "harp", "sure": "perhaps"}]}"#;
    let no = "I'm sorry, but I can't help with that.";
    let (caption, asked) = seen(&[open, no, no, "Yes, there is.", no], 3);
    assert_eq!(asked.len(), 5);
    assert!(asked[3].ends_with("Is there a piano?") && asked[3].starts_with("Look again"), "{asked:?}");
    assert_eq!(
        (of(&caption, "piano").witness, of(&caption, "harp").witness),
        (WitnessAnswer::Seen, WitnessAnswer::Unsure)
    );
    let told: Vec<_> = caption.transcript[1..].iter().map(|one| (one.answer.as_str(), one.trouble)).collect();
    assert_eq!(told, [("Yes, there is.", Some(AnswerTrouble::Refusal)), ("", Some(AnswerTrouble::Refusal))]);
}

#[test]
fn doubtful_things_are_named_only_without_certain_ones() {
    let (caption, _) = seen(&[r#"{"room": "kitchen or dining room", "things": [{"name": "possibly a stove"}]}"#], 0);
    assert_eq!((caption.room, caption.perhaps_rooms.len()), (None, 2));
    assert_eq!(caption.text, "A place. It is perhaps a kitchen or a dining room. Perhaps there is a stove.");
}

proptest::proptest! {
    #[test]
    fn no_answer_makes_it_panic(answer in "(\\PC|[\n{}\\[\\]\":,']|\"name\"|\"things\"|room|sofa|\\\\){0,80}") {
        seen(&[&answer, &answer], 0);
    }
}
