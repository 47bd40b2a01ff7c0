//! Fills the CSV files of answers, moves, submissions and items.

use super::{
    MeasureKind, MeasureUnit, StudyMeasure, exclusions,
    judgements::{AnsweredItem, ParticipantFilter, seconds_between},
    names::ParticipantNames,
    people::ParticipantSummary,
    sheet::{DataSheet, SheetCell, SheetColumn, sheet_column},
    walks::WalkScorer,
};
use crate::{
    ConditionKind, PairChoice, Participant, ParticipantAnswer, SlotState, StudyData, StudyTask, WindowSize,
    wording::RatingScale,
};
use std::collections::BTreeMap;

/// The data from which all files are made.
pub(super) struct SheetSources<'a> {
    pub(super) data: &'a StudyData,
    pub(super) names: &'a ParticipantNames<'a>,
    pub(super) answered: &'a [AnsweredItem<'a>],
    pub(super) most_failed: usize,
}

/// From when the times in the files count, for the meanings of columns.
const SINCE_CONSENT: &str = "after the participant's consent";
/// The possible values of a column with a status.
const STATUSES: &str = "started, complete, withdrawn, screened_out, attention_failed";
const YES_NO_VALUES: &str = "1 yes, 0 no";

impl SheetSources<'_> {
    /// All files, in the order of the codebook.
    pub(super) fn all_sheets(&self, people: &ParticipantSummary) -> Vec<DataSheet> {
        let moves = (self.data.plan.mode == StudyTask::Follow).then(|| self.move_sheet());
        let end = (!self.data.settings.end.is_empty()).then(|| self.end_sheet());
        [Some(self.answer_sheet()), moves, Some(self.submission_sheet()), end, Some(self.item_sheet(people))]
            .into_iter()
            .flatten()
            .collect()
    }

    fn answer_sheet(&self) -> DataSheet {
        let mode = self.data.plan.mode;
        let mut columns = vec![
            sheet_column("participant", "the participant; the names are drawn and mean nothing", "", "p001 and so on"),
            sheet_column("item", "the item, as in items.csv", "", "number from 0"),
            sheet_column("route", "the route's name in the dataset or run", "", "text"),
            sheet_column(
                "position",
                "its place in the sequence of the participant; practice is not in this file",
                "",
                "number from 1",
            ),
            sheet_column("given_s", &format!("when the item was given, {SINCE_CONSENT}"), "seconds", "number"),
            sheet_column("answered_s", &format!("when it was answered, {SINCE_CONSENT}"), "seconds", "number"),
            sheet_column("seconds", "from getting the item to the answer; in a walk, to stopping", "seconds", "number"),
            sheet_column("status", "how far the participant came", "", STATUSES),
            sheet_column("in_everybody", "whether the answer is in the main figures", "", YES_NO_VALUES),
            sheet_column(
                "in_finished",
                "whether it is in the figures of those who finished and passed the attention checks",
                "",
                YES_NO_VALUES,
            ),
            sheet_column(
                "in_kept",
                "whether it is in these figures and no exclusion rule leaves it out",
                "",
                YES_NO_VALUES,
            ),
            sheet_column(
                "excluded",
                "the exclusion rules of study.toml that it breaks",
                "",
                "too_fast, film_not_watched, too_few_moves, with spaces between; empty if none",
            ),
        ];
        columns.extend(match mode {
            StudyTask::Follow => follow_columns(),
            StudyTask::Rate => rate_columns(),
            StudyTask::Pair => pair_columns(),
        });
        let mut sheet = DataSheet::new("answers.csv", "an answer to an item", columns);
        let mut answered: Vec<&AnsweredItem<'_>> = self.answered.iter().collect();
        answered.sort_by_key(|one| (self.names.name_for_id(&one.participant.id), one.slot.position, one.item.id));
        sheet.rows = answered.into_iter().map(|one| self.answer_row(one)).collect();
        sheet
    }

    fn answer_row(&self, one: &AnsweredItem<'_>) -> Vec<SheetCell> {
        let since = |at_ms| SheetCell::Number(seconds_between(one.participant.consented_ms, at_ms), 3);
        let route = self.data.routes.get(one.item.route as usize);
        let is_in = |filter: ParticipantFilter| {
            SheetCell::yes_or_no(exclusions::counts_answer(filter, one, self.data, self.most_failed))
        };
        let mut cells = vec![
            SheetCell::text(self.names.name_for_id(&one.participant.id)),
            SheetCell::Whole(i64::from(one.item.id)),
            route.map_or(SheetCell::Empty, |route| SheetCell::text(&route.name)),
            one.slot.position.map_or(SheetCell::Empty, |position| SheetCell::Whole(i64::from(position) + 1)),
            since(one.slot.given_ms),
            one.slot.answered_ms.map_or(SheetCell::Empty, since),
            SheetCell::number(one.answer_seconds(), 3),
            SheetCell::text(one.participant.status.name()),
            is_in(ParticipantFilter::Everybody),
            is_in(ParticipantFilter::Finished),
            is_in(ParticipantFilter::Kept),
            SheetCell::text(exclusions::broken_rules(one, self.data).join(" ")),
        ];
        let pictures = || one.slot.pictures_seen.map_or(SheetCell::Empty, |seen| SheetCell::Whole(i64::from(seen)));
        let condition = |text: usize| {
            one.item.texts.get(text).map_or(SheetCell::Empty, |judged| SheetCell::text(&judged.condition))
        };
        let levels = one.chosen_levels().iter().map(|level| SheetCell::Whole(i64::from(*level)));
        match one.answer {
            ParticipantAnswer::Follow { looks, window, .. } => {
                cells.push(condition(0));
                cells.extend(walk_figure_cells(one));
                cells.extend([SheetCell::count(one.slot.moves.len()), SheetCell::Whole(i64::from(*looks))]);
                cells
                    .push(one.count_presses().map_or(SheetCell::Empty, |presses| SheetCell::Whole(i64::from(presses))));
                cells.extend(levels);
                cells.extend(window_cells(*window));
            }
            ParticipantAnswer::Rate { .. } => {
                cells.push(condition(0));
                cells.extend(levels);
                cells.push(pictures());
                cells.push(one.slot.own_text.as_ref().map_or(SheetCell::Empty, SheetCell::text));
            }
            ParticipantAnswer::Pair { choice } => {
                let [a, b] = one.shown_order();
                cells.extend([condition(a), condition(b), SheetCell::text(choice_word(*choice))]);
                cells.push(one.preferred_text().map_or(SheetCell::Empty, condition));
                cells.push(pictures());
            }
        }
        cells
    }

    fn move_sheet(&self) -> DataSheet {
        let columns = vec![
            sheet_column("participant", "the participant", "", "p001 and so on"),
            sheet_column("item", "the item, as in items.csv", "", "number from 0"),
            sheet_column("step", "which move of the walk; 0 is the start", "", "number from 0"),
            sheet_column("viewpoint", "where it leads", "", "name of a viewpoint"),
            sheet_column("at_s", &format!("when it was made, {SINCE_CONSENT}"), "seconds", "number"),
            sheet_column("walk_s", "when it was made, after the item was given", "seconds", "number"),
            sheet_column(
                "to_goal_m",
                "from there to the goal, along the graph",
                "metres",
                "number; empty where there is no way",
            ),
        ];
        let mut sheet = DataSheet::new("moves.csv", "a move of a walk that was finished", columns);
        let mut walks = WalkScorer::new(self.data);
        let mut answered: Vec<&AnsweredItem<'_>> = self.answered.iter().collect();
        answered.sort_by_key(|one| (self.names.name_for_id(&one.participant.id), one.slot.position, one.item.id));
        for one in answered {
            let start = self.data.routes.get(one.item.route as usize).and_then(|route| route.viewpoints.first());
            let start = start.map(|start| (start, one.slot.given_ms));
            let steps = start.into_iter().chain(one.slot.moves.iter().map(|step| (&step.viewpoint, step.at_ms)));
            for (step, (viewpoint, at_ms)) in steps.enumerate() {
                sheet.rows.push(vec![
                    SheetCell::text(self.names.name_for_id(&one.participant.id)),
                    SheetCell::Whole(i64::from(one.item.id)),
                    SheetCell::count(step),
                    SheetCell::text(viewpoint.as_str()),
                    SheetCell::Number(seconds_between(one.participant.consented_ms, at_ms), 3),
                    SheetCell::Number(seconds_between(one.slot.given_ms, at_ms), 3),
                    SheetCell::number(walks.metres_to_goal(one.item.route, viewpoint), 3),
                ]);
            }
        }
        sheet
    }

    fn submission_sheet(&self) -> DataSheet {
        let columns = vec![
            sheet_column("participant", "the participant", "", "p001 and so on"),
            sheet_column("status", "how far", "", STATUSES),
            sheet_column("expected", "items to be answered", "", "number"),
            sheet_column("given", "items given", "", "number"),
            sheet_column("answered", "items answered", "", "number"),
            sheet_column("seconds", "from consent to the end", "seconds", "number; empty without an end"),
            sheet_column("seen_s", &format!("the last sign of life, {SINCE_CONSENT}"), "seconds", "number"),
            sheet_column("misunderstood", "tries in which the task was not understood", "", "0, 1 or 2"),
            sheet_column("understood", "whether the task was understood in the end", "", YES_NO_VALUES),
            sheet_column(
                "recruiter_status",
                "what the recruiter said when its list was last imported",
                "",
                "text; empty if never",
            ),
            sheet_column("checks_answered", "attention checks answered", "", "number"),
            sheet_column("checks_failed", "attention checks failed", "", "number"),
            sheet_column("failed", "which attention checks were failed", "", "numbers from 1, with spaces between"),
            sheet_column("is_over", "whether more failed than Prolific's rule lets pass", "", YES_NO_VALUES),
            sheet_column("in_everybody", "whether the answers are in the main figures", "", YES_NO_VALUES),
            sheet_column(
                "in_finished",
                "whether they are in the figures of those who finished and passed",
                "",
                YES_NO_VALUES,
            ),
            sheet_column("consent", "hash of what was consented to", "", "text"),
        ];
        let mut sheet = DataSheet::new("submissions.csv", "a participant who consented and was not forgotten", columns);
        let mut people: Vec<&Participant> = self.data.participants.iter().collect();
        people.sort_by_key(|person| self.names.name_for_id(&person.id));
        let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for slot in self.data.slots.iter().filter(|slot| slot.position.is_some()) {
            let (given, answered) = counts.entry(&slot.participant).or_default();
            *given += 1;
            *answered += usize::from(slot.state == SlotState::Answered);
        }
        let slot_counts = |person: &Participant| counts.get(person.id.as_str()).copied().unwrap_or_default();
        sheet.rows = people.into_iter().map(|person| self.submission_row(person, slot_counts(person))).collect();
        sheet
    }

    fn submission_row(&self, person: &Participant, (given, done): (usize, usize)) -> Vec<SheetCell> {
        let failed: Vec<String> =
            person.attention.iter().filter(|check| !check.passed).map(|check| (check.number + 1).to_string()).collect();
        let since = |at_ms| SheetCell::Number(seconds_between(person.consented_ms, at_ms), 3);
        let is_in =
            |filter: ParticipantFilter| SheetCell::yes_or_no(filter.accepts_participant(person, self.most_failed));
        vec![
            SheetCell::text(self.names.name_for_id(&person.id)),
            SheetCell::text(person.status.name()),
            SheetCell::Whole(i64::from(person.expected)),
            SheetCell::count(given),
            SheetCell::count(done),
            person.finished_ms.map_or(SheetCell::Empty, since),
            since(person.seen_ms),
            SheetCell::Whole(i64::from(person.misunderstood)),
            SheetCell::yes_or_no(person.understood),
            person.recruiter_status.clone().map_or(SheetCell::Empty, SheetCell::text),
            SheetCell::count(person.attention.len()),
            SheetCell::count(failed.len()),
            SheetCell::text(failed.join(" ")),
            SheetCell::yes_or_no(failed.len() > self.most_failed),
            is_in(ParticipantFilter::Everybody),
            is_in(ParticipantFilter::Finished),
            SheetCell::text(&person.consent),
        ]
    }

    fn end_sheet(&self) -> DataSheet {
        let columns = vec![
            sheet_column("participant", "the participant", "", "p001 and so on"),
            sheet_column("question", "the name of a question at the end, as in study.toml", "", "a name"),
            sheet_column("number", "which answer was chosen, or which level", "", "number from 1; empty for a text"),
            sheet_column(
                "answer",
                "the words of the answer, or what the participant wrote",
                "",
                "text; an apostrophe in front is not the participant's: take one away; empty if left out",
            ),
        ];
        let mut sheet = DataSheet::new("end.csv", "an answer to a question at the end", columns);
        let mut people: Vec<&Participant> = self.data.participants.iter().collect();
        people.sort_by_key(|person| self.names.name_for_id(&person.id));
        for (person, given) in people.iter().flat_map(|person| person.end.iter().map(move |given| (person, given))) {
            sheet.rows.push(vec![
                SheetCell::text(self.names.name_for_id(&person.id)),
                SheetCell::text(&given.name),
                given.number.map_or(SheetCell::Empty, SheetCell::count),
                SheetCell::text(&given.answer),
            ]);
        }
        sheet
    }

    fn item_sheet(&self, people: &ParticipantSummary) -> DataSheet {
        let columns = vec![
            sheet_column("item", "the item", "", "number from 0"),
            sheet_column("route", "the route's name in the dataset or run", "", "text"),
            sheet_column("scene", "the scene", "", "text"),
            sheet_column("text_number", "which of the item's texts; an item of two texts has two lines", "", "1 or 2"),
            sheet_column("condition", "the condition of the text", "", "text"),
            sheet_column("kind", "what the condition is", "", "run, people, other-path"),
            sheet_column("text", "the text that people were given", "", "text"),
            sheet_column("marks", "how often words of it were marked for people to doubt", "", "number"),
            sheet_column("given", "how often it was given", "", "number"),
            sheet_column("answered", "how often it was answered", "", "number"),
            sheet_column("returned", "how often it went back unanswered", "", "number"),
            sheet_column("live", "how many people still have it", "", "number"),
        ];
        let mut sheet = DataSheet::new("items.csv", "a text of an item; practice is left out", columns);
        let items = self.data.items.iter().filter(|item| !item.is_practice);
        for (item, handed) in items.zip(&people.by_item) {
            let route = self.data.routes.get(item.route as usize);
            for (number, item_text) in (1..).zip(&item.texts) {
                let kind = self.data.plan.conditions.iter().find(|condition| condition.name == item_text.condition);
                sheet.rows.push(vec![
                    SheetCell::Whole(i64::from(item.id)),
                    route.map_or(SheetCell::Empty, |route| SheetCell::text(&route.name)),
                    route.map_or(SheetCell::Empty, |route| SheetCell::text(route.scene.as_str())),
                    SheetCell::Whole(number),
                    SheetCell::text(&item_text.condition),
                    kind.map_or(SheetCell::Empty, |condition| SheetCell::text(kind_name(condition.kind))),
                    SheetCell::text(&item_text.text),
                    SheetCell::Whole(i64::try_from(item_text.marks.len()).unwrap_or(i64::MAX)),
                    SheetCell::count(handed.given),
                    SheetCell::count(handed.answered),
                    SheetCell::count(handed.returned),
                    SheetCell::count(handed.live),
                ]);
            }
        }
        sheet
    }
}

