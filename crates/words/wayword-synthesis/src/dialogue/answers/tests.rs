//! Answers of models about pictures, and the sightings that are read from them.

use super::*;
use crate::dialogue::OPENING_REQUEST;
use proptest::prelude::*;

fn read_all(pairs: &[(&str, &str)]) -> Vec<ObjectSighting> {
    let transcript: Vec<_> = pairs.iter().map(|(question, answer)| DialogueExchange::new(*question, *answer)).collect();
    dialogue_sightings(&transcript, "test")
}

/// A sighting in short: "+ dark red chair left several", with "-" for denied and "?" for not sure.
fn short(sighting: &ObjectSighting) -> String {
    let sign = match sighting.witness {
        WitnessAnswer::Seen => "+",
        WitnessAnswer::Denied => "-",
        WitnessAnswer::Unsure => "?",
    };
    let place = sighting.place.map(|place| format!("{place:?}").to_lowercase());
    let several = sighting.several.then(|| "several".to_owned());
    let colour = sighting.colour.clone();
    let words = [Some(sign.to_owned()), colour, Some(sighting.name.clone()), place, several];
    words.into_iter().flatten().collect::<Vec<_>>().join(" ")
}

fn told(pairs: &[(&str, &str)]) -> String {
    read_all(pairs).iter().map(short).collect::<Vec<_>>().join(", ")
}

fn check(question: &str, table: &[(&str, &str)]) {
    let wrong: Vec<String> = table
        .iter()
        .map(|(answer, wanted)| (answer, told(&[(question, answer)]), wanted))
        .filter(|(_, told, wanted)| told != *wanted)
        .map(|(answer, told, wanted)| format!("{answer}\n   told {told}\n wanted {wanted}"))
        .collect();
    assert!(wrong.is_empty(), "{question}\n{}", wrong.join("\n"));
}

#[test]
fn a_later_no_outweighs_an_earlier_sighting() {
    let told = read_all(&[
        (OPENING_REQUEST, "I can see a bed and a mirror."),
        ("Is there a mirror?", "No."),
        ("Is there a lamp?", "I am not sure."),
    ]);
    let witness = |name: &str| told.iter().find(|s| s.name == name).unwrap().witness;
    assert_eq!(
        (witness("bed"), witness("mirror"), witness("lamp")),
        (WitnessAnswer::Seen, WitnessAnswer::Denied, WitnessAnswer::Unsure)
    );
}

#[test]
fn colours_join_the_things_they_belong_to() {
    assert_eq!(
        told(&[
            (OPENING_REQUEST, "There is a sofa in the middle."),
            ("What colour is the sofa?", "The sofa is green.")
        ]),
        "+ green sofa middle"
    );
}

#[test]
fn descriptions_are_read_with_colours_places_and_numbers() {
    check(
        OPENING_REQUEST,
        &[
            ("The picture shows a bedroom with a bed and a mirror.", "+ bed, + mirror"),
            ("There is a red sofa on the left and a lamp to the right.", "+ red sofa left, + lamp right"),
            ("On the left side of the room there is a bed with two pillows.", "+ bed left, + pillow left several"),
            ("On the left is a bed, and on the right a lamp.", "+ bed left, + lamp right"),
            ("Three chairs stand around a dining table.", "+ chair several, + dining table"),
            ("There are several plants in the background.", "+ plant middle several"),
            ("The sofa is dark gray. The walls are white.", "+ dark grey sofa"),
            ("A kitchen with stairs leading up.", "+ stairs"),
            ("A photo of a living room with a couch to the left of a fireplace.", "+ couch, + fireplace"),
            ("In the center of the image is a large wooden table.", "+ table middle"),
            ("It has a cozy atmosphere and a modern design.", ""),
            ("There is a disco ball in the middle of the room.", "+ disco ball middle"),
            ("The image depicts a spacious room with plenty of natural light.", ""),
            ("- Bed: in the center\n- Lamp: on the right", "+ bed middle, + lamp right"),
            ("Straight ahead there is a door.", "+ door middle"),
            ("There is a range of colours in shades of blue, and light streaming in.", ""),
            ("The decor is tasteful. There is a painting of a horse above the sofa.", "+ painting, + sofa"),
            ("A picture on the wall hangs above the bed.", "+ picture, + bed"),
            ("", ""),
            ("🛏️🛋️", ""),
        ],
    );
}

