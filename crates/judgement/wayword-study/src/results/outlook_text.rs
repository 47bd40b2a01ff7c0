//! Prints the outlook of a planned study.

use super::{
    PlannedPower, StudyOutlook, escape,
    number_format::{count_with_noun, format_number, format_percent},
    sheets::kind_name,
};
use crate::{ConditionKind, StudyTask};
use std::fmt;

impl fmt::Display for StudyOutlook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mode          {}", self.mode.name())?;
        writeln!(f, "items         {} on {}", self.items, count_with_noun(self.routes, "route", "routes"))?;
        for planned in &self.conditions {
            let kind = if planned.kind == ConditionKind::Run {
                String::new()
            } else {
                format!(" ({})", kind_name(planned.kind))
            };
            writeln!(f, "  {:<11} {}{kind}", planned.items, escape::to_table_name(&planned.condition))?;
        }
        let per_item = format_number(self.per_item, usize::from(self.per_item.fract() > 0.0));
        writeln!(f, "answers       {}: {per_item} of each item", self.answers)?;
        writeln!(
            f,
            "participants  {}, if all finish: {} each",
            self.participants,
            count_with_noun(self.per_participant, "item", "items")
        )?;
        writeln!(f, "minutes each  {}", self.minutes)?;
        self.write_power(f)?;
        if self.conditions.iter().all(|planned| planned.kind == ConditionKind::Run) && self.mode != StudyTask::Pair {
            writeln!(
                f,
                "\nThere is no control. --include original,other-path shows how well a good and a wrong text do."
            )?;
        }
        if self.per_participant == 1 {
            writeln!(f, "\nEach person gets one item: what persons do and what items do cannot be told apart.")?;
        }
        Ok(())
    }
}

impl StudyOutlook {
    /// What the study finds, one line for each assumption, and what the assumptions mean.
    fn write_power(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.assumptions.is_empty() {
            return writeln!(f, "\nThere are no two conditions to compare.");
        }
        let points = |share: f64| format!("{} points", format_number(100.0 * share, 0));
        let effect = format!("{} points", format_percent(self.effect));
        match self.mode {
            StudyTask::Pair => {
                writeln!(f, "\nTwo conditions; one is preferred {effect} more often than half of the time.")?;
            }
            StudyTask::Follow | StudyTask::Rate => {
                writeln!(
                    f,
                    "\nTwo conditions whose shares differ by {effect} around {} %.",
                    format_percent(self.base_share)
                )?;
            }
        }
        writeln!(
            f,
            "{} simulated studies each, with the intervals of `results` (95 %, clustered by persons and routes):\n",
            self.simulated_studies
        )?;
        writeln!(f, "persons  routes   studies that    found by 4 of 5   participants")?;
        writeln!(f, "differ   differ   find {effect:<10} studies           for {effect}")?;
        for assumption in &self.assumptions {
            writeln!(f, "{}", assumption_line(assumption, &points))?;
        }
        let error = self.assumptions.iter().filter_map(|one| one.power).map(|power| power.se).fold(0.0, f64::max);
        writeln!(
            f,
            "\nThe percentages are known to about {} points (two standard errors).",
            format_number(200.0 * error, 0)
        )?;
        writeln!(
            f,
            "\"Differ\" is a standard deviation on the logit scale: how much better or worse a condition suits one person, or one route, than\n\
             the others. At 0.5, a condition of 50 % has 38 to 62 % with two of three persons; at 1, 27 to 73 %. What a person or a route\n\
             does to both conditions alike cancels. Participants are for these {}: --routes tries another number.",
            count_with_noun(self.routes, "route", "routes")
        )
    }
}

/// A line of the table.
fn assumption_line(assumption: &PlannedPower, points: &impl Fn(f64) -> String) -> String {
    let power =
        assumption.power.map_or_else(|| "-".to_owned(), |found| format!("{} %", format_number(100.0 * found.power, 0)));
    let difference = assumption.difference.map_or_else(|| "none".to_owned(), points);
    let participants = assumption
        .participants
        .map_or_else(|| "more routes needed".to_owned(), |participants| participants.to_string());
    format!(
        "{:<8} {:<8} {power:<15} {difference:<17} {participants}",
        format!("{:.2}", assumption.person_sd),
        format!("{:.2}", assumption.route_sd)
    )
}
