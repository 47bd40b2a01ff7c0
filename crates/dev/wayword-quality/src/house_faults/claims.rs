//! Finds what a piece of a text claims: turns, things, rooms, stairs and the stop. The rules are this generator's own.

use super::{
    word_lists::{
        AFTER_TURN_WORDS, ARTICLES, LandmarkWord, MAX_NAME_WORDS, NUMBER_WORDS, PHRASE_BREAKERS, SIDE_FILLERS,
        STAIRS_WORDS, STOP_PREPOSITIONS, STOP_VERBS, SideWord, TURN_VERBS, room_for_name,
    },
    words::{FaultWord, list_words},
};
use wayword_house::model::RoomKind;

/// Most words between a verb and its side.
const MAX_SIDE_FILLERS: usize = 4;
/// An article is at most this many words before its name.
const ARTICLE_REACH_WORDS: usize = 3;
/// A verb or preposition is at most this many words before the phrase that it governs.
const ROLE_REACH_WORDS: usize = 4;
/// Words before something that the walker goes towards.
const TOWARD_WORDS: [&str; 4] = ["to", "toward", "towards", "reach"];
/// Words before something that the walker passes.
const PASS_WORDS: [&str; 4] = ["past", "pass", "passing", "by"];
/// Words of a clause for the place of a turn: "turn right when you get to the mirror".
const ARRIVAL_WORDS: [&str; 5] = ["when", "get", "reach", "once", "until"];
/// Words before a room that the walker enters.
const ENTER_WORDS: [&str; 7] = ["enter", "entering", "into", "inside", "to", "toward", "towards"];
/// Words before a room that the walker leaves.
const LEAVE_WORDS: [&str; 4] = ["exit", "exiting", "leave", "leaving"];
/// Words before a room in which the walker is.
const INSIDE_WORDS: [&str; 6] = ["in", "down", "along", "follow", "across", "through"];
/// Words before a room that the walker does not enter.
const ASIDE_WORDS: [&str; 6] = ["past", "by", "near", "beside", "before", "passing"];

/// A side that a piece names, of a turn or of a thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SideMention {
    /// The side.
    pub(super) side: SideWord,
    /// Byte range of the word in the piece.
    pub(super) span: [usize; 2],
}

/// How a piece uses a thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LandmarkRole {
    /// The walker passes it.
    Pass,
    /// The walker goes towards it.
    Toward,
    /// It is near the place of a turn or of the stop.
    Near,
}

/// A thing that a piece names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LandmarkClaim {
    /// The entry of the name in the list of words.
    pub(super) word: &'static LandmarkWord,
    /// How the piece uses it.
    pub(super) role: LandmarkRole,
    /// Byte range of the name in the piece.
    pub(super) name: [usize; 2],
    /// Byte range of the name with its article and adjectives.
    pub(super) phrase: [usize; 2],
    /// Whether an article or a number begins the phrase.
    pub(super) has_article: bool,
    /// Whether the name is in the plural.
    pub(super) is_plural: bool,
    /// The number before it, with its byte range.
    pub(super) number: Option<([usize; 2], usize)>,
    /// The side on which it is: "the bed on your left".
    pub(super) side: Option<SideMention>,
    /// The words before the phrase, at most [`ROLE_REACH_WORDS`] of them.
    pub(super) before: Vec<FaultWord>,
    /// The word behind the name; empty at the end of the piece.
    pub(super) after: String,
}

/// How a piece uses a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RoomRole {
    /// The walker enters it.
    Enter,
    /// The walker leaves it.
    Leave,
    /// The walker is in it.
    Inside,
}

/// A room that a piece names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RoomClaim {
    /// The kind of room.
    pub(super) kind: RoomKind,
    /// How the piece uses it.
    pub(super) role: RoomRole,
    /// Byte range of the name in the piece.
    pub(super) span: [usize; 2],
}