#[test]
fn long_descriptions_are_read_to_their_end() {
    check(
        OPENING_REQUEST,
        &[
            (
                "The image depicts a cozy living room with a large, comfortable couch positioned in the center of the room. \
                 The couch is accompanied by two chairs. A coffee table is placed in front of the couch, and a TV is mounted on \
                 the wall. There are also a few potted plants scattered throughout the room, adding a touch of greenery.",
                "+ couch middle, + chair several, + coffee table, + tv, + potted plant several",
            ),
            (
                "The room features a staircase leading up to the second floor, with a black metal railing. To the left, there's \
                 a small console table with a vase on top. To the right, a doorway opens to a kitchen area. There are no other \
                 pieces of furniture visible.",
                "+ staircase, + black railing, + console table left, + vase left, + doorway right",
            ),
            (
                "**Objects:**\n1. **Bed** – A king-size bed with white linens in the center.\n2. **Lamps** – A lamp on each \
                 nightstand.\n3. **Window** – On the right side, with beige curtains.",
                "+ bed middle, + lamp several, + nightstand, + window right, + beige curtain several",
            ),
            (
                "The kitchen has white cabinets, a stainless steel refrigerator on the left, and a black stove. There doesn't \
                 appear to be a dishwasher, though it may be hidden.",
                "+ white cabinet several, + refrigerator left, + black stove, - dishwasher",
            ),
            (
                "A large mirror hangs on the right wall above a brown bench, while a coat rack stands against the left wall.",
                "+ mirror right, + brown bench, + coat rack left",
            ),
            (
                "In the foreground, there is a rug. In the background, a piano can be seen, but no bench.",
                "+ rug, + piano middle, - bench middle",
            ),
            (
                "The bed is unmade and its sheets are blue. The lamp isn't turned on. The TV is off.",
                "+ bed, + blue sheet several, + lamp, + tv",
            ),
        ],
    );
}

#[test]
fn denials_within_descriptions_are_heard() {
    check(
        OPENING_REQUEST,
        &[
            ("There is a bed but no mirror.", "+ bed, - mirror"),
            ("There are no chairs or tables.", "- chair, - table"),
            ("There are no chairs, tables, or lamps, but there is a bed.", "- chair, - table, - lamp, + bed"),
            ("A bedroom without a window.", "- window"),
            ("I don't see any stairs.", "- stairs"),
            ("I do not see a lamp, a mirror or a bed.", "- lamp, - mirror, - bed"),
            ("I cannot see a TV on the wall.", "- tv"),
            ("The mirror is not visible in the picture.", "- mirror"),
            ("A bed and a lamp are not visible.", "- bed, - lamp"),
            ("It isn't a sofa, it is a bed.", "- sofa, + bed"),
            ("That is not a sofa but a bench.", "- sofa, + bench"),
            ("There isn't a lamp.", "- lamp"),
            ("There is no sign of a piano.", "- piano"),
            ("The room does not have a fireplace.", "- fireplace"),
            ("There doesn't appear to be a bathtub.", "- bathtub"),
            ("I don't think there is a clock.", "- clock"),
            ("There is neither a bed nor a sofa.", "- bed, - sofa"),
            ("There is no red chair.", "- red chair"),
            ("There’s no lamp.", "- lamp"),
            ("The room lacks a door.", "- door"),
            ("The lamp is missing.", "- lamp"),
        ],
    );
}

#[test]
fn not_every_no_is_a_denial() {
    check(
        OPENING_REQUEST,
        &[
            ("No doubt there is a lamp.", "+ lamp"),
            ("There is nothing on the table.", "+ table"),
            ("A lamp stands not far from the sofa.", "+ lamp, + sofa"),
            ("There is not only a bed but also a desk.", "+ bed, + desk"),
            ("I don't see anything on the bed.", "+ bed"),
            ("I can't see what is on the shelf.", "+ shelf"),
            ("The lamp is not on the table.", "+ lamp, + table"),
            ("There are no other chairs around the table.", "+ table"),
            ("The bed is not fully visible.", "+ bed"),
            ("The sofa is not very large.", "+ sofa"),
            ("No, there is a lamp.", "+ lamp"),
            ("There is no one on the sofa.", "+ sofa"),
            ("A bed, no more than two chairs.", "+ bed, + chair several"),
        ],
    );
}

#[test]
fn hedged_things_are_unsure_and_appearances_are_seen() {
    check(
        OPENING_REQUEST,
        &[
            ("There might be a lamp on the table.", "? lamp, + table"),
            ("There is possibly a mirror.", "? mirror"),
            ("Maybe a bench.", "? bench"),
            ("It could be a desk.", "? desk"),
            ("There appears to be a piano.", "+ piano"),
            ("It looks like a bathtub.", "+ bathtub"),
            ("There seems to be a stove.", "+ stove"),
            ("I am not sure if there is a lamp.", "? lamp"),
            ("There is a bed. It is unclear whether there is a mirror.", "+ bed, ? mirror"),
            ("There is a dresser or a bench.", "? dresser, ? bench"),
            ("There is a sofa or couch.", "+ sofa"),
        ],
    );
}

