//! Measures whether the dialogue removes hallucinated objects: counts them in captions and in instructions, for each way of asking a
//! scripted, flawed model about the pictures.

use crate::stage::{MeasuredWorldArgs, MeasurementStage, TEXT_ROLE_ERROR_SHARE};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::Platform;
use wayword_experiments::perceive::{MeasurementExtent, measure_perception};
use wayword_language::reading::{EventContent, read_instruction};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    pipeline::{MadeItem, path_panoramas},
    settings::{Perception, RunJob, RunSettings},
};
use wayword_synthesis::repair::WritingOutcome;

/// Counts of the objects that instructions name, and of those that no label along the path confirms.
#[derive(Debug, Default)]
pub(super) struct NamedObjectCounts {
    /// Texts that were accepted.
    pub(super) texts: usize,
    /// Texts that were rejected.
    pub(super) rejected: usize,
    /// Accepted texts that rules finished, because the model's text failed.
    finished_by_rules: usize,
    /// Objects that the labels confirm or deny.
    pub(super) objects: usize,
    /// Those among them that the labels deny.
    pub(super) hallucinated: usize,
    /// Texts with at least one denied object.
    pub(super) with_hallucinations: usize,
}

/// Prints how many hallucinated objects captions and instructions have, for each way of asking a flawed eye.
///
/// # Errors
/// When the platform cannot be opened, a view cannot be had, or an item fails.
pub fn measure_eye(
    world: &MeasuredWorldArgs,
    views: usize,
    paths: usize,
    hallucinated_share: f64,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let stage = MeasurementStage::new(world, hallucinated_share)?;
    let ways = [Perception::Fixed, Perception::Single, Perception::Dialogue];
    let extent = MeasurementExtent { views, show: 0 };
    let captions = measure_perception(&stage.world, &stage.writing_job(views)?, extent, &ways, output)?;
    let mut lines = vec![
        format!(
            "{} views of {}, and instructions for {paths} paths; a scripted eye that names {:.0} % hallucinated objects and denies 70 % of \
             them when it is asked about one; scripted text roles that err with {:.0} %",
            captions.views,
            captions.platform,
            100.0 * hallucinated_share,
            100.0 * TEXT_ROLE_ERROR_SHARE
        ),
        "asked     caption: hallucinated  with one  precision  recall  calls/view | instruction: hallucinated  with one  by rules  rejected"
            .to_owned(),
    ];
    for row in &captions.rows {
        let job = stage.writing_job(paths)?;
        let job = RunJob { settings: RunSettings { perception: row.perception, ..job.settings }, ..job };
        let mut named = NamedObjectCounts::default();
        for made in stage.make_items(&job)?.0 {
            named.count_item(&made?, &stage.world)?;
        }
        lines.push(format!(
            "{:<9}{:>21.1}% {:>8.1}% {:>9.1}% {:>6.1}% {:>11.1} | {:>24.1}% {:>8.1}% {:>9} {:>9}",
            format!("{:?}", row.perception).to_lowercase(),
            100.0 * row.hallucination_rate,
            100.0 * row.captions_with_hallucinations,
            100.0 * row.precision,
            100.0 * row.recall,
            row.calls_per_view,
            100.0 * named.hallucinated as f64 / named.objects.max(1) as f64,
            100.0 * named.with_hallucinations as f64 / named.texts.max(1) as f64,
            named.finished_by_rules,
            named.rejected
        ));
    }
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

impl NamedObjectCounts {
    /// Counts the objects in all texts of an item. Without labels, nothing is counted.
    pub(super) fn count_item(&mut self, made: &MadeItem, world: &dyn Platform) -> Result<(), CommandError> {
        let panoramas = path_panoramas(world, &made.walk.path)?;
        let Some(labels) = Evidence::from_labels(&made.walk.path, &panoramas) else { return Ok(()) };
        for outcome in &made.outcomes {
            let WritingOutcome::Accepted(instruction) = outcome else {
                self.rejected += 1;
                continue;
            };
            self.texts += 1;
            self.finished_by_rules += usize::from(instruction.provenance.finished_for.is_some());
            let reading = read_instruction(&instruction.text, &BTreeSet::new());
            let things = reading.events.iter().filter_map(|event| match &event.what {
                EventContent::Place(place) if place.is_thing && !place.is_room => Some(place.name.as_str()),
                _ => None,
            });
            // An object that the labels neither confirm nor deny is not counted at all.
            let (real, others): (Vec<&str>, Vec<&str>) =
                things.partition(|name| !labels.frames_with_thing(name).is_empty());
            let hallucinated = others.iter().filter(|name| labels.denies_thing(name)).count();
            self.objects += real.len() + hallucinated;
            self.hallucinated += hallucinated;
            self.with_hallucinations += usize::from(hallucinated > 0);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::{TestBuildingFolder, test_instruction};
    use wayword_run::{item::run_items, platforms};
    use wayword_synthesis::walk::ObservedWalk;

    /// A path of the made-up building from the entryway, which has a bench, with these outcomes.
    fn counted(outcomes: Vec<WritingOutcome>) -> NamedObjectCounts {
        let building = TestBuildingFolder::new();
        let stage = MeasurementStage::new(&building.matterport_world(), 0.15).unwrap();
        let mut settings = stage.writing_job(1).unwrap().settings;
        settings.episodes = Some(building.data_folder().join("reverie/REVERIE_val_seen.json"));
        let world = platforms::open_named("matterport", Some(&building.data_folder()), None, None).unwrap();
        let first = run_items(&settings, world.as_ref()).unwrap().remove(0);
        let path = first.find_path(&settings, world.as_ref()).unwrap();
        let walk = ObservedWalk::new(path, Vec::new());
        let made = MadeItem { walk, outcomes, costs: Vec::new(), pictures: Vec::new(), used: None };
        let mut named = NamedObjectCounts::default();
        named.count_item(&made, world.as_ref()).unwrap();
        named
    }

    /// Of three objects that two texts name, a piano is nowhere in the building.
    #[test]
    fn an_object_that_no_label_along_the_path_confirms_is_hallucinated() {
        let text = |text: &str| WritingOutcome::Accepted(test_instruction("r2r", text, &[]));
        let named = counted(vec![
            text("Walk past the bench. Stop at the piano."),
            text("Walk past the bench. Stop in the hallway."),
        ]);
        assert_eq!(
            (named.texts, named.objects, named.hallucinated, named.with_hallucinations),
            (2, 3, 1, 1),
            "{named:?}"
        );
        assert_eq!((named.rejected, named.finished_by_rules), (0, 0));
    }

    #[test]
    fn texts_that_were_rejected_or_that_rules_finished_are_counted_apart() {
        let mut finished = test_instruction("r2r", "Walk past the bench.", &[]);
        finished.provenance.finished_for = Some("server/words".into());
        let named = counted(vec![
            WritingOutcome::Accepted(finished),
            WritingOutcome::Rejected { last: None, reason: "there is no text".into(), drafts: Vec::new() },
        ]);
        assert_eq!((named.texts, named.rejected, named.finished_by_rules), (1, 1, 1), "{named:?}");
    }
}
