//! Tests of world programs: what they provide if they behave, and what happens if they do not.
//!
//! The child is this test binary itself: if the environment names a role, `the_child` plays it. A shell passes its
//! standard output on as descriptor 3, because the test harness writes to descriptor 1.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test fails by panicking, and its child speaks")]

mod actor;
mod faults;
mod graphs;
#[cfg(target_os = "linux")]
mod lives;
mod worlds;

use std::{path::Path, sync::Arc, time::Duration};
use wayword_core::{Frame, Heading, Platform, PlatformError, Pose, SceneId, View, ViewGaze, ViewpointId};
use wayword_platforms::{ProcessPlatform, process::ProcessOptions};

/// Plays a child if the environment names a role, and is an empty test otherwise.
#[test]
fn the_child() {
    if let Ok(role) = std::env::var("WAYWORD_TEST_ROLE") {
        actor::play(&role);
    }
}

/// The options that start a child with a role; it may put pictures into `folder`.
pub(crate) fn options(role: &str, folder: &Path) -> ProcessOptions {
    let script =
        "WAYWORD_TEST_ROLE=$1 WAYWORD_TEST_FOLDER=$2 exec \"$0\" --exact process::the_child --nocapture 3>&1 1>&2";
    let this = std::env::current_exe().unwrap();
    let arguments = ["-c", script, this.to_str().unwrap(), role, folder.to_str().unwrap()];
    ProcessOptions {
        arguments: arguments.map(str::to_owned).to_vec(),
        width_px: actor::WIDTH_PX,
        height_px: actor::HEIGHT_PX,
        start_within: Duration::from_secs(60),
        answer_within: Duration::from_secs(60),
        ..ProcessOptions::new("sh")
    }
}

/// Starts a child with a role.
pub(crate) fn started(role: &str) -> Result<ProcessPlatform, PlatformError> {
    ProcessPlatform::start(options(role, Path::new("/nowhere")), Arc::new(|_: &str| ()))
}

pub(crate) fn scene(name: &str) -> SceneId {
    SceneId::new(name).unwrap()
}

/// A look to the north from viewpoint `a`.
pub(crate) fn look(platform: &ProcessPlatform, name: &str) -> Result<View, PlatformError> {
    let pose = Pose::looking_level(wayword_core::DVec3::new(0.0, 0.0, 1.5), Heading::NORTH);
    let frame = Frame { pose, viewpoint: Some(ViewpointId::new("a").unwrap()), level: None };
    platform.look_from(&scene(name), &frame, ViewGaze::quarter_view(Heading::NORTH))
}

/// The process id of the child that answered a look: the actor sends it as the name of the room.
pub(crate) fn pid(view: &View) -> u32 {
    view.ground_truth().unwrap().room.as_ref().unwrap().parse().unwrap()
}
