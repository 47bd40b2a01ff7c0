//! Opens recordings in the same way as the program.

use std::{path::Path, sync::Arc};
use wayword_core::{PathRequest, Platform, PlatformError, ViewGaze};
use wayword_recording::RecordingPlatform;

/// Opens the recordings under a path, samples a path from each of the first two, and looks from the first two frames.
pub fn walk(path: &Path) -> Result<(), PlatformError> {
    let platform = RecordingPlatform::open(path, Arc::new(|_: &str| ()))?;
    for scene in platform.list_scenes()?.iter().take(2) {
        platform.graph_for_scene(scene)?;
        let walk = platform.sample_path(scene, &PathRequest { hops: 1..=200, length_m: 0.01..=1e6 }, 1)?;
        for frame in walk.frames.iter().take(2) {
            platform.look_from(scene, frame, ViewGaze::quarter_view(frame.pose.heading))?;
        }
    }
    Ok(())
}
