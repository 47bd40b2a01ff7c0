//! The word lists of this generator: names of things and rooms, sides, and verbs. They are its own, because it must
//! not share the errors of the program's reader.

use wayword_house::model::RoomKind;

/// The most words that a name has.
pub(super) const MAX_NAME_WORDS: usize = 3;

/// Verbs that turn the walker to the side behind them.
pub(super) const TURN_VERBS: [&str; 9] = ["turn", "take", "make", "bear", "veer", "hang", "go", "head", "do"];
/// Words between such a verb and its side.
pub(super) const SIDE_FILLERS: [&str; 12] =
    ["a", "an", "the", "to", "your", "slight", "slightly", "sharp", "sharply", "hard", "immediate", "quick"];
/// Words that may follow the side of a turn. Behind any other word it is the side of a thing ("the left door").
pub(super) const AFTER_TURN_WORDS: [&str; 24] = [
    "at", "and", "then", "into", "onto", "in", "to", "toward", "towards", "through", "past", "when", "once", "after",
    "before", "by", "again", "down", "up", "until", "on", "out", "from", "near",
];
/// Verbs with which a clause begins.
pub(super) const CLAUSE_VERBS: [&str; 35] = [
    "turn", "take", "make", "bear", "veer", "hang", "go", "walk", "head", "move", "continue", "proceed", "keep",
    "pass", "enter", "exit", "leave", "step", "follow", "climb", "ascend", "descend", "cross", "stop", "wait", "stand",
    "halt", "pause", "finish", "end", "come", "stay", "travel", "get", "reach",
];
/// Verbs that report where the walk ends.
pub(super) const STOP_VERBS: [&str; 8] = ["stop", "wait", "stand", "halt", "pause", "finish", "end", "stay"];
/// Words for the stairs, or for a walk over them.
pub(super) const STAIRS_WORDS: [&str; 10] =
    ["stairs", "stair", "steps", "staircase", "stairway", "upstairs", "downstairs", "ascend", "descend", "climb"];
/// Articles, and what takes their place.
pub(super) const ARTICLES: [&str; 4] = ["the", "a", "an", "your"];
/// Numbers that a text may give for things.
pub(super) const NUMBER_WORDS: [(&str, usize); 3] = [("two", 2), ("three", 3), ("four", 4)];
/// Words at which the search for the article of a name ends.
pub(super) const PHRASE_BREAKERS: [&str; 20] = [
    "and", "to", "toward", "towards", "by", "past", "of", "at", "near", "with", "in", "on", "into", "pass", "passing",
    "beside", "through", "between", "after", "before",
];
/// Prepositions for the place of a stop, the longest first.
pub(super) const STOP_PREPOSITIONS: [&str; 7] = ["in front of", "close to", "next to", "beside", "near", "at", "by"];
/// Things that a text can name as the place of a stop, by their names in the plan: they stand on the floor or hang
/// where one looks, and are large.
pub(super) const STOP_THINGS: [&str; 34] = [
    "sofa",
    "armchair",
    "coffee table",
    "television",
    "bookshelf",
    "floor lamp",
    "plant",
    "fireplace",
    "piano",
    "grandfather clock",
    "refrigerator",
    "stove",
    "kitchen island",
    "toilet",
    "bathtub",
    "shower",
    "mirror",
    "dining table",
    "sideboard",
    "bed",
    "nightstand",
    "wardrobe",
    "dresser",
    "bench",
    "desk",
    "washing machine",
    "dryer",
    "filing cabinet",
    "console table",
    "coat rack",
    "workbench",
    "car",
    "bicycle",
    "radiator",
];
/// Pieces of a text that command only to walk on.
pub(super) const STRAIGHT_PIECES: [&str; 10] = [
    "walk straight",
    "go straight",
    "head straight",
    "continue straight",
    "walk forward",
    "move forward",
    "go forward",
    "continue forward",
    "keep going straight",
    "walk straight ahead",
];