#[test]
fn yes_and_no_are_heard_in_all_their_forms() {
    check(
        "Is there a mirror?",
        &[
            ("Yes", "+ mirror"),
            ("yes.", "+ mirror"),
            ("Yes, on the left.", "+ mirror left"),
            ("Yes, there is a large mirror to the right.", "+ mirror right"),
            ("Yes, above the sink.", "+ mirror, + sink"),
            ("There is a round mirror on the wall.", "+ mirror"),
            ("I see one on the left.", "+ mirror left"),
            ("Based on the picture, yes.", "+ mirror"),
            ("Yes, there is one. I am not sure what it is made of.", "+ mirror"),
            ("Yes, there might be a mirror.", "? mirror"),
            ("Actually, no.", "- mirror"),
            ("Unfortunately not.", "- mirror"),
            ("There does not seem to be one.", "- mirror"),
            ("Upon closer inspection, there is no mirror in the picture.", "- mirror"),
            ("I apologize for the confusion. There isn't a mirror; it is a window.", "- mirror, + window"),
            ("It's a window, not a mirror.", "- mirror, + window"),
            ("It doesn't appear that there is a mirror.", "- mirror"),
            ("I can't see any.", "- mirror"),
            ("No", "- mirror"),
            ("no.", "- mirror"),
            ("No, there isn't.", "- mirror"),
            ("No, there is no mirror.", "- mirror"),
            ("No, I don't see one.", "- mirror"),
            ("No, but there is a window.", "- mirror, + window"),
            ("I don't think so.", "- mirror"),
            ("Not that I can see.", "- mirror"),
            ("None.", "- mirror"),
            ("The mirror is not visible.", "- mirror"),
            ("There is no looking glass.", "- mirror"),
            ("I am not sure.", "? mirror"),
            ("Unclear.", "? mirror"),
            ("It is hard to say.", "? mirror"),
            ("Possibly.", "? mirror"),
            ("There might be a mirror.", "? mirror"),
            ("A lamp.", "? mirror, + lamp"),
            ("There is a lamp on the right.", "? mirror, + lamp right"),
            ("I can see a lamp.", "? mirror, + lamp"),
            ("There are two on the left.", "+ mirror left"),
            ("", ""),
        ],
    );
}

#[test]
fn answers_to_all_forms_of_questions_are_read() {
    for (question, answer, wanted) in [
        ("Are there any chairs in the room?", "Yes, there are two chairs on the left.", "+ chair left several"),
        ("Are there any chairs in the room?", "No.", "- chair"),
        ("Do you see a television?", "There is no TV.", "- television"),
        ("Can you see any stairs?", "No, there are no stairs visible.", "- stairs"),
        ("Is the lamp you mentioned really there?", "No, there is no lamp.", "- lamp"),
        ("Is the lamp you mentioned really there?", "Yes, it is.", "+ lamp"),
        ("Does the room have a fireplace?", "It does not.", "- fireplace"),
        ("Is there a bed or a sofa?", "A bed is.", "+ bed"),
        ("Is there a bed or a sofa?", "Yes.", ""),
        ("Is there a bed or a sofa?", "Yes, there is a sofa.", "+ sofa"),
        ("Is there a bed or a sofa?", "No.", "- bed, - sofa"),
        ("Is there a bed or a sofa?", "Yes, both.", "+ bed, + sofa"),
        ("Is there a bed and a sofa?", "Yes.", "+ bed, + sofa"),
        ("Is there a bed and a sofa?", "No.", ""),
        ("Is there a bed and a sofa?", "No, there is a bed but no sofa.", "+ bed, - sofa"),
        ("Is there a red chair?", "Yes.", "+ red chair"),
        ("Is there a red chair?", "No.", "- red chair"),
        ("Is there a red chair?", "There is no chair.", "- chair"),
        ("Is there a gizmo?", "No, there is no gizmo.", "- gizmo"),
        ("Are there any doors or ways out?", "Yes, there is a door on the right side of the room.", "+ door right"),
        ("Are there any windows?", "Yes, there are two windows, both on the left wall.", "+ window left several"),
        ("Do you see any furniture other than the bed?", "Yes, a dresser and a chair.", "+ dresser, + chair"),
        ("Is there anything hanging on the walls?", "Yes, there are several paintings.", "+ painting several"),
        ("What material is the table made of?", "There is no table in the image.", "- table"),
        ("What is next to the bed?", "A nightstand with a lamp on it.", "+ nightstand, + lamp"),
        (
            "Which objects are on the left side?",
            "There is a lamp, a bed and a rug.",
            "+ lamp left, + bed left, + rug left",
        ),
        ("How many chairs are there?", "Three.", "+ chair several"),
        ("How many chairs are there?", "There is one chair.", "+ chair"),
        ("How many chairs are there?", "None.", "- chair"),
        ("Where is the lamp?", "On the right.", "+ lamp right"),
        ("Where is the lamp?", "Left.", "+ lamp left"),
        ("Where is the lamp?", "Right side", "+ lamp right"),
        ("Where is the lamp?", "There is no lamp.", "- lamp"),
        ("Where is the lamp?", "I am not sure.", ""),
        ("What colour is the lamp?", "There is no lamp.", "- lamp"),
        ("What color is the lamp?", "White.", "+ white lamp"),
        ("What color is the lamp?", "The lamp is light gray and stands on the left.", "+ light grey lamp left"),
        ("What color is the lamp?", "It is hard to tell, maybe white.", ""),
        ("Is the sofa brown or black?", "It is black.", "+ black sofa"),
        ("What is on the left?", "A desk and two monitors.", "+ desk left, + monitor left several"),
        ("What is on the table?", "There is nothing on the table.", "+ table"),
        ("What kind of room is this?", "This is a living room with a sofa.", "+ sofa"),
        ("Which room is this?", "It is a bar.", ""),
        ("Is this a kitchen?", "No.", ""),
    ] {
        assert_eq!(told(&[(question, answer)]), wanted, "{question} {answer}");
    }
}

