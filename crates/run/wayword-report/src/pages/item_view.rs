//! One item as the template shows it: its path, map, texts and frames.

use super::{
    frames::{FrameView, frame_views},
    item_record::ItemRecord,
    link_targets::{LinkTargets, item_anchor},
    map::{BADGE_RADIUS, MapView},
    pictures::PagePictures,
    texts::{TextView, text_views},
};
use serde::Serialize;
use wayword_core::{ObjectDistinction, PathTarget};
use wayword_run::{check::CheckedAgain, run_folder::ItemCalls};

/// Most frames of an item that are shown.
const MAX_ITEM_FRAMES: usize = 200;

/// The template's values for an item.
#[derive(Debug, Serialize)]
pub(super) struct ItemView {
    /// From 1.
    pub(super) number: usize,
    /// The anchor of its heading on the page.
    pub(super) anchor: String,
    id: String,
    scene: String,
    /// Metres; `None` if the recording has no poses.
    length_m: Option<String>,
    target: Option<String>,
    levels: Option<String>,
    /// The answers of models that it used.
    used: Option<String>,
    map: Option<MapView>,
    map_radius: f64,
    map_stop: &'static str,
    map_words: String,
    texts: Vec<TextView>,
    originals: Vec<String>,
    frames: Vec<FrameView>,
    frames_left_out: usize,
}

impl ItemView {
    /// An item with its pictures; `number` from 1.
    pub(super) fn new(
        number: usize,
        record: &ItemRecord,
        again: &CheckedAgain,
        pictures: &mut PagePictures<'_>,
    ) -> Self {
        let (path, anchor) = (&record.walk.path, item_anchor(number));
        let shown = path.frames.len().min(MAX_ITEM_FRAMES);
        let map = MapView::new(path, &record.walk.map, shown);
        let texts = text_views(record, again, LinkTargets { item: &anchor, frames: path.frames.len(), shown });
        let frames = frame_views(&record.walk, &anchor, shown, pictures);
        let length_m = path.length_m().map(|length_m| format!("{length_m:.1}"));
        Self {
            number,
            id: path.id.clone(),
            scene: path.scene.to_string(),
            target: path.target.as_ref().map(target_words),
            levels: level_words(path.frames.iter().filter(|_| path.motion.is_known()).filter_map(|frame| frame.level)),
            used: record.walk.used.as_ref().map(used_words),
            map_words: length_m.as_ref().map_or_else(String::new, |length_m| {
                format!("Map of the path from frame 0 to frame {}, {length_m} m, north up", shown.saturating_sub(1))
            }),
            length_m,
            map,
            map_radius: BADGE_RADIUS,
            map_stop: "Frame",
            texts,
            originals: record.walk.originals.clone(),
            frames,
            frames_left_out: path.frames.len() - shown,
            anchor,
        }
    }
}

fn used_words(used: &ItemCalls) -> String {
    let ItemCalls { answers, tokens_in, tokens_out, usd, .. } = used;
    let usd = if *usd > 0.0 { format!(", ${usd:.4}") } else { String::new() };
    format!("{answers} answers of models: {tokens_in} tokens in, {tokens_out} out{usd}")
}

fn level_words(levels: impl Iterator<Item = u32> + Clone) -> Option<String> {
    let (low, high) = (levels.clone().min()?, levels.max()?);
    Some(if low == high { format!("storey {low}") } else { format!("storeys {low} to {high}") })
}

fn target_words(target: &PathTarget) -> String {
    let distinctions: Vec<String> = target.told_by.iter().take(3).map(ObjectDistinction::to_predicate).collect();
    let name = &target.name;
    match (distinctions.is_empty(), target.has_namesake) {
        (true, false) => name.clone(),
        (true, true) => format!("{name} (one of several)"),
        (false, _) => format!("{name} ({})", distinctions.join(", ")),
    }
}
