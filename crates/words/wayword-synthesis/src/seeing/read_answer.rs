//! Parses a structured answer (the JSON about a view) leniently: models use other field names, other types and another
//! case than the schema.

use super::names::{MAX_DETAIL_WORDS, NameReading, read_name, read_rooms};
use crate::dialogue::colour_at;
use serde_json::{Map, Value};
use wayword_core::{ViewThird, WayOut};
use wayword_language::{
    answers::MATERIALS,
    lexicon::{ThingClass, find_thing, names_agree},
};
use wayword_replies::{ObjectReading, find_object};

/// Most things that are taken from one answer; further ones are ignored.
const MAX_THINGS: usize = 24;
/// Most ways out that are taken; further ones are ignored.
const MAX_WAYS_OUT: usize = 8;
/// Most words of a text that are searched for colours; later words are ignored.
const MAX_COLOUR_WORDS: usize = 12;

/// Names that models give to the field of the room, and to that of the things.
const ROOM_FIELDS: [&str; 4] = ["room", "roomtype", "location", "scene"];
const THINGS_FIELDS: [&str; 4] = ["things", "objects", "items", "thing"];

/// The content of a structured answer about a view.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ViewReading {
    /// The rooms that it may be; one if the model is sure.
    pub(super) rooms: Vec<String>,
    pub(super) room_is_sure: bool,
    pub(super) ways: Vec<WayOut>,
    pub(super) things: Vec<ViewThing>,
}

/// A thing in a structured answer.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ViewThing {
    pub(super) reading: NameReading,
    pub(super) is_sure: bool,
    pub(super) place: Option<ViewThird>,
    pub(super) is_far: bool,
    pub(super) stands_out: bool,
}

/// Parses an answer. An answer that was cut off is an error, unless `takes_part`: then its complete part is read.
///
/// # Errors
/// With the fault in words for the model.
pub(super) fn read_view_answer(answer: &str, takes_part: bool) -> Result<ViewReading, String> {
    let parts = |fields: &Map<String, Value>| {
        (find_field(fields, &ROOM_FIELDS).is_some(), find_field(fields, &THINGS_FIELDS).is_some())
    };
    let ObjectReading { fields, is_cut } = find_object(answer, &|fields| parts(fields) != (false, false))
        .map_err(|fault| format!("{fault}; it needs \"room\" and \"things\""))?;
    if is_cut && !takes_part {
        return Err("it was cut off: name fewer things".to_owned());
    }
    if is_foreign(&fields) {
        return Err("it is not in English: give every name in English".to_owned());
    }
    let room = find_field(&fields, &ROOM_FIELDS);
    let listed = find_field(&fields, &THINGS_FIELDS);
    let cues: Vec<NameReading> = find_field(&fields, &["standsout", "standout", "landmarks", "salient"])
        .map(value_texts)
        .unwrap_or_default()
        .iter()
        .map(|cue| read_name(cue))
        .collect();
    let things: Vec<ViewThing> = listed
        .map(list_entries)
        .unwrap_or_default()
        .into_iter()
        .filter_map(|entry| read_thing(entry, &cues))
        .take(MAX_THINGS)
        .collect();
    if let Some(listed) = listed.filter(|listed| things.is_empty() && !is_empty(listed)) {
        return Err(format!("\"things\" is no list of things with names: {}", shorten_value(listed)));
    }
    let (rooms, is_guess) = read_rooms(&room.map(value_text).unwrap_or_default());
    let says_sure = find_field(&fields, &["roomsure", "roomcertainty"]).is_none_or(is_sure);
    let ways =
        find_field(&fields, &["waysout", "exits", "ways", "openings", "doors"]).map(list_entries).unwrap_or_default();
    Ok(ViewReading {
        room_is_sure: rooms.len() == 1 && says_sure && !is_guess,
        rooms,
        ways: ways.into_iter().filter_map(read_way_out).take(MAX_WAYS_OUT).collect(),
        things: merge_like_things(things),
    })
}

/// Whether most letters of an answer's values are of another script than the Latin one.
fn is_foreign(fields: &Map<String, Value>) -> bool {
    fn count(value: &Value, letters: &mut [usize; 2]) {
        match value {
            Value::String(text) => {
                text.chars().filter(|c| c.is_alphabetic()).for_each(|c| letters[usize::from(c > '\u{24F}')] += 1);
            }
            Value::Array(values) => values.iter().for_each(|value| count(value, letters)),
            Value::Object(fields) => fields.values().for_each(|value| count(value, letters)),
            _ => {}
        }
    }
    let mut letters = [0; 2];
    // The words that the form itself asks for ("left", "sure") are English in any answer.
    let named = fields.iter().flat_map(|(_, value)| match value {
        Value::Array(entries) => entries.iter().map(|entry| entry.get("name").unwrap_or(entry)).collect(),
        other => vec![other],
    });
    named.for_each(|value| count(value, &mut letters));
    letters[1] > letters[0]
}