/// A side of the walker, as a text names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SideWord {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl SideWord {
    /// The side that a word in lower case names.
    pub(super) fn from_word(word: &str) -> Option<Self> {
        match word {
            "left" => Some(Self::Left),
            "right" => Some(Self::Right),
            _ => None,
        }
    }

    /// The word for it.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// The other side.
    pub(super) fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Whether a number that is positive on the right lies on this side: a turn in degrees, or a distance.
    pub(super) fn has_sign(self, number: f64) -> bool {
        match self {
            Self::Left => number < 0.0,
            Self::Right => number > 0.0,
        }
    }
}

/// A word for things, and what it may mean in the plan of a house.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct LandmarkWord {
    /// The word for one thing.
    pub(super) one: &'static str,
    /// The word for several.
    pub(super) many: &'static str,
    /// All names in the plan for things that a person could call so. The list is long on purpose: a text is wrong
    /// only where no reader could find a thing that it might mean.
    means: &'static [&'static str],
}

impl LandmarkWord {
    /// The entry for a name in lower case, singular or plural.
    pub(super) fn for_name(name: &str) -> Option<&'static Self> {
        LANDMARK_WORDS.iter().find(|word| word.one == name || word.many == name)
    }

    /// Whether a person could call a thing of the plan so.
    pub(super) fn can_mean(&self, plan_name: &str) -> bool {
        self.means.contains(&plan_name)
    }

    /// Whether some thing could be called by both words.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.means.iter().any(|name| other.can_mean(name))
    }
}

/// An entry of [`LANDMARK_WORDS`].
const fn landmark(one: &'static str, many: &'static str, means: &'static [&'static str]) -> LandmarkWord {
    LandmarkWord { one, many, means }
}