/// Everything that a piece claims.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct PieceClaims {
    /// Turns that it commands.
    pub(super) turns: Vec<SideMention>,
    /// Things that it names.
    pub(super) landmarks: Vec<LandmarkClaim>,
    /// Rooms that it enters, leaves or is in.
    pub(super) rooms: Vec<RoomClaim>,
    /// Whether it is about stairs.
    pub(super) has_stairs: bool,
    /// Whether it commands to stop.
    pub(super) is_stop: bool,
}

/// A name in a piece.
enum PieceName {
    /// A thing's.
    Landmark(&'static LandmarkWord),
    /// A room's.
    Room(RoomKind),
}

/// Reads what a piece claims.
pub(super) fn read_claims(piece: &str) -> PieceClaims {
    let words = list_words(piece);
    let mut claims = PieceClaims {
        turns: list_turns(&words),
        has_stairs: names_stairs(piece),
        is_stop: words.first().is_some_and(|word| STOP_VERBS.contains(&word.low.as_str())),
        ..PieceClaims::default()
    };
    let mut at = 0;
    while at < words.len() {
        let Some((length, name)) = find_name(&words, at) else {
            at += 1;
            continue;
        };
        match name {
            PieceName::Landmark(word) => {
                let landmark = read_landmark(&words, [at, at + length], word, &claims);
                claims.landmarks.extend(landmark);
            }
            PieceName::Room(kind) => claims.rooms.extend(read_room(&words, [at, at + length], kind, claims.is_stop)),
        }
        at += length;
    }
    claims
}

/// Whether a text is about stairs.
pub(super) fn names_stairs(text: &str) -> bool {
    list_words(text).iter().any(|word| STAIRS_WORDS.contains(&word.low.as_str()))
}

/// The longest name that begins at a word, with the number of its words.
fn find_name(words: &[FaultWord], at: usize) -> Option<(usize, PieceName)> {
    (1..=MAX_NAME_WORDS).rev().find_map(|length| {
        let name: Vec<&str> = words.get(at..at + length)?.iter().map(|word| word.low.as_str()).collect();
        let name = name.join(" ");
        let landmark = LandmarkWord::for_name(&name).map(PieceName::Landmark);
        Some((length, landmark.or_else(|| room_for_name(&name).map(PieceName::Room))?))
    })
}

/// The sides of a piece that belong to a turn.
fn list_turns(words: &[FaultWord]) -> Vec<SideMention> {
    let turns = words.iter().enumerate().filter_map(|(at, word)| {
        let side = SideWord::from_word(&word.low)?;
        let next_fits = words.get(at + 1).is_none_or(|next| AFTER_TURN_WORDS.contains(&next.low.as_str()));
        let before = words.get(..at).unwrap_or_default().iter().rev().take(MAX_SIDE_FILLERS + 1);
        let verb = before.map(|word| word.low.as_str()).find(|word| !SIDE_FILLERS.contains(word))?;
        (next_fits && TURN_VERBS.contains(&verb)).then_some(SideMention { side, span: word.span })
    });
    turns.collect()
}

/// The claim about a thing, given the range of its name in words.
fn read_landmark(
    words: &[FaultWord],
    [start, end]: [usize; 2],
    word: &'static LandmarkWord,
    claims: &PieceClaims,
) -> Option<LandmarkClaim> {
    let name = [words.get(start)?.span[0], words.get(end.checked_sub(1)?)?.span[1]];
    let (first, has_article, number) = find_phrase(words, start);
    let before = words.get(first.saturating_sub(ROLE_REACH_WORDS)..first).unwrap_or_default().to_vec();
    let low = words.get(start..end)?.iter().map(|word| word.low.as_str()).collect::<Vec<_>>().join(" ");
    Some(LandmarkClaim {
        word,
        role: find_landmark_role(words, &before, claims),
        name,
        phrase: [words.get(first)?.span[0], name[1]],
        has_article,
        is_plural: low == word.many,
        number,
        side: find_side_behind(words, end),
        before,
        after: words.get(end).map_or_else(String::new, |next| next.low.clone()),
    })
}

/// The word with which the phrase of a name begins, whether that is an article or a number, and the number.
fn find_phrase(words: &[FaultWord], name: usize) -> (usize, bool, Option<([usize; 2], usize)>) {
    let is_article = |at: usize| words.get(at).is_some_and(|word| ARTICLES.contains(&word.low.as_str()));
    for back in 1..=ARTICLE_REACH_WORDS {
        let Some((at, word)) = name.checked_sub(back).and_then(|at| Some((at, words.get(at)?))) else { break };
        if let Some((_, number)) = NUMBER_WORDS.iter().find(|(low, _)| *low == word.low) {
            let first = at.checked_sub(1).filter(|before| is_article(*before)).unwrap_or(at);
            return (first, true, Some((word.span, *number)));
        }
        if is_article(at) {
            return (at, true, None);
        }
        if PHRASE_BREAKERS.contains(&word.low.as_str()) {
            break;
        }
    }
    (name, false, None)
}

/// How a piece uses the thing behind the words `before`.
fn find_landmark_role(words: &[FaultWord], before: &[FaultWord], claims: &PieceClaims) -> LandmarkRole {
    let is_beside = |at: usize| at.checked_sub(1).and_then(|at| before.get(at)).is_some_and(is_nearness);
    let nearest = before.iter().enumerate().rev().find_map(|(at, word)| {
        let low = word.low.as_str();
        match (TOWARD_WORDS.contains(&low), PASS_WORDS.contains(&low)) {
            (true, _) if is_beside(at) => Some(LandmarkRole::Near),
            (true, _) => Some(LandmarkRole::Toward),
            (false, true) => Some(LandmarkRole::Pass),
            (false, false) => None,
        }
    });
    let role = nearest.unwrap_or(LandmarkRole::Near);
    let is_arrival = words.iter().any(|word| ARRIVAL_WORDS.contains(&word.low.as_str()));
    let turns = !claims.turns.is_empty();
    if claims.is_stop || turns && (is_arrival || role != LandmarkRole::Toward) { LandmarkRole::Near } else { role }
}

/// Whether a word makes "to" mean nearness: "next to", "close to".
fn is_nearness(word: &FaultWord) -> bool {
    ["next", "close"].contains(&word.low.as_str())
}

/// The side behind a name that ends before the word `end`: "on your left", "to the left".
fn find_side_behind(words: &[FaultWord], end: usize) -> Option<SideMention> {
    let [preposition, article, side] = words.get(end..end + 3)? else { return None };
    let leads = ["on", "to"].contains(&preposition.low.as_str()) && ["your", "the"].contains(&article.low.as_str());
    let side_word = SideWord::from_word(&side.low).filter(|_| leads)?;
    Some(SideMention { side: side_word, span: side.span })
}

/// The claim about a room, given the range of its name in words; `None` where the walker only passes it, or no verb
/// is known.
fn read_room(words: &[FaultWord], [start, end]: [usize; 2], kind: RoomKind, is_stop: bool) -> Option<RoomClaim> {
    let low = |at: usize| words.get(at).map_or("", |word| word.low.as_str());
    let role = (start.saturating_sub(ROLE_REACH_WORDS)..start).rev().find_map(|at| {
        let word = low(at);
        if ASIDE_WORDS.contains(&word) {
            return Some(None);
        }
        let is_out_of = word == "of" && at > 0 && low(at - 1) == "out";
        let role = if LEAVE_WORDS.contains(&word) || is_out_of {
            RoomRole::Leave
        } else if INSIDE_WORDS.contains(&word) || word == "of" {
            RoomRole::Inside
        } else if ENTER_WORDS.contains(&word) {
            RoomRole::Enter
        } else {
            return None;
        };
        Some(Some(role))
    })??;
    let role = if is_stop && role == RoomRole::Enter { RoomRole::Inside } else { role };
    Some(RoomClaim { kind, role, span: [words.get(start)?.span[0], words.get(end.checked_sub(1)?)?.span[1]] })
}

impl LandmarkClaim {
    /// The preposition right before the phrase, as at the place of a stop, with its byte range.
    pub(super) fn preposition(&self) -> Option<(&'static str, [usize; 2])> {
        STOP_PREPOSITIONS.into_iter().find_map(|preposition| {
            let length = preposition.split(' ').count();
            let words = self.before.get(self.before.len().checked_sub(length)?..)?;
            let is_it = words.iter().map(|word| word.low.as_str()).eq(preposition.split(' '));
            is_it.then_some((preposition, [words.first()?.span[0], words.last()?.span[1]]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(piece: &str) -> Vec<SideWord> {
        read_claims(piece).turns.iter().map(|turn| turn.side).collect()
    }

    #[test]
    fn read_claims_takes_only_sides_of_turns_for_turns() {
        for piece in ["turn to the left", "make a slight left", "veer left at the bed", "go left", "take a left past"] {
            assert_eq!(sides(piece), [SideWord::Left], "{piece}");
        }
        for piece in
            ["pass the bed on the left", "walk past the bed to the left", "take the left door", "go in on the left"]
        {
            assert_eq!(sides(piece), [], "{piece}");
        }
    }

    #[test]
    fn read_claims_finds_phrases_of_things_with_number_and_side() {
        let piece = "walk past the two blue bookshelves on your right";
        let claims = read_claims(piece);
        let [shelves] = claims.landmarks.as_slice() else { panic!("{claims:?}") };
        assert_eq!(&piece[shelves.phrase[0]..shelves.phrase[1]], "the two blue bookshelves");
        assert_eq!((shelves.role, shelves.is_plural), (LandmarkRole::Pass, true));
        assert_eq!(shelves.number.map(|(span, number)| (&piece[span[0]..span[1]], number)), Some(("two", 2)));
        assert_eq!(shelves.side.map(|side| side.side), Some(SideWord::Right));
    }

    #[test]
    fn read_claims_tells_roles_of_things_apart() {
        let role = |piece: &str| read_claims(piece).landmarks[0].role;
        assert_eq!(role("go toward the kitchen island"), LandmarkRole::Toward);
        assert_eq!(role("turn right when you get to the mirror"), LandmarkRole::Near);
        assert_eq!(role("stop next to the couch"), LandmarkRole::Near);
        assert_eq!(role("pass the couch"), LandmarkRole::Pass);
        assert!(read_claims("go toward the kitchen island").rooms.is_empty(), "an island is no kitchen");
    }

    #[test]
    fn read_claims_tells_rooms_that_are_entered_left_and_passed_apart() {
        let rooms = |piece: &str| -> Vec<(RoomKind, RoomRole)> {
            read_claims(piece).rooms.iter().map(|room| (room.kind, room.role)).collect()
        };
        let both = rooms("walk out of the kitchen into the dining room");
        assert_eq!(both, [(RoomKind::Kitchen, RoomRole::Leave), (RoomKind::DiningRoom, RoomRole::Enter)]);
        assert_eq!(rooms("go down the hall"), [(RoomKind::Hallway, RoomRole::Inside)]);
        assert_eq!(rooms("wait inside the office"), [(RoomKind::Office, RoomRole::Inside)]);
        assert_eq!(rooms("walk past the bedroom"), []);
    }

    #[test]
    fn preposition_is_the_longest_one_right_before_the_phrase() {
        let piece = "stop in front of the red car";
        let claims = read_claims(piece);
        let (preposition, span) = claims.landmarks[0].preposition().unwrap();
        assert_eq!((preposition, &piece[span[0]..span[1]]), ("in front of", "in front of"));
        assert!(claims.is_stop && !claims.has_stairs);
        assert_eq!(read_claims("pass the car").landmarks[0].preposition(), None);
        assert!(read_claims("walk upstairs").has_stairs);
    }
}
