//! Tests of the packs, on sentences of our own.

use super::*;
use crate::reading::{EventContent, PlaceMention, PlaceOrdinal, ReadWord, TextEvent, TextReading, read_instruction};
use proptest::prelude::*;
use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, Side};

fn gloss(text: &str) -> String {
    gloss_text(text).unwrap().text().to_owned()
}

fn read(text: &str) -> TextReading {
    read_instruction(&gloss(text), &BTreeSet::new())
}

/// Turns and climbs of a text, in order.
fn moves(text: &str) -> Vec<&'static str> {
    let word = |what| match what {
        EventContent::Turn(Side::Left) => Some("left"),
        EventContent::Turn(Side::Right) => Some("right"),
        EventContent::Turn(Side::Behind) => Some("around"),
        EventContent::Climb(ClimbDirection::Up) | EventContent::Steps(ClimbDirection::Up) => Some("up"),
        EventContent::Climb(ClimbDirection::Down) | EventContent::Steps(ClimbDirection::Down) => Some("down"),
        _ => None,
    };
    read(text).into_claims().events.into_iter().filter_map(|event| word(event.what)).collect()
}

fn places(text: &str) -> Vec<PlaceMention> {
    let place = |what| if let EventContent::Place(place) = what { Some(place) } else { None };
    read(text).events.into_iter().filter_map(|event| place(event.what)).collect()
}

fn names(text: &str) -> Vec<String> {
    places(text).into_iter().map(|place| place.name).collect()
}

#[test]
fn every_rule_of_every_pack_is_read() {
    for files in &PACKS {
        assert!(rules::parse_stages(files.rules).is_ok_and(|stages| stages.len() > 1), "{}", files.language);
    }
}

#[test]
fn every_row_of_words_has_its_columns() {
    for files in &PACKS {
        for line in crate::data::content_lines(files.words) {
            let columns: Vec<&str> = line.split('|').map(str::trim).collect();
            assert!(
                columns.len() == 3 && columns.iter().all(|column| !column.is_empty()),
                "{}: {line}",
                files.language
            );
            assert!(files.is_spaced || !columns[2].contains(','), "{line}");
        }
    }
}

#[test]
fn the_classes_of_rules_are_those_of_words_or_of_rules() {
    for files in &PACKS {
        let content = |file: &'static str| crate::data::content_lines(file);
        let mut known: BTreeSet<&str> = content(files.words).filter_map(|line| line.split('|').next()).collect();
        known.extend(["unknown"]);
        known.extend(content(files.rules).filter_map(|line| Some(line.split_once(" = ")?.0)));
        known.extend(
            content(files.rules).filter(|line| line.contains("->")).filter_map(|line| Some(line.split_once(':')?.0)),
        );
        let members = content(files.rules)
            .filter_map(|line| Some(line.split_once(" = ")?.1))
            .flat_map(|members| members.split('|'));
        for member in members {
            assert!(known.contains(member), "{}: {member}", files.language);
        }
        for line in content(files.rules).filter(|line| line.contains("->")) {
            let pattern = line.split_once(':').unwrap().1.split_once("->").unwrap().0;
            for class in
                pattern.split(|c: char| c.is_whitespace() || "|?*+".contains(c)).filter(|class| !class.is_empty())
            {
                assert!(known.contains(class), "{}: {class} in {line}", files.language);
            }
        }
    }
}

#[test]
fn chinese_moves_are_read_in_order() {
    for (text, expected) in [
        ("向左转，走到沙发旁边停下。", &["left"][..]),
        ("走出卧室右转直走，上楼梯后左拐。", &["right", "up", "left"]),
        // Towards "ahead on the right" is no turn: people say it of ways that hardly bend.
        ("下楼梯，上完台阶后向右前方走。", &["down"]),
        ("转身走到门口，往右手边走。", &["around", "right"]),
        ("在第二个门口略微向左转然后下台阶", &["left", "down"]),
        ("经过左边的椅子一直走到走廊尽头", &[]),
        ("不要左转，沿着楼梯向上走。", &["up"]),
        ("往床的方向左拐", &["left"]),
    ] {
        assert_eq!(moves(text), expected, "{text}: {}", gloss(text));
    }
}