#[test]
fn answers_are_joined_and_any_denial_outweighs() {
    let opening =
        (OPENING_REQUEST, "A room with a sofa, a chair, two dining chairs and a staircase. There might be a piano.");
    for (question, answer, wanted) in [
        (
            "Is there a couch?",
            "No, there is no couch.",
            "- sofa, + chair, + dining chair several, + staircase, ? piano",
        ),
        ("Are there stairs?", "No stairs.", "+ sofa, + chair, + dining chair several, - staircase, ? piano"),
        ("Is there a red chair?", "No.", "+ sofa, + chair, + dining chair several, + staircase, ? piano, - red chair"),
        ("Is there a dining chair?", "No.", "+ sofa, + chair, - dining chair several, + staircase, ? piano"),
        ("Are there any chairs?", "No.", "+ sofa, - chair, - dining chair several, + staircase, ? piano"),
        ("Is there a piano?", "Yes.", "+ sofa, + chair, + dining chair several, + staircase, + piano"),
        ("Is there really a sofa?", "I am not sure.", "? sofa, + chair, + dining chair several, + staircase, ? piano"),
        ("What colour is the couch?", "Red.", "+ red sofa, + chair, + dining chair several, + staircase, ? piano"),
    ] {
        assert_eq!(told(&[opening, (question, answer)]), wanted, "{question} {answer}");
    }
    let yes = ("Is there really a sofa?", "Yes.");
    assert!(told(&[opening, ("Is there a sofa?", "No."), yes, yes]).starts_with("- sofa"));
    assert_eq!(
        told(&[("Is there a chair?", "No."), (OPENING_REQUEST, "There is an armchair.")]),
        "- chair, - armchair"
    );
}

#[test]
fn a_denial_of_one_side_leaves_the_other() {
    assert_eq!(
        told(&[(OPENING_REQUEST, "There is a chair on the right."), ("Is there a chair on the left?", "No.")]),
        "+ chair right"
    );
}

#[test]
fn endless_text_is_read_in_reasonable_time() {
    let long = "There is no chair, a lamp or a table on the left and maybe the sofa is red ".repeat(20_000);
    assert!(read_all(&[(OPENING_REQUEST, &long)]).len() < 20);
}

#[test]
fn rooms_are_found_in_answers_to_the_question_for_them() {
    for (answer, wanted) in [
        ("It is an office.", Some("office")),
        ("It is an unheard chamber.", Some("unheard chamber")),
        ("kitchen", Some("kitchen")),
        ("A bathroom.", Some("bathroom")),
        ("This is a living room with a sofa and a table.", Some("living room")),
        ("The room appears to be a cozy bedroom.", Some("bedroom")),
        ("It's a hallway leading to a kitchen.", Some("hallway")),
        ("It is not a kitchen but a dining room.", Some("dining room")),
        ("Living Room", Some("living room")),
        ("Observatory.", Some("observatory")),
        ("I am not sure.", None),
        ("It is hard to say, it may be an office.", None),
        ("Yes, there is a lamp on the table and it is lit.", None),
        ("", None),
    ] {
        let told = dialogue_room(&[DialogueExchange::new("What kind of room is this?", answer)]);
        assert_eq!(told.as_deref(), wanted, "{answer}");
    }
}

