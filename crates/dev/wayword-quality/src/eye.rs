//! Measures whether the dialogue removes hallucinated objects: counts them in captions and in instructions, for each way of asking a
//! scripted, flawed model about the pictures.

use crate::stage::{CARELESSNESS, Stage, World};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::Platform;
use wayword_experiments::perceive::{Extent, perceive};
use wayword_language::reading::{What, read};
use wayword_run::{
    error::Error,
    output::Output,
    pipeline::{Made, panoramas},
    settings::{Job, Perception, Settings},
};
use wayword_synthesis::repair::Outcome;

/// Counts of the objects that instructions name, and of those that no label along the path confirms.
#[derive(Debug, Default)]
pub(super) struct Named {
    pub(super) texts: usize,
    pub(super) rejected: usize,
    finished_by_rules: usize,
    pub(super) objects: usize,
    pub(super) hallucinated: usize,
    pub(super) with_hallucinations: usize,
}

pub fn measure(
    world: &World,
    views: usize,
    paths: usize,
    hallucinated_share: f64,
    output: &Output,
) -> Result<(), Error> {
    let stage = Stage::new(world, hallucinated_share)?;
    let ways = [Perception::Fixed, Perception::Single, Perception::Dialogue];
    let extent = Extent { views, show: 0 };
    let captions = perceive(&stage.world, &stage.job(views)?, extent, &ways, output)?;
    let mut lines = vec![
        format!(
            "{} views of {}, and instructions for {paths} paths; a scripted eye that names {:.0} % hallucinated objects and denies 70 % of \
             them when it is asked about one; scripted text roles that err with {:.0} %",
            captions.views,
            captions.platform,
            100.0 * hallucinated_share,
            100.0 * CARELESSNESS
        ),
        "asked     caption: hallucinated  with one  precision  recall  calls/view | instruction: hallucinated  with one  by rules  rejected"
            .to_owned(),
    ];
    for row in &captions.rows {
        let job = stage.job(paths)?;
        let job = Job { settings: Settings { perception: row.perception, ..job.settings }, ..job };
        let mut named = Named::default();
        for made in stage.make(&job)?.0 {
            named.count(&made?, &stage.world)?;
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
    output.data(&(), lines.join("\n"));
    Ok(())
}

impl Named {
    pub(super) fn count(&mut self, made: &Made, world: &dyn Platform) -> Result<(), Error> {
        let panoramas = panoramas(world, &made.walk.path)?;
        let Some(labels) = Evidence::from_labels(&made.walk.path, &panoramas) else { return Ok(()) };
        for outcome in &made.outcomes {
            let Outcome::Accepted(instruction) = outcome else {
                self.rejected += 1;
                continue;
            };
            self.texts += 1;
            self.finished_by_rules += usize::from(instruction.provenance.finished_for.is_some());
            let reading = read(&instruction.text, &BTreeSet::new());
            let things = reading.events.iter().filter_map(|event| match &event.what {
                What::Place(place) if place.is_thing && !place.is_room => Some(place.name.as_str()),
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
    use crate::made_up::{Building, instruction};
    use wayword_run::{item::items, platforms};
    use wayword_synthesis::walk::Walk;

    /// A path of the made-up building from the entryway, which has a bench, with these outcomes.
    fn counted(outcomes: Vec<Outcome>) -> Named {
        let building = Building::new();
        let stage = Stage::new(&building.world(), 0.15).unwrap();
        let mut settings = stage.job(1).unwrap().settings;
        settings.episodes = Some(building.data().join("reverie/REVERIE_val_seen.json"));
        let world = platforms::open_named("matterport", Some(&building.data()), None, None).unwrap();
        let first = items(&settings, world.as_ref()).unwrap().remove(0);
        let path = first.path(&settings, world.as_ref()).unwrap();
        let made = Made { walk: Walk::new(path, Vec::new()), outcomes, pictures: Vec::new() };
        let mut named = Named::default();
        named.count(&made, world.as_ref()).unwrap();
        named
    }

    /// Of three objects that two texts name, a piano is nowhere in the building.
    #[test]
    fn an_object_that_no_label_along_the_path_confirms_is_hallucinated() {
        let text = |text: &str| Outcome::Accepted(instruction("r2r", text, &[]));
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
        let mut finished = instruction("r2r", "Walk past the bench.", &[]);
        finished.provenance.finished_for = Some("server/words".into());
        let named = counted(vec![
            Outcome::Accepted(finished),
            Outcome::Rejected { last: None, reason: "there is no text".into() },
        ]);
        assert_eq!((named.texts, named.rejected, named.finished_by_rules), (1, 1, 1), "{named:?}");
    }
}