/// The cells with the metrics of a walk, in the order of their columns.
fn walk_figure_cells(one: &AnsweredItem<'_>) -> impl Iterator<Item = SheetCell> {
    let figure = |measure: &StudyMeasure| {
        let value = one.score.as_ref().and_then(|score| measure.walk_value(score));
        SheetCell::number(value, figure_digits(measure))
    };
    StudyMeasure::walk_measures().map(figure)
}

/// Number of digits after the point for a metric of a walk.
fn figure_digits(measure: &StudyMeasure) -> usize {
    match (measure.kind, measure.unit) {
        (MeasureKind::Share, _) => 0,
        (_, MeasureUnit::Metres) => 3,
        _ => 6,
    }
}

fn condition_column() -> SheetColumn {
    sheet_column("condition", "the condition of the text", "", "name of a condition")
}

fn level_columns(scales: &[RatingScale]) -> impl Iterator<Item = SheetColumn> {
    let levels = |scale: &RatingScale| {
        let levels: Vec<String> =
            (1..).zip(scale.levels).map(|(number, word): (u8, &str)| format!("{number} {word}")).collect();
        levels.join(", ")
    };
    scales.iter().map(move |scale| sheet_column(scale.name, scale.text, "level", &levels(scale)))
}

fn follow_columns() -> Vec<SheetColumn> {
    let walk_column = |measure: &'static StudyMeasure| {
        let values = match figure_digits(measure) {
            0 => YES_NO_VALUES,
            3 => "number; empty where there is no way",
            _ => "0 to 1",
        };
        sheet_column(
            measure.name,
            measure.meaning,
            if measure.unit == MeasureUnit::Metres { "metres" } else { "" },
            values,
        )
    };
    let mut columns = vec![condition_column()];
    columns.extend(StudyMeasure::walk_measures().map(walk_column));
    columns.extend([
        sheet_column("moves", "moves from one viewpoint to the next", "", "number"),
        sheet_column("looks", "turns to look, as the page counted them", "", "number"),
        sheet_column("presses", "moves and looks", "", "number"),
    ]);
    columns.extend(level_columns(&crate::wording::FOLLOW_STATEMENTS));
    columns.extend([
        sheet_column(
            "window_width",
            "width of the window, to the nearest 50",
            "CSS pixels",
            "number; empty if not measured",
        ),
        sheet_column(
            "window_height",
            "height of the window, to the nearest 50",
            "CSS pixels",
            "number; empty if not measured",
        ),
        sheet_column("pixel_ratio", "pixels of the screen for each CSS pixel", "", "1 to 4; empty if not measured"),
        sheet_column("touch", "whether the screen is used by touch", "", "yes or no; empty if not measured"),
    ]);
    columns
}