#[test]
fn room_comes_from_the_first_description_without_a_question() {
    for (answer, wanted) in [
        ("The picture shows a bedroom with a bed.", Some("bedroom")),
        ("The image depicts a spacious living room. A doorway leads to a kitchen.", Some("living room")),
        ("A door leads to a bathroom.", None),
        ("There is a closet on the left.", None),
        ("There are stairs and a bar.", None),
    ] {
        assert_eq!(dialogue_room(&[DialogueExchange::new(OPENING_REQUEST, answer)]).as_deref(), wanted, "{answer}");
    }
}

#[test]
fn a_room_that_is_asked_about_is_confirmed_or_corrected() {
    let told = |answer: &str| dialogue_room(&[DialogueExchange::new("Is this a kitchen?", answer)]);
    assert_eq!(told("Yes.").as_deref(), Some("kitchen"));
    assert_eq!(told("No, it is a laundry room.").as_deref(), Some("laundry room"));
    assert_eq!(told("No."), None);
}

proptest! {
    #[test]
    fn any_words_can_be_read(question in "(\\PC|[\n?.,]){0,60}", answer in "(\\PC|[\n?.,]){0,200}") {
        let told = read_all(&[(OPENING_REQUEST, &answer), (&question, &answer)]);
        prop_assert!(told.iter().all(|sighting| !sighting.name.is_empty() && sighting.by == "test"));
    }

    #[test]
    fn words_of_answers_can_come_in_any_order(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "is", "there", "no", "not", "a", "lamp", "bed", ",", ".", "or", "and", "on", "the", "left", "of", "see", "don't",
                "maybe", "any", "chairs", "without", "but", "what", "colour", "red", "room", "kitchen", "?", "isn't", "to", "you",
                "visible", "in", "picture", "unsure", "where", "how", "many", "stairs",
            ]),
            0..14,
        ),
        at in 0_usize..14,
    ) {
        let at = at.min(words.len());
        let (question, answer) = (words[..at].join(" "), words[at..].join(" "));
        read_all(&[(&question, &answer), (&answer, &question)]);
        dialogue_room(&[DialogueExchange::new(question, answer)]);
    }
}

#[test]
fn figures_of_speech_name_no_things() {
    check(
        OPENING_REQUEST,
        &[
            ("There is a bed with a soft, blotchy pattern on the wall.", "+ bed"),
            ("The wall steps forward next to a sofa.", "+ sofa"),
            ("There is a light wooden floor and a lamp.", "+ lamp"),
            ("A grey sofa fills the picture.", "+ grey sofa"),
            ("A sofa fills most of the picture and a lamp stands on the left.", "+ sofa, + lamp left"),
            ("I can see a box. There is nothing besides the box.", "+ box"),
            ("There are no chairs besides the box on the left.", "- chair, + box left"),
        ],
    );
}

#[test]
fn long_noun_phrases_are_read_whole() {
    check(
        OPENING_REQUEST,
        &[
            ("There are two tall grey armchairs on the left.", "+ grey armchair left several"),
            ("The large flat-screen television on the wall is off.", "+ television"),
            ("I see a row of kitchen cabinets on the right.", "+ kitchen cabinet right several"),
            ("Two tall grey armchairs and a low round table.", "+ grey armchair several, + round table"),
        ],
    );
}

#[test]
fn the_room_is_the_one_that_one_stands_in() {
    let room_of = |question: &str, answer: &str| dialogue_room(&[DialogueExchange::new(question, answer)]);
    for (answer, wanted) in [
        ("A hallway leading to a kitchen.", Some("hallway")),
        ("Through the doorway a bedroom can be seen.", None),
        ("Through the doorway a bedroom can be seen. This is a hallway.", Some("hallway")),
        ("I see a kitchen through the open door, and a sofa.", None),
        ("A living room with a view into the kitchen.", Some("living room")),
        ("This is a hallway, with a bathroom visible beyond the door.", Some("hallway")),
    ] {
        for question in [OPENING_REQUEST, "Which room is this?"] {
            assert_eq!(room_of(question, answer).as_deref(), wanted, "{question} {answer}");
        }
    }
}
