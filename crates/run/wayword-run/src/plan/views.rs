//! Counts the different views along paths. Workers that share a ledger describe each of them only once, however many paths pass
//! it.

use std::{
    collections::BTreeSet,
    ops::{AddAssign, Sub},
};
use wayword_core::{Path, SceneId, ViewGaze, ViewpointId};
use wayword_synthesis::{observe::frame_gazes, walk::FrameSelection};

/// A place in a scene.
type ViewPlace = (SceneId, ([u64; 3], Option<ViewpointId>));

/// The views of some paths.
#[derive(Default)]
pub(super) struct DistinctViews {
    views: BTreeSet<(ViewPlace, i64)>,
    panoramas: BTreeSet<ViewPlace>,
}

/// How many views and panoramas differ.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct DistinctCounts {
    pub(super) views: u64,
    pub(super) panoramas: u64,
}

impl DistinctViews {
    /// Adds the views along a path.
    pub(super) fn add_path(&mut self, path: &Path, frames: FrameSelection) {
        for frame in &path.frames {
            let place = (path.scene.clone(), frame.place_key());
            self.views.extend(frame_gazes(frame, frames).iter().map(|gaze| (place.clone(), micro_rad(*gaze))));
            if frames == FrameSelection::Panoramic {
                self.panoramas.insert(place);
            }
        }
    }

    /// Counts the views and panoramas that were added.
    pub(super) fn count_distinct(&self) -> DistinctCounts {
        DistinctCounts { views: self.views.len() as u64, panoramas: self.panoramas.len() as u64 }
    }
}

impl AddAssign for DistinctCounts {
    fn add_assign(&mut self, other: Self) {
        self.views += other.views;
        self.panoramas += other.panoramas;
    }
}

impl Sub for DistinctCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { views: self.views - other.views, panoramas: self.panoramas - other.panoramas }
    }
}

/// Headings that differ only by rounding look at the same thing.
fn micro_rad(gaze: ViewGaze) -> i64 {
    (gaze.heading.rad() * 1e6).round() as i64
}
