//! Chooses the views to caption: those along random paths or episodes, each once, if the platform has labels for them.

use std::collections::BTreeSet;
use wayword_checks::{Evidence, SeenThing};
use wayword_core::{Frame, Gaze, Path, Platform, PlatformError, SceneId, View};
use wayword_run::{count::count, error::Error, item::Item, plan::Plan, settings::Settings};
use wayword_synthesis::observe::gazes;

/// A view with the things that its labels name.
pub(super) struct Labelled {
    pub(super) scene: SceneId,
    pub(super) view: View,
    pub(super) labels: Vec<SeenThing>,
}

/// The first `most` views with labels, in the order of the paths.
pub(super) fn labelled_views(plan: &Plan<'_>, most: usize) -> Result<Vec<Labelled>, Error> {
    let (settings, platform) = (&plan.job.settings, plan.platform);
    let mut views = Vec::new();
    let mut looked_at = BTreeSet::new();
    let mut blind = 0;
    'paths: for item in &plan.items {
        let Some(path) = path(item, settings, platform)? else { continue };
        let looks = path
            .frames
            .iter()
            .flat_map(|frame| gazes(frame, settings.frames).into_iter().map(move |gaze| (frame, gaze)));
        for (frame, gaze) in looks {
            if views.len() == most {
                break 'paths;
            }
            let place = (path.scene.clone(), frame.place(), micro_rad(gaze));
            if !looked_at.insert(place) {
                continue;
            }
            match labelled(platform, &path, frame, gaze)? {
                Some(view) => views.push(view),
                None => blind += 1,
            }
        }
    }
    if views.is_empty() {
        return Err(Error::usage(
            format!("none of {} has labels to check a caption against", count(blind, "view")),
            "give a platform or data folder with labels, or other --episodes or --scan",
        ));
    }
    Ok(views)
}

/// An item's path; `None` if its scene has no path of the kind that was asked for.
pub(super) fn path(item: &Item, settings: &Settings, platform: &dyn Platform) -> Result<Option<Path>, Error> {
    match item.path(settings, platform) {
        Ok(path) => Ok(Some(path)),
        Err(PlatformError::NoSuchPath { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn micro_rad(gaze: Gaze) -> u64 {
    (gaze.heading.rad() * 1e6).round() as u64
}

fn labelled(platform: &dyn Platform, path: &Path, frame: &Frame, gaze: Gaze) -> Result<Option<Labelled>, Error> {
    let view = platform.look(&path.scene, frame, gaze)?;
    let one = Path { frames: vec![frame.clone()], ..path.clone() };
    let evidence = Evidence::from_labels(&one, &[vec![view.clone()]]);
    let labels = evidence.and_then(|evidence| evidence.frames.into_iter().next()).map(|frame| frame.things);
    let labels = labels.filter(|labels| !labels.is_empty());
    Ok(labels.map(|labels| Labelled { scene: path.scene.clone(), view, labels }))
}
