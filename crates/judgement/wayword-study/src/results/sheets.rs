//! Fills the CSV files of answers, moves, submissions and items.

use super::{
    Measure, MeasureKind, Unit,
    given::{Answered, Whose, seconds},
    names::Names,
    people::People,
    sheet::{Cell, Column, Sheet, column},
    walks::Walks,
};
use crate::{Answer, Choice, Data, Kind, Mode, Participant, SlotState, wording::Scale};
use std::collections::BTreeMap;

/// The data from which all files are made.
pub(super) struct Sources<'a> {
    pub(super) data: &'a Data,
    pub(super) names: &'a Names<'a>,
    pub(super) answered: &'a [Answered<'a>],
    pub(super) most_failed: usize,
}

const SINCE_CONSENT: &str = "after the participant's consent";
const STATUSES: &str = "started, complete, withdrawn, screened_out, attention_failed";
const YES: &str = "1 yes, 0 no";

impl Sources<'_> {
    /// All files, in the order of the codebook.
    pub(super) fn sheets(&self, people: &People) -> Vec<Sheet> {
        let moves = (self.data.plan.mode == Mode::Follow).then(|| self.moves());
        [Some(self.answers()), moves, Some(self.submissions()), Some(self.items(people))]
            .into_iter()
            .flatten()
            .collect()
    }

    fn answers(&self) -> Sheet {
        let mode = self.data.plan.mode;
        let mut columns = vec![
            column("participant", "the participant; the names are drawn and mean nothing", "", "p001 and so on"),
            column("item", "the item, as in items.csv", "", "number from 0"),
            column("route", "the route's name in the dataset or run", "", "text"),
            column(
                "position",
                "its place in the sequence of the participant; practice is not in this file",
                "",
                "number from 1",
            ),
            column("given_s", &format!("when the item was given, {SINCE_CONSENT}"), "seconds", "number"),
            column("answered_s", &format!("when it was answered, {SINCE_CONSENT}"), "seconds", "number"),
            column("seconds", "from getting the item to the answer; in a walk, to stopping", "seconds", "number"),
            column("status", "how far the participant came", "", STATUSES),
            column("in_everybody", "whether the answer is in the main figures", "", YES),
            column(
                "in_finished",
                "whether it is in the figures of those who finished and passed the attention checks",
                "",
                YES,
            ),
        ];
        columns.extend(match mode {
            Mode::Follow => follow_columns(),
            Mode::Rate => rate_columns(),
            Mode::Pair => pair_columns(),
        });
        let mut sheet = Sheet::new("answers.csv", "an answer to an item", columns);
        let mut answered: Vec<&Answered<'_>> = self.answered.iter().collect();
        answered.sort_by_key(|one| (self.names.of(&one.participant.id), one.slot.position, one.item.id));
        sheet.rows = answered.into_iter().map(|one| self.answer(one)).collect();
        sheet
    }

    fn answer(&self, one: &Answered<'_>) -> Vec<Cell> {
        let since = |at_ms| Cell::Number(seconds(one.participant.consented_ms, at_ms), 3);
        let route = self.data.routes.get(one.item.route as usize);
        let is_in = |whose: Whose| Cell::yes(whose.takes(one.participant, self.most_failed));
        let mut cells = vec![
            Cell::text(self.names.of(&one.participant.id)),
            Cell::Whole(i64::from(one.item.id)),
            route.map_or(Cell::Empty, |route| Cell::text(&route.name)),
            one.slot.position.map_or(Cell::Empty, |position| Cell::Whole(i64::from(position) + 1)),
            since(one.slot.given_ms),
            one.slot.answered_ms.map_or(Cell::Empty, since),
            Cell::number(one.seconds(), 3),
            Cell::text(one.participant.status.name()),
            is_in(Whose::Everybody),
            is_in(Whose::Finished),
        ];
        let condition = |text: usize| one.item.texts.get(text).map_or(Cell::Empty, |told| Cell::text(&told.condition));
        let levels = one.levels().iter().map(|level| Cell::Whole(i64::from(*level)));
        match one.answer {
            Answer::Follow { looks, .. } => {
                cells.push(condition(0));
                cells.extend(walk(one));
                cells.extend([Cell::count(one.slot.moves.len()), Cell::Whole(i64::from(*looks))]);
                cells.push(one.presses().map_or(Cell::Empty, |presses| Cell::Whole(i64::from(presses))));
                cells.extend(levels);
            }
            Answer::Rate { .. } => {
                cells.push(condition(0));
                cells.extend(levels);
                cells.push(one.slot.own_text.as_ref().map_or(Cell::Empty, Cell::text));
            }
            Answer::Pair { choice } => {
                let [a, b] = one.sides();
                cells.extend([condition(a), condition(b), Cell::text(word(*choice))]);
                cells.push(one.preferred().map_or(Cell::Empty, condition));
            }
        }
        cells
    }

    fn moves(&self) -> Sheet {
        let columns = vec![
            column("participant", "the participant", "", "p001 and so on"),
            column("item", "the item, as in items.csv", "", "number from 0"),
            column("step", "which move of the walk; 0 is the start", "", "number from 0"),
            column("viewpoint", "where it leads", "", "name of a viewpoint"),
            column("at_s", &format!("when it was made, {SINCE_CONSENT}"), "seconds", "number"),
            column("walk_s", "when it was made, after the item was given", "seconds", "number"),
            column(
                "to_goal_m",
                "from there to the goal, along the graph",
                "metres",
                "number; empty where there is no way",
            ),
        ];
        let mut sheet = Sheet::new("moves.csv", "a move of a walk that was finished", columns);
        let mut walks = Walks::new(self.data);
        let mut answered: Vec<&Answered<'_>> = self.answered.iter().collect();
        answered.sort_by_key(|one| (self.names.of(&one.participant.id), one.slot.position, one.item.id));
        for one in answered {
            let start = self.data.routes.get(one.item.route as usize).and_then(|route| route.viewpoints.first());
            let start = start.map(|start| (start, one.slot.given_ms));
            let steps = start.into_iter().chain(one.slot.moves.iter().map(|step| (&step.viewpoint, step.at_ms)));
            for (step, (viewpoint, at_ms)) in steps.enumerate() {
                sheet.rows.push(vec![
                    Cell::text(self.names.of(&one.participant.id)),
                    Cell::Whole(i64::from(one.item.id)),
                    Cell::count(step),
                    Cell::text(viewpoint.as_str()),
                    Cell::Number(seconds(one.participant.consented_ms, at_ms), 3),
                    Cell::Number(seconds(one.slot.given_ms, at_ms), 3),
                    Cell::number(walks.metres_to_goal(one.item.route, viewpoint), 3),
                ]);
            }
        }
        sheet
    }

    fn submissions(&self) -> Sheet {
        let columns = vec![
            column("participant", "the participant", "", "p001 and so on"),
            column("status", "how far", "", STATUSES),
            column("expected", "items to be answered", "", "number"),
            column("given", "items given", "", "number"),
            column("answered", "items answered", "", "number"),
            column("seconds", "from consent to the end", "seconds", "number; empty without an end"),
            column("seen_s", &format!("the last sign of life, {SINCE_CONSENT}"), "seconds", "number"),
            column("misunderstood", "tries in which the task was not understood", "", "0, 1 or 2"),
            column("understood", "whether the task was understood in the end", "", YES),
            column(
                "recruiter_status",
                "what the recruiter said when its list was last imported",
                "",
                "text; empty if never",
            ),
            column("checks_answered", "attention checks answered", "", "number"),
            column("checks_failed", "attention checks failed", "", "number"),
            column("failed", "which attention checks were failed", "", "numbers from 1, with spaces between"),
            column("is_over", "whether more failed than Prolific's rule lets pass", "", YES),
            column("in_everybody", "whether the answers are in the main figures", "", YES),
            column("in_finished", "whether they are in the figures of those who finished and passed", "", YES),
            column("consent", "hash of what was consented to", "", "text"),
        ];
        let mut sheet = Sheet::new("submissions.csv", "a participant who consented and was not forgotten", columns);
        let mut people: Vec<&Participant> = self.data.participants.iter().collect();
        people.sort_by_key(|person| self.names.of(&person.id));
        let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for slot in self.data.slots.iter().filter(|slot| slot.position.is_some()) {
            let (given, answered) = counts.entry(&slot.participant).or_default();
            *given += 1;
            *answered += usize::from(slot.state == SlotState::Answered);
        }
        let of = |person: &Participant| counts.get(person.id.as_str()).copied().unwrap_or_default();
        sheet.rows = people.into_iter().map(|person| self.submission(person, of(person))).collect();
        sheet
    }

    fn submission(&self, person: &Participant, (given, done): (usize, usize)) -> Vec<Cell> {
        let failed: Vec<String> =
            person.attention.iter().filter(|check| !check.passed).map(|check| (check.number + 1).to_string()).collect();
        let since = |at_ms| Cell::Number(seconds(person.consented_ms, at_ms), 3);
        let is_in = |whose: Whose| Cell::yes(whose.takes(person, self.most_failed));
        vec![
            Cell::text(self.names.of(&person.id)),
            Cell::text(person.status.name()),
            Cell::Whole(i64::from(person.expected)),
            Cell::count(given),
            Cell::count(done),
            person.finished_ms.map_or(Cell::Empty, since),
            since(person.seen_ms),
            Cell::Whole(i64::from(person.misunderstood)),
            Cell::yes(person.understood),
            person.recruiter_status.clone().map_or(Cell::Empty, Cell::text),
            Cell::count(person.attention.len()),
            Cell::count(failed.len()),
            Cell::text(failed.join(" ")),
            Cell::yes(failed.len() > self.most_failed),
            is_in(Whose::Everybody),
            is_in(Whose::Finished),
            Cell::text(&person.consent),
        ]
    }

    fn items(&self, people: &People) -> Sheet {
        let columns = vec![
            column("item", "the item", "", "number from 0"),
            column("route", "the route's name in the dataset or run", "", "text"),
            column("scene", "the scene", "", "text"),
            column("text_number", "which of the item's texts; an item of two texts has two lines", "", "1 or 2"),
            column("condition", "the condition of the text", "", "text"),
            column("kind", "what the condition is", "", "run, people, other-path"),
            column("text", "the text that people were given", "", "text"),
            column("marks", "how often words of it were marked for people to doubt", "", "number"),
            column("given", "how often it was given", "", "number"),
            column("answered", "how often it was answered", "", "number"),
            column("returned", "how often it went back unanswered", "", "number"),
            column("live", "how many people still have it", "", "number"),
        ];
        let mut sheet = Sheet::new("items.csv", "a text of an item; practice is left out", columns);
        let items = self.data.items.iter().filter(|item| !item.is_practice);
        for (item, handed) in items.zip(&people.by_item) {
            let route = self.data.routes.get(item.route as usize);
            for (number, told) in (1..).zip(&item.texts) {
                let kind = self.data.plan.conditions.iter().find(|condition| condition.name == told.condition);
                sheet.rows.push(vec![
                    Cell::Whole(i64::from(item.id)),
                    route.map_or(Cell::Empty, |route| Cell::text(&route.name)),
                    route.map_or(Cell::Empty, |route| Cell::text(route.scene.as_str())),
                    Cell::Whole(number),
                    Cell::text(&told.condition),
                    kind.map_or(Cell::Empty, |condition| Cell::text(kind_name(condition.kind))),
                    Cell::text(&told.text),
                    Cell::Whole(i64::try_from(told.marks.len()).unwrap_or(i64::MAX)),
                    Cell::count(handed.given),
                    Cell::count(handed.answered),
                    Cell::count(handed.returned),
                    Cell::count(handed.live),
                ]);
            }
        }
        sheet
    }
}