/// The words for things.
static LANDMARK_WORDS: &[LandmarkWord] = &[
    landmark("sofa", "sofas", &["sofa"]),
    landmark("couch", "couches", &["sofa"]),
    landmark("armchair", "armchairs", &["armchair"]),
    landmark("office chair", "office chairs", &["office chair"]),
    landmark("chair", "chairs", &["chair", "armchair", "office chair"]),
    landmark("stool", "stools", &["stool"]),
    landmark("coffee table", "coffee tables", &["coffee table", "side table"]),
    landmark("side table", "side tables", &["side table", "nightstand", "coffee table"]),
    landmark("console table", "console tables", &["console table", "sideboard"]),
    landmark("dining table", "dining tables", &["dining table"]),
    landmark("table", "tables", &["dining table", "coffee table", "side table", "console table", "desk", "workbench"]),
    landmark("tv stand", "tv stands", &["tv stand", "sideboard"]),
    landmark("television", "televisions", &["television"]),
    landmark("tv", "tvs", &["television"]),
    landmark("bookshelf", "bookshelves", &["bookshelf", "shelf", "metal shelf"]),
    landmark("bookcase", "bookcases", &["bookshelf", "shelf", "metal shelf"]),
    landmark("metal shelf", "metal shelves", &["metal shelf", "shelf"]),
    landmark("shelf", "shelves", &["shelf", "bookshelf", "metal shelf"]),
    landmark("floor lamp", "floor lamps", &["floor lamp"]),
    landmark("lamp", "lamps", &["lamp", "floor lamp", "ceiling light"]),
    landmark("rug", "rugs", &["rug", "bath mat", "doormat"]),
    landmark("carpet", "carpets", &["rug", "bath mat", "doormat"]),
    landmark("plant", "plants", &["plant"]),
    landmark("painting", "paintings", &["painting", "pictures", "tapestry"]),
    landmark("picture", "pictures", &["painting", "pictures", "tapestry"]),
    landmark("photo", "photos", &["pictures", "painting"]),
    landmark("tapestry", "tapestries", &["tapestry", "painting"]),
    landmark("fireplace", "fireplaces", &["fireplace"]),
    landmark("curtain", "curtains", &["curtain"]),
    landmark("vase", "vases", &["vase"]),
    landmark("piano", "pianos", &["piano"]),
    landmark("coat hooks", "coat hooks", &["coat hooks", "coat rack"]),
    landmark("coat rack", "coat racks", &["coat rack", "coat hooks", "clothes rack"]),
    landmark("bulletin board", "bulletin boards", &["bulletin board", "whiteboard"]),
    landmark("whiteboard", "whiteboards", &["whiteboard", "bulletin board"]),
    landmark("tool rack", "tool racks", &["tool rack"]),
    landmark("grandfather clock", "grandfather clocks", &["grandfather clock"]),
    landmark("clock", "clocks", &["clock", "grandfather clock"]),
    landmark("kitchen counter", "kitchen counters", &["kitchen counter", "kitchen island", "sink", "stove"]),
    landmark("counter", "counters", &["kitchen counter", "kitchen island", "sink", "stove"]),
    landmark("kitchen island", "kitchen islands", &["kitchen island"]),
    landmark("island", "islands", &["kitchen island"]),
    landmark("sink", "sinks", &["sink"]),
    landmark("stove", "stoves", &["stove"]),
    landmark("oven", "ovens", &["stove"]),
    landmark("refrigerator", "refrigerators", &["refrigerator"]),
    landmark("fridge", "fridges", &["refrigerator"]),
    landmark("cabinet", "cabinets", &["cabinet", "filing cabinet", "sideboard", "tv stand", "wardrobe", "dresser"]),
    landmark("filing cabinet", "filing cabinets", &["filing cabinet", "cabinet"]),
    landmark("range hood", "range hoods", &["range hood"]),
    landmark("microwave", "microwaves", &["microwave"]),
    landmark("toaster", "toasters", &["toaster"]),
    landmark("kettle", "kettles", &["kettle"]),
    landmark("fruit bowl", "fruit bowls", &["fruit bowl"]),
    landmark("toilet", "toilets", &["toilet"]),
    landmark("mirror", "mirrors", &["mirror"]),
    landmark("bathtub", "bathtubs", &["bathtub"]),
    landmark("tub", "tubs", &["bathtub"]),
    landmark("bath", "baths", &["bathtub"]),
    landmark("bath mat", "bath mats", &["bath mat", "rug"]),
    landmark("doormat", "doormats", &["doormat", "rug"]),
    landmark("shower", "showers", &["shower"]),
    landmark("towel", "towels", &["towel"]),
    landmark("chandelier", "chandeliers", &["chandelier", "ceiling light"]),
    landmark("sideboard", "sideboards", &["sideboard", "console table", "dresser", "tv stand"]),
    landmark("bed", "beds", &["bed"]),
    landmark("nightstand", "nightstands", &["nightstand", "side table"]),
    landmark("wardrobe", "wardrobes", &["wardrobe"]),
    landmark("dresser", "dressers", &["dresser", "sideboard", "nightstand"]),
    landmark("bench", "benches", &["bench"]),
    landmark("desk", "desks", &["desk"]),
    landmark("computer", "computers", &["computer"]),
    landmark("globe", "globes", &["globe"]),
    landmark("washing machine", "washing machines", &["washing machine", "dryer"]),
    landmark("washer", "washers", &["washing machine", "dryer"]),
    landmark("dryer", "dryers", &["dryer", "washing machine"]),
    landmark("laundry basket", "laundry baskets", &["laundry basket"]),
    landmark("ironing board", "ironing boards", &["ironing board"]),
    landmark("shoe rack", "shoe racks", &["shoe rack"]),
    landmark("clothes rack", "clothes racks", &["clothes rack", "coat rack"]),
    landmark("cardboard box", "cardboard boxes", &["cardboard boxes"]),
    landmark("box", "boxes", &["cardboard boxes"]),
    landmark("car", "cars", &["car"]),
    landmark("workbench", "workbenches", &["workbench"]),
    landmark("radiator", "radiators", &["radiator"]),
    landmark("bicycle", "bicycles", &["bicycle"]),
    landmark("bike", "bikes", &["bicycle"]),
    landmark("window", "windows", &["window"]),
];