/// The first of these fields that is present. Case and underscores do not matter.
fn find_field<'a>(fields: &'a Map<String, Value>, names: &[&str]) -> Option<&'a Value> {
    let plain = |key: &str| key.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    names.iter().find_map(|name| {
        fields.iter().find(|(key, value)| plain(key) == *name && !value.is_null()).map(|(_, value)| value)
    })
}

/// A value as text: the first text within it.
fn value_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number.to_string(),
        Value::Bool(flag) => flag.to_string(),
        Value::Array(values) => values.first().map(value_text).unwrap_or_default(),
        Value::Object(fields) => find_field(fields, &["name", "label", "object", "thing", "kind", "type", "room"])
            .map(value_text)
            .unwrap_or_default(),
        Value::Null => String::new(),
    }
}

/// A value as texts: the items of a list, or the parts of a text between commas.
fn value_texts(value: &Value) -> Vec<String> {
    match value {
        Value::Array(values) => values.iter().take(MAX_THINGS).map(value_text).collect(),
        Value::Null => Vec::new(),
        Value::String(text) => text.split([',', ';']).take(MAX_THINGS).map(str::to_owned).collect(),
        other => vec![value_text(other)],
    }
}

/// The entries of a list. A single entry, and names with commas between them, are lists too.
fn list_entries(value: &Value) -> Vec<&Value> {
    match value {
        Value::Array(values) => values.iter().take(4 * MAX_THINGS).collect(),
        Value::Null => Vec::new(),
        other => vec![other],
    }
}

/// Whether a value means "nothing": an empty list or object, or such a word.
fn is_empty(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.is_empty(),
        Value::String(text) => matches!(text.trim().to_lowercase().as_str(), "" | "none" | "nothing"),
        Value::Object(fields) => fields.is_empty(),
        _ => false,
    }
}

/// Reads one entry of the list of things. `cues` are the names that the model gave as standing out. `None` if the entry
/// names no thing.
fn read_thing(entry: &Value, cues: &[NameReading]) -> Option<ViewThing> {
    let mut told = match entry {
        Value::Number(_) | Value::Bool(_) => return None,
        entry => read_name(&value_text(entry)),
    };
    let empty = Map::new();
    let fields = entry.as_object().unwrap_or(&empty);
    for colour in find_field(fields, &["colours", "colors", "colour", "color"])
        .map(value_texts)
        .unwrap_or_default()
        .iter()
        .flat_map(|said| read_colours(said))
    {
        told.add_colour(colour);
    }
    let material = find_field(fields, &["material", "materials"]).map(value_text).unwrap_or_default().to_lowercase();
    told.material = material
        .split(|c: char| !c.is_alphabetic())
        .find(|word| MATERIALS.contains(word))
        .map(str::to_owned)
        .or(told.material);
    let detail = find_field(fields, &["detail", "details", "pattern", "shows", "looks"]).map(value_text);
    told.detail = detail.and_then(|said| read_detail(&said)).or(told.detail);
    let stands_out = cues.iter().any(|cue| is_cue(cue, &told));
    if told.names.is_empty() {
        return None;
    }
    let count = find_field(fields, &["count", "number", "how many", "several"]).map(value_text).unwrap_or_default();
    told.several |= count.parse::<u32>().is_ok_and(|count| count > 1)
        || matches!(count.as_str(), "true" | "several" | "many" | "two");
    let is_far = find_field(fields, &["distance", "nearorfar", "far", "depth"])
        .map(value_text)
        .unwrap_or_default()
        .to_lowercase();
    Some(ViewThing {
        is_sure: told.names.len() == 1
            && !told.is_guess
            && find_field(fields, &["sure", "certainty", "confidence", "howsure", "certain"]).is_none_or(is_sure),
        place: find_field(fields, &["side", "position", "where", "place", "location"])
            .and_then(|side| read_place(&value_text(side))),
        is_far: is_far.contains("far") || is_far.contains("back") || is_far == "true",
        stands_out,
        reading: told,
    })
}

/// A detail in a few words; `None` for words that say that there is none.
fn read_detail(said: &str) -> Option<String> {
    let said = said[..said.floor_char_boundary(200)].to_lowercase();
    let words: Vec<&str> = said.split(|c: char| !(c.is_alphanumeric() || "-'".contains(c))).collect();
    let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).take(MAX_DETAIL_WORDS).collect();
    let is_none =
        matches!(words[..], [] | ["none" | "plain" | "unknown" | "no" | "solid" | "n"] | ["n", "a"] | ["no", ..]);
    (!is_none).then(|| words.join(" "))
}

