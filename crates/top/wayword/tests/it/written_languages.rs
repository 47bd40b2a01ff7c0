//! Texts for a path in several languages say the same, and texts in Chinese are whole.
//!
//! The counter below reads both languages by its own lists. It shares no code with the writer, the plan, or the reader of texts.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use std::collections::BTreeMap;
use wayword_formats::jsonl::{self, InstructionRecord};

/// What rooms and things are called, in English and in Chinese. "The room" and doors are no names.
const NAMES: &[(&str, &str)] = &[
    ("hallway, hall, corridor", "走廊, 过道, 通道"),
    ("bedroom", "卧室"),
    ("bathroom", "卫生间, 浴室, 洗手间"),
    ("kitchen", "厨房"),
    ("dining room, dining area", "餐厅"),
    ("living room, living area, sitting room", "客厅"),
    ("entryway, entry way, foyer", "玄关, 大厅, 门厅"),
    ("laundry room", "洗衣房"),
    ("office, study", "书房, 办公室"),
    ("closet", "衣帽间"),
    ("garage", "车库"),
    ("arch, archway", "拱门, 拱"),
    ("armchair", "沙发椅"),
    ("basket, laundry basket", "篮子"),
    ("bathtub, tub", "浴缸"),
    ("bed", "床"),
    ("bench", "长椅"),
    ("bicycle, bike", "自行车"),
    ("bookshelf, bookcase", "书架, 书柜"),
    ("box, cardboard box", "箱子"),
    ("bulletin board, board", "公告板"),
    ("cabinet, sideboard, credenza", "柜子, 橱柜, 餐边柜"),
    ("car", "车"),
    ("chair", "椅子"),
    ("chandelier", "吊灯"),
    ("coat hook", "挂钩"),
    ("coat rack", "衣帽架"),
    ("coffee table", "茶几"),
    ("column, pillar", "柱子"),
    ("console table, console", "玄关桌"),
    ("counter, countertop, counter top, kitchen counter", "台面"),
    ("curtain", "窗帘"),
    ("desk", "办公桌, 书桌"),
    ("dining chair", "餐椅"),
    ("dining table", "餐桌"),
    ("dresser", "抽屉柜"),
    ("dryer", "烘干机"),
    ("fireplace", "壁炉"),
    ("floor lamp", "落地灯"),
    ("grandfather clock", "落地钟"),
    ("ironing board", "熨衣板"),
    ("kitchen island, island", "岛台"),
    ("lamp, table lamp", "台灯, 灯"),
    ("laundry sink, sink", "洗手池, 水池"),
    ("mirror", "镜子"),
    ("nightstand", "床头柜"),
    ("office chair", "办公椅"),
    ("oven", "烤箱"),
    ("painting, picture", "壁画, 油画, 画"),
    ("plant, potted plant", "盆栽, 绿植"),
    ("radiator", "暖气片"),
    ("refrigerator, fridge", "冰箱"),
    ("rug, carpet, doormat, bath mat", "地毯"),
    ("shelf", "架子"),
    ("shoe rack", "鞋架"),
    ("shower", "淋浴间, 淋浴"),
    ("sofa, couch", "沙发"),
    ("stove", "灶台"),
    ("suitcase", "行李箱"),
    ("table, round table", "桌子"),
    ("tapestry", "挂毯"),
    ("toilet", "马桶"),
    ("tool rack", "工具架"),
    ("towel rack", "毛巾架"),
    ("trash can, bin", "垃圾桶"),
    ("tv, television", "电视机, 电视"),
    ("vase", "花瓶"),
    ("wardrobe", "衣柜"),
    ("washing machine", "洗衣机"),
    ("window", "窗户"),
    ("workbench", "工具台"),
];

/// The words for sides, and for turning around.
const SIDES: [(&str, &str); 3] = [("left", "左"), ("right", "右"), ("around", "转身, 向后转, 掉头")];

/// The words for climbs.
const CLIMBS: [(&str, &str); 2] = [
    (
        "upstairs, up the stairs, up the steps, up the staircase, climb the stairs, ascend the stairs, up the stairway",
        "上楼, 上台阶, 楼梯往上走",
    ),
    (
        "downstairs, down the stairs, down the steps, down the staircase, descend the stairs, down the stairway",
        "下楼, 下台阶, 楼梯往下走",
    ),
];

/// What a text says: its sides, its climbs, and its rooms and things, each in order.
#[derive(Debug, PartialEq)]
struct Said {
    sides: Vec<usize>,
    climbs: Vec<usize>,
    names: Vec<usize>,
}

/// The phrases of one language with what they mean, the longest first.
fn phrases(rows: &[(&str, &str)], of: fn(&(&str, &str)) -> String) -> Vec<(String, usize)> {
    let rows = rows.iter().enumerate();
    let all =
        rows.flat_map(|(row, names)| of(names).split(", ").map(|name| (name.to_owned(), row)).collect::<Vec<_>>());
    let mut all: Vec<(String, usize)> = all.collect();
    all.sort_by_key(|(name, _)| std::cmp::Reverse(name.chars().count()));
    all
}

