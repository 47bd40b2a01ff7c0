//! Cuts an instruction into pieces for the rule-based splitter: stretches of words that each lead to one place, and the closing task.
//! "Go down the hallway to the kitchen and clean the sink" gives "Go down the hallway", "to the kitchen" and the task "clean the
//! sink".

use super::clauses::{Clause, ends_in_task, has_object, mended, without_joints};
use std::{collections::BTreeSet, ops::Range};
use wayword_language::{
    directions::{AFTER_ROOM, GOING_ON},
    reading::{Event, Link, Place, Reading, What, read},
    text::{Token, tokens},
};

/// Most clauses of a closing task: "empty the bin, wipe the sink and close the door".
const MOST_TASKS: usize = 3;
/// Most words of a piece that climbs first and then gets to a place.
const MOST_WORDS_OF_CLIMB: usize = 16;
/// How far before a place its preposition is looked for, words.
const REACH: usize = 7;

/// An instruction with its tokens, its reading and its clauses, from which pieces are cut.
pub(super) struct Pieces<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    reading: Reading,
    clauses: Vec<Clause>,
}

impl<'a> Pieces<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        let tokens = tokens(text);
        let clauses = mended(text, &tokens);
        Self { text, reading: read(text, &BTreeSet::new()), tokens, clauses }
    }

    /// The first clause of the closing task. Where several tasks end a text, all of them are the closing task.
    pub(super) fn task(&self) -> Option<usize> {
        let last = self.clauses.last()?;
        let is_task = |clause: &usize| ends_in_task(self.words(&self.clauses[*clause].head));
        if !ends_in_task(&self.text[..self.span(&last.head)[1]]) {
            return None;
        }
        let last = (0..self.clauses.len()).rev().find(is_task)?;
        // "Got to the kitchen" is not a task but "Go to the kitchen" with a mistake in writing.
        let is_one_of_several = |clause: &usize| {
            let head = &self.clauses[*clause].head;
            let gets_there = self.places(head).next().is_some_and(|(_, place)| place.link == Link::Goal);
            !gets_there && has_object(&self.tokens, head) && is_task(clause)
        };
        (0..last).rev().take(MOST_TASKS - 1).take_while(is_one_of_several).last().or(Some(last))
    }

    /// The text from a clause on.
    pub(super) fn rest(&self, clause: usize) -> &'a str {
        let end = self.clauses.last().map_or(0, |last| last.all.end);
        self.words(&(self.clauses[clause].all.start..end))
    }

    /// The pieces of the clauses before `end` that lead to a place, in their order.
    ///
    /// Pieces that only turn or go on are left out, because no picture shows that. Pieces that only climb or name a storey are
    /// joined to the next one.
    pub(super) fn leading(&self, end: Option<usize>) -> Vec<&'a str> {
        let mut pieces = Vec::new();
        let mut climb = None;
        for clause in self.before(end) {
            for piece in self.cut(&clause.all) {
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

    /// The longest clause before the task that does more than turn: it may name a place in words that the reader does
    /// not know.
    pub(super) fn unread(&self, task: usize) -> Option<&'a str> {
        let only_moves = |what: &What| matches!(what, What::Turn(_) | What::Onward);
        let may_lead = |clause: &&Clause| {
            clause.all.len() > 1 && !self.events(&clause.all).any(|event| event.denied || only_moves(&event.what))
        };
        let longest = self.before(Some(task)).iter().filter(may_lead).max_by_key(|clause| clause.all.len())?;
        Some(self.words(&longest.all))
    }

    /// The room in which the closing task is done, as the task names it.
    pub(super) fn room_of_task(&self, task: usize) -> Option<&'a str> {
        let rooms = self.clauses[task..].iter().flat_map(|clause| {
            let rooms = self
                .places(&clause.all)
                .filter(|(_, place)| place.is_room && matches!(place.link, Link::Within | Link::Beside));
            rooms.filter_map(|(event, _)| self.about_room(&clause.all, event))
        });
        rooms.map(|room| self.words(&room)).next()
    }

    fn before(&self, end: Option<usize>) -> &[Clause] {
        &self.clauses[..end.unwrap_or(self.clauses.len())]
    }

    /// Cuts a clause that goes through one place and on to another: "down the hallway" and "to the kitchen".
    fn cut(&self, clause: &Range<usize>) -> Vec<Range<usize>> {
        let mut cuts = vec![clause.start];
        let mut before: Option<(usize, &Place)> = None;
        for (event, place) in self.places(clause) {
            let (start, at) = (cuts.last().map_or(0, |cut| cut + 1), self.first_token(event));
            if let Some((end, from)) = before {
                let is_goal = place.link == Link::Goal && self.leads_on(end, from);
                let cut =
                    self.going_on(end..at).or_else(|| is_goal.then(|| self.before_goal(end.max(start)..at)).flatten());
                cuts.extend(cut);
            }
            before = Some((self.tokens.partition_point(|token| token.span[0] < event.span[1]), place));
        }
        cuts.push(clause.end);
        cuts.windows(2).map(|ends| without_joints(&self.tokens, ends[0]..ends[1])).collect()
    }

    /// Whether the walk passes or leaves a place on its way to the next. The place's last token is before `end`.
    fn leads_on(&self, end: usize, place: &Place) -> bool {
        let mut before = (0..end).rev().take(REACH).map(|at| self.word(at));
        let mut leaves = || before.any(|word| matches!(word, "out" | "from"));
        let is_only_room = place.is_room && !place.is_thing;
        match place.link {
            Link::Along | Link::Plain => true,
            Link::Goal => is_only_room,
            Link::Within => leaves(),
            Link::Beside => false,
        }
    }

    /// The token after an "and" with which the walk goes on ("and continue"), if there is one between two places.
    fn going_on(&self, between: Range<usize>) -> Option<usize> {
        let goes_on = |at: &usize| self.word(*at - 1) == "and" && GOING_ON.contains(&self.word(*at));
        (between.start + 1..between.end).find(goes_on)
    }

    /// Where the words that lead to a place begin: its preposition, with the adverbs before that ("all the way to the sofa").
    fn before_goal(&self, between: Range<usize>) -> Option<usize> {
        let is_goal =
            |at: &usize| matches!(self.word(*at), "to" | "into" | "onto" | "toward" | "towards" | "until" | "till");
        let mut at = between.clone().rev().take(REACH).find(is_goal)?;
        let is_adverb = |at: usize| {
            matches!(self.word(at), "up" | "down" | "over" | "back" | "straight" | "way" | "all")
                || (self.word(at) == "the" && self.word(at + 1) == "way")
        };
        while at > between.start && is_adverb(at - 1) {
            at -= 1;
        }
        Some(at)
    }

    /// The words about a room in a clause: from after its preposition to the beginning of the next part. `None` if its preposition
    /// means that the task is elsewhere, as "near" or "away from".
    fn about_room(&self, clause: &Range<usize>, event: &Event) -> Option<Range<usize>> {
        let room = self.first_token(event);
        let is_in = |at: &usize| matches!(self.word(*at), "in" | "inside" | "within" | "at" | "on" | "from" | "of");
        let preposition = (clause.start..room).rev().take(REACH).find(is_in)?;
        let far = |at: usize| matches!(self.word(at), "far" | "farthest" | "furthest" | "farther" | "further" | "away");
        let aside = |at: &usize| matches!(self.word(*at), "near" | "by" | "to" | "closest" | "nearest");
        if (preposition > clause.start && far(preposition - 1)) || (preposition..room).any(|at| aside(&at)) {
            return None;
        }
        let end = (room + 1..clause.end).find(|at| AFTER_ROOM.contains(&self.word(*at))).unwrap_or(clause.end);
        Some(preposition + 1..end)
    }

    /// The places of a stretch that a walker may see there.
    fn places(&self, piece: &Range<usize>) -> impl Iterator<Item = (&Event, &Place)> {
        self.events(piece).filter(|event| !event.denied && !self.is_pace(event)).filter_map(|event| match &event.what {
            What::Place(place) => Some((event, place)),
            _ => None,
        })
    }

    /// Whether the event is about paces, as in "take two steps into the room", and not about stairs.
    fn is_pace(&self, event: &Event) -> bool {
        let at = self.first_token(event);
        let before = |back: usize| at.checked_sub(back).map_or("", |at| self.word(at));
        matches!(self.word(at), "step" | "steps")
            && matches!(
                before(1),
                "a" | "one" | "two" | "three" | "four" | "five" | "six" | "few" | "couple" | "2" | "3"
            )
            && !(2..=4).any(|back| matches!(before(back), "up" | "down" | "climb" | "the" | "those" | "these"))
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
