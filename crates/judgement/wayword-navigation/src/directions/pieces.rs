//! A text in pieces: stretches of its words that lead to a place, and its closing task.

use std::{collections::BTreeSet, ops::Range};
use wayword_synthesis::{
    lexicon::same_room,
    reading::{Event, Link, Place, Reading, What, clauses, read},
    text::{Token, tokens},
};

/// Most clauses of a closing task: "empty the bin, wipe the sink and close the door".
const MOST_TASKS: usize = 3;
/// Most words of a piece that climbs first and then gets to a place.
const MOST_WORDS_OF_CLIMB: usize = 16;
/// How far before a place its preposition may stand, words.
const REACH: usize = 7;

/// Words that join a clause to the one before.
const JOINING: [&str; 8] = ["and", "then", "please", "also", "now", "finally", "afterwards", "but"];
/// Words that end what is said about a room.
const AFTER_ROOM: [&str; 9] = ["and", "if", "when", "while", "whether", "so", "until", "for", "to"];

/// A text in pieces.
pub(super) struct Pieces<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    reading: Reading,
    /// Ranges of tokens, without the words that join them and the marks at their ends.
    clauses: Vec<Range<usize>>,
}

impl<'a> Pieces<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        let tokens = tokens(text);
        let clauses = clause_ranges(&tokens);
        Self { text, reading: read(text, &BTreeSet::new()), tokens, clauses }
    }

    /// The first clause of the closing task. Where several tasks end a text, all of them are the closing task.
    pub(super) fn task(&self) -> Option<usize> {
        self.reading.task.as_ref()?;
        let is_task = |clause: &usize| read(self.words(&self.clauses[*clause]), &BTreeSet::new()).task.is_some();
        let last = (0..self.clauses.len()).rev().find(is_task)?;
        (0..=last).rev().take(MOST_TASKS).take_while(is_task).last()
    }

    /// The text from a clause on.
    pub(super) fn rest(&self, clause: usize) -> &'a str {
        let end = self.clauses.last().map_or(0, |last| last.end);
        self.words(&(self.clauses[clause].start..end))
    }

    /// The pieces of the clauses before `end` that lead to a place, in their order.
    ///
    /// What only turns or goes on is left out, because no picture shows it. What only climbs or tells a floor is joined to the
    /// next piece.
    pub(super) fn leading(&self, end: Option<usize>) -> Vec<&'a str> {
        let mut pieces = Vec::new();
        let mut climb = None;
        for clause in &self.clauses[..end.unwrap_or(self.clauses.len())] {
            for piece in self.cut(clause) {
                if self.places(&piece).next().is_some() {
                    let start = climb.take().filter(|start| piece.end - start <= MOST_WORDS_OF_CLIMB);
                    pieces.push(self.words(&(start.unwrap_or(piece.start)..piece.end)));
                } else if self.events(&piece).any(|event| climbs(&event.what)) {
                    climb.get_or_insert(piece.start);
                }
            }
        }
        pieces
    }

    /// The rooms in which the closing task is done, as it tells them, without those that are named before.
    pub(super) fn rooms_of_task(&self, task: usize) -> Vec<&'a str> {
        let mut named: Vec<&str> = Vec::new();
        let mut rooms = Vec::new();
        for (at, clause) in self.clauses.iter().enumerate() {
            for (event, place) in self.places(clause).filter(|(_, place)| place.is_room) {
                if at >= task && place.link == Link::Within && !named.iter().any(|name| same_room(name, &place.name)) {
                    rooms.push(self.words(&self.about_room(clause, event)));
                }
                named.push(&place.name);
            }
        }
        rooms
    }

    /// A clause in two where it goes through one place and on to another: "down the hallway" and "to the kitchen".
    fn cut(&self, clause: &Range<usize>) -> Vec<Range<usize>> {
        let mut pieces = Vec::new();
        let mut start = clause.start;
        let mut leads_on = false;
        for (event, place) in self.places(clause) {
            if place.link == Link::Goal && leads_on {
                let cut = self.before_goal(start, self.first_token(event));
                pieces.push(start..cut);
                (start, leads_on) = (cut, false);
            }
            leads_on |= matches!(place.link, Link::Along | Link::Plain);
        }
        pieces.push(start..clause.end);
        pieces
    }

    /// Where the words that lead to a place begin: its preposition, with the adverbs before that ("all the way to the sofa").
    fn before_goal(&self, from: usize, place: usize) -> usize {
        let is_goal = |at: &usize| {
            matches!(
                self.word(*at),
                "to" | "into" | "onto" | "toward" | "towards" | "until" | "till" | "enter" | "reach"
            )
        };
        let Some(mut at) = (from + 1..place).rev().take(REACH).find(is_goal) else { return place };
        while at > from + 1
            && (matches!(
                self.word(at - 1),
                "up" | "down" | "over" | "back" | "straight" | "way" | "all" | "and" | "right"
            ) || (self.word(at - 1) == "the" && self.word(at) == "way"))
        {
            at -= 1;
        }
        // "And" joins; it belongs to neither.
        if self.word(at) == "and" { at + 1 } else { at }
    }

    /// What is said about a room in a clause: from behind its preposition to where something else begins.
    fn about_room(&self, clause: &Range<usize>, event: &Event) -> Range<usize> {
        let room = self.first_token(event);
        let is_in = |at: &usize| matches!(self.word(*at), "in" | "inside" | "within" | "at" | "on" | "from" | "of");
        let start = (clause.start..room).rev().take(REACH).find(is_in).map_or(room, |at| at + 1);
        let end = (room + 1..clause.end).find(|at| AFTER_ROOM.contains(&self.word(*at))).unwrap_or(clause.end);
        start..end
    }

    fn places(&self, piece: &Range<usize>) -> impl Iterator<Item = (&Event, &Place)> {
        self.events(piece).filter(|event| !event.denied).filter_map(|event| match &event.what {
            What::Place(place) => Some((event, place)),
            _ => None,
        })
    }

    fn events(&self, piece: &Range<usize>) -> impl Iterator<Item = &Event> {
        let [from, to] = self.span(piece);
        let first = self.reading.events.partition_point(|event| event.span[0] < from);
        self.reading.events[first..].iter().take_while(move |event| event.span[0] < to)
    }

    fn first_token(&self, event: &Event) -> usize {
        self.tokens.partition_point(|token| token.span[0] < event.span[0])
    }

    fn word(&self, at: usize) -> &str {
        &self.tokens[at].word
    }

    fn span(&self, range: &Range<usize>) -> [usize; 2] {
        [self.tokens[range.start].span[0], self.tokens[range.end - 1].span[1]]
    }

    fn words(&self, range: &Range<usize>) -> &'a str {
        let [from, to] = self.span(range);
        &self.text[from..to]
    }
}

fn climbs(what: &What) -> bool {
    matches!(what, What::Climb(_) | What::Steps(_) | What::Storey(_) | What::Floor(_))
}

/// The clauses that have words, without what joins them.
fn clause_ranges(tokens: &[Token]) -> Vec<Range<usize>> {
    let numbers = clauses(tokens);
    let mut ranges = Vec::new();
    let mut from = 0;
    for clause in numbers.chunk_by(|a, b| a == b) {
        let mut range = from..from + clause.len();
        from = range.end;
        let joins = |token: &Token| !token.is_word() || JOINING.contains(&token.word.as_str());
        while !range.is_empty() && joins(&tokens[range.start]) {
            range.start += 1;
        }
        while !range.is_empty() && joins(&tokens[range.end - 1]) {
            range.end -= 1;
        }
        if !range.is_empty() {
            ranges.push(range);
        }
    }
    ranges
}