/// What the phrases of a text mean, in order; at each place the longest counts.
fn scan(text: &str, phrases: &[(String, usize)]) -> Vec<usize> {
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some(letter) = rest.chars().next() {
        let known = phrases.iter().find(|(phrase, _)| rest.starts_with(phrase.as_str()));
        found.extend(known.map(|(_, row)| *row));
        rest = &rest[known.map_or(letter.len_utf8(), |(phrase, _)| phrase.len())..];
    }
    found
}

/// An English text with a blank before and behind each word, and plurals with an "s" as their singular.
fn plain_words(text: &str) -> String {
    let words = text.to_lowercase();
    let words = words.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let single = |word: &str| match word {
        "bookshelves" => "bookshelf".to_owned(),
        "boxes" => "box".to_owned(),
        "couches" => "couch".to_owned(),
        "benches" => "bench".to_owned(),
        "upstairs" | "downstairs" | "stairs" | "steps" => word.to_owned(),
        word => word.strip_suffix('s').filter(|word| word.len() > 2).unwrap_or(word).to_owned(),
    };
    words.map(|word| format!(" {} ", single(word))).collect()
}

fn said_in_english(text: &str) -> Said {
    let text = plain_words(text);
    let own = |rows: &[(&str, &str)]| -> Vec<(String, usize)> {
        let all = phrases(rows, |names| names.0.to_owned()).into_iter();
        all.map(|(name, row)| (format!(" {} ", name.replace(' ', "  ")), row)).collect()
    };
    Said { sides: scan(&text, &own(&SIDES)), climbs: scan(&text, &own(&CLIMBS)), names: scan(&text, &own(NAMES)) }
}

fn said_in_chinese(text: &str) -> Said {
    let own = |rows: &[(&str, &str)]| phrases(rows, |names| names.1.to_owned());
    Said { sides: scan(text, &own(&SIDES)), climbs: scan(text, &own(&CLIMBS)), names: scan(text, &own(NAMES)) }
}

/// The texts of a run, by path and style.
fn texts(building: &Building, run: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut texts: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    let records: Vec<InstructionRecord> =
        jsonl::read_records(&building.path(&format!("{run}/instructions.jsonl"))).unwrap();
    for record in records {
        texts.entry(record.path.id).or_default().insert(record.instruction.style, record.instruction.text);
    }
    texts
}

fn generate(building: &Building, args: &[&str]) -> Ran {
    building.wayword(&[&["generate", "--no-pictures", "--no-route", "--candidates", "1"], args].concat())
}

#[test]
fn the_texts_of_200_walks_say_the_same_in_english_and_in_chinese() {
    let building = Building::new();
    let ran = generate(&building, &["--paths", "210", "--style", "r2r", "--language", "en,zh", "--out", "both"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.err);
    let texts = texts(&building, "both");
    let pairs: Vec<(&str, &str)> =
        texts.values().filter_map(|texts| Some((texts.get("r2r")?.as_str(), texts.get("r2r-zh")?.as_str()))).collect();
    // A few texts of either language fail their checks.
    assert!(pairs.len() >= 200, "only {} walks have both texts", pairs.len());
    let differs = |pair: &&(&str, &str)| said_in_english(pair.0) != said_in_chinese(pair.1);
    let differing: Vec<&(&str, &str)> = pairs.iter().filter(differs).collect();
    assert!(differing.is_empty(), "{differing:#?}");
    let rich = pairs.iter().filter(|(english, _)| said_in_english(english).names.len() > 2).count();
    assert!(rich > pairs.len() / 2, "the counter finds too little: {rich}");
}

#[test]
fn the_counter_sees_a_side_a_climb_and_a_name_that_differ() {
    let english = said_in_english("Turn left and go down the stairs. Walk past the sofa.");
    assert_eq!(english, said_in_chinese("左转，下楼梯，经过沙发。"));
    for other in ["右转，下楼梯，经过沙发。", "左转，上楼梯，经过沙发。", "左转，下楼梯，经过床。", "左转，经过沙发。"]
    {
        assert_ne!(english, said_in_chinese(other), "{other}");
    }
    assert_eq!(said_in_english("Walk past the coffee table and the chairs to the kitchen counters.").names.len(), 3);
}

#[test]
fn goals_in_chinese_have_no_latin_letters_and_pass_their_checks() {
    let building = Building::new();
    let ran = generate(&building, &["--paths", "40", "--style", "reverie", "--language", "zh", "--out", "goals"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.err);
    let texts = texts(&building, "goals");
    assert!(texts.len() >= 36, "only {} of 40 goals passed: {}", texts.len(), ran.err);
    for text in texts.values().flat_map(BTreeMap::values) {
        assert!(!text.chars().any(|c| c.is_ascii_alphanumeric() || c == ' '), "{text}");
    }
}