/// The words for rooms.
const ROOM_WORDS: [(&str, RoomKind); 23] = [
    ("living room", RoomKind::LivingRoom),
    ("living area", RoomKind::LivingRoom),
    ("sitting room", RoomKind::LivingRoom),
    ("family room", RoomKind::LivingRoom),
    ("lounge", RoomKind::LivingRoom),
    ("kitchen", RoomKind::Kitchen),
    ("dining room", RoomKind::DiningRoom),
    ("dining area", RoomKind::DiningRoom),
    ("bedroom", RoomKind::Bedroom),
    ("bathroom", RoomKind::Bathroom),
    ("restroom", RoomKind::Bathroom),
    ("office", RoomKind::Office),
    ("study", RoomKind::Office),
    ("hallway", RoomKind::Hallway),
    ("hall", RoomKind::Hallway),
    ("corridor", RoomKind::Hallway),
    ("laundry room", RoomKind::LaundryRoom),
    ("laundry area", RoomKind::LaundryRoom),
    ("entryway", RoomKind::Entryway),
    ("entry way", RoomKind::Entryway),
    ("foyer", RoomKind::Entryway),
    ("closet", RoomKind::Closet),
    ("garage", RoomKind::Garage),
];

/// The kind of room that a name in lower case means.
pub(super) fn room_for_name(name: &str) -> Option<RoomKind> {
    ROOM_WORDS.iter().find(|(word, _)| *word == name).map(|(_, kind)| *kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_house::generate_house;

    #[test]
    fn landmark_words_mean_only_names_that_plans_have() {
        let names: BTreeSet<String> =
            (0..40).flat_map(|seed| generate_house(seed).furniture).map(|piece| piece.name).collect();
        let meant: BTreeSet<&str> = LANDMARK_WORDS.iter().flat_map(|word| word.means).copied().collect();
        let unknown: Vec<&&str> = meant.iter().filter(|name| **name != "window" && !names.contains(**name)).collect();
        // A rare piece may be in none of forty houses, but a misspelt name is in none at all.
        assert!(unknown.len() <= 3, "{unknown:?}");
    }

    #[test]
    fn every_thing_for_stops_has_a_word_that_means_it() {
        for thing in STOP_THINGS {
            let word = LandmarkWord::for_name(thing);
            assert!(word.is_some_and(|word| word.one == thing && word.can_mean(thing)), "{thing}");
        }
    }

    #[test]
    fn words_are_in_lower_case_and_each_is_listed_once() {
        let mut all = BTreeSet::new();
        for word in LANDMARK_WORDS {
            let length = word.one.split(' ').count();
            assert!(word.one == word.one.to_lowercase() && length <= MAX_NAME_WORDS, "{}", word.one);
            assert!(all.insert(word.one), "{}", word.one);
        }
    }

    #[test]
    fn overlaps_holds_for_words_that_can_mean_one_thing() {
        let word = |name: &str| LandmarkWord::for_name(name).unwrap();
        assert!(word("couch").overlaps(word("sofas")) && word("chair").overlaps(word("armchair")));
        assert!(!word("bed").overlaps(word("bench")));
        assert_eq!(LandmarkWord::for_name("harp"), None);
    }

    #[test]
    fn room_for_name_knows_other_words_for_a_room() {
        assert_eq!(room_for_name("foyer"), Some(RoomKind::Entryway));
        assert_eq!(room_for_name("hall"), Some(RoomKind::Hallway));
        assert_eq!(room_for_name("island"), None);
    }

    #[test]
    fn has_sign_is_negative_on_the_left() {
        assert!(SideWord::Left.has_sign(-40.0) && SideWord::Right.has_sign(40.0));
        assert!(!SideWord::Left.has_sign(40.0) && !SideWord::Right.has_sign(0.0));
        assert_eq!(SideWord::from_word("left").map(SideWord::opposite), SideWord::from_word("right"));
    }
}
