//! Cuts an instruction into pieces for the rule-based splitter: stretches of words that each lead to one place, and the closing task.
//! "Go down the hallway to the kitchen and clean the sink" gives "Go down the hallway", "to the kitchen" and the task "clean the
//! sink".

use super::clauses::{MendedClause, ends_in_task, has_object, mend_clauses, without_joints};
use std::{collections::BTreeSet, ops::Range};
use wayword_language::{
    directions::{AFTER_ROOM, GOING_ON},
    reading::{EventContent, PlaceLink, PlaceMention, TextEvent, TextReading, read_instruction},
    text::TextToken,
};

/// Most clauses of a closing task, as in "empty the bin, wipe the sink and close the door". Earlier clauses belong to the way.
const MAX_TASK_CLAUSES: usize = 3;
/// Most words of a piece that climbs first and then gets to a place. In a longer one, the climb is left out.
const MAX_CLIMB_PIECE_WORDS: usize = 16;
/// How far before a place its preposition is looked for, words.
const PREPOSITION_REACH_WORDS: usize = 7;

/// An instruction with its reading and its clauses, from which pieces are cut.
pub(super) struct InstructionPieces<'a> {
    text: &'a str,
    reading: TextReading,
    clauses: Vec<MendedClause>,
}

impl<'a> InstructionPieces<'a> {
    pub(super) fn from_text(text: &'a str) -> Self {
        let reading = read_instruction(text, &BTreeSet::new());
        let clauses = mend_clauses(text, reading.tokens(), reading.token_clauses());
        Self { text, reading, clauses }
    }

    /// The words and marks of the instruction.
    fn tokens(&self) -> &[TextToken] {
        self.reading.tokens()
    }

    /// The first clause of the closing task. Where several tasks end a text, all of them are the closing task.
    pub(super) fn task_clause(&self) -> Option<usize> {
        let last = self.clauses.last()?;
        let is_task = |clause: &usize| ends_in_task(self.words_in(&self.clauses[*clause].head));
        if !ends_in_task(&self.text[..self.byte_span(&last.head)[1]]) {
            return None;
        }
        let last = (0..self.clauses.len()).rev().find(is_task)?;
        // "Got to the kitchen" is not a task but "Go to the kitchen" with a mistake in writing.
        let is_one_of_several = |clause: &usize| {
            let head = &self.clauses[*clause].head;
            let gets_there = self.visible_places(head).next().is_some_and(|(_, place)| place.link == PlaceLink::Goal);
            !gets_there && has_object(self.tokens(), head) && is_task(clause)
        };
        (0..last).rev().take(MAX_TASK_CLAUSES - 1).take_while(is_one_of_several).last().or(Some(last))
    }