/// The cells of the window in which a walk was shown.
fn window_cells(window: Option<WindowSize>) -> [SheetCell; 4] {
    let number = |of: fn(&WindowSize) -> u32| {
        window.as_ref().map_or(SheetCell::Empty, |window| SheetCell::Whole(i64::from(of(window))))
    };
    [
        number(|window| window.width_px),
        number(|window| window.height_px),
        number(|window| window.pixel_ratio),
        window.map_or(SheetCell::Empty, |window| SheetCell::yes_or_no(window.has_touch)),
    ]
}

fn rate_columns() -> Vec<SheetColumn> {
    let mut columns = vec![condition_column()];
    columns.extend(level_columns(&crate::wording::RATE_QUESTIONS));
    columns.push(pictures_column());
    let prefix = "text; an apostrophe in front is not the participant's: take one away";
    columns.push(sheet_column("own_text", "what the participant wrote before seeing the text", "", prefix));
    columns
}

fn pair_columns() -> Vec<SheetColumn> {
    vec![
        sheet_column("condition_a", "the condition of the text shown as A", "", "name of a condition"),
        sheet_column("condition_b", "the condition of the text shown as B", "", "name of a condition"),
        sheet_column("choice", "what was chosen", "", "a, b, tie (about equal), bad (both are)"),
        sheet_column(
            "preferred",
            "the condition of the text that was preferred",
            "",
            "name of a condition; empty without a preference",
        ),
        pictures_column(),
    ]
}

fn pictures_column() -> SheetColumn {
    let values = "number; empty where the page could not count";
    sheet_column("pictures_seen", "how many different pictures of the film were seen, as the page counted", "", values)
}

fn choice_word(choice: PairChoice) -> &'static str {
    match choice {
        PairChoice::A => "a",
        PairChoice::B => "b",
        PairChoice::Tie => "tie",
        PairChoice::Bad => "bad",
    }
}

/// The kind of a condition, as the plan writes it.
pub(super) fn kind_name(kind: ConditionKind) -> &'static str {
    match kind {
        ConditionKind::Run => "run",
        ConditionKind::People => "people",
        ConditionKind::OtherPath => "other-path",
        ConditionKind::Corrupted => "corrupted",
    }
}