/// Whether a cue ("stands out") means a thing. "Brick wall" does not mean a white wall.
fn is_cue(cue: &NameReading, told: &NameReading) -> bool {
    let names = cue.names.iter().any(|cue| told.names.iter().any(|name| names_agree(cue, name)));
    let is_everywhere = told.names.iter().any(|name| is_everywhere(name));
    let material = cue.material.is_none() || cue.material == told.material;
    if is_everywhere {
        return names && material && (told.material.is_some() || !told.colours.is_empty());
    }
    names && (material || told.material.is_none())
}

/// Whether every room has such a thing.
pub(super) fn is_everywhere(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| matches!(thing.name, "wall" | "floor" | "ceiling" | "corner"))
}

/// The colours that a text names, with their shades.
fn read_colours(said: &str) -> Vec<String> {
    let said = said.to_lowercase();
    let words: Vec<&str> =
        said.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty()).take(MAX_COLOUR_WORDS).collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let next = colour_at(&words[at..]);
        at += next.as_ref().map_or(1, |(_, length)| *length);
        found.extend(next.map(|(colour, _)| colour));
    }
    found
}

/// Whether a field expresses certainty: a flag, a number from 0.75, or words without doubt.
fn is_sure(value: &Value) -> bool {
    match value {
        Value::Bool(flag) => *flag,
        Value::Number(number) => number.as_f64().is_some_and(|share| share >= 0.75),
        other => {
            let said = value_text(other).to_lowercase();
            if let Some(share) = share_in_words(&said) {
                return share >= 0.75;
            }
            let doubts = [
                "perhaps",
                "unsure",
                "not",
                "mayb",
                "guess",
                "possib",
                "probab",
                "likely",
                "low",
                "medium",
                "uncertain",
                "false",
                "no",
            ];
            !doubts.iter().any(|doubt| said.starts_with(doubt) || said.contains(&format!(" {doubt}")))
        }
    }
}

/// A share that is written as a text: "0.3", "30%", "30 %".
fn share_in_words(said: &str) -> Option<f64> {
    let percent = said.trim().strip_suffix('%');
    let number: f64 = percent.unwrap_or(said).trim().parse().ok()?;
    Some(if percent.is_some() || number > 1.0 { number / 100.0 } else { number })
}

/// The third of the view that a text names; `None` if it names none or several.
fn read_place(said: &str) -> Option<ViewThird> {
    let said = said.to_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| said.contains(word));
    let middle = has(&["middle", "cent", "ahead", "front"]);
    match (has(&["left"]), has(&["right"]), middle) {
        (true, false, _) => Some(ViewThird::Left),
        (false, true, _) => Some(ViewThird::Right),
        (false, false, true) => Some(ViewThird::Middle),
        _ => None,
    }
}

/// Reads one entry of the list of ways out. `None` if it is neither a door, stairs or opening, nor leads to a known
/// room.
fn read_way_out(entry: &Value) -> Option<WayOut> {
    let reading = read_name(&value_text(entry));
    let empty = Map::new();
    let fields = entry.as_object().unwrap_or(&empty);
    let leads_to = find_field(fields, &["leadsto", "to", "room", "behind"]).map(value_text).unwrap_or_default();
    let (mut rooms, is_guess) = read_rooms(&leads_to);
    let room = if rooms.len() == 1 && !is_guess { rooms.pop() } else { None };
    let name = reading.names.into_iter().next().filter(|name| {
        let class = find_thing(name).map(|thing| thing.class);
        let fits = matches!(class, Some(ThingClass::Door | ThingClass::Stairs)) || is_opening(name);
        fits && !reading.is_guess
    });
    // A hallway that one looks along is a way out, but no thing.
    let name = name.or_else(|| room.is_some().then(|| "opening".to_owned()))?;
    let place =
        find_field(fields, &["side", "position", "where", "place"]).and_then(|side| read_place(&value_text(side)));
    Some(WayOut { name, place, leads_to: room })
}

/// Whether a name means an opening that one can walk through.
fn is_opening(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| matches!(thing.name, "doorway" | "arch" | "archway"))
        || ["doorway", "archway", "opening", "entrance", "exit", "gate", "elevator"]
            .iter()
            .any(|kind| name.ends_with(kind))
}

/// Joins things of the same name and side into one that counts as several.
fn merge_like_things(things: Vec<ViewThing>) -> Vec<ViewThing> {
    let mut merged: Vec<ViewThing> = Vec::new();
    for thing in things {
        let same = |other: &&mut ViewThing| other.reading.names == thing.reading.names && other.place == thing.place;
        match merged.iter_mut().find(same) {
            Some(other)
                if other.reading.colours == thing.reading.colours
                    || other.reading.colours.is_empty()
                    || thing.reading.colours.is_empty() =>
            {
                other.reading.several = true;
                other.is_sure |= thing.is_sure;
                other.stands_out |= thing.stands_out;
                other.is_far &= thing.is_far;
            }
            _ => merged.push(thing),
        }
    }
    merged
}

/// The beginning of a value for a message, 80 characters.
fn shorten_value(value: &Value) -> String {
    value.to_string().chars().take(80).collect()
}
