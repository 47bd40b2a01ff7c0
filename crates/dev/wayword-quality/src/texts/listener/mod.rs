//! Checks whether a text pins its target down, as a listener would who knows the labels of a building: it reads the description of the
//! target and looks for the objects that fit it. A good text fits only the target.
//!
//! The listener's grammar and geometry are independent of the writer's, so that errors of one are not hidden by the other.

mod clauses;
mod denial;
mod fits;
mod phrases;
mod scene;
mod target_description;
mod vocabulary;

use super::row::{TextFigureRow, share_row};
use fits::{ListenerArrival, TargetListener};
use scene::ListenerScene;
use serde::Serialize;
use std::collections::BTreeMap;
use wayword_core::{Platform, SceneId, ViewpointSurvey};
use wayword_formats::Episode;
use wayword_run::error::CommandError;
use wayword_world::path_over_viewpoints;

/// The listener's result for one text.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct ListenerResult {
    /// The id of the item.
    pub(super) item: String,
    /// The text.
    pub(super) text: String,
    /// Whether the text names the target.
    is_named: bool,
    /// How many objects fit the description.
    fitting: usize,
    /// Whether the target is among them.
    fits_target: bool,
    /// The part of the description that contradicts the target's geometry.
    denied: Option<&'static str>,
    /// Whether the description has words that labels cannot judge, such as a colour.
    has_look: bool,
    /// Whether another object with the target's name is in view at the end.
    has_namesake: bool,
    /// Whether the text has any word that could distinguish the target from its namesakes.
    has_distinction: bool,
    /// Whether a namesake in view fits as well.
    fits_namesake: bool,
}

impl ListenerResult {
    /// Whether only the target fits, and its geometry contradicts no part of the description.
    pub(super) fn is_pinned(&self) -> bool {
        self.fits_target && self.fitting == 1 && self.denied.is_none()
    }

    /// Whether only another object fits, or the target's geometry contradicts the description.
    fn is_falsely_pinned(&self) -> bool {
        self.denied.is_some() || self.pins_another()
    }

    /// Whether the text names the target, but only another object fits.
    fn pins_another(&self) -> bool {
        self.is_named && !self.fits_target && self.fitting == 1
    }

    /// The reason why the target is not pinned down, in words.
    pub(super) fn describe_fault(&self) -> String {
        match self.denied {
            Some(what) => format!("{what} denied"),
            None if self.pins_another() => "another object fits".to_owned(),
            None if !self.is_named => "the target is not named".to_owned(),
            None if !self.has_distinction && self.has_namesake => {
                format!("{} objects fit, no distinction", self.fitting)
            }
            None => format!("{} objects fit", self.fitting),
        }
    }
}

/// The listener's results for all texts of episodes that have a target and a path in one of the surveyed scenes.
pub(super) fn hear_episodes(
    platform: &dyn Platform,
    surveys: &BTreeMap<SceneId, ViewpointSurvey>,
    episodes: &[Episode],
) -> Result<Vec<ListenerResult>, CommandError> {
    let mut by_scene: BTreeMap<&SceneId, Vec<&Episode>> = BTreeMap::new();
    for episode in episodes.iter().filter(|episode| episode.target_object.is_some()) {
        by_scene.entry(&episode.scene).or_default().push(episode);
    }
    let mut heard = Vec::new();
    for (scene, episodes) in by_scene {
        let Some(survey) = surveys.get(scene) else { continue };
        let top_level = survey.viewpoints().iter().filter_map(|viewpoint| viewpoint.level).max();
        let known = ListenerScene::from_survey(survey);
        for episode in episodes {
            let path =
                path_over_viewpoints(platform, &*episode.id, scene, &episode.viewpoints, episode.start_heading, None)?;
            let target = known.objects.iter().position(|object| Some(&object.id) == episode.target_object.as_ref());
            let last = path.frames.last();
            let at = last.and_then(|frame| known.viewpoint_index(frame.viewpoint.as_ref()?.as_str()));
            let (Some(target), Some(at), Some(last)) = (target, at, last) else { continue };
            let start_level = path.frames.first().and_then(|frame| frame.level);
            let arrival =
                ListenerArrival { at, eye: last.pose.position, heading: last.pose.heading, start_level, top_level };
            let hear =
                |text: &String| ListenerResult { item: episode.id.clone(), ..hear_text(&known, arrival, target, text) };
            heard.extend(episode.instructions.iter().map(hear));
        }
    }
    Ok(heard)
}

/// Reads the description of the target in a text, and compares it with the target, with all objects of the scene, and with the
/// namesakes in view at the end.
fn hear_text(scene: &ListenerScene, arrival: ListenerArrival, target: usize, text: &str) -> ListenerResult {
    let mut heard = ListenerResult { text: text.to_owned(), ..ListenerResult::default() };
    let description = target_description::describe_target(text, &scene.names).unwrap_or_default();
    let listener = TargetListener { scene, described_target: &description, arrival };
    let namesakes = listener.namesakes_in_view(target);
    heard.has_namesake = !namesakes.is_empty();
    heard.is_named = scene.objects_called(&description.name).any(|object| object == target);
    if !heard.is_named {
        return heard;
    }
    let matches = listener.fitting_objects();
    let fitting = matches.objects;
    heard.fitting = fitting.len();
    heard.fits_target = fitting.contains(&target);
    heard.denied = listener.denied_part(target);
    // Words that the listener had to leave out cannot be judged by labels either.
    heard.has_look = description.has_look || matches.left_out > 0;
    heard.has_distinction = heard.has_look
        || !description.relations.is_empty()
        || !description.ranks.is_empty()
        || description.side.is_some();
    heard.fits_namesake = heard.fits_target && !fitting.is_disjoint(&namesakes);
    heard
}

/// The rows of the table about targets.
pub(super) fn listener_rows(heard: &[ListenerResult]) -> Vec<TextFigureRow> {
    let of_all = |name: &str, counts: &dyn Fn(&ListenerResult) -> bool| share_row(name, heard.iter().map(counts));
    let with_namesake = |name: &str, counts: &dyn Fn(&ListenerResult) -> bool| {
        share_row(name, heard.iter().filter(|heard| heard.has_namesake).map(counts))
    };
    vec![
        of_all("the target is named", &|heard| heard.is_named),
        of_all("pinned down: it alone fits, by labels", &ListenerResult::is_pinned),
        of_all("pinned down, or with a word that labels cannot judge", &|heard| {
            heard.is_pinned() || heard.has_look && heard.fits_target && heard.denied.is_none()
        }),
        of_all("falsely pinned", &ListenerResult::is_falsely_pinned),
        of_all("  the geometry denies what is said of it", &|heard| heard.denied.is_some()),
        of_all("  another object alone fits", &|heard| heard.denied.is_none() && heard.pins_another()),
        of_all("a namesake in view at the end", &|heard| heard.has_namesake),
        with_namesake("  of these, no word tells them apart", &|heard| !heard.has_distinction),
        with_namesake("  of these, the namesake fits too", &|heard| heard.fits_namesake && !heard.has_look),
    ]
}
