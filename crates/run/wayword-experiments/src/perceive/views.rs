//! Chooses the views to caption: those along random paths or episodes, each once, if the platform has labels for them.

use std::collections::BTreeSet;
use wayword_checks::{Evidence, SeenThing};
use wayword_core::{Frame, Path, Platform, PlatformError, SceneId, View, ViewGaze};
use wayword_run::{count::count_phrase, error::CommandError, item::RunItem, plan::RunPlan, settings::RunSettings};
use wayword_synthesis::observe::frame_gazes;

/// A view with the things that its labels name.
pub(super) struct LabelledView {
    pub(super) scene: SceneId,
    pub(super) view: View,
    pub(super) labels: Vec<SeenThing>,
}

/// The first `max_views` views with labels, in the order of the paths.
pub(super) fn labelled_views(plan: &RunPlan<'_>, max_views: usize) -> Result<Vec<LabelledView>, CommandError> {
    let (settings, platform) = (&plan.job.settings, plan.platform);
    let mut views = Vec::new();
    let mut looked_at = BTreeSet::new();
    let mut views_without_labels = 0;
    'paths: for item in &plan.items {
        let Some(path) = item_path(item, settings, platform)? else { continue };
        let looks = path
            .frames
            .iter()
            .flat_map(|frame| frame_gazes(frame, settings.frames).into_iter().map(move |gaze| (frame, gaze)));
        for (frame, gaze) in looks {
            if views.len() == max_views {
                break 'paths;
            }
            let place = (path.scene.clone(), frame.place_key(), micro_rad(gaze));
            if !looked_at.insert(place) {
                continue;
            }
            match labelled_view(platform, &path, frame, gaze)? {
                Some(view) => views.push(view),
                None => views_without_labels += 1,
            }
        }
    }
    if views.is_empty() {
        return Err(CommandError::usage(
            format!("none of {} has labels to check a caption against", count_phrase(views_without_labels, "view")),
            "give a platform or data folder with labels, or other --episodes or --scan",
        ));
    }
    Ok(views)
}

/// An item's path; `None` if its scene has no path of the kind that was asked for.
pub(super) fn item_path(
    item: &RunItem,
    settings: &RunSettings,
    platform: &dyn Platform,
) -> Result<Option<Path>, CommandError> {
    match item.find_path(settings, platform) {
        Ok(path) => Ok(Some(path)),
        Err(PlatformError::NoSuchPath { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// The heading of a gaze in whole microradians, which can be compared exactly.
fn micro_rad(gaze: ViewGaze) -> u64 {
    (gaze.heading.rad() * 1e6).round() as u64
}

/// The view from a frame with its labels; `None` if the platform has none for it.
fn labelled_view(
    platform: &dyn Platform,
    path: &Path,
    frame: &Frame,
    gaze: ViewGaze,
) -> Result<Option<LabelledView>, CommandError> {
    let view = platform.look_from(&path.scene, frame, gaze)?;
    let single_frame = Path { frames: vec![frame.clone()], ..path.clone() };
    let evidence = Evidence::from_labels(&single_frame, &[vec![view.clone()]]);
    let labels = evidence.and_then(|evidence| evidence.frames.into_iter().next()).map(|frame| frame.things);
    let labels = labels.filter(|labels| !labels.is_empty());
    Ok(labels.map(|labels| LabelledView { scene: path.scene.clone(), view, labels }))
}