#[test]
fn chinese_names_are_the_english_ones() {
    assert_eq!(names("走到沙发旁边停下。"), ["sofa"]);
    assert_eq!(names("走出卫生间，经过茶几，停在冰箱前。"), ["bathroom", "coffee table", "refrigerator"]);
    assert_eq!(names("进入卧室左转走到床头柜前面"), ["bedroom", "nightstand"]);
    let chair = &places("经过右手边的第二把红色椅子")[0];
    assert_eq!(
        (chair.name.as_str(), chair.side, chair.ordinal),
        ("chair", Some(Side::Right), Some(PlaceOrdinal::Number(2)))
    );
    assert_eq!(chair.colour.as_deref(), Some("red"));
    assert_eq!(places("走到两张桌子前")[0].count, Some(2));
}

#[test]
fn a_chinese_text_is_understood_whole() {
    for text in [
        "面对镜子，向右转，沿着走廊直走到尽头，进入左边的房间停在床尾。",
        "往楼梯口方向直走，上楼梯，到第一个门口右转进入书房，停在办公桌旁边。",
        "穿过餐厅，从厨房门口出去，绕过圆桌停在落地窗前。",
    ] {
        let reading = read(text);
        let known = |span: [usize; 2]| gloss(text)[span[0]..span[1]].to_owned();
        let unread: Vec<String> =
            reading.words.iter().filter(|word| !word.is_understood()).map(|word| known(word.span)).collect();
        assert!(
            unread.is_empty() && reading.clauses.iter().all(|clause| clause.understood),
            "{text}: {} {unread:?}",
            gloss(text)
        );
        assert!(reading.language.is_english());
    }
}

#[test]
fn what_is_not_there_is_not_claimed() {
    let claims = read("房间里没有沙发，左转。").into_claims();
    let is_sofa = |event: &TextEvent| matches!(&event.what, EventContent::Place(place) if place.name == "sofa");
    assert!(!claims.events.iter().any(is_sofa), "{}", gloss("房间里没有沙发，左转。"));
    assert!(read("这不是厨房。").clauses.iter().any(|clause| !clause.understood));
}

#[test]
fn numbers_in_digits_are_whole() {
    assert!(gloss("往前走12米").contains("12"), "{}", gloss("往前走12米"));
    assert!(gloss("走2.5米后停下").contains("2.5"), "{}", gloss("走2.5米后停下"));
    assert!(!gloss("走到第12个门").contains("first"), "{}", gloss("走到第12个门"));
    assert!(!names("往上走一层，右转").iter().any(|name| name.contains("floor")));
}

#[test]
fn what_no_list_has_stays_unknown() {
    let reading = read("走到魑魅前停下");
    assert!(reading.words.iter().any(|word| !word.is_understood()), "{}", gloss("走到魑魅前停下"));
}

#[test]
fn byte_ranges_of_the_gloss_lead_back_to_the_text() {
    let text = "走到沙发旁边，左转。";
    let glossed = gloss_text(text).unwrap();
    let source = |words: &str| {
        let from = glossed.text().find(words).unwrap();
        let [from, to] = glossed.source_span([from, from + words.len()]);
        &text[from..to]
    };
    assert_eq!(source("sofa"), "沙发");
    assert_eq!(source("turn left"), "左转");
    assert_eq!(source("walk to the sofa"), "走到沙发旁边");
}