/// The cells with the metrics of a walk, in the order of their columns.
fn walk(one: &Answered<'_>) -> impl Iterator<Item = Cell> {
    let figure = |measure: &Measure| {
        let value = one.score.as_ref().and_then(|score| measure.of_walk(score));
        Cell::number(value, digits(measure))
    };
    Measure::of_walks().map(figure)
}

/// Number of digits after the point for a metric of a walk.
fn digits(measure: &Measure) -> usize {
    match (measure.kind, measure.unit) {
        (MeasureKind::Share, _) => 0,
        (_, Unit::Metres) => 3,
        _ => 6,
    }
}

fn condition_column() -> Column {
    column("condition", "the condition of the text", "", "name of a condition")
}

fn level_columns(scales: &[Scale]) -> impl Iterator<Item = Column> {
    let levels = |scale: &Scale| {
        let levels: Vec<String> =
            (1..).zip(scale.levels).map(|(number, word): (u8, &str)| format!("{number} {word}")).collect();
        levels.join(", ")
    };
    scales.iter().map(move |scale| column(scale.name, scale.text, "level", &levels(scale)))
}

fn follow_columns() -> Vec<Column> {
    let of_walk = |measure: &'static Measure| {
        let values = match digits(measure) {
            0 => YES,
            3 => "number; empty where there is no way",
            _ => "0 to 1",
        };
        column(measure.name, measure.meaning, if measure.unit == Unit::Metres { "metres" } else { "" }, values)
    };
    let mut columns = vec![condition_column()];
    columns.extend(Measure::of_walks().map(of_walk));
    columns.extend([
        column("moves", "moves from one viewpoint to the next", "", "number"),
        column("looks", "turns to look, as the page counted them", "", "number"),
        column("presses", "moves and looks", "", "number"),
    ]);
    columns.extend(level_columns(&crate::wording::STATEMENTS));
    columns
}

fn rate_columns() -> Vec<Column> {
    let mut columns = vec![condition_column()];
    columns.extend(level_columns(&crate::wording::QUESTIONS));
    let prefix = "text; an apostrophe in front is not the participant's: take one away";
    columns.push(column("own_text", "what the participant wrote before seeing the text", "", prefix));
    columns
}

fn pair_columns() -> Vec<Column> {
    vec![
        column("condition_a", "the condition of the text shown as A", "", "name of a condition"),
        column("condition_b", "the condition of the text shown as B", "", "name of a condition"),
        column("choice", "what was chosen", "", "a, b, tie (about equal), bad (both are)"),
        column(
            "preferred",
            "the condition of the text that was preferred",
            "",
            "name of a condition; empty without a preference",
        ),
    ]
}

fn word(choice: Choice) -> &'static str {
    match choice {
        Choice::A => "a",
        Choice::B => "b",
        Choice::Tie => "tie",
        Choice::Bad => "bad",
    }
}

/// The kind of a condition, as the plan writes it.
pub(super) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Run => "run",
        Kind::People => "people",
        Kind::OtherPath => "other-path",
    }
}