    /// The text from a clause on.
    pub(super) fn text_from(&self, clause: usize) -> &'a str {
        let end = self.clauses.last().map_or(0, |last| last.all.end);
        self.words_in(&(self.clauses[clause].all.start..end))
    }

    /// The pieces of the clauses before `end` that lead to a place, in their order.
    ///
    /// Pieces that only turn or go on are left out, because no picture shows that. Pieces that only climb or name a storey are
    /// joined to the next one.
    pub(super) fn leading_pieces(&self, end: Option<usize>) -> Vec<&'a str> {
        let mut pieces = Vec::new();
        let mut climb = None;
        for clause in self.clauses_before(end) {
            for piece in self.cut_clause(&clause.all) {
                if self.visible_places(&piece).next().is_some() {
                    let start = climb.take().filter(|start| piece.end - start <= MAX_CLIMB_PIECE_WORDS);
                    pieces.push(self.words_in(&(start.unwrap_or(piece.start)..piece.end)));
                } else if self.events_in(&piece).any(|event| is_climb(&event.what)) {
                    climb.get_or_insert(piece.start);
                }
            }
        }
        pieces
    }

    /// The longest clause before the task that does more than turn: it may name a place in words that the reader does
    /// not know.
    pub(super) fn longest_unread(&self, task: usize) -> Option<&'a str> {
        let only_moves = |what: &EventContent| matches!(what, EventContent::Turn(_) | EventContent::Onward);
        let may_lead = |clause: &&MendedClause| {
            clause.all.len() > 1 && !self.events_in(&clause.all).any(|event| event.denied || only_moves(&event.what))
        };
        let longest = self.clauses_before(Some(task)).iter().filter(may_lead).max_by_key(|clause| clause.all.len())?;
        Some(self.words_in(&longest.all))
    }

    /// The room in which the closing task is done, as the task names it.
    pub(super) fn room_of_task(&self, task: usize) -> Option<&'a str> {
        let rooms = self.clauses[task..].iter().flat_map(|clause| {
            let rooms = self
                .visible_places(&clause.all)
                .filter(|(_, place)| place.is_room && matches!(place.link, PlaceLink::Within | PlaceLink::Beside));
            rooms.filter_map(|(event, _)| self.room_words(&clause.all, event))
        });
        rooms.map(|room| self.words_in(&room)).next()
    }

    fn clauses_before(&self, end: Option<usize>) -> &[MendedClause] {
        &self.clauses[..end.unwrap_or(self.clauses.len())]
    }

    /// Cuts a clause that goes through one place and on to another: "down the hallway" and "to the kitchen".
    fn cut_clause(&self, clause: &Range<usize>) -> Vec<Range<usize>> {
        let mut cuts = vec![clause.start];
        // The place before, with the token after it.
        let mut previous: Option<(usize, &PlaceMention)> = None;
        for (event, place) in self.visible_places(clause) {
            // A cut is at least one token after the cut before, so that no piece is empty.
            let (start, at) = (cuts.last().map_or(0, |cut| cut + 1), self.first_token(event));
            if let Some((end, passed)) = previous {
                let is_goal = place.link == PlaceLink::Goal && self.leads_on(end, passed);
                let cut = self
                    .onward_token(end..at)
                    .or_else(|| is_goal.then(|| self.goal_start(end.max(start)..at)).flatten());
                cuts.extend(cut);
            }
            previous = Some((self.tokens().partition_point(|token| token.span[0] < event.span[1]), place));
        }
        cuts.push(clause.end);
        cuts.windows(2).map(|ends| without_joints(self.tokens(), ends[0]..ends[1])).collect()
    }

    /// Whether the walk passes or leaves a place on its way to the next. The place's last token is before `end`.
    fn leads_on(&self, end: usize, place: &PlaceMention) -> bool {
        let mut before = (0..end).rev().take(PREPOSITION_REACH_WORDS).map(|at| self.word_at(at));
        let mut leaves = || before.any(|word| matches!(word, "out" | "from"));
        let is_only_room = place.is_room && !place.is_thing;
        match place.link {
            PlaceLink::Along | PlaceLink::Plain => true,
            PlaceLink::Goal => is_only_room,
            PlaceLink::Within => leaves(),
            PlaceLink::Beside => false,
        }
    }

    /// The token after an "and" with which the walk goes on ("and continue"), if there is one between two places.
    fn onward_token(&self, between: Range<usize>) -> Option<usize> {
        let goes_on = |at: &usize| self.word_at(*at - 1) == "and" && GOING_ON.contains(&self.word_at(*at));
        (between.start + 1..between.end).find(goes_on)
    }

    /// The token at which the words that lead to a place begin: its preposition, with the adverbs before that ("all the way to the sofa").
    fn goal_start(&self, between: Range<usize>) -> Option<usize> {
        let is_goal =
            |at: &usize| matches!(self.word_at(*at), "to" | "into" | "onto" | "toward" | "towards" | "until" | "till");
        let mut at = between.clone().rev().take(PREPOSITION_REACH_WORDS).find(is_goal)?;
        let is_adverb = |at: usize| {
            matches!(self.word_at(at), "up" | "down" | "over" | "back" | "straight" | "way" | "all")
                || (self.word_at(at) == "the" && self.word_at(at + 1) == "way")
        };
        while at > between.start && is_adverb(at - 1) {
            at -= 1;
        }
        Some(at)
    }

    /// The words about a room in a clause: from after its preposition to the beginning of the next part. `None` if its preposition
    /// means that the task is elsewhere, as "near" or "away from".
    fn room_words(&self, clause: &Range<usize>, event: &TextEvent) -> Option<Range<usize>> {
        let room = self.first_token(event);
        let is_in = |at: &usize| matches!(self.word_at(*at), "in" | "inside" | "within" | "at" | "on" | "from" | "of");
        let preposition = (clause.start..room).rev().take(PREPOSITION_REACH_WORDS).find(is_in)?;
        let far =
            |at: usize| matches!(self.word_at(at), "far" | "farthest" | "furthest" | "farther" | "further" | "away");
        let aside = |at: &usize| matches!(self.word_at(*at), "near" | "by" | "to" | "closest" | "nearest");
        if (preposition > clause.start && far(preposition - 1)) || (preposition..room).any(|at| aside(&at)) {
            return None;
        }
        let end = (room + 1..clause.end).find(|at| AFTER_ROOM.contains(&self.word_at(*at))).unwrap_or(clause.end);
        Some(preposition + 1..end)
    }

    /// The places of a stretch that a walker may see there.
    fn visible_places(&self, piece: &Range<usize>) -> impl Iterator<Item = (&TextEvent, &PlaceMention)> {
        self.events_in(piece).filter(|event| !event.denied && !self.is_pace(event)).filter_map(|event| {
            match &event.what {
                EventContent::Place(place) => Some((event, place)),
                _ => None,
            }
        })
    }

    /// Whether the event is about paces, as in "take two steps into the room", and not about stairs.
    fn is_pace(&self, event: &TextEvent) -> bool {
        let at = self.first_token(event);
        let before = |back: usize| at.checked_sub(back).map_or("", |at| self.word_at(at));
        matches!(self.word_at(at), "step" | "steps")
            && matches!(
                before(1),
                "a" | "one" | "two" | "three" | "four" | "five" | "six" | "few" | "couple" | "2" | "3"
            )
            && !(2..=4).any(|back| matches!(before(back), "up" | "down" | "climb" | "the" | "those" | "these"))
    }

    /// The events that begin within a piece.
    fn events_in(&self, piece: &Range<usize>) -> impl Iterator<Item = &TextEvent> {
        let [from, to] = self.byte_span(piece);
        let first = self.reading.events.partition_point(|event| event.span[0] < from);
        self.reading.events[first..].iter().take_while(move |event| event.span[0] < to)
    }

    /// The index of an event's first token.
    fn first_token(&self, event: &TextEvent) -> usize {
        self.tokens().partition_point(|token| token.span[0] < event.span[0])
    }

    fn word_at(&self, at: usize) -> &str {
        &self.tokens()[at].word
    }

    /// The bytes of a range of tokens.
    fn byte_span(&self, range: &Range<usize>) -> [usize; 2] {
        let tokens = self.tokens();
        [tokens[range.start].span[0], tokens[range.end - 1].span[1]]
    }

    /// The text of a range of tokens.
    fn words_in(&self, range: &Range<usize>) -> &'a str {
        let [from, to] = self.byte_span(range);
        &self.text[from..to]
    }
}

/// Whether an event is about stairs or a storey.
fn is_climb(what: &EventContent) -> bool {
    matches!(what, EventContent::Climb(_) | EventContent::Steps(_) | EventContent::Storey(_) | EventContent::Floor(_))
}