#[test]
fn words_of_the_text_are_understood_where_their_english_words_are() {
    let text = "走到魑魅旁边停下";
    let readable = ReadableText::new(text, None);
    let reading = read_instruction(readable.english(), &BTreeSet::new());
    let unknown = |word: &ReadWord| !word.is_understood();
    let words = readable.source_words(&reading.words);
    let lost: Vec<&str> =
        words.iter().filter(|word| unknown(word)).map(|word| &text[word.span[0]..word.span[1]]).collect();
    assert_eq!(lost, ["魑", "魅"]);
    assert!(words.iter().any(|word| &text[word.span[0]..word.span[1]] == "停下"));
    let english = ReadableText::new("Stop at the zorble.", None);
    let reading = read_instruction(english.english(), &BTreeSet::new());
    assert_eq!(english.source_words(&reading.words), reading.words);
}

/// What a sentence tells, in its order: moves, and places with their numbers and sides.
fn told(text: &str) -> String {
    let word = |event: TextEvent| match event.what {
        EventContent::Place(place) => {
            let ordinal = match place.ordinal {
                Some(PlaceOrdinal::Number(number)) => ["", "first ", "second ", "third "].get(number as usize).copied(),
                Some(PlaceOrdinal::Last) => Some("last "),
                _ => None,
            };
            let count = place.count.map_or("", |count| {
                if count == 2 {
                    "two "
                } else if count == 4 {
                    "four "
                } else {
                    ""
                }
            });
            let side = place.side.map_or(String::new(), |side| format!(":{side:?}").to_lowercase());
            Some(format!("{}{count}{}{side}", ordinal.unwrap_or_default(), place.name))
        }
        EventContent::Turn(Side::Left) => Some("left".to_owned()),
        EventContent::Turn(Side::Right) => Some("right".to_owned()),
        EventContent::Turn(Side::Behind) => Some("around".to_owned()),
        EventContent::Climb(climb) | EventContent::Steps(climb) => Some(format!("{climb:?}").to_lowercase()),
        _ => None,
    };
    let events = read(text).into_claims().events.into_iter();
    events.filter_map(word).filter(|word| word != "stair").collect::<Vec<_>>().join(" ")
}

#[test]
fn hindi_sentences_are_read() {
    let mut wrong = Vec::new();
    for line in include_str!("hi/sentences.jsonl").lines() {
        let value =
            |field: &str| line.split_once(&format!("\"{field}\": \"")).unwrap().1.split_once('"').unwrap().0.to_owned();
        let (text, expected) = (value("instruction"), value("told"));
        let sorted = |told: &str| {
            let mut words: Vec<String> = told.replace("stairs", "").split_whitespace().map(str::to_owned).collect();
            words.sort_unstable();
            words
        };
        if sorted(&told(&text)) != sorted(&expected) {
            wrong.push(format!("{text}: {} | {} | {expected}", gloss(&text), told(&text)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn only_hindi_is_an_experiment() {
    let language = |text: &'static str| ReadableText::new(text, None).experimental_language();
    assert_eq!(language("बाएँ मुड़ें।"), Some("Hindi"));
    assert_eq!(language("走到门口左转。"), None);
    assert_eq!(language("Turn left."), None);
}

#[test]
fn dots_below_letters_may_be_missing_or_built_in() {
    for text in ["बाएँ मुड\u{93C}ें", "बाएँ मुडें", "बाएँ मु\u{95C}ें"]
    {
        assert_eq!(moves(text), ["left"], "{text}");
    }
}

#[test]
fn english_and_what_has_no_pack_is_not_glossed() {
    for text in ["Turn left at the sofa.", "Gehen Sie nach links.", "తలుపు గుండా వెళ్ళి ఎడమ వైపు తిరగండి.", ""]
    {
        assert!(gloss_text(text).is_none() && !ReadableText::new(text, None).is_glossed(), "{text}");
    }
}

proptest! {
    #[test]
    fn any_text_is_glossed_with_places_in_it(text in "[走到的左右转沙发门口停下，。前旁第一个楼梯上下往方向x 1]{3,60}|[\\u{900}-\\u{97F} ]{3,40}") {
        let Some(glossed) = gloss_text(&text) else { return Ok(()) };
        for token in crate::text::split_tokens(glossed.text()) {
            let [from, to] = glossed.source_span(token.span);
            prop_assert!(text.get(from..to).is_some());
        }
    }
}
